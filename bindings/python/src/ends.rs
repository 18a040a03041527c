//! The events of a user, and the events at which a motion ends.

use hodograph_simulation::EventKind;
use pyo3::prelude::*;

use crate::errors;

/// The names of own events, and at which events a motion ends.
#[derive(Clone, Default)]
pub struct Ends {
    pub names: Vec<String>,
    stop: Vec<String>,
}

impl Ends {
    /// Own events of these names, and the events that end a motion: kinds, or own ones.
    pub fn new(py: Python<'_>, names: Vec<String>, stop: &[String]) -> PyResult<Self> {
        let is_kind = |name: &String| EventKind::NAMES.contains(&name.as_str());
        if let Some(name) = names.iter().find(|name| is_kind(name)) {
            let message =
                format!("`events` names one '{name}', which is a kind of event: give it another name");
            return Err(errors::argument(py, "events", "bad_option", &message));
        }
        if let Some(name) = stop.iter().find(|name| !is_kind(name) && !names.contains(name)) {
            let known = EventKind::NAMES.iter().copied().chain(names.iter().map(String::as_str));
            let known: Vec<&str> = known.collect();
            let message = format!("`stop`: there is no event '{name}': expected one of {}", known.join(", "));
            return Err(errors::argument(py, "stop", "unknown_name", &message));
        }
        Ok(Ends { names, stop: stop.to_vec() })
    }

    /// The name of an event: its own, or that of its kind.
    pub fn name<'a>(&'a self, kind: &'a EventKind) -> &'a str {
        match kind {
            EventKind::Zero(index) => self.names.get(*index).map_or("zero", String::as_str),
            kind => kind.name(),
        }
    }

    /// Whether a motion ends there.
    pub fn stops(&self, kind: &EventKind) -> bool {
        self.stop.iter().any(|name| name == self.name(kind))
    }
}
