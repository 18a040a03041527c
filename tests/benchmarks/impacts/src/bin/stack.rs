//! Computes how much stack the solver needs: `cargo run --release --bin stack`, for x86-64 (needs `objdump`).
//!
//! Builds `tests/fixtures/freestanding`, and adds the frames on the deepest way of calls from each of its functions:
//! return address, saved registers, and what is taken off the stack pointer.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, ExitCode};

/// A function of the program: its frame, and what it calls or jumps to.
#[derive(Default)]
struct Function {
    frame: u64,
    calls: BTreeSet<String>,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = here.join("../target/stack");
    execute(
        Command::new("cargo")
            .args(["build", "--profile", "freestanding", "--target-dir"])
            .arg(&target)
            .current_dir(here.join("../../fixtures/freestanding")),
    )?;
    let text = execute(
        Command::new("objdump")
            .args(["-d", "--no-show-raw-insn"])
            .arg(target.join("freestanding/freestanding")),
    )?;
    let functions = functions(&text);
    println!("| function | bytes | deepest way |");
    println!("| --- | --- | --- |");
    for name in functions.keys().filter(|name| name.contains("12freestanding") && !name.contains("hopper")) {
        let (bytes, way) = deepest(&functions, name, &mut Vec::new());
        let way: Vec<String> = way.iter().map(|(name, frame)| format!("{} {frame}", short(name))).collect();
        println!("| {} | {bytes} | {} |", short(name), way.join(", "));
    }
    Ok(())
}

/// The functions of a disassembly by their symbols.
fn functions(text: &str) -> BTreeMap<String, Function> {
    let mut all: BTreeMap<String, Function> = BTreeMap::new();
    let mut current = String::new();
    for line in text.lines() {
        if let Some(name) = line.strip_suffix(">:").and_then(|line| line.split_once('<')) {
            current = name.1.to_owned();
            all.insert(current.clone(), Function { frame: 8, ..Function::default() });
            continue;
        }
        let Some(function) = all.get_mut(&current) else { continue };
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        match words.as_slice() {
            ["push", ..] => function.frame += 8,
            ["sub", operands, ..] if operands.ends_with(",%rsp") => {
                let number = operands.trim_start_matches("$0x").trim_end_matches(",%rsp");
                function.frame += u64::from_str_radix(number, 16).unwrap_or(0);
            }
            ["call" | "jmp", .., callee] if callee.starts_with('<') && !callee.contains('+') => {
                function.calls.insert(callee.trim_matches(['<', '>']).to_owned());
            }
            _ => {}
        }
    }
    all
}

/// The bytes of the deepest way from a function, and the frames on it. There is no recursion; `on` guards
/// against a wrong reading.
fn deepest<'a>(
    all: &'a BTreeMap<String, Function>,
    name: &'a str,
    on: &mut Vec<&'a str>,
) -> (u64, Vec<(&'a str, u64)>) {
    let Some(function) = all.get(name) else { return (0, Vec::new()) };
    if on.contains(&name) {
        return (0, Vec::new());
    }
    on.push(name);
    let below = function.calls.iter().map(|callee| deepest(all, callee, on)).max_by_key(|(bytes, _)| *bytes);
    on.pop();
    let (bytes, mut way) = below.unwrap_or_default();
    way.insert(0, (name, function.frame));
    (bytes + function.frame, way)
}

/// The last names of a mangled symbol.
fn short(symbol: &str) -> String {
    let mut names = Vec::new();
    let mut rest = symbol.trim_start_matches("_ZN");
    while let Some(digits) = rest.find(|c: char| !c.is_ascii_digit()).filter(|digits| *digits > 0) {
        let length: usize = rest[..digits].parse().unwrap_or(0);
        let Some(name) = rest.get(digits..digits + length) else { break };
        // not the hash at the end
        if !(length == 17 && name.starts_with('h')) {
            names.push(name);
        }
        rest = &rest[digits + length..];
    }
    names.last().map_or(symbol, |name| name).to_owned()
}

fn execute(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr)))
    }
}
