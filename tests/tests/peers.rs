//! Imported robots agree with another program (`tests/data/peers/expected.json`), as interpreted programs and
//! as emitted code.
//!
//! `tests/models/<robot>.mech` is what `hodograph import tests/data/peers/<robot>.urdf --contact ee` writes.

use crate::common::{Model, difference, numbers};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::{ContactQuantity, Quantity};
use serde_json::Value;

#[allow(missing_docs)]
mod emitted {
    hodograph::mechanism!("models/dpend.mech");
    hodograph::mechanism!("models/panda.mech");
}

/// What a robot answers in a state; matrices by rows.
struct Answers {
    mass: Vec<f64>,
    forward: Vec<f64>,
    inverse: Vec<f64>,
    /// contact basis: normal, first and second along N.x, N.y, N.z
    basis: [Vec<f64>; 3],
    /// along the contact basis
    partials: Vec<f64>,
    /// nn, n1, n2, 11, 12, 22
    reduced: [f64; 6],
}

/// The states of a robot.
fn states(robot: &str) -> Vec<Value> {
    let text = include_str!("../data/peers/expected.json");
    let all: Value = serde_json::from_str(text).unwrap();
    all[robot]["states"].as_array().unwrap().clone()
}

/// Holds answers to the reference numbers, relative to the largest of each kind.
fn check(robot: &str, how: &str, state: &Value, answers: &Answers) {
    let Answers { basis, partials, reduced: [nn, n1, n2, aa, ab, bb], .. } = answers;
    let joints = partials.len() / 3;
    let matrix = [[nn, n1, n2], [n1, aa, ab], [n2, ab, bb]];
    // Along the world's axes.
    let jacobian = (0..3 * joints)
        .map(|at| (0..3).map(|k| basis[k][at / joints] * partials[k * joints + at % joints]).sum());
    let contact = (0..9)
        .map(|at| (0..9).map(|k| basis[k / 3][at / 3] * matrix[k / 3][k % 3] * basis[k % 3][at % 3]).sum());
    let pairs = [
        ("M", answers.mass.clone()),
        ("forward_dynamics", answers.forward.clone()),
        ("inverse_dynamics", answers.inverse.clone()),
        ("J", jacobian.collect()),
        ("contact_matrix", contact.collect()),
    ];
    for (what, found) in pairs {
        let error = difference(&found, &numbers(&state[what]));
        assert!(error <= 1e-10, "{robot} {how}, {what}: off by {error:e}");
    }
}

/// Derivatives of accelerations and of inverse dynamics, by rows.
struct Slopes {
    by_coordinates: Vec<f64>,
    by_speeds: Vec<f64>,
    by_inputs: Vec<f64>,
}

/// Holds derivatives to the reference numbers, relative to the largest entry of each matrix; the largest
/// difference.
fn check_slopes(robot: &str, how: &str, number: usize, [forward, inverse]: [Slopes; 2]) -> f64 {
    let text = include_str!("../data/peers/derivatives.json");
    let all: Value = serde_json::from_str(text).unwrap();
    let expected = &all[robot][number];
    let pairs = [
        ("forward_by_q", forward.by_coordinates),
        ("forward_by_v", forward.by_speeds),
        ("forward_by_tau", forward.by_inputs),
        ("inverse_by_q", inverse.by_coordinates),
        ("inverse_by_v", inverse.by_speeds),
    ];
    let mut worst = 0.0_f64;
    for (what, found) in pairs {
        let rows = expected[what].as_array().unwrap();
        let error = difference(&found, &rows.iter().flat_map(numbers).collect::<Vec<f64>>());
        assert!(error <= 1e-11, "{robot} {how}, {what}: off by {error:e}");
        worst = worst.max(error);
    }
    worst
}

