//! Random drops of mechanisms with several contacts: every motion comes to its end, and none gains energy.
//!
//! `cargo test -p hodograph-simulation --test all campaigns::` tries a few of each; all of them:
//!
//! `HODOGRAPH_DROPS=1000 cargo test --release -p hodograph-simulation --test all campaigns:: -- --nocapture`
//!
//! `HODOGRAPH_DROPS=81..82` tries one start alone, and a name after `campaigns::` one family.

use std::collections::BTreeMap;
use std::time::Instant;

use crate::many::{Ended, Start, drops, follow, model, name, surface, with_parameters};
use hodograph::{ComponentKind, Contacts, Law, Mechanism};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_random::Random;
use hodograph_simulation::Options;

/// A family of motions.
struct Family {
    model: &'static str,
    until: f64,
    /// greatest coefficients of friction and restitution
    most: [f64; 2],
    /// whether all loads have a potential, so that energy is accounted for
    potential: bool,
    /// sets of parameters, as names and values, one of which is chosen at random; none: those of the model
    parameters: &'static [&'static str],
    /// tolerances, one of which is chosen at random; none: 1e-12
    tolerances: &'static [f64],
    /// changes the start state that the model states
    throw: fn(&InterpretedMechanism, &mut Start, &mut Random),
}

impl Family {
    /// One whose mechanism and tolerance do not vary.
    const fn new(
        model: &'static str,
        until: f64,
        most: [f64; 2],
        throw: fn(&InterpretedMechanism, &mut Start, &mut Random),
    ) -> Self {
        Self { model, until, most, potential: true, parameters: &[], tolerances: &[], throw }
    }
}

/// How long the longest mechanisms are followed, s: without optimisation they take minutes.
const LONG: f64 = if cfg!(debug_assertions) { 0.4 } else { 2.0 };

/// Runs a family and tells its outcomes.
fn campaign(family: &Family, usual: impl IntoIterator<Item = u64>) {
    let mechanism = model(family.model);
    let others: Vec<_> = family.parameters.iter().map(|set| changed(&mechanism, set)).collect();
    let seeds = drops(usual);
    let begin = Instant::now();
    let mut outcomes: BTreeMap<&'static str, usize> = BTreeMap::new();
    let (mut events, mut account, mut slowest) = (0, 0.0_f64, (0.0_f64, 0));
    let mut failures = Vec::new();
    for &seed in &seeds {
        let one = Instant::now();
        let (end, tolerance, what) = drop_one(family, &mechanism, &others, seed);
        let took = one.elapsed().as_secs_f64();
        *outcomes.entry(end.outcome()).or_default() += 1;
        events += end.events.len();
        let size = end.before.abs().max(1e-3);
        let off = if family.potential { end.account.abs() / size } else { 0.0 };
        account = account.max(off);
        if took > slowest.0 {
            slowest = (took, seed);
        }
        let gained = end.gain().filter(|(_, gain)| *gain > 1e-12 * size);
        let wrong = match (&end.error, gained) {
            (Some(error), _) => Some(error.to_string()),
            (_, Some((event, gain))) => Some(format!("{event} gives {gain:e} J")),
            // Some hundreds of steps, each of which may err by the tolerance.
            _ if off > f64::max(1e-8, 1e3 * tolerance) => {
                Some(format!("the account is off by {:e} J", end.account))
            }
            _ => None,
        };
        if let Some(wrong) = wrong {
            let names = end.names();
            let last = &names[names.len().saturating_sub(4)..];
            println!("{} {seed}: {what}: {wrong}, after {last:?}", family.model);
            failures.push(seed);
        }
    }
    println!(
        "{}: {} drops, {outcomes:?}, {events} events, account {account:.1e}, {:.1} s, slowest {:.2} s ({})",
        family.model,
        seeds.len(),
        begin.elapsed().as_secs_f64(),
        slowest.0,
        slowest.1
    );
    assert!(failures.is_empty(), "{}: {failures:?}", family.model);
}

