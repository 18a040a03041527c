//! `hodograph fit`: fits parameters, mu and e to measured motions.

pub mod table_of_motions;

use std::collections::BTreeMap;
use std::path::PathBuf;

use hodograph::{Cause, ComponentKind, Mechanism as _, Surface};
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_gradients::{By, Fit, FitError, FitTask, FittedStart, Loss, fit};
use hodograph_interpreter::InterpretedMechanism;
use serde::Serialize;

use self::table_of_motions::Motions;
use super::motion_arguments::MotionArguments;
use crate::evaluate::report::{Named, named};
use crate::expression;
use crate::json::state::State;
use crate::json::{Failure, Kind};
use crate::state_arguments::once;
use crate::stop::{Outcome, Stop};
use crate::table::{Table, number};

/// Fit parameters, mu and e to measured motions
///
///   hodograph fit throws.csv rod.mech --parameters mu,e,l --mu 0.2 --e 0.5 --law poisson
///
/// The data are a CSV file with a column `t` (s) and columns of coordinates and speeds, named as in the model, as `x` or `x [m]`; a
/// column `trajectory` tells motions apart. The first row of each motion is its start state, which is taken as it is unless
/// --flight is given; what has no column there is that of the model or of --state. The fit begins at the values that the model and the options give.
/// Models with inputs are not fitted yet.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the data
    data: PathBuf,
    /// the model file
    model: PathBuf,
    /// the names of what is fitted: parameters, mu, e, mu.CONTACT, e.CONTACT
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', required = true)]
    parameters: Vec<String>,
    /// the columns that are compared [default: all coordinates and speeds of the data]
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    outputs: Vec<String>,
    /// standard errors of the measurements, by which differences are divided, as x=0.0002,q=0.001 [default:
    /// the standard deviation of the column]
    #[arg(long, value_name = "NAME=NUMBER,..", value_delimiter = ',')]
    error: Vec<String>,
    /// differences beyond so many errors count in proportion to their size, not to its square (Huber), so that motions that
    /// went another way do not decide alone
    #[arg(long, value_name = "ERRORS", conflicts_with = "cap")]
    huber: Option<f64>,
    /// differences beyond so many errors count as much as if they were so large
    #[arg(long, value_name = "ERRORS")]
    cap: Option<f64>,
    /// seconds from the start of each motion in which nothing is struck: its start state is fitted to the samples within them
    /// [default: the first row is taken as it is]
    #[arg(long, value_name = "SECONDS")]
    flight: Option<f64>,
    /// seconds from the start up to which the motions are fitted, one after the other, before all of them: 0.1,0.3
    #[arg(long, value_name = "SECONDS,..", value_delimiter = ',')]
    horizons: Vec<f64>,
    /// number of starts: that of the model and the options, and others at random, from a quarter to four times its values
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    starts: usize,
    /// number of bootstrap samples, two at least: trajectories are drawn with replacement and fitted again, which gives the
    /// spread of the values
    #[arg(long, value_name = "COUNT", default_value_t = 0)]
    bootstrap: usize,
    /// with --starts or --bootstrap: the seed of their draws [default: 1]
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    #[command(flatten)]
    motion: MotionArguments,
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Call`] for mistakes in the data or the options; [`Stop::Fault`] if a motion cannot be simulated.
pub fn run(arguments: &Arguments) -> Outcome {
    let machine = arguments.motion.machine(&arguments.model)?;
    let names: Vec<&str> = arguments.parameters.iter().map(|name| name.trim()).collect();
    arguments.check()?;
    once("--parameters", &names)?;
    once("--outputs", &arguments.outputs.iter().map(|name| name.trim()).collect::<Vec<_>>())?;
    arguments.motion.form.write(
        || {
            let state = arguments.motion.state.state(&machine)?;
            let mechanism = machine.interpreted(&state)?;
            without_inputs(&state)?;
            let by: Result<Vec<By>, String> =
                names.iter().map(|name| By::adjustable(&mechanism, name)).collect();
            let by =
                by.map_err(|message| Failure::new(Kind::UnknownName, format!("--parameters: {message}")))?;
            let start = state.borrowed();
            let options = arguments.motion.options(&mechanism, &start)?;
            let motions = Motions::read(&arguments.data, &mechanism, &start, &arguments.outputs)?;
            let units = arguments.units(&motions, &mechanism)?;
            let task = FitTask {
                trajectories: &motions.trajectories,
                measured: &motions.measured,
                units: &units,
                variables: &by,
                loss: arguments.loss(),
                flight: arguments.flight,
                horizons: &arguments.horizons,
                starts: arguments.starts,
                bootstrap: arguments.bootstrap,
                seed: arguments.seed.unwrap_or(1),
            };
            let found = fit(&mechanism, &options, &task).map_err(stop)?;
            let mut answer = Answer::new(&found, &names, (&mechanism, &by), motions.trajectories.len());
            let outputs = motions.names(&mechanism);
            answer.units = outputs.iter().cloned().zip(units.iter().copied()).collect();
            answer.outputs = outputs;
            answer.outliers = (arguments.loss() != Loss::Square).then_some(found.outliers);
            answer.model = arguments.model.display().to_string();
            answer.options = arguments.motion.given();
            answer.flight = arguments.flight;
            answer.start_states =
                found.starts.iter().map(|found| Start::new(&machine.mechanism, found)).collect();
            answer.motions = motions.trajectories.iter().map(|one| one.name.clone()).collect();
            Ok(answer)
        },
        |answer| answer.tables(&names),
    )
}

/// Refuses a mechanism with inputs.
///
/// # Errors
///
/// `failed_motion`.
pub(crate) fn without_inputs(state: &State) -> Result<(), Failure> {
    if state.inputs.is_empty() {
        return Ok(());
    }
    let message = "motions of mechanisms with inputs are not fitted yet: make the inputs parameters of the model, if they are constant";
    Err(Failure::new(Kind::FailedMotion, message))
}

pub(crate) fn stop(error: FitError) -> Stop {
    match error {
        FitError::BadRequest(message) => Stop::Call(message),
        error @ FitError::NotFinite(_) => Failure::new(Kind::Of(Cause::NotFinite), error.to_string()).into(),
        error => Failure::new(Kind::FailedMotion, error.to_string()).into(),
    }
}

impl Arguments {
    /// Refuses numbers that mean nothing.
    fn check(&self) -> Outcome {
        for (option, size) in [("--huber", self.huber), ("--cap", self.cap)] {
            if let Some(size) = size
                && !(size.is_finite() && size > 0.0)
            {
                return Err(Stop::Call(format!(
                    "{option} {size}: the number of errors must be positive, as in {option} 3"
                )));
            }
        }
        if self.bootstrap == 1 {
            return Err(Stop::Call(
                "--bootstrap 1: one sample has no spread: give two at least, as in --bootstrap 200"
                    .to_owned(),
            ));
        }
        if self.seed.is_some() && self.starts <= 1 && self.bootstrap == 0 {
            return Err(Stop::Call(
                "--seed is of --starts and --bootstrap: give one of them, or leave it out".to_owned(),
            ));
        }
        Ok(())
    }

    /// What a difference costs.
    fn loss(&self) -> Loss {
        self.huber.map(Loss::Huber).or(self.cap.map(Loss::Cap)).unwrap_or_default()
    }

    /// The divisors of the differences of each column.
    fn units(&self, motions: &Motions, mechanism: &InterpretedMechanism) -> Outcome<Vec<f64>> {
        let mut units = motions.deviations();
        let call =
            |text: &str| Stop::Call(format!("--error {text}: give NAME=NUMBER with a positive number"));
        for text in &self.error {
            let (name, value) = text.split_once('=').ok_or_else(|| call(text))?;
            let value = expression::number(value).map_err(|_| call(text))?;
            let place = motions.place(mechanism, name.trim()).ok_or_else(|| {
                Stop::Call(format!("--error {text}: no column `{}` of the data is compared", name.trim()))
            })?;
            if value <= 0.0 {
                return Err(call(text));
            }
            units[place] = value;
        }
        Ok(units)
    }
}

/// The answer of the command.
#[derive(Serialize)]
struct Answer<'a> {
    values: Named<'a, f64>,
    /// null if the data do not determine a value, or leave no difference beyond the values
    errors: Named<'a, f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bootstrap: Option<Named<'a, f64>>,
    correlations: Vec<Vec<f64>>,
    undetermined: Vec<Named<'a, f64>>,
    rms: f64,
    differences: usize,
    /// how many of them cost less than their squares, with `--huber` or `--cap`
    #[serde(skip_serializing_if = "Option::is_none")]
    outliers: Option<usize>,
    trajectories: usize,
    without_derivatives: Vec<String>,
    steps: usize,
    /// options of `simulate` with these values
    arguments: Vec<String>,
    /// what `validate` needs: the model, the options, the columns and their divisors, and the names of the motions
    model: String,
    options: Vec<String>,
    outputs: Vec<String>,
    units: BTreeMap<String, f64>,
    motions: Vec<String>,
    /// with `--starts`: the values and the root mean square at the minimum of each, the least first
    #[serde(skip_serializing_if = "Vec::is_empty")]
    minima: Vec<Minimum<'a>>,
    /// with `--flight`: its seconds, and the start states that were fitted
    #[serde(skip_serializing_if = "Option::is_none")]
    flight: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    start_states: Vec<Start<'a>>,
}

#[derive(Serialize)]
struct Minimum<'a> {
    values: Named<'a, f64>,
    rms: f64,
}

/// A start state that was fitted.
#[derive(Serialize)]
struct Start<'a> {
    trajectory: String,
    q: Named<'a, f64>,
    u: Named<'a, f64>,
    /// standard errors of both; null where the samples do not determine one
    errors: Named<'a, f64>,
    rms: f64,
}

impl<'a> Start<'a> {
    fn new(model: &'a Mechanism, found: &FittedStart) -> Self {
        let (q, u) = found.trajectory.state.split_at(model.coordinates.len());
        let speeds = || model.speeds.iter().filter(|speed| !speed.dependent);
        let names = model.coordinates.iter().map(|one| &one.name).chain(speeds().map(|one| &one.name));
        Start {
            trajectory: found.trajectory.name.clone(),
            q: named(&model.coordinates, q.iter().copied()),
            u: named(speeds(), u.iter().copied()),
            errors: Named(names.map(String::as_str).zip(found.errors.iter().copied()).collect()),
            rms: found.rms,
        }
    }
}

impl<'a> Answer<'a> {
    fn new(
        found: &Fit,
        names: &[&'a str],
        (mechanism, by): (&InterpretedMechanism, &[By]),
        trajectories: usize,
    ) -> Self {
        let named = |values: &[f64]| Named(names.iter().copied().zip(values.iter().copied()).collect());
        let mut arguments = Vec::new();
        for ((variable, name), value) in by.iter().zip(names).zip(&found.values) {
            if matches!(variable, By::Parameter(_)) {
                arguments.extend(["--parameter".to_owned(), format!("{name}={value}")]);
            }
        }
        for (contact, Surface { mu, e, law }) in &found.surfaces {
            let name =
                mechanism.component(ComponentKind::Contact, *contact).map_or("?", |contact| contact.name);
            arguments.extend(["--surface".to_owned(), format!("{name}={mu},{e},{law}")]);
        }
        Answer {
            values: named(&found.values),
            errors: named(&found.errors),
            bootstrap: found.spread.as_deref().map(named),
            correlations: found.correlations.row_iter().map(|row| row.iter().copied().collect()).collect(),
            undetermined: found.undetermined.iter().map(|direction| named(direction)).collect(),
            rms: found.rms,
            differences: found.differences,
            outliers: None,
            trajectories,
            without_derivatives: found.without_derivatives.clone(),
            steps: found.steps,
            arguments,
            model: String::new(),
            options: Vec::new(),
            outputs: Vec::new(),
            units: BTreeMap::new(),
            motions: Vec::new(),
            minima: match &found.minima[..] {
                [_] => Vec::new(),
                all => all.iter().map(|(values, rms)| Minimum { values: named(values), rms: *rms }).collect(),
            },
            flight: None,
            start_states: Vec::new(),
        }
    }

    fn tables(&self, names: &[&str]) -> String {
        let mut heads = vec!["", "value", "error"];
        heads.extend(self.bootstrap.as_ref().map(|_| "bootstrap"));
        let mut table = Table::new(heads.into_iter().chain(names.iter().copied()));
        for (row, name) in names.iter().enumerate() {
            let error = self.errors.0[row].1;
            let error = if error.is_finite() { number(error) } else { "-".to_owned() };
            let mut cells = vec![(*name).to_owned(), number(self.values.0[row].1), error];
            cells.extend(self.bootstrap.as_ref().map(|spread| number(spread.0[row].1)));
            cells.extend(self.correlations[row].iter().map(|value| format!("{value:.3}")));
            table.row(cells);
        }
        let mut out = format!("\nvalues, their errors and correlations\n{}", table.text("  "));
        for direction in &self.undetermined {
            let parts = direction.0.iter().filter(|(_, part)| part.abs() > 1e-6);
            let parts: Vec<String> = parts.map(|(name, part)| format!("{part:+.3} {name}")).collect();
            out += &format!("\nnot determined by the data, in parts of the values: {}\n", parts.join(" "));
        }
        out += &format!(
            "\nrms {} of {} differences in {} motions, after {} steps\n",
            number(self.rms),
            self.differences,
            self.trajectories,
            self.steps
        );
        if !self.minima.is_empty() {
            let all: Vec<String> = self.minima.iter().map(|minimum| number(minimum.rms)).collect();
            out += &format!("minima of all starts: {}\n", all.join(" "));
        }
        if let Some(outliers) = self.outliers {
            out += &format!("{outliers} of the differences cost less than their squares\n");
        }
        if !self.without_derivatives.is_empty() {
            let names = self.without_derivatives.join(", ");
            out += &format!("not differentiable, fitted by differences: {names}\n");
        }
        out += &format!("simulate with: {}\n", self.arguments.join(" "));
        out
    }
}
