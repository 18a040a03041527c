//! Writes results to standard output, and files completely or not at all.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::interrupt::Unfinished;
use crate::stop::{Outcome, Stop};

/// Writes text and flushes it.
///
/// # Errors
///
/// [`Stop::ReaderGone`] if the other end of the pipe is closed.
pub fn text(text: &str) -> Outcome {
    bytes(text.as_bytes())
}

/// Writes bytes and flushes them.
///
/// # Errors
///
/// Those of [`text`].
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
/// Those of [`text`].
pub fn line(line: &str) -> Outcome {
    text(&format!("{line}\n"))
}

/// Writes text for people to standard error, with a newline. Errors of writing it are ignored.
pub fn say(text: impl std::fmt::Display) {
    let _ = writeln!(io::stderr().lock(), "{}", visible(&text.to_string()));
}

/// Text that is safe in a terminal: control characters except line ends and tabs, and characters that change
/// the direction of writing, are replaced by their code points.
pub fn visible(text: &str) -> String {
    let shown = |c: char| {
        let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        if turns || c.is_control() && c != '\n' && c != '\t' {
            c.escape_unicode().to_string()
        } else {
            c.to_string()
        }
    };
    text.chars().map(shown).collect()
}

/// Standard output whose reader may close the pipe before the end. Later text is dropped, but the command
/// runs to its exit code.
#[derive(Default)]
pub struct Report {
    reader_gone: bool,
}

impl Report {
    /// Writes text for people and flushes it.
    ///
    /// # Errors
    ///
    /// Writing fails for another reason than a closed pipe.
    pub fn text(&mut self, text: &str) -> Outcome {
        if self.reader_gone {
            return Ok(());
        }
        match self::text(&visible(text)) {
            Err(Stop::ReaderGone) => {
                self.reader_gone = true;
                Ok(())
            }
            other => other,
        }
    }
}

/// Writes a value as one line of JSON.
///
/// # Errors
///
/// Those of [`text`].
pub fn json(value: &impl serde::Serialize) -> Outcome {
    let line_of =
        serde_json::to_string(value).map_err(|error| Stop::Fault(format!("cannot write JSON: {error}")))?;
    line(&line_of)
}

/// Writes a file, completely or not at all: to a temporary file beside it, which is renamed when it is
/// complete.
///
/// # Errors
///
/// The file cannot be written; then a previous file is unchanged.
pub fn file(path: &Path, bytes: &[u8]) -> Outcome {
    check(path)?;
    written(path, bytes).map_err(|error| Stop::unwritable(path, &error))
}

/// Writes a file that must not exist yet, completely or not at all.
///
/// # Errors
///
/// It exists already, or cannot be written.
pub fn new_file(path: &Path, bytes: &[u8]) -> Outcome {
    let write = || -> io::Result<()> {
        let mut file = temporary(folder(path))?;
        let _unfinished = Unfinished::file(file.path());
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist_noclobber(path).map(drop).map_err(|error| error.error)
    };
    write().map_err(|error| Stop::unwritable(path, &error))
}

/// Refuses a path that [`file`] cannot write, before the result is computed.
///
/// # Errors
///
/// The path is a folder, or its folder does not exist.
pub fn check(path: &Path) -> Outcome {
    let refused = |kind| Err(Stop::unwritable(path, &io::Error::from(kind)));
    if path.is_dir() {
        return refused(io::ErrorKind::IsADirectory);
    }
    check_folder(path)
}

/// Refuses a path whose folder does not exist.
fn check_folder(path: &Path) -> Outcome {
    let refused = |kind| Err(Stop::unwritable(path, &io::Error::from(kind)));
    match folder(path).metadata() {
        Ok(data) if data.is_dir() => Ok(()),
        Ok(_) => refused(io::ErrorKind::NotADirectory),
        Err(error) => {
            let message = format!("its folder {}: {error}", folder(path).display());
            Err(Stop::unwritable(path, &io::Error::new(error.kind(), message)))
        }
    }
}

