//! How much the rounding of doubles costs: what the measured programs answer at many random states, beside
//! the same quantities in twice as many digits, and beside Pinocchio's error at the same states (stored, or
//! measured anew with `--peers`).

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use hodograph_generator::check::check;
use hodograph_generator::files;
use hodograph_generator::interpret::Evaluator;
use hodograph_generator::model::mechanism::{Mechanism, Orientation, Variable};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::Program;
use hodograph_generator::program::graph::Input;
use hodograph_generator::program::{ContactQuantity, Quantity};
use serde_json::{Value, json};

use crate::cases::{Case, Origin};
use crate::derive::Derivation;
use crate::harness::{Built, ROUTINES};
use crate::precise::{Precise, evaluate};
use crate::python;
use crate::tools::{Failure, Folders, output};

/// Errors of Pinocchio.
const PEERS: &str = "tests/data/peers/rounding.json";

/// How many states a set has: the worst of so many is what is compared.
const SET: usize = 2000;
/// How many sets. The worst of one is a single state, and says little: their median says more.
const SETS: usize = 10;

/// A random state: numbers between -1 and 1, angles between -pi and pi, quaternions of unit length.
struct State {
    coordinates: Vec<f64>,
    speeds: Vec<f64>,
    accelerations: Vec<f64>,
    inputs: Vec<f64>,
}

/// Errors relative to the largest entry of an answer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Error {
    /// the largest of a set of states, median over the sets
    pub worst: f64,
    /// the largest of all states
    pub of_all: f64,
    /// the mean over the states
    pub mean: f64,
}

impl Error {
    fn new(errors: &[f64]) -> Self {
        let largest = |errors: &[f64]| errors.iter().fold(0.0f64, |largest, &error| largest.max(error));
        let mut sets: Vec<f64> = errors.chunks(SET).map(largest).collect();
        sets.sort_by(f64::total_cmp);
        let middle = sets.len() / 2;
        let median =
            if sets.len().is_multiple_of(2) { (sets[middle - 1] + sets[middle]) / 2.0 } else { sets[middle] };
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        Error { worst: median, of_all: largest(errors), mean }
    }
}

/// Errors per routine.
pub type Errors = BTreeMap<&'static str, Error>;

/// The states of a mechanism, the same every time.
fn states(mechanism: &Mechanism) -> Vec<State> {
    let mut bits = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut state = || {
        let mut coordinates: Vec<f64> = mechanism
            .coordinates
            .iter()
            .map(|coordinate| next() * if coordinate.unit == "rad" { std::f64::consts::PI } else { 1.0 })
            .collect();
        for frame in &mechanism.frames {
            if let Orientation::Quaternion(ids) = &frame.orientation {
                let norm = ids.iter().map(|id| coordinates[id.0].powi(2)).sum::<f64>().sqrt();
                ids.iter().for_each(|id| coordinates[id.0] /= norm);
            }
        }
        let mut list = |count: usize| (0..count).map(|_| next()).collect::<Vec<f64>>();
        let speeds = mechanism.speeds.len();
        State {
            coordinates,
            speeds: list(speeds),
            accelerations: list(speeds),
            inputs: list(mechanism.inputs.len()),
        }
    };
    (0..SETS * SET).map(|_| state()).collect()
}

/// Quaternions that have unit length to all digits: a double more or less is what both sides round.
fn unit_quaternions(mechanism: &Mechanism, coordinates: &mut [Precise]) {
    for frame in &mechanism.frames {
        if let Orientation::Quaternion(ids) = &frame.orientation {
            let square =
                ids.iter().fold(Precise::from(0.0), |sum, id| sum + coordinates[id.0] * coordinates[id.0]);
            let norm = square.sqrt();
            ids.iter().for_each(|id| coordinates[id.0] = coordinates[id.0] / norm);
        }
    }
}

/// What a routine answers.
fn quantities(routine: &str) -> Vec<Quantity> {
    match routine {
        "FD" => vec![Quantity::Accelerations],
        "ID" => vec![Quantity::InverseDynamics],
        "CM" => vec![Quantity::Contact(0, ContactQuantity::Reduced)],
        _ => vec![Quantity::MassMatrix],
    }
}

