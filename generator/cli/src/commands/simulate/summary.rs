//! Writes a motion as tables of states and events, and a summary.

use hodograph_generator::model::mechanism::{Mechanism, Variable};
use hodograph_simulation::{EnergyAccount, Event, EventKind};

use crate::table::{Table, number, with_unit};

/// The largest numbers of states and events in the tables.
const STATES: usize = 21;
const EVENTS: usize = 40;

/// The part of a motion that the summary reports.
#[derive(Debug, Default)]
pub struct Summary {
    /// the states at steps: time, coordinates, speeds
    states: Vec<(f64, Vec<f64>)>,
    events: Vec<Line>,
    /// at the start and at the end
    energy: [Option<EnergyAccount>; 2],
}

/// An event in words.
#[derive(Debug)]
struct Line {
    time: f64,
    name: &'static str,
    contact: String,
    impulse: Option<f64>,
    energy: Option<f64>,
}

impl Summary {
    /// A state at a step.
    pub fn state(&mut self, t: f64, q: &[f64], u: &[f64]) {
        self.states.push((t, q.iter().chain(u).copied().collect()));
    }

    /// An event at a contact, which may have no name.
    pub fn event(&mut self, event: &Event, contact: &str) {
        let (impulse, energy) = match &event.kind {
            EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => {
                (Some(struck.outcome.impact.impulse.x), Some(struck.outcome.energy_change))
            }
            EventKind::SimultaneousCollision(struck) => (None, Some(struck.energy_change)),
            _ => (None, None),
        };
        let contact = contact.to_owned();
        self.events.push(Line { time: event.time, name: event.kind.name(), contact, impulse, energy });
    }

    /// Takes the energies after the impacts at the start, then those at the end. The account begins before these impacts.
    pub fn energy(&mut self, account: EnergyAccount) {
        if self.energy[0].is_some() {
            self.energy[1] = Some(account);
        } else {
            let before = account.kinetic - account.impacts;
            self.energy[0] = Some(EnergyAccount { kinetic: before, impacts: 0.0, ..account });
        }
    }

    /// The text.
    pub fn text(&self, model: &Mechanism) -> String {
        let mut out = self.states_table(model);
        out += &self.events_table();
        if let [Some(start), Some(end)] = &self.energy {
            out += &energy_table(start, end, model);
        }
        out += self.outcome().as_str();
        out
    }

    fn states_table(&self, model: &Mechanism) -> String {
        let names = |variables: &[Variable]| -> Vec<String> {
            variables.iter().map(|variable| with_unit(&variable.name, &variable.unit)).collect()
        };
        let speeds: Vec<Variable> = model.speeds.iter().filter(|speed| !speed.dependent).cloned().collect();
        let heads = ["t [s]".to_owned()].into_iter().chain(names(&model.coordinates)).chain(names(&speeds));
        let mut table = Table::new(heads);
        let stride = self.states.len().saturating_sub(1).div_ceil(STATES - 1).max(1);
        let last = self.states.len().saturating_sub(1);
        for (index, (t, numbers)) in self.states.iter().enumerate() {
            if index % stride == 0 || index == last {
                table.row([*t].iter().chain(numbers).map(|&value| number(value)));
            }
        }
        let every = match stride {
            1 => String::new(),
            _ => {
                format!(" (every {stride}th of {} states; --format csv or json gives all)", self.states.len())
            }
        };
        format!("{}{every}\n\n{}", model.name, table.text("  "))
    }

    fn events_table(&self) -> String {
        if self.events.is_empty() {
            return String::new();
        }
        let mut table =
            Table::new(["t [s]", "event", "contact", "normal impulse [N s]", "energy change [J]"]);
        let cell = |value: Option<f64>| value.map_or(String::new(), number);
        for line in self.events.iter().take(EVENTS) {
            let name = line.name.replace('_', " ");
            let cells = [
                format!("{:.6}", line.time),
                name,
                line.contact.clone(),
                cell(line.impulse),
                cell(line.energy),
            ];
            table.row(cells);
        }
        let more = self.events.len().saturating_sub(EVENTS);
        let more = if more > 0 { format!("  and {more} more\n") } else { String::new() };
        format!("\nEvents\n\n{}{more}", table.text("  "))
    }