/// Refuses output files that are the same file, or an input file, under any of its paths.
///
/// # Errors
///
/// [`Stop::Call`].
pub fn check_distinct(written: &[&Path], read: &[PathBuf]) -> Outcome {
    let place = |path: &Path| -> PathBuf {
        // A file that does not exist yet is identified by its folder.
        let beside = || Some(folder(path).canonicalize().ok()?.join(path.file_name()?));
        path.canonicalize().ok().or_else(beside).unwrap_or_else(|| path.to_path_buf())
    };
    let places: Vec<PathBuf> = written.iter().map(|path| place(path)).collect();
    for (index, path) in written.iter().enumerate() {
        if places[..index].contains(&places[index]) {
            let path = path.display();
            return Err(Stop::Call(format!("{path} is given for two files: give each its own name")));
        }
        if let Some(input) = read.iter().find(|input| place(input) == places[index]) {
            return Err(Stop::Call(format!(
                "{} would overwrite {}, which is an input: give another name",
                path.display(),
                input.display()
            )));
        }
    }
    Ok(())
}

/// The folder of a file.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn written(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // The target of a link is written, not the link; devices and pipes are written directly.
    let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if std::fs::metadata(&place).is_ok_and(|data| !data.is_file() && !data.is_dir()) {
        return std::fs::OpenOptions::new().write(true).open(&place)?.write_all(bytes);
    }
    let mut file = temporary(folder(&place))?;
    let _unfinished = Unfinished::file(file.path());
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    if let Ok(data) = std::fs::metadata(&place) {
        file.as_file().set_permissions(data.permissions())?;
    }
    file.persist(&place).map(drop).map_err(|error| error.error)
}

/// A hidden temporary file in a folder.
fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".hodograph");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The permissions of a new file of the user: the mask of the process applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Writes a folder with these files (paths in it and texts), completely or not at all: to a temporary folder
/// beside it, which is renamed when it is complete.
///
/// # Errors
///
/// The folder exists or cannot be written; then nothing is left.
pub fn files(path: &Path, files: &[(String, String)]) -> Outcome {
    check_folder(path)?;
    let make = || -> io::Result<()> {
        let folder = tempfile::Builder::new().prefix(".hodograph").tempdir_in(folder(path))?;
        let _unfinished = Unfinished::file(folder.path());
        for (name, text) in files {
            let place = folder.path().join(name);
            if let Some(parent) = place.parent() {
                std::fs::create_dir_all(parent)?;
            }
            std::fs::write(place, text)?;
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o755))?;
        }
        std::fs::rename(folder.path(), path)
    };
    make().map_err(|error| Stop::unwritable(path, &error))
}

/// Reports why a command stopped, and returns the exit code.
pub fn report(stop: Stop) -> ExitCode {
    match stop {
        Stop::Call(message) => {
            say(format_args!("error: {message}"));
            ExitCode::from(2)
        }
        Stop::Fault(message) => {
            say(format_args!("error: {message}"));
            ExitCode::from(1)
        }
        Stop::Object(failure) => {
            if let Err(Stop::Fault(message)) = line(&failure.to_line()) {
                say(format_args!("error: {message}; what should stand there: {failure}"));
            }
            ExitCode::from(1)
        }
        Stop::Reported => ExitCode::from(1),
        Stop::ReaderGone => ExitCode::SUCCESS,
    }
}

/// Writes the requested help, or the mistake of the call, and returns the exit code.
pub fn answer(answer: &clap::Error) -> ExitCode {
    let written = answer.print().and_then(|()| io::stdout().flush());
    match written {
        _ if answer.use_stderr() => ExitCode::from(2),
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            report(Stop::Fault(format!("cannot write to standard output: {error}")))
        }
        _ => ExitCode::SUCCESS,
    }
}
