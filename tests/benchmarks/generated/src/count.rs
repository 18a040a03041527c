//! Counts instructions and measures the code size of routines.
//!
//! valgrind's callgrind executes the program and counts every instruction that retires between entry and
//! return of a routine, whatever it calls (sines, cosines) included, loops and argument hiding around it
//! excluded. Counts do not depend on load.

use std::collections::BTreeMap;
use std::process::Command;

use crate::harness::{self, Built, DERIVATIVES, ROUTINES};
use crate::tools::{Failure, Folders, output};

/// How often each routine is evaluated at each state.
const REPEATS: u64 = 50;

/// The runtime's functions for sines and cosines of several angles.
const ANGLES: &str = "angles::of_";

/// What stands for the routine that computes what depends on parameters alone.
pub const CONSTRUCTION: &str = "construction";

/// Instructions per evaluation and calls of other functions, per routine.
pub type Counts = BTreeMap<&'static str, f64>;

/// Counts instructions per evaluation, the mean over the states.
pub fn instructions(folders: &Folders, built: &Built) -> Result<Counts, Failure> {
    let functions: Vec<(&str, &str)> =
        ROUTINES.into_iter().chain(DERIVATIVES).chain([(CONSTRUCTION, ">::hoist")]).collect();
    of_functions(folders, built, &functions)
}

/// Counts instructions per call of functions: what each is called here, and a part of its name in the
/// program.
pub fn of_functions<'a>(
    folders: &Folders,
    built: &Built,
    functions: &[(&'a str, &str)],
) -> Result<BTreeMap<&'a str, f64>, Failure> {
    let file = folders.work.join(format!("{}.callgrind", built.package));
    let count = || {
        output(
            Command::new("valgrind")
                .args(["--tool=callgrind", "--compress-strings=no", "--compress-pos=no"])
                .arg(format!("--callgrind-out-file={}", file.display()))
                .arg(&built.program)
                .arg(REPEATS.to_string()),
        )
    };
    let counted = count().or_else(|failure| {
        // valgrind does not know one of the two encodings of `vmovq` between registers; the compiler seldom
        // takes that one.
        if !failure.to_string().contains("unhandled instruction") {
            return Err(failure);
        }
        eprintln!(
            "{}: compiled again as one unit, since valgrind does not know an instruction",
            built.package
        );
        harness::as_one_unit(folders, &built.package)?;
        count()
    });
    counted.map_err(|failure| {
        Failure::new(format!("instructions are counted with valgrind, which failed: {failure}"))
    })?;
    Ok(parse(&std::fs::read_to_string(&file)?, functions))
}

/// Reads a profile: a line `cfn=` names the callee, `calls=` says how often, the next line ends with the
/// inclusive cost.
fn parse<'a>(profile: &str, functions: &[(&'a str, &str)]) -> BTreeMap<&'a str, f64> {
    let mut totals: BTreeMap<&str, (u64, u64)> = BTreeMap::new();
    let mut callee = None;
    let mut lines = profile.lines();
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("cfn=") {
            // `measured_ml` contains `measured_m`: the longest name is meant.
            let named = functions.iter().filter(|(_, function)| name.contains(function));
            callee = named.max_by_key(|(_, function)| function.len()).map(|&(routine, _)| routine);
        } else if let (Some(calls), Some(routine)) = (line.strip_prefix("calls="), callee.take()) {
            let number =
                |text: &str, at: usize| text.split_whitespace().nth(at).and_then(|word| word.parse().ok());
            let cost: u64 = lines.next().and_then(|line| number(line, 1)).unwrap_or(0);
            let total = totals.entry(routine).or_default();
            total.0 += number(calls, 0).unwrap_or(0);
            total.1 += cost;
        }
    }
    totals.into_iter().map(|(routine, (calls, cost))| (routine, cost as f64 / calls as f64)).collect()
}

/// Bytes of machine code per routine: its function, the method, where that is a function of its own, and the
/// sines and cosines of several angles, which all routines share.
pub fn sizes(built: &Built) -> Result<BTreeMap<&'static str, u64>, Failure> {
    let text = output(Command::new("nm").args(["--print-size", "--demangle"]).arg(&built.program))?;
    let methods = [
        "::accelerations",
        "::inverse_dynamics",
        "::contact_matrices_",
        "::mass_matrix",
        "::accelerations_derivatives",
        "::inverse_dynamics_derivatives",
        "::linearise",
    ];
    let mut sizes = BTreeMap::new();
    for line in text.lines() {
        let mut words = line.splitn(4, ' ');
        let (Some(_), Some(size), Some(_), Some(name)) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            continue;
        };
        let Ok(size) = u64::from_str_radix(size, 16) else { continue };
        for ((routine, function), method) in ROUTINES.iter().chain(&DERIVATIVES).zip(methods) {
            // a value's method is not that of its derivatives
            let of_values = !routine.starts_with('d') && name.contains("_derivatives");
            let is_method = name.contains(method) && !of_values;
            if name.contains(function) || is_method || name.contains(ANGLES) {
                *sizes.entry(*routine).or_default() += size;
            }
        }
    }
    Ok(sizes)
}