/// The mechanism with other parameters: `name value name value ..`.
fn changed(mechanism: &InterpretedMechanism, set: &str) -> InterpretedMechanism {
    let words: Vec<&str> = set.split_whitespace().collect();
    let pairs: Vec<(&str, f64)> = words.chunks(2).map(|pair| (pair[0], pair[1].parse().unwrap())).collect();
    with_parameters(mechanism, &pairs)
}

fn drop_one(
    family: &Family,
    mechanism: &InterpretedMechanism,
    others: &[InterpretedMechanism],
    seed: u64,
) -> (Ended, f64, String) {
    let mut random = Random::new(seed);
    let mechanism = if others.is_empty() { mechanism } else { &others[random.below(others.len())] };
    let tolerances = family.tolerances;
    let tolerance = if tolerances.is_empty() { 1e-12 } else { tolerances[random.below(tolerances.len())] };
    let mut start = Start::of(mechanism);
    (family.throw)(mechanism, &mut start, &mut random);
    let law = [Law::Newton, Law::Poisson, Law::Stronge][random.below(3)];
    let (mu, e) = (random.between(0.05, family.most[0]), random.between(0.0, family.most[1]));
    // A third is perfectly plastic.
    let e = if random.below(3) == 0 { 0.0 } else { e };
    let options =
        Options { relative_tolerance: tolerance, absolute_tolerance: tolerance, ..surface(mu, e, law) };
    let what = format!("mu {mu:.3} e {e:.3} {law:?} {tolerance:e}");
    (follow(mechanism, &start, options, family.until), tolerance, what)
}

/// Random speeds: up to `linear` (m/s) and `angular` (rad/s).
fn speeds(
    mechanism: &InterpretedMechanism,
    start: &mut Start,
    random: &mut Random,
    linear: f64,
    angular: f64,
) {
    for index in 0..mechanism.count(ComponentKind::Speed) {
        let turns = mechanism.component(ComponentKind::Speed, index).is_some_and(|c| c.unit.contains("rad"));
        let most = if turns { angular } else { linear };
        start.speeds[index] += random.between(-most, most);
    }
}

/// A quaternion of any rotation, or of one by no more than an angle about any axis.
fn turn(
    mechanism: &InterpretedMechanism,
    start: &mut Start,
    random: &mut Random,
    names: [&str; 4],
    most: Option<f64>,
) {
    let [e0, e1, e2, e3] = random.rotation();
    let values = match most {
        None => [e0, e1, e2, e3],
        Some(most) => {
            let half = 0.5 * random.between(0.0, most);
            let axis = (e1 * e1 + e2 * e2 + e3 * e3).sqrt();
            let [x, y, z] = [e1, e2, e3].map(|e| half.sin() * e / axis);
            [half.cos(), x, y, z]
        }
    };
    for (name, value) in names.iter().zip(values) {
        start.set(mechanism, name, value);
    }
}

#[test]
fn boxes() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "z", random.between(0.4, 1.0));
        turn(m, start, random, ["e0", "e1", "e2", "e3"], None);
        start.speeds.fill(0.0);
        speeds(m, start, random, 2.0, 8.0);
    };
    campaign(&Family::new("tumbling_box", 6.0, [1.0, 0.7], throw), 0..4);
}

/// Logs thrown on the edges and the corner of a table, half of them flat and slowly.
fn throw_log(m: &InterpretedMechanism, start: &mut Start, random: &mut Random) {
    let flat = random.below(2) == 0;
    start.set(m, "x", random.between(-0.4, 0.2));
    start.set(m, "y", if flat { random.between(0.06, 0.1) } else { 0.5 });
    start.set(m, "z", random.between(0.5, 1.1));
    turn(m, start, random, ["e0", "e1", "e2", "e3"], None);
    if flat {
        let half = random.between(-3.0, 3.0);
        ["e0", "e1", "e2", "e3"].into_iter().for_each(|name| start.set(m, name, 0.0));
        start.set(m, "e0", half.cos());
        start.set(m, "e2", half.sin());
    }
    start.speeds.fill(0.0);
    let [linear, angular] = if flat { [0.5, 1.0] } else { [1.0, 6.0] };
    speeds(m, start, random, linear, angular);
}

