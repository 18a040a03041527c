//! Motions of every model from random starts near the one that it states, and those of them that failed once.
//!
//! `HODOGRAPH_DROPS=1000 cargo test --release -p hodograph-simulation --test all near_starts:: -- --nocapture` tries a thousand
//! starts of each model, with `HODOGRAPH_MODEL=name` those of one.

use std::collections::BTreeMap;
use std::time::Instant;

use crate::many::{Ended, Start, drops, follow, model, surface};
use hodograph::{ComponentKind, Contacts, Law, Mechanism};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_random::Random;
use hodograph_simulation::{Event, EventKind};

/// The models of these tests, each from random starts near the one that it states, with gaps that are open.
#[test]
fn every_model() {
    let seeds = drops(0..1);
    let (mut outcomes, mut failures) = (BTreeMap::new(), Vec::new());
    let only = std::env::var("HODOGRAPH_MODEL").ok();
    for name in MODELS.into_iter().filter(|name| only.as_deref().is_none_or(|only| only == *name)) {
        let began = Instant::now();
        near_its_start(name, &seeds, &mut outcomes, &mut failures);
        println!("{name}: {:.1} s", began.elapsed().as_secs_f64());
    }
    println!("{outcomes:?}");
    assert!(failures.is_empty(), "{failures:?}");
}

/// A walker stands on both feet, which slide apart until f of both vanishes while they press alike: one of them opens.
#[test]
fn feet_that_slide_apart() {
    let (mut outcomes, mut failures) = (BTreeMap::new(), Vec::new());
    let ends = near_its_start("compass", &[100, 109], &mut outcomes, &mut failures);
    assert!(failures.is_empty(), "{failures:?}");
    // either of them might
    let opens = |event: &Event| {
        matches!(event.kind, EventKind::LiftOff { selection: hodograph::Selection::SeveralModes })
    };
    assert!(ends.iter().all(|end| end.events.iter().any(opens)), "{:?}", ends[0].names());
}

/// Two feet of a table slide; one by itself would jam, and the forces of both stay finite and unique.
#[test]
fn a_foot_that_another_keeps_from_a_jam() {
    let (mut outcomes, mut failures) = (BTreeMap::new(), Vec::new());
    near_its_start("table3", &[123], &mut outcomes, &mut failures);
    assert!(failures.is_empty(), "{failures:?}");
}

/// Balls in a row swing side by side through the lowest point, where nothing but rounding presses them together.
#[test]
fn balls_that_swing_side_by_side() {
    let (mut outcomes, mut failures) = (BTreeMap::new(), Vec::new());
    near_its_start("cradle5", &[201], &mut outcomes, &mut failures);
    assert!(failures.is_empty(), "{failures:?}");
}

/// Slip of two feet of a table turns into a jam of both: their forces grow beyond all bounds within less than a step.
#[test]
fn feet_whose_slip_turns_into_a_jam() {
    let (mut outcomes, mut failures) = (BTreeMap::new(), Vec::new());
    let ends = near_its_start("table3", &[205], &mut outcomes, &mut failures);
    assert!(failures.is_empty(), "{failures:?}");
    let jam = |event: &Event| {
        let EventKind::SimultaneousCollision(struck) = &event.kind else { return false };
        let shares = &struck.shares;
        shares.iter().all(|share| share.approach.abs() < 1e-9)
            && shares.iter().any(|share| share.impulse > 1e-3)
    };
    assert!(ends[0].events.iter().any(jam), "{:?}", ends[0].names());
}

/// Joints of a chain lie on a floor, and one of them slides slowly towards the others. No modes have finite forces, and no
/// contact can be named that jams: all of them have an impact without approach, which ends the slip.
#[test]
fn contacts_that_jam_only_together() {
    let mechanism = model("dropped5");
    let (start, (mu, e, law)) = drawn(&mechanism, 182);
    let end = follow(&mechanism, &start, surface(mu, e, law), 0.1735);
    assert!(end.error.is_none(), "{:?}", end.error);
    let jam = |event: &Event| match &event.kind {
        EventKind::SimultaneousCollision(struck)
            if struck.shares.iter().all(|share| share.approach.abs() < 1e-9) =>
        {
            Some(struck.clone())
        }
        _ => None,
    };
    let jams: Vec<_> = end.events.iter().filter_map(jam).collect();
    assert!(!jams.is_empty(), "{:?}", end.names());
    for struck in jams {
        assert!(struck.energy_change < 0.0);
        for share in struck.shares {
            let friction = share.impulse_on_point.xy().norm();
            assert!(share.impulse >= 0.0 && share.separation > -1e-12, "{share:?}");
            assert!(friction <= mu * (1.0 + 1e-4) * share.impulse, "{share:?}");
        }
    }
}

