//! Counts the instructions per collision of every method, and measures their errors. `docs/benchmarks.md`
//! says how to read it.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, ExitCode};

use hodograph_benchmark_impacts::{METHODS, modes, set};

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
    let target = here.join("../target/impacts");
    execute(
        Command::new("cargo")
            .args(["build", "--release", "--bin", "measured", "--manifest-path"])
            .arg(here.join("Cargo.toml"))
            .arg("--target-dir")
            .arg(&target)
            // valgrind executes no AVX-512.
            .env("RUSTFLAGS", "-C target-cpu=x86-64-v3"),
    )?;
    // `modes` alone: the last table only.
    if std::env::args().nth(1).is_none_or(|only| only != "modes") {
        for name in ["nine", "random", "all"] {
            let names: Vec<_> = METHODS.iter().map(|method| method.1).collect();
            table(name, &counts(&profile(&target, name)?, &names));
        }
        by_cases(&target)?;
        worst(&target)?;
        println!("\ntime of the exact solver over that of a method, best turns in one process\n");
        let times = Command::new(target.join("release/measured")).arg("times").output();
        print!("{}", String::from_utf8_lossy(&times.map_err(|error| error.to_string())?.stdout));
    }
    let names: Vec<_> = modes::ROWS.iter().map(|row| row.1).collect();
    let counts = counts(&profile(&target, "modes")?, &names);
    println!("\nclosed contacts\n\n| call | instructions |\n| --- | --- |");
    for (label, function, ..) in modes::ROWS {
        println!("| {label} | {:.0} |", counts.get(function).copied().unwrap_or(f64::NAN));
    }
    Ok(())
}

/// What callgrind writes of a set.
fn profile(target: &Path, name: &str) -> Result<String, String> {
    let profile = target.join(format!("{name}.callgrind"));
    execute(
        Command::new("valgrind")
            .args(["--tool=callgrind", "--compress-strings=no", "--compress-pos=no"])
            .arg(format!("--callgrind-out-file={}", profile.display()))
            .arg(target.join("release/measured"))
            .arg(name),
    )?;
    std::fs::read_to_string(&profile).map_err(|error| error.to_string())
}

/// Instructions of each collision of a set by the exact solver: callgrind writes down what it has counted
/// whenever the next one begins.
fn each(target: &Path, name: &str) -> Result<Vec<u64>, String> {
    let folder = target.join(name);
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    for entry in std::fs::read_dir(&folder).map_err(|error| error.to_string())?.flatten() {
        std::fs::remove_file(entry.path()).map_err(|error| error.to_string())?;
    }
    execute(
        Command::new("valgrind")
            .args(["--tool=callgrind", "--dump-before=*measured_exact*", "--dump-line=no"])
            .arg(format!("--callgrind-out-file={}", folder.join("profile").display()))
            .arg(target.join("release/measured"))
            .args([name, "measured_exact"]),
    )?;
    // The first profile is what came before the first collision; what came after the last one is in the last.
    let mut counts = Vec::new();
    for number in 1..set(name).len() {
        let path = folder.join(format!("profile.{}", number + 1));
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let total = text.lines().rev().find_map(|line| line.strip_prefix("totals: ")?.trim().parse().ok());
        counts.push(total.ok_or("a profile without total")?);
    }
    Ok(counts)
}

/// The nine collisions of two sleds one by one; the set has the last of them twice, so that each is followed
/// by another.
fn by_cases(target: &Path) -> Result<(), String> {
    println!("\nnine, one by one: exact\n");
    println!("| mu | Newton | Poisson | Stronge |");
    println!("| --- | --- | --- | --- |");
    let counts = each(target, "nine and the last again")?;
    for (mu, laws) in ["0.6", "1.1", "1.6"].into_iter().zip(counts.as_chunks::<3>().0) {
        println!("| {mu} | {} | {} | {} |", laws[0], laws[1], laws[2]);
    }
    Ok(())
}

fn worst(target: &Path) -> Result<(), String> {
    let cases = set("hostile");
    let mut counts: Vec<(u64, usize)> = each(target, "hostile")?.into_iter().zip(0..).collect();
    counts.sort_unstable();
    let at = |part: f64| counts.get((part * (counts.len() - 1) as f64) as usize).map_or(0, |count| count.0);
    println!("\nhostile: {} collisions, exact\n", counts.len());
    println!("| median | 90 % | 99 % | most |");
    println!("| --- | --- | --- | --- |");
    println!("| {} | {} | {} | {} |", at(0.5), at(0.9), at(0.99), at(1.0));
    for (count, index) in counts.iter().rev().take(3) {
        if let Some(case) = cases.get(*index) {
            let m = <[f64; 6]>::from(case.matrix);
            eprintln!("{count}: {m:?} {:?} {:?}", case.approach.as_slice(), case.surface);
        }
    }
    Ok(())
}

fn execute(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if output.status.success() {
        Ok(())
    } else {
        Err(format!("{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr)))
    }
}

/// Instructions per call of each measured function, with all that it calls: a line `cfn=` names the callee,
/// the line after `calls=` ends with the cost.
fn counts(profile: &str, names: &[&'static str]) -> BTreeMap<&'static str, f64> {
    let mut totals: BTreeMap<&'static str, (f64, f64)> = BTreeMap::new();
    let (mut callee, mut lines) = (None, profile.lines());
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("cfn=") {
            callee = names.iter().find(|known| name.contains(**known)).copied();
        } else if let (Some(calls), Some(function)) = (line.strip_prefix("calls="), callee.take()) {
            let number = |text: &str, place| {
                text.split_whitespace().nth(place).and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0)
            };
            let total = totals.entry(function).or_default();
            total.0 += number(calls, 0);
            total.1 += lines.next().map_or(0.0, |line| number(line, 1));
        }
    }
    totals.into_iter().map(|(function, (calls, cost))| (function, cost / calls)).collect()
}

fn table(name: &str, counts: &BTreeMap<&'static str, f64>) {
    let cases = set(name);
    println!("\n{name}: {} collisions\n", cases.len());
    println!("| method | instructions | median error | largest error | no answer |");
    println!("| --- | --- | --- | --- | --- |");
    for (label, function, method) in METHODS {
        let answers: Vec<_> = cases.iter().map(|case| method(case).map(|hit| case.error(&hit))).collect();
        let mut errors: Vec<f64> = answers.iter().flatten().copied().collect();
        errors.sort_by(f64::total_cmp);
        let count = counts.get(function).copied().unwrap_or(f64::NAN);
        let median = errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN);
        let largest = errors.last().copied().unwrap_or(f64::NAN);
        let none = answers.len() - errors.len();
        println!("| {label} | {count:.0} | {median:.1e} | {largest:.1e} | {none} |");
    }
}
