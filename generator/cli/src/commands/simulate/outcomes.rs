//! `simulate --outcomes`: many motions that differ by the draws at impacts of several contacts, and what they tell of
//! the set of all of them.

use std::time::Duration;

use hodograph::Component;
use hodograph::{ComponentKind, Mechanism as _};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{
    Batch, Case, Drive, ImpactsAtOnce, Options, Outcome as Motion, OutcomeSet, Range, Watch, simulate_many,
};
use serde::Serialize;

use super::lines::Format;
use crate::evaluate::report::{Named, named};
use crate::json::state::State;
use crate::output;
use crate::stop::{Outcome, Stop};
use crate::table::{Table, number, with_unit};

/// So many of the most frequent ends are written.
const ENDS: usize = 20;
/// The confidence of the ranges.
const CONFIDENCE: f64 = 0.95;

/// The options of the set of outcomes.
#[derive(Clone, Debug, clap::Args)]
pub struct OutcomesArguments {
    /// follow this many motions, in each of which contacts that are struck at one time are struck in an order, and in
    /// groups, that are drawn at random; write where they end, what is probably missing, and ranges
    #[arg(
        long,
        value_name = "NUMBER",
        value_parser = clap::value_parser!(u32).range(1..),
        conflicts_with_all = ["spread", "stiffness", "together", "step"]
    )]
    outcomes: Option<u32>,
    /// with --outcomes: the seed of the draws [default: 1]
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
}

impl OutcomesArguments {
    /// Refuses a seed of nothing, and rows of a set.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`].
    pub fn check(&self, format: Option<Format>) -> Outcome {
        match (self.outcomes, self.seed, format) {
            (None, Some(_), _) => {
                Err(Stop::Call("--seed is of --outcomes alone: give that, or leave it out".to_owned()))
            }
            (Some(_), _, Some(Format::Csv)) => {
                Err(Stop::Call("--outcomes has no rows: take --format json or table".to_owned()))
            }
            _ => Ok(()),
        }
    }

    /// The number of motions and the seed, if a set of outcomes is asked for.
    pub fn asked(&self) -> Option<(usize, u64)> {
        self.outcomes.map(|count| (count as usize, self.seed.unwrap_or(1)))
    }
}

/// Follows the motions and writes their set.
///
/// # Errors
///
/// [`Stop::Fault`] if no motion reaches its end: the first error.
pub fn outcomes(
    mechanism: &InterpretedMechanism,
    state: &State,
    options: &Options,
    until: f64,
    (count, seed): (usize, u64),
    format: Format,
) -> Outcome {
    let Options { relative_tolerance, absolute_tolerance, max_step, breaks, surfaces, laws, .. } = options;
    // The inputs of the tool are functions of time.
    let inputs = match &options.drive {
        Drive::Continuous(function) => Some(function),
        _ => None,
    };
    let case = |row: usize| {
        Ok(Case {
            mechanism,
            time: state.time,
            coordinates: state.coordinates.clone(),
            speeds: state.speeds.clone(),
            inputs: state.inputs.clone(),
            options: Options {
                relative_tolerance: *relative_tolerance,
                absolute_tolerance: *absolute_tolerance,
                max_step: *max_step,
                breaks: breaks.clone(),
                surfaces: surfaces.clone(),
                laws: laws.clone(),
                drive: inputs.cloned().map_or(Drive::Held, Drive::Continuous),
                together: ImpactsAtOnce::Sampled(seed.wrapping_add(row as u64)),
                ..Options::default()
            },
            until,
        })
    };
    let motions = watched(count, |batch| simulate_many(count, case, batch));
    let set = OutcomeSet::of(&motions, options);
    if set.motions == 0
        && let Some(error) = motions.iter().find_map(|motion| motion.error.as_ref())
    {
        return Err(Stop::Fault(format!("no motion of {count} reaches t = {until} s: the first: {error}")));
    }
    let report = Report::new(mechanism, &motions, &set, seed);
    match format {
        // Rows are refused before anything moves.
        Format::Json | Format::Csv => output::json(&report),
        Format::Table => output::text(&report.text(mechanism)),
    }
}

/// Runs a batch with a progress bar on a terminal.
fn watched(count: usize, run: impl FnOnce(&Batch<'_>) -> Vec<Option<Motion>>) -> Vec<Motion> {
    let watch = Watch::new();
    let batch = Batch { watch: Some(&watch), ..Batch::default() };
    let bar = indicatif::ProgressBar::new(count as u64);
    let done = std::sync::atomic::AtomicBool::new(false);
    let motions = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(std::sync::atomic::Ordering::Relaxed) {
                bar.set_position(watch.done() as u64);
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        let motions = run(&batch);
        done.store(true, std::sync::atomic::Ordering::Relaxed);
        motions
    });
    bar.finish_and_clear();
    motions.into_iter().flatten().collect()
}

