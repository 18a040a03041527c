//! Renaming in all models that have a name: those that are open, and files that are not.

use std::path::{Path, PathBuf};

use gen_lsp_types as lsp;
use hodograph_generator::{files, source};
use hodograph_language::Document;
use hodograph_language::rename_with_parts::{self, Known, Renamed};
use hodograph_language::text::Text;

use super::convert::Places;
use super::documents::Documents;

/// At most so many files and folders are looked at for models that import a part.
const MOST_ENTRIES: usize = 20_000;
/// So deep.
const MOST_DEPTH: usize = 16;

/// The changes that give the name at a place of an open document another; `folders` are those of the workspace.
///
/// # Errors
///
/// Why it cannot be renamed.
pub fn rename(
    documents: &mut Documents,
    name: &str,
    offset: u32,
    new: &str,
    folders: &[PathBuf],
) -> Result<lsp::WorkspaceEdit, String> {
    documents.read_all();
    let open = documents.get(name).ok_or_else(|| format!("{name} is not open"))?;
    let document = open.document.as_ref().ok_or_else(|| format!("{name} cannot be read"))?;
    let shares = document.source().is_library() || document.source().imported().next().is_some();
    let own = open.path().and_then(Path::parent);
    let folders: Vec<&Path> = folders.iter().map(PathBuf::as_path).chain(own).filter(|_| shares).collect();
    let closed = closed(documents, &folders);
    let known = |key, document| Known { key, document };
    let others = documents.iter().filter_map(|(_, open)| Some(known(open.key(), open.document.as_ref()?)));
    let closed = closed.iter().map(|(key, document)| known(key, document));
    let others: Vec<Known<'_>> = others.chain(closed).filter(|_| shares).collect();
    let changes = rename_with_parts::rename(known(open.key(), document), offset, new, &others)?;
    let encoding = documents.encoding;
    let edits = |change: Renamed| {
        let uri =
            if change.key == open.key() { lsp::Uri(name.to_owned()) } else { documents.uri_of(&change.key) };
        let text = Text::new(change.text);
        (uri, Places { text: &text, encoding }.edits(change.edits))
    };
    let changes = changes.into_iter().map(edits).collect();
    Ok(lsp::WorkspaceEdit { changes: Some(changes), ..lsp::WorkspaceEdit::default() })
}

/// The models of these folders that are not open and import something, with what they are known by.
fn closed(documents: &Documents, folders: &[&Path]) -> Vec<(String, Document)> {
    let (mut left, mut paths) = (MOST_ENTRIES, Vec::new());
    folders.iter().for_each(|folder| models(folder, MOST_DEPTH, &mut left, &mut paths));
    let mut found: Vec<(String, Document)> = Vec::new();
    for path in paths {
        let key = files::key(&path);
        let known = documents.iter().any(|(_, open)| open.key() == key)
            || found.iter().any(|(other, _)| *other == key);
        let Some(text) =
            files::text(&path, source::MAX_BYTES).ok().filter(|text| !known && text.contains("import"))
        else {
            continue;
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        found.push((key, Document::importing(text, &name, documents.beside(&path))));
    }
    found
}

/// The files of models in a folder, without what is hidden or built.
fn models(folder: &Path, depth: usize, left: &mut usize, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    for path in paths {
        if *left == 0 {
            return;
        }
        *left -= 1;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with('.') || name == "node_modules" {
            continue;
        }
        if path.extension().is_some_and(|extension| extension == "mech") && path.is_file() {
            found.push(path);
        } else if depth > 0 && path.is_dir() && !path.is_symlink() && !path.join("CACHEDIR.TAG").exists() {
            models(&path, depth - 1, left, found);
        }
    }
}
