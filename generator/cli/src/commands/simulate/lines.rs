//! Writes the states and events of `simulate` as lines, or gathers them for a summary.

use hodograph::{ComponentKind, Mechanism, Selection, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{CollisionRecord, EnergyAccount, Event, EventKind, SimultaneousCollision};
use serde::Serialize;

use super::summary::Summary;
use crate::evaluate::report::{Named, named};
use crate::json::answer::Answer;
use crate::output;
use crate::stop::{Outcome, Stop};

/// The format of lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// tables of states and events, and a summary
    Table,
    /// a JSON object per line
    Json,
    /// comma-separated values: t, event, contact, coordinates, speeds
    Csv,
}

/// The columns of CSV before those of coordinates and speeds.
const OWN_COLUMNS: [&str; 3] = ["t", "event", "contact"];

#[derive(Serialize)]
struct Sample<'a> {
    t: f64,
    q: Named<'a, f64>,
    u: Named<'a, f64>,
}

/// An event; fields that do not apply to it are left out.
#[derive(Serialize)]
struct Line<'a> {
    t: f64,
    event: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<&'a str>,
    #[serde(flatten)]
    answer: Option<Answer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shares: Option<Vec<ShareOf<'a>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    u_after: Option<Named<'a, f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kinetic_energy_change: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    last_bounce: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    spread: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    along: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sense: Option<i8>,
    #[serde(skip_serializing_if = "Option::is_none")]
    several_modes: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    indeterminate: Option<bool>,
    q: Named<'a, f64>,
    u: Named<'a, f64>,
}

/// The part of one of several contacts in a simultaneous impact.
#[derive(Serialize)]
struct ShareOf<'a> {
    contact: &'a str,
    /// normal impulse, N s
    impulse: f64,
    /// normal velocity before and after, m/s
    v_before: f64,
    v: f64,
    /// work of the impulse, J
    work: f64,
}

/// Writes lines.
pub struct Lines<'m> {
    mechanism: &'m InterpretedMechanism,
    format: Format,
    summary: Summary,
    /// whether the simulation continues after the reader of the lines has closed the pipe
    to_the_end: bool,
    reader_gone: bool,
}

impl<'m> Lines<'m> {
    /// Starts the output; CSV begins with a header. With `to_the_end` the simulation continues even if the
    /// reader of the lines closes the pipe, since files shall contain all of the motion.
    ///
    /// # Errors
    ///
    /// As [`output::text`].
    pub fn new(mechanism: &'m InterpretedMechanism, format: Format, to_the_end: bool) -> Outcome<Self> {
        let summary = Summary::default();
        let mut lines = Lines { mechanism, format, summary, to_the_end, reader_gone: false };
        if format == Format::Csv {
            let names = |kind| {
                (0..mechanism.count(kind))
                    .filter_map(move |index| mechanism.component(kind, index))
                    .map(|component| component.name)
            };
            let quantities = || names(ComponentKind::Coordinate).chain(names(ComponentKind::Speed));
            if let Some(name) = quantities().find(|name| OWN_COLUMNS.contains(name)) {
                return Err(Stop::Call(format!(
                    "--format csv: the column `{name}` would stand there twice, since a quantity of the model has this name too: give \
                     --format json, or rename it in the model"
                )));
            }
            let head: Vec<&str> = OWN_COLUMNS.into_iter().chain(quantities()).collect();
            lines.write(&csv_row(head)?)?;
        }
        Ok(lines)
    }

    /// The state at a time.
    ///
    /// # Errors
    ///
    /// As [`output::text`].
    pub fn sample(&mut self, t: f64, q: &[f64], u: &[f64]) -> Outcome {
        match self.format {
            Format::Table => self.summary.state(t, q, u),
            Format::Csv => return self.row(t, "", "", q, u),
            Format::Json => {
                let line = json(&Sample { t, q: self.coordinates(q), u: self.speeds(u) })?;
                return self.write(&line);
            }
        }
        Ok(())
    }

    /// The energies at the current time.
    pub fn energy(&mut self, account: EnergyAccount) {
        self.summary.energy(account);
    }

    /// Writes the summary of a table.
    ///
    /// # Errors
    ///
    /// As [`output::text`].
    pub fn finish(&self) -> Outcome {
        match self.format {
            Format::Table => output::text(&output::visible(&self.summary.text(self.mechanism.model()))),
            Format::Json | Format::Csv => Ok(()),
        }
    }

    /// Writes a line. If the reader has closed the pipe, this is an error unless the simulation shall
    /// continue.
    fn write(&mut self, line: &str) -> Outcome {
        if self.reader_gone {
            return Ok(());
        }
        match output::line(line) {
            Err(Stop::ReaderGone) if self.to_the_end => {
                self.reader_gone = true;
                Ok(())
            }
            other => other,
        }
    }

    /// Writes an event.
    ///
    /// # Errors
    ///
    /// As [`output::text`].
    pub fn event(&mut self, event: &Event, inputs: &[f64]) -> Outcome {
        let name = |contact| {
            self.mechanism.component(ComponentKind::Contact, contact).map(|component| component.name)
        };
        let contact = event.contact.and_then(name);
        match self.format {
            Format::Json => {}
            Format::Table => {
                self.summary.event(event, contact.unwrap_or(""));
                return Ok(());
            }
            Format::Csv => {
                let (kind, contact) = (event.kind.name(), contact.unwrap_or(""));
                return self.row(event.time, kind, contact, &event.coordinates, &event.speeds);
            }
        }
        let line = self.object(event, inputs, contact)?;
        self.write(&line)
    }