/// A program in [`Precise`] numbers.
fn exact(
    program: &Program,
    mechanism: &Mechanism,
    state: &State,
    routine: &str,
) -> Result<Vec<Precise>, Failure> {
    let precise = |list: &[f64]| list.iter().map(|&number| Precise::from(number)).collect::<Vec<_>>();
    let mut coordinates = precise(&state.coordinates);
    unit_quaternions(mechanism, &mut coordinates);
    let of =
        |list: &[Precise], index: u32| list.get(index as usize).copied().unwrap_or(Precise::from(f64::NAN));
    let parameters: Vec<Precise> = mechanism
        .parameters
        .iter()
        .map(|parameter| Precise::from(parameter.value.unwrap_or(f64::NAN)))
        .collect();
    let (speeds, accelerations) = (precise(&state.speeds), precise(&state.accelerations));
    // Inverse dynamics tells what inputs are needed on top of those that act.
    let inputs =
        if routine == "ID" { vec![Precise::from(0.0); state.inputs.len()] } else { precise(&state.inputs) };
    let input = |from| match from {
        Input::Parameter(index) => of(&parameters, index),
        Input::Coordinate(index) => of(&coordinates, index),
        Input::Speed(index) => of(&speeds, index),
        Input::Acceleration(index) => of(&accelerations, index),
        Input::Input(index) => of(&inputs, index),
        _ => Precise::from(f64::NAN),
    };
    evaluate(program, &quantities(routine), input).map_err(Failure::new)
}

/// The model of a derivation.
fn mechanism(derivation: &Derivation<'_>) -> Result<Mechanism, Failure> {
    let path: PathBuf = derivation.path.clone();
    check(&files::model(&path))
        .mechanism
        .ok_or_else(|| Failure::new(format!("{} is not accepted", path.display())))
}

/// What the compiled program answers at the states: per state, the numbers of each routine.
fn answers(built: &Built, states: &[State]) -> Result<Vec<Vec<f64>>, Failure> {
    let mut child =
        Command::new(&built.program).arg("answer").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let mut lines = String::new();
    for state in states {
        let numbers = [&state.coordinates, &state.speeds, &state.accelerations, &state.inputs];
        let words: Vec<String> = numbers.into_iter().flatten().map(|number| format!("{number:?}")).collect();
        lines += &(words.join(" ") + "\n");
    }
    let Some(mut pipe) = child.stdin.take() else { return Err(Failure::new("the program takes no states")) };
    let writer = std::thread::spawn(move || pipe.write_all(lines.as_bytes()));
    let output = child.wait_with_output()?;
    let _ = writer.join();
    let text = String::from_utf8_lossy(&output.stdout);
    let line = |line: &str| line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    Ok(text.lines().map(line).collect())
}

/// The errors of a measured program against the program with parameters at run time, evaluated in twice the
/// digits; the states and the exact answers are left in the folder for the peers, if that is wanted.
pub fn measure(
    folders: &Folders,
    built: &Built,
    derivation: &Derivation<'_>,
    reference: &Derivation<'_>,
    keep: bool,
) -> Result<Errors, Failure> {
    let mechanism = mechanism(reference)?;
    let states = states(&mechanism);
    let answers = answers(built, &states)?;
    let mut errors = Errors::new();
    let mut kept: Vec<Value> = states
        .iter()
        .map(|state| json!({"q": state.coordinates, "v": state.speeds, "a": state.accelerations, "tau": state.inputs}))
        .collect();
    for (place, (routine, _)) in ROUTINES.into_iter().enumerate() {
        let mut list = Vec::with_capacity(states.len());
        for (index, state) in states.iter().enumerate() {
            let exact = exact(&reference.program, &mechanism, state, routine)?;
            let all = answers.get(index * ROUTINES.len() + place).map_or(&[][..], Vec::as_slice);
            // of V and the reduced matrix the latter, which stands last
            let found = all.get(all.len().saturating_sub(exact.len())..).unwrap_or_default();
            let off = relative(found, &exact);
            list.push(if off.is_nan() { f64::INFINITY } else { off });
            if keep {
                kept[index][routine] = exact.iter().map(|number| json!([number.high, number.low])).collect();
            }
        }
        errors.insert(routine, Error::new(&list));
    }
    if keep {
        let folder = folders.work.join("rounding");
        std::fs::create_dir_all(&folder)?;
        let names = |list: &[Variable]| -> Vec<String> {
            list.iter().map(|quantity| quantity.name.clone()).collect()
        };
        let head = json!({
            "coordinates": names(&mechanism.coordinates),
            "speeds": derivation.speeds,
            "basis": basis(&reference.program, &mechanism, &states[0])?,
            "set": SET,
        });
        let file = folder.join(format!("{}.jsonl", derivation.case.name));
        let mut out = std::io::BufWriter::new(std::fs::File::create(file)?);
        for line in std::iter::once(&head).chain(&kept) {
            writeln!(out, "{line}")?;
        }
        out.flush()?;
    }
    Ok(errors)
}