#[test]
fn logs() {
    campaign(&Family::new("log_on_table", 1.5, [1.0, 0.7], throw_log), 0..20);
}

#[test]
fn logs_on_a_polytope() {
    campaign(&Family::new("log_on_slab", 1.5, [1.0, 0.7], throw_log), 0..5);
}

/// Eggs thrown on a rock from above.
#[test]
fn eggs() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "x", random.between(-0.4, 0.4));
        start.set(m, "y", random.between(-0.2, 0.2));
        start.set(m, "z", random.between(0.5, 0.7));
        turn(m, start, random, ["e0", "e1", "e2", "e3"], None);
        speeds(m, start, random, 1.0, 20.0);
    };
    campaign(&Family::new("egg_on_egg", 1.0, [1.0, 0.8], throw), 0..5);
}

/// Wheels thrown on a road in a plane.
#[test]
fn wheels_on_a_road() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "x", random.between(-2.0, 2.0));
        start.set(m, "y", random.between(0.3, 0.8));
        speeds(m, start, random, 2.0, 10.0);
    };
    campaign(&Family::new("ball_on_road", 4.0, [1.0, 0.8], throw), 0..10);
}

/// Crates thrown on the edges and the corner of a table.
#[test]
fn crates_on_a_table() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "x", random.between(-0.4, 0.2));
        start.set(m, "y", random.between(0.3, 0.5));
        start.set(m, "z", random.between(0.5, 1.1));
        turn(m, start, random, ["e0", "e1", "e2", "e3"], None);
        speeds(m, start, random, 1.0, 6.0);
    };
    // In 79 a vertex passes beside the table while an edge strikes it.
    campaign(&Family::new("crate_on_table", 1.5, [1.0, 0.7], throw), (0..3).chain([79]));
}

/// Tetrahedra thrown on a ramp and the floor before it.
#[test]
fn dice_on_a_ramp() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "x", random.between(-0.5, 0.4));
        start.set(m, "y", random.between(0.6, 0.8));
        start.set(m, "z", random.between(-0.5, 0.5));
        turn(m, start, random, ["e0", "e1", "e2", "e3"], None);
        speeds(m, start, random, 1.0, 6.0);
    };
    campaign(&Family::new("die_on_ramp", 1.5, [1.0, 0.6], throw), 0..5);
}

#[test]
fn two_cubes() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "z1", random.between(0.2, 0.3));
        start.set(m, "z2", random.between(0.6, 0.8));
        turn(m, start, random, ["e01", "e11", "e21", "e31"], Some(0.3));
        turn(m, start, random, ["e02", "e12", "e22", "e32"], Some(0.4));
        speeds(m, start, random, 0.3, 1.0);
    };
    // 3 slides to its end with hardly any forces left that the laws allow. In 53, 96, 164 and 166 corners begin to slip so
    // slowly that no search finds the directions in which they settle; they were taken for settled.
    campaign(&Family::new("cubes2", 2.0, [1.0, 0.6], throw), (0..4).chain([53, 96, 164, 166]));
}

#[test]
fn balls_in_a_corner() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        for name in ["x", "y", "z"] {
            start.set(m, name, 0.1 + random.between(0.0, 0.3));
        }
        speeds(m, start, random, 1.0, 20.0);
    };
    campaign(&Family::new("ball_in_corner", 6.0, [1.0, 0.8], throw), 0..10);
}

