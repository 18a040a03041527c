//! A driven hopper beside its equations in numbers of twice the digits: derivatives of a motion of many events, and
//! multipliers of its periodic motion.

use hodograph::{ComponentKind, Law, Mechanism, State};
use hodograph_gradients::{By, Periodic, Return, differentiate, find_orbit};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use nalgebra::{Complex, DMatrix};

use crate::common::{options, read};
use crate::doubled_hopper::{Hopper, Variable, number};

const MU: f64 = 0.35;

fn doubled(mechanism: &InterpretedMechanism) -> Hopper {
    let mut parameters = [0.0; 9];
    assert_eq!(mechanism.count(ComponentKind::Parameter), 9);
    mechanism.parameter_values(&mut parameters).unwrap();
    Hopper { parameters: parameters.map(number), mu: number(MU) }
}

fn precise() -> Options {
    Options { relative_tolerance: 1e-13, absolute_tolerance: 1e-15, ..options(MU, 0.0, Law::Poisson) }
}

/// Hops, slips and sticks: twenty events, by the start, by parameters and by mu.
#[test]
fn twenty_events_beside_doubled_digits() {
    let mechanism = read("driven_hopper.mech");
    let state = [0.0, 0.004, 0.29, 0.1, 0.2, -0.1];
    let (until, variables) = (
        1.06,
        [
            (By::Coordinate(1), Variable::State(1)),
            (By::Coordinate(2), Variable::State(2)),
            (By::Speed(0), Variable::State(3)),
            (By::Speed(1), Variable::State(4)),
            (By::Speed(2), Variable::State(5)),
            (By::Parameter(0), Variable::Parameter(0)),
            (By::Parameter(4), Variable::Parameter(4)),
            (By::Parameter(5), Variable::Parameter(5)),
            (By::Parameter(7), Variable::Parameter(7)),
            (By::Friction(None), Variable::Friction),
        ],
    );
    let (by, of): (Vec<By>, Vec<Variable>) = variables.into_iter().unzip();
    let start = State { time: 0.0, coordinates: &state[..3], speeds: &state[3..], inputs: &[] };
    let found = differentiate(&mechanism, &start, precise(), &by, &[until]).unwrap();
    assert!(found.undefined.is_none(), "{:?}", found.undefined);
    let hopper = doubled(&mechanism);
    let (end, events) = hopper.motion(&state.map(number), number(until));
    let names: Vec<&str> = events.iter().map(|(_, name)| *name).collect();
    // `contact` says in which mode a collision ends.
    let own: Vec<_> = found.events.iter().filter(|event| event.event.kind.name() != "contact").collect();
    assert_eq!(own.iter().map(|event| event.event.kind.name()).collect::<Vec<_>>(), names);
    assert!(names.len() >= 20, "{} events", names.len());
    let sample = &found.samples[0];
    let derivative = sample.derivative.as_ref().unwrap();
    let exact = hopper.derivatives(&state.map(number), number(until), &of);
    let mut worst = [0.0_f64; 4];
    for (found, exact) in sample.state.iter().zip(&end) {
        worst[0] = worst[0].max((found - exact.rounded()).abs());
    }
    for (found, (exact, _)) in own.iter().zip(&events) {
        worst[1] = worst[1].max((found.event.time - exact.rounded()).abs());
    }
    for (column, (of_state, of_times)) in exact.iter().enumerate() {
        let size = |numbers: &[f64]| numbers.iter().fold(1e-12_f64, |size, number| size.max(number.abs()));
        for (row, exact) in of_state.iter().enumerate() {
            worst[2] = worst[2].max((derivative[(row, column)] - exact).abs() / size(of_state));
        }
        for (event, exact) in own.iter().zip(of_times) {
            let time = event.time.as_ref().unwrap()[column];
            worst[3] = worst[3].max((time - exact).abs() / size(of_times));
        }
    }
    println!(
        "{} events: state {:e}, times {:e}, derivatives of the state {:e}, of times {:e}",
        names.len(),
        worst[0],
        worst[1],
        worst[2],
        worst[3]
    );
    assert!(worst[2] < 1e-10 && worst[3] < 1e-10, "{worst:?}");
}

/// One hop for each period of the drive.
#[test]
fn a_driven_hopper_hops_periodically() {
    let mechanism = read("driven_hopper.mech");
    let period = 2.0 * std::f64::consts::PI / 30.0;
    let start = State { time: 0.0, coordinates: &[0.0, 0.0, 0.28], speeds: &[0.0; 3], inputs: &[] };
    let hopper = doubled(&mechanism);
    for segments in [1, 3] {
        let periodic = Periodic {
            returns: Return::After(period),
            reset: vec![0],
            symmetry: Vec::new(),
            longest: 1.0,
            segments,
        };
        let orbit = find_orbit(&mechanism, &start, &precise(), &periodic, &[]).unwrap();
        let state: [f64; 6] = orbit.state.clone().try_into().unwrap();
        // Newton's method for the length of the leg and its rate, in doubled digits.
        let mut state = state.map(number);
        for _ in 0..4 {
            let (end, _) = hopper.motion(&state, number(period));
            let by = hopper.derivatives(&state, number(period), &[Variable::State(2), Variable::State(5)]);
            let matrix = DMatrix::from_fn(2, 2, |row, column| {
                by[column].0[[2, 5][row]] - f64::from(u8::from(row == column))
            });
            let inverse = matrix.try_inverse().unwrap();
            let off = [end[2] - state[2], end[5] - state[5]];
            for (row, place) in [2, 5].into_iter().enumerate() {
                state[place] =
                    state[place] - (number(inverse[(row, 0)]) * off[0] + number(inverse[(row, 1)]) * off[1]);
            }
        }
        let (_, events) = hopper.motion(&state, number(period));
        println!(
            "{:?} {:?}",
            orbit.state,
            events.iter().map(|(t, name)| (t.rounded(), *name)).collect::<Vec<_>>()
        );
        for (place, exact) in [(2, state[2]), (5, state[5])] {
            let off = (orbit.state[place] - exact.rounded()).abs();
            assert!(off < 1e-13, "{place}: {off:e}");
        }
        let by = hopper.derivatives(&state, number(period), &[Variable::State(2), Variable::State(5)]);
        let exact = DMatrix::from_fn(2, 2, |row, column| by[column].0[[2, 5][row]]);
        let mut exact: Vec<Complex<f64>> = exact.complex_eigenvalues().iter().copied().collect();
        exact.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        println!("{:?} {exact:?}", orbit.multipliers);
        for (found, exact) in orbit.multipliers.iter().zip(&exact) {
            let off = (found - exact).norm().min((found - exact.conj()).norm());
            assert!(off < 1e-12, "{found} instead of {exact}: {off:e}");
        }
        assert!(orbit.multipliers[2..].iter().all(|other| other.norm() < 1e-12) && orbit.is_stable());
        assert_eq!(orbit.nodes.len(), segments);
    }
}
