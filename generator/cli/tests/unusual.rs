//! Valid mechanisms of unusual kinds (`tests/data/unusual`: gears, belts, rolling in drums, knife edges,
//! struck frames, springs of all forms, quaternions, linkages, very small and very large parts): accepted
//! without a warning, derived, and equal to the numeric evaluation.
#![cfg(feature = "derive")]

use crate::common::{hodograph, root};
use hodograph_generator::check::check;
use hodograph_generator::diagnostics::codes::NO_GAP;
use hodograph_generator::files;
use hodograph_generator::interpret::Evaluator;
use hodograph_generator::model::mechanism::{Mechanism, Orientation};
use hodograph_generator::numeric::{self, Evaluation, State};
use hodograph_generator::program::{ContactQuantity, Inputs, PointQuantity, Program, Quantity};
use hodograph_generator::{artifact, rendering::render};

/// A state near the initial one, with its loops closed; `None` where they cannot be.
fn near(m: &Mechanism, seed: u64) -> Option<State> {
    let mut bits = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut state = State::of(m);
    state.time = 0.4 * next();
    for list in [&mut state.coordinates, &mut state.inputs] {
        list.iter_mut().for_each(|number| *number += 0.1 * next() * number.abs().max(1e-7));
    }
    state.speeds.iter_mut().for_each(|number| *number += next());
    for frame in &m.frames {
        if let Orientation::Quaternion(ids) = &frame.orientation {
            let norm = ids.iter().map(|id| state.coordinates[id.0].powi(2)).sum::<f64>().sqrt();
            ids.iter().for_each(|id| state.coordinates[id.0] /= norm);
        }
    }
    numeric::assemble(m, &mut state).ok().map(|()| state)
}

/// The largest difference beside the largest of the numbers expected, or of their surroundings.
fn off(found: &[f64], expected: &[f64], scale: f64) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(scale, |largest, value| largest.max(value.abs()));
    let apart = found.iter().zip(expected).fold(0.0_f64, |apart, (a, b)| apart.max((a - b).abs()));
    if apart == 0.0 { 0.0 } else { apart / largest }
}

fn compare(m: &Mechanism, program: &Program, state: &State, expected: &Evaluation) -> Vec<String> {
    let inputs = Inputs {
        parameters: state.parameters.clone(),
        time: state.time,
        coordinates: state.coordinates.clone(),
        speeds: state.speeds.clone(),
        inputs: state.inputs.clone(),
        ..Inputs::default()
    };
    let evaluator = Evaluator::new(program);
    let get = |quantity: Quantity| match evaluator.evaluate(&inputs, &[quantity]) {
        Ok(mut arrays) => arrays.remove(0).values,
        Err(error) => panic!("{} {quantity:?}: {error}", m.name),
    };
    let mut wrong = Vec::new();
    let mut hold = |what: String, found: &[f64], expected: &[f64], scale: f64| {
        let off = off(found, expected, scale);
        if off > 1e-9 {
            wrong.push(format!("{} {what} is off by {off:.1e}: {found:?} {expected:?}", m.name));
        }
    };
    hold("mass matrix".into(), &get(Quantity::MassMatrix), &expected.mass_matrix.concat(), 0.0);
    hold("forcing".into(), &get(Quantity::Forcing), &expected.forcing, 1e-9);
    hold("kinetic energy".into(), &get(Quantity::KineticEnergy), &[expected.kinetic_energy], 0.0);
    if program.output(Quantity::PotentialEnergy).is_some() {
        let stored = expected.potential_energy.expect("heights that the derivation knows");
        hold("potential energy".into(), &get(Quantity::PotentialEnergy), &[stored], 1e-3);
    }
    if !m.coordinates.is_empty() {
        hold("rates".into(), &get(Quantity::CoordinateRates), &expected.rates, 0.0);
    }
    for (i, velocity) in expected.velocities.iter().enumerate() {
        let quantity = Quantity::Point(i as u32, PointQuantity::Velocity);
        if program.output(quantity).is_some() {
            hold(format!("velocity of {}", m.points[i].name), &get(quantity), velocity, 1e-3);
        }
    }
    for (i, contact) in expected.contacts.iter().enumerate() {
        let of = |quantity| get(Quantity::Contact(i as u32, quantity));
        let name = &m.contacts[i].name;
        let axes = [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second].map(of);
        let along =
            |v: &[f64; 3]| axes.iter().map(|n| (0..3).map(|k| n[k] * v[k]).sum()).collect::<Vec<f64>>();
        hold(format!("normal of {name}"), &axes[0], &contact.normal, 0.0);
        hold(format!("velocity of {name}"), &of(ContactQuantity::Velocity), &along(&contact.velocity), 1e-3);
        if let Some(gap) = contact.gap {
            hold(format!("gap of {name}"), &of(ContactQuantity::Gap), &[gap], 1e-6);
        }
    }
    wrong
}

#[test]
fn they_are_accepted_derived_and_the_same_on_both_roads() {
    let folder = tempfile::tempdir().unwrap();
    let mut names = Vec::new();
    let mut said = String::new();
    for entry in std::fs::read_dir(root().join("tests/data/unusual")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "mech") {
            continue;
        }
        let source = files::model(&path);
        let checked = check(&source);
        let others: Vec<_> = checked.diagnostics.iter().filter(|d| d.code != NO_GAP).cloned().collect();
        said += &render(&others, &source);
        let copy = folder.path().join(path.file_name().unwrap());
        std::fs::copy(&path, &copy).unwrap();
        names.push((copy, checked.mechanism));
    }
    assert!(said.trim().is_empty(), "{said}");
    assert!(names.len() >= 25, "{}", names.len());
    let derived = hodograph(&["derive", folder.path().to_str().unwrap()], "");
    assert_eq!((derived.code, derived.stderr.contains("warning")), (0, false), "{}", derived.stderr);
    let mut wrong = Vec::new();
    for (path, mechanism) in names {
        let m = mechanism.unwrap();
        let kept = std::fs::read_to_string(path.with_extension("derivation")).unwrap();
        let program = artifact::decode(&kept).unwrap().program;
        let mut tried = 0;
        for seed in 1..6 {
            let Some(state) = near(&m, seed) else { continue };
            let expected =
                numeric::evaluate(&m, &state).unwrap_or_else(|error| panic!("{}: {error}", m.name));
            wrong.extend(compare(&m, &program, &state, &expected));
            tried += 1;
        }
        if tried < 3 {
            wrong.push(format!("{} at {tried} states only", m.name));
        }
        let run = hodograph(&["eval", path.to_str().unwrap()], "");
        if run.code != 0 {
            wrong.push(format!("{}: {}{}", m.name, run.stdout, run.stderr));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
