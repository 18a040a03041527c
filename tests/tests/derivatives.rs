//! Derivatives of the dynamics, each computed in several ways: by the matrices of the emitted modules, by
//! running these modules on numbers that carry derivatives, and by the directional derivative of the
//! accelerations.

use crate::common::emitted::{Emitted, emitted};
use crate::common::random::samples;
use crate::common::{Model, root};
use hodograph_generator::program::{ContactQuantity as C, Inputs, Quantity as Q};
use hodograph_generator::rust_names::snake_case;
use nalgebra::{DMatrix, DVector};

/// The states of each model.
const STATES: usize = 4;

/// Off by at most this part of the largest entry.
const BOUND: f64 = 1e-12;

/// The directions of the derivatives: independent coordinates, with what follows, independent speeds, named
/// inputs.
fn directions(module: &dyn Emitted, model: &Model, at: &Inputs) -> Vec<Inputs> {
    let m = &model.mechanism;
    let none = || Inputs {
        coordinates: vec![0.0; m.coordinates.len()],
        speeds: vec![0.0; model.freedom()],
        inputs: vec![0.0; m.inputs.len()],
        ..Default::default()
    };
    let along = |change: &dyn Fn(&mut Inputs)| {
        let mut direction = none();
        change(&mut direction);
        direction
    };
    let (dependent, leaders): (Vec<usize>, Vec<usize>) =
        (0..m.coordinates.len()).partition(|&index| m.coordinates[index].dependent);
    let mut all = Vec::new();
    for leader in leaders {
        let mut direction = along(&|direction| direction.coordinates[leader] = 1.0);
        if !dependent.is_empty() {
            // The configuration equations stay fulfilled.
            let residual = |direction: &Inputs| {
                DVector::from_vec(module.along("configuration_residual", at, direction).expect("a loop"))
            };
            let columns: Vec<DVector<f64>> = dependent
                .iter()
                .map(|&index| residual(&along(&|direction| direction.coordinates[index] = 1.0)))
                .collect();
            let solved = DMatrix::from_columns(&columns).lu().solve(&-residual(&direction));
            for (&index, rate) in dependent.iter().zip(solved.expect("a regular state").iter()) {
                direction.coordinates[index] = *rate;
            }
        }
        all.push(direction);
    }
    all.extend((0..model.freedom()).map(|index| along(&|direction| direction.speeds[index] = 1.0)));
    all.extend((0..m.inputs.len()).map(|index| along(&|direction| direction.inputs[index] = 1.0)));
    all
}

/// The largest difference of two lists of columns, as a part of the largest entry of the first.
fn off(expected: &[Vec<f64>], found: &[Vec<f64>]) -> f64 {
    assert_eq!(expected.len(), found.len());
    let size = expected.iter().flatten().fold(1.0_f64, |size, entry| size.max(entry.abs()));
    let pairs = expected.iter().zip(found).flat_map(|(a, b)| {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b)
    });
    pairs.fold(0.0_f64, |off, (a, b)| off.max((a - b).abs() / size)).max(f64::from(u8::from(size.is_nan())))
}

/// The columns of a matrix that is stored by rows.
fn columns(matrix: &[f64], count: usize) -> Vec<Vec<f64>> {
    (0..count).map(|column| matrix.iter().skip(column).step_by(count).copied().collect()).collect()
}

#[test]
fn matrices_are_what_numbers_with_derivatives_say() {
    let mut worst: Vec<(f64, String)> = Vec::new();
    for module in emitted() {
        let model = Model::load(module.name());
        for sample in samples(&model, STATES) {
            let at = &sample.inputs;
            let call = |routine: &str| {
                let answer =
                    module.call(routine, at).unwrap_or_else(|| panic!("{}: no {routine}", model.name));
                answer.expect("a regular state")
            };
            let directions = directions(&*module, &model, at);
            for routine in ["accelerations", "inverse_dynamics"] {
                let found = columns(&call(&format!("{routine}_derivatives")), 1 + directions.len());
                let along = |direction| module.along(routine, at, direction).expect("the routine");
                let expected: Vec<Vec<f64>> =
                    std::iter::once(call(routine)).chain(directions.iter().map(along)).collect();
                let value = off(&expected[..1], &found[..1]);
                let slopes = off(&expected[1..], &found[1..]);
                worst
                    .push((value.max(slopes), format!("{}: {routine} {value:.1e} {slopes:.1e}", model.name)));
            }
            let independent: Vec<usize> = (0..model.mechanism.coordinates.len())
                .filter(|&index| !model.mechanism.coordinates[index].dependent)
                .collect();
            let rates: Vec<Vec<f64>> = directions
                .iter()
                .map(|direction| {
                    let all = module.along("coordinate_rates", at, direction).expect("the routine");
                    independent.iter().map(|&index| all[index]).collect()
                })
                .collect();
            let found = columns(&call("coordinate_rates_derivatives"), directions.len());
            let rates = off(&rates, &found);
            worst.push((rates, format!("{}: rates {rates:.1e}", model.name)));
        }
    }
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, text) in worst.iter().take(6) {
        println!("{text}");
    }
    assert_eq!(worst.len(), 3 * STATES * emitted().len());
    assert!(worst[0].0 <= BOUND, "{}", worst[0].1);
}