/// The derivatives that the derived program gives: of the accelerations with inputs, of the inverse dynamics
/// without.
fn interpreted_slopes(model: &Model, state: &Value) -> [Slopes; 2] {
    let [q, v, a, tau] = ["q", "v", "a", "tau"].map(|key| numbers(&state[key]));
    let joints = q.len();
    let zeros = vec![0.0; tau.len()];
    let free = Inputs { coordinates: q, speeds: v, accelerations: a, inputs: zeros, ..model.initial() };
    let driven = Inputs { inputs: tau, ..free.clone() };
    let asked =
        [(&driven, Quantity::AccelerationsDerivatives), (&free, Quantity::InverseDynamicsDerivatives)];
    asked.map(|(at, quantity)| {
        let rows = model.get(at, quantity).values;
        let block = |first: usize| {
            let rows = rows.chunks_exact(1 + 3 * joints);
            rows.flat_map(|row| row[1 + first * joints..][..joints].to_vec()).collect()
        };
        Slopes { by_coordinates: block(0), by_speeds: block(1), by_inputs: block(2) }
    })
}

/// What the derived program answers.
fn interpreted(model: &Model, state: &Value) -> Answers {
    let [q, v, a, tau] = ["q", "v", "a", "tau"].map(|key| numbers(&state[key]));
    let zeros = vec![0.0; tau.len()];
    let free = Inputs { coordinates: q, speeds: v, accelerations: a, inputs: zeros, ..model.initial() };
    let driven = Inputs { inputs: tau, ..free.clone() };
    let contact = |quantity| model.get(&free, Quantity::Contact(0, quantity)).values;
    Answers {
        mass: model.get(&free, Quantity::MassMatrix).values,
        forward: model.get(&driven, Quantity::Accelerations).values,
        inverse: model.get(&free, Quantity::InverseDynamics).values,
        basis: [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second].map(contact),
        partials: contact(ContactQuantity::PartialVelocities),
        reduced: contact(ContactQuantity::Reduced).try_into().unwrap(),
    }
}

macro_rules! robot_agrees {
    ($name:ident, $module:ident, $mechanism:ident, $joints:literal) => {
        #[test]
        fn $name() {
            use emitted::$module::{Coordinates, Inputs, Speeds, $mechanism};
            let robot = stringify!($module);
            let model = Model::load(&format!("../tests/models/{robot}"));
            let machine = $mechanism::<f64>::default();
            let mut worst = 0.0_f64;
            for (number, state) in states(robot).into_iter().enumerate() {
                check(robot, "interpreted", &state, &interpreted(&model, &state));
                let slopes = interpreted_slopes(&model, &state);
                worst = worst.max(check_slopes(robot, "interpreted", number, slopes));
                let [q, v, a, tau] = ["q", "v", "a", "tau"]
                    .map(|key| <[f64; $joints]>::try_from(numbers(&state[key])).unwrap());
                let (q, u, a, tau) =
                    (Coordinates::from(q), Speeds::from(v), Speeds::from(a), Inputs::from(tau));
                let basis = machine.contact_basis_contact_ee(&q).unwrap();
                let (partials, reduced) = machine.contact_matrices_contact_ee(&q).unwrap();
                let free = Inputs::default();
                let emitted = Answers {
                    mass: machine.mass_matrix(&q).unwrap().as_slice().to_vec(),
                    forward: <[f64; $joints]>::from(machine.accelerations(&q, &u, &tau).unwrap()).to_vec(),
                    inverse: machine.inverse_dynamics(&q, &u, &a, &free).unwrap().as_slice().to_vec(),
                    basis: [0, 1, 2].map(|axis| basis.column(axis).iter().copied().collect()),
                    partials: partials.transpose().as_slice().to_vec(),
                    reduced: reduced.into(),
                };
                check(robot, "emitted", &state, &emitted);
                let slopes = [
                    machine.accelerations_derivatives(&q, &u, &tau).unwrap(),
                    machine.inverse_dynamics_derivatives(&q, &u, &a, &free).unwrap(),
                ];
                let slopes = slopes.map(|slopes| Slopes {
                    by_coordinates: slopes.by_coordinates.transpose().as_slice().to_vec(),
                    by_speeds: slopes.by_speeds.transpose().as_slice().to_vec(),
                    by_inputs: slopes.by_inputs.transpose().as_slice().to_vec(),
                });
                worst = worst.max(check_slopes(robot, "emitted", number, slopes));
            }
            println!("{robot}: derivatives off by at most {worst:.1e}");
        }
    };
}

robot_agrees!(the_double_pendulum_agrees, dpend, Dpend, 2);
robot_agrees!(the_arm_agrees, panda, Panda, 7);
