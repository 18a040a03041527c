//! One derivation at a time: the engine may be used by a single thread of a user, and aborts the process otherwise.
//!
//! A lock file excludes other processes, a mutex other threads of this one; the work then runs on a fresh thread with a
//! large stack, returns owned data only, and is joined before the locks go. There is no other door to the engine.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Why no session could be held.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SessionError {
    /// the lock file cannot be used
    Lock {
        /// its path
        path: PathBuf,
        /// what the system said
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
                "the lock file {} that keeps derivations apart cannot be used: {reason}; make it writable",
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

/// Stack of the working thread: expressions are walked recursively.
const STACK: usize = 512 << 20;

static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Runs `work` as the only user of the algebra engine, waiting (and saying so on stderr) while another holds it.
pub fn exclusively<R: Send + 'static>(work: impl FnOnce() -> R + Send + 'static) -> Result<R, SessionError> {
    let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let lock = acquire()?;
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

/// The lock file: one for all processes of a user, wherever they run.
pub fn lock_path() -> PathBuf {
    let home = std::env::home_dir().filter(|home| home.is_dir());
    let folder = home.map(|home| home.join(".cache").join("hodograph"));
    let folder = folder.filter(|folder| std::fs::create_dir_all(folder).is_ok());
    // Without a home of their own, users must not meet in one file.
    let elsewhere = || {
        let user = ["USER", "LOGNAME", "USERNAME"].into_iter().find_map(|name| std::env::var(name).ok());
        std::env::temp_dir().join(format!("hodograph-{}", user.as_deref().unwrap_or("unnamed")))
    };
    folder.unwrap_or_else(elsewhere).join("algebra-engine.lock")
}

fn acquire() -> Result<File, SessionError> {
    let path = lock_path();
    let failed =
        |reason: std::io::Error| SessionError::Lock { path: path.clone(), reason: reason.to_string() };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    let file = OpenOptions::new().create(true).append(true).open(&path).map_err(failed)?;
    for _ in 0..20 {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) => thread::sleep(Duration::from_millis(50)),
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
    }
    eprintln!(
        "hodograph: waiting for another derivation to end: one at a time may use the algebra engine (lock {})",
        path.display()
    );
    file.lock().map_err(failed)?;
    Ok(file)
}