#[test]
fn chains_of_five() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "z", random.between(0.6, 0.8));
        for name in ["q1", "q2", "q3", "q4", "q5"] {
            start.set(m, name, random.between(-1.2, 1.2));
        }
        speeds(m, start, random, 0.5, 4.0);
    };
    // In 6 slip begins, and its rate changes its sign before it is as large as errors of a step. In 149 slip begins
    // against what rounding has left of the slip before, and hardly grows. In 796 two links slide to their end while the
    // slip of a third has just begun. In 525 one link folds onto another, and its foot opens and closes while it slips.
    campaign(&Family::new("chain5", 2.0, [1.0, 0.5], throw), (4..7).chain([149, 525, 796]));
}

#[test]
fn chains_of_ten() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "z", random.between(1.1, 1.3));
        for k in 1..=10 {
            start.set(m, &format!("q{k}"), random.between(-1.2, 1.2));
        }
        speeds(m, start, random, 0.5, 4.0);
    };
    // In 44 the chain lies straight on its feet, which can hardly move relative to each other.
    campaign(&Family::new("chain10", LONG, [1.0, 0.5], throw), [0, 44]);
    // In 304 slip settles no more while ten feet are down, and nothing has ended a mode: modes are decided anew.
    campaign(&Family::new("chain10", 1.21, [1.0, 0.5], throw), [304]);
}

/// Three to eight dominoes, the first of which is pushed; the others stand far away.
#[test]
fn dominoes() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        let fall = 3 + random.below(6);
        let apart = random.between(0.02, 0.05);
        for k in 1..=8 {
            let place = f64::from(k) * if k as usize > fall { 1.0 } else { apart };
            start.set(m, &format!("x{k}"), place);
        }
        start.set(m, "q1", random.between(0.0, 0.02));
        start.set(m, "z1", 0.0402);
        start.set(m, "ux1", random.between(0.0, 0.4));
        start.set(m, "uq1", random.between(2.0, 10.0));
    };
    campaign(&Family::new("domino8", 0.5 * LONG, [0.8, 0.5], throw), 0..1);
}

/// The first frames of 360 measured tosses of two boxes with a hinge.
const TOSSES: &str = include_str!("../../tests/data/tosses/elbow.csv");

/// A measured toss, above the table: the measured places are some millimetres off.
fn toss(m: &InterpretedMechanism, start: &mut Start, random: &mut Random) {
    let rows: Vec<&str> = TOSSES.lines().skip(1).collect();
    let row: Vec<f64> =
        rows[random.below(rows.len())].split(',').skip(1).map(|number| number.parse().unwrap()).collect();
    let length = row[..4].iter().map(|part| part * part).sum::<f64>().sqrt();
    let names = "e0 e1 e2 e3 x y z th u4 u5 u6 u1 u2 u3 u7".split(' ');
    for (place, (name, value)) in names.zip(&row).enumerate() {
        start.set(m, name, if place < 4 { value / length } else { *value });
    }
    let state = start.state();
    let gaps = (0..m.count(ComponentKind::Contact)).map(|contact| m.gap(contact, &state).unwrap().unwrap());
    let lowest = gaps.fold(f64::INFINITY, f64::min);
    if lowest < 1e-3 {
        start.coordinates[m.index(ComponentKind::Coordinate, "z").unwrap()] += 1e-3 - lowest;
    }
}

/// Hinged boxes as published, with the measured moments and with rounded corners.
#[test]
fn hinged_boxes() {
    let parameters = &[
        "",
        "J1 1.8e-4 J2 4.6e-4 J3 4.3e-4 K1 1.8e-4 K2 4.6e-4 K3 4.3e-4",
        "J1 2e-4 J2 5e-4 J3 5.5e-4 K1 2e-4 K2 5e-4 K3 5.5e-4 r 3.2e-3",
    ];
    let tolerances = &[1e-12, 1e-10, 1e-9];
    // In this one a box begins to tip while the forces at two of its corners fall to some nanonewtons, of which the
    // Hessian of their barrier did not tell whether they press. In 101 two corners come to rest 30 um apart, where
    // they can hardly move relative to each other; in 209 a box that slides on six corners begins to tip.
    let usual = [36, 101, 209];
    campaign(&Family { parameters, tolerances, ..Family::new("elbow", 1.5, [0.6, 0.5], toss) }, usual);
}

