//! A Python of the benchmark's own, with Pinocchio.

use std::path::PathBuf;
use std::process::Command;

use crate::tools::{Failure, Folders, output};

/// The program that others are compared with.
const PINOCCHIO: &str = "pin==4.1.0";

/// Fetches Pinocchio into the benchmark's own folder, if it is not there yet; the interpreter.
pub fn with_pinocchio(folders: &Folders) -> Result<PathBuf, Failure> {
    let environment = folders.work.join("robots/python");
    let python = environment.join("bin/python");
    if !python.exists() {
        eprintln!("fetching Pinocchio");
        output(Command::new("python3").args(["-m", "venv"]).arg(&environment))?;
    }
    output(Command::new(&python).args(["-m", "pip", "--quiet", "install", PINOCCHIO]))?;
    Ok(python)
}
