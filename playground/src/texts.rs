//! The texts of a question: a model, and the files that it may import.

use std::collections::BTreeMap;
use std::rc::Rc;

use hodograph_language::Document;
use hodograph_model::parts::{Files, Imported};
use hodograph_model::source::Source;
use serde_json::Value;

/// A model and what it may import.
pub struct Texts<'q> {
    /// the model
    pub text: &'q str,
    name: &'q str,
    others: Rc<Others>,
}

impl<'q> Texts<'q> {
    /// Those of a question: `text`, `name`, and `files` by their names.
    ///
    /// # Errors
    ///
    /// It has no text.
    pub fn of(question: &'q Value) -> Result<Self, String> {
        let text = question["text"].as_str().ok_or("the question has no text")?;
        let name = question["name"].as_str().unwrap_or("model.mech");
        let mut files = BTreeMap::new();
        for (name, text) in question["files"].as_object().into_iter().flatten() {
            files.insert(name.clone(), text.as_str().unwrap_or("").to_owned());
        }
        Ok(Texts { text, name, others: Rc::new(Others { root: name.to_owned(), files }) })
    }

    /// All texts as models, with their names.
    pub fn all(&self) -> Vec<(String, Document)> {
        let mut files = self.others.files.clone();
        files.insert(self.name.to_owned(), self.text.to_owned());
        let model = |(name, text): (&String, &String)| {
            let others = Others { root: name.clone(), files: files.clone() };
            (name.clone(), Document::importing(text.as_str(), name, Rc::new(others)))
        };
        files.iter().map(model).collect()
    }

    /// The name of the text.
    pub fn name(&self) -> &str {
        self.name
    }

    /// The model as `check` reads it.
    pub fn source(&self) -> Source {
        Source::file(self.name, self.text).importing(&*self.others)
    }

    /// The model as an editor asks of it.
    pub fn document(&self) -> Document {
        Document::importing(self.text, self.name, self.others.clone())
    }
}

/// The files beside a model.
struct Others {
    root: String,
    files: BTreeMap<String, String>,
}

impl Files for Others {
    fn read(&self, importing: Option<&Imported>, path: &str) -> Result<Imported, String> {
        let from = importing.map_or(self.root.as_str(), |file| file.key.as_str());
        let name = joined(from, path);
        let text = self.files.get(&name).ok_or("is no file of this page")?;
        Ok(Imported { key: name.clone(), name, text: text.clone() })
    }
}

/// Where a path leads from the folder of a file.
fn joined(from: &str, path: &str) -> String {
    let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    #[test]
    fn paths_are_those_of_the_folder_of_the_importing_file() {
        for (from, path, to) in [
            ("model.mech", "leg.mech", "leg.mech"),
            ("model.mech", "./parts/leg.mech", "parts/leg.mech"),
            ("parts/leg.mech", "foot.mech", "parts/foot.mech"),
            ("parts/leg.mech", "../foot.mech", "foot.mech"),
            ("model.mech", "../foot.mech", "../foot.mech"),
        ] {
            assert_eq!(super::joined(from, path), to);
        }
    }
}
