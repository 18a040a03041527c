//! The options that give the state of a model: JSON of a file or standard input, and numbers by name.

use hodograph::Cause;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use hodograph_generator::files;
use hodograph_generator::model::mechanism::Mechanism;

use crate::evaluate::Machine;
use crate::expression::{self, Mistake};
use crate::json::state::State;
use crate::json::{Failure, Kind};
use crate::output;
use crate::stop::{Outcome, Stop};

/// Largest size of a state, in bytes.
const MAX_STATE: usize = 16 << 20;

/// The options that give a state.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct StateArguments {
    /// coordinates, speeds, inputs and the time t by name, as q1=0.3,u1=2 (the rest as in the model); or a
    /// file with a state, `-` for standard input, or the state as JSON; may be given several times, each name once
    #[arg(long, value_name = "NAME=NUMBER|FILE|-|JSON", allow_hyphen_values = true)]
    state: Vec<String>,
    /// parameters by name, as m=3,l=0.4; may be given several times, each name once
    #[arg(long, value_name = "NAME=NUMBER", allow_hyphen_values = true)]
    parameter: Vec<String>,
}

/// An argument of `--state`.
enum Given<'a> {
    /// an object
    Text(&'a str),
    /// a file, or `-`
    Place(&'a str),
    /// names and numbers
    Numbers(&'a str),
}

fn given(argument: &str) -> Given<'_> {
    // A name of a part with a point, `a.x`, is none of a state, which has `a_x`: the error of names says so, that of files would not.
    let name = |text: &str| {
        let text = text.trim();
        let letters = |text: &str| text.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
        text.split('.').all(|word| !word.is_empty() && letters(word))
    };
    match argument.split_once('=') {
        _ if argument.trim_start().starts_with('{') => Given::Text(argument),
        Some((before, _)) if name(before) && !Path::new(argument).exists() => Given::Numbers(argument),
        _ => Given::Place(argument),
    }
}

impl StateArguments {
    /// Whether nothing was given.
    pub fn is_empty(&self) -> bool {
        self.state.is_empty() && self.parameter.is_empty()
    }

    /// The options as they were given.
    pub fn given(&self) -> Vec<String> {
        let options = |name: &'static str, list: &[String]| -> Vec<String> {
            list.iter().map(|text| format!("{name}={text}")).collect()
        };
        [options("--state", &self.state), options("--parameter", &self.parameter)].concat()
    }

    /// The input files.
    pub fn files(&self) -> Vec<PathBuf> {
        let file = |argument: &String| match given(argument) {
            Given::Place(path) if path != "-" => Some(PathBuf::from(path)),
            _ => None,
        };
        self.state.iter().filter_map(file).collect()
    }

    /// The state of a model, after quaternions and loops have been checked, with completed dependent
    /// coordinates.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`] if a file cannot be read, or two objects are given; those of [`State::read`],
    /// [`State::set`] and [`Machine::complete`].
    pub fn state(&self, machine: &Machine) -> Outcome<State> {
        let mechanism = &machine.mechanism;
        let mut state = State::initial(mechanism);
        let mut object: Option<&str> = None;
        let mut in_object = HashSet::new();
        for argument in &self.state {
            let text = match given(argument) {
                Given::Text(text) => text.to_owned(),
                Given::Place(place) => read(place)?,
                Given::Numbers(_) => continue,
            };
            if let Some(other) = object.replace(argument) {
                return Err(Stop::Call(format!(
                    "--state {other} and --state {argument} are two whole states: give one, and numbers by name"
                )));
            }
            in_object = state.read(&text, mechanism)?;
        }
        let Mechanism { coordinates, speeds, inputs, parameters, .. } = mechanism;
        let lists = [coordinates, speeds, inputs, parameters];
        let of_model: Vec<&str> = lists.into_iter().flatten().map(|one| one.name.as_str()).collect();
        let mut named: Vec<String> = Vec::new();
        let of_state = self.state.iter().filter_map(|argument| match given(argument) {
            Given::Numbers(text) => Some(("--state", text)),
            _ => None,
        });
        let of_parameter = self.parameter.iter().map(|text| ("--parameter", text.as_str()));
        for (option, text) in of_state.chain(of_parameter) {
            for assignment in assignments(text) {
                let (name, value) = assignment
                    .split_once('=')
                    .filter(|(name, _)| !name.trim().is_empty())
                    .ok_or_else(|| Stop::Call(format!("{option} {text}: give NAME=NUMBER, as in q1=0.3")))?;
                let name = name.trim();
                let value =
                    expression::number(value).map_err(|mistake| refused(option, name, value, &mistake))?;
                if named.iter().any(|other| other == name) {
                    return Err(Stop::Call(format!("{option} {text}: {name} is given twice: leave one out")));
                }
                if option == "--state" && name == "t" && of_model.contains(&"t") {
                    output::say(
                        "note: --state t=.. sets the `t` of the model, not the time: that is given in an object, as in --state '{\"t\":1}'",
                    );
                }
                state.set(mechanism, name, value, option == "--parameter")?;
                named.push(name.to_owned());
            }
        }
        let given = |name: &str| in_object.contains(name) || named.iter().any(|other| other == name);
        state.complete(mechanism, given)?;
        machine.complete(state).map_err(Stop::from)
    }
}

/// The error of a number that an option gives by name.
fn refused(option: &str, name: &str, value: &str, mistake: &Mistake) -> Failure {
    let (kind, cure) = match mistake {
        // several assignments, with other signs between them
        Mistake::Unreadable(_) if value.contains([';', '=']) => {
            (Kind::BadJson, ": commas stand between numbers, as in q1=0.3,u1=2")
        }
        Mistake::Unreadable(_) => (Kind::BadJson, ""),
        Mistake::UnknownName(_) => (Kind::UnknownName, ""),
        Mistake::NotFinite(_) => (Kind::Of(Cause::NotFinite), ""),
    };
    Failure::new(kind, format!("{option} {name}={value}: {mistake}{cure}"))
}

/// The parts between commas outside brackets.
fn assignments(text: &str) -> Vec<&str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0_i32);
    for (at, letter) in text.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth <= 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

/// The text of a file, or of standard input (`-`).
fn read(place: &str) -> Outcome<String> {
    let bytes = match place {
        "-" => files::up_to(std::io::stdin().lock(), MAX_STATE)
            .map_err(|error| Stop::Call(format!("cannot read the state from standard input: {error}")))?,
        path => files::bytes(Path::new(path), MAX_STATE).map_err(|error| {
            Stop::Call(format!(
                "cannot read the state from {path}: {error}; a state is a file, `-` for standard input, numbers by name, as in q1=0.3,u1=2, \
                 or the object itself, as in '{{\"q\":{{\"q1\":0.3}}}}'"
            ))
        })?,
    };
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        Failure::bad_json(format!("the state is not UTF-8 at byte {at}")).into()
    })
}

/// Refuses a name that an option gives twice.
///
/// # Errors
///
/// [`Stop::Call`] with the name.
pub fn once(option: &str, names: &[&str]) -> Outcome {
    let twice = names.iter().enumerate().find(|(place, name)| names[..*place].contains(name));
    match twice {
        Some((_, name)) => Err(Stop::Call(format!("{option}: {name} is given twice: leave one out"))),
        None => Ok(()),
    }
}
