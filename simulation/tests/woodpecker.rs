//! The woodpecker toy beside time stepping: its period depends on the law of friction in impacts.

use crate::many::{Start, follow, model, surface};
use hodograph::{ComponentKind, Law, Mechanism, Surface};
use hodograph_simulation::{EventKind, Options};

/// Masses, lengths, stiffness and gravity of the model, in its units.
const SLEEVE: [f64; 2] = [3e-4, 5e-9];
const BIRD: [f64; 2] = [4.5e-3, 7e-7];
const SPRING: f64 = 5.6e-3;
const ARMS: [f64; 2] = [0.010, 0.015];
const G: f64 = 9.81;
const MU: f64 = 0.3;
const BEAK: f64 = 0.5;
/// Approaches above this are impacts, m/s: below, a contact lasts.
const STRIKES: f64 = 0.02;

type Three = [f64; 3];

fn dot(a: &Three, b: &Three) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(a: &Three, b: &Three, by: f64) -> Three {
    std::array::from_fn(|i| a[i] + by * b[i])
}

/// How friction acts in an impact.
#[derive(Clone, Copy, PartialEq)]
enum Friction {
    /// Moreau: against the slip that is left after it.
    After,
    /// Coulomb's law all the time while the normal impulse grows.
    During,
}

/// y, the angles of the sleeve and of the bird: normals and tangents of beak, lower and upper edge, and their gaps.
const NORMALS: [Three; 3] = [[0.0, 0.0, -0.02], [0.0, 0.0058, 0.0], [0.0, -0.0058, 0.0]];
const TANGENTS: [Three; 3] = [[1.0, 0.010, 0.015 - 0.0201], [1.0, 0.0031, 0.0], [1.0, 0.0031, 0.0]];
const GAPS: Three = [0.010 + 0.015 - 0.0201 - 0.0025, 0.0006, 0.0006];

/// The inverse mass matrix times a vector, by elimination.
fn move_by(force: &Three) -> Three {
    let m = BIRD[0];
    let mut rows = [
        [m + SLEEVE[0], m * ARMS[0], m * ARMS[1], force[0]],
        [m * ARMS[0], SLEEVE[1] + m * ARMS[0] * ARMS[0], m * ARMS[0] * ARMS[1], force[1]],
        [m * ARMS[1], m * ARMS[0] * ARMS[1], BIRD[1] + m * ARMS[1] * ARMS[1], force[2]],
    ];
    for j in 0..3 {
        for i in 0..3 {
            if i != j {
                let factor = rows[i][j] / rows[j][j];
                let pivot = rows[j];
                rows[i].iter_mut().zip(&pivot).for_each(|(entry, pivot)| *entry -= factor * pivot);
            }
        }
    }
    std::array::from_fn(|i| rows[i][3] / rows[i][i])
}