    /// An event as JSON.
    fn object(&self, event: &Event, inputs: &[f64], contact: Option<&str>) -> Outcome<String> {
        let mut line = Line {
            t: event.time,
            event: event.kind.name(),
            contact,
            answer: None,
            shares: None,
            u_after: None,
            kinetic_energy_change: None,
            last_bounce: None,
            spread: None,
            mode: None,
            direction: None,
            along: None,
            sense: None,
            several_modes: None,
            indeterminate: None,
            q: self.coordinates(&event.coordinates),
            u: self.speeds(&event.speeds),
        };
        let mut certain = |selection: &Selection| {
            line.several_modes = (*selection == Selection::SeveralModes).then_some(true);
            line.indeterminate = (*selection == Selection::Indeterminate).then_some(true);
        };
        match &event.kind {
            EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => {
                self.collision(event, struck, inputs, &mut line)?;
            }
            EventKind::SimultaneousCollision(struck) => self.simultaneous(event, struck, inputs, &mut line),
            EventKind::Contact { mode, selection } => {
                certain(selection);
                line.mode = Some(mode.name());
            }
            EventKind::Slip { direction, along, selection }
            | EventKind::Roll { direction, along, selection } => {
                certain(selection);
                line.direction = Some(direction.map(|part| part + 0.0));
                line.along = Some(along.map(|part| part + 0.0));
            }
            EventKind::Spin { positive, selection } => {
                certain(selection);
                line.sense = Some(if *positive { 1 } else { -1 });
            }
            EventKind::LiftOff { selection }
            | EventKind::Stick { selection }
            | EventKind::RollEnds { selection }
            | EventKind::SpinEnds { selection } => certain(selection),
            _ => {}
        }
        json(&line)
    }

    /// The fields of an impact: those of `collide`, and the speeds before as `u`.
    fn collision<'a>(
        &'a self,
        event: &'a Event,
        struck: &'a CollisionRecord,
        inputs: &[f64],
        line: &mut Line<'a>,
    ) -> Outcome {
        line.answer = Some(Answer::try_from(&struck.outcome.impact)?);
        line.u_after = Some(self.after(event, inputs));
        line.kinetic_energy_change = Some(struck.outcome.energy_change + 0.0);
        line.last_bounce = struck.last_bounce.then_some(true);
        line.spread = struck.spread;
        line.u = self.speeds(&struck.speeds_before);
        Ok(())
    }

    /// The fields of a simultaneous impact, and the speeds before as `u`.
    fn simultaneous<'a>(
        &'a self,
        event: &'a Event,
        struck: &'a SimultaneousCollision,
        inputs: &[f64],
        line: &mut Line<'a>,
    ) {
        let shares = struck.shares.iter().map(|share| ShareOf {
            contact: self
                .mechanism
                .component(ComponentKind::Contact, share.contact)
                .map_or("", |component| component.name),
            impulse: share.impulse + 0.0,
            v_before: share.approach + 0.0,
            v: share.separation + 0.0,
            work: share.work + 0.0,
        });
        line.shares = Some(shares.collect());
        line.u_after = Some(self.after(event, inputs));
        line.kinetic_energy_change = Some(struck.energy_change + 0.0);
        line.spread = struck.spread;
        line.u = self.speeds(&struck.speeds_before);
    }

    /// All speeds after an event, at which the inputs have these values.
    fn after(&self, event: &Event, inputs: &[f64]) -> Named<'_, f64> {
        let mut after = event.speeds.clone();
        let mut dependent = vec![0.0; self.mechanism.count(ComponentKind::DependentSpeed)];
        let state =
            State { time: event.time, coordinates: &event.coordinates, speeds: &event.speeds, inputs };
        if self.mechanism.dependent_speeds(&state, &mut dependent).is_ok() {
            after.extend(dependent);
        }
        named(&self.mechanism.model().speeds, after)
    }

    fn coordinates(&self, q: &[f64]) -> Named<'_, f64> {
        named(&self.mechanism.model().coordinates, q.iter().map(|value| value + 0.0))
    }

    fn speeds(&self, u: &[f64]) -> Named<'_, f64> {
        named(&self.mechanism.model().speeds, u.iter().map(|value| value + 0.0))
    }

    fn row(&mut self, t: f64, event: &str, contact: &str, q: &[f64], u: &[f64]) -> Outcome {
        let numbers = q.iter().chain(u).map(|value| (value + 0.0).to_string());
        let cells = [t.to_string(), event.to_owned(), contact.to_owned()].into_iter().chain(numbers);
        self.write(&csv_row(cells)?)
    }
}

/// A line of CSV.
fn csv_row<C: AsRef<[u8]>>(cells: impl IntoIterator<Item = C>) -> Outcome<String> {
    let fault = |error: String| Stop::Fault(format!("cannot write CSV: {error}"));
    let mut writer =
        csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(Vec::new());
    writer.write_record(cells).map_err(|error| fault(error.to_string()))?;
    let row = writer.into_inner().map_err(|error| fault(error.to_string()))?;
    let row = String::from_utf8(row).map_err(|error| fault(error.to_string()))?;
    Ok(row.trim_end_matches('\n').to_owned())
}

/// A line of JSON.
fn json(value: &impl Serialize) -> Outcome<String> {
    serde_json::to_string(value).map_err(|error| Stop::Fault(format!("cannot write JSON: {error}")))
}