/// The same by the interpreter for models with fixed parameters, which have no module here: dual numbers of
/// the derivation itself.
#[test]
fn the_derivative_along_a_direction_is_a_sum_of_columns() {
    for name in ["dpend", "panda"] {
        let model = Model::load(root().join("tests/models").join(name).to_str().expect("a path"));
        for sample in samples(&model, STATES) {
            let states = model.mechanism.independent_states();
            let count = states + model.mechanism.inputs.len();
            let tangent: Vec<f64> = (0..count).map(|index| 1.0 - 0.3 * index as f64).collect();
            let at = Inputs { tangent: tangent.clone(), ..sample.inputs };
            let matrix = model.get(&at, Q::AccelerationsDerivatives).values;
            let freedom = model.freedom();
            let found: Vec<f64> = (0..freedom)
                .map(|row| {
                    let slopes = &matrix[row * (1 + count) + 1..(row + 1) * (1 + count)];
                    slopes.iter().zip(&tangent).map(|(slope, rate)| slope * rate).sum()
                })
                .collect();
            let expected = model.get(&at, Q::StateTangent).values[states - freedom..].to_vec();
            let off = off(&[expected], &[found]);
            assert!(off <= BOUND, "{name} off by {off:e}");
        }
    }
}

/// Of every contact: each column of its derivatives is its derivative along one direction, and the first
/// column is the value.
#[test]
fn derivatives_of_contacts_are_their_derivatives_along_each_direction() {
    let (mut contacts, mut worst) = (0, 0.0_f64);
    let simulated = ["../simulation/models/biped", "../simulation/models/tumbling_box"].map(Model::load);
    for model in crate::common::models().into_iter().chain(simulated) {
        let m = &model.mechanism;
        let count = m.independent_states() + m.inputs.len();
        for contact in 0..m.contacts.len() as u32 {
            let of = |quantity| Q::Contact(contact, quantity);
            assert_eq!(
                model.program.output(of(C::Tangent)).is_some(),
                model.program.output(of(C::Derivatives)).is_some()
            );
            if model.program.output(of(C::Derivatives)).is_none() {
                continue;
            }
            contacts += 1;
            for sample in samples(&model, 2) {
                let found = model.get(&sample.inputs, of(C::Derivatives));
                let found = columns(&found.values, 1 + count);
                let value = [C::Velocity, C::Reduced, C::Response, C::Gap]
                    .map(|quantity| model.get(&sample.inputs, of(quantity)).values);
                let along = (0..count).map(|direction| {
                    let mut at = sample.inputs.clone();
                    at.tangent = vec![0.0; count];
                    at.tangent[direction] = 1.0;
                    model.get(&at, of(C::Tangent)).values
                });
                let off_value = off(&[value.concat()], &found[..1]);
                let off_columns = off(&along.collect::<Vec<_>>(), &found[1..]);
                worst = worst.max(off_value).max(off_columns);
                assert!(
                    off_value < BOUND && off_columns < BOUND,
                    "{} {off_value:e} {off_columns:e}",
                    model.name
                );
            }
        }
    }
    println!("{contacts} contacts, off by at most {worst:e}");
    assert!(contacts > 30, "{contacts}");
}

/// The method of a module gives them in its record.
#[test]
fn the_record_of_a_contact_holds_its_derivatives() {
    use hodograph_models::planar_double_pendulum::{Coordinates, PlanarDoublePendulum, Speeds};
    let pendulum = PlanarDoublePendulum::<f64>::default();
    let (q, u) = (Coordinates::from([0.3, -0.5]), Speeds::from([0.7, 1.1]));
    let model = Model::load("planar_double_pendulum");
    let contact = snake_case(&model.mechanism.contacts[0].name);
    assert_eq!(contact, "tip_wall");
    let all = pendulum.contact_derivatives_tip_wall(&q, &u).expect("a regular state");
    let state = pendulum.contact_state_tip_wall(&q, &u).expect("a regular state");
    assert!((all.velocity - state.velocity).amax() < 1e-14);
    let (ours, its): ([f64; 6], [f64; 6]) = (all.reduced.into(), state.reduced.into());
    assert!(off(&[its.to_vec()], &[ours.to_vec()]) < BOUND);
    assert_eq!(all.gap.is_some(), state.gap.is_some());
    for direction in 0..4 {
        let mut tangent = [0.0; 4];
        tangent[direction] = 1.0;
        let along = pendulum.contact_tangent_tip_wall(&q, &u, &tangent).expect("a regular state");
        let velocity = if direction < 2 {
            all.velocity_by_coordinates.column(direction)
        } else {
            all.velocity_by_speeds.column(direction - 2)
        };
        let mut column: Vec<f64> = velocity.iter().copied().collect();
        if direction < 2 {
            column.extend(all.reduced_by_coordinates.column(direction).iter());
            column.extend(all.response_by_coordinates[direction].transpose().iter());
            column.extend(all.gap_by_coordinates.map(|by| by[direction]));
        } else {
            column.resize(along.len(), 0.0);
        }
        assert!(off(&[along.as_slice().to_vec()], &[column]) < BOUND, "{direction}");
    }
}
