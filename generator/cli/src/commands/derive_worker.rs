//! The process that uses the algebra engine. Its standard output belongs to the engine.

use std::path::PathBuf;

use crate::stop::Outcome;

/// Derive one model in a process of its own (used by the other commands)
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// a file with the text of the model
    input: PathBuf,
    /// where to write the derivation
    output: PathBuf,
    /// what to call the model in messages
    name: String,
    /// where to write what each pass did
    #[arg(long)]
    trace: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
///
/// Said on stderr.
#[cfg(feature = "derive")]
pub fn run(arguments: &Arguments) -> Outcome {
    use crate::commands::explain::row;
    use crate::stop::Stop;
    use hodograph_generator::DerivationError;
    use hodograph_generator::artifact;
    use hodograph_generator::check::check;
    use hodograph_generator::program::{Program, cost};
    use hodograph_generator::rendering::render;
    use hodograph_generator::source::Source;

    end_with_parent();
    let text = std::fs::read_to_string(&arguments.input)
        .map_err(|error| Stop::unreadable(&arguments.input, &error))?;
    let source = Source::file(arguments.name.clone(), text);
    let mechanism = check(&source).mechanism.ok_or(Stop::Said)?;
    let derived = hodograph_generator::derive(&mechanism).map_err(|error| match error {
        DerivationError::Model(error) => {
            eprint!("{}", render(&[error.diagnostic()], &source));
            Stop::Said
        }
        DerivationError::Session(error) => Stop::Fault(error.to_string()),
    })?;
    if let Some(path) = &arguments.trace {
        let steps = cost::trace(&derived);
        let text: String = steps.iter().map(|step| format!("{}\t{}\n", step.pass, row(&step.cost))).collect();
        std::fs::write(path, text).map_err(|error| Stop::unwritable(path, &error))?;
    }
    let text = artifact::encode(&Program::new(&derived), &artifact::model_hash(&source));
    std::fs::write(&arguments.output, text).map_err(|error| Stop::unwritable(&arguments.output, &error))
}

/// Nobody waits for the result of a process whose parent is gone, but others wait for the engine.
#[cfg(all(feature = "derive", unix))]
fn end_with_parent() {
    use std::os::unix::process::parent_id;
    let parent = parent_id();
    std::thread::spawn(move || {
        while parent_id() == parent {
            std::thread::sleep(std::time::Duration::from_millis(200));
        }
        std::process::exit(1);
    });
}

#[cfg(all(feature = "derive", not(unix)))]
fn end_with_parent() {}

/// Without the engine there is nothing to do.
///
/// # Errors
///
/// Always.
#[cfg(not(feature = "derive"))]
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { input, output, name, .. } = arguments;
    Err(crate::stop::Stop::Fault(format!(
        "built without the feature `derive`: cannot derive {name} from {} to {}",
        input.display(),
        output.display()
    )))
}
