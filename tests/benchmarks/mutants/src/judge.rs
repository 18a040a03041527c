//! Runs the tests with one mutant active at a time.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use crate::{Outcome, list::Mutant};

/// A test program, and how long it takes without a mutant.
struct Test {
    name: String,
    program: PathBuf,
    takes: Duration,
}

/// Judges mutants by the tests whose names contain `only`: names those that no test finds, then how many each
/// test program found, the quickest first.
pub fn all(
    folder: &Path,
    programs: &[(String, PathBuf)],
    only: Option<&str>,
    mutants: &[Mutant],
    chosen: &[usize],
) -> Outcome<()> {
    let mut tests = Vec::new();
    for (name, program) in programs {
        let begin = Instant::now();
        if run(folder, program, only, None, Duration::from_secs(600))? {
            tests.push(Test { name: name.clone(), program: program.clone(), takes: begin.elapsed() });
        } else {
            println!("left out, because it fails without a mutant in this build: {name}");
        }
    }
    tests.sort_by_key(|test| test.takes);
    for test in &tests {
        println!("{}: {:.2} s", test.name, test.takes.as_secs_f64());
    }
    let mut found: BTreeMap<&str, usize> = BTreeMap::new();
    let mut survivors = 0;
    for (judged, &id) in chosen.iter().enumerate() {
        match finder(folder, &tests, only, id)? {
            Some(name) => *found.entry(name).or_default() += 1,
            None => {
                survivors += 1;
                println!("{} of {} survive, {}", survivors, judged + 1, mutants[id].name);
            }
        }
    }
    println!("{} judged, {survivors} survive; found by {found:?}", chosen.len());
    Ok(())
}

/// The first test program that fails with a mutant, or does not end in ten times its time.
fn finder<'a>(folder: &Path, tests: &'a [Test], only: Option<&str>, id: usize) -> Outcome<Option<&'a str>> {
    for test in tests {
        if !run(folder, &test.program, only, Some(id), test.takes * 10 + Duration::from_secs(10))? {
            return Ok(Some(&test.name));
        }
    }
    Ok(None)
}

/// Whether a test program passes in time.
fn run(
    folder: &Path,
    program: &Path,
    only: Option<&str>,
    id: Option<usize>,
    limit: Duration,
) -> Outcome<bool> {
    let mut command = Command::new(program);
    command.args(only).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.env_remove("MUTANT").env("CARGO_MANIFEST_DIR", folder).env("PROPTEST_FAILURE_PERSISTENCE", "off");
    if let Some(id) = id {
        command.env("MUTANT", id.to_string());
    }
    let begin = Instant::now();
    let mut child = command.spawn()?;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.success());
        }
        if begin.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(false);
        }
        sleep(Duration::from_millis(5));
    }
}
