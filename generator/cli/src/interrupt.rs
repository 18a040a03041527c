//! Handles signals: a file or folder that is being written is removed before the process ends.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files and folders that are not complete.
static BEGUN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn begun() -> MutexGuard<'static, Vec<PathBuf>> {
    BEGUN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// As long as it lives, a signal that ends the process removes the file or folder.
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// The file or folder at this path is being written.
    pub fn file(path: &Path) -> Self {
        begun().push(path.to_path_buf());
        Unfinished(path.to_path_buf())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        begun().retain(|path| *path != self.0);
    }
}

/// From now on files that are not complete are removed when the user or the system ends the process, which
/// then ends as it would have.
#[cfg(unix)]
pub fn clean_up() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::low_level::emulate_default_handler;
    // Where no handler can be set, signals end the process as always.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            // Kept until the end: nothing begins after this.
            let begun = begun();
            begun
                .iter()
                .for_each(|path| drop(std::fs::remove_file(path).or_else(|_| std::fs::remove_dir_all(path))));
            let _ = emulate_default_handler(signal);
            std::process::exit(128 + signal);
        }
    });
}

/// Elsewhere there is nothing to be set.
#[cfg(not(unix))]
pub fn clean_up() {}
