//! Finds the program of a model: reads its derivation file, or derives it if the feature `derive` is on.

use std::path::Path;

use hodograph_model::model::mechanism::Mechanism;
use hodograph_model::source::Source;
use hodograph_program::artifact::{self, Loaded};
use hodograph_program::program::Program;

/// Finds the program of a model. `path` is the path of its derivation, `shown` the name of that file in
/// messages, `command` the command that writes it.
pub fn find(
    source: &Source,
    mechanism: &Mechanism,
    path: &Path,
    shown: &str,
    command: &str,
) -> Result<Program, String> {
    match artifact::load(path, source) {
        Loaded::Absent => absent(source, mechanism, shown, command),
        found => found.program().map_err(|fault| {
            format!(
                "the derivation `{shown}` {fault}; run this in the folder of the package's Cargo.toml and check the \
                 result in:\n\n    {command}\n"
            )
        }),
    }
}

#[cfg(feature = "derive")]
fn absent(source: &Source, mechanism: &Mechanism, _shown: &str, _command: &str) -> Result<Program, String> {
    use crate::DerivationError;

    #[cfg(unix)]
    let _elsewhere = redirect_stdout();
    match crate::derive(mechanism) {
        Ok(derived) => Ok(Program::new(&derived)),
        Err(DerivationError::Model(error)) => Err(error.diagnostic().compiler_text(source)),
        Err(error) => Err(format!("the equations could not be derived: {error}")),
    }
}

/// The algebra engine prints a greeting to standard output, which here belongs to the compiler or to an
/// editor's macro server. Until the guard is dropped, standard output goes to standard error or, where that
/// is not possible, is discarded.
#[cfg(all(feature = "derive", unix))]
fn redirect_stdout() -> Box<dyn std::any::Any> {
    let stderr = std::fs::OpenOptions::new().write(true).open("/dev/stderr").ok();
    match stderr.and_then(|stderr| gag::Redirect::stdout(stderr).ok()) {
        Some(redirect) => Box::new(redirect),
        None => Box::new(gag::Gag::stdout().ok()),
    }
}

#[cfg(not(feature = "derive"))]
fn absent(_source: &Source, _mechanism: &Mechanism, shown: &str, command: &str) -> Result<Program, String> {
    Err(format!(
        "the model has no derivation `{shown}`; run this in the folder of the package's Cargo.toml and check the result \
         in:\n\n    {command}\n\n(or, while the model is being written, switch on the feature `derive` of hodograph)"
    ))
}

#[cfg(test)]
mod tests {
    use hodograph_model::check::check;

    use super::*;

    const MODEL: &str = "mechanism Drop; parameters { m: kg = 1 } coordinates { q1: m } speeds { u1: m/s } \
                         points { P = O + q1*N.x; } particles { A { point: P, mass: m } }";

    /// The error for a derivation with this text; `None`: there is no file.
    fn error_for(name: &str, text: Option<&str>) -> String {
        let source = Source::file("models/drop.mech", MODEL);
        let mechanism = check(&source).mechanism.expect("the model is sound");
        let path = std::env::temp_dir().join(format!("hodograph-{}-{name}.derivation", std::process::id()));
        if let Some(text) = text {
            std::fs::write(&path, text).unwrap();
        }
        let found =
            find(&source, &mechanism, &path, "models/drop.derivation", "hodograph derive models/drop.mech");
        let _ = std::fs::remove_file(&path);
        found.err().unwrap_or_default()
    }

    #[test]
    fn a_fresh_derivation_is_taken() {
        let hash = artifact::model_hash(&Source::file("models/drop.mech", MODEL));
        assert_eq!(error_for("fresh", Some(&artifact::encode(&Program::default(), &hash))), "");
    }

    #[test]
    fn the_command_that_repairs_is_named() {
        let stale = error_for("stale", Some(&artifact::encode(&Program::default(), "00")));
        assert!(stale.contains("`models/drop.derivation` is stale"), "{stale}");
        let damaged = error_for("damaged", Some("<<<<<<< ours\n"));
        assert!(damaged.contains("is damaged"), "{damaged}");
        for message in [stale, damaged] {
            assert!(message.contains("\n\n    hodograph derive models/drop.mech\n"), "{message}");
        }
    }

    #[test]
    #[cfg(not(feature = "derive"))]
    fn an_absent_derivation_names_the_command_and_the_feature() {
        let absent = error_for("absent", None);
        assert!(
            absent.contains("hodograph derive models/drop.mech") && absent.contains("feature `derive`"),
            "{absent}"
        );
    }
}
