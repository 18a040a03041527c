//! Reads files up to a maximum size. Pipes, devices and larger files are refused, so that reading always
//! ends.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};

use hodograph_model::parts::{Files, Imported};
use hodograph_model::source::{self, Source};

/// The bytes of a file of at most `most` bytes.
///
/// # Errors
///
/// There is no such file, it may not be read, it is not a regular file, or it is too large (then the kind of
/// the error is [`ErrorKind::FileTooLarge`]).
pub fn bytes(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    let refused = |why: &str| Err(io::Error::new(ErrorKind::InvalidInput, why));
    let data = std::fs::metadata(path).map_err(in_words)?;
    if data.is_dir() {
        return refused("it is a directory");
    }
    // Opening a pipe without a writer would wait, and reading some devices never ends.
    if !data.is_file() {
        return refused("it is a pipe or a device, not a file");
    }
    up_to(File::open(path).map_err(in_words)?, most)
}

/// The text of a file of at most `most` bytes.
///
/// # Errors
///
/// Those of [`bytes`]; and the text is not UTF-8.
pub fn text(path: &Path, most: usize) -> io::Result<String> {
    String::from_utf8(bytes(path, most)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        io::Error::new(ErrorKind::InvalidData, format!("it is not UTF-8 text at byte {at}; save it as UTF-8"))
    })
}

/// A model in a file. Errors of reading it are reported when the model is checked.
pub fn model(path: &Path) -> Source {
    model_as(path.display().to_string(), path)
}

/// A model in a file under the given name, which messages use.
pub fn model_as(name: impl Into<String>, path: &Path) -> Source {
    match bytes(path, source::MAX_BYTES) {
        Ok(bytes) => {
            let name = name.into();
            let imports = Beside { path: path.to_path_buf(), name: name.clone() };
            Source::bytes(name, bytes).importing(&imports)
        }
        Err(error) if error.kind() == ErrorKind::FileTooLarge => Source::too_large(name.into()),
        Err(error) => {
            let message = format!("the file cannot be read: {error}");
            Source::unreadable(name.into(), message, "check the path")
        }
    }
}

/// Reads the files that a model imports by paths relative to its own file.
#[derive(Clone, Debug)]
pub struct Beside {
    /// the file of the model
    pub path: PathBuf,
    /// the name of the model in messages
    pub name: String,
}

impl Beside {
    /// Where a path leads that stands in the model or in a file that it imports, and what messages call that.
    ///
    /// # Errors
    ///
    /// Why it leads nowhere, as the rest of a sentence about the path.
    pub fn find(&self, importing: Option<&Imported>, path: &str) -> Result<(PathBuf, String), String> {
        if Path::new(path).has_root() {
            return Err("is no relative path".to_owned());
        }
        let (from, name) = match importing {
            None => (self.path.as_path(), self.name.as_str()),
            Some(file) => (Path::new(&file.key), file.name.as_str()),
        };
        let name = normalised(&Path::new(name).with_file_name("").join(path));
        Ok((from.with_file_name("").join(path), name))
    }
}

impl Files for Beside {
    fn read(&self, importing: Option<&Imported>, path: &str) -> Result<Imported, String> {
        let (found, name) = self.find(importing, path)?;
        let text = text(&found, source::MAX_BYTES).map_err(|error| format!("cannot be read: {error}"))?;
        Ok(Imported { key: key(&found), name, text })
    }
}

/// What a file is known by, however its path is written.
pub fn key(path: &Path) -> String {
    let known = std::fs::canonicalize(path);
    known.unwrap_or_else(|_| PathBuf::from(normalised(path))).to_string_lossy().into_owned()
}

/// A path without `.` and, where a folder stands before it, without `..`.
fn normalised(path: &Path) -> String {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.iter().collect::<PathBuf>().to_string_lossy().into_owned()
}

/// Everything that a reader yields, if that is at most `most` bytes.
///
/// # Errors
///
/// The reader yields more, or reading fails.
pub fn up_to(reader: impl Read, most: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(most as u64 + 1).read_to_end(&mut bytes).map_err(in_words)?;
    if bytes.len() > most {
        let size = if most >= 1 << 20 { format!("{} MiB", most >> 20) } else { format!("{most} bytes") };
        return Err(io::Error::new(ErrorKind::FileTooLarge, format!("it is larger than {size}")));
    }
    Ok(bytes)
}

/// An error with the commonest reasons in words.
fn in_words(error: io::Error) -> io::Error {
    let words = match error.kind() {
        ErrorKind::NotFound => "there is no such file",
        ErrorKind::PermissionDenied => "permission to read it is denied",
        _ => return error,
    };
    io::Error::new(error.kind(), words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_ends() {
        let folder = std::env::temp_dir();
        assert_eq!(bytes(&folder, 10).unwrap_err().to_string(), "it is a directory");
        let missing = bytes(&folder.join("hodograph no such file"), 10).unwrap_err();
        assert_eq!(
            (missing.kind(), missing.to_string().as_str()),
            (ErrorKind::NotFound, "there is no such file")
        );
        assert_eq!(up_to(&[7; 10][..], 10).unwrap().len(), 10);
        assert_eq!(up_to(io::repeat(7), 10).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }

    #[test]
    fn paths_of_imports_are_plain() {
        for (path, expected) in [("a/./b", "a/b"), ("a/../b", "b"), ("../b", "../b"), ("a/b/../../c", "c")] {
            assert_eq!(normalised(Path::new(path)), expected);
        }
    }

    #[test]
    #[cfg(unix)]
    fn devices_are_refused() {
        for device in ["/dev/zero", "/dev/null"] {
            assert_eq!(bytes(Path::new(device), 10).unwrap_err().kind(), ErrorKind::InvalidInput);
        }
    }
}
