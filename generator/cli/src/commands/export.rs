//! `hodograph export`: writes a mechanism as a library for another language.

use std::path::{Path, PathBuf};

use hodograph_generator::emit::{self, Requests};
use hodograph_generator::rust_names::snake_case;

use crate::commands::expand;
use crate::derivation::{self, Limits};
use crate::export::{Scalar, files};
use crate::output;
use crate::stop::{Outcome, Stop};

/// Write a mechanism as a library for C: a small crate that builds a static library, and its header
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// for C (the only language so far)
    #[arg(long, required = true)]
    c: bool,
    /// the folder to write to, which must not exist
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    /// numbers are `float` instead of `double`: for processors that have singles only
    #[arg(long)]
    single: bool,
    /// the folder of the package `hodograph`, which the crate depends on [default: the published package of
    /// this tool's version]
    #[arg(long, value_name = "FOLDER")]
    hodograph: Option<PathBuf>,
    #[command(flatten)]
    limits: Limits,
}

/// Runs the command.
///
/// # Errors
///
/// The model has errors or cannot be derived; the folder exists or cannot be written.
pub fn run(arguments: &Arguments) -> Outcome {
    let folder = &arguments.output;
    if folder.symlink_metadata().is_ok() {
        return Err(Stop::Call(format!(
            "{} exists: name a folder that does not, or remove it first",
            folder.display()
        )));
    }
    let dependency = match &arguments.hodograph {
        Some(runtime) if !runtime.join("Cargo.toml").is_file() => {
            return Err(Stop::Call(format!(
                "{} has no Cargo.toml: name the folder of the package `hodograph`",
                runtime.display()
            )));
        }
        Some(runtime) => {
            let runtime =
                std::fs::canonicalize(runtime).map_err(|error| Stop::unreadable(runtime, &error))?;
            let Some(path) = runtime.to_str().filter(|path| !path.contains(['\'', '\n'])) else {
                return Err(Stop::Call(format!("{} cannot stand in a manifest", runtime.display())));
            };
            format!("{{ path = '{path}', default-features = false }}")
        }
        None => format!("{{ version = \"{}\", default-features = false }}", env!("CARGO_PKG_VERSION")),
    };
    let scalar = if arguments.single { Scalar::Single } else { Scalar::Double };
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let expanded = expand::module(&machine, Requests::default())?;
    let name = snake_case(&machine.mechanism.name);
    let offered = emit::interface(&machine.mechanism, &machine.program, &name).map_err(Stop::Fault)?;
    let files = files(&expanded, &offered, scalar, &dependency);
    output::files(folder, &files)?;
    output::say(format_args!(
        "{} written: README.md there says how to build it",
        Path::new(folder).display()
    ));
    Ok(())
}
