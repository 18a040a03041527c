//! `hodograph plot`: draws the course of collisions, and sketches of mechanisms.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use hodograph::{ComponentKind, ReducedMatrix, snapshot_at};
use hodograph_animation::{Recording, Setup};
use hodograph_generator::files;
use hodograph_generator::program::Quantity;
use nalgebra::Vector3;

use crate::derivation::{self, Limits};
use crate::evaluate::contact::{self, Contact};
use crate::json::{Failure, Fields, Json};
use crate::model;
use crate::output;
use crate::plot::collision::figure;
use crate::plot::figure::{Figure, Panel};
use crate::plot::file::{Format, picture};
use crate::plot::trace::{Trace, trace};
use crate::plot::{conics, portrait, sketch};
use crate::state_arguments::StateArguments;
use crate::stop::{Outcome, Stop};

/// Draw the course of a collision: v_s over v_t, v_n and the slip s over I_n, as the paper's Fig. 3
///
/// Here s = n x t; the paper takes s = t x n in its example, so that its Fig. 3 is the mirror image.
/// A ray shows phi_bar, the direction in which slip stops.
///
///   hodograph plot models/two_sleds.mech --mu 0.6,1.1,1.6 --e 0.8 --output sleds.svg
///   echo '{"m":[..],"v":[..]}' | hodograph plot --mu 0.6 --e 0.8 > one.svg
///
/// Arrowheads show the direction of a curve, a dot its beginning; a circle marks where Newton's law
/// ends the collision, a cross Poisson's, a square Stronge's. The file's name decides the format:
/// .svg or .png.
///
/// --figure conics draws Appendix B of the paper, its Fig. 4, for the contact: the ellipse g = 0, the
/// hyperbola h = 0, a circle of radius mu, and the points A, B, C and D. --figure portrait draws
/// the hodographs of many directions of approach, a panel for each coefficient of friction.
///
/// --sketch draws the mechanism itself in the state: its shapes and grounds, and lines between its points.
///
///   hodograph plot --sketch models/shapes/dropped_crate.mech --output crate.svg
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
        required_unless_present = "sketch",
        allow_hyphen_values = true
    )]
    mu: Vec<f64>,
    /// coefficient of restitution, between 0 and 1; `conics` needs none
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, required_unless_present_any = ["figure", "sketch"])]
    e: Option<f64>,
    /// draw the mechanism instead of a collision
    #[arg(long, requires = "model", conflicts_with_all = ["mu", "e", "figure", "starts", "contact"])]
    sketch: bool,
    /// what to draw
    #[arg(long, value_enum, default_value_t = Kind::Course)]
    figure: Kind,
    /// `portrait`: number of hodographs [default: 24]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=360))]
    starts: Option<u16>,
    /// the file [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// the format [default: by the ending of the file's name, else svg]
    #[arg(long, value_enum)]
    format: Option<Format>,
    #[command(flatten)]
    limits: Limits,
}

/// The figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// the course of one collision: Fig. 3
    Course,
    /// ellipse, hyperbola and circles: Appendix B, Fig. 4
    Conics,
    /// hodographs of many directions of approach
    Portrait,
}

/// Runs the command. Errors are reported on standard error; standard output holds the picture only.
///
/// # Errors
///
/// [`Stop::Call`] for mistakes in the options; [`Stop::Fault`] for mistakes in the state or the collision.
pub fn run(arguments: &Arguments) -> Outcome {
    drawn(arguments).map_err(Stop::on_standard_error)
}

fn drawn(arguments: &Arguments) -> Outcome {
    let format = Format::of(arguments.format, arguments.output.as_deref())?;
    if format == Format::Png && arguments.output.is_none() && std::io::stdout().is_terminal() {
        return Err(Stop::Call("a picture is not for a terminal: give --output FILE.png".to_owned()));
    }
    if let (true, Some(model)) = (arguments.sketch, &arguments.model) {
        check_output(arguments)?;
        let bytes = sketched(model, arguments, format)?;
        return match &arguments.output {
            Some(path) => output::file(path, &bytes),
            None => output::bytes(&bytes),
        };
    }
    let e = match (arguments.figure, arguments.e) {
        (Kind::Conics, None) => 0.0,
        (_, Some(e)) if arguments.figure != Kind::Conics => e,
        (Kind::Conics, Some(_)) => return Err(Stop::Call("--figure conics needs no --e".to_owned())),
        _ => return Err(Stop::Call("--e is missing: the coefficient of restitution".to_owned())),
    };
    if arguments.starts.is_some() && arguments.figure != Kind::Portrait {
        return Err(Stop::Call("--starts is for --figure portrait".to_owned()));
    }
    if arguments.model.is_none() && !arguments.state.is_empty() {
        return Err(Stop::Call("--state and --parameter are those of a model: name one".to_owned()));
    }
    check_output(arguments)?;
    let Drawn { title, matrix, velocity } = collision(arguments)?;
    let figure = match arguments.figure {
        Kind::Course => course(&format!("{title}e = {e}"), &matrix, velocity, &arguments.mu, e)?,
        Kind::Conics => {
            check_conics(&matrix, &arguments.mu)?;
            let [_, v_t, v_s] = velocity;
            conics::figure(&format!("{title}Appendix B of the paper"), &matrix, &arguments.mu, v_s.atan2(v_t))
        }
        Kind::Portrait => {
            let starts = usize::from(arguments.starts.unwrap_or(24));
            let title = format!("{title}e = {e}");
            let (figure, failures) = portrait::figure(&title, &matrix, velocity, (&arguments.mu, e), starts);
            for failure in &failures {
                output::say(format_args!("note: {failure}"));
            }
            let directed = |panel: &Panel| panel.series.iter().any(|s| s.directed && !s.points.is_empty());
            if !figure.panels.iter().any(directed) {
                return Err(nothing());
            }
            figure
        }
    };
    match &arguments.output {
        Some(path) => figure.save(path, format),
        None => output::bytes(&figure.bytes(format)?),
    }
}

