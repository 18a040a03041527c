//! Runs the tool and reads what it says.

use std::path::Path;
use std::process::{Command, Output};

/// The tool.
pub fn tool() -> Command {
    Command::new(env!("CARGO_BIN_EXE_hodograph-sweep"))
}

/// Its output with these arguments, run in this directory.
pub fn run(directory: &Path, arguments: &[&str]) -> Output {
    tool().args(arguments).current_dir(directory).output().unwrap()
}

/// What it writes where it succeeds.
pub fn succeeds(directory: &Path, arguments: &[&str]) -> String {
    let output = run(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// What it says where it fails; the status is 2 for wrong input and 1 otherwise.
pub fn fails(directory: &Path, arguments: &[&str], status: i32) -> String {
    let output = run(directory, arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
    assert!(!said.contains("panicked") && !said.contains("Internal error"), "{said}");
    said
}

/// The line with the digest.
pub fn digest(output: &str) -> &str {
    output.lines().find(|line| line.starts_with("digest")).unwrap_or_else(|| panic!("no digest: {output}"))
}

/// Collisions of the two sleds of which all approach, counted; for so many rows.
pub fn collisions(rows: u64) -> String {
    format!(
        "SELECT mu, count(*) AS collisions, count(*) FILTER (WHERE c['kind'] = 'ok') AS solved, checksum(outcome_hash(c)) AS checksum,
            histogram(c['energy_change'], -4.0, 1.0, 20) AS energy
         FROM (SELECT mu, two_sleds_collide(named_struct('mu', mu, 'e', 0.8, 'law', 'newton',
                   'u1', uniform(i, 0, 1), 'u4', 1.0 + uniform(i, 1, 1), 'u3', 0.2 * sobol(i, 2, 1))) AS c
               FROM (SELECT i, linspace(i % 5, 0, 1, 5) AS mu FROM rows({rows})))
         GROUP BY mu ORDER BY mu"
    )
}
