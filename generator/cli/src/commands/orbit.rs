//! `hodograph orbit`: finds periodic motions, and follows them through a parameter.

use std::path::PathBuf;

use hodograph::{ComponentKind, Mechanism as _};
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_gradients::{
    BranchPoint, By, Exchange, GradientError, Orbit, OrbitError, Periodic, Return, find_orbit, follow_branch,
};
use hodograph_interpreter::InterpretedMechanism;
use serde::Serialize;

use super::motion_arguments::MotionArguments;
use crate::evaluate::report::{Named, named};
use crate::expression;
use crate::json::{Failure, Kind};
use crate::stop::{Outcome, Stop};
use crate::table::{Table, number};

/// Find a periodic motion from a start near to one, with its multipliers, and follow it through a parameter
///
///   hodograph orbit wheel.mech --return collision:second --reset x,z,q --mu 2 --e 0 --law poisson
///   hodograph orbit ball.mech --period 2*pi/60 --follow a=0.002..0.004 --mu 0 --e 0.7 --law newton
///
/// A motion has returned after a period, or just after an event. With --follow the answer is the motions at values of
/// the parameter, and where they change: fold, period_doubling, crossing.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// the period, s, of a motion that is driven in time: a number, or as 2*pi/60
    #[arg(long, value_name = "SECONDS", conflicts_with = "returns", required_unless_present = "returns")]
    period: Option<String>,
    /// the event that ends a period: collision, stick, slip, lift_off, ..; with :CONTACT, and with :COUNT if
    /// it happens several times in a period
    #[arg(long = "return", value_name = "EVENT[:CONTACT][:COUNT]")]
    returns: Option<String>,
    /// coordinates that are reset to their initial values after each period: those on which nothing depends,
    /// and those that a symmetry brings back, such as the angle of the next spoke
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    reset: Vec<String>,
    /// what a symmetry does to the state that has returned: coordinates and speeds take the places of others, as q1=q2,q2=q1
    /// (or q1=-q2) of the legs that change
    #[arg(long, value_name = "TO=FROM,..", value_delimiter = ',')]
    exchange: Vec<String>,
    /// the longest period to wait for, s
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    longest: f64,
    /// segments of a period, in which the motion is sought at the same time: more of them where deviations grow much in a
    /// period
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    segments: usize,
    /// a parameter (or mu, e, mu.CONTACT, e.CONTACT) and the range through which the motion is followed
    #[arg(long, value_name = "NAME=FROM..TO")]
    follow: Option<String>,
    /// the greatest number of motions along the range
    #[arg(long, value_name = "COUNT", default_value_t = 500)]
    points: usize,
    #[command(flatten)]
    motion: MotionArguments,
}

/// Runs the command.
///
/// # Errors
///
/// An error object for mistakes in the state or the names, and if no periodic motion is found.
pub fn run(arguments: &Arguments) -> Outcome {
    let machine = arguments.motion.machine(&arguments.model)?;
    arguments.motion.form.write(
        || {
            let state = arguments.motion.state.state(&machine)?;
            let mechanism = machine.interpreted(&state)?;
            let start = state.borrowed();
            let options = arguments.motion.options(&mechanism, &start)?;
            let periodic = arguments.periodic(&mechanism)?;
            let Some(follow) = &arguments.follow else {
                let orbit = find_orbit(&mechanism, &start, &options, &periodic, &[]).map_err(stop)?;
                let motions = vec![Motion::new(&machine.mechanism, None, &orbit, true)];
                return Ok(Answer { motions, changes: Vec::new(), ended: None });
            };
            let (name, range) = range(follow)?;
            let by = variable(&mechanism, name)?;
            let along = (by, range[0], range[1]);
            let found = follow_branch(&mechanism, &start, &options, &periodic, along, arguments.points);
            let found = found.map_err(stop)?;
            let motion =
                |point: &BranchPoint| Motion::new(&machine.mechanism, Some(point.value), &point.orbit, false);
            Ok(Answer {
                motions: found.points.iter().map(motion).collect(),
                changes: found
                    .changes
                    .iter()
                    .map(|change| ChangeOf { change: change.kind.name(), motion: motion(&change.at) })
                    .collect(),
                ended: found.ended,
            })
        },
        Answer::tables,
    )
}

