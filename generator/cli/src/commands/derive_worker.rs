//! The child process that uses the algebra engine. The engine prints to standard output; the result follows
//! after its output.

use crate::stop::Outcome;

/// Derive one model in a process of its own (used by the other commands)
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// the name of the model in messages; its text comes from standard input
    name: String,
    /// answer with the effect of each pass instead of the derivation
    #[arg(long)]
    trace: bool,
}

/// Runs the command.
///
/// # Errors
///
/// Reported on standard error.
#[cfg(feature = "derive")]
pub fn run(arguments: &Arguments) -> Outcome {
    use crate::commands::explain::row;
    use crate::derivation::ANSWER;
    use crate::output;
    use crate::stop::Stop;
    use hodograph_generator::DerivationError;
    use hodograph_generator::artifact;
    use hodograph_generator::check::check;
    use hodograph_generator::program::{Program, cost};
    use hodograph_generator::rendering::render;
    use hodograph_generator::source::Source;

    end_with_parent();
    let text = std::io::read_to_string(std::io::stdin().lock())
        .map_err(|error| Stop::Fault(format!("cannot read the model: {error}")))?;
    let source = Source::file(arguments.name.clone(), text);
    let mechanism = check(&source).mechanism.ok_or(Stop::Reported)?;
    let derived = hodograph_generator::derive(&mechanism).map_err(|error| match error {
        DerivationError::Model(error) => {
            output::say(render(&[error.diagnostic()], &source).trim_end());
            Stop::Reported
        }
        DerivationError::Session(error) => Stop::Fault(error.to_string()),
    })?;
    let answer: String = if arguments.trace {
        cost::trace(&derived).iter().map(|step| format!("{}\t{}\n", step.pass, row(&step.cost))).collect()
    } else {
        artifact::encode(&Program::new(&derived), &artifact::model_hash(&source))
    };
    output::text(&format!("{ANSWER}{answer}"))
}

/// Ends this process when its parent ends: nobody would use its result, but others wait for the engine.
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

/// Fails, since the engine is not built in.
///
/// # Errors
///
/// Always.
#[cfg(not(feature = "derive"))]
pub fn run(arguments: &Arguments) -> Outcome {
    let name = &arguments.name;
    Err(crate::stop::Stop::Fault(format!("built without the feature `derive`: cannot derive {name}")))
}
