//! The documents of a client, and what they import of each other.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use gen_lsp_types as lsp;
use hodograph_generator::diagnostics::codes;
use hodograph_generator::files;
use hodograph_generator::parts::Files;
use hodograph_language::Document;
use hodograph_language::text::{Encoding, Text};

use super::answers::{self, Located};
use super::texts::Texts;
use super::uri;

/// A document that the client has opened.
pub struct Open {
    pub text: Text,
    pub version: i32,
    /// its file, and what that is known by
    file: Option<(PathBuf, String)>,
    /// what is known of this text; nothing until it is asked for
    pub document: Option<Document>,
    published: bool,
}

impl Open {
    /// What is known of it.
    pub fn document(&mut self, texts: &Texts) -> &Document {
        self.document.get_or_insert_with(|| match &self.file {
            None => Document::new(self.text.as_str()),
            Some((path, _)) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                Document::importing(self.text.as_str(), &name, texts.beside(path))
            }
        })
    }

    /// What its file is known by; empty where it has none.
    pub fn key(&self) -> &str {
        self.file.as_ref().map_or("", |(_, key)| key)
    }

    /// Its file, if it has one.
    pub fn path(&self) -> Option<&Path> {
        self.file.as_ref().map(|(path, _)| path.as_path())
    }

    /// The number of a file that it imports.
    pub fn imports(&self, key: &str) -> Option<usize> {
        let files = &self.document.as_ref()?.source().expansion()?.files;
        Some(files.iter().position(|file| file.key == key)? + 1)
    }

    /// Whether it is to be read anew where a file has changed.
    fn depends_on(&self, key: &str) -> bool {
        let missing = |document: &Document| {
            document.analysis().diagnostics.iter().any(|found| found.code == codes::IMPORT)
        };
        self.imports(key).is_some() || self.document.as_ref().is_some_and(missing)
    }
}

/// All documents that are open.
#[derive(Default)]
pub struct Documents {
    list: BTreeMap<String, Open>,
    /// what of it others import
    texts: Texts,
    /// how the client counts characters
    pub encoding: Encoding,
}

/// A document and what is wrong with it.
pub struct Settled {
    pub name: String,
    pub version: i32,
    pub diagnostics: Vec<lsp::Diagnostic>,
}

impl Documents {
    /// A document of this name.
    pub fn get(&self, name: &str) -> Option<&Open> {
        self.list.get(name)
    }

    /// All, with their names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Open)> {
        self.list.iter().map(|(name, open)| (name.as_str(), open))
    }

    /// What is known of a document.
    pub fn document(&mut self, name: &str) -> Option<&Document> {
        Some(self.list.get_mut(name)?.document(&self.texts))
    }

    /// Reads those that have changed.
    pub fn read_all(&mut self) {
        for open in self.list.values_mut() {
            // one that cannot be read has no document
            let _ = catch_unwind(AssertUnwindSafe(|| open.document(&self.texts).text().lines()));
        }
    }

    /// What a model in a file may import.
    pub fn beside(&self, path: &Path) -> Rc<dyn Files> {
        self.texts.beside(path)
    }

    /// A document is opened.
    pub fn open(&mut self, name: String, text: String, version: i32) {
        let file = uri::path(&name).map(|path| {
            let key = files::key(&path);
            (path, key)
        });
        let open = Open { text: Text::new(text), version, file, document: None, published: false };
        self.list.insert(name.clone(), open);
        self.has_new_text(&name);
    }

    /// A document has another text.
    pub fn change(&mut self, name: &str, text: Text, version: i32) {
        self.is_left(name);
        if let Some(open) = self.list.get_mut(name) {
            (open.text, open.version) = (text, version);
        }
        self.has_new_text(name);
    }

    /// A document is closed; whether it was open.
    pub fn close(&mut self, name: &str) -> bool {
        self.is_left(name);
        let Some(open) = self.list.remove(name) else { return false };
        self.texts.remove(open.key());
        self.file_has_changed(open.key());
        true
    }

    /// What imports a document is read anew, and what it imports shown anew.
    fn has_new_text(&mut self, name: &str) {
        let Some(open) = self.list.get(name) else { return };
        let key = open.key().to_owned();
        if !key.is_empty() {
            self.texts.set(&key, open.text.as_str());
        }
        if let Some(open) = self.list.get_mut(name) {
            (open.document, open.published) = (None, false);
        }
        self.file_has_changed(&key);
    }

    /// What a document imports no longer shows what it found there.
    fn is_left(&mut self, name: &str) {
        let Some(open) = self.list.get(name) else { return };
        let imported = |(_, other): &(&String, &Open)| open.imports(other.key()).is_some();
        let names: Vec<String> = self.list.iter().filter(imported).map(|(name, _)| name.clone()).collect();
        names.iter().for_each(|name| {
            if let Some(open) = self.list.get_mut(name) {
                open.published = false;
            }
        });
    }

    /// What imports a file is read anew.
    pub fn file_has_changed(&mut self, key: &str) {
        for open in self.list.values_mut().filter(|open| open.depends_on(key)) {
            (open.document, open.published) = (None, false);
        }
    }

    /// Reads the texts that have changed; what is wrong with them. What is imported shows what the models that
    /// import it find there.
    pub fn settle(&mut self) -> Vec<Settled> {
        let mut left: Vec<String> = Vec::new();
        for (name, open) in self.list.iter_mut().filter(|(_, open)| !open.published) {
            // a document that cannot be read has no diagnostics
            let _ = catch_unwind(AssertUnwindSafe(|| open.document(&self.texts).text().lines()));
            open.published = true;
            left.push(name.clone());
        }
        for (other, shown) in &self.list {
            let imported = |name: &String| self.list[name].imports(shown.key()).is_some();
            if left.iter().any(imported) && !left.contains(other) {
                left.push(other.clone());
            }
        }
        left.sort();
        let settled = left.into_iter().map(|name| {
            let found = catch_unwind(AssertUnwindSafe(|| self.diagnostics(&name)));
            let version = self.list[&name].version;
            Settled { name, version, diagnostics: found.unwrap_or_default() }
        });
        settled.collect()
    }

    /// What is wrong with a document, by itself and by what imports it.
    fn diagnostics(&self, name: &str) -> Vec<lsp::Diagnostic> {
        let open = &self.list[name];
        let mut found = open
            .document
            .as_ref()
            .map_or(Vec::new(), |document| answers::diagnostics(self.located(document, name), 0));
        for (other, importing) in &self.list {
            let Some((document, file)) = importing.document.as_ref().zip(importing.imports(open.key()))
            else {
                continue;
            };
            for more in answers::diagnostics(self.located(document, other), file) {
                let same = |known: &lsp::Diagnostic| {
                    (&known.range, &known.code, &known.message) == (&more.range, &more.code, &more.message)
                };
                if !found.iter().any(same) {
                    found.push(more);
                }
            }
        }
        found
    }

    /// The name of a file by what it is known by: that of the client where it is open.
    pub fn uri_of(&self, key: &str) -> lsp::Uri {
        let open = self.list.iter().find(|(_, open)| open.key() == key);
        lsp::Uri(open.map_or_else(|| uri::of(key.as_ref()), |(name, _)| name.clone()))
    }

    /// A document with the places of its texts.
    pub fn located<'a>(&'a self, document: &'a Document, name: &str) -> Located<'a> {
        let imported = document.source().expansion().into_iter().flat_map(|expansion| &expansion.files);
        let uris =
            std::iter::once(lsp::Uri(name.to_owned())).chain(imported.map(|file| self.uri_of(&file.key)));
        Located { document, uris: uris.collect(), encoding: self.encoding }
    }
}
