//! Finds the stored derivation of a model.

use std::io::ErrorKind;
use std::path::Path;

use hodograph_model::source::Source;

use super::{Artifact, MAX_BYTES, decode, model_hash};
use crate::files;
use crate::program::Program;

/// The result of looking for the derivation of a model.
#[derive(Clone, Debug)]
pub enum Loaded {
    /// the derivation belongs to this model
    Fresh(Box<Program>),
    /// there is no derivation
    Absent,
    /// the derivation belongs to another text of the model
    Stale,
    /// the file is not a derivation, was changed after it was written, or cannot be read; with the reason
    Damaged(String),
}

/// Looks for the derivation of a model in a file.
pub fn load(path: &Path, source: &Source) -> Loaded {
    match files::text(path, MAX_BYTES) {
        Ok(text) => load_text(&text, source),
        Err(error) if error.kind() == ErrorKind::NotFound => Loaded::Absent,
        Err(error) => Loaded::Damaged(format!("it cannot be read: {error}")),
    }
}

/// Looks for the derivation of a model in a text.
pub fn load_text(text: &str, source: &Source) -> Loaded {
    match decode(text) {
        Ok(Artifact { model, program, .. }) if model == model_hash(source) => {
            Loaded::Fresh(Box::new(program))
        }
        Ok(_) => Loaded::Stale,
        Err(error) => Loaded::Damaged(error.to_string()),
    }
}

impl Loaded {
    /// What is wrong with the derivation, as the rest of a sentence about its file; `None` if it is fresh.
    pub fn fault(&self) -> Option<String> {
        match self {
            Loaded::Fresh(_) => None,
            Loaded::Absent => Some("is not there".to_owned()),
            Loaded::Stale => Some("is stale: it was derived from another text of the model".to_owned()),
            Loaded::Damaged(why) => Some(format!("is damaged: {why}")),
        }
    }

    /// The program, if it is fresh.
    ///
    /// # Errors
    ///
    /// The derivation is absent, stale or damaged, as [`Loaded::fault`] says.
    pub fn program(self) -> Result<Program, String> {
        let fault = self.fault().unwrap_or_default();
        match self {
            Loaded::Fresh(program) => Ok(*program),
            _ => Err(fault),
        }
    }
}