/// The same with hinges that damp, viscously and by friction.
#[test]
fn damped_hinged_boxes() {
    let parameters = &[
        "J1 2e-4 J2 5e-4 J3 5.5e-4 K1 2e-4 K2 5e-4 K3 5.5e-4 tau 5e-4",
        "J1 1.8e-4 J2 4.6e-4 J3 4.3e-4 K1 1.8e-4 K2 4.6e-4 K3 4.3e-4 r 3.18e-3 z0 -2.52e-3 \
         sx1 -1e-3 sx2 -1.5e-3 cv 6e-4",
        "J1 1.89e-4 J2 6.54e-4 J3 7.37e-4 K1 1.57e-4 K2 5.43e-4 K3 6.13e-4 m2 0.3075 r 1.24e-3 z0 7e-4 \
         cv 7.3e-4 tau 4.5e-4",
    ];
    let tolerances = &[1e-12, 1e-10, 1e-9];
    let family =
        Family { potential: false, parameters, tolerances, ..Family::new("elbow", 1.5, [0.6, 0.5], toss) };
    campaign(&family, 0..1);
}

#[test]
fn three_dominoes() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        for (i, x) in [0.03, 0.06, 0.09].into_iter().enumerate() {
            start.set(m, &format!("x{}", i + 1), x);
            start.set(m, &format!("z{}", i + 1), 0.04 + random.between(0.002, 0.01));
            start.set(m, &format!("q{}", i + 1), random.between(-0.08, 0.08));
        }
        start.speeds.fill(0.0);
        start.set(m, "ux1", random.between(0.0, 0.4));
        start.set(m, "uq1", random.between(0.0, 6.0));
    };
    campaign(&Family::new("domino3", 1.5, [0.8, 0.5], throw), 0..3);
}

#[test]
fn quadrupeds() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "z", random.between(0.4, 0.7));
        turn(m, start, random, ["e0", "e1", "e2", "e3"], Some(0.4));
        for leg in ["lf", "rf", "lh", "rh"] {
            start.set(m, &format!("h_{leg}"), random.between(-0.3, 0.3));
        }
        speeds(m, start, random, 0.5, 1.0);
    };
    // In the first slip begins after four events at one time, while that of two other feet is small. In the second a step
    // ends just before friction is exhausted, and the next one has to see that in spite of rounding. In the third slip
    // of a tolerance would end at once at its rate, but its direction turns with that of another foot.
    campaign(&Family { potential: false, ..Family::new("quadruped", 1.5, [1.0, 0.3], throw) }, [2, 908, 927]);
}

/// Two crossed rods that fall flat, all four ends at once, or hardly turned.
#[test]
fn scissors() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        start.set(m, "z", random.between(0.05, 0.3));
        start.set(m, "th", random.between(0.3, 2.8));
        if random.below(2) == 0 {
            turn(m, start, random, ["e0", "e1", "e2", "e3"], Some(0.2));
            speeds(m, start, random, 0.5, 2.0);
        }
    };
    campaign(&Family::new("scissors", 2.0, [1.0, 0.6], throw), 0..4);
}

/// Every family is tried, and no name is misspelt.
#[test]
fn the_models_have_contacts() {
    let families = [
        "tumbling_box",
        "cubes2",
        "ball_in_corner",
        "chain5",
        "domino3",
        "quadruped",
        "chain10",
        "domino8",
        "elbow",
        "scissors",
    ]
    .map(model);
    for mechanism in &families {
        assert!(
            mechanism.count(ComponentKind::Contact) >= 3,
            "{}",
            name(mechanism, ComponentKind::Contact, 0)
        );
    }
}
