//! Compares derivatives with those of Pinocchio at the same states (`tests/data/peers/derivatives.json`).

use std::process::Command;

use hodograph_generator::check::check;
use hodograph_generator::files;
use serde_json::Value;

use crate::cases::Origin;
use crate::derive::Derivation;
use crate::harness::{Built, differentiated};
use crate::states::{State, numbers, parsed};
use crate::tools::{Failure, Folders, output};

/// The largest difference that is accepted, as a part of the largest entry of a matrix.
const BOUND: f64 = 1e-11;

/// What the columns of a model's matrices belong to.
pub struct Names {
    /// coordinates
    pub coordinates: Vec<String>,
    /// independent speeds
    pub speeds: Vec<String>,
    /// named inputs
    pub inputs: Vec<String>,
}

/// The largest difference over all matrices and states; `None` for mechanisms that have no reference.
pub fn difference(
    folders: &Folders,
    built: &Built,
    derivation: &Derivation<'_>,
) -> Result<Option<f64>, Failure> {
    if derivation.case.origin != Origin::Peer || !differentiated(derivation) {
        return Ok(None);
    }
    let text = std::fs::read_to_string(folders.root.join("tests/data/peers/derivatives.json"))?;
    let reference = parsed(&text)?;
    let expected = reference[derivation.case.name.as_str()].as_array().cloned().unwrap_or_default();
    if expected.len() != derivation.states.len() {
        return Err(Failure::new(format!("{}: no derivatives to compare with", derivation.package())));
    }
    let names = names(derivation)?;
    let answers = output(Command::new(&built.program).arg("derivatives"))?;
    let mut lines = answers.lines();
    let mut worst = 0.0_f64;
    for (state, expected) in derivation.states.iter().zip(&expected) {
        for kind in ["forward", "inverse"] {
            let line = lines.next().unwrap_or("");
            let found: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            for off in off(&found, &names, state, expected, kind) {
                // `max` would pass over what is not a number.
                if off.is_nan() || off > BOUND {
                    let package = derivation.package();
                    return Err(Failure::new(format!(
                        "{package}, derivatives of {kind} dynamics: off by {off:e}"
                    )));
                }
                worst = worst.max(off);
            }
        }
    }
    Ok(Some(worst))
}

/// The names in a model.
pub fn names(derivation: &Derivation<'_>) -> Result<Names, Failure> {
    let mechanism = check(&files::model(&derivation.path)).mechanism;
    let mechanism = mechanism.ok_or_else(|| Failure::new("a model that was derived is not accepted"))?;
    Ok(Names {
        coordinates: mechanism.coordinates.iter().map(|coordinate| coordinate.name.clone()).collect(),
        speeds: derivation.speeds.clone(),
        inputs: mechanism.inputs.iter().map(|input| input.name.clone()).collect(),
    })
}

/// The differences of the matrices of one answer: a value and the derivatives by coordinates, speeds and
/// inputs, all by rows.
fn off(found: &[f64], names: &Names, state: &State, expected: &Value, kind: &str) -> Vec<f64> {
    let rows = names.speeds.len();
    let counts = [names.coordinates.len(), rows, names.inputs.len()];
    if found.len() != rows * (1 + counts.iter().sum::<usize>()) {
        return vec![f64::NAN];
    }
    let (mut rest, mut all) = (&found[rows..], Vec::new());
    for (by, count) in ["q", "v", "tau"].into_iter().zip(counts) {
        let (block, after) = rest.split_at(rows * count);
        rest = after;
        let Some(reference) = expected[format!("{kind}_by_{by}")].as_array() else { continue };
        let reference: Vec<Vec<f64>> = reference.iter().map(numbers).collect();
        let columns: Vec<Vec<(usize, f64)>> =
            state.u.iter().map(|(name, _)| column(names, state, name, by)).collect();
        let largest = reference.iter().flatten().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        for ((name, _), expected) in state.u.iter().zip(&reference) {
            let Some(row) = names.speeds.iter().position(|speed| speed == name) else {
                return vec![f64::NAN];
            };
            for (column, expected) in columns.iter().zip(expected) {
                // An input that the model does not have has no column.
                if column.is_empty() {
                    continue;
                }
                let ours: f64 = column.iter().map(|&(at, part)| part * block[row * count + at]).sum();
                all.push((ours - expected).abs() / largest);
            }
        }
    }
    all
}

/// What a column of the reference is in the model's columns: that of a speed, an input, or the small motion
/// that a speed stands for.
pub fn column(names: &Names, state: &State, speed: &str, by: &str) -> Vec<(usize, f64)> {
    let bare = speed.trim_start_matches("u_");
    let place = |list: &[String], name: String| list.iter().position(|other| *other == name);
    match by {
        "v" => place(&names.speeds, speed.to_owned()).map(|at| (at, 1.0)).into_iter().collect(),
        "tau" => place(&names.inputs, format!("tau_{bare}")).map(|at| (at, 1.0)).into_iter().collect(),
        _ => motion(state, bare)
            .into_iter()
            .filter_map(|(name, part)| Some((place(&names.coordinates, format!("q_{name}"))?, part)))
            .collect(),
    }
}

/// How coordinates change with the small motion that a speed stands for. Those of a free base are along and
/// about its own axes.
fn motion(state: &State, speed: &str) -> Vec<(String, f64)> {
    let of = |name: &str| {
        state
            .q
            .iter()
            .find(|(other, _)| *other == format!("q_base_{name}"))
            .map_or(f64::NAN, |(_, value)| *value)
    };
    let e = || ["e0", "e1", "e2", "e3"].map(of);
    let axis = |name: &str| ["x", "y", "z"].iter().position(|axis| *axis == name);
    let named =
        |list: &[(&str, f64)]| list.iter().map(|(name, part)| (format!("base_{name}"), *part)).collect();
    let Some(part) = speed.strip_prefix("base_") else { return vec![(speed.to_owned(), 1.0)] };
    if let Some(axis) = axis(part) {
        let [e0, e1, e2, e3] = e();
        let column = [
            [1.0 - 2.0 * (e2 * e2 + e3 * e3), 2.0 * (e1 * e2 + e0 * e3), 2.0 * (e1 * e3 - e0 * e2)],
            [2.0 * (e1 * e2 - e0 * e3), 1.0 - 2.0 * (e1 * e1 + e3 * e3), 2.0 * (e2 * e3 + e0 * e1)],
            [2.0 * (e1 * e3 + e0 * e2), 2.0 * (e2 * e3 - e0 * e1), 1.0 - 2.0 * (e1 * e1 + e2 * e2)],
        ][axis];
        return named(&[("x", column[0]), ("y", column[1]), ("z", column[2])]);
    }
    let Some(axis) = part.strip_prefix('r').and_then(axis) else { return Vec::new() };
    let [e0, e1, e2, e3] = e().map(|part| part / 2.0);
    let column = [[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]][axis];
    named(&[("e0", column[0]), ("e1", column[1]), ("e2", column[2]), ("e3", column[3])])
}
