//! Simulates a motion and keeps what its derivatives are carried through: smooth parts, events, and states at given
//! times.

use std::fmt;

use hodograph::{ComponentKind, Contacts, Mechanism, State, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::stepper::Tolerances;
use hodograph_simulation::{ContactLaw, Drive, Event, Options, Simulation, SimulationError, SmoothPart};
use nalgebra::DMatrix;

use crate::By;
use crate::field::Sampling;

/// The state at a time, after the events there.
#[derive(Clone, Debug)]
pub struct Sample {
    /// s
    pub time: f64,
    /// coordinates and independent speeds: those of the simulation, whether or not there are derivatives
    pub state: Vec<f64>,
    /// their derivatives at this time; `None` if the motion is not differentiable
    pub derivative: Option<DMatrix<f64>>,
}

/// Why a motion is not differentiated at all.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum GradientError {
    /// The motion itself fails.
    Simulation(SimulationError),
    /// The motion has a property with which derivatives are not supported, in words.
    NotSupported(String),
    /// The times are not finite, do not increase, or begin before the start; or a variable does not exist.
    BadRequest(String),
}

impl fmt::Display for GradientError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulation(error) => error.fmt(out),
            Self::NotSupported(what) => write!(out, "derivatives of this motion are not supported: {what}"),
            Self::BadRequest(what) => out.write_str(what),
        }
    }
}

impl std::error::Error for GradientError {}

impl From<SimulationError> for GradientError {
    fn from(error: SimulationError) -> Self {
        Self::Simulation(error)
    }
}

/// A motion that was simulated, to be differentiated.
pub(crate) struct Followed {
    pub parts: Vec<SmoothPart>,
    /// up to the last of the given times
    pub events: Vec<Event>,
    /// the states at the given times, without derivatives
    pub samples: Vec<Sample>,
    /// first and last time, s
    pub start: f64,
    pub end: f64,
    pub surfaces: Vec<(usize, Surface<f64>)>,
    pub sampling: Option<Sampling>,
    pub tolerances: Tolerances,
}

impl Followed {
    /// Simulates a motion that supports derivatives.
    pub fn new(
        mechanism: &InterpretedMechanism,
        start: &State<'_>,
        options: Options,
        by: &[By],
        times: &[f64],
    ) -> Result<Self, GradientError> {
        check_request(mechanism, start, &options, by, times)?;
        let sampling = match &options.drive {
            Drive::Table(table) => {
                Some(Sampling { start: start.time, period: table.period, rows: table.values.len() })
            }
            _ => None,
        };
        let surfaces = supported(mechanism, start, &options)?;
        let tolerances =
            Tolerances { relative: options.relative_tolerance, absolute: options.absolute_tolerance };
        let end = times.last().copied().unwrap_or(start.time);
        let mut simulation = Simulation::new(mechanism, start, options)?;
        simulation.keep_parts();
        let (mut events, mut parts, mut samples) = (Vec::new(), Vec::new(), Vec::new());
        for &time in times {
            events.extend(simulation.advance_to(time)?);
            parts.extend(simulation.take_parts());
            let state = [simulation.coordinates(), simulation.speeds()].concat();
            samples.push(Sample { time, state, derivative: None });
        }
        if parts.last().is_none_or(|part: &SmoothPart| part.end <= end) {
            // Events at the end need the motion after them.
            simulation.advance_to(end.next_up())?;
            parts.extend(simulation.take_parts());
        }
        events.retain(|event| event.time <= end);
        Ok(Followed { parts, events, samples, start: start.time, end, surfaces, sampling, tolerances })
    }
}

fn check_request(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: &Options,
    by: &[By],
    times: &[f64],
) -> Result<(), GradientError> {
    let bad = |what: String| Err(GradientError::BadRequest(what));
    let mut before = start.time;
    for &time in times {
        if !time.is_finite() || time < before {
            return bad(format!(
                "the times must be finite, not before the start at {} s, and must rise: {time} follows {before}",
                start.time
            ));
        }
        before = time;
    }
    for &variable in by {
        let (kind, index) = match variable {
            By::Coordinate(index) => (ComponentKind::Coordinate, index),
            By::Speed(index) => (ComponentKind::Speed, index),
            By::Parameter(index) => (ComponentKind::Parameter, index),
            By::Input(index) => (ComponentKind::Input, index),
            By::Sample { input, row } => {
                let rows = match &options.drive {
                    Drive::Table(table) => table.values.len(),
                    _ => 0,
                };
                if row >= rows {
                    return bad(format!("there is no sample {row} of the inputs: there are {rows}"));
                }
                (ComponentKind::Input, input)
            }
            By::Friction(contact) | By::Restitution(contact) => {
                (ComponentKind::Contact, contact.unwrap_or(0))
            }
        };
        if index >= mechanism.count(kind) {
            return bad(format!("there is no {} with the number {index}", kind.noun()));
        }
    }
    Ok(())
}

/// The surfaces of the contacts, if all of them support derivatives.
fn supported(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: &Options,
) -> Result<Vec<(usize, Surface<f64>)>, GradientError> {
    let no = |what: String| Err(GradientError::NotSupported(what));
    if !matches!(options.drive, Drive::Held | Drive::Table(_)) || !options.breaks.is_empty() {
        return no("its inputs are functions or come from a controller; only inputs that are held, or a table of samples, have derivatives"
            .to_owned());
    }
    if mechanism.count(ComponentKind::DependentCoordinate) > 0 {
        return no("the mechanism has closed loops (dependent coordinates)".to_owned());
    }
    let mut surfaces = Vec::new();
    for contact in 0..mechanism.count(ComponentKind::Contact) {
        if !matches!(mechanism.gap(contact, start), Ok(Some(_))) {
            continue;
        }
        let own = |list: &[(usize, Surface<f64>)]| {
            list.iter().rev().find(|(other, _)| *other == contact).map(|(_, surface)| *surface)
        };
        let surface = own(&options.surfaces).or(options.surface).or_else(|| mechanism.surface(contact));
        surfaces.extend(surface.map(|surface| (contact, surface)));
        let given =
            options.laws.iter().rev().find(|(other, _)| *other == contact).map(|(_, law)| law.clone());
        let stated = || ContactLaw::stated(&mechanism.stated_law(contact)).unwrap_or_default();
        let law = given.or_else(|| options.law.clone()).unwrap_or_else(stated);
        if law != ContactLaw::default() {
            let name =
                mechanism.component(ComponentKind::Contact, contact).map_or("?", |contact| contact.name);
            return no(format!(
                "contact {name} has a law of its own beyond mu, e and law (static friction, functions of speeds, rolling or spinning \
                 friction)"
            ));
        }
    }
    Ok(surfaces)
}
