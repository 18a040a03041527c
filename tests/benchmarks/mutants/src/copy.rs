//! A copy of the repository's files for the mutants, in this package's target folder.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::Outcome;

/// Copies every file that git knows. The folder `target` of an earlier copy stays.
pub fn of_the_repository(root: &Path) -> Outcome<PathBuf> {
    let copy = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/copy");
    let listed = Command::new("git").current_dir(root).args(["ls-files", "-z"]).output()?;
    if !listed.status.success() {
        return Err("git ls-files failed".into());
    }
    for name in String::from_utf8(listed.stdout)?.split_terminator('\0') {
        let (from, to) = (root.join(name), copy.join(name));
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder)?;
        }
        if from.is_file() {
            fs::copy(from, to)?;
        }
    }
    Ok(copy)
}
