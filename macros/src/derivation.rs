//! The program of a model: from its checked-in derivation, or derived here where that is switched on.

use std::path::Path;

use hodograph_generator::artifact;
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::program::Program;
use hodograph_generator::source::Source;

/// Where a program comes from.
pub struct Found {
    /// the program
    pub program: Program,
    /// was it read from the file (which the module then depends on)?
    pub checked_in: bool,
}

/// Finds the program of a model. `path` is where its derivation should be, `shown` how messages call that file, `command` what
/// writes it.
pub fn find(
    source: &Source,
    mechanism: &Mechanism,
    path: &Path,
    shown: &str,
    command: &str,
) -> Result<Found, String> {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return absent(mechanism, shown, command);
        }
        Err(error) => return Err(format!("the derivation `{shown}` cannot be read: {error}")),
    };
    let repair = format!(
        "run this in the folder of the package's Cargo.toml and check the result in:\n\n    {command}\n"
    );
    let artifact = artifact::decode(&text).map_err(|error| {
        format!("the derivation `{shown}` is damaged or of another version ({error}); {repair}")
    })?;
    if artifact.model != source.content_hash() {
        return Err(format!(
            "the derivation `{shown}` is stale: the model has changed since it was derived; {repair}"
        ));
    }
    Ok(Found { program: artifact.program, checked_in: true })
}

#[cfg(feature = "derive")]
fn absent(mechanism: &Mechanism, _shown: &str, _command: &str) -> Result<Found, String> {
    match hodograph_generator::derive(mechanism) {
        Ok(derived) => Ok(Found { program: Program::new(&derived), checked_in: false }),
        Err(error) => Err(format!("the equations could not be derived: {error}")),
    }
}

#[cfg(not(feature = "derive"))]
fn absent(_mechanism: &Mechanism, shown: &str, command: &str) -> Result<Found, String> {
    Err(format!(
        "the model has no derivation `{shown}`; run this in the folder of the package's Cargo.toml and check the result \
         in:\n\n    {command}\n\n(or, while the model is being written, switch on the feature `derive` of hodograph)"
    ))
}
