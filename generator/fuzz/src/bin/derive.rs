//! `cargo run -p hodograph-fuzz --bin derive --features derive -- [COUNT] [SEED]`: mutated models that the
//! front end accepts are derived and lowered. A derivation must end with a result or an error; a panic is a
//! failure, and its seed is printed.

use std::path::Path;
use std::time::{Duration, Instant};

use hodograph_fuzz::{Random, mutate};
use hodograph_generator::algebra::SessionError;
use hodograph_generator::program::Program;
use hodograph_generator::source::Source;
use hodograph_generator::{DerivationError, check::check, derive};

/// Shipped models that are quick to derive.
fn models() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("models").filter_map(|e| Some(e.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "mech"));
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).expect("a model")).filter(|text| text.len() < 4000).collect()
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("a number"));
    let count = arguments.next().unwrap_or(1000);
    let first = arguments.next().unwrap_or(0);
    let good = models();
    let start = Instant::now();
    let mut reasons = std::collections::BTreeSet::new();
    let (mut derived, mut refused, mut slowest) = (0u64, 0u64, Duration::ZERO);
    let mut seed = first;
    while derived + refused < count {
        seed += 1;
        let bytes = mutate(&good, &mut Random::new(seed));
        let Some(mechanism) = check(&Source::bytes("fuzz.mech", bytes.clone())).mechanism else { continue };
        let begun = Instant::now();
        match derive(&mechanism) {
            Ok(result) => {
                let _ = Program::new(&result);
                derived += 1;
            }
            Err(DerivationError::Session(SessionError::Panicked(what))) => {
                println!("seed {seed} panics: {what}\n{}", String::from_utf8_lossy(&bytes));
                std::process::exit(1);
            }
            Err(error) => {
                refused += 1;
                // the front end should have said it: the first of each kind is shown
                let reason = error.to_string();
                let kind: String = reason.split('`').step_by(2).collect::<Vec<_>>().join("..");
                if reasons.insert(kind) {
                    println!("seed {seed} is accepted and then refused: {reason}");
                }
            }
        }
        slowest = slowest.max(begun.elapsed());
        if (derived + refused) % 1000 == 0 {
            println!("{} mutated models, {derived} derived, {refused} refused", seed - first);
        }
    }
    let models = seed - first;
    println!(
        "{models} mutated models, {derived} derived, {refused} refused with a reason; {:.0} s, slowest {slowest:.1?}",
        start.elapsed().as_secs_f64()
    );
}
