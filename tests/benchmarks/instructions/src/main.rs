//! Counts the instructions of every routine in `measured`, of every motion in `motions` and of every model that
//! `typing` types into, and holds them against `counts.txt`: more than 6 % above it (of a motion or of typing 10 %) is
//! an error, and so is more than 1 % of all routines together (3 % of all motions, or of all typing). With
//! `HODOGRAPH_UPDATE=1` the table is written anew instead.
//!
//! With the argument `specialised` it prints what collisions that are one routine bring, with `answers` what answers cost
//! by value and in place, as tables of documents.

#[path = "../../../tests/common/expectations.rs"]
mod expectations;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// A routine may take this much more than the table says: compilers and their versions differ a little, and what the
/// compiler inlines into a collision depends even on the folder that it is built in (4 % were seen). All routines
/// together vary much less.
const SLACK: f64 = 0.06;
const SLACK_TOGETHER: f64 = 0.01;
const SLACK_OF_PROGRAMS_TOGETHER: f64 = 0.03;
/// A whole program may take this much more: the numbers of a motion's steps depend on rounding, which the C library's
/// functions differ in, and the standard library allocates differently from version to version.
const SLACK_OF_PROGRAMS: f64 = 0.10;
/// Programs that are counted as a whole: how their names in the table begin, the package, and the function whose
/// instructions, with those of all it calls, are counted.
const PROGRAMS: [(&str, &str, &str); 2] =
    [("motion::", "motions", "motions::follow*"), ("typing::", "typing", "typing::press*")];
/// A few instructions are no matter, however short the routine.
const FEW: f64 = 8.0;

/// So many routines may be left out because valgrind does not know one of their instructions: which, changes
/// with the compiler's choices.
const MISSING: usize = 12;

/// Flags of the compiler for what is counted: valgrind executes no AVX-512.
const FLAGS: &str = "-C target-cpu=x86-64-v3";

type Counts = BTreeMap<String, f64>;

