//! Runs one derivation at a time. The engine allows one thread per user and aborts the process otherwise.
//!
//! A lock file excludes other processes, and a mutex excludes other threads of this one. The work runs on a
//! new thread with a large stack, returns owned data only, and ends before the locks are released. No other
//! code uses the engine.

mod lock;

use std::fs::OpenOptions;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::thread;

pub use lock::lock_path;

/// Why no session could be started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SessionError {
    /// the lock file cannot be used
    Lock {
        /// its path
        path: PathBuf,
        /// the error of the system
        reason: String,
    },
    /// the engine needs a home directory that can be written
    Home {
        /// the home directory
        path: PathBuf,
        /// the error of the system
        reason: String,
    },
    /// the thread could not be started
    Thread(String),
    /// the work panicked
    Panicked(String),
}

impl std::fmt::Display for SessionError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Lock { path, reason } => write!(
                f,
                "the lock file {} that keeps derivations apart cannot be used: {reason}; let this user write there (if another user \
                 made the file or its folder, remove it)",
                path.display()
            ),
            Self::Home { path, reason } => write!(
                f,
                "the algebra engine needs a home directory that it can write to, but {} is none: {reason}; set HOME to one",
                path.display()
            ),
            Self::Thread(reason) => write!(f, "no thread for the derivation could be started: {reason}"),
            Self::Panicked(what) => {
                write!(f, "the derivation failed inside: {what}; please report it with the model")
            }
        }
    }
}

impl std::error::Error for SessionError {}

/// Stack of the working thread, since expressions are traversed recursively.
const STACK: usize = 512 << 20;

static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Runs `work` as the only user of the algebra engine. Waits while another process uses the engine, and
/// reports this on standard error.
pub fn exclusively<R: Send + 'static>(work: impl FnOnce() -> R + Send + 'static) -> Result<R, SessionError> {
    let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let lock = lock::acquire()?;
    writable_home()?;
    let worker = thread::Builder::new().name("derivation".into()).stack_size(STACK);
    let result = worker.spawn(work).map_err(|e| SessionError::Thread(e.to_string())).and_then(|handle| {
        handle.join().map_err(|panic| {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| text.to_string()));
            SessionError::Panicked(text.unwrap_or_else(|| "unknown panic".into()))
        })
    });
    drop(lock);
    result
}

/// Checks that the engine can store its permit below the home directory, since it ends the process if it
/// cannot.
fn writable_home() -> Result<(), SessionError> {
    let Some(home) = std::env::home_dir().filter(|home| !home.as_os_str().is_empty()) else { return Ok(()) };
    // The name is unpredictable; an existing file or link is not opened.
    let now = std::time::UNIX_EPOCH.elapsed().map_or(0, |since| since.as_nanos());
    let probe = home.join(format!(".hodograph-{}-{now}", std::process::id()));
    let written = std::fs::create_dir_all(&home)
        .and_then(|()| OpenOptions::new().write(true).create_new(true).open(&probe))
        .and_then(|_| std::fs::remove_file(&probe));
    written.map_err(|error| SessionError::Home { path: home, reason: error.to_string() })
}
