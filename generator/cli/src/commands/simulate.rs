//! `hodograph simulate`: simulates motion with collisions and lasting contact.

mod figure;
mod inputs;
mod lines;
mod outcomes;
mod pictures;
mod summary;
pub mod surfaces;

use std::io::IsTerminal;
use std::path::PathBuf;

use hodograph::{ComponentKind, Mechanism as _};
use hodograph_animation::{Setup, Span, Watch};
use hodograph_generator::files;
use hodograph_generator::format::plain;
use hodograph_interpreter::{InterpretedMechanism, motion};
use hodograph_simulation::{Event, ImpactsAtOnce, Options, Simulation, SimulationError};

use self::lines::{Format, Lines};
use self::outcomes::OutcomesArguments;
use self::pictures::{PictureFiles, Pictures};
use self::surfaces::MotionSurfaces;
use crate::answers::is_terminal;
use crate::derivation::{self, Limits};
use crate::json::state::State;
use crate::model;
use crate::output;
use crate::state_arguments::StateArguments;
use crate::stop::{Outcome, Stop};

/// Simulate a model from a state: motion, collisions and contact that lasts
///
///   hodograph simulate pendulum.mech --html pendulum.html
///   hodograph simulate models/free_box_corner.mech --until 1 --mu 0.3 --e 0.5 --law stronge --html box.html
///
/// At a terminal the answer is a set of tables and a summary, else JSON lines: {"t":..,"q":{..},"u":{..}} at each step, and {"t":..,"event":"collision","contact":..}
/// and so on at each event: collision, struck_together, impact_without_collision, contact, lift_off,
/// slip, stick, roll, roll_ends, spin, spin_ends, rest; singular where the motion ends since the point of a contact is undefined there. Times of events do not depend on --step.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    #[command(flatten)]
    state: StateArguments,
    /// when to end, s [default: 10 s after the start, or when all is at rest]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    until: Option<f64>,
    /// time between two output lines, s
    #[arg(long, value_name = "SECONDS", default_value_t = motion::STEP, allow_hyphen_values = true)]
    step: f64,
    /// relative and absolute tolerance of the integration, at least 1e-16; bounces lower than it, in
    /// metres, end in contact [default: 1e-12]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// greatest step of the integration, s: by default 0.05 if something depends on time explicitly, else
    /// unbounded; it must be shorter than the changes of the inputs
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    max_step: Option<f64>,
    #[command(flatten)]
    surfaces: MotionSurfaces,
    /// an input as a function of the time `t`, as `F = 2*sin(3*t)`; may be given several times
    #[arg(long, value_name = "NAME=EXPRESSION")]
    input: Vec<String>,
    /// a CSV file with a column `t` and a column for each input, between whose rows inputs are
    /// interpolated
    #[arg(long, value_name = "FILE")]
    inputs: Option<PathBuf>,
    /// how to treat several contacts that are struck at the same time
    #[arg(long, value_name = "WAY", default_value = "approaching")]
    together: TogetherArgument,
    /// compare the outcomes of all orders of up to four contacts struck at one time (`spread`, J)
    #[arg(long)]
    spread: bool,
    /// with --together lzb: the stiffness of a contact, as `left=2`; only ratios matter, and the default is 1
    #[arg(long, value_name = "CONTACT=NUMBER")]
    stiffness: Vec<String>,
    #[command(flatten)]
    outcomes: OutcomesArguments,
    /// the format of states and events [default: tables at a terminal, else JSON]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    #[command(flatten)]
    pictures: PictureFiles,
    #[command(flatten)]
    limits: Limits,
}

/// The ways to treat contacts that are struck at the same time.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum TogetherArgument {
    /// all contacts that approach are struck at once, by Poisson's hypothesis if all have the law poisson,
    /// else by Moreau's law, with friction; contacts that this presses together are struck next
    Approaching,
    /// one after the other, the fastest first
    Sequential,
    /// all closed contacts are struck at once, by the same laws
    Simultaneous,
    /// all closed contacts at once, after Liu, Zhao and Brogliato, with the ratios of --stiffness; without
    /// friction only
    Lzb,
    /// an error
    Stop,
}

/// Runs the command. Errors are reported on standard error; standard output holds the motion only.
///
/// # Errors
///
/// [`Stop::Call`] for mistakes in the options; [`Stop::Fault`] for mistakes in the state or a surface, and if
/// the motion fails: its beginning is written.
pub fn run(arguments: &Arguments) -> Outcome {
    simulated(arguments).map_err(Stop::on_standard_error)
}