#[derive(Serialize)]
struct Report<'a> {
    outcomes: usize,
    failed: usize,
    seed: u64,
    different: usize,
    unseen: f64,
    confidence: f64,
    content: f64,
    /// the most frequent ones
    ends: Vec<EndReport<'a>>,
    q: Named<'a, RangeReport>,
    u: Named<'a, RangeReport>,
    /// the kinds of errors, with their numbers
    errors: Named<'a, usize>,
}

#[derive(Serialize)]
struct EndReport<'a> {
    count: usize,
    outcome: &'static str,
    t: f64,
    rest: Option<f64>,
    closed: Vec<&'a str>,
    q: Named<'a, f64>,
    u: Named<'a, f64>,
}

#[derive(Clone, Serialize)]
struct RangeReport {
    least: f64,
    greatest: f64,
}

impl<'a> Report<'a> {
    fn new(mechanism: &'a InterpretedMechanism, motions: &[Motion], set: &OutcomeSet, seed: u64) -> Self {
        let model = mechanism.model();
        let independent = mechanism.count(ComponentKind::Speed);
        let (coordinates, speeds) = (&model.coordinates, &model.speeds[..independent]);
        let contact = |&index: &usize| {
            mechanism.component(ComponentKind::Contact, index).map_or("?", |Component { name, .. }| name)
        };
        let ends = set.ends.iter().take(ENDS).map(|end| {
            let motion = &motions[end.row];
            EndReport {
                count: end.count,
                outcome: motion.kind(),
                t: motion.time,
                rest: motion.rest,
                closed: motion.closed.iter().map(contact).collect(),
                q: named(coordinates, motion.coordinates.iter().copied()),
                u: named(speeds, motion.speeds.iter().copied()),
            }
        });
        let ranges = |names: &'a [hodograph_generator::model::mechanism::Variable], ranges: &[Range]| {
            let reports = ranges.iter().map(|&Range { least, greatest }| RangeReport { least, greatest });
            Named(names.iter().map(|variable| variable.name.as_str()).zip(reports).collect())
        };
        let mut errors: Vec<(&str, usize)> = Vec::new();
        for error in motions.iter().filter_map(|motion| motion.error.as_ref()) {
            let kind = error.kind.name();
            match errors.iter_mut().find(|(name, _)| *name == kind) {
                Some((_, count)) => *count += 1,
                None => errors.push((kind, 1)),
            }
        }
        Report {
            outcomes: motions.len(),
            failed: set.failed,
            seed,
            different: set.ends.len(),
            unseen: set.unseen(),
            confidence: CONFIDENCE,
            content: set.content(CONFIDENCE),
            ends: ends.collect(),
            q: ranges(coordinates, &set.coordinates),
            u: ranges(speeds, &set.speeds),
            errors: Named(errors),
        }
    }

    fn text(&self, mechanism: &InterpretedMechanism) -> String {
        let model = mechanism.model();
        let variables = model.coordinates.iter().chain(&model.speeds);
        let mut table = Table::new(["at the end", "least", "greatest"]);
        for (variable, (_, range)) in variables.zip(self.q.0.iter().chain(&self.u.0)) {
            table.row([
                with_unit(&variable.name, &variable.unit),
                number(range.least),
                number(range.greatest),
            ]);
        }
        let mut out = table.text("");
        let mut ends = Table::new(["motions", "t [s]", "end", "closed contacts"]);
        for end in &self.ends {
            ends.row([
                end.count.to_string(),
                number(end.rest.unwrap_or(end.t)),
                end.outcome.to_owned(),
                end.closed.join(" "),
            ]);
        }
        out += "\n";
        out += &ends.text("");
        if self.different > self.ends.len() {
            out += &format!(".. and {} more ends\n", self.different - self.ends.len());
        }
        out += &format!(
            "\n{} motions, {} different ends; another motion ends as none of these with probability {:.2} (the part of them that ended alone)\n\
             with {:.0} % confidence another motion is within the range of a quantity with probability {:.3} at least\n",
            self.outcomes - self.failed,
            self.different,
            self.unseen,
            100.0 * self.confidence,
            self.content,
        );
        for (kind, count) in &self.errors.0 {
            out += &format!("{count} ended early: {kind}\n");
        }
        out
    }
}
