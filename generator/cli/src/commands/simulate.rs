//! `hodograph simulate`: motion with collisions.

use std::cell::RefCell;
use std::path::PathBuf;

use differential_equations::prelude::{
    CrossingDirection, Event, EventConfig, ExplicitRungeKutta, IVP, ODE, Status,
};
use hodograph::Surface;
use hodograph_generator::model::mechanism::Orientation;
use hodograph_generator::program::{ContactQuantity, Quantity};
use serde::Serialize;

use crate::derivation::{self, Limits};
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

/// Bodies overlap where a gap is below minus this, m.
const OVERLAP: f64 = 1e-9;
/// Bound on the halvings of an interval in which a contact opens and closes.
const SPLITS: usize = 60;

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
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let text = model::state_text(arguments.state.as_deref())?;
    let surface = arguments.surface.surface()?;
    let mut state = machine.state(text.as_deref())?;
    let start = state.time;
    if let Some((gap, index)) = closest(&machine, &state)?
        && gap < -OVERLAP
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
            if let Some(contact) = advance(&machine, &mut state, end, arguments.tolerance)? {
                hits += 1;
                hit(&machine, &mut state, contact, &surface, hits)?;
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

/// A contact that is closed and whose bodies approach: it strikes now.
fn striking(machine: &Machine, state: &State) -> Result<Option<usize>, Failure> {
    for index in 0..machine.mechanism.contacts.len() {
        let wanted = [ContactQuantity::Gap, ContactQuantity::Velocity]
            .map(|what| Quantity::Contact(index as u32, what));
        let numbers = machine.evaluate(state, &wanted)?;
        if let (Some(&gap), Some(&normal)) = (numbers.get(wanted[0]).first(), numbers.get(wanted[1]).first())
            && gap <= 0.0
            && normal < 0.0
        {
            return Ok(Some(index));
        }
    }
    Ok(None)
}

/// The collision of a contact that is closed.
fn hit(machine: &Machine, state: &mut State, index: usize, surface: &Surface<f64>, hits: usize) -> Outcome {
    let gap = |index: usize, state: &State| -> Result<Option<f64>, Failure> {
        let quantity = Quantity::Contact(index as u32, ContactQuantity::Gap);
        Ok(machine.evaluate(state, &[quantity])?.get(quantity).first().copied())
    };
    let Some(own) = gap(index, state)? else { return Ok(()) };
    let contact = &machine.mechanism.contacts[index];
    let (name, time) = (&contact.name, state.time);
    for (other, contact) in machine.mechanism.contacts.iter().enumerate() {
        if other != index
            && let Some(other_gap) = gap(other, state)?
            && (other_gap - own).abs() < 1e-9
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

/// Follows the motion until a contact strikes, which is the result, or to a time.
fn advance(machine: &Machine, state: &mut State, end: f64, tolerance: f64) -> Outcome<Option<usize>> {
    // A gap that is closed already does not close any more: what strikes at once must be seen here.
    if let Some(contact) = striking(machine, state)? {
        return Ok(Some(contact));
    }
    let mut until = end;
    for _ in 0..SPLITS {
        let (next, closed) = integrate(machine, state, until, tolerance)?;
        let closest = closest(machine, &next)?;
        match closest {
            Some((_, contact)) if closed => {
                *state = next;
                return Ok(Some(contact));
            }
            // A gap opened and closed again on the way, so that both ends looked alike: look more closely.
            Some((gap, _)) if gap < -OVERLAP => until = state.time + 0.5 * (until - state.time),
            _ => {
                *state = next;
                return Ok(None);
            }
        }
    }
    Err(Stop::Fault(format!("at t = {} a contact bounces too fast to be followed", state.time)))
}

/// The state at a time, or where a gap closes before (true).
fn integrate(machine: &Machine, state: &State, end: f64, tolerance: f64) -> Outcome<(State, bool)> {
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
    let mut state = motion.at(if closed { t } else { end }, y);
    for frame in &machine.mechanism.frames {
        let Orientation::Quaternion(parts) = frame.orientation else { continue };
        let norm = parts.map(|part| state.coordinates[part.0].powi(2)).iter().sum::<f64>().sqrt();
        parts.iter().for_each(|part| state.coordinates[part.0] /= norm);
    }
    complete::complete(machine, &mut state)?;
    Ok((state, closed))
}
