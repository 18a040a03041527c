//! Derivatives by the values of sampled inputs.

use hodograph::{Law, State};
use hodograph_gradients::{Adjoint, By, GradientError, differentiate};
use hodograph_simulation::{Drive, Options, Samples, Simulation};
use nalgebra::DVector;

use crate::common::{compare, options, read};

const PERIOD: f64 = 0.05;

fn table(values: &[Vec<f64>]) -> Options {
    let drive = Drive::Table(Samples { period: PERIOD, values: values.to_vec().into() });
    Options { drive, ..options(0.9, 0.0, Law::Newton) }
}

/// A hopper lands, stands and leaves, while the torque at its hip and the length of its spring change every 50 ms.
#[test]
fn a_hopper_follows_a_table_of_inputs() {
    let mechanism = read("simulation/models/hopper.mech");
    let values: Vec<Vec<f64>> = [0.3, -0.5, 0.8, 0.1, -0.6, 0.4, -0.2]
        .iter()
        .zip([0.6, 0.605, 0.6, 0.62, 0.63, 0.61, 0.6])
        .map(|(torque, rest)| vec![*torque, rest])
        .collect();
    let (q, u) = ([0.0, 0.68, 0.05, -0.04, 0.6], [0.2, 0.0, 0.1, 0.0, 0.0]);
    let start = State { time: 0.3, coordinates: &q, speeds: &u, inputs: &[0.0, 0.6] };
    let times = [0.37, 0.55, 0.75];
    let samples = (0..values.len()).flat_map(|row| [0, 1].map(|input| By::Sample { input, row }));
    let mut by: Vec<By> = samples.collect();
    by.extend([By::Input(0), By::Input(1), By::Speed(0)]);
    let forwards = differentiate(&mechanism, &start, table(&values), &by, &times).unwrap();
    assert!(forwards.undefined.is_none(), "{:?}", forwards.undefined);
    let names: Vec<&str> = forwards.events.iter().map(|event| event.event.kind.name()).collect();
    assert!(names.contains(&"collision") && names.contains(&"lift_off"), "{names:?}");
    compare(&forwards, &Adjoint::new(&mechanism, &start, table(&values), &by, &times).unwrap());
    let end = |values: &[Vec<f64>], until: f64| {
        let mut simulation = Simulation::new(&mechanism, &start, table(values)).unwrap();
        simulation.advance_to(until).unwrap();
        DVector::from_vec([simulation.coordinates(), simulation.speeds()].concat())
    };
    for sample in &forwards.samples {
        let exact = sample.derivative.as_ref().unwrap();
        let size = exact.amax();
        for row in 0..values.len() {
            for input in 0..2 {
                let column = exact.column(2 * row + input).into_owned();
                // A row has no effect before it begins.
                if 0.3 + PERIOD * row as f64 >= sample.time {
                    assert_eq!(column.amax(), 0.0);
                    continue;
                }
                let central = |h: f64| {
                    let at = |h: f64| {
                        let mut values = values.clone();
                        values[row][input] += h;
                        end(&values, sample.time)
                    };
                    (at(h) - at(-h)) / (2.0 * h)
                };
                let h = if input == 0 { 1e-3 } else { 1e-5 };
                let differences = (central(h) * 4.0 - central(2.0 * h)) / 3.0;
                let off = (&column - &differences).amax() / size;
                assert!(off < 1e-7, "{row} {input} at {}: {off:e}", sample.time);
            }
        }
        // An input is the sum of its samples.
        for input in 0..2 {
            let of_samples: DVector<f64> =
                (0..values.len()).map(|row| exact.column(2 * row + input).into_owned()).sum();
            assert!((exact.column(2 * values.len() + input) - of_samples).amax() < 1e-9 * size);
        }
    }
}

#[test]
fn samples_have_names_and_must_exist() {
    let mechanism = read("simulation/models/hopper.mech");
    let by = By::Sample { input: 1, row: 12 };
    assert_eq!(By::named(&mechanism, "rest[12]"), Ok(by));
    assert_eq!(by.name(&mechanism), "rest[12]");
    let start =
        State { time: 0.0, coordinates: &[0.0, 1.0, 0.0, 0.0, 0.6], speeds: &[0.0; 5], inputs: &[0.0, 0.6] };
    let values = vec![vec![0.0, 0.6]; 3];
    let refused = |options: Options| {
        matches!(
            differentiate(&mechanism, &start, options, &[By::Sample { input: 0, row: 3 }], &[0.1]),
            Err(GradientError::BadRequest(_))
        )
    };
    assert!(refused(table(&values)) && refused(options(0.5, 0.5, Law::Newton)));
    // Tables without rows or with short ones are refused by the simulation.
    for values in [vec![], vec![vec![0.0, 0.6], vec![0.1]]] {
        assert!(Simulation::new(&mechanism, &start, table(&values)).is_err());
    }
}
