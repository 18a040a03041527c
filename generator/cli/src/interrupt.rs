//! Handles signals: a file or folder that is being written is removed before the process ends.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files and folders that are being written.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While it lives, a signal that ends the process removes the file or folder.
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// Registers the file or folder at this path as unfinished.
    pub fn file(path: &Path) -> Self {
        unfinished().push(path.to_path_buf());
        Unfinished(path.to_path_buf())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

/// Installs handlers that remove unfinished files when the user or the system ends the process; the process
/// then ends as it would have without them.
#[cfg(unix)]
pub fn clean_up() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::low_level::emulate_default_handler;
    // If no handler can be installed, signals end the process as always.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            // Keep the lock until the process ends, so that no further file is begun.
            let unfinished = unfinished();
            unfinished
                .iter()
                .for_each(|path| drop(std::fs::remove_file(path).or_else(|_| std::fs::remove_dir_all(path))));
            let _ = emulate_default_handler(signal);
            std::process::exit(128 + signal);
        }
    });
}

/// Other systems have no handlers.
#[cfg(not(unix))]
pub fn clean_up() {}
