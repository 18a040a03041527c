//! `hodograph new`: writes a commented model to begin with.

use std::path::{Path, PathBuf};

use crate::output;
use crate::stop::{Outcome, Stop};

/// A model to start from.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Template {
    /// a rod on a pivot whose tip strikes a wall: point, normal and gap of the contact are written out
    Pendulum,
    /// a box that tumbles on a floor: mass, inertia and contacts follow from shapes
    Crate,
}

impl Template {
    /// The name of its mechanism, and its text.
    fn model(self) -> (&'static str, &'static str) {
        match self {
            Self::Pendulum => ("Pendulum", include_str!("pendulum.mech")),
            Self::Crate => ("Crate", include_str!("crate.mech")),
        }
    }
}

/// Write a commented model to begin with: a pendulum whose tip strikes a wall, or a crate on a floor
///
///   hodograph new pendulum
///   hodograph simulate pendulum.mech --html pendulum.html
///   hodograph new my_crate --template crate
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the name of the mechanism, in letters, digits and `_`; its file is NAME.mech
    name: PathBuf,
    /// what to begin with
    #[arg(long, value_enum, default_value_t = Template::Pendulum)]
    template: Template,
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Call`] if the name is not allowed; [`Stop::Fault`] if the file exists or cannot be written.
pub fn run(arguments: &Arguments) -> Outcome {
    let given = &arguments.name;
    let stem = match given.extension() {
        Some(extension) if extension == "mech" => given.file_stem(),
        _ => given.file_name(),
    };
    let stem = stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let Some((file, mechanism)) = names(&stem) else {
        return Err(Stop::Call(format!(
            "`{}` cannot be the name of a mechanism: give letters, digits and `_`, a letter first, as in my_pendulum",
            given.display()
        )));
    };
    let path = given.with_file_name(format!("{file}.mech"));
    output::check(&path)?;
    if path.exists() {
        return Err(Stop::Fault(format!("{} exists: give another name, or remove it", path.display())));
    }
    let (of_template, text) = arguments.template.model();
    let text = text.replace(&format!("mechanism {of_template};"), &format!("mechanism {mechanism};"));
    output::new_file(&path, text.as_bytes())?;
    let shown = path.display();
    let page = Path::new(&file).with_extension("html");
    output::say(format_args!(
        "wrote {shown}. Next:\n  hodograph check {shown}\n  hodograph simulate {shown} --html {}",
        page.display()
    ));
    Ok(())
}

/// The names of the file and the mechanism: `my_pendulum` and `MyPendulum`; either may be given.
fn names(given: &str) -> Option<(String, String)> {
    let known = given.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if !known || !given.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
        return None;
    }
    let mechanism: String = given
        .split('_')
        .map(|word| {
            let mut letters = word.chars();
            letters
                .next()
                .map_or(String::new(), |first| first.to_ascii_uppercase().to_string() + letters.as_str())
        })
        .collect();
    Some((hodograph_generator::rust_names::snake_case(&mechanism), mechanism))
}
