//! The motion of a model: its states, events, and what of it is drawn.

use hodograph::{Contacts, Surface};
use hodograph_animation::{Recorded, Recording, Setup, Span, Watch, follow};
use hodograph_interpreter::motion::{GivenSurface, STEP, STEP_OF_TIME, surfaces};
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};
use hodograph_model::model::mechanism::Mechanism;
use hodograph_model::numeric::State;
use hodograph_model::source::Source;
use hodograph_program::artifact::Loaded;
use hodograph_simulation::{ContactLaw, Event, EventKind, Options, Simulation, SimulationError};
use serde_json::{Value, json};

use crate::answer::object;
use crate::collision::law;
use crate::{GoOn, model};

/// How long a motion lasts where nothing is said, s.
const LASTS: f64 = 10.0;
/// A motion has this many samples at most.
const MOST_SAMPLES: f64 = 20_000.0;

/// Why a motion ended before its time.
enum End {
    /// it took too long
    Stopped(f64),
    /// it cannot be followed
    Fault(String),
}

impl From<SimulationError> for End {
    fn from(error: SimulationError) -> Self {
        End::Fault(error.to_string())
    }
}

/// What is kept of a motion.
struct Keeper<'m, 'g> {
    recording: Recording<'m>,
    surfaces: Vec<(usize, Surface<f64>)>,
    /// per event shown: what its hodograph is computed from
    collisions: Vec<Value>,
    events: Vec<Value>,
    go_on: GoOn<'g>,
}

impl Keeper<'_, '_> {
    fn look(&self, time: f64) -> Result<(), End> {
        if (self.go_on)(time) { Ok(()) } else { Err(End::Stopped(time)) }
    }
}

impl Watch<End> for Keeper<'_, '_> {
    fn sample(&mut self, simulation: &Simulation<'_>) -> Result<(), End> {
        self.recording.add(simulation);
        self.look(simulation.time())
    }

    fn event(&mut self, event: &Event, simulation: &Simulation<'_>) -> Result<(), End> {
        self.recording.before(event, simulation);
        self.recording.add(simulation);
        let shown = self.recording.shown().events.len();
        self.recording.event(event);
        if let (EventKind::Collision(struck), Some(contact)) = (&event.kind, event.contact) {
            let surface = self.surfaces.iter().find(|(of, _)| *of == contact).map(|(_, surface)| surface);
            let m = &struck.outcome.reduced;
            if let Some(surface) = surface {
                self.collisions.push(object!({
                    "event": shown,
                    "matrix": [m.nn, m.nt, m.ns, m.tt, m.ts, m.ss],
                    "approach": struck.outcome.approach.as_slice(),
                    "mu": surface.mu,
                    "e": if struck.last_bounce { 0.0 } else { surface.e },
                    "law": surface.law.name(),
                }));
            }
        }
        self.events.push(object!({
            "t": event.time, "event": event.kind.name(), "contact": event.contact,
            "q": event.coordinates.as_slice(), "u": event.speeds.as_slice(),
        }));
        self.look(event.time)
    }
}

/// Follows a motion.
///
/// # Errors
///
/// A sentence: the model has mistakes, the numbers are impossible, a contact has no surface.
pub fn motion(source: &Source, question: &Value, go_on: GoOn<'_>) -> Result<Value, String> {
    let mechanism = model::read(source)?;
    let start = model::start(&mechanism, question)?;
    let free: Vec<f64> = mechanism
        .parameters
        .iter()
        .zip(&start.parameters)
        .filter(|(parameter, _)| !parameter.fixed)
        .map(|(_, value)| *value)
        .collect();
    let kept = model::derivation(source, question["derivation"].as_str().unwrap_or(""));
    if let Loaded::Fresh(program) = kept {
        let interpreted = InterpretedMechanism::with_parameters(mechanism.clone(), *program, &free)
            .map_err(|error| error.to_string())?;
        let step = interpreted.greatest_step(false);
        return followed(&interpreted, &mechanism, &start, question, step, "derivation", go_on);
    }
    let step = if source.names_time() { STEP_OF_TIME } else { f64::INFINITY };
    let numeric = NumericMechanism::with_parameters(mechanism.clone(), &free).map_err(|e| e.to_string())?;
    followed(&numeric, &mechanism, &start, question, step, "numeric", go_on)
}

/// The surface of a contact, or of all, as far as a question gives it.
fn given(value: &Value) -> Result<GivenSurface, String> {
    let law = value["law"].as_str().filter(|name| !name.is_empty()).map(law).transpose()?;
    let given = GivenSurface { mu: value["mu"].as_f64(), e: value["e"].as_f64(), law };
    given.check().map_err(|error| error.to_string())
}

fn followed(
    mechanism: &dyn Contacts<f64>,
    model: &Mechanism,
    start: &State,
    question: &Value,
    max_step: f64,
    road: &str,
    go_on: GoOn<'_>,
) -> Result<Value, String> {
    let state = hodograph::State {
        time: start.time,
        coordinates: &start.coordinates,
        speeds: &start.speeds,
        inputs: &start.inputs,
    };
    let all = given(&question["surface"])?;
    let mut own = Vec::new();
    for (contact, found) in model.contacts.iter().enumerate() {
        own.push((contact, given(&question["surfaces"][&found.name])?));
    }
    let surfaces = surfaces(mechanism, &state, all, &own).map_err(|error| {
        format!("{error}: state its `surface` in the model, or give mu, e and the law beside the picture")
    })?;
    let mut laws = Vec::new();
    for contact in 0..model.contacts.len() {
        laws.push((contact, ContactLaw::stated(&mechanism.stated_law(contact))?));
    }
    let number = |name: &str, usual: f64| question[name].as_f64().filter(|x| *x > 0.0).unwrap_or(usual);
    let tolerance = number("tolerance", Options::default().relative_tolerance);
    let until = start.time + number("until", LASTS);
    let step = number("step", STEP).max((until - start.time) / MOST_SAMPLES);
    let options = Options {
        relative_tolerance: tolerance,
        absolute_tolerance: tolerance,
        max_step,
        surfaces: surfaces.of_contacts.clone(),
        laws,
        ..Options::default()
    };
    // as the command line tool does: what nothing pushes may come to rest
    let at_rest = question["until"].is_null() && max_step.is_infinite();
    let span = Span { start: start.time, until, step, at_rest };
    let mut simulation = Simulation::new(mechanism, &state, options).map_err(|error| error.to_string())?;
    let mut keeper = Keeper {
        recording: Recording::new(mechanism, model, start, Setup::default()),
        surfaces: surfaces.of_contacts,
        collisions: Vec::new(),
        events: Vec::new(),
        go_on,
    };
    keeper.recording.add(&simulation);
    let end = follow(&mut simulation, &span, &mut keeper);
    let Keeper { recording, collisions, events, .. } = keeper;
    let Recorded { mut shown, states, .. } = recording.finish();
    for contact in surfaces.without_gap {
        let name = &model.contacts[contact].name;
        shown.notes.push(format!("contact {name} has no gap in the model: it is never seen to close"));
    }
    let (stopped, fault) = match end {
        Ok(()) => (None, None),
        Err(End::Stopped(time)) => (Some(time), None),
        Err(End::Fault(text)) => (None, Some(text)),
    };
    let times = shown.times.clone();
    shown.thin();
    Ok(object!({
        "animation": json!(shown), "times": times, "states": json!(states), "events": events,
        "collisions": collisions, "road": road, "stopped": stopped, "ended": fault,
    }))
}
