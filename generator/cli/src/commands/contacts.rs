//! `hodograph contacts`: solves problems of several contacts given as JSON lines, and writes forces and velocities as
//! JSON lines.

use hodograph::Cause;
use std::fs::File;
use std::io::{self, BufRead, BufReader, IsTerminal};
use std::path::PathBuf;

use hodograph_simulation::MOST_FRICTION;
use hodograph_simulation::contact_problem::{
    MOST_ENUMERATED, Problem, Solution, Solutions, Unsolved, enumerate, natural_residual, solve,
};
use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector2};
use serde::Serialize;

use crate::json::fields::number;
use crate::json::{Failure, Fields, Json, Kind, lines::read_line};
use crate::output;
use crate::stop::{Outcome, Stop};

// models may state no friction that motions refuse
const _: () = assert!(hodograph_generator::model::mechanism::Surface::MOST_FRICTION == MOST_FRICTION);

/// The longest line, in bytes.
const MAX_LINE: usize = 1 << 28;

/// Entries of a matrix and of its transpose may differ by this much, relative to the diagonal: measured sets of problems
/// do by 0.004.
const ASYMMETRIC: f64 = 0.05;

/// A matrix may miss being positive semidefinite by this much, relative to its diagonal.
const INDEFINITE: f64 = 1e-6;

/// Eigenvalues are looked at of matrices of so many contacts.
const MAX_DECOMPOSED: usize = 60;

/// After so many iterations eigenvalues are not looked at.
const MOST_ITERATIONS: usize = 10_000;

/// The largest number of contacts; more would need more than a gigabyte.
const MAX_CONTACTS: usize = 2000;

/// Solve problems of several contacts: one JSON object per line, one answer per line
///
/// A line gives the coefficients of friction, the velocities (or accelerations) without contact forces, and the blocks of
/// the matrix that takes forces to velocities, components n, t, s of each contact:
///
///   {"name":"..","contacts":2,"mu":[0.3,0.3],"q":[n,t,s,n,t,s],"w":[[0,0,[nine numbers by rows]],..]}
///
/// Its answer is
/// {"name":"..","force":[..],"velocity":[..],"residual":..,"solutions":"unique"}
/// or {"name":"..","error":{"kind":"..","message":".."}}. Blank lines are skipped, other fields are left alone.
/// Exit 0 if every line was solved, 1 if one had an error.
// the brackets are JSON, as the help shows it
#[allow(rustdoc::broken_intra_doc_links)]
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// file with the lines, `-` for standard input
    #[arg(default_value = "-", value_name = "FILE")]
    pub file: PathBuf,
    /// for at most four contacts, write a line for every solution in distinct modes, the one with most
    /// contacts at rest first
    #[arg(long)]
    pub all: bool,
}

/// The solution of a problem: forces and velocities.
#[derive(Clone, Debug, Serialize)]
struct Answer {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    force: Vec<f64>,
    velocity: Vec<f64>,
    residual: f64,
    solutions: &'static str,
}