fn stop(error: OrbitError) -> Stop {
    match error {
        OrbitError::BadRequest(message) | OrbitError::Gradient(GradientError::BadRequest(message)) => {
            Stop::Call(message)
        }
        OrbitError::NoReturn(_) | OrbitError::NotFound(_) => {
            Failure::new(Kind::NotFound, error.to_string()).into()
        }
        error => Failure::new(Kind::FailedMotion, error.to_string()).into(),
    }
}

fn variable(mechanism: &InterpretedMechanism, name: &str) -> Outcome<By> {
    let found = By::adjustable(mechanism, name);
    Ok(found.map_err(|message| Failure::new(Kind::UnknownName, format!("--follow: {message}")))?)
}

/// A name and its range.
fn range(text: &str) -> Outcome<(&str, [f64; 2])> {
    let read = || {
        let (name, range) = text.split_once('=')?;
        let (from, to) = range.split_once("..")?;
        Some((name.trim(), [expression::number(from).ok()?, expression::number(to).ok()?]))
    };
    read().ok_or_else(|| Stop::Call(format!("--follow {text}: give NAME=FROM..TO, as in a=0.002..0.004")))
}

impl Arguments {
    fn periodic(&self, mechanism: &InterpretedMechanism) -> Outcome<Periodic> {
        let index = |kind, name: &str| mechanism.index(kind, name.trim());
        let reset = self.reset.iter().map(|name| {
            index(ComponentKind::Coordinate, name).ok_or_else(|| {
                Stop::from(Failure::new(
                    Kind::UnknownName,
                    format!("--reset: there is no coordinate `{name}`"),
                ))
            })
        });
        let reset = reset.collect::<Outcome<Vec<usize>>>()?;
        let exchange = self.exchange.iter().map(|text| {
            Exchange::named(mechanism, text).map_err(|message| Stop::Call(format!("--exchange: {message}")))
        });
        let symmetry = exchange.collect::<Outcome<Vec<Exchange>>>()?;
        let returns = match (&self.period, &self.returns) {
            (Some(period), _) => Return::After(
                expression::number(period)
                    .map_err(|error| Stop::Call(format!("--period {period}: {error}")))?,
            ),
            (None, Some(text)) => {
                let mut parts = text.split(':');
                let event = parts.next().unwrap_or("").to_owned();
                let call = |message: String| Stop::Call(format!("--return {text}: {message}"));
                let (mut contact, mut count) = (None, None);
                for part in parts {
                    let twice = match index(ComponentKind::Contact, part) {
                        Some(found) => contact.replace(found).is_some(),
                        None if part.parse::<f64>().is_ok() => {
                            let number = part.parse::<usize>().ok().filter(|number| *number > 0);
                            let bad = || call(format!("the count is {part}: give a whole number from 1 on"));
                            count.replace(number.ok_or_else(bad)?).is_some()
                        }
                        None => return Err(call(format!("there is no contact `{part}`"))),
                    };
                    if twice {
                        return Err(call("give one contact and one count, as in EVENT:CONTACT:2".to_owned()));
                    }
                }
                if !Return::EVENTS.contains(&event.as_str()) {
                    return Err(Stop::Call(format!(
                        "--return {text}: there is no event `{event}` at which a motion returns: there are {}",
                        Return::EVENTS.join(", ")
                    )));
                }
                Return::At { event, contact, count: count.unwrap_or(1) }
            }
            (None, None) => return Err(Stop::Call("give --period or --return".to_owned())),
        };
        Ok(Periodic { returns, reset, symmetry, longest: self.longest, segments: self.segments })
    }
}

