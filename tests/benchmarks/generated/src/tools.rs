//! Folders, and the programs that the benchmark runs.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Why the benchmark stops.
#[derive(Debug)]
pub struct Failure(String);

impl Failure {
    /// With this message.
    pub fn new(message: impl Into<String>) -> Self {
        Failure(message.into())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Failure(error.to_string())
    }
}

/// Where things are.
pub struct Folders {
    /// the repository
    pub root: PathBuf,
    /// what the benchmark writes
    pub work: PathBuf,
}

impl Folders {
    /// The folders of this checkout.
    pub fn new() -> Result<Self, Failure> {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = here.join("../../..").canonicalize()?;
        let work = here.join("../target/generated");
        std::fs::create_dir_all(&work)?;
        Ok(Folders { root, work })
    }
}

/// Runs a command; its standard output, or a failure with everything that it said.
pub fn output(command: &mut Command) -> Result<String, Failure> {
    let shown = format!("{command:?}");
    let output = command.output().map_err(|error| Failure::new(format!("{shown}: {error}")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(Failure::new(format!("{shown}: {}\n{said}", output.status)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The command line tool in release: the given one, or built here.
pub fn tool(folders: &Folders, given: Option<&Path>) -> Result<PathBuf, Failure> {
    if let Some(given) = given {
        return Ok(given.canonicalize()?);
    }
    eprintln!("building the command line tool");
    output(
        Command::new("cargo")
            .args(["build", "--release", "--locked", "-p", "hodograph-cli"])
            .current_dir(&folders.root),
    )?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(folders.root.join("target"), PathBuf::from);
    Ok(target.join("release/hodograph").canonicalize()?)
}

/// What a program took.
pub struct Effort {
    /// seconds of the processor, of all its threads and children; other work on the machine is not in them.
    /// Without `/usr/bin/time` it is the time that passed.
    pub seconds: f64,
    /// the most memory of one of its processes, kB
    pub kilobytes: Option<u64>,
}

/// Runs a program and says what it took. `figure` is a file for what `time` says.
pub fn effort(command: &mut Command, figure: &Path) -> Result<Effort, Failure> {
    const TIME: &str = "/usr/bin/time";
    if !Path::new(TIME).exists() {
        let start = Instant::now();
        output(command)?;
        return Ok(Effort { seconds: start.elapsed().as_secs_f64(), kilobytes: None });
    }
    let mut timed = Command::new(TIME);
    timed.args(["-f", "%U %S %M", "-o"]).arg(figure).arg(command.get_program()).args(command.get_args());
    if let Some(folder) = command.get_current_dir() {
        timed.current_dir(folder);
    }
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => timed.env(name, value),
            None => timed.env_remove(name),
        };
    }
    output(&mut timed)?;
    let text = std::fs::read_to_string(figure)?;
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [user, system, kilobytes] => Ok(Effort { seconds: user + system, kilobytes: Some(kilobytes as u64) }),
        _ => Err(Failure::new(format!("{}: {text}", figure.display()))),
    }
}
