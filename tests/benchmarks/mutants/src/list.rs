//! The mutants that `cargo mutants` lists, and samples of them.

use std::{path::Path, process::Command};

use serde_json::Value;

use crate::Outcome;

/// A change of one place in a source file.
pub struct Mutant {
    /// As `cargo mutants` names it: place, change, function.
    pub name: String,
    pub file: String,
    /// What is changed: `BinaryOperator`, `FnValue` and so on.
    pub genre: String,
    /// Line and column where the replaced text begins, both from 1.
    pub start: (usize, usize),
    pub replacement: String,
}

/// The mutants of the files that fit a pattern, as `cargo mutants` lists them.
pub fn of(root: &Path, package: &str, files: &str) -> Outcome<Vec<Mutant>> {
    let listed = Command::new("cargo")
        .current_dir(root)
        .args(["mutants", "--list", "--json", "--package", package, "--file", files])
        .output()?;
    if !listed.status.success() {
        return Err("cargo mutants failed: cargo install --locked cargo-mutants".into());
    }
    let listed: Vec<Value> = serde_json::from_slice(&listed.stdout)?;
    listed
        .iter()
        .map(|mutant| read(mutant).ok_or_else(|| format!("not understood: {mutant}").into()))
        .collect()
}

fn read(mutant: &Value) -> Option<Mutant> {
    let text = |key: &str| mutant[key].as_str().map(str::to_owned);
    let place = |key: &str| mutant["span"]["start"][key].as_u64().map(|number| number as usize);
    Some(Mutant {
        name: text("name")?,
        file: text("file")?,
        genre: text("genre")?,
        start: (place("line")?, place("column")?),
        replacement: text("replacement")?,
    })
}

/// At most `count` of the mutants whose names contain `only`, in a random order, which is the same each time.
pub fn sample(mut mutants: Vec<Mutant>, count: usize, only: &str) -> Vec<Mutant> {
    mutants.retain(|mutant| mutant.name.contains(only));
    let mut keyed: Vec<_> =
        mutants.into_iter().enumerate().map(|(id, mutant)| (mixed(id as u64), mutant)).collect();
    keyed.sort_by_key(|(key, _)| *key);
    keyed.into_iter().take(count).map(|(_, mutant)| mutant).collect()
}

/// The output function of SplitMix64.
fn mixed(number: u64) -> u64 {
    let z = number.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The folder of a package, where its tests run.
pub fn folder(package: &str) -> &'static str {
    match package {
        "hodograph" => "runtime",
        "hodograph-generator" => "generator",
        "hodograph-simulation" => "simulation",
        _ => ".",
    }
}
