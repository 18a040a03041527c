//! Random problems of several contacts, in four families.

use hodograph_random::Random;
use nalgebra::{DMatrix, DVector, Matrix3, Vector2, Vector3};

/// W, beta, mu and the directions of slip.
pub struct Contacts {
    pub w: DMatrix<f64>,
    pub beta: DVector<f64>,
    pub mu: Vec<f64>,
    pub slip: Vec<Option<Vector2<f64>>>,
}

/// The names of the families.
pub const FAMILIES: [&str; 5] = ["planted", "body", "flat", "stack", "chain"];

fn vector(random: &mut Random) -> Vector3<f64> {
    Vector3::new(random.normal(), random.normal(), random.normal())
}

fn direction(random: &mut Random) -> Vector2<f64> {
    let angle = std::f64::consts::TAU * random.unit();
    Vector2::new(angle.cos(), angle.sin())
}

/// A problem of a family with about `k` contacts (a stack has a multiple of four).
pub fn problem(family: &str, k: usize, seed: u64) -> Contacts {
    let mut random = Random::new(seed.wrapping_mul(0x5851_f42d_4c95_7f2d) ^ (k as u64) << 40);
    match family {
        "planted" => planted(k, &mut random),
        "body" => body(k, true, &mut random),
        "flat" => body(k, false, &mut random),
        "chain" => chain(k, &mut random),
        _ => stack(k.div_ceil(4), &mut random),
    }
}

/// A solution is planted: a fifth of the contacts slips along a given direction, the others separate, stick or begin to
/// slip.
fn planted(k: usize, random: &mut Random) -> Contacts {
    let dofs = 3 + (random.unit() * 4.0 * k as f64) as usize;
    let partials = DMatrix::from_fn(3 * k, dofs, |_, _| random.normal());
    let w = &partials * partials.transpose() / dofs as f64;
    let mut mu = Vec::new();
    let mut slip = Vec::new();
    let (mut force, mut acceleration) = (DVector::zeros(3 * k), DVector::zeros(3 * k));
    for i in 0..k {
        let (friction, d) = (random.between(0.05, 0.6), direction(random));
        let normal = random.between(0.1, 2.0);
        let kind = random.unit();
        mu.push(friction);
        slip.push((kind < 0.2).then_some(d));
        let set = |values: &mut DVector<f64>, three: [f64; 3]| {
            for (axis, value) in three.into_iter().enumerate() {
                values[3 * i + axis] = value;
            }
        };
        if kind < 0.2 {
            set(&mut force, [normal, -friction * normal * d.x, -friction * normal * d.y]);
            set(&mut acceleration, [0.0, random.normal(), random.normal()]);
        } else if kind < 0.45 {
            set(&mut acceleration, [normal, random.normal(), random.normal()]);
        } else if kind < 0.8 {
            let push = friction * normal * random.unit();
            set(&mut force, [normal, push * d.x, push * d.y]);
        } else {
            let rate = random.between(0.1, 2.0);
            set(&mut force, [normal, -friction * normal * d.x, -friction * normal * d.y]);
            set(&mut acceleration, [0.0, rate * d.x, rate * d.y]);
        }
    }
    let beta = acceleration - &w * force;
    Contacts { w, beta, mu, slip }
}

/// One body on k contacts in a plane, with vertical normals or with tilted ones, under a random load.
fn body(k: usize, tilted: bool, random: &mut Random) -> Contacts {
    let mut partials = DMatrix::zeros(3 * k, 6);
    let mut mu = Vec::new();
    for i in 0..k {
        let point = Vector3::new(random.normal(), random.normal(), -0.5);
        let lean = if tilted { 0.6 } else { 0.0 };
        let normal = Vector3::new(lean * random.normal(), lean * random.normal(), 1.0).normalize();
        rows(&mut partials, i, 0, &point, &normal, 1.0);
        mu.push(random.between(0.05, 1.0));
    }
    let masses = [1.0, 1.0, 1.0, 0.3, 0.4, 0.5];
    let load = Vector3::new(random.normal(), random.normal(), -4.0);
    let moment = vector(random) * 0.5;
    let free = [load.x, load.y, load.z, moment.x / 0.3, moment.y / 0.4, moment.z / 0.5];
    assembled(&partials, &masses, &free, mu)
}

