//! `hodograph solve`: solves collisions given as JSON lines, and writes their outcomes as JSON
//! lines.

use std::io::{self, IsTerminal};

use clap::ValueEnum;
use hodograph::methods::{self, Integration, Partial, Solution, Summation, Switch};
use hodograph::{Hodograph, Law, ReducedMatrix, Surface, snapshot_at};
use nalgebra::Vector3;

use crate::json::answer::{Answer, At};
use crate::json::characteristics::{Characteristics, CharacteristicsArgument, Form};
use crate::json::{Failure, Fields, Json, lines::read_line};
use crate::output;
use crate::stop::{Outcome, Stop};
use crate::surface;

/// The longest line, in bytes.
const MAX_LINE: usize = 1 << 20;

/// Solve collisions: one JSON object per line from standard input, one answer per line
///
/// A line gives the reduced mass matrix, the velocity of approach and the surfaces:
///
///   {"m":[nn,nt,ns,tt,ts,ss],"v":[n,t,s],"mu":0.6,"e":0.8,"law":"stronge"}
///
/// Its answer is
/// {"impulse":[n,t,s],"v":[n,t,s],"dE":..,"dEn":..,"path":[..],"compressions":1,"sensitivity":[]}
/// or {"error":{"kind":"..","message":".."}}. Blank lines are skipped, other fields are left alone.
/// Exit 0 if every line was solved, 1 if one had an error.
// the brackets are JSON, as the help shows it
#[allow(rustdoc::broken_intra_doc_links)]
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// how to solve; all but `exact` are for comparison
    #[arg(long, value_enum, default_value_t = Method::Exact)]
    pub method: Method,
    /// `sum`, `irs`: number of steps per unit of impulse, the paper's refinement k [default: 50]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub steps: Option<u32>,
    /// `sum`, `irs`: the unit of impulse, N s; the paper has 1 [default: -v_n1 / (4 m_nn)]
    #[arg(long, value_name = "N s", value_parser = positive, conflicts_with = "tolerance")]
    pub unit: Option<f64>,
    /// `integrate`, and `irs` instead of steps: relative error per step, 1e-14 to 0.1 [default: 1e-10]
    #[arg(long, value_parser = tolerance, conflicts_with = "steps")]
    pub tolerance: Option<f64>,
    /// `integrate`, and `irs` with --tolerance: the paper's epsilon_s, the speed of slip below which slip is
    /// set to zero, m/s [default: slip is followed to its end]
    #[arg(long, value_name = "m/s", value_parser = positive)]
    pub threshold: Option<f64>,
    /// `exact`: also the state at these normal impulses, N s, from 0 on; they may be beyond the end of the collision
    #[arg(long, value_name = "N s,..", value_delimiter = ',', allow_hyphen_values = true, value_parser = not_negative)]
    pub at: Vec<f64>,
    #[command(flatten)]
    pub characteristics: CharacteristicsArgument,
    /// `exact`: the largest number of quadratures for a collision; one that needs more has the error
    /// `budget_exceeded` [default: no limit but the solver's own]
    #[arg(long, value_name = "QUADRATURES")]
    pub budget: Option<u32>,
}

/// The methods of solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// the exact solver
    Exact,
    /// numerical integration (55)
    Integrate,
    /// recursive summation (56)
    Sum,
    /// summation or, with --tolerance, integration of the sliding part, and (57)-(62) after it
    Irs,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (1e-14..=0.1).contains(&value) => Ok(value),
        _ => Err("it must be a number from 1e-14 to 0.1".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("it must be a number greater than 0".to_owned()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("it must be a finite number that is not negative: a collision begins with the impulse 0"
            .to_owned()),
    }
}

impl Arguments {
    /// Reports an option that the method does not have.
    fn check(&self) -> Outcome {
        let misfit = match self.method {
            Method::Integrate | Method::Sum | Method::Irs if self.budget.is_some() => "--budget",
            Method::Exact if self.steps.is_some() => "--steps",
            Method::Exact | Method::Sum if self.tolerance.is_some() => "--tolerance",
            Method::Integrate if self.steps.is_some() => "--steps",
            Method::Exact | Method::Integrate if self.unit.is_some() => "--unit",
            Method::Exact | Method::Sum if self.threshold.is_some() => "--threshold",
            Method::Irs if self.threshold.is_some() && self.tolerance.is_none() => {
                "--threshold without --tolerance"
            }
            Method::Integrate | Method::Sum | Method::Irs if !self.at.is_empty() => "--at",
            _ => return Ok(()),
        };
        let method =
            self.method.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
        Err(Stop::Call(format!("--method {method} has no option {misfit}: see `hodograph solve --help`")))
    }

    fn integration(&self, approach: &Vector3<f64>) -> Integration {
        let options = self.tolerance.map_or_else(Integration::default, Integration::with_tolerance);
        let slip = approach.y.hypot(approach.z);
        match self.threshold {
            // Without slip there is no threshold.
            Some(threshold) if slip > 0.0 => {
                Integration { slip_threshold: threshold / slip, switch: Switch::AtThreshold, ..options }
            }
            _ => options,
        }
    }

