//! `hodograph solve`: solves collisions given as JSON lines, and writes their outcomes as JSON
//! lines.

use std::io::{self, IsTerminal};

use clap::ValueEnum;
use hodograph::methods::{self, Integration, Partial, Summation};
use hodograph::{ReducedMatrix, Surface};
use nalgebra::Vector3;

use crate::json::answer::Answer;
use crate::json::{Failure, Fields, Json, lines::read_line};
use crate::output;
use crate::stop::{Outcome, Stop};
use crate::surface;

/// A line longer than this is no collision.
const LONGEST_LINE: usize = 1 << 20;

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
    /// `sum`, `irs`: steps to an impulse of -v_n1 / (4 m_nn), the paper's refinement k [default:
    /// 50]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub steps: Option<u32>,
    /// `integrate`, and `irs` instead of steps: error allowed per step, relative, 1e-14 to 0.1
    /// [default: 1e-10]
    #[arg(long, value_parser = tolerance, conflicts_with = "steps")]
    pub tolerance: Option<f64>,
    /// `exact`: quadratures that a collision may take; one that needs more has the error
    /// `budget_exceeded` [default: no limit but the solver's own]
    #[arg(long, value_name = "QUADRATURES")]
    pub budget: Option<u32>,
}

/// The roads to an outcome.
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

impl Arguments {
    /// Names an option that the method does not have.
    fn check(&self) -> Outcome {
        let misfit = match self.method {
            Method::Integrate | Method::Sum | Method::Irs if self.budget.is_some() => "--budget",
            Method::Exact if self.steps.is_some() => "--steps",
            Method::Exact | Method::Sum if self.tolerance.is_some() => "--tolerance",
            Method::Integrate if self.steps.is_some() => "--steps",
            _ => return Ok(()),
        };
        let method =
            self.method.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
        Err(Stop::Call(format!("--method {method} has no option {misfit}: see `hodograph solve --help`")))
    }

    fn integration(&self) -> Integration {
        self.tolerance.map_or_else(Integration::default, Integration::with_tolerance)
    }

    fn summation(&self) -> Summation {
        Summation::new(self.steps.unwrap_or(50))
    }

    fn solve(
        &self,
        matrix: &ReducedMatrix<f64>,
        approach: &Vector3<f64>,
        surface: &Surface<f64>,
    ) -> Result<hodograph::Impact<f64>, Failure> {
        let partial = if self.tolerance.is_some() {
            Partial::Integrate(self.integration())
        } else {
            Partial::Sum(self.summation())
        };
        Ok(match self.method {
            Method::Exact => {
                hodograph::solve(matrix, approach, &surface.within(self.budget.unwrap_or(u32::MAX)))?
            }
            Method::Integrate => methods::integrate(matrix, approach, surface, &self.integration())?,
            Method::Sum => methods::sum(matrix, approach, surface, &self.summation())?,
            Method::Irs => methods::irs(matrix, approach, surface, &partial)?,
        })
    }
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Said`] if a line had an error, [`Stop::Call`] for an option that the method does not
/// have.
pub fn run(arguments: &Arguments) -> Outcome {
    arguments.check()?;
    let mut input = io::stdin().lock();
    if io::stdin().is_terminal() {
        output::say(
            "reading collisions from the terminal, one JSON object per line; `hodograph solve --help` shows one",
        );
    }
    let (mut all_solved, mut line) = (true, Vec::new());
    while let Some(complete) = read_line(&mut input, &mut line, LONGEST_LINE, "standard input")? {
        let answer = if complete {
            if line.iter().all(u8::is_ascii_whitespace) {
                continue;
            }
            answer(&line, arguments)
        } else {
            Err(Failure::bad_json(format!(
                "the line is longer than {LONGEST_LINE} bytes: give one collision per line"
            )))
        };
        all_solved &= answer.is_ok();
        let written = match answer {
            Ok(answer) => output::json(&answer),
            Err(failure) => output::line(&failure.to_line()),
        };
        match written {
            // There may be no end of lines: nothing more is read.
            Err(Stop::ReaderGone) => break,
            other => other?,
        }
    }
    if all_solved { Ok(()) } else { Err(Stop::Said) }
}

fn answer(line: &[u8], arguments: &Arguments) -> Result<Answer, Failure> {
    let text = std::str::from_utf8(line)
        .map_err(|error| Failure::bad_json(format!("this is no UTF-8 at byte {}", error.valid_up_to())))?;
    let case = Fields::new(Json::parse(text)?, "a collision")?;
    let matrix = case.numbers::<6>("m", "the six numbers nn, nt, ns, tt, ts, ss")?;
    let velocity = case.numbers::<3>("v", "the three numbers n, t, s")?;
    let mu = case.number("mu", "the coefficient of friction")?;
    let e = case.number("e", "the coefficient of restitution")?;
    let law = match case.need("law", "\"newton\", \"poisson\" or \"stronge\"")? {
        Json::String(name) => surface::law(name)?,
        other => {
            return Err(Failure::bad_json(format!(
                "`law` must be \"newton\", \"poisson\" or \"stronge\", not {}",
                other.sort()
            )));
        }
    };
    let surface = Surface { mu, e, law };
    let matrix = ReducedMatrix::from(matrix);
    let velocity = Vector3::from(velocity);
    Answer::try_from(&arguments.solve(&matrix, &velocity, &surface)?)
}