fn simulated(arguments: &Arguments) -> Outcome {
    let step = arguments.step;
    let positive = |number: f64| number.is_finite() && number > 0.0;
    let max_step = arguments.max_step.is_none_or(positive);
    if !(arguments.until.is_none_or(f64::is_finite) && positive(step) && max_step) {
        return Err(Stop::Call(
            "--step and --max-step must be positive and finite, and --until finite".to_owned(),
        ));
    }
    arguments.outcomes.check(arguments.format)?;
    let tolerance = arguments.tolerance.unwrap_or(Options::default().relative_tolerance);
    Options::check_tolerance(tolerance).map_err(|error| Stop::Call(format!("--tolerance: {error}")))?;
    let mut read = model::files_of(&arguments.model);
    read.extend(arguments.state.files());
    read.extend(arguments.inputs.clone());
    arguments.pictures.check(&read)?;
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let state = arguments.state.state(&machine)?;
    let until = arguments.until.unwrap_or(state.time + DEFAULT_DURATION);
    if let Some(longest) = arguments.max_step
        && (until - state.time) / longest > MOST_STEPS
    {
        let steps = (until - state.time) / longest;
        return Err(Stop::Call(format!(
            "--max-step {longest:e} is too short: {steps:.1e} steps; give a longer one"
        )));
    }
    if until < state.time {
        return Err(Stop::Call(format!(
            "--until is {until}, before the start at t = {}: give a later time",
            state.time
        )));
    }
    let mechanism = machine.interpreted(&state)?;
    arguments.pictures.check_times(state.time, until)?;
    let format = arguments.format.unwrap_or(if is_terminal() { Format::Table } else { Format::Json });
    check_size(&mechanism, until - state.time, step, arguments.pictures.wanted(), format)?;
    let surfaces::Found { surfaces, laws } = arguments.surfaces.of(&mechanism, &state.borrowed())?;
    let stiffness = surfaces::stiffnesses(&arguments.stiffness, &mechanism)?;
    if !stiffness.is_empty() && !matches!(arguments.together, TogetherArgument::Lzb) {
        return Err(Stop::Call(
            "--stiffness is of --together lzb alone: give that, or leave it out".to_owned(),
        ));
    }
    if arguments.until.is_none() {
        output::say(format_args!(
            "note: until t = {until} s or until all is at rest: --until says otherwise"
        ));
    }
    let driven = inputs::drive(&machine.mechanism, &arguments.input, arguments.inputs.as_deref())?;
    let greatest = mechanism.greatest_step(driven.is_some());
    // a mechanism driven in time or by inputs does not stay at rest
    let at_rest = arguments.until.is_none() && greatest.is_infinite();
    let (drive, breaks) = driven.map_or_else(Default::default, |driven| (driven.drive, driven.breaks));
    let options = Options {
        relative_tolerance: tolerance,
        absolute_tolerance: tolerance,
        max_step: arguments.max_step.unwrap_or(greatest),
        surfaces,
        laws,
        drive,
        breaks,
        together: match arguments.together {
            TogetherArgument::Approaching => ImpactsAtOnce::Approaching,
            TogetherArgument::Sequential => ImpactsAtOnce::Sequential,
            TogetherArgument::Simultaneous => ImpactsAtOnce::Simultaneous,
            TogetherArgument::Lzb => ImpactsAtOnce::Lzb,
            TogetherArgument::Stop => ImpactsAtOnce::Stop,
        },
        stiffness,
        compare_orders: arguments.spread,
        ..Options::default()
    };
    if let Some(asked) = arguments.outcomes.asked() {
        if arguments.pictures.wanted() {
            return Err(Stop::Call(
                "--outcomes writes no pictures: leave --html, --plot and --mcap out".to_owned(),
            ));
        }
        return outcomes::outcomes(&mechanism, &state, &options, until, asked, format);
    }
    let mut lines = Lines::new(&mechanism, format, arguments.pictures.wanted())?;
    let text = || plain(&files::model(&arguments.model));
    let setup = || Setup::of(&machine.mechanism, &state.to_numeric(), &options.surfaces, text());
    let mut pictures = Pictures::new(&arguments.pictures, &mechanism, &state, setup);
    let progress = bar(state.time, until, format);
    let span = Span { start: state.time, until, step, at_rest };
    let done = follow(&mechanism, &state, options, &span, &mut lines, &mut pictures, &progress);
    progress.finish_and_clear();
    // The motion up to an error is written, too: it may show the cause.
    let told = lines.finish();
    pictures.save(&arguments.pictures, done.and(told))
}