/// Boxes on each other, four contacts between each two, the lowest on the ground.
fn stack(boxes: usize, random: &mut Random) -> Contacts {
    let mut partials = DMatrix::zeros(12 * boxes, 6 * boxes);
    let mut mu = Vec::new();
    let (mut masses, mut free) = (Vec::new(), Vec::new());
    for b in 0..boxes {
        let friction = random.between(0.2, 0.8);
        for (corner, (x, y)) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)].into_iter().enumerate() {
            rows(&mut partials, 4 * b + corner, 6 * b, &Vector3::new(x, y, -0.5), &Vector3::z(), 1.0);
            if b > 0 {
                rows(
                    &mut partials,
                    4 * b + corner,
                    6 * (b - 1),
                    &Vector3::new(x, y, 0.5),
                    &Vector3::z(),
                    -1.0,
                );
            }
            mu.push(friction);
        }
        let mass = random.between(0.5, 2.0);
        masses.extend([mass, mass, mass, mass / 6.0, mass / 6.0, mass / 6.0]);
        let push = vector(random) * if random.unit() < 0.3 { 3.0 } else { 0.3 };
        let turn = vector(random) * 0.3;
        free.extend([push.x, push.y, -9.81, turn.x, turn.y, turn.z]);
    }
    assembled(&partials, &masses, &free, mu)
}

/// A chain in a plane, nearly straight along the floor: masses at the joints of links of length one, k of which touch the
/// floor. These can hardly move relative to each other along it. Links between two of them do not turn, others do, so
/// that the joints pull at each other.
fn chain(k: usize, random: &mut Random) -> Contacts {
    let closed: Vec<bool> = std::iter::repeat_with(|| random.unit() < 0.7).take(8 * k).collect();
    let last = closed.iter().scan(0, |sum, closed| {
        *sum += usize::from(*closed);
        Some(*sum)
    });
    let joints = last.take_while(|sum| *sum < k).count() + 1;
    let steep = 10.0_f64.powf(random.between(-12.0, -4.0));
    let (fast, dofs) = (10.0_f64.powf(random.between(-6.0, 0.0)), joints + 1);
    let angles: Vec<f64> = (1..joints).map(|_| steep * random.normal()).collect();
    let turns: Vec<f64> = (1..joints)
        .map(|link| if closed[link - 1] && closed[link] { 0.0 } else { fast * random.normal() })
        .collect();
    // The velocities of joint i, up and along, by those of the first joint and the angular velocities of the links; and
    // their rates for constant speeds.
    let (mut up, mut along) = (DMatrix::zeros(joints, dofs), DMatrix::zeros(joints, dofs));
    let (mut up_rate, mut along_rate) = (DVector::zeros(joints), DVector::zeros(joints));
    for i in 0..joints {
        (up[(i, 0)], along[(i, 1)]) = (1.0, 1.0);
        for link in 0..i {
            let (sin, cos) = angles[link].sin_cos();
            (up[(i, 2 + link)], along[(i, 2 + link)]) = (cos, -sin);
            up_rate[i] -= sin * turns[link] * turns[link];
            along_rate[i] -= cos * turns[link] * turns[link];
        }
    }
    let masses = DMatrix::from_diagonal(&DVector::from_fn(joints, |_, _| random.between(0.5, 2.0)));
    let mass = up.tr_mul(&masses) * &up + along.tr_mul(&masses) * &along;
    let load = -up.tr_mul(&masses) * up_rate.add_scalar(9.81) - along.tr_mul(&masses) * &along_rate;
    let factors = mass.cholesky().unwrap();
    let free = factors.solve(&load);
    let mut partials = DMatrix::zeros(3 * k, dofs);
    let mut beta = DVector::zeros(3 * k);
    for (contact, joint) in (0..joints).filter(|&i| closed[i] || i + 1 == joints).take(k).enumerate() {
        for (row, (velocity, rate)) in [(&up, &up_rate), (&along, &along_rate)].into_iter().enumerate() {
            partials.row_mut(3 * contact + row).copy_from(&velocity.row(joint));
            beta[3 * contact + row] = velocity.row(joint).transpose().dot(&free) + rate[joint];
        }
    }
    let w = &partials * factors.solve(&partials.transpose());
    let w = 0.5 * (&w + w.transpose());
    Contacts { w, beta, mu: vec![random.between(0.05, 1.0); k], slip: vec![None; k] }
}

/// The rows of contact `i` at a point of the body whose speeds begin at `column`.
fn rows(
    partials: &mut DMatrix<f64>,
    i: usize,
    column: usize,
    point: &Vector3<f64>,
    normal: &Vector3<f64>,
    sign: f64,
) {
    let t = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let t = (t - normal * normal.dot(&t)).normalize();
    let basis = Matrix3::from_columns(&[*normal, t, normal.cross(&t)]);
    for axis in 0..3 {
        let e: Vector3<f64> = basis.column(axis).into();
        let arm = point.cross(&e);
        for c in 0..3 {
            partials[(3 * i + axis, column + c)] += sign * e[c];
            partials[(3 * i + axis, column + 3 + c)] += sign * arm[c];
        }
    }
}

fn assembled(partials: &DMatrix<f64>, masses: &[f64], free: &[f64], mu: Vec<f64>) -> Contacts {
    let weighed = DMatrix::from_fn(partials.ncols(), partials.nrows(), |a, b| partials[(b, a)] / masses[a]);
    let slip = vec![None; mu.len()];
    Contacts { w: partials * weighed, beta: partials * DVector::from_column_slice(free), mu, slip }
}
