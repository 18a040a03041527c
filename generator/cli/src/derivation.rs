//! Reads derivation files, derives in a child process, and writes derivation files completely or not at all.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use hodograph_generator::artifact::{self, place};
use hodograph_generator::files;
use hodograph_generator::format::plain;
use hodograph_generator::program::Program;
use indicatif::{ProgressBar, ProgressStyle};

use crate::evaluate::Machine;
use crate::model::{self, Model};
use crate::output;
use crate::stop::{Outcome, Stop};

/// Name of the hidden command that the child process runs.
pub const WORKER: &str = "derive-worker";

/// Bounds on a derivation.
#[derive(Clone, Debug, clap::Args)]
pub struct Limits {
    /// give up deriving, or writing equations, after this many seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 600)]
    pub time_limit: u64,
}

/// The stack size of threads that traverse expressions recursively.
const STACK: usize = 256 << 20;

impl Limits {
    /// Runs `work` for at most the time limit; a thread that takes longer ends with the process. `doing`
    /// describes the work in messages.
    ///
    /// # Errors
    ///
    /// [`Stop::Fault`] after the limit.
    pub fn bound<R: Send + 'static>(
        &self,
        doing: &str,
        work: impl FnOnce() -> R + Send + 'static,
    ) -> Outcome<R> {
        let (sender, receiver) = std::sync::mpsc::channel();
        let worker = std::thread::Builder::new().stack_size(STACK);
        let limit = Duration::from_secs(self.time_limit);
        let late = format!("{doing} took more than {} seconds: give more with --time-limit", self.time_limit);
        let started = Instant::now();
        worker
            .spawn(move || drop(sender.send((work(), started.elapsed()))))
            .map_err(|error| Stop::Fault(format!("cannot start a thread: {error}")))?;
        match receiver.recv_timeout(limit) {
            // on a busy machine this thread may wake up after an answer that came too late
            Ok((_, took)) if took > limit => Err(Stop::Fault(late)),
            Ok((answer, _)) => Ok(answer),
            Err(RecvTimeoutError::Timeout) => Err(Stop::Fault(late)),
            Err(RecvTimeoutError::Disconnected) => {
                Err(Stop::Fault(format!("{doing} failed: please report it with the model")))
            }
        }
    }
}

/// A model with its equations: the stored derivation if it is fresh, else one that is derived now and not
/// stored.
///
/// # Errors
///
/// Those of [`model::load`] and [`derive()`].
pub fn machine(path: &Path, limits: &Limits) -> Outcome<Machine> {
    let model = model::load(path)?;
    let kept = place::beside(path);
    let program = match artifact::load(&kept, &model.source).program() {
        Ok(program) => program,
        Err(fault) => {
            output::say(format_args!(
                "note: {} {fault}; deriving in memory, `hodograph derive {}` keeps the result",
                kept.display(),
                path.display()
            ));
            derive(&model, limits)?.0
        }
    };
    Ok(Machine { mechanism: model.mechanism, program })
}

/// Derives a model and returns the program, and the text of its derivation file.
///
/// The algebra engine prints to standard output and may end the process that uses it, so it runs in a process
/// of its own. Only one such process at a time may run on behalf of a user; the generator waits for others,
/// and says so.
///
/// # Errors
///
/// [`Stop::Reported`] if the child process has reported the mistake itself, else [`Stop::Fault`].
pub fn derive(model: &Model, limits: &Limits) -> Outcome<(Program, String)> {
    let answer = run(model, limits, false)?;
    let derived = artifact::decode(&answer)
        .map_err(|error| Stop::Fault(format!("the derivation of {}: {error}", model.source.name())))?;
    Ok((derived.program, answer))
}

/// Derives a model and returns a line for each pass with the number of operations after it.
///
/// # Errors
///
/// Those of [`derive()`].
pub fn trace(model: &Model, limits: &Limits) -> Outcome<String> {
    run(model, limits, true)
}

