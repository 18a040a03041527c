//! A Python of the benchmark's own, with Pinocchio and CasADi.

use std::path::PathBuf;
use std::process::Command;

use crate::tools::{Failure, Folders, output};

/// The program that others are compared with.
const PINOCCHIO: &str = "pin==4.1.0";

/// What writes the code that ours is timed against.
const GENERATORS: [&str; 3] = ["casadi==3.8.2", "wrenfold==0.5.3", "symforce==0.12.0"];

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

/// The same with other generators of code.
pub fn with_generators(folders: &Folders) -> Result<PathBuf, Failure> {
    let python = with_pinocchio(folders)?;
    output(Command::new(&python).args(["-m", "pip", "--quiet", "install"]).args(GENERATORS))?;
    Ok(python)
}
