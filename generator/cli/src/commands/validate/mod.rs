//! `hodograph validate`: how well fitted values predict measured motions.

mod page;
mod report;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Parser;
use hodograph::{ComponentKind, Mechanism as _};
use hodograph_generator::files;
use hodograph_gradients::statistics::quantile;
use hodograph_gradients::validation::{Measure, Noise, floor, noise_replicate, predict};
use hodograph_gradients::{By, Trajectory, with_values};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use nalgebra::DMatrix;
use serde::Deserialize;

use self::page::Course;
use self::report::{Convergence, Motion, Paired, Report, Share, Summary};
use super::fit::table_of_motions::Motions;
use super::motion_arguments::MotionArguments;
use crate::answers::FormArgument;
use crate::expression;
use crate::model;
use crate::output;
use crate::stop::{Outcome, Stop};

/// Judge fitted values on measured motions
///
///   hodograph fit some.csv rod.mech --parameters mu,e --mu 0.2 --e 0.5 --law poisson --format json > fit.json
///   hodograph validate fit.json others.csv --html others.html
///
/// Predicts each motion of the data from its start, as the fit took it, with the values, outputs and errors of the fit, and tells how far the
/// predictions are from the measurements: quantiles of the errors, and what they are beside another prediction (--against), beside
/// measurement noise alone (--noise), and beside the best values of each motion (--floor).
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the answer of `hodograph fit`, as JSON
    fit: PathBuf,
    /// the data, as `fit` takes them; they should not be those of the fit
    data: PathBuf,
    /// the model file [default: that of the fit]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// another prediction of the same motions at the same times, in the form of the data
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// an end is right where these quantities are not farther from the measurement than this, as x=0.02,q=0.5
    #[arg(long, value_name = "NAME=NUMBER,..", value_delimiter = ',')]
    within: Vec<String>,
    /// standard errors of the measurements, as x=0.0002,q=0.001: tells the errors that they alone would make
    #[arg(long, value_name = "NAME=NUMBER,..", value_delimiter = ',')]
    noise: Vec<String>,
    /// with --noise: its seed [default: 1]
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// fit the values to each motion by itself: tells the errors that no common values can fall below
    #[arg(long)]
    floor: bool,
    /// write the predictions to this file, in the form of the data
    #[arg(long, value_name = "FILE")]
    predictions: Option<PathBuf>,
    /// write a page with pictures
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    #[command(flatten)]
    form: FormArgument,
}

/// What is read of the answer of `fit`.
#[derive(Deserialize)]
struct Fitted {
    model: String,
    values: BTreeMap<String, f64>,
    units: BTreeMap<String, f64>,
    outputs: Vec<String>,
    options: Vec<String>,
    motions: Vec<String>,
    #[serde(default)]
    flight: Option<f64>,
}

/// The options that `fit` had.
#[derive(clap::Parser)]
#[command(no_binary_name = true)]
struct Given {
    #[command(flatten)]
    motion: MotionArguments,
}

