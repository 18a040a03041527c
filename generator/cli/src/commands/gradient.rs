//! `hodograph gradient`: differentiates a motion.

use std::path::PathBuf;

use hodograph_generator::model::mechanism::Mechanism;
use hodograph_gradients::{
    By, EventGradient, GradientError, MotionGradient, Sample, Undefined, differentiate,
};
use nalgebra::DMatrix;
use serde::Serialize;

use super::motion_arguments::MotionArguments;
use crate::evaluate::report::{Named, named};
use crate::json::{Failure, Kind};
use crate::state_arguments::once;
use crate::stop::{Outcome, Stop};
use crate::table::{Table, number};

/// Differentiate a motion by its start, parameters, mu and e, through impacts and contact that lasts
///
///   hodograph gradient models/free_box_corner.mech --by z,u3,mu,e,m --at 0.3,0.6 --mu 0.3 --e 0.5 --law stronge --state z=1
///
/// The answer is the states at these times and the events up to the last of them, with derivatives: of the states at these times, and of
/// the times of events and of the states there, before and after. Where the motion is not differentiable (contacts
/// that strike at once, grazing, ..) there are none from then on, and `undefined` says why.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// what to differentiate by: names of coordinates, speeds, parameters and inputs, and mu, e,
    /// mu.CONTACT, e.CONTACT
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', required = true)]
    by: Vec<String>,
    /// the times of the states, s, increasing
    #[arg(long, value_name = "TIME,..", value_delimiter = ',', required = true, allow_hyphen_values = true)]
    at: Vec<f64>,
    #[command(flatten)]
    motion: MotionArguments,
}

/// Runs the command.
///
/// # Errors
///
/// An error object for mistakes in the state, the names or the times, and for a motion that fails.
pub fn run(arguments: &Arguments) -> Outcome {
    let machine = arguments.motion.machine(&arguments.model)?;
    let by: Vec<&str> = arguments.by.iter().map(|name| name.trim()).collect();
    once("--by", &by)?;
    if let Some(pair) = arguments.at.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Stop::Call(format!("--at: the times must rise: {} is given twice", pair[0])));
    }
    let names = Names { model: &machine.mechanism, by };
    arguments.motion.form.write(
        || {
            let state = arguments.motion.state.state(&machine)?;
            let mechanism = machine.interpreted(&state)?;
            let named = |name: &&str| By::named(&mechanism, name);
            let by: Result<Vec<By>, String> = names.by.iter().map(named).collect();
            let by = by.map_err(|message| Failure::new(Kind::UnknownName, message))?;
            if let Some(sample) = by.iter().find(|by| matches!(by, By::Sample { .. })) {
                let name = sample.name(&mechanism);
                return Err(Stop::Call(format!(
                    "--by {name}: inputs are held here; a table of samples is given in Rust or Python"
                )));
            }
            let start = state.borrowed();
            let options = arguments.motion.options(&mechanism, &start)?;
            let found = differentiate(&mechanism, &start, options, &by, &arguments.at).map_err(stop)?;
            Ok(names.answer(&found))
        },
        |answer| answer.tables(&names.by),
    )
}

fn stop(error: GradientError) -> Stop {
    match error {
        GradientError::BadRequest(message) => Stop::Call(format!("--at: {message}")),
        error => Failure::new(Kind::FailedMotion, error.to_string()).into(),
    }
}

/// The answer of the command.
#[derive(Serialize)]
struct Answer<'a> {
    states: Vec<StateAt<'a>>,
    events: Vec<EventAt<'a>>,
    undefined: Option<Why<'a>>,
}

/// Values for coordinates and speeds.
#[derive(Serialize)]
struct OfState<'a> {
    q: Named<'a, f64>,
    u: Named<'a, f64>,
}

/// The derivatives with respect to each variable.
type Derivatives<'a> = Option<Named<'a, OfState<'a>>>;

#[derive(Serialize)]
struct StateAt<'a> {
    t: f64,
    #[serde(flatten)]
    state: OfState<'a>,
    by: Derivatives<'a>,
}

#[derive(Serialize)]
struct EventAt<'a> {
    t: f64,
    event: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<&'a str>,
    t_by: Option<Named<'a, f64>>,
    before_by: Derivatives<'a>,
    after_by: Derivatives<'a>,
}

