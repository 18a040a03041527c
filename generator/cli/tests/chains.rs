//! Compares imported robots and long chains with the numeric evaluation of the model: mass matrix, forces,
//! accelerations and contacts at random states.
#![cfg(feature = "derive")]

use std::fmt::Write;
use std::path::Path;

use crate::common::{ALL_JOINTS, hodograph};
use hodograph_generator::files;
use hodograph_generator::interpret::Evaluator;
use hodograph_generator::model::mechanism::{Mechanism, Orientation};
use hodograph_generator::numeric::{self, State};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::Program;
use hodograph_generator::program::{ContactQuantity, Quantity};
use hodograph_generator::{artifact, check::check};
use nalgebra::{DMatrix, DVector};

/// Derives a model that stands in a folder.
fn derived(folder: &Path, text: &str) -> (Mechanism, Program) {
    let path = folder.join("model.mech");
    std::fs::write(&path, text).unwrap();
    let run = hodograph(&["derive", &path.display().to_string()], "");
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let kept = std::fs::read_to_string(path.with_extension("derivation")).unwrap();
    let mechanism = check(&files::model(&path)).mechanism.unwrap();
    (mechanism, artifact::decode(&kept).unwrap().program)
}

/// A state with every number between -1 and 1, quaternions of unit length.
fn random(m: &Mechanism, seed: u64) -> State {
    let mut bits = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut state = State::of(m);
    for list in [&mut state.coordinates, &mut state.speeds, &mut state.inputs] {
        list.iter_mut().for_each(|number| *number = next());
    }
    for frame in &m.frames {
        if let Orientation::Quaternion(ids) = &frame.orientation {
            let norm = ids.iter().map(|id| state.coordinates[id.0].powi(2)).sum::<f64>().sqrt();
            ids.iter().for_each(|id| state.coordinates[id.0] /= norm);
        }
    }
    state
}

fn close(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-9 * largest, "{what}: {a} is not {b}");
    }
}

/// Holds a program to the numeric evaluation at some states.
fn agrees(m: &Mechanism, program: &Program) {
    for seed in 1..4 {
        let state = random(m, seed);
        let expected = numeric::evaluate(m, &state).unwrap();
        let inputs = Inputs {
            parameters: state.parameters.clone(),
            coordinates: state.coordinates.clone(),
            speeds: state.speeds.clone(),
            inputs: state.inputs.clone(),
            ..Inputs::default()
        };
        let get = |quantity: Quantity| {
            Evaluator::new(program).evaluate(&inputs, &[quantity]).unwrap().remove(0).values
        };
        let mass = expected.mass_matrix.concat();
        close("mass matrix", &get(Quantity::MassMatrix), &mass);
        close("forcing", &get(Quantity::Forcing), &expected.forcing);
        let n = expected.forcing.len();
        let mass = DMatrix::from_row_slice(n, n, &mass);
        let accelerations = DVector::from_vec(get(Quantity::Accelerations));
        close("M u'", (&mass * accelerations).as_slice(), &expected.forcing);
        for (index, contact) in expected.contacts.iter().enumerate() {
            let of = |quantity| get(Quantity::Contact(index as u32, quantity));
            let basis = [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second].map(of);
            let along = |axis: usize, v: &[f64; 3]| (0..3).map(|i| basis[axis][i] * v[i]).sum::<f64>();
            let rows: Vec<f64> = (0..3)
                .flat_map(|axis| {
                    contact.partial_velocities.iter().map(move |v| along(axis, v)).collect::<Vec<_>>()
                })
                .collect();
            close("partial velocities", &of(ContactQuantity::PartialVelocities), &rows);
            let v = DMatrix::from_row_slice(3, n, &rows);
            let response = DMatrix::from_row_slice(n, 3, &of(ContactQuantity::Response));
            close("M (M^-1 V')", (&mass * &response).as_slice(), v.transpose().as_slice());
            let reduced = &v * response;
            let upper = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| reduced[at]);
            close("reduced matrix", &of(ContactQuantity::Reduced), &upper);
        }
    }
}

