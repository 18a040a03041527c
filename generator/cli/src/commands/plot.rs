//! `hodograph plot`: draws the course of collisions.

use std::io::IsTerminal;
use std::path::PathBuf;

use hodograph::ReducedMatrix;
use hodograph_generator::artifact::place;
use hodograph_generator::program::Quantity;
use hodograph_generator::reading;

use crate::derivation::{self, Limits};
use crate::evaluate::contact::{self, Contact};
use crate::json::{Fields, Json};
use crate::output;
use crate::plot::collision::figure;
use crate::plot::file::Format;
use crate::plot::trace::{Trace, trace};
use crate::state_arguments::StateArguments;
use crate::stop::{Outcome, Stop};

/// Draw the course of a collision: v_s over v_t, v_n and the slip s over I_n, as the paper's Fig. 3
///
///   hodograph plot models/two_sleds.mech --mu 0.6,1.1,1.6 --e 0.8 --output sleds.svg
///   echo '{"m":[..],"v":[..]}' | hodograph plot --mu 0.6 --e 0.8 > one.svg
///
/// Arrowheads show the direction of a curve, a dot its beginning; a circle marks where Newton's law
/// ends the collision, a cross Poisson's, a square Stronge's. The file's name decides the format:
/// .svg or .png.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file; without it a collision as for `solve` is read from standard input
    model: Option<PathBuf>,
    /// the contact; may be left out if the model has only one
    #[arg(long, value_name = "NAME", requires = "model")]
    contact: Option<String>,
    #[command(flatten)]
    state: StateArguments,
    /// coefficients of friction, one curve each
    #[arg(
        long,
        value_name = "NUMBER,..",
        value_delimiter = ',',
        required = true,
        allow_hyphen_values = true
    )]
    mu: Vec<f64>,
    /// coefficient of restitution, between 0 and 1
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    e: f64,
    /// where to write [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// the format [default: as the file's name ends, else svg]
    #[arg(long, value_enum)]
    format: Option<Format>,
    #[command(flatten)]
    limits: Limits,
}

/// Runs the command.
///
/// # Errors
///
/// An error object for what is wrong with the collision.
pub fn run(arguments: &Arguments) -> Outcome {
    let format = Format::of(arguments.format, arguments.output.as_deref())?;
    if format == Format::Png && arguments.output.is_none() && std::io::stdout().is_terminal() {
        return Err(Stop::Call("a picture is not for a terminal: give --output FILE.png".to_owned()));
    }
    if arguments.model.is_none() && !arguments.state.is_empty() {
        return Err(Stop::Call("--state and --parameter are those of a model: name one".to_owned()));
    }
    if let Some(path) = &arguments.output {
        let mut read = arguments.state.files();
        if let Some(model) = &arguments.model {
            read.extend([model.clone(), place::beside(model)]);
        }
        output::apart(&[path], &read)?;
    }
    let (title, matrix, velocity) = collision(arguments)?;
    let traces: Vec<Trace> =
        arguments.mu.iter().map(|&mu| trace(&matrix, velocity, mu, arguments.e)).collect();
    for failure in traces.iter().flat_map(|trace| &trace.failures) {
        output::say(format_args!("note: {failure}"));
    }
    if traces.iter().all(|trace| trace.samples.is_empty()) {
        return Err(Stop::Fault("there is nothing to draw: no collision has an outcome".to_owned()));
    }
    let figure = figure(&title, &traces);
    match &arguments.output {
        Some(path) => figure.save(path, format),
        None => output::bytes(&figure.bytes(format)?),
    }
}

/// Largest size of a collision in JSON, in bytes.
const MAX_BYTES: usize = 1 << 20;

/// What collides: a title, the reduced matrix and the velocity of approach.
fn collision(arguments: &Arguments) -> Outcome<(String, ReducedMatrix<f64>, [f64; 3])> {
    let e = arguments.e;
    let Some(path) = &arguments.model else {
        let unreadable =
            |error: String| Stop::Call(format!("cannot read the collision from standard input: {error}"));
        let bytes = reading::up_to(std::io::stdin().lock(), MAX_BYTES)
            .map_err(|error| unreadable(error.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|error| unreadable(error.to_string()))?;
        let case = Fields::new(Json::parse(&text)?, "a collision")?;
        let matrix = case.numbers::<6>("m", "the six numbers nn, nt, ns, tt, ts, ss")?;
        let velocity = case.numbers::<3>("v", "the three numbers n, t, s")?;
        return Ok((format!("e = {e}"), matrix.into(), velocity));
    };
    let machine = derivation::machine(path, &arguments.limits)?;
    let index = machine.contact(arguments.contact.as_deref())?;
    let state = arguments.state.state(&machine)?;
    let wanted = contact::QUANTITIES.map(|quantity| Quantity::Contact(index as u32, quantity));
    let contact = Contact::new(&machine.evaluate(&state, &wanted)?, index, &state.speeds);
    let mechanism = &machine.mechanism;
    let title = format!("{}, {}, e = {e}", mechanism.name, mechanism.contacts[index].name);
    Ok((title, contact.reduced.into(), contact.slip.into()))
}
