//! Reads and checks the file of a model.

use std::path::Path;

use hodograph_model::model::mechanism::Mechanism;
use hodograph_model::source::Source;
use hodograph_model::{check, rendering};
use hodograph_program::files;

use crate::Error;

/// The model of a file, and its text.
pub fn model(path: &Path) -> Result<(Mechanism, Source), Error> {
    let source = files::model(path);
    let checked = check::check(&source);
    match checked.mechanism {
        Some(model) => Ok((model, source)),
        None => Err(Error::Model(rendering::render(&checked.diagnostics, &source))),
    }
}
