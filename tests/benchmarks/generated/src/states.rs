//! Where the routines are evaluated, and what they must answer there.

use std::path::Path;
use std::process::Command;

use serde_json::{Map, Value};

use crate::cases::{Case, Origin};
use crate::derive::Derivation;
use crate::harness::Built;
use crate::tools::{Failure, Folders, output};

/// Named numbers.
pub type Named = Vec<(String, f64)>;

/// A state.
pub struct State {
    /// coordinates
    pub q: Named,
    /// independent speeds
    pub u: Named,
    /// their derivatives, for inverse dynamics
    pub a: Named,
    /// named inputs, for forward dynamics
    pub inputs: Named,
    /// reference numbers, in the order of `u`
    pub expected: Option<Expected>,
}

/// What the routines must answer.
pub struct Expected {
    /// u'
    pub forward: Vec<f64>,
    /// generalised forces without inputs
    pub inverse: Vec<f64>,
    /// mass matrix by rows
    pub mass: Vec<f64>,
}

/// The states of a mechanism.
pub fn states(folders: &Folders, tool: &Path, case: &Case, model: &Path) -> Result<Vec<State>, Failure> {
    match case.origin {
        Origin::Peer => peer(folders, case),
        Origin::Chain(links) => Ok((0..3).map(|turn| of_chain(links, f64::from(turn))).collect()),
        Origin::Model => (0..3).map(|turn| of_model(tool, model, turn)).collect(),
    }
}

/// JSON.
pub fn parsed(text: &str) -> Result<Value, Failure> {
    serde_json::from_str(text).map_err(|error| Failure::new(error.to_string()))
}

/// All numbers of a list of lists.
pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        _ => vec![value.as_f64().unwrap_or(f64::NAN)],
    }
}

