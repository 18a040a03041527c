//! Random drops of mechanisms with several contacts: every motion comes to its end, and none gains energy.
//!
//! `cargo test -p hodograph-simulation --test campaigns` tries a few of each; all of them:
//!
//! `HODOGRAPH_DROPS=1000 cargo test --release -p hodograph-simulation --test campaigns -- --nocapture`
//!
//! `HODOGRAPH_DROPS=81..82` tries one start alone, and a name after `--test campaigns` one family.

mod many;
#[path = "common/random.rs"]
#[allow(dead_code)]
mod random;

use std::collections::BTreeMap;
use std::ops::Range;
use std::time::Instant;

use hodograph::{Kind, Law, Mechanism};
use hodograph_interpreter::InterpretedMechanism;
use many::{Ended, Start, follow, model, name, surface};
use random::Random;

/// A family of motions.
struct Family {
    model: &'static str,
    until: f64,
    /// greatest coefficients of friction and restitution
    most: [f64; 2],
    /// whether all loads have a potential, so that energy is accounted for
    potential: bool,
    /// changes the start state that the model states
    throw: fn(&InterpretedMechanism, &mut Start, &mut Random),
}

/// The starts: the first so many, or what `HODOGRAPH_DROPS` says, a number or a range.
fn drops(usual: u64) -> Range<u64> {
    let text = std::env::var("HODOGRAPH_DROPS").unwrap_or_default();
    match text.split_once("..") {
        Some((from, to)) => from.parse().unwrap_or(0)..to.parse().unwrap_or(usual),
        None => 0..text.parse().unwrap_or(usual),
    }
}

/// Runs a family and tells its outcomes.
fn campaign(family: &Family, usual: u64) {
    let mechanism = model(family.model);
    let seeds = drops(usual);
    let begin = Instant::now();
    let mut outcomes: BTreeMap<&'static str, usize> = BTreeMap::new();
    let (mut events, mut account, mut slowest) = (0, 0.0_f64, (0.0_f64, 0));
    let mut failures = Vec::new();
    for seed in seeds.clone() {
        let one = Instant::now();
        let (end, what) = drop_one(family, &mechanism, seed);
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
            _ if off > 1e-8 => Some(format!("the account is off by {:e} J", end.account)),
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
        seeds.end - seeds.start,
        begin.elapsed().as_secs_f64(),
        slowest.0,
        slowest.1
    );
    assert!(failures.is_empty(), "{}: {failures:?}", family.model);
}

fn drop_one(family: &Family, mechanism: &InterpretedMechanism, seed: u64) -> (Ended, String) {
    let mut random = Random(seed);
    let mut start = Start::of(mechanism);
    (family.throw)(mechanism, &mut start, &mut random);
    let law = [Law::Newton, Law::Poisson, Law::Stronge][random.place(3)];
    let (mu, e) = (random.between(0.05, family.most[0]), random.between(0.0, family.most[1]));
    // A third is perfectly plastic.
    let e = if random.place(3) == 0 { 0.0 } else { e };
    (follow(mechanism, &start, surface(mu, e, law), family.until), format!("mu {mu:.3} e {e:.3} {law:?}"))
}

/// Random speeds: up to `linear` (m/s) and `angular` (rad/s).
fn speeds(
    mechanism: &InterpretedMechanism,
    start: &mut Start,
    random: &mut Random,
    linear: f64,
    angular: f64,
) {
    for index in 0..mechanism.count(Kind::Speed) {
        let turns = mechanism.component(Kind::Speed, index).is_some_and(|c| c.unit.contains("rad"));
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
    campaign(&Family { model: "tumbling_box", until: 6.0, most: [1.0, 0.7], potential: true, throw }, 4);
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
    campaign(&Family { model: "cubes2", until: 2.0, most: [1.0, 0.6], potential: true, throw }, 2);
}

#[test]
fn balls_in_a_corner() {
    let throw = |m: &InterpretedMechanism, start: &mut Start, random: &mut Random| {
        for name in ["x", "y", "z"] {
            start.set(m, name, 0.1 + random.between(0.0, 0.3));
        }
        speeds(m, start, random, 1.0, 20.0);
    };
    campaign(&Family { model: "ball_in_corner", until: 6.0, most: [1.0, 0.8], potential: true, throw }, 10);
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
    campaign(&Family { model: "chain5", until: 2.0, most: [1.0, 0.5], potential: true, throw }, 3);
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
    campaign(&Family { model: "domino3", until: 1.5, most: [0.8, 0.5], potential: true, throw }, 3);
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
    campaign(&Family { model: "quadruped", until: 1.5, most: [1.0, 0.3], potential: false, throw }, 1);
}

/// Every family is tried, and no name is misspelt.
#[test]
fn the_models_have_contacts() {
    let families = ["tumbling_box", "cubes2", "ball_in_corner", "chain5", "domino3", "quadruped"].map(model);
    for mechanism in &families {
        assert!(mechanism.count(Kind::Contact) >= 3, "{}", name(mechanism, Kind::Contact, 0));
    }
}
