//! MuJoCo in a Python of the benchmark's own.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use hodograph_benchmark_contact::Failure;

/// The program that others are compared with.
const MUJOCO: &str = "mujoco==4.0.0";

/// What MuJoCo does: scene, time step and duration, s.
pub type Job = (&'static str, f64, f64);

/// What a job gave.
#[derive(Clone, Debug)]
pub struct Answer {
    /// time of the processor, s
    pub seconds: f64,
    /// positions at the end
    pub q: Vec<f64>,
    /// how far the first body moved along x between a fifth of the motion and its end, m
    pub drift: f64,
}

/// An interpreter with MuJoCo, fetched into the benchmark's own folder if it is not there yet.
pub fn python() -> Result<PathBuf, Failure> {
    let environment = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../target/python"));
    let python = environment.join("bin/python");
    if !python.exists() {
        eprintln!("fetching {MUJOCO}");
        done(Command::new("python3").args(["-m", "venv"]).arg(&environment))?;
    }
    done(Command::new(&python).args(["-m", "pip", "--quiet", "install", MUJOCO]))?;
    Ok(python)
}

/// Runs jobs, each with a simulation of its own.
pub fn run(python: &PathBuf, jobs: &[Job]) -> Result<Vec<Answer>, Failure> {
    let mut child = Command::new(python)
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/peer.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    child.stdin.take().ok_or("no pipe")?.write_all(json!(jobs).to_string().as_bytes())?;
    let output = child.wait_with_output()?;
    if !output.status.success() {
        return Err("peer.py failed".into());
    }
    let answer: Value = serde_json::from_slice(&output.stdout)?;
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let answers = answer["answers"].as_array().ok_or("no answers")?;
    Ok(answers
        .iter()
        .map(|answer| Answer {
            seconds: number(&answer["seconds"]),
            q: answer["q"].as_array().into_iter().flatten().map(number).collect(),
            drift: number(&answer["drift"]),
        })
        .collect())
}

fn done(command: &mut Command) -> Result<(), Failure> {
    match command.status()?.success() {
        true => Ok(()),
        false => Err(format!("{command:?} failed").into()),
    }
}