/// Moreau's time stepping at the midpoint, by projected Gauss and Seidel: the times at which the sleeve jams below.
fn time_stepping(friction: Friction, dt: f64, until: f64) -> Vec<f64> {
    let (n, t) = (NORMALS.map(|v| move_by(&v)), TANGENTS.map(|v| move_by(&v)));
    let restitution = [BEAK, 0.0, 0.0];
    let (mut q, mut u) = ([0.0, -0.0006 / 0.0058, -0.2788], [-0.3411, 0.0, -7.4583]);
    let (mut starts, mut held) = (Vec::<f64>::new(), true);
    for step in 0..(until / dt) as usize {
        let middle = add(&q, &u, 0.5 * dt);
        let twist = SPRING * (middle[2] - middle[1]);
        let weight = BIRD[0] * G;
        let force = [-weight - SLEEVE[0] * G, twist - weight * ARMS[0], -twist - weight * ARMS[1]];
        let before = u;
        u = add(&u, &move_by(&force), dt);
        let mut active: Vec<usize> = (0..3).filter(|&i| GAPS[i] + dot(&NORMALS[i], &middle) <= 0.0).collect();
        let now = active.contains(&1);
        let struck: Vec<usize> =
            active.iter().copied().filter(|&i| dot(&NORMALS[i], &u) < -STRIKES).collect();
        if friction == Friction::During && struck.len() == 1 {
            let i = struck[0];
            let wanted = -restitution[i] * dot(&NORMALS[i], &u);
            let part = 1e-3 * (wanted - dot(&NORMALS[i], &u)) / dot(&NORMALS[i], &n[i]);
            while dot(&NORMALS[i], &u) < wanted {
                u = add(&u, &n[i], part);
                let stop = -dot(&TANGENTS[i], &u) / dot(&TANGENTS[i], &t[i]);
                u = add(&u, &t[i], stop.clamp(-MU * part, MU * part));
            }
            active.retain(|&j| j != i || restitution[i] == 0.0);
        }
        let mut impulse = [[0.0; 2]; 3];
        for _ in 0..2000 {
            let mut changed = 0.0_f64;
            for &i in &active {
                let miss = dot(&NORMALS[i], &u) + restitution[i] * dot(&NORMALS[i], &before);
                let normal = (impulse[i][0] - miss / dot(&NORMALS[i], &n[i])).max(0.0);
                u = add(&u, &n[i], normal - impulse[i][0]);
                let stop = impulse[i][1] - dot(&TANGENTS[i], &u) / dot(&TANGENTS[i], &t[i]);
                let tangential = stop.clamp(-MU * normal, MU * normal);
                u = add(&u, &t[i], tangential - impulse[i][1]);
                changed = changed.max((normal - impulse[i][0]).abs()).max((tangential - impulse[i][1]).abs());
                impulse[i] = [normal, tangential];
            }
            if changed < 1e-15 {
                break;
            }
        }
        q = add(&middle, &u, 0.5 * dt);
        let time = (step + 1) as f64 * dt;
        if now && !held && starts.last().is_none_or(|last| time - last > 0.05) {
            starts.push(time);
        }
        held = now;
    }
    starts
}

/// The mean of the last three periods.
fn period(starts: &[f64]) -> f64 {
    let last = starts.len() - 1;
    (starts[last] - starts[last - 3]) / 3.0
}

/// Slip turns round while the beak strikes. With Moreau's friction, against the slip that is left, the period is that of
/// the literature, 0.146 s; with Coulomb's law during the impact it is that of the events, 0.151 s.
#[test]
fn its_period_is_that_of_time_stepping_with_the_same_friction() {
    let moreau = period(&time_stepping(Friction::After, 1e-4, 1.3));
    assert!((moreau - 0.146).abs() < 1e-3, "{moreau}");
    let during = period(&time_stepping(Friction::During, 1e-5, 1.5));
    let mechanism = model("woodpecker");
    let index = |name: &str| mechanism.index(ComponentKind::Contact, name).unwrap();
    let beak = Surface { mu: MU, e: BEAK, law: Law::Newton };
    let options = Options { surfaces: vec![(index("beak"), beak)], ..surface(MU, 0.0, Law::Newton) };
    let end = follow(&mechanism, &Start::of(&mechanism), options, 1.7);
    assert!(end.error.is_none() && end.gain().is_none_or(|(_, gain)| gain <= 0.0), "{:?}", end.error);
    let mut starts: Vec<f64> = Vec::new();
    for event in end.events.iter().filter(|event| event.contact == Some(index("low")) && event.time > 0.0) {
        let strikes = matches!(event.kind, EventKind::Collision(_));
        if strikes && starts.last().is_none_or(|last| event.time - last > 0.05) {
            starts.push(event.time);
        }
    }
    let events = period(&starts);
    assert!((events - 0.1512).abs() < 3e-4, "{events} {starts:?}");
    // Steps of 1e-5 s do not tell every slow approach from a contact that lasts.
    assert!((during - events).abs() < 3e-3, "{during} {events}");
    assert!(events > moreau + 4e-3 && during > moreau + 4e-3, "{moreau} {during} {events}");
}
