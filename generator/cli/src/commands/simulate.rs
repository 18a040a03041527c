//! `hodograph simulate`: motion with collisions.

use std::cell::RefCell;
use std::path::PathBuf;

use differential_equations::prelude::{
    CrossingDirection, Event, EventConfig, ExplicitRungeKutta, IVP, ODE, Status,
};
use hodograph::Surface;
use hodograph_generator::model::mechanism::Orientation;
use hodograph_generator::program::routine::{ContactQuantity, Quantity};
use serde::Serialize;

use crate::derivation::Limits;
use crate::evaluate::collision::{Collision, collide};
use crate::evaluate::report::{Named, named};
use crate::evaluate::{Machine, complete};
use crate::json::state::State;
use crate::json::{Failure, Kind};
use crate::model;
use crate::output;
use crate::stop::{Outcome, Stop};
use crate::surface::SurfaceArguments;

/// Simulate a model from a state: motion, and collisions where a gap closes, as JSON lines
///
///   hodograph simulate models/free_box_corner.mech --until 1 --step 0.01 --mu 0.3 --e 0.5 --law stronge
///
/// Lines are {"t":..,"q":{..},"u":{..}} at each step and {"t":..,"contact":"..", what `collide` writes} at each collision.
/// One contact is resolved at a time; where bodies come to rest on each other, or two gaps close at once, the simulation says so and ends.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// a file with the state at the start, `-` for standard input, or the state itself
    #[arg(long, value_name = "FILE|-|JSON", allow_hyphen_values = true)]
    state: Option<String>,
    /// when to end, s
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    until: f64,
    /// a line each so many seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 0.01, allow_hyphen_values = true)]
    step: f64,
    /// relative and absolute tolerance of the integration
    #[arg(long, value_name = "NUMBER", default_value_t = 1e-9, allow_hyphen_values = true)]
    tolerance: f64,
    #[command(flatten)]
    surface: SurfaceArguments,
    #[command(flatten)]
    limits: Limits,
}

#[derive(Serialize)]
struct Sample<'a> {
    t: f64,
    q: Named<'a, f64>,
    u: Named<'a, f64>,
}

#[derive(Serialize)]
struct Hit<'a> {
    t: f64,
    contact: &'a str,
    #[serde(flatten)]
    collision: Collision<'a>,
}

/// Bound on the collisions within one step: more are the end of bouncing.
const MOST_HITS: usize = 100;

/// Runs the command.
///
/// # Errors
///
/// An error object for what is wrong with the state; [`Stop::Fault`] where the motion cannot be followed.
pub fn run(arguments: &Arguments) -> Outcome {
    let (until, step) = (arguments.until, arguments.step);
    if !(until.is_finite() && step.is_finite() && step > 0.0 && arguments.tolerance > 0.0) {
        return Err(Stop::Call("--step and --tolerance must be positive and --until finite".to_owned()));
    }
    let machine = model::machine(&arguments.model, &arguments.limits)?;
    let text = model::state_text(arguments.state.as_deref())?;
    let surface = arguments.surface.surface()?;
    let mut state = machine.state(text.as_deref())?;
    let start = state.time;
    if let Some((gap, index)) = closest(&machine, &state)?
        && gap < -1e-9
    {
        let name = &machine.mechanism.contacts[index].name;
        return Err(Stop::Fault(format!(
            "contact {name} begins with the negative gap {gap}: start where they are apart"
        )));
    }
    sample(&machine, &state)?;
    for count in 1.. {
        let end = (start + f64::from(count) * step).min(until);
        if end <= state.time {
            break;
        }
        let mut hits = 0;
        while state.time < end {
            if advance(&machine, &mut state, end, arguments.tolerance)? {
                hits += 1;
                hit(&machine, &mut state, &surface, hits)?;
            }
        }
        sample(&machine, &state)?;
    }
    Ok(())
}

fn sample(machine: &Machine, state: &State) -> Outcome {
    let q = named(&machine.mechanism.coordinates, state.coordinates.iter().copied());
    let u = named(&machine.mechanism.speeds, state.speeds.iter().copied());
    output::json(&Sample { t: state.time, q, u })
}

/// The smallest gap and its contact, if the model gives any.
fn closest(machine: &Machine, state: &State) -> Result<Option<(f64, usize)>, Failure> {
    let gaps: Vec<Quantity> = (0..machine.mechanism.contacts.len())
        .map(|index| Quantity::Contact(index as u32, ContactQuantity::Gap))
        .collect();
    let numbers = machine.evaluate(state, &gaps)?;
    let gaps = gaps.iter().enumerate().filter_map(|(index, &gap)| Some((*numbers.get(gap).first()?, index)));
    Ok(gaps.min_by(|a, b| a.0.total_cmp(&b.0)))
}

