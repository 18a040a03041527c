//! The lock file: one for all processes of a user, even if their environment variables name different home
//! and temporary directories.

use std::fs::{DirBuilder, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::SessionError;

/// The lock file. Its path depends only on the user: all environments of a user must share it, and different
/// users must not.
pub fn lock_path() -> PathBuf {
    folder().join("algebra-engine.lock")
}

#[cfg(unix)]
fn folder() -> PathBuf {
    Path::new("/tmp").join(format!("hodograph-{}", rustix::process::geteuid().as_raw()))
}

/// On other systems the temporary directory belongs to the user.
#[cfg(not(unix))]
fn folder() -> PathBuf {
    std::env::temp_dir().join("hodograph")
}

/// Waits for the lock, and reports this on standard error if it takes more than a moment.
pub(super) fn acquire() -> Result<File, SessionError> {
    let path = lock_path();
    let failed = |error: io::Error| SessionError::Lock { path: path.clone(), reason: error.to_string() };
    let mut said = false;
    loop {
        let file = open(&path).map_err(failed)?;
        wait(&file, &path, &mut said).map_err(failed)?;
        if is_still(&path, &file) {
            return Ok(file);
        }
    }
}

fn open(path: &Path) -> io::Result<File> {
    if let Some(folder) = path.parent() {
        let mut builder = DirBuilder::new();
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
        builder.recursive(true).create(folder)?;
        belongs_to_user(folder)?;
    }
    // a lock needs only the right to read, which exists even on a read-only medium
    let written = OpenOptions::new().create(true).append(true).open(path);
    written.or_else(|error| File::open(path).map_err(|_| error))
}

/// The owner of the folder could redirect the file in it.
#[cfg(unix)]
fn belongs_to_user(folder: &Path) -> io::Result<()> {
    use std::os::unix::fs::MetadataExt;
    let data = std::fs::symlink_metadata(folder)?;
    if data.is_dir() && data.uid() == rustix::process::geteuid().as_raw() {
        return Ok(());
    }
    let why = format!("{} is not a folder of this user", folder.display());
    Err(io::Error::new(io::ErrorKind::PermissionDenied, why))
}

#[cfg(not(unix))]
fn belongs_to_user(_folder: &Path) -> io::Result<()> {
    Ok(())
}

fn wait(file: &File, path: &Path, said: &mut bool) -> io::Result<()> {
    for _ in 0..20 {
        match file.try_lock() {
            Ok(()) => return Ok(()),
            Err(TryLockError::WouldBlock) => thread::sleep(Duration::from_millis(50)),
            Err(TryLockError::Error(error)) => return Err(error),
        }
    }
    if !*said {
        *said = true;
        // Errors of writing the message are ignored.
        let _ = writeln!(
            io::stderr().lock(),
            "hodograph: waiting for another derivation to end: one at a time may use the algebra engine (lock {})",
            path.display()
        );
    }
    file.lock()
}

/// Temporary directories are cleaned up: a deleted file excludes nobody.
#[cfg(unix)]
fn is_still(path: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let (there, locked) = (std::fs::metadata(path), file.metadata());
    matches!((there, locked), (Ok(a), Ok(b)) if (a.dev(), a.ino()) == (b.dev(), b.ino()))
}

#[cfg(not(unix))]
fn is_still(path: &Path, _file: &File) -> bool {
    path.exists()
}