/// An error with the name of the problem.
#[derive(Serialize)]
struct Named<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    error: &'a Failure,
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Reported`] if a line had an error, [`Stop::Call`] if the file cannot be read.
pub fn run(arguments: &Arguments) -> Outcome {
    if arguments.file.as_os_str() == "-" {
        if io::stdin().is_terminal() {
            output::say(
                "reading problems from the terminal, one JSON object per line; `hodograph contacts --help` shows one",
            );
        }
        return answer_lines(arguments, &mut io::stdin().lock(), "standard input");
    }
    let unreadable = |error: io::Error| Stop::unreadable(&arguments.file, &error);
    let file = File::open(&arguments.file).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.is_dir() {
        return Err(unreadable(io::ErrorKind::IsADirectory.into()));
    }
    let name = output::visible(&arguments.file.display().to_string());
    answer_lines(arguments, &mut BufReader::new(file), &name)
}

fn answer_lines(arguments: &Arguments, input: &mut impl BufRead, from: &str) -> Outcome {
    let (mut all_solved, mut line) = (true, Vec::new());
    while let Some(complete) = read_line(input, &mut line, MAX_LINE, from)? {
        let (name, answers) = if complete {
            if line.iter().all(u8::is_ascii_whitespace) {
                continue;
            }
            answer(&line, arguments.all)
        } else {
            let said = format!("the line is longer than {MAX_LINE} bytes: give one problem per line");
            (None, Err(Failure::bad_json(said)))
        };
        all_solved &= answers.is_ok();
        let written = match answers {
            Ok(answers) => answers.iter().try_for_each(output::json),
            Err(failure) => output::json(&Named { name: name.as_deref(), error: &failure }),
        };
        match written {
            // The input may never reach an end of line, so nothing more is read.
            Err(Stop::ReaderGone) => break,
            other => other?,
        }
    }
    if all_solved { Ok(()) } else { Err(Stop::Reported) }
}

/// The name of a problem and its answers.
fn answer(line: &[u8], all: bool) -> (Option<String>, Result<Vec<Answer>, Failure>) {
    let fields = match parsed(line) {
        Ok(fields) => fields,
        Err(failure) => return (None, Err(failure)),
    };
    let name = match fields.get("name") {
        None => None,
        Some(Json::String(name)) => Some(name.clone()),
        Some(other) => {
            return (None, Err(Failure::bad_json(format!("`name` must be text, not {}", other.sort()))));
        }
    };
    let answers = Given::read(&fields).and_then(|given| given.answers(name.as_ref(), all));
    (name, answers)
}

fn parsed(line: &[u8]) -> Result<Fields, Failure> {
    let text = std::str::from_utf8(line)
        .map_err(|error| Failure::bad_json(format!("this is not UTF-8 at byte {}", error.valid_up_to())))?;
    Fields::new(Json::parse(text)?, "a problem")
}

/// A problem as read from a line.
struct Given {
    w: DMatrix<f64>,
    q: DVector<f64>,
    mu: Vec<f64>,
    slip: Vec<Option<Vector2<f64>>>,
}

impl Given {
    fn read(fields: &Fields) -> Result<Self, Failure> {
        let contacts = fields.number("contacts", "the number of contacts")?;
        if contacts < 0.0 || contacts.fract() != 0.0 || contacts > MAX_CONTACTS as f64 {
            return Err(Failure::bad_json(format!(
                "`contacts` must be a whole number from 0 to {MAX_CONTACTS}, not {contacts}"
            )));
        }
        let k = contacts as usize;
        let mu = list(fields, "mu", k, "a coefficient of friction for each contact")?;
        if let Some(i) = (0..k).find(|&i| mu[i] < 0.0) {
            return Err(Failure::new(
                Kind::Of(Cause::NegativeFriction),
                format!("`mu[{i}]` is {}: friction cannot be negative", mu[i]),
            ));
        }
        if let Some(i) = (0..k).find(|&i| mu[i] > MOST_FRICTION) {
            return Err(Failure::bad_json(format!(
                "`mu[{i}]` is {:e}: its square must be a number, so that at most {MOST_FRICTION:e} is taken; 1e6 holds as well",
                mu[i]
            )));
        }
        let q = DVector::from_vec(list(fields, "q", 3 * k, "n, t, s of each contact")?);
        let blocks = array(fields.need("w", FORM)?, "w", FORM)?;
        let mut w = DMatrix::zeros(3 * k, 3 * k);
        let mut given = vec![false; k * k];
        for (place, block) in blocks.iter().enumerate() {
            let (i, j, entries) = read_block(block, place, k)?;
            if std::mem::replace(&mut given[i * k + j], true) {
                return Err(Failure::bad_json(format!("`w[{place}]` gives the block {i}, {j} once more")));
            }
            for (at, entry) in entries.into_iter().enumerate() {
                w[(3 * i + at / 3, 3 * j + at % 3)] = entry;
            }
        }
        if let Some(what) = of_no_mechanism(&w) {
            return Err(Failure::new(
                Kind::Of(Cause::NotPositiveSemidefinite),
                format!("{what}: no mechanism has such a matrix"),
            ));
        }
        let slip = match fields.get("slip") {
            None => vec![None; k],
            Some(slip) => {
                let form = "null or a direction [t,s] for each contact";
                let items = array(slip, "slip", form)?;
                if items.len() != k {
                    return Err(Failure::bad_json(format!(
                        "`slip` must be {form}, not {} of them",
                        items.len()
                    )));
                }
                items.iter().enumerate().map(|(i, item)| direction(item, i)).collect::<Result<_, _>>()?
            }
        };
        Ok(Self { w, q, mu, slip })
    }

    fn answers(&self, name: Option<&String>, all: bool) -> Result<Vec<Answer>, Failure> {
        let problem = Problem { w: &self.w, beta: &self.q, mu: &self.mu, slip: &self.slip, noise: None };
        let few = self.mu.len() <= MOST_ENUMERATED;
        if all && !few {
            return Err(Failure::new(
                Kind::Unsolved,
                format!(
                    "--all lists the solutions of at most {MOST_ENUMERATED} contacts, not of {}",
                    self.mu.len()
                ),
            ));
        }
        let listed = if few { enumerate(&problem) } else { Vec::new() };
        if all && !listed.is_empty() {
            return listed.iter().map(|solution| self.answer(&problem, name, solution)).collect();
        }
        let mut found = solve(&problem, None).map_err(|reason| failure(&reason))?;
        if let Some(first) = listed.first() {
            found.solutions = first.solutions;
        }
        Ok(vec![self.answer(&problem, name, &found)?])
    }

    fn answer(
        &self,
        problem: &Problem<'_>,
        name: Option<&String>,
        solution: &Solution,
    ) -> Result<Answer, Failure> {
        // A zero has no sign for a reader.
        let plain = |values: &DVector<f64>| values.iter().map(|value| value + 0.0).collect::<Vec<f64>>();
        let residual = natural_residual(problem, &solution.force);
        let solutions = if self.mu.is_empty() { Solutions::Unique } else { solution.solutions };
        let answer = Answer {
            name: name.cloned(),
            force: plain(&solution.force),
            velocity: plain(&solution.acceleration),
            residual,
            solutions: solutions.name(),
        };
        let numbers = answer.force.iter().chain(&answer.velocity).chain([&answer.residual]);
        if numbers.into_iter().all(|number| number.is_finite()) {
            Ok(answer)
        } else {
            Err(Failure::new(
                Kind::Of(Cause::NotFinite),
                "the answer is out of the range of doubles: choose other units",
            ))
        }
    }
}

/// What shows that a matrix of blocks takes no forces of a mechanism to velocities: it is symmetric up to errors of a
/// computation, and forces do no work on what is at rest.
fn of_no_mechanism(w: &DMatrix<f64>) -> Option<String> {
    let n = w.nrows();
    if let Some(row) = (0..n).find(|&row| w[(row, row)] < 0.0) {
        return Some(format!("`w` has {} on its diagonal (contact {})", w[(row, row)], row / 3));
    }
    let size = |i: usize, j: usize| w[(i, i)].sqrt() * w[(j, j)].sqrt();
    let pairs = || (0..n).flat_map(|i| (0..i).map(move |j| (j, i)));
    let entries =
        |i: usize, j: usize| format!("entry {}, {} of the block {}, {} of `w`", i % 3, j % 3, i / 3, j / 3);
    if let Some((i, j)) = pairs().find(|&(i, j)| (w[(i, j)] - w[(j, i)]).abs() > ASYMMETRIC * size(i, j)) {
        let opposite = if i / 3 == j / 3 {
            "the opposite entry".to_owned()
        } else {
            format!("that of the block {}, {}", j / 3, i / 3)
        };
        return Some(format!(
            "{} is {}, and {opposite} {}, which are the same in a symmetric matrix",
            entries(i, j),
            w[(i, j)],
            w[(j, i)]
        ));
    }
    if let Some((i, j)) = pairs().find(|&(i, j)| w[(i, j)].abs() > (1.0 + INDEFINITE) * size(i, j)) {
        return Some(format!("{} is {}, more than its diagonal entries allow", entries(i, j), w[(i, j)]));
    }
    if n == 0 || n > 3 * MAX_DECOMPOSED {
        return None;
    }
    // of the matrix whose diagonal is 1, so that units do not matter
    let scale = |i: usize| if w[(i, i)] > 0.0 { w[(i, i)].sqrt() } else { 1.0 };
    let scaled = DMatrix::from_fn(n, n, |i, j| 0.5 * (w[(i, j)] + w[(j, i)]) / scale(i) / scale(j));
    let asymmetry =
        pairs().fold(0.0_f64, |most, (i, j)| most.max((w[(i, j)] - w[(j, i)]).abs() / scale(i) / scale(j)));
    let decomposed = SymmetricEigen::try_new(scaled, f64::EPSILON, MOST_ITERATIONS)?;
    let least = decomposed.eigenvalues.iter().fold(0.0_f64, |least, value| least.min(*value));
    (least < -(INDEFINITE + asymmetry) * n as f64).then(|| "`w` has a negative eigenvalue".to_owned())
}

const FORM: &str = "blocks [i,j,[nine numbers by rows]]";

fn array<'a>(value: &'a Json, name: &str, form: &str) -> Result<&'a [Json], Failure> {
    match value {
        Json::Array(items) => Ok(items),
        other => Err(Failure::bad_json(format!("`{name}` must be {form}, not {}", other.sort()))),
    }
}

fn list(fields: &Fields, name: &str, length: usize, form: &str) -> Result<Vec<f64>, Failure> {
    let items = array(fields.need(name, form)?, name, form)?;
    if items.len() != length {
        return Err(Failure::bad_json(format!(
            "`{name}` must have {length} numbers ({form}), not {}",
            items.len()
        )));
    }
    items.iter().enumerate().map(|(i, item)| number(item, &format!("{name}[{i}]"))).collect()
}

fn read_block(block: &Json, place: usize, k: usize) -> Result<(usize, usize, [f64; 9]), Failure> {
    let name = format!("w[{place}]");
    let [i, j, entries] = array(block, &name, FORM)? else {
        return Err(Failure::bad_json(format!("`{name}` must be [i,j,[nine numbers by rows]]")));
    };
    let index = |value: &Json| -> Result<usize, Failure> {
        let number = number(value, &name)?;
        if number >= 0.0 && number.fract() == 0.0 && number < k as f64 {
            return Ok(number as usize);
        }
        Err(Failure::bad_json(format!(
            "`{name}` names contact {number}: give a number from 0 to {}",
            k.max(1) - 1
        )))
    };
    let (i, j) = (index(i)?, index(j)?);
    let items = array(entries, &format!("{name}[2]"), "nine numbers by rows")?;
    let mut nine = [0.0; 9];
    if items.len() != 9 {
        return Err(Failure::bad_json(format!("`{name}[2]` must have nine numbers, not {}", items.len())));
    }
    for (at, (slot, item)) in nine.iter_mut().zip(items).enumerate() {
        *slot = number(item, &format!("{name}[2][{at}]"))?;
    }
    Ok((i, j, nine))
}

/// The direction of slip of a contact, normalised.
fn direction(item: &Json, i: usize) -> Result<Option<Vector2<f64>>, Failure> {
    if *item == Json::Null {
        return Ok(None);
    }
    let name = format!("slip[{i}]");
    let [t, s] = array(item, &name, "null or a direction [t,s]")? else {
        return Err(Failure::bad_json(format!("`{name}` must be null or a direction [t,s]")));
    };
    let d = Vector2::new(number(t, &name)?, number(s, &name)?);
    let length = d.x.hypot(d.y);
    if length > 0.0 && length.is_finite() {
        Ok(Some(d / length))
    } else {
        Err(Failure::bad_json(format!("`{name}` has no direction: give null where a contact does not slip")))
    }
}

fn failure(reason: &Unsolved) -> Failure {
    let kind = match reason {
        Unsolved::Jam { .. } => Kind::Of(Cause::Jam),
        Unsolved::NotFound { .. } => Kind::Unsolved,
        Unsolved::Lengths | Unsolved::Input { .. } => Kind::BadJson,
    };
    Failure::new(kind, reason.to_string())
}