fn main() -> ExitCode {
    let done = match std::env::args().nth(1).as_deref() {
        None => run(),
        Some("specialised") => specialised().map(|()| true),
        Some("answers") => answers().map(|()| true),
        Some(other) => Err(format!("`{other}`: there is no argument but `specialised` and `answers`")),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Whether nothing is above the table.
fn run() -> Result<bool, String> {
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("counts.txt");
    let (mut counted, in_part) = count()?;
    for program in PROGRAMS {
        counted.extend(whole(program)?);
    }
    let stored = std::fs::read_to_string(&table).map_err(|error| format!("{}: {error}", table.display()))?;
    let stored: Counts = stored.lines().filter_map(entry).collect();
    if expectations::are_written_anew() {
        // What could not be counted keeps the count that it had.
        let is_in_part = |name: &str| in_part.iter().any(|subject| name.split("::").next() == Some(subject));
        let mut all: Counts = stored.into_iter().filter(|(name, _)| is_in_part(name)).collect();
        all.extend(counted);
        let lines: Vec<String> = all.iter().map(|(name, count)| format!("{name} {count:.0}\n")).collect();
        std::fs::write(&table, lines.concat()).map_err(|error| format!("{}: {error}", table.display()))?;
        println!("{} counts written to {}", all.len(), table.display());
        return Ok(true);
    }
    let mut right = true;
    let missing: Vec<&str> =
        stored.keys().filter(|name| !counted.contains_key(*name)).map(String::as_str).collect();
    if !missing.is_empty() {
        println!("in the table, but not counted: {}", missing.join(", "));
        right = missing.len() <= MISSING;
    }
    for (name, now) in &counted {
        let Some(before) = stored.get(name) else {
            println!("{name}: {now:.0}, not in the table");
            right = false;
            continue;
        };
        let more = now - before;
        let slack = if program_of(name).is_some() { SLACK_OF_PROGRAMS } else { SLACK };
        if more > FEW && more > slack * before {
            println!("{name}: {now:.0}, {:.1} % above {before:.0}", 100.0 * more / before);
            right = false;
        }
    }
    for (what, program) in [("routines", None), ("motions", Some(0)), ("models typed into", Some(1))] {
        let of = |counts: &Counts| -> Vec<f64> {
            counts.iter().filter(|(name, _)| program_of(name) == program).map(|(_, count)| *count).collect()
        };
        let (now, before) = (of(&counted), of(&stored));
        let part = now.iter().sum::<f64>() / before.iter().sum::<f64>();
        println!("{} {what}, together {:.2} % of the table", now.len(), 100.0 * part);
        let slack = if program.is_some() { SLACK_OF_PROGRAMS_TOGETHER } else { SLACK_TOGETHER };
        if part > 1.0 + slack {
            println!("together they are more than {:.0} % above it", 100.0 * slack);
            right = false;
        }
    }
    if !right {
        println!("where this is meant: HODOGRAPH_UPDATE=1 writes the table anew");
    }
    Ok(right)
}

/// A line of the table: a name and a count.
fn entry(line: &str) -> Option<(String, f64)> {
    let (name, count) = line.split_once(' ')?;
    Some((name.to_owned(), count.trim().parse().ok()?))
}

/// Prints instructions and times of the usual collisions and of specialised ones.
fn specialised() -> Result<(), String> {
    // As programs are built that ask for nothing.
    let measured = build("plain", "", &["measured"])?;
    let (counts, unfinished) = profile(&measured, "specialised")?;
    if !unfinished.is_empty() {
        return Err(format!("valgrind does not know an instruction of {}", unfinished.join(", ")));
    }
    println!(
        "| collision | instructions: usual | law known | law, mu, e known | time: usual (us) | law known | law, mu, e known |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: |");
    for line in execute(Command::new(&measured).arg("times"))?.lines() {
        let mut words = line.split(' ');
        let model = words.next().unwrap_or_default();
        let times: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        let count = |routine: &str| {
            counts.get(&format!("specialised::{model}_{routine}")).copied().unwrap_or(f64::NAN)
        };
        let [usual, law, surface] = ["shared", "known_law", "known_surface"].map(count);
        let [time, with_law, with_surface] = times[..] else { return Err(format!("no times: {line}")) };
        println!(
            "| {model} | {usual:.0} | {law:.0} ({:.3}) | {surface:.0} ({:.3}) | {time:.2} | {with_law:.2} ({:.3}) | {with_surface:.2} ({:.3}) |",
            law / usual,
            surface / usual,
            with_law / time,
            with_surface / time
        );
    }
    Ok(())
}

/// Prints instructions and times of routines in place, and of those by value as parts of them.
fn answers() -> Result<(), String> {
    let measured = build("measured", FLAGS, &["measured", "motions", "typing"])?;
    let (counts, unfinished) = profile(&measured, "answers")?;
    if !unfinished.is_empty() {
        return Err(format!("valgrind does not know an instruction of {}", unfinished.join(", ")));
    }
    println!(
        "| mechanism | routine | instructions in place | by value | `out = ..?` | time: by value | `out = ..?` |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: | ---: |");
    for line in execute(Command::new(&measured).arg("times_of_answers"))?.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let [model, routine, in_place, by_value, assigned] = words[..] else {
            return Err(format!("no times: {line}"));
        };
        let count =
            |kind: &str| counts.get(&format!("{model}::{routine}{kind}")).copied().unwrap_or(f64::NAN);
        let times = [in_place, by_value, assigned].map(|time| time.parse().unwrap_or(f64::NAN));
        println!(
            "| {} | `{routine}` | {:.0} | {:.2} | {:.2} | {:.2} | {:.2} |",
            model.trim_end_matches("_answers"),
            count(""),
            count("_by_value") / count(""),
            count("_assigned") / count(""),
            times[1] / times[0],
            times[2] / times[0],
        );
    }
    Ok(())
}

/// Which of the programs that are counted as a whole a name of the table belongs to.
fn program_of(name: &str) -> Option<usize> {
    PROGRAMS.iter().position(|(prefix, ..)| name.starts_with(prefix))
}

/// Instructions of a program with each of the arguments that it offers.
fn whole((prefix, package, function): (&str, &str, &str)) -> Result<Counts, String> {
    let program = build("measured", FLAGS, &["measured", "motions", "typing"])?.with_file_name(package);
    let profile = program.with_file_name("callgrind.whole.out");
    let mut counts = Counts::new();
    for case in execute(&mut Command::new(&program))?.lines() {
        execute(
            Command::new("valgrind")
                .args(["--tool=callgrind", &format!("--toggle-collect={function}")])
                .arg(format!("--callgrind-out-file={}", profile.display()))
                .arg(&program)
                .args(case.split(',')),
        )?;
        let text =
            std::fs::read_to_string(&profile).map_err(|error| format!("{}: {error}", profile.display()))?;
        let total = text.lines().find_map(|line| line.strip_prefix("totals: ")?.trim().parse().ok());
        let total: f64 = total.filter(|total| *total > 0.0).ok_or(format!("{case}: nothing was counted"))?;
        counts.insert(format!("{prefix}{}", case.replace([' ', ','], "_")), total);
    }
    Ok(counts)
}

/// Builds the programs that are measured, in a folder of their own for these flags of the compiler.
fn build(folder: &str, flags: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let target = here.join("../target").join(folder);
    execute(
        Command::new("cargo")
            .args(["build", "--release", "--locked"])
            .args(packages.iter().flat_map(|package| ["--package", package]))
            .arg("--manifest-path")
            .arg(here.join("Cargo.toml"))
            .arg("--target-dir")
            .arg(&target)
            .env("RUSTFLAGS", flags),
    )?;
    Ok(target.join("release/measured"))
}

/// Instructions of the routines, and the subjects of which not all were counted.
fn count() -> Result<(Counts, Vec<String>), String> {
    let measured = build("measured", FLAGS, &["measured", "motions", "typing"])?;
    let subjects = execute(&mut Command::new(&measured))?;
    let (mut counts, mut in_part) = (Counts::new(), Vec::new());
    for subject in subjects.lines() {
        let (counted, unfinished) = profile(&measured, subject)?;
        if !unfinished.is_empty() {
            println!("{subject}: counted in part, for valgrind does not know one of its instructions");
            in_part.push(subject.to_owned());
        }
        counts.extend(counted);
    }
    if counts.is_empty() {
        Err("valgrind counted none of the routines".to_owned())
    } else {
        Ok((counts, in_part))
    }
}

/// Instructions of the routines of a subject, without those that valgrind did not execute to their end, which
/// are named too.
fn profile(measured: &Path, subject: &str) -> Result<(Counts, Vec<String>), String> {
    let profile = measured.with_file_name("callgrind.out");
    let counted = execute(
        Command::new("valgrind")
            .args(["--tool=callgrind", "--compress-strings=no", "--compress-pos=no"])
            .arg(format!("--callgrind-out-file={}", profile.display()))
            .arg(measured)
            .arg(subject),
    );
    let unfinished: Vec<String> = match counted {
        Ok(_) => Vec::new(),
        // what was counted before it is kept
        Err(message) if message.contains("Unrecognised instruction") || message.contains("SIGILL") => {
            let calls = message.lines().filter(|line| line.contains(" at 0x") || line.contains(" by 0x"));
            calls.filter_map(routine).collect()
        }
        Err(message) => return Err(message),
    };
    let text =
        std::fs::read_to_string(&profile).map_err(|error| format!("{}: {error}", profile.display()))?;
    let counts = per_call(&text).into_iter().filter(|(name, _)| !unfinished.contains(name));
    Ok((counts.collect(), unfinished))
}

/// What a command prints.
fn execute(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr)))
    }
}