/// Motions with more steps than this, by `--max-step`, would take days.
const MOST_STEPS: f64 = 1e10;
/// Largest number of steps: above it, adding 1 does not change a double.
const MAX_STEPS: f64 = 9_007_199_254_740_992.0;
/// Largest number of values that are stored until the end of a motion: some 200 MB of text.
const MAX_NUMBERS: f64 = 2e7;
/// Bytes of a number in a page or a figure.
const BYTES: f64 = 10.0;
/// The duration of a motion by default, s.
const DEFAULT_DURATION: f64 = 10.0;
/// Refuses step lengths that give more steps than can be counted, or so many that the stored pictures and
/// tables would be too large to open.
fn check_size(
    mechanism: &InterpretedMechanism,
    span: f64,
    step: f64,
    pictures: bool,
    format: Format,
) -> Outcome {
    let steps = (span / step).ceil() + 1.0;
    if steps > MAX_STEPS {
        return Err(Stop::Call(format!(
            "--step {step:e} is too short: {steps:.1e} steps; give a longer one"
        )));
    }
    let table = if format == Format::Table { 1 + mechanism.count(ComponentKind::Coordinate) } else { 0 };
    let each = if pictures { hodograph_animation::numbers(mechanism, mechanism.model()) } else { table };
    let numbers = steps * each as f64;
    if numbers <= MAX_NUMBERS {
        return Ok(());
    }
    let least = span / (MAX_NUMBERS / each as f64 - 2.0).max(1.0);
    // rounded up to two digits
    let unit = 10_f64.powf(least.log10().floor() - 1.0);
    let without = if pictures { "leave --html, --plot and --mcap out" } else { "take --format csv" };
    Err(Stop::Call(format!(
        "--step {step:e} over {span} s is {steps:.1e} steps of {each} numbers, some {:.1e} MB of text: give --step {:.1e} or more, or an \
         earlier --until, or {without}",
        numbers * BYTES * 1e-6,
        (least / unit).ceil() * unit
    )))
}

/// Simulates the motion and writes it.
fn follow(
    mechanism: &InterpretedMechanism,
    state: &State,
    options: Options,
    span: &Span,
    lines: &mut Lines<'_>,
    pictures: &mut Pictures<'_>,
    progress: &indicatif::ProgressBar,
) -> Outcome {
    let mut simulation = Simulation::new(mechanism, &state.borrowed(), options).map_err(fault)?;
    lines.sample(state.time, &state.coordinates, &state.speeds)?;
    lines.energy(simulation.energy().map_err(fault)?);
    pictures.add(&simulation);
    hodograph_animation::follow(&mut simulation, span, &mut Writer { lines, pictures, progress, span })?;
    lines.energy(simulation.energy().map_err(fault)?);
    Ok(())
}

/// Writes samples and events.
struct Writer<'w, 'l, 'p> {
    lines: &'w mut Lines<'l>,
    pictures: &'w mut Pictures<'p>,
    progress: &'w indicatif::ProgressBar,
    span: &'w Span,
}

impl Writer<'_, '_, '_> {
    fn show(&self, t: f64) {
        self.progress.set_position(((t - self.span.start) * 1e3) as u64);
        self.progress.set_message(format!("t = {t:.3} s"));
    }
}

impl Watch<Stop> for Writer<'_, '_, '_> {
    fn sample(&mut self, simulation: &Simulation<'_>) -> Outcome {
        let time = simulation.time();
        if time > self.span.start {
            self.lines.sample(time, simulation.coordinates(), simulation.speeds())?;
        }
        self.pictures.add(simulation);
        self.show(time);
        Ok(())
    }

    fn event(&mut self, event: &Event, simulation: &Simulation<'_>) -> Outcome {
        self.lines.event(event, simulation.inputs())?;
        self.pictures.event(event, simulation);
        self.show(event.time);
        Ok(())
    }
}

impl From<SimulationError> for Stop {
    fn from(error: SimulationError) -> Self {
        fault(error)
    }
}

/// A progress bar. It is hidden if standard error is not a terminal, or if lines are written to a terminal.
fn bar(start: f64, until: f64, format: Format) -> indicatif::ProgressBar {
    if (is_terminal() && format != Format::Table) || !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = indicatif::ProgressStyle::with_template("{wide_bar} {msg} of {prefix} s");
    let bar = indicatif::ProgressBar::new(((until - start) * 1e3) as u64).with_prefix(until.to_string());
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

fn fault(error: SimulationError) -> Stop {
    Stop::Fault(error.to_string())
}
