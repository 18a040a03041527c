//! Standard output, to which nothing but results goes, and files, which are written whole or not at all.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use crate::stop::{Outcome, Stop};

/// Writes text and flushes it.
///
/// # Errors
///
/// [`Stop::ReaderGone`] where the other end of the pipe is closed.
pub fn text(text: &str) -> Outcome {
    bytes(text.as_bytes())
}

/// Writes bytes and flushes them.
///
/// # Errors
///
/// As [`text`].
pub fn bytes(bytes: &[u8]) -> Outcome {
    let mut stdout = io::stdout().lock();
    stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Stop::ReaderGone,
        _ => Stop::Fault(format!("cannot write to standard output: {error}")),
    })
}

/// Writes a line and flushes it.
///
/// # Errors
///
/// As [`text`].
pub fn line(line: &str) -> Outcome {
    text(&format!("{line}\n"))
}

/// Writes a value as one line of JSON.
///
/// # Errors
///
/// As [`text`].
pub fn json(value: &impl serde::Serialize) -> Outcome {
    let line_of =
        serde_json::to_string(value).map_err(|error| Stop::Fault(format!("cannot write JSON: {error}")))?;
    line(&line_of)
}

/// Writes a file, whole or not at all: beside its place first, and moved there when it is complete.
///
/// # Errors
///
/// The file cannot be written: then what was there before is there still.
pub fn file(path: &Path, bytes: &[u8]) -> Outcome {
    written(path, bytes).map_err(|error| Stop::unwritable(path, &error))
}

fn written(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // What a link points to is written, not the link; a device or pipe has no place beside it.
    let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if std::fs::metadata(&place).is_ok_and(|data| !data.is_file() && !data.is_dir()) {
        return std::fs::OpenOptions::new().write(true).open(&place)?.write_all(bytes);
    }
    let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".hodograph");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As a new file of the user: the mask of the process applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    if let Ok(data) = std::fs::metadata(&place) {
        file.as_file().set_permissions(data.permissions())?;
    }
    file.persist(&place).map(drop).map_err(|error| error.error)
}

/// Says why a command stopped, and gives the exit code.
pub fn report(stop: Stop) -> ExitCode {
    match stop {
        Stop::Call(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
        Stop::Fault(message) => {
            eprintln!("error: {message}");
            ExitCode::from(1)
        }
        Stop::Object(failure) => {
            let _ = line(&failure.to_line());
            ExitCode::from(1)
        }
        Stop::Said => ExitCode::from(1),
        Stop::ReaderGone => ExitCode::SUCCESS,
    }
}