/// Tolerances at which the errors are computed once more, in parts of that of the fit.
const COARSER: [f64; 2] = [1e2, 1e4];

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Call`] for mistakes in the files or the options.
pub fn run(arguments: &Arguments) -> Outcome {
    if arguments.seed.is_some() && arguments.noise.is_empty() {
        return Err(Stop::Call("--seed is of --noise alone: give that, or leave it out".to_owned()));
    }
    let mut courses = Vec::new();
    let made = report(arguments, &mut courses);
    if let (Ok(report), Some(path)) = (&made, &arguments.html) {
        output::file(path, page::page(report, &courses).as_bytes())?;
    }
    arguments.form.write(|| made, Report::tables)
}

/// Refuses to overwrite a file that is read: those of the call, and those that the fit names.
fn check_output(arguments: &Arguments, model: &Path, given: &Given) -> Outcome {
    let written = [&arguments.html, &arguments.predictions].into_iter().flatten();
    let written: Vec<&Path> = written.map(PathBuf::as_path).collect();
    let mut read = vec![arguments.fit.clone(), arguments.data.clone()];
    read.extend(arguments.against.clone());
    read.extend(model::files_of(model));
    read.extend(given.motion.state.files());
    output::check_distinct(&written, &read)
}

/// The motions and what predicts them.
struct Task<'a> {
    mechanism: InterpretedMechanism,
    options: Options,
    measure: Measure<'a>,
    trajectories: &'a [Trajectory],
}

impl Task<'_> {
    fn name(&self, column: usize) -> &str {
        let index = self.measure.measured[column];
        let count = self.mechanism.count(ComponentKind::Coordinate);
        let component = match index.checked_sub(count) {
            Some(speed) => self.mechanism.component(ComponentKind::Speed, speed),
            None => self.mechanism.component(ComponentKind::Coordinate, index),
        };
        component.map_or("?", |component| component.name)
    }

    /// The error of each motion with another tolerance; NaN where there is none.
    fn errors_with(&self, tolerance: f64) -> Vec<f64> {
        let mut options = self.options.clone();
        (options.relative_tolerance, options.absolute_tolerance) = (tolerance, tolerance);
        let error = |one: &Trajectory| match predict(&self.mechanism, &options, self.measure, one) {
            Ok(predicted) => self.measure.error(&one.samples, &predicted),
            Err(_) => f64::NAN,
        };
        self.trajectories.iter().map(error).collect()
    }
}

/// The largest answer of a fit, in bytes.
const MAX_BYTES: usize = 1 << 26;

fn report(arguments: &Arguments, courses: &mut Vec<Course>) -> Outcome<Report> {
    let call = |path: &Path, what: String| Stop::Call(format!("{}: {what}", path.display()));
    let text =
        files::text(&arguments.fit, MAX_BYTES).map_err(|error| Stop::unreadable(&arguments.fit, &error))?;
    let fitted: Fitted = serde_json::from_str(&text).map_err(|error| {
        call(&arguments.fit, format!("is no answer of `hodograph fit --format json`: {error}"))
    })?;
    let given = Given::try_parse_from(&fitted.options)
        .map_err(|error| call(&arguments.fit, format!("its options cannot be read: {error}")))?;
    let path = arguments.model.clone().unwrap_or_else(|| PathBuf::from(&fitted.model));
    check_output(arguments, &path, &given)?;
    let machine = given.motion.machine(&path)?;
    let state = given.motion.state.state(&machine)?;
    super::fit::without_inputs(&state)?;
    let mechanism = machine.interpreted(&state)?;
    let start = state.borrowed();
    let options = given.motion.options(&mechanism, &start)?;
    let by: Result<Vec<By>, String> =
        fitted.values.keys().map(|name| By::adjustable(&mechanism, name)).collect();
    let by = by.map_err(|why| call(&arguments.fit, why))?;
    let values: Vec<f64> = fitted.values.values().copied().collect();
    let (mechanism, options) =
        with_values(&mechanism, &options, &by, &values).map_err(|why| call(&arguments.fit, why))?;
    let mut motions = Motions::read(&arguments.data, &mechanism, &start, &fitted.outputs)?;
    let mut units = vec![1.0; motions.measured.len()];
    for (name, unit) in &fitted.units {
        if !(unit.is_finite() && *unit > 0.0) {
            let what = format!("the unit of {name} is {unit}, and must be positive: make the fit again");
            return Err(call(&arguments.fit, what));
        }
        if let Some(place) = motions.place(&mechanism, name) {
            units[place] = *unit;
        }
    }
    if let Some(flight) = fitted.flight {
        motions.fit_starts(&mechanism, &options, &units, flight).map_err(super::fit::stop)?;
    }
    let within = numbers(&arguments.within, "--within", &motions, &mechanism)?;
    let noise = numbers(&arguments.noise, "--noise", &motions, &mechanism)?;
    let measure = Measure { measured: &motions.measured, units: &units };
    let task = Task { mechanism, options, measure, trajectories: &motions.trajectories };
    let others = match &arguments.against {
        None => None,
        Some(path) => {
            let read = Motions::read(path, &task.mechanism, &start, &fitted.outputs)?;
            Some(matched(path, task.trajectories, read.trajectories)?)
        }
    };
    let mut random = Noise::new(arguments.seed.unwrap_or(1));
    let mut list = Vec::new();
    let mut predictions = Vec::new();
    for (place, trajectory) in task.trajectories.iter().enumerate() {
        let mut motion = Motion {
            name: trajectory.name.clone(),
            at_rest: measure.error(&trajectory.samples, &measure.at_rest(trajectory)),
            ..Motion::default()
        };
        let predicted = predict(&task.mechanism, &task.options, measure, trajectory);
        match &predicted {
            Ok(predicted) => match measure.error(&trajectory.samples, predicted) {
                error if error.is_infinite() => {
                    motion.failed = Some("its error is out of the range of doubles".to_owned());
                }
                error => motion.error = Some(error),
            },
            Err(error) => motion.failed = Some(error.to_string()),
        }
        if !within.is_empty() {
            let near = predicted.as_ref().map(|predicted| is_near(trajectory, predicted, &within));
            // what is not predicted is not right
            motion.right = Some(near.unwrap_or(false));
        }
        if let Some(others) = &others {
            let error = measure.error(&trajectory.samples, &others[place].samples);
            motion.against = Some(error).filter(|error| error.is_finite());
            motion.against_right =
                (!within.is_empty()).then(|| is_near(trajectory, &others[place].samples, &within));
        }
        if !noise.is_empty() {
            let mut errors = vec![0.0; motions.measured.len()];
            noise.iter().for_each(|(column, error)| errors[*column] = *error);
            motion.noise =
                noise_replicate(&task.mechanism, &task.options, measure, (trajectory, &errors), &mut random)
                    .ok();
        }
        if arguments.floor {
            motion.floor = floor(&task.mechanism, &task.options, measure, &by, trajectory).ok();
        }
        list.push(motion);
        predictions.push(predicted.ok());
    }
    if let Some(path) = &arguments.predictions {
        output::file(path, table(&task, &predictions).as_bytes())?;
    }
    if arguments.html.is_some() {
        *courses = chosen(&task, &list, &predictions, others.as_deref());
    }
    let fitted_on: Vec<String> =
        list.iter().map(|one| one.name.clone()).filter(|name| fitted.motions.contains(name)).collect();
    Ok(Report {
        model: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        data: arguments.data.display().to_string(),
        values: fitted.values,
        units: (0..units.len()).map(|column| (task.name(column).to_owned(), units[column])).collect(),
        fitted_on,
        error: Summary::of(list.iter().filter_map(|one| one.error)),
        at_rest: Summary::of(list.iter().map(|one| one.at_rest)),
        right: Share::of(list.iter().filter_map(|one| one.right)),
        against: Summary::of(list.iter().filter_map(|one| one.against)),
        against_right: Share::of(list.iter().filter_map(|one| one.against_right)),
        difference: Paired::of(&list),
        noise: Summary::of(list.iter().filter_map(|one| one.noise)),
        floor: Summary::of(list.iter().filter_map(|one| one.floor)),
        convergence: convergence(&task, &list),
        trajectories: list,
    })
}

/// Numbers by the columns that they are for.
fn numbers(
    list: &[String],
    option: &str,
    motions: &Motions,
    mechanism: &InterpretedMechanism,
) -> Outcome<Vec<(usize, f64)>> {
    let call = |text: &str| Stop::Call(format!("{option} {text}: give NAME=NUMBER with a positive number"));
    let mut out = Vec::new();
    for text in list {
        let (name, value) = text.split_once('=').ok_or_else(|| call(text))?;
        let value = expression::number(value).ok().filter(|value| *value > 0.0).ok_or_else(|| call(text))?;
        let place = motions.place(mechanism, name.trim()).ok_or_else(|| {
            Stop::Call(format!("{option} {text}: no column `{}` of the data is compared", name.trim()))
        })?;
        out.push((place, value));
    }
    Ok(out)
}

/// Another prediction, in the order of the motions: it must have their times.
fn matched(path: &Path, motions: &[Trajectory], others: Vec<Trajectory>) -> Outcome<Vec<Trajectory>> {
    let mut by_name: BTreeMap<String, Trajectory> =
        others.into_iter().map(|other| (other.name.clone(), other)).collect();
    let mut out = Vec::new();
    for motion in motions {
        let wrong = |what: &str| Stop::Call(format!("{}: trajectory {} {what}", path.display(), motion.name));
        let other = by_name.remove(&motion.name).ok_or_else(|| wrong("is missing"))?;
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * a.abs().max(1.0);
        if other.times.len() != motion.times.len() || !other.times.iter().zip(&motion.times).all(near) {
            return Err(wrong("has other times than the data"));
        }
        out.push(other);
    }
    Ok(out)
}

/// Whether the last measured value of each of these quantities is as near as the number says.
fn is_near(trajectory: &Trajectory, predicted: &DMatrix<f64>, within: &[(usize, f64)]) -> bool {
    within.iter().all(|(column, most)| {
        let last = (0..predicted.nrows()).rev().find(|row| !trajectory.samples[(*row, *column)].is_nan());
        last.is_none_or(|row| (predicted[(row, *column)] - trajectory.samples[(row, *column)]).abs() <= *most)
    })
}

fn convergence(task: &Task<'_>, list: &[Motion]) -> Vec<Convergence> {
    let mut out = Vec::new();
    for tolerance in COARSER.map(|factor| factor * task.options.relative_tolerance) {
        let changes = task.errors_with(tolerance).into_iter().zip(list);
        let changes =
            changes.filter_map(|(error, one)| Some(((error - one.error?).abs(), one.name.as_str())));
        let changes: Vec<(f64, &str)> = changes.filter(|(change, _)| change.is_finite()).collect();
        let Some((greatest, name)) = changes.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let all: Vec<f64> = changes.iter().map(|(change, _)| *change).collect();
        out.push(Convergence {
            tolerance,
            median_change: quantile(&all, 0.5),
            greatest_change: *greatest,
            trajectory: (*name).to_owned(),
        });
    }
    out
}

/// The predictions as a table in the form of the data: the first row of each motion is its start.
fn table(task: &Task<'_>, predictions: &[Option<DMatrix<f64>>]) -> String {
    let names: Vec<&str> = (0..task.measure.measured.len()).map(|column| task.name(column)).collect();
    let mut out = format!("trajectory,t,{}\n", names.join(","));
    let mut row = |name: &str, time: f64, numbers: Vec<f64>| {
        let cell = |number: &f64| if number.is_nan() { String::new() } else { number.to_string() };
        let cells: Vec<String> = numbers.iter().map(cell).collect();
        let quoted = if name.contains([',', '"', '\n']) {
            format!("\"{}\"", name.replace('"', "\"\""))
        } else {
            name.to_owned()
        };
        out += &format!("{quoted},{time},{}\n", cells.join(","));
    };
    for (trajectory, predicted) in task.trajectories.iter().zip(predictions) {
        let start = task.measure.measured.iter().map(|index| trajectory.state[*index]).collect();
        row(&trajectory.name, trajectory.start, start);
        for (i, time) in trajectory.times.iter().enumerate() {
            let numbers = match predicted {
                Some(predicted) => predicted.row(i).iter().copied().collect(),
                None => vec![f64::NAN; task.measure.measured.len()],
            };
            row(&trajectory.name, *time, numbers);
        }
    }
    out
}

/// The motions that the page shows: those with the median, the upper quartile and the greatest error, at most three
/// quantities of each.
fn chosen(
    task: &Task<'_>,
    list: &[Motion],
    predictions: &[Option<DMatrix<f64>>],
    others: Option<&[Trajectory]>,
) -> Vec<Course> {
    let mut order: Vec<usize> =
        (0..list.len()).filter(|i| list[*i].error.is_some_and(f64::is_finite)).collect();
    order.sort_by(|a, b| list[*a].error.unwrap_or(0.0).total_cmp(&list[*b].error.unwrap_or(0.0)));
    let Some(last) = order.len().checked_sub(1) else { return Vec::new() };
    let mut places =
        vec![(last / 2, "median error"), (3 * last / 4, "upper quartile"), (last, "greatest error")];
    places.dedup_by_key(|(place, _)| *place);
    let mut courses = Vec::new();
    for (place, what) in places {
        let motion = order[place];
        let (trajectory, Some(predicted)) = (&task.trajectories[motion], &predictions[motion]) else {
            continue;
        };
        for column in 0..task.measure.measured.len().min(3) {
            let column_of =
                |samples: &DMatrix<f64>| samples.column(column).iter().copied().collect::<Vec<f64>>();
            courses.push(Course {
                title: format!("{} of {} ({what})", task.name(column), trajectory.name),
                times: trajectory.times.clone(),
                measured: column_of(&trajectory.samples),
                predicted: column_of(predicted),
                other: others.map(|others| column_of(&others[motion].samples)),
            });
        }
    }
    courses
}
