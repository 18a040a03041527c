//! Contacts that solve an equation by iteration, at random poses and with random sizes: the derived program refuses none
//! that the model itself, evaluated in numbers, has an answer for, and both have the same.

use std::path::Path;

use hodograph::{ComponentKind, Contacts, Mechanism, State};
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};
use hodograph_random::Random;

/// Looks at poses within a distance from the origin. Lengths are up to three times as large or small as the model says.
/// Returns how many poses have an answer.
fn same_at(model: &str, reach: f64, poses: usize) -> usize {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(model);
    let derived = InterpretedMechanism::read(&path).unwrap_or_else(|error| panic!("{model}: {error}"));
    let mut random = Random::new(11);
    let mut answered = 0;
    for pose in 0..poses {
        let mut values = derived.all_parameters().to_vec();
        for (index, value) in values.iter_mut().enumerate() {
            let unit = derived.component(ComponentKind::Parameter, index).unwrap().unit;
            if unit == "m" {
                *value *= 3f64.powf(random.between(-1.0, 1.0));
            }
        }
        let (parts, program) = (derived.model().clone(), derived.program().clone());
        let Ok(by_program) = InterpretedMechanism::with_parameters(parts.clone(), program, &values) else {
            continue;
        };
        let Ok(by_model) = NumericMechanism::with_parameters(parts, &values) else { continue };
        let mut q: Vec<f64> = (0..3).map(|_| random.between(-reach, reach)).collect();
        q.extend((0..4).map(|_| random.between(-1.0, 1.0)));
        by_program.normalise(&mut q).unwrap();
        let u: Vec<f64> = (0..6).map(|_| random.between(-1.0, 1.0)).collect();
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
        let Ok(Some(gap)) = by_model.gap(0, &state) else { continue };
        answered += 1;
        let found = by_program.gap(0, &state);
        let told = format!("{model}, pose {pose} {values:?} {q:?}: {gap} {found:?}");
        assert!(found.is_ok_and(|found| found.is_some_and(|found| (found - gap).abs() < 1e-11)), "{told}");
        let [one, other] = [by_model.contact_velocity(0, &state), by_program.contact_velocity(0, &state)];
        let (one, other) = (one.unwrap(), other.unwrap_or_else(|error| panic!("{told}: {error}")));
        // the tangential axes may be others
        let same = (one.x - other.x).abs() < 1e-9 && (one.norm() - other.norm()).abs() < 1e-9;
        assert!(same, "{told}: {one} {other}");
    }
    answered
}

#[test]
fn programs_refuse_no_pose_that_has_an_answer() {
    for (model, reach, least) in [
        ("simulation/models/egg_on_egg.mech", 1.0, 100),
        ("models/shapes/tyre_on_hills.mech", 0.6, 30),
        ("models/shapes/ball_in_bowl.mech", 0.5, 30),
        ("models/shapes/marble_in_channel.mech", 0.5, 30),
    ] {
        let answered = same_at(model, reach, 150);
        println!("{model}: {answered} of 150 poses");
        assert!(answered >= least, "{model}: {answered}");
    }
}