/// A chain in space, each joint across the one before; its tip strikes the ground, and two of its links
/// strike each other.
fn chain(links: usize) -> String {
    let list = |line: &dyn Fn(usize) -> String| (1..=links).map(line).collect::<String>();
    let mut text = "mechanism Chain;\nparameters { m: kg = 0.5, l: m = 0.3, g: m/s^2 = 9.81 }\n".to_owned();
    let axis = |k: usize| ["x", "y", "z"][k % 3];
    let before = |k: usize, first: &str, letter: &str| {
        if k == 1 { first.to_owned() } else { format!("{letter}{}", k - 1) }
    };
    let sections = [
        ("coordinates", list(&|k| format!("q{k}: rad, "))),
        ("speeds", list(&|k| format!("u{k}: rad/s, "))),
        ("frames", list(&|k| format!("A{k} = {}.rotate({}, q{k}); ", before(k, "N", "A"), axis(k)))),
        ("points", list(&|k| format!("P{k} = {} + l*A{k}.z + l/4*A{k}.x; ", before(k, "O", "P")))),
        (
            "bodies",
            list(&|k| {
                format!(
                    "B{k} {{ frame: A{k}, centre: P{k}, mass: m, inertia: [m*l^2/9, m*l^2/8, m*l^2/10] }}, "
                )
            }),
        ),
        ("loads", "gravity: -g*N.z;".to_owned()),
        (
            "contacts",
            format!(
                "ground {{ point: P{links} of B{links}, normal: N.z }}, \
                 own {{ point: P{links} of B{links}, against: P{} of B{}, normal: A1.x }}, \
                 link {{ point: P{links} of B{links}, against: B{}, normal: A2.y }}",
                links / 2,
                links / 2,
                links / 3
            ),
        ),
    ];
    for (title, body) in sections {
        let _ = writeln!(text, "{title} {{ {body} }}");
    }
    text
}

#[test]
fn long_chains_agree_are_not_taken_for_singular_and_cost_in_proportion_to_their_length() {
    let folder = tempfile::tempdir().unwrap();
    let mut costs = Vec::new();
    for links in [12, 18] {
        let (mechanism, program) = derived(folder.path(), &chain(links));
        agrees(&mechanism, &program);
        let contact = [ContactQuantity::PartialVelocities, ContactQuantity::Reduced];
        let of = |quantities: &[Quantity]| program.cost(quantities).evaluation().total();
        costs.push([
            of(&contact.map(|quantity| Quantity::Contact(0, quantity))),
            of(&[Quantity::Accelerations]),
            of(&[Quantity::InverseDynamics]),
        ]);
    }
    for (short, long) in costs[0].iter().zip(&costs[1]) {
        assert!(long * 10 < short * 18, "half as many links again: {short} operations, then {long}");
    }
}

#[test]
fn imported_joints_of_every_kind_agree() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("all.urdf");
    std::fs::write(&urdf, ALL_JOINTS).unwrap();
    let run =
        hodograph(&["import", &urdf.display().to_string(), "--contact", "hook", "--contact", "bird"], "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (mechanism, program) = derived(folder.path(), &run.stdout);
    agrees(&mechanism, &program);
}

/// The bounds of definitions that are squared in others are exact numbers with ever more digits: from some on
/// they are measured by themselves, and the program is the same to the numeric evaluation.
#[test]
fn definitions_that_are_squared_agree() {
    let folder = tempfile::tempdir().unwrap();
    for (count, step) in [(3, "2*{a}^2 - 1"), (12, "{a}*{a}/2 + {a}/3"), (39, "{a}*{a}/2 + {a}/3")] {
        let chain: String =
            (0..count).map(|i| format!("a{} = {}; ", i + 1, step.replace("{a}", &format!("a{i}")))).collect();
        let text = format!(
            "mechanism Squares; parameters {{ m: kg = 1, l: m = 1, g: m/s^2 = 9.81 }} coordinates {{ q1: rad = 0.3 }} \
             speeds {{ u1: rad/s = 1 }} definitions {{ a0 = cos(q1); {chain} }} \
             points {{ P = O + l*(q1 + 0.1*a{count})*N.x; }} particles {{ A {{ point: P, mass: m }} }} \
             loads {{ gravity: -g*N.x; }}"
        );
        let (mechanism, program) = derived(folder.path(), &text);
        agrees(&mechanism, &program);
    }
}

/// A divisor made of values that square one another is not taken for zero: bounds of their terms grow like the squares,
/// while the values stay near 1.
#[test]
fn divisors_of_nested_squares_are_not_taken_for_singular() {
    let folder = tempfile::tempdir().unwrap();
    let chain: String = (0..7).map(|i| format!("a{} = 2*a{i}^2 - 1; ", i + 1)).collect();
    for (count, constraint) in
        [(5, "(2 + a5)*u2 = u1"), (6, "(2 + a6)*u2 = u1"), (7, "(2 + a7)*u2 = u1 + a6*u1")]
    {
        let text = format!(
            "mechanism Squares; parameters {{ m: kg = 1, l: m = 1 }} coordinates {{ q1: rad = 0.3, q2: rad = 0.4 }} \
             speeds {{ u1: rad/s }} dependent {{ u2: rad/s }} definitions {{ a0 = cos(q2); {chain} }} \
             points {{ P = O + l*q1*N.x + l*q2*N.y; }} particles {{ A {{ point: P, mass: m }} }} \
             kinematics {{ d(q1)/dt = u1; d(q2)/dt = u2; }} constraints {{ {constraint}; }}"
        );
        let (m, program) = derived(folder.path(), &text);
        agrees(&m, &program);
        println!("{count} squares");
    }
}
