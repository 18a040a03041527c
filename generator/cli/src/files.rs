//! Finds the models that a command's arguments name: files, directories, Rust files with inline models.

use std::path::{Path, PathBuf};

use hodograph_generator::artifact::place;
use hodograph_generator::files;
use hodograph_generator::rust_names::snake_case;
use hodograph_generator::source::Source;

use crate::inline::{self, Invocation};
use crate::stop::{Outcome, Stop};

/// A model and the file it is in.
#[derive(Clone, Debug)]
pub struct Entry {
    /// the file
    pub path: PathBuf,
    /// the text
    pub source: Source,
    /// whether it is inline in a Rust file.
    pub inline: bool,
}

impl Entry {
    /// The path of its derivation.
    ///
    /// # Errors
    ///
    /// The model is inline and belongs to no package.
    pub fn derivation(&self, mechanism: &str) -> Outcome<PathBuf> {
        match self.inline {
            true => Ok(place::inline(&inline::package(&self.path)?, mechanism)),
            false => Ok(place::beside(&self.path)),
        }
    }

    /// A warning if the name of a model file differs from that of its mechanism.
    pub fn misnamed(&self, mechanism: &str) -> Option<String> {
        let (stem, snake) = (self.path.file_stem()?.to_string_lossy(), snake_case(mechanism));
        (!self.inline && stem != snake).then(|| {
            format!(
                "{}: warning: the file of mechanism {mechanism} should be called {snake}.mech",
                self.path.display()
            )
        })
    }
}

/// All models in the files and, recursively, directories.
///
/// # Errors
///
/// A path cannot be read, or there is no model.
pub fn collect(paths: &[PathBuf]) -> Outcome<Vec<Entry>> {
    let mut entries = Vec::new();
    for path in paths {
        let data = std::fs::metadata(path).map_err(|error| Stop::unreadable(path, &error))?;
        let mut found = Vec::new();
        if data.is_dir() {
            walk(path, &mut found)?;
        } else {
            file(path, &mut found)?;
        }
        if found.is_empty() {
            return Err(Stop::Call(format!("{} holds no model", path.display())));
        }
        for entry in found {
            match entry.inline {
                true => entries.push(entry),
                false => add(&entry.path, &mut entries),
            }
        }
    }
    Ok(entries)
}

fn file(path: &Path, entries: &mut Vec<Entry>) -> Outcome {
    if path.extension().is_none_or(|extension| extension != "rs") {
        add(path, entries);
        return Ok(());
    }
    for model in inline::models(path)? {
        match model {
            Invocation::Inline(source) => {
                entries.push(Entry { path: path.to_path_buf(), source, inline: true })
            }
            // As in the macro: relative to Cargo.toml, else to the source file.
            Invocation::File(file) => {
                let beside = path.with_file_name(&file);
                let named = inline::package(path).map(|package| package.join(&file));
                add(&named.ok().filter(|named| named.is_file()).unwrap_or(beside), entries);
            }
        }
    }
    Ok(())
}

/// Adds a model file, unless it is already there.
fn add(path: &Path, entries: &mut Vec<Entry>) {
    let real = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let this = real(path);
    if !entries.iter().any(|entry| !entry.inline && real(&entry.path) == this) {
        entries.push(Entry { path: path.to_path_buf(), source: files::model(path), inline: false });
    }
}

fn walk(folder: &Path, entries: &mut Vec<Entry>) -> Outcome {
    let unreadable = |error: std::io::Error| Stop::unreadable(folder, &error);
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        paths.push(entry.map_err(unreadable)?.path());
    }
    paths.sort();
    for path in paths {
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        let is_folder = path.is_dir() && !path.is_symlink();
        match path.extension().and_then(|extension| extension.to_str()) {
            _ if hidden => {}
            // Build output contains copies of sources.
            _ if is_folder && path.join("CACHEDIR.TAG").exists() => {}
            _ if is_folder => walk(&path, entries)?,
            Some("mech" | "rs") if path.is_file() => file(&path, entries)?,
            _ => {}
        }
    }
    Ok(())
}