/// Four corners of a cube begin to slip on another cube so slowly that turns of their directions hardly change anything:
/// errors of the rates at which they turn must not grow from step to step.
#[test]
fn corners_that_begin_to_slip_slowly() {
    let (mut outcomes, mut failures) = (BTreeMap::new(), Vec::new());
    near_its_start("cubes2", &[186], &mut outcomes, &mut failures);
    assert!(failures.is_empty(), "{failures:?}");
}

/// Five joints of a chain bounce on each other some 240 times within 1e-12 s before their bounces end.
#[test]
fn bounces_that_end_together() {
    let mechanism = model("dropped5");
    let (start, (mu, e, law)) = drawn(&mechanism, 232);
    let end = follow(&mechanism, &start, surface(mu, e, law), 0.0915);
    assert!(end.error.is_none(), "{:?}", end.error);
    let struck: Vec<f64> = end.events.iter().map(|event| event.time).collect();
    let together = struck.windows(200).filter(|times| times[199] - times[0] < 1e-12).count();
    assert!(together > 0, "{}", struck.len());
}

/// Motions of a model from random starts near the one that it states: counts their outcomes, and lists those that fail.
fn near_its_start(
    name: &'static str,
    seeds: &[u64],
    outcomes: &mut BTreeMap<&'static str, usize>,
    failures: &mut Vec<(&'static str, u64)>,
) -> Vec<Ended> {
    let mechanism = model(name);
    let mut ends = Vec::new();
    for &seed in seeds {
        let (start, (mu, e, law)) = drawn(&mechanism, seed);
        let end = follow(&mechanism, &start, surface(mu, e, law), 1.0);
        *outcomes.entry(end.outcome()).or_insert(0) += 1;
        let size = end.before.abs().max(1e-3);
        // By Newton's hypothesis an oblique impact may give energy, and so may a surface that is driven.
        let may_gain = law == Law::Newton || DRIVEN.contains(&name);
        let gained = end.gain().filter(|(_, gain)| !may_gain && *gain > 1e-12 * size);
        if end.error.is_some() || gained.is_some() {
            let (error, names) = (end.error.as_ref().map(ToString::to_string), end.names());
            let last = &names[names.len().saturating_sub(3)..];
            println!("{name} {seed}: mu {mu:.3} e {e:.3} {law:?}: {error:?} {gained:?}, after {last:?}");
            failures.push((name, seed));
        }
        ends.push(end);
    }
    ends
}

/// A random start near the stated one, and the constants of a surface.
fn drawn(mechanism: &InterpretedMechanism, seed: u64) -> (Start, (f64, f64, Law)) {
    let mut random = Random::new(seed ^ 0x5eed_0000);
    let start = near_stated(mechanism, &mut random);
    let law = [Law::Newton, Law::Poisson, Law::Stronge][random.below(3)];
    let mu = if random.below(8) == 0 { 0.0 } else { random.between(0.05, 1.2) };
    let e = if random.below(3) == 0 { 0.0 } else { random.between(0.0, 1.0) };
    (start, (mu, e, law))
}

/// A surface that is driven.
const DRIVEN: [&str; 1] = ["truck"];

/// All but those whose gap does not belong to their normal everywhere (`plank_rollers`, `table_edge`), and `spin`: these have
/// tests of their own.
const MODELS: [&str; 37] = [
    "a_frame",
    "ball_in_corner",
    "box_on_incline",
    "bracket",
    "car",
    "chain10",
    "chain5",
    "coin",
    "compass",
    "cradle5",
    "crate",
    "cubes2",
    "cylinders3",
    "domino3",
    "domino8",
    "dropped5",
    "elbow",
    "euler_disc",
    "fence",
    "gripper",
    "groove_drop",
    "groove_roll",
    "guide",
    "kerb",
    "ladder",
    "ladder_man",
    "pyramid3",
    "quadruped",
    "row3",
    "scissors",
    "stack10",
    "table3",
    "tripod",
    "truck",
    "wedge",
    "wedge_block",
    "woodpecker",
];

/// A start whose gaps are open, with coordinates up to 0.3 away from the stated ones; after many trials less far.
fn near_stated(mechanism: &InterpretedMechanism, random: &mut Random) -> Start {
    let stated = Start::of(mechanism);
    for trial in 0..400 {
        let far = 0.3 * 0.98_f64.powi(trial);
        let mut start = stated.clone();
        start.coordinates.iter_mut().for_each(|q| *q += random.between(-far, far));
        start.speeds.iter_mut().for_each(|u| *u += random.between(-1.0, 1.0));
        if mechanism.normalise(&mut start.coordinates).is_err() {
            continue;
        }
        let state = start.state();
        let open = |contact| !matches!(mechanism.gap(contact, &state), Ok(Some(gap)) if gap < 1e-6);
        if (0..mechanism.count(ComponentKind::Contact)).all(open) && mechanism.kinetic_energy(&state).is_ok()
        {
            return start;
        }
    }
    stated
}
