//! What the examples share: a motion followed and told in lines, and a picture of it.
#![allow(dead_code)]

pub mod picture;

use std::error::Error;

use hodograph::{ComponentKind, Contacts, State};
use hodograph_simulation::{EnergyAccount, Event, EventKind, Options, Progress, Simulation};

pub use picture::Picture;

/// What an example tells and shows.
#[derive(Debug, Default)]
pub struct Story {
    /// to be read
    pub text: String,
    /// to be looked at
    pub picture: Picture,
    /// everything that happened
    pub events: Vec<Event>,
    /// the state at the end: coordinates and speeds
    pub end: (Vec<f64>, Vec<f64>),
    /// the energies at the start and at the end
    pub energy: [EnergyAccount; 2],
}

/// The answer of an example.
pub type Told = Result<Story, Box<dyn Error>>;

/// Prints a story, and writes its picture where the call asks for one.
pub fn show(story: &Story) -> Result<(), Box<dyn Error>> {
    println!("{}", story.text);
    let mut arguments = std::env::args().skip(1);
    match (arguments.next().as_deref(), arguments.next()) {
        (Some("--svg"), Some(path)) => {
            std::fs::write(&path, story.picture.svg())?;
            println!("the picture is {path}");
        }
        (None, _) => println!("A picture: the same call with `-- --svg FILE`."),
        _ => return Err("the only option is --svg FILE".into()),
    }
    Ok(())
}

/// The state that a model's file gives as its first.
pub struct Start {
    pub coordinates: Vec<f64>,
    pub speeds: Vec<f64>,
    pub inputs: Vec<f64>,
}

impl Start {
    pub fn of(mechanism: &dyn Contacts<f64>) -> Result<Self, Box<dyn Error>> {
        let none = |kind| vec![0.0; mechanism.count(kind)];
        let mut start = Start {
            coordinates: none(ComponentKind::Coordinate),
            speeds: none(ComponentKind::Speed),
            inputs: none(ComponentKind::Input),
        };
        mechanism.initial_state(&mut start.coordinates, &mut start.speeds, &mut start.inputs)?;
        Ok(start)
    }

    pub fn state(&self) -> State<'_> {
        State { time: 0.0, coordinates: &self.coordinates, speeds: &self.speeds, inputs: &self.inputs }
    }
}

/// Follows a motion to a time, or to rest, and calls `look` each so many seconds.
pub fn follow(
    mechanism: &dyn Contacts<f64>,
    start: &Start,
    options: Options,
    (until, every): (f64, f64),
    mut look: impl FnMut(&Simulation<'_>, &mut Story),
) -> Told {
    let mut simulation = Simulation::new(mechanism, &start.state(), options)?;
    let mut story = Story::default();
    story.energy[0] = simulation.energy()?;
    look(&simulation, &mut story);
    'motion: for count in 1_u32.. {
        let time = (f64::from(count) * every).min(until);
        while let Progress::Event(event) = simulation.advance(time)? {
            let ends = matches!(event.kind, EventKind::Rest | EventKind::Singular);
            story.events.push(event);
            if ends {
                look(&simulation, &mut story);
                break 'motion;
            }
        }
        look(&simulation, &mut story);
        if time >= until {
            break;
        }
    }
    story.energy[1] = simulation.energy()?;
    story.end = (simulation.coordinates().to_vec(), simulation.speeds().to_vec());
    Ok(story)
}

/// The events as lines. Bounces follow each other ever faster: those that do, and the contacts that they end
/// in, stand in one.
pub fn lines(mechanism: &dyn Contacts<f64>, events: &[Event]) -> String {
    let mut text = String::new();
    let mut rest = events;
    while let Some(first) = rest.first() {
        let run = (1..rest.len())
            .take_while(|&k| {
                bounces(&rest[k - 1]) && bounces(&rest[k]) && rest[k].time - rest[k - 1].time < PAUSE
            })
            .count();
        let (group, after) = rest.split_at(1 + run);
        let impacts = group.iter().filter(|event| struck(event).is_some()).count();
        text += &if impacts > 0 { impacts_line(mechanism, group) } else { line(mechanism, first) };
        text.push('\n');
        rest = if impacts > 0 { after } else { &rest[1..] };
    }
    text
}

/// Impacts that are further apart stand in lines of their own, s.
const PAUSE: f64 = 0.05;

fn bounces(event: &Event) -> bool {
    matches!(event.kind, EventKind::Collision(_) | EventKind::Contact { .. })
}