/// The collision of the contact that is closed.
fn hit(machine: &Machine, state: &mut State, surface: &Surface<f64>, hits: usize) -> Outcome {
    let Some((gap, index)) = closest(machine, state)? else { return Ok(()) };
    let contact = &machine.mechanism.contacts[index];
    let (name, time) = (&contact.name, state.time);
    for (other, contact) in machine.mechanism.contacts.iter().enumerate() {
        let quantity = Quantity::Contact(other as u32, ContactQuantity::Gap);
        let numbers = machine.evaluate(state, &[quantity])?;
        if let Some(&other_gap) = numbers.get(quantity).first()
            && other != index
            && (other_gap - gap).abs() < 1e-9
        {
            return Err(Stop::Fault(format!(
                "at t = {time} the gaps of {name} and {} close together: one contact is resolved at a time",
                contact.name
            )));
        }
    }
    let rest = || {
        Stop::Fault(format!("at t = {time} contact {name} comes to rest: lasting contact is not simulated"))
    };
    let collision = collide(machine, state, index, surface).map_err(|failure| match failure.kind {
        Kind::NotApproaching => rest(),
        _ => Stop::Object(failure),
    })?;
    for (speed, (_, after)) in state.speeds.iter_mut().zip(&collision.u_after.0) {
        *speed = *after;
    }
    let separation = collision.answer.v[0];
    output::json(&Hit { t: time, contact: name, collision })?;
    // What falls with 1e-6 m/s bounces for less than a microsecond.
    if hits > MOST_HITS || separation < 1e-6 {
        return Err(rest());
    }
    Ok(())
}

/// The equations of motion, as the integrator sees them.
struct Motion<'a> {
    machine: &'a Machine,
    state: &'a State,
    failure: RefCell<Option<Failure>>,
}

impl Motion<'_> {
    fn at(&self, t: f64, y: &[f64]) -> State {
        let (q, u) = y.split_at(self.state.coordinates.len());
        State { time: t, coordinates: q.to_vec(), speeds: u.to_vec(), ..self.state.clone() }
    }

    fn fail(&self, failure: Failure) {
        self.failure.borrow_mut().get_or_insert(failure);
    }
}

impl ODE<f64, Vec<f64>> for Motion<'_> {
    fn diff(&self, t: f64, y: &Vec<f64>, dydt: &mut Vec<f64>) {
        let wanted = [Quantity::CoordinateRates, Quantity::Accelerations];
        match self.machine.evaluate(&self.at(t, y), &wanted) {
            Ok(numbers) => {
                let rates = wanted.iter().flat_map(|&quantity| numbers.get(quantity));
                dydt.iter_mut().zip(rates).for_each(|(slot, rate)| *slot = *rate);
            }
            Err(failure) => {
                self.fail(failure);
                dydt.iter_mut().for_each(|slot| *slot = f64::NAN);
            }
        }
    }
}

impl Event<f64, Vec<f64>> for Motion<'_> {
    fn config(&self) -> EventConfig {
        EventConfig::default().direction(CrossingDirection::Negative).terminal()
    }

    fn event(&self, t: f64, y: &Vec<f64>) -> f64 {
        match closest(self.machine, &self.at(t, y)) {
            Ok(closest) => closest.map_or(1.0, |(gap, _)| gap),
            Err(failure) => {
                self.fail(failure);
                1.0
            }
        }
    }
}

/// Follows the motion until a gap closes (true) or a time (false).
fn advance(machine: &Machine, state: &mut State, end: f64, tolerance: f64) -> Outcome<bool> {
    let motion = Motion { machine, state, failure: RefCell::new(None) };
    let y = [&state.coordinates[..], &state.speeds[..]].concat();
    let method = ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance);
    let solved = IVP::ode(&motion, state.time, end, y).event(&motion).method(method).solve();
    if let Some(failure) = motion.failure.take() {
        return Err(failure.into());
    }
    let solution = solved.map_err(|error| {
        Stop::Fault(format!("the motion cannot be followed from t = {} on: {error:?}", state.time))
    })?;
    let (Some(&t), Some(y)) = (solution.t.last(), solution.y.last()) else {
        return Err(Stop::Fault("the integration gave no result".to_owned()));
    };
    let closed = matches!(solution.status, Status::Interrupted);
    let next = motion.at(if closed { t } else { end }, y);
    *state = next;
    for frame in &machine.mechanism.frames {
        let Orientation::Quaternion(parts) = frame.orientation else { continue };
        let norm = parts.map(|part| state.coordinates[part.0].powi(2)).iter().sum::<f64>().sqrt();
        parts.iter().for_each(|part| state.coordinates[part.0] /= norm);
    }
    complete::complete(machine, state)?;
    Ok(closed)
}
