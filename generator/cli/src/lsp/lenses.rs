//! What stands above the name of a mechanism: the state of its derivation, and commands.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use gen_lsp_types as lsp;
use hodograph_generator::artifact::{self, place};
use hodograph_generator::files;
use hodograph_language::Document;

use super::convert::Places;
use super::jobs;

/// When a file was written, and how long it is.
type Seen = (SystemTime, u64);

/// Of which model the derivations that were read are; of what is none nothing.
#[derive(Default)]
pub struct Derivations {
    read: HashMap<PathBuf, (Seen, Option<String>)>,
}

/// So many derivations are remembered.
const MOST: usize = 64;

impl Derivations {
    /// The hash of the model whose derivation is in a file. `None`: there is no file.
    fn model(&mut self, path: &Path) -> Option<Option<String>> {
        let data = std::fs::metadata(path).ok()?;
        let seen = (data.modified().ok()?, data.len());
        if let Some((_, model)) = self.read.get(path).filter(|(before, _)| *before == seen) {
            return Some(model.clone());
        }
        let text = files::text(path, artifact::MAX_BYTES).ok();
        let model =
            text.and_then(|text| artifact::decode(&text).ok()).map(|artifact| artifact.model.to_string());
        if self.read.len() >= MOST {
            self.read.clear();
        }
        self.read.insert(path.to_owned(), (seen, model.clone()));
        Some(model)
    }

    /// The lenses of a document.
    pub fn lenses(
        &mut self,
        document: &Document,
        places: Places<'_>,
        uri: &str,
        path: &Path,
    ) -> Vec<lsp::CodeLens> {
        let Some(name) = document.name_place() else { return Vec::new() };
        let range = places.range(name);
        let lens = |title: &str, command: &str| {
            let arguments = Some(vec![serde_json::Value::from(uri)]);
            let command = lsp::Command {
                title: title.to_owned(),
                command: command.to_owned(),
                arguments,
                tooltip: None,
            };
            lsp::CodeLens { range, command: Some(command), data: None }
        };
        if document.analysis().has_errors() {
            return Vec::new();
        }
        let source = document.source();
        let state = match self.model(&place::beside(path)) {
            None => "derive",
            Some(None) => "derivation is damaged: derive again",
            Some(Some(model)) if artifact::model_hash(source) == model => "derivation is fresh",
            Some(Some(_)) => "derivation is stale: derive again",
        };
        vec![lens(state, jobs::DERIVE), lens("equations", jobs::EQUATIONS), lens("simulate", jobs::SIMULATE)]
    }
}