fn name(mechanism: &dyn Contacts<f64>, contact: Option<usize>) -> &str {
    contact
        .and_then(|contact| mechanism.component(ComponentKind::Contact, contact))
        .map_or("", |component| component.name)
}

fn struck(event: &Event) -> Option<&hodograph_simulation::CollisionRecord> {
    match &event.kind {
        EventKind::Collision(struck) => Some(struck),
        _ => None,
    }
}

/// Names, each once.
fn names(mechanism: &dyn Contacts<f64>, contacts: impl Iterator<Item = Option<usize>>) -> String {
    let mut names: Vec<&str> = contacts.map(|contact| name(mechanism, contact)).collect();
    names.sort_unstable();
    names.dedup();
    names.join(", ")
}

/// An impact, or several in a row.
fn impacts_line(mechanism: &dyn Contacts<f64>, events: &[Event]) -> String {
    let impacts: Vec<(&Event, &hodograph_simulation::CollisionRecord)> =
        events.iter().filter_map(|event| struck(event).map(|struck| (event, struck))).collect();
    let at = names(mechanism, impacts.iter().map(|(event, _)| event.contact));
    let energy: f64 = impacts.iter().map(|(_, struck)| struck.outcome.energy_change).sum::<f64>() + 0.0;
    let (first, last) = (events[0].time, events[events.len() - 1].time);
    let mut text = match &impacts[..] {
        [(_, hit)] => format!(
            "{first:9.6} s  {at} strikes at {:.3} m/s and leaves at {:.3} m/s: {energy:+.4} J",
            -hit.outcome.approach.x,
            hit.outcome.impact.velocity.x.max(0.0)
        ),
        _ if last - first < 1e-9 => {
            format!("{first:9.6} s  {at} strike together, {} impacts in turn: {energy:+.4} J", impacts.len())
        }
        _ => format!("{first:9.6} s  to {last:.6} s: {} impacts at {at}: {energy:+.4} J", impacts.len()),
    };
    // How they touch in the end: the last that is said of each.
    let mut touch: Vec<(usize, &str)> = Vec::new();
    for event in events {
        let Some(contact) = event.contact else { continue };
        touch.retain(|(other, _)| *other != contact);
        if let EventKind::Contact { mode, .. } = &event.kind {
            touch.push((contact, mode.name()));
        }
    }
    for how in ["stick", "slide"] {
        let these = touch.iter().filter(|(_, mode)| *mode == how).map(|(contact, _)| Some(*contact));
        let these = names(mechanism, these);
        if !these.is_empty() {
            text += &format!("; then contact at {these} ({how})");
        }
    }
    text
}

/// An event that is no collision.
fn line(mechanism: &dyn Contacts<f64>, event: &Event) -> String {
    let what = match &event.kind {
        EventKind::Contact { mode, .. } => format!("touches from now on ({})", mode.name()),
        EventKind::LiftOff { .. } => "lifts off".to_owned(),
        EventKind::Slip { .. } => "begins to slip".to_owned(),
        EventKind::Stick { .. } => "stops slipping".to_owned(),
        EventKind::Roll { .. } => "begins to roll".to_owned(),
        EventKind::RollEnds { .. } => "stops rolling".to_owned(),
        EventKind::Spin { .. } => "begins to spin".to_owned(),
        EventKind::SpinEnds { .. } => "stops spinning".to_owned(),
        EventKind::Rest => "everything is at rest".to_owned(),
        EventKind::ImpactWithoutCollision(struck) => format!(
            "no finite force holds it: an impact without collision, {:.3} N s upwards: {:+.4} J",
            struck.outcome.impact.impulse.x, struck.outcome.energy_change
        ),
        other => other.name().to_owned(),
    };
    let contact = name(mechanism, event.contact);
    format!("{:9.6} s  {contact}{}{what}", event.time, if contact.is_empty() { "" } else { " " })
}

/// Where the energy went.
pub fn account(energy: &[EnergyAccount; 2]) -> String {
    let [before, after] = energy;
    let (Some(first), Some(last)) = (before.total(), after.total()) else {
        return "the potential energy is not defined, and there is no account of the energy\n".to_owned();
    };
    // At the start impacts may have happened already.
    let start = first - before.impacts;
    let left = last - start - after.friction - after.impacts;
    let mut text = format!(
        "energy (J): {:.6} at the start, {:.6} at the end\n  impacts {:+.6}, friction while contact lasts {:+.6}\n",
        start, last, after.impacts, after.friction
    );
    if left.abs() > 1e-6 {
        text += &format!("  springs, dampers and inputs {left:+.6}\n");
    } else {
        text += &format!("  the account is off by {:.0e}\n", left.abs());
    }
    text
}