/// The answer of the command.
#[derive(Serialize)]
struct Answer<'a> {
    motions: Vec<Motion<'a>>,
    changes: Vec<ChangeOf<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ended: Option<String>,
}

#[derive(Serialize)]
struct ChangeOf<'a> {
    change: &'static str,
    #[serde(flatten)]
    motion: Motion<'a>,
}

/// A periodic motion.
#[derive(Serialize)]
struct Motion<'a> {
    /// value of the parameter that is followed
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    period: f64,
    q: Named<'a, f64>,
    u: Named<'a, f64>,
    /// real and imaginary parts
    multipliers: Vec<[f64; 2]>,
    stable: bool,
    residual: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    events: Option<Vec<OrbitEvent<'a>>>,
}

#[derive(Serialize)]
struct OrbitEvent<'a> {
    t: f64,
    event: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<&'a str>,
}

impl<'a> Motion<'a> {
    fn new(model: &'a Mechanism, value: Option<f64>, orbit: &Orbit, events: bool) -> Self {
        let (q, u) = orbit.state.split_at(model.coordinates.len());
        let speeds = model.speeds.iter().filter(|speed| !speed.dependent);
        let of_event = |event: &hodograph_simulation::Event| OrbitEvent {
            t: event.time,
            event: event.kind.name(),
            contact: event
                .contact
                .and_then(|index| model.contacts.get(index))
                .map(|found| found.name.as_str()),
        };
        Motion {
            value,
            period: orbit.period,
            q: named(&model.coordinates, q.iter().map(|number| number + 0.0)),
            u: named(speeds, u.iter().map(|number| number + 0.0)),
            multipliers: orbit.multipliers.iter().map(|number| [number.re + 0.0, number.im + 0.0]).collect(),
            stable: orbit.is_stable(),
            residual: orbit.residual,
            events: events.then(|| orbit.events.iter().map(of_event).collect()),
        }
    }

    fn cells(&self) -> Vec<String> {
        let multipliers = self.multipliers.iter().map(|[re, im]| match *im {
            0.0 => number(*re),
            im => format!("{}{}{}i", number(*re), if im < 0.0 { "" } else { "+" }, number(im)),
        });
        let multipliers: Vec<String> = multipliers.collect();
        let mut cells: Vec<String> = self.value.map(number).into_iter().collect();
        cells.push(number(self.period));
        cells.extend(self.q.0.iter().chain(&self.u.0).map(|(_, value)| number(*value)));
        cells.extend([if self.stable { "yes" } else { "no" }.to_owned(), multipliers.join(" ")]);
        cells
    }
}

impl Answer<'_> {
    fn tables(&self) -> String {
        let Some(first) = self.motions.first() else { return String::new() };
        let names = || first.q.0.iter().chain(&first.u.0).map(|(name, _)| *name);
        let value = first.value.is_some().then_some("value");
        let heads = || value.into_iter().chain(["period"]).chain(names()).chain(["stable", "multipliers"]);
        let mut table = Table::new(heads());
        self.motions.iter().for_each(|motion| table.row(motion.cells()));
        let mut out = format!("\n{}", table.text("  "));
        if !self.changes.is_empty() {
            let mut table = Table::new(["change"].into_iter().chain(heads()));
            for change in &self.changes {
                table.row([change.change.to_owned()].into_iter().chain(change.motion.cells()));
            }
            out += &format!("\n{}", table.text("  "));
        }
        if let Some(events) = &first.events {
            let mut table = Table::new(["t", "event", "contact"]);
            for event in events {
                table.row([number(event.t), event.event.to_owned(), event.contact.unwrap_or("").to_owned()]);
            }
            out += &format!("\n{}", table.text("  "));
        }
        if let Some(ended) = &self.ended {
            out += &format!("\nfollowed no further: {ended}\n");
        }
        out
    }
}
