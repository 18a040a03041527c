//! Measures the code that Hodograph generates: retired instructions per evaluation, operations, derivation
//! time, compile time and code size, beside stored figures of other generators and libraries.
//! `docs/benchmarks.md` says how to run and read it.

mod cases;
mod chain;
mod count;
mod derive;
mod harness;
mod literature;
mod peers;
mod plot;
mod precise;
mod python;
mod robots;
mod rounding;
mod slopes;
mod states;
mod table;
mod times;
mod tools;
mod whole;

use std::path::PathBuf;
use std::process::ExitCode;

use cases::Case;
use table::Row;
use tools::{Failure, Folders};

/// What the command line asks for.
struct Arguments {
    /// only mechanisms whose name is one of these; empty: all
    only: Vec<String>,
    /// the command line tool, if it is built already
    tool: Option<PathBuf>,
    /// fetch public robots and compare them, instead of measuring
    robots: bool,
    /// fetch CasADi, wrenfold and SymForce and compare times with their code, instead of measuring
    times: bool,
    /// fetch a peer and measure its rounding anew
    peers: bool,
}

const USAGE: &str = "usage: hodograph-benchmark [--only NAME,NAME..] [--tool PATH-OF-HODOGRAPH] [--robots] [--times] [--peers]";

fn main() -> ExitCode {
    match arguments().and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn arguments() -> Result<Arguments, Failure> {
    let mut arguments = Arguments { only: Vec::new(), tool: None, robots: false, times: false, peers: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| Failure::new(USAGE));
        match word.as_str() {
            "--only" => arguments.only = value()?.split(',').map(str::to_owned).collect(),
            "--tool" => arguments.tool = Some(PathBuf::from(value()?)),
            "--peers" => arguments.peers = true,
            "--robots" => arguments.robots = true,
            "--times" => arguments.times = true,
            _ => return Err(Failure::new(USAGE)),
        }
    }
    Ok(arguments)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let folders = Folders::new()?;
    let tool = tools::tool(&folders, arguments.tool.as_deref())?;
    if arguments.robots {
        return robots::compare(&folders, &tool);
    }
    if arguments.times {
        return times::run(&folders, &tool, &arguments.only);
    }
    let wanted = |case: &Case| arguments.only.is_empty() || arguments.only.contains(&case.name);
    let cases: Vec<Case> = cases::all().into_iter().filter(wanted).collect();
    let mut derived = Vec::new();
    for case in &cases {
        for fixed in [false, true] {
            derived.push(derive::derive(&folders, &tool, case, fixed)?);
        }
    }
    harness::prepare(&folders, &derived)?;
    let mut rows = Vec::new();
    let mut errors = Vec::new();
    for (index, derivation) in derived.iter().enumerate() {
        eprintln!("measuring {}", derivation.package());
        let built = harness::build(&folders, derivation)?;
        states::agree(&built, derivation)?;
        let slopes = slopes::difference(&folders, &built, derivation)?;
        let counts = count::instructions(&folders, &built)?;
        if derivation.case.has_peers() {
            // Each mechanism is derived with parameters at run time first.
            let reference = &derived[index - usize::from(derivation.fixed)];
            let keep = arguments.peers && !derivation.fixed;
            errors.push((derivation, rounding::measure(&folders, &built, derivation, reference, keep)?));
        }
        rows.push(Row {
            derivation,
            compile_seconds: built.seconds,
            counts,
            sizes: count::sizes(&built)?,
            slopes,
        });
    }
    let peers = peers::read(&folders)?;
    table::print(&rows, &peers);
    if arguments.peers {
        rounding::of_peers(&folders, &cases)?;
    }
    rounding::print(&folders, &errors)?;
    whole::print(&folders, &derived)?;
    literature::print(&folders, &tool)?;
    plot::chains(&folders, &rows, &peers)
}
