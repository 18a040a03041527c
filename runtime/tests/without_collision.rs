//! Impact without collision: v_n = 0 and f < 0 (Painleve).

use crate::common::random::Random;
use crate::common::second_road::{self, condition};
use hodograph::{
    Impact, ImpactError, Law, ReducedMatrix, Surface, derivative_without_collision, impact_without_collision,
    rates, solve,
};
use nalgebra::{Matrix3, Vector2, Vector3};

/// Contacts of a rank that slide with f < 0.
fn painleve(seed: u64, rank: usize, count: usize) -> Vec<(ReducedMatrix<f64>, Vector2<f64>, Surface<f64>)> {
    let mut random = Random::new(seed);
    let mut found = Vec::new();
    while found.len() < count {
        let b =
            Matrix3::from_fn(|_, j| if j < rank { (random.number() * 1024.0).round() / 1024.0 } else { 0.0 });
        let m = ReducedMatrix::from(b * b.transpose());
        let v = if rank < 3 {
            // Without prescribed motion slip is in the range of the matrix; exactly so in doubles.
            (b.column(0) * b[(0, 1)] - b.column(1) * b[(0, 0)]) * random.number().signum()
        } else {
            Vector3::from_fn(|_, _| random.number())
        };
        let slip = Vector2::new(v.y, v.z);
        let surface = Surface {
            mu: 0.2 + 3.0 * random.number().abs(),
            e: [0.0, 1.0, 0.5 + 0.5 * random.number()][found.len() % 3],
            law: Law::ALL[(found.len() / 3) % Law::ALL.len()],
        };
        let f = rates(&m, surface.mu, slip.y.atan2(slip.x)).x;
        if m.nn > 1e-2 && f < -1e-3 * m.nn && slip.norm() > 1e-3 && b[(0, 0)].abs() > 0.05 {
            found.push((m, slip, surface));
        }
    }
    found
}

/// Against Taylor's method in twice the digits, with the energy two ways.
#[test]
fn second_road_agrees() {
    for (rank, expected) in [(2, [109, 11, 0]), (3, [120, 0, 0])] {
        let (mut count, mut wedged, mut left_out, mut worst) = (0, 0, 0, 0.0_f64);
        for (m, slip, surface) in painleve(31 + rank as u64, rank, 120) {
            let ours = impact_without_collision(&m, &slip, &surface);
            let road = second_road::without_collision(&m, [slip.x, slip.y], &surface);
            let (hit, road) = match (ours, road) {
                (Ok(hit), Ok(road)) if road.margin >= 1e-9 * condition(&m) => (hit, road),
                (Err(ImpactError::Wedged { .. }), Err(second_road::Failure::Wedged)) => {
                    wedged += 1;
                    continue;
                }
                (_, Err(second_road::Failure::Unfinished)) | (Ok(_), Ok(_)) => {
                    left_out += 1;
                    continue;
                }
                (ours, road) => panic!("{ours:?} {road:?} {m:?} {slip:?} {surface:?}"),
            };
            let v = Vector3::new(0.0, slip.x, slip.y);
            // How long v_n falls depends on f at the start, of which rounding leaves f over its terms.
            let f = rates(&m, surface.mu, slip.y.atan2(slip.x)).x;
            let terms = (m.nn + surface.mu * m.nt.hypot(m.ns)) / f.abs();
            // The work of little restitution is a difference: v_n2 is known to a multiple of eps / e.
            let little = if surface.law == Law::Stronge && surface.e > 0.0 { 1.0 / surface.e } else { 1.0 };
            let bound = (32.0 * condition(&m) * 2.2e-16).max(1e-12) * terms.max(1.0) * little;
            let error = road.error(&hit, &v) / bound;
            assert!(error <= 1.0, "{error} {hit:?} {road:?} {m:?} {slip:?} {surface:?}");
            assert_eq!(hit.compressions, road.compressions);
            worst = worst.max(error);
            count += 1;
            // The work of the impulse is the change of v^T M^-1 v / 2.
            if let Some(inverse) = Matrix3::from(m).try_inverse().filter(|_| condition(&m) < 1e6 && rank == 3)
            {
                let energy = |v: &Vector3<f64>| 0.5 * v.dot(&(inverse * v));
                let change = energy(&hit.velocity) - energy(&v);
                assert!((change - hit.contact_work).abs() <= 1e-9 * energy(&v), "{change} {hit:?}");
            }
            assert!(hit.contact_work < 0.0 && hit.impulse.x > 0.0, "{hit:?}");
            assert!(hit.velocity.x >= -1e-14 * slip.norm(), "{hit:?}");
            if surface.law == Law::Newton {
                assert!(hit.velocity.x.abs() <= 1e-14 * slip.norm(), "{hit:?}");
            }
        }
        println!(
            "rank {rank}: {count}, {wedged} wedged, {left_out} left out, worst {worst:.1e} of the bound"
        );
        assert_eq!([count, wedged, left_out], expected, "rank {rank}: compared, wedged, left out");
    }
}