/// Reads the states of `expected.json`; a free base has q = position, quaternion (x, y, z, w).
fn peer(folders: &Folders, case: &Case) -> Result<Vec<State>, Failure> {
    let text = std::fs::read_to_string(folders.root.join("tests/data/peers/expected.json"))?;
    let all = parsed(&text)?;
    let robot = &all[case.name.as_str()];
    let joints: Vec<&str> =
        robot["joints"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let states = robot["states"].as_array().into_iter().flatten().map(|state| {
        let [q, v, a, tau] = ["q", "v", "a", "tau"].map(|key| numbers(&state[key]));
        let (mut coordinates, mut speeds): (Vec<String>, Vec<String>) = Default::default();
        for joint in &joints {
            match *joint {
                "universe" => {}
                "root_joint" => {
                    coordinates
                        .extend(["x", "y", "z", "e1", "e2", "e3", "e0"].map(|part| format!("base_{part}")));
                    speeds.extend(["x", "y", "z", "rx", "ry", "rz"].map(|part| format!("base_{part}")));
                }
                joint => {
                    coordinates.push(joint.to_owned());
                    speeds.push(joint.to_owned());
                }
            }
        }
        let named = |prefix: &str, names: &[String], values: Vec<f64>| -> Named {
            names.iter().map(|name| format!("{prefix}_{name}")).zip(values).collect()
        };
        State {
            q: named("q", &coordinates, q),
            u: named("u", &speeds, v),
            a: named("u", &speeds, a),
            inputs: named("tau", &speeds, tau),
            expected: Some(Expected {
                forward: numbers(&state["forward_dynamics"]),
                inverse: numbers(&state["inverse_dynamics"]),
                mass: numbers(&state["M"]),
            }),
        }
    });
    Ok(states.collect())
}

fn of_chain(links: usize, turn: f64) -> State {
    let named = |prefix: &str, scale: f64, phase: f64| -> Named {
        let value = |joint: usize| scale * (1.7 * joint as f64 + phase + 2.3 * turn).sin();
        (0..=links).map(|joint| (format!("{prefix}_j{joint}"), value(joint))).collect()
    };
    State {
        q: named("q", 1.2, 0.4),
        u: named("u", 0.9, 1.1),
        a: named("u", 1.4, 2.0),
        inputs: named("tau", 2.0, 0.7),
        expected: None,
    }
}

/// The independent speeds of a model in their order.
pub fn speeds(tool: &Path, model: &Path) -> Result<Vec<String>, Failure> {
    let answer = parsed(&output(Command::new(tool).arg("eval").arg(model))?)?;
    Ok(names_of_speeds(&answer))
}

fn names_of_speeds(answer: &Value) -> Vec<String> {
    answer["speeds"].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
}

/// The model's initial state, moved a little; the tool completes the dependent coordinates.
fn of_model(tool: &Path, model: &Path, turn: i32) -> Result<State, Failure> {
    let answer = output(Command::new(tool).arg("eval").arg(model))?;
    let initial = parsed(&answer)?;
    let turn = f64::from(turn);
    let named = |values: Option<&Map<String, Value>>, shift: f64| -> Named {
        let moved = |(at, (name, value)): (usize, (&String, &Value))| {
            let value = value.as_f64().unwrap_or(0.0);
            (name.clone(), value + shift * turn * (at as f64 + 1.0))
        };
        values.into_iter().flatten().enumerate().map(moved).collect()
    };
    let mut q = Map::new();
    for (name, value) in named(initial["q"].as_object(), 0.01) {
        q.insert(name, value.into());
    }
    // What a loop determines is left to the tool.
    let text = std::fs::read_to_string(model)?;
    q.retain(|name, _| !text.contains(&format!("dependent {name}:")));
    let state = serde_json::json!({ "q": q }).to_string();
    let answer = parsed(&output(Command::new(tool).arg("eval").arg(model).args(["--state", &state]))?)?;
    let speeds = names_of_speeds(&answer);
    let of = |scale: f64, phase: f64| -> Named {
        let value = |at: usize| scale * (1.7 * at as f64 + phase + 2.3 * turn).sin();
        speeds.iter().enumerate().map(|(at, name)| (name.clone(), value(at))).collect()
    };
    Ok(State {
        q: named(answer["q"].as_object(), 0.0),
        u: of(2.0, 1.1),
        a: of(1.4, 2.0),
        inputs: Vec::new(),
        expected: None,
    })
}

/// Holds what the measured routines answer to the reference numbers: 1e-10 of the largest entry.
pub fn agree(built: &Built, derivation: &Derivation<'_>) -> Result<(), Failure> {
    let answers = output(Command::new(&built.program).arg("numbers"))?;
    let mut lines = answers.lines();
    for state in &derivation.states {
        let mut next = || -> Vec<f64> {
            lines.next().unwrap_or("").split_whitespace().filter_map(|word| word.parse().ok()).collect()
        };
        let [forward, inverse, _contact, mass] = [next(), next(), next(), next()];
        let Some(expected) = &state.expected else { continue };
        let pairs = [
            ("forward dynamics", forward, &expected.forward),
            ("inverse dynamics", inverse, &expected.inverse),
            ("mass matrix", mass, &expected.mass),
        ];
        // From the reference's order of the speeds to the model's.
        let place = |name: &String| state.u.iter().position(|(other, _)| other == name).unwrap_or(usize::MAX);
        let order: Vec<usize> = derivation.speeds.iter().map(place).collect();
        for (what, found, expected) in pairs {
            let entry = |at: usize| expected.get(at).copied().unwrap_or(f64::NAN);
            let expected: Vec<f64> = if what == "mass matrix" {
                (0..order.len() * order.len())
                    .map(|at| entry(order[at / order.len()] * order.len() + order[at % order.len()]))
                    .collect()
            } else {
                order.iter().map(|&i| entry(i)).collect()
            };
            let largest = expected.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
            let same_length = found.len() == expected.len();
            let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
            if !same_length || error.is_nan() || error > 1e-10 {
                return Err(Failure::new(format!("{} {what}: off by {error:e}", derivation.package())));
            }
        }
    }
    Ok(())
}