    fn summation(&self) -> Summation {
        Summation { unit: self.unit, ..Summation::new(self.steps.unwrap_or(50)) }
    }

    fn solve(
        &self,
        matrix: &ReducedMatrix<f64>,
        approach: &Vector3<f64>,
        surface: &Surface<f64>,
    ) -> Result<Answer, Failure> {
        let integration = self.integration(approach);
        let partial = if self.tolerance.is_some() {
            Partial::Integrate(integration)
        } else {
            Partial::Sum(self.summation())
        };
        let Solution { impact, steps, .. } = match self.method {
            Method::Exact => return self.solve_exactly(matrix, approach, surface),
            Method::Integrate => methods::integrate(matrix, approach, surface, &integration)?,
            Method::Sum => methods::sum(matrix, approach, surface, &self.summation())?,
            Method::Irs => methods::irs(matrix, approach, surface, &partial)?,
        };
        let characteristics = self.characteristics.form.map(|_| {
            let slip = [approach.y, approach.z];
            Characteristics::of_contact(matrix)
                .with_friction(matrix, surface.mu, slip)
                .with_phases(&impact.phases)
        });
        Ok(Answer { steps: Some(steps), characteristics, ..Answer::try_from(&impact)? })
    }

    fn solve_exactly(
        &self,
        matrix: &ReducedMatrix<f64>,
        approach: &Vector3<f64>,
        surface: &Surface<f64>,
    ) -> Result<Answer, Failure> {
        let impact =
            hodograph::solve(matrix, approach, &surface.with_budget(self.budget.unwrap_or(u32::MAX)))?;
        let at =
            self.at.iter().map(|&impulse| snapshot_at(matrix, approach, surface.mu, impulse).map(At::from));
        let at = at.collect::<Result<_, _>>()?;
        let characteristics = match self.characteristics.form {
            Some(_) => Some(characteristics_of(matrix, approach, surface)?),
            None => None,
        };
        Ok(Answer { at, characteristics, ..Answer::try_from(&impact)? })
    }
}

/// All characteristic quantities of a collision.
///
/// # Errors
///
/// Those of the solver.
pub fn characteristics_of(
    matrix: &ReducedMatrix<f64>,
    approach: &Vector3<f64>,
    surface: &Surface<f64>,
) -> Result<Characteristics, Failure> {
    // Unlike `solve`, this locates the end of compression under every law.
    let whole = Hodograph::new(matrix, approach, surface)?;
    Ok(Characteristics::of_contact(matrix)
        .with_friction(matrix, surface.mu, [approach.y, approach.z])
        .with_phases(&whole.impact().phases))
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Reported`] if a line had an error, [`Stop::Call`] for an option that the method does not have.
pub fn run(arguments: &Arguments) -> Outcome {
    arguments.check()?;
    let mut input = io::stdin().lock();
    if io::stdin().is_terminal() {
        output::say(
            "reading collisions from the terminal, one JSON object per line; `hodograph solve --help` shows one",
        );
    }
    let (mut all_solved, mut line) = (true, Vec::new());
    while let Some(complete) = read_line(&mut input, &mut line, MAX_LINE, "standard input")? {
        let answer = if complete {
            if line.iter().all(u8::is_ascii_whitespace) {
                continue;
            }
            answer(&line, arguments)
        } else {
            Err(Failure::bad_json(format!(
                "the line is longer than {MAX_LINE} bytes: give one collision per line"
            )))
        };
        all_solved &= answer.is_ok();
        let written = match answer {
            Ok(Answer { characteristics: Some(found), .. })
                if arguments.characteristics.form == Some(Form::Table) =>
            {
                output::text(&found.table())
            }
            Ok(answer) => output::json(&answer),
            Err(failure) => output::line(&failure.to_line()),
        };
        match written {
            // The input may never reach an end of line, so nothing more is read.
            Err(Stop::ReaderGone) => break,
            other => other?,
        }
    }
    if all_solved { Ok(()) } else { Err(Stop::Reported) }
}

fn answer(line: &[u8], arguments: &Arguments) -> Result<Answer, Failure> {
    let text = std::str::from_utf8(line)
        .map_err(|error| Failure::bad_json(format!("this is not UTF-8 at byte {}", error.valid_up_to())))?;
    let case = Fields::new(Json::parse(text)?, "a collision")?;
    let matrix = case.numbers::<6>("m", "the six numbers nn, nt, ns, tt, ts, ss")?;
    let velocity = case.numbers::<3>("v", "the three numbers n, t, s")?;
    let mu = case.number("mu", "the coefficient of friction")?;
    let e = case.number("e", "the coefficient of restitution")?;
    let names = Law::NAMES.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    let law = match case.need("law", &format!("one of {names}"))? {
        Json::String(name) => surface::law(name)?,
        other => {
            return Err(Failure::bad_json(format!("`law` must be one of {names}, not {}", other.sort())));
        }
    };
    let surface = Surface { mu, e, law };
    let matrix = ReducedMatrix::from(matrix);
    let velocity = Vector3::from(velocity);
    arguments.solve(&matrix, &velocity, &surface)
}