/// Velocities go with the slip, impulses with slip over mass, works with slip squared over mass.
#[test]
fn scales_with_slip_and_mass() {
    for (m, slip, surface) in painleve(41, 3, 60) {
        let Ok(one) = impact_without_collision(&m, &slip, &surface) else { continue };
        for (speed, mass) in [(8.0, 1.0), (1.0 / 1024.0, 4.0), (2.0_f64.powi(300), 2.0_f64.powi(-300))] {
            let heavy = ReducedMatrix::from(<[f64; 6]>::from(m).map(|x| x * mass));
            let hit = impact_without_collision(&heavy, &(slip * speed), &surface).expect("the same");
            assert!((hit.velocity / speed - one.velocity).amax() <= 1e-13 * slip.norm());
            assert!((hit.impulse * (mass / speed) - one.impulse).amax() <= 1e-13 * one.impulse.amax());
            assert_eq!(hit.path, one.path);
        }
    }
}

/// It is the limit of a collision whose speed of approach vanishes, under Poisson's and Stronge's hypotheses;
/// and under Newton's with e = 0.
#[test]
fn limit_of_collisions() {
    let mut count = 0;
    for (m, slip, surface) in painleve(51, 3, 90) {
        let Ok(limit) = impact_without_collision(&m, &slip, &surface) else { continue };
        if limit.sensitivity.grazing || limit.sensitivity.near_mu_c || condition(&m) > 1e4 {
            continue;
        }
        let apart = |approach: f64| {
            let v = Vector3::new(-approach * slip.norm(), slip.x, slip.y);
            let hit = solve(&m, &v, &surface).expect("an outcome");
            (hit.impulse - limit.impulse).amax() / limit.impulse.amax()
        };
        let (wide, close) = (apart(1e-4), apart(1e-8));
        assert!(close <= 1e-2 * wide + 1e-10, "{wide:e} {close:e} {m:?} {slip:?} {surface:?}");
        count += 1;
    }
    assert_eq!(count, 78);
}

/// A uniform rod that slides on its tip at an angle of tangent t: f < 0 needs mu > (4 + t^2) / (3 t).
#[test]
fn rod_on_a_rough_plane() {
    for t in [0.5, 1.0, 2.0, 4.0_f64] {
        let (sin, cos) = t.atan().sin_cos();
        // Mass 1 and length 2; slip towards the side to which the rod leans over its tip.
        let m =
            ReducedMatrix::new(1.0 + 3.0 * cos * cos, 3.0 * sin * cos, 0.0, 1.0 + 3.0 * sin * sin, 0.0, 0.0);
        let least = (4.0 + t * t) / (3.0 * t);
        let at = |mu: f64, law| {
            impact_without_collision(&m, &Vector2::new(0.7, 0.0), &Surface { mu, e: 0.5, law })
        };
        for &law in Law::ALL {
            let none = at(least * (1.0 - 1e-9), law);
            assert!(matches!(none, Err(ImpactError::NoImpact { rate }) if rate > 0.0), "{none:?}");
            let hit = at(least * (1.0 + 1e-6), law).expect("an impact");
            assert!(!hit.sensitivity.jam);
            // Slip stops, then the tip sticks and is thrown up: everything is in closed form.
            let mu = least * 1.25;
            let hit = at(mu, law).expect("an impact");
            let (f, g) = (m.nn - mu * m.nt, m.nt - mu * m.tt);
            let stop = -0.7 / g;
            let fallen = f * stop;
            let rate = m.nn - m.nt * m.nt / m.tt;
            let compressed = stop - fallen / rate;
            let lost = 0.5 * fallen * compressed;
            let rise = match law {
                Law::Newton => 0.0,
                Law::Poisson => 0.5 * compressed * rate,
                Law::Stronge => (-2.0 * 0.25 * lost * rate).sqrt(),
                other => panic!("no closed form for {other:?}"),
            };
            assert!((hit.velocity - Vector3::new(rise, 0.0, 0.0)).amax() < 1e-14, "{hit:?} {rise}");
            assert!((hit.impulse.x - compressed - rise / rate).abs() < 1e-13);
        }
        // f = 0: the contact jams, and v_n stays until slip has stopped.
        let mu = m.nn / m.nt;
        let hit = at(mu, Law::Poisson).expect("an impact");
        assert!(hit.sensitivity.jam && hit.velocity.x > 0.0, "{hit:?}");
        assert!((hit.impulse.x - 1.5 * 0.7 / (mu * m.tt - m.nt)).abs() < 1e-12);
    }
}

