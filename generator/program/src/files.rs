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
/// There is no such file, it may not be read, it is no file, or it is too large: its kind is
/// [`ErrorKind::FileTooLarge`] then.
pub fn bytes(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    let refused = |why: &str| Err(io::Error::new(ErrorKind::InvalidInput, why));
    let data = std::fs::metadata(path).map_err(plain)?;
    if data.is_dir() {
        return refused("it is a directory");
    }
    // opening a pipe without a writer would wait, and some devices never end
    if !data.is_file() {
        return refused("it is a pipe or a device, not a file");
    }
    up_to(File::open(path).map_err(plain)?, most)
}

/// The text of a file of at most `most` bytes.
///
/// # Errors
///
/// As [`bytes`], and where it is no UTF-8.
pub fn text(path: &Path, most: usize) -> io::Result<String> {
    String::from_utf8(bytes(path, most)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        io::Error::new(ErrorKind::InvalidData, format!("it is no UTF-8 text at byte {at}; save it as UTF-8"))
    })
}

/// A model in a file. What goes wrong is reported when it is checked.
pub fn model(path: &Path) -> Source {
    model_as(path.display().to_string(), path)
}

/// As [`model`], with the name that messages give it.
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

/// Finds what a model imports by paths relative to its file.
#[derive(Clone, Debug)]
pub struct Beside {
    /// the file of the model
    pub path: PathBuf,
    /// what messages call it
    pub name: String,
}

impl Files for Beside {
    fn read(&self, importing: Option<&Imported>, path: &str) -> Result<Imported, String> {
        if Path::new(path).has_root() {
            return Err("is no relative path".to_owned());
        }
        let (from, name) = match importing {
            None => (self.path.as_path(), self.name.as_str()),
            Some(file) => (Path::new(&file.key), file.name.as_str()),
        };
        let found = from.with_file_name("").join(path);
        let text = text(&found, source::MAX_BYTES).map_err(|error| format!("cannot be read: {error}"))?;
        let key = std::fs::canonicalize(&found).unwrap_or(found).to_string_lossy().into_owned();
        let name = plainly(&Path::new(name).with_file_name("").join(path));
        Ok(Imported { key, name, text })
    }
}

/// A path without `.` and, where a folder stands before it, without `..`.
fn plainly(path: &Path) -> String {
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

/// All that a reader has, if that is at most `most` bytes.
///
/// # Errors
///
/// It has more, or reading fails.
pub fn up_to(reader: impl Read, most: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(most as u64 + 1).read_to_end(&mut bytes).map_err(plain)?;
    if bytes.len() > most {
        let size = if most >= 1 << 20 { format!("{} MiB", most >> 20) } else { format!("{most} bytes") };
        return Err(io::Error::new(ErrorKind::FileTooLarge, format!("it is larger than {size}")));
    }
    Ok(bytes)
}

/// The commonest reasons in words.
fn plain(error: io::Error) -> io::Error {
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
            assert_eq!(plainly(Path::new(path)), expected);
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