/// Instructions per call of each routine, with all that it calls: a line `cfn=` names the callee, the line
/// after `calls=` ends with the cost.
fn per_call(profile: &str) -> Counts {
    let mut totals: BTreeMap<String, (f64, f64)> = BTreeMap::new();
    let (mut callee, mut lines) = (None, profile.lines());
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("cfn=") {
            callee = routine(name);
        } else if let (Some(calls), Some(name)) = (line.strip_prefix("calls="), callee.take()) {
            let word = |text: &str, place| {
                text.split_whitespace().nth(place).and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0)
            };
            let total = totals.entry(name).or_default();
            total.0 += word(calls, 0);
            total.1 += lines.next().map_or(0.0, |line| word(line, 1));
        }
    }
    totals.into_iter().map(|(name, (calls, cost))| (name, cost / calls)).collect()
}

/// The name of a measured routine, `model::routine`, from that of a function: `measured::model::routine`, and
/// what the compiler adds.
fn routine(function: &str) -> Option<String> {
    let rest = function.split("measured::").nth(1)?;
    let mut parts = rest.split("::").map(|part| part.split([' ', '\'']).next().unwrap_or(part));
    let (model, name) = (parts.next()?, parts.next()?);
    // What stands deeper is called by routines.
    (parts.next().is_none()
        && model != "Bench"
        && !matches!(name, "run" | "states" | "times" | "prepared" | "{{closure}}"))
    .then(|| format!("{model}::{name}"))
}