/// The line that the child process writes before its answer; the text above it comes from the engine.
pub const ANSWER: &str = "\nthe answer of hodograph derive-worker:\n";

/// Runs the child process. It reads the model, with its parts expanded, from standard input and writes its
/// answer at the end of standard output. So no temporary file is needed.
fn run(model: &Model, limits: &Limits, trace: bool) -> Outcome<String> {
    if !cfg!(feature = "derive") {
        return Err(Stop::Fault(
            "this build of the tool reads derivations but makes none: build it with its feature `derive`"
                .to_owned(),
        ));
    }
    let name = model.source.name();
    let fault = |what: &str, error: std::io::Error| Stop::Fault(format!("{what}: {error}"));
    let tool =
        std::env::current_exe().map_err(|error| fault("cannot find this program's own file", error))?;
    let mut child = Command::new(tool)
        .arg(WORKER)
        .args(trace.then_some("--trace"))
        .args(["--", name])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| fault("cannot start the process that derives", error))?;
    if let Some(mut input) = child.stdin.take() {
        // The child reads all of its input first; if it ends early, its exit code is reported below.
        let _ = input.write_all(plain(&model.source).as_bytes());
    }
    let output = child.stdout.take();
    let reader =
        std::thread::spawn(move || output.map(|output| files::up_to(output, 2 * artifact::MAX_BYTES)));
    let status = wait(child, name, limits)?;
    let written = reader.join();
    if !status.success() {
        return Err(match status.code() {
            Some(1) => Stop::Reported,
            _ => Stop::Fault(format!(
                "deriving {name} ended with {status}; what was said of it is above. The algebra engine ends the process where another \
                 program of this user holds it: then try again. If it does so alone, please report it with the model"
            )),
        });
    }
    let Ok(Some(Ok(written))) = written else {
        return Err(Stop::Fault(format!("the derivation of {name} could not be read, or is too large")));
    };
    let written = String::from_utf8_lossy(&written);
    match written.split_once(ANSWER) {
        Some((_, answer)) => Ok(answer.to_owned()),
        None => Err(Stop::Fault(format!("the process that derives {name} gave no answer"))),
    }
}

/// Waits for the child; shows progress after a second, and ends the child at the time limit.
fn wait(mut child: Child, name: &str, limits: &Limits) -> Outcome<ExitStatus> {
    let start = Instant::now();
    let mut progress: Option<ProgressBar> = None;
    let mut pause = Duration::from_millis(2);
    loop {
        let status = child
            .try_wait()
            .map_err(|error| Stop::Fault(format!("cannot wait for the derivation: {error}")))?;
        if let Some(status) = status {
            if let Some(progress) = progress {
                progress.finish_and_clear();
            }
            return Ok(status);
        }
        if start.elapsed() > Duration::from_secs(limits.time_limit) {
            let _ = child.kill();
            let _ = child.wait();
            return Err(Stop::Fault(format!(
                "deriving {name} took more than {} seconds: give more with --time-limit, or simplify the model",
                limits.time_limit
            )));
        }
        if progress.is_none() && start.elapsed() > Duration::from_secs(1) {
            progress = Some(show(name));
        }
        if let Some(progress) = &progress {
            progress.tick();
        }
        std::thread::sleep(pause);
        pause = (pause * 2).min(Duration::from_millis(100));
    }
}

fn show(name: &str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        output::say(format_args!("deriving {name} .."));
    }
    let style = ProgressStyle::with_template("{spinner} deriving {msg} [{elapsed}]");
    let progress = ProgressBar::new_spinner().with_message(name.to_owned());
    style.map_or(progress.clone(), |style| progress.with_style(style))
}

/// Writes a derivation file, completely or not at all.
///
/// # Errors
///
/// [`Stop::Fault`].
pub fn write(path: &Path, text: &str) -> Outcome {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|error| Stop::unwritable(path, &error))?;
    output::file(path, text.as_bytes())
}