/// The axes of the contact, by rows; they stand still.
fn basis(program: &Program, mechanism: &Mechanism, state: &State) -> Result<Vec<Vec<f64>>, Failure> {
    let inputs = Inputs {
        parameters: mechanism
            .parameters
            .iter()
            .map(|parameter| parameter.value.unwrap_or(f64::NAN))
            .collect(),
        coordinates: state.coordinates.clone(),
        ..Inputs::default()
    };
    let axes = [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second];
    let axes = axes.map(|axis| Quantity::Contact(0, axis));
    let arrays = Evaluator::new(program).evaluate(&inputs, &axes);
    let arrays = arrays.map_err(|error| Failure::new(error.to_string()))?;
    Ok(arrays.into_iter().map(|array| array.values).collect())
}

/// Largest difference over largest entry.
fn relative(found: &[f64], exact: &[Precise]) -> f64 {
    if found.len() != exact.len() {
        return f64::NAN;
    }
    let largest = exact.iter().fold(0.0f64, |largest, number| largest.max(number.high.abs()));
    let off = found.iter().zip(exact).map(|(&found, &exact)| (Precise::from(found) - exact).high.abs());
    off.fold(0.0f64, |most, off| if off > most || off.is_nan() { off } else { most }) / largest
}

/// Errors of Pinocchio at the same states.
fn peers(folders: &Folders) -> Result<Value, Failure> {
    let text = std::fs::read_to_string(folders.root.join(PEERS))?;
    serde_json::from_str(&text).map_err(|error| Failure::new(error.to_string()))
}

/// Measures Pinocchio's errors at the same states and stores them.
pub fn of_peers(folders: &Folders, cases: &[Case]) -> Result<(), Failure> {
    let python = python::with_pinocchio(folders)?;
    let mut command = Command::new(python);
    command.args(["-c", include_str!("rounding.py")]).arg(folders.work.join("rounding"));
    for case in cases.iter().filter(|case| case.has_peers()) {
        let folder = match case.origin {
            Origin::Peer => folders.root.join("tests/data/peers"),
            _ => folders.work.join("models"),
        };
        command.arg(format!("{}:{}", case.name, folder.join(format!("{}.urdf", case.name)).display()));
    }
    Ok(std::fs::write(folders.root.join(PEERS), output(&mut command)?)?)
}

/// Prints the table: run-time parameters, fixed ones, Pinocchio; worst of a set, worst of all and mean each.
pub fn print(folders: &Folders, rows: &[(&Derivation<'_>, Errors)]) -> Result<(), Failure> {
    let peers = peers(folders)?;
    println!(
        "\n| mechanism | routine | run-time, worst | of all | mean | fixed, worst | of all | mean | Pinocchio, worst | of all | mean |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for pair in rows.chunks_exact(2) {
        let [(derivation, slow), (_, fast)] = pair else { continue };
        for (routine, _) in ROUTINES {
            let theirs = &peers[derivation.case.name.as_str()][routine];
            let number = |error: f64| format!("{error:.2e}");
            let ours = [slow[routine], fast[routine]];
            let ours = ours.into_iter().flat_map(|error| [error.worst, error.of_all, error.mean]).map(number);
            let theirs =
                ["worst", "of_all", "mean"].map(|key| theirs[key].as_f64().map_or_else(String::new, number));
            let all: Vec<String> = ours.chain(theirs).collect();
            println!("| {} | {routine} | {} |", derivation.case.title, all.join(" | "));
        }
    }
    Ok(())
}