    /// The number of events, and whether the mechanism is at rest at the end.
    fn outcome(&self) -> String {
        let mut counts: Vec<(&str, usize)> = Vec::new();
        for line in self.events.iter().filter(|line| !["rest", "singular"].contains(&line.name)) {
            match counts.iter_mut().find(|(name, _)| *name == line.name) {
                Some((_, count)) => *count += 1,
                None => counts.push((line.name, 1)),
            }
        }
        let counted: Vec<String> = counts.iter().map(|&(name, count)| plural(name, count)).collect();
        let counted = if counted.is_empty() { "no event".to_owned() } else { counted.join(", ") };
        let end = self.states.last().map_or(0.0, |(t, _)| *t);
        let rest = match self.events.last() {
            Some(line) if line.name == "rest" => format!("at rest from t = {} s", number(line.time)),
            Some(line) if line.name == "singular" => {
                let contact = &line.contact;
                format!(
                    "the motion ends at t = {} s: the point of {contact} is undefined there",
                    number(line.time)
                )
            }
            _ => format!("still in motion at t = {} s", number(end)),
        };
        format!("\n{counted}; {rest}.\n")
    }
}

/// A number of events in words.
fn plural(name: &str, count: usize) -> String {
    let words = name.replace('_', " ");
    let (many, one) = match name {
        "struck_together" => (format!("times {words}"), format!("time {words}")),
        "slip" => ("beginnings of slip".to_owned(), "beginning of slip".to_owned()),
        "stick" => ("ends of slip".to_owned(), "end of slip".to_owned()),
        "roll" => ("beginnings of rolling".to_owned(), "beginning of rolling".to_owned()),
        "roll_ends" => ("ends of rolling".to_owned(), "end of rolling".to_owned()),
        "spin" => ("beginnings of spinning".to_owned(), "beginning of spinning".to_owned()),
        "spin_ends" => ("ends of spinning".to_owned(), "end of spinning".to_owned()),
        "lift_off" => ("lift-offs".to_owned(), "lift-off".to_owned()),
        "contact" => ("beginnings of contact".to_owned(), "beginning of contact".to_owned()),
        "impact_without_collision" => {
            ("impacts without collision".to_owned(), "impact without collision".to_owned())
        }
        _ => (format!("{words}s"), words),
    };
    format!("{count} {}", if count == 1 { one } else { many })
}

fn energy_table(start: &EnergyAccount, end: &EnergyAccount, model: &Mechanism) -> String {
    let mut table = Table::new(["energy [J]", "start", "end", "change"]);
    let mut row = |name: &str, a: f64, b: f64| {
        table.row([name.to_owned(), number(a), number(b), number(b - a)]);
    };
    row("kinetic", start.kinetic, end.kinetic);
    if let (Some(a), Some(b)) = (start.potential, end.potential) {
        row("potential", a, b);
        row("sum", start.kinetic + a, end.kinetic + b);
    }
    let mut works = Table::new(["work [J]", ""]);
    for (name, value) in [
        ("impacts", end.impacts - start.impacts),
        ("friction in lasting contact", end.friction - start.friction),
        ("inputs", end.inputs - start.inputs),
    ] {
        if value != 0.0 {
            works.row([name.to_owned(), number(value)]);
        }
    }
    let works = if works.is_empty() { String::new() } else { format!("\n{}", works.text("  ")) };
    let note = hodograph_animation::missing(model).filter(|_| end.potential.is_none());
    let note = note.map_or(String::new(), |note| format!("\n  note: {note}\n"));
    format!("\n{}{works}{note}", table.text("  "))
}