#[derive(Serialize)]
struct Why<'a> {
    t: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<&'a str>,
    message: String,
}

/// The names in an answer.
struct Names<'a> {
    model: &'a Mechanism,
    by: Vec<&'a str>,
}

impl<'a> Names<'a> {
    fn state(&self, numbers: impl Iterator<Item = f64>) -> OfState<'a> {
        let mut numbers = numbers.map(|number| number + 0.0);
        let count = self.model.coordinates.len();
        let q = named(&self.model.coordinates, numbers.by_ref().take(count).collect::<Vec<_>>());
        let speeds = self.model.speeds.iter().filter(|speed| !speed.dependent);
        OfState { q, u: named(speeds, numbers) }
    }

    fn derivatives(&self, matrix: Option<&DMatrix<f64>>) -> Derivatives<'a> {
        let matrix = matrix?;
        let of = |(column, name): (usize, &&'a str)| {
            (*name, self.state(matrix.column(column).iter().copied().collect::<Vec<_>>().into_iter()))
        };
        Some(Named(self.by.iter().enumerate().map(of).collect()))
    }

    fn contact(&self, contact: Option<usize>) -> Option<&'a str> {
        self.model.contacts.get(contact?).map(|contact| contact.name.as_str())
    }

    fn answer(&self, found: &MotionGradient) -> Answer<'a> {
        let state = |sample: &Sample| StateAt {
            t: sample.time,
            state: self.state(sample.state.iter().copied()),
            by: self.derivatives(sample.derivative.as_ref()),
        };
        let event = |event: &EventGradient| EventAt {
            t: event.event.time,
            event: event.event.kind.name(),
            contact: self.contact(event.event.contact),
            t_by: event.time.as_ref().map(|time| {
                Named(self.by.iter().copied().zip(time.iter().map(|number| number + 0.0)).collect())
            }),
            before_by: self.derivatives(event.before.as_ref()),
            after_by: self.derivatives(event.after.as_ref()),
        };
        let why = |why: &Undefined| Why {
            t: why.time,
            contact: self.contact(why.contact),
            message: why.to_string(),
        };
        Answer {
            states: found.samples.iter().map(state).collect(),
            events: found.events.iter().map(event).collect(),
            undefined: found.undefined.as_ref().map(why),
        }
    }
}

impl Answer<'_> {
    /// A table of each state, one of the events, and the reason if derivatives end.
    fn tables(&self, by: &[&str]) -> String {
        let heads = |first: &[&str]| Table::new(first.iter().copied().chain(by.iter().copied()));
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), number);
        let mut out = String::new();
        for at in &self.states {
            let mut table = heads(&["", "value"]);
            let of = |state: &OfState<'_>| -> Vec<f64> {
                state.q.0.iter().chain(&state.u.0).map(|(_, value)| *value).collect()
            };
            let values = of(&at.state);
            let columns: Option<Vec<Vec<f64>>> =
                at.by.as_ref().map(|by| by.0.iter().map(|(_, state)| of(state)).collect());
            let names = at.state.q.0.iter().chain(&at.state.u.0).map(|(name, _)| *name);
            for (row, name) in names.enumerate() {
                let derivatives =
                    (0..by.len()).map(|column| cell(columns.as_ref().map(|columns| columns[column][row])));
                table.row([name.to_owned(), number(values[row])].into_iter().chain(derivatives));
            }
            out += &format!("\nt = {} s, and derivatives by\n{}", number(at.t), table.text("  "));
        }
        let mut table = heads(&["event", "contact", "t"]);
        for event in &self.events {
            let of = |column: usize| event.t_by.as_ref().map(|by| by.0[column].1);
            let first = [event.event.to_owned(), event.contact.unwrap_or("").to_owned(), number(event.t)];
            table.row(first.into_iter().chain((0..by.len()).map(|column| cell(of(column)))));
        }
        if !table.is_empty() {
            out += &format!("\ntimes of events, and derivatives by\n{}", table.text("  "));
        }
        if let Some(why) = &self.undefined {
            let contact = why.contact.map_or(String::new(), |contact| format!(" (contact {contact})"));
            out += &format!("\n{}{contact}\n", why.message);
        }
        out
    }
}
