//! Counts instructions with valgrind.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use crate::Failure;

/// The instructions of a function, with those of all it calls, in a run of a program.
pub fn of(program: &Path, arguments: &[&OsStr], function: &str, folder: &Path) -> Result<u64, Failure> {
    let out = folder.join("callgrind.out");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--collect-atstart=no", &format!("--toggle-collect={function}")])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(program)
        .args(arguments)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let text = std::fs::read_to_string(out)?;
    let total =
        text.lines().find_map(|line| line.strip_prefix("totals: ").or(line.strip_prefix("summary: ")));
    Ok(total.ok_or("valgrind counted nothing")?.trim().parse()?)
}

/// Runs a command that must succeed.
pub fn done(command: &mut Command) -> Result<(), Failure> {
    let status = command.status()?;
    if status.success() { Ok(()) } else { Err(format!("{command:?} failed").into()) }
}