/// Refuses to overwrite an input file.
fn check_output(arguments: &Arguments) -> Outcome {
    let Some(path) = &arguments.output else { return Ok(()) };
    let mut read = arguments.state.files();
    if let Some(model) = &arguments.model {
        read.extend(model::files_of(model));
    }
    output::check_distinct(&[path], &read)
}

/// The picture of a mechanism in a state.
fn sketched(path: &Path, arguments: &Arguments, format: Format) -> Outcome<Vec<u8>> {
    let machine = derivation::machine(path, &arguments.limits)?;
    let state = arguments.state.state(&machine)?;
    let mechanism = machine.interpreted(&state)?;
    let mut recording = Recording::new(&mechanism, mechanism.model(), &state.to_numeric(), Setup::default());
    recording.still(&hodograph::State {
        time: state.time,
        coordinates: &state.coordinates,
        speeds: &state.speeds[..hodograph::Mechanism::count(&mechanism, ComponentKind::Speed)],
        inputs: &state.inputs,
    });
    let recorded = recording.finish();
    for note in &recorded.notes {
        output::say(format_args!("note: {note}"));
    }
    let title = &machine.mechanism.name;
    let names = recorded.shown.shapes.iter().map(|shape| shape.name.as_str()).collect::<Vec<_>>().join(", ");
    let what = if names.is_empty() { "lines between its points".to_owned() } else { names };
    picture(&sketch::sheet(&recorded.shown, 0), format, title, &what)
}

fn nothing() -> Stop {
    Stop::Fault("there is nothing to draw: no collision has an outcome".to_owned())
}

/// The course of one collision for each coefficient of friction.
fn course(title: &str, m: &ReducedMatrix<f64>, velocity: [f64; 3], mu: &[f64], e: f64) -> Outcome<Figure> {
    let traces: Vec<Trace> = mu.iter().map(|&mu| trace(m, velocity, mu, e)).collect();
    for failure in traces.iter().flat_map(|trace| &trace.failures) {
        output::say(format_args!("note: {failure}"));
    }
    if traces.iter().all(|trace| trace.samples.is_empty()) {
        return Err(nothing());
    }
    Ok(figure(title, &traces))
}

/// Refuses a matrix or coefficient of friction that `solve` refuses.
fn check_conics(matrix: &ReducedMatrix<f64>, mu: &[f64]) -> Outcome {
    let approach = Vector3::new(-1.0, 0.0, 0.0);
    for &mu in mu {
        if let Err(error) = snapshot_at(matrix, &approach, mu, 0.0) {
            return Err(Failure::from(error).into());
        }
    }
    Ok(())
}

/// What is to be drawn: the beginning of the title, the reduced matrix and the velocity of approach.
struct Drawn {
    title: String,
    matrix: ReducedMatrix<f64>,
    velocity: [f64; 3],
}

/// Largest size of a collision in JSON, in bytes.
const MAX_BYTES: usize = 1 << 20;

/// Reads or evaluates the collision.
fn collision(arguments: &Arguments) -> Outcome<Drawn> {
    let Some(path) = &arguments.model else {
        let unreadable =
            |error: String| Stop::Call(format!("cannot read the collision from standard input: {error}"));
        let bytes = files::up_to(std::io::stdin().lock(), MAX_BYTES)
            .map_err(|error| unreadable(error.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|error| unreadable(error.to_string()))?;
        let case = Fields::new(Json::parse(&text)?, "a collision")?;
        let matrix = case.numbers::<6>("m", "the six numbers nn, nt, ns, tt, ts, ss")?;
        let velocity = match arguments.figure {
            // By default slip is along t, as in the paper.
            Kind::Conics if case.get("v").is_none() => [-1.0, 1.0, 0.0],
            _ => case.numbers::<3>("v", "the three numbers n, t, s")?,
        };
        return Ok(Drawn { title: String::new(), matrix: matrix.into(), velocity });
    };
    let machine = derivation::machine(path, &arguments.limits)?;
    let index = machine.contact(arguments.contact.as_deref())?;
    let state = arguments.state.state(&machine)?;
    let wanted = contact::QUANTITIES.map(|quantity| Quantity::Contact(index as u32, quantity));
    let contact = Contact::new(&machine.evaluate(&state, &wanted)?, index, &state.speeds);
    let mechanism = &machine.mechanism;
    let title = format!("{}, {}, ", mechanism.name, mechanism.contacts[index].name);
    Ok(Drawn { title, matrix: contact.reduced, velocity: contact.slip.into() })
}