#[test]
fn nothing_happens_without_painleve() {
    let m = ReducedMatrix::new(1.0, 0.3, 0.1, 1.0, 0.0, 1.0);
    let surface = Surface { mu: 0.5, e: 0.5, law: Law::Stronge };
    let kind = |slip: [f64; 2], surface: &Surface<f64>| {
        impact_without_collision(&m, &Vector2::from(slip), surface).map_err(|e| e.kind()).err()
    };
    assert_eq!(kind([1.0, 0.0], &surface), Some("no_impact"));
    assert_eq!(kind([0.0, 0.0], &surface), Some("no_impact"));
    assert_eq!(kind([f64::NAN, 0.0], &surface), Some("not_finite"));
    assert_eq!(kind([1.0, 0.0], &Surface { mu: -1.0, ..surface }), Some("negative_friction"));
    assert_eq!(kind([1.0, 0.0], &Surface { mu: 5.0, ..surface }), None);
}

/// The derivative against differences of fourth order, and against numbers of another crate that carry
/// derivatives.
#[test]
fn derivatives_are_those_of_differences() {
    use num_dual::Dual64;
    let (mut compared, mut unresolved) = (0, 0);
    for (m, slip, surface) in painleve(77, 3, 150) {
        let Ok(d) = derivative_without_collision(&m, &slip, &surface) else { continue };
        assert_eq!(d.impact.impulse, impact_without_collision(&m, &slip, &surface).unwrap().impulse);
        assert_eq!(d.impulse.column(0).amax(), 0.0, "v_n1 stays zero");
        let entries: [f64; 6] = m.into();
        // Input j moved by h.
        let moved = |j: usize, h: f64| {
            let mut entries = entries;
            let mut slip = slip;
            let mut surface = surface;
            match j {
                1 | 2 => slip[j - 1] += h,
                3..9 => entries[j - 3] += h,
                9 => surface.mu += h,
                _ => surface.e += h,
            }
            impact_without_collision(&ReducedMatrix::from(entries), &slip, &surface).ok()
        };
        for j in 1..11 {
            // At the ends of its range e has no difference on both sides.
            if d.non_smoothness.is_some() || (j == 10 && (surface.e == 0.0 || surface.e == 1.0)) {
                continue;
            }
            let column = d.impulse.column(j).into_owned();
            // No step resolves an impulse that changes by all of itself within a few of them.
            if 1e-4 * column.amax() > d.impact.impulse.amax() {
                unresolved += 1;
                continue;
            }
            // Large steps truncate, small ones round: the best of four must agree.
            let differences = [1e-4, 1e-5, 1e-6, 1e-7].into_iter().filter_map(|h| {
                let [a, b, c, e] = [moved(j, -2.0 * h)?, moved(j, -h)?, moved(j, h)?, moved(j, 2.0 * h)?];
                let same =
                    |x: &Impact<f64>| x.path == d.impact.path && x.compressions == d.impact.compressions;
                let impulse = ((c.impulse - b.impulse) * 8.0 - (e.impulse - a.impulse)) / (12.0 * h);
                [a, b, c, e].iter().all(same).then_some((column - impulse).amax())
            });
            let Some(off) = differences.reduce(f64::min) else { continue };
            let size = 1.0 + column.amax() + d.impact.impulse.amax();
            assert!(off <= 1e-7 * size, "{j}: {off:e} of {size:e} {:e}", d.impact.impulse.amax());
            let carry = |x: f64, k: usize| if k == j { Dual64::new(x, 1.0) } else { Dual64::from_re(x) };
            let dual = impact_without_collision(
                &ReducedMatrix::from(std::array::from_fn(|k| carry(entries[k], k + 3))),
                &Vector2::new(carry(slip.x, 1), carry(slip.y, 2)),
                &Surface { mu: carry(surface.mu, 9), e: carry(surface.e, 10), law: surface.law },
            );
            let dual = dual.unwrap().impulse.map(|x| x.eps);
            assert!((column - dual).amax() <= 1e-10 * size, "{j}: {column} {dual}");
            compared += 1;
        }
    }
    assert_eq!((compared, unresolved), (1376, 24));
}
