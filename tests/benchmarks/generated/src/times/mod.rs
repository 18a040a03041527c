//! Times of the generated routines as ratios to those of C code generated with CasADi, wrenfold and SymForce, in the same process.
//!
//! The scripts in `peer/` write the C code; gcc compiles it for the same target, and one program calls both
//! in turns.

mod program;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::cases::{self, Case, Origin};
use crate::count;
use crate::derive::{self, Derivation};
use crate::harness::{self, Built, DERIVATIVES, ROUTINES, TARGET};
use crate::peers;
use crate::python;
use crate::slopes::{self, Names};
use crate::states::{self, Named, State};
use crate::tools::{Failure, Folders, output};
use program::Peer;

/// Mechanisms that are timed.
const TIMED: [&str; 6] = ["dpend", "cart5", "panda", "anymal", "whipple_bicycle", "chain20"];

/// What is timed: short name, and our function in the program.
fn routines() -> impl Iterator<Item = (&'static str, &'static str)> {
    let [derivatives, ..] = DERIVATIVES;
    ROUTINES.into_iter().chain([("M, one triangle", "measured_ml"), derivatives])
}

/// Numbers must agree to this, as a part of the largest.
const AGREEMENT: f64 = 1e-10;

/// What was measured of a mechanism: by name of a function in its program.
struct Figures {
    instructions: BTreeMap<String, f64>,
    seconds: BTreeMap<String, f64>,
}

/// Times all mechanisms, or those that are named, and prints a table.
pub fn run(folders: &Folders, tool: &Path, only: &[String]) -> Result<(), Failure> {
    let python = python::with_generators(folders)?;
    let wanted =
        |case: &Case| TIMED.contains(&case.name.as_str()) && (only.is_empty() || only.contains(&case.name));
    let cases: Vec<Case> = cases::all().into_iter().filter(wanted).collect();
    let mut derived = Vec::new();
    for case in &cases {
        for fixed in [false, true] {
            derived.push(derive::derive(folders, tool, case, fixed)?);
        }
    }
    harness::prepare(folders, &[])?;
    let stored = peers::read(folders)?;
    println!(
        "| mechanism | routine | ours | peer | ratio | stored | time, fixed | time, run-time | peer, equal trigonometry | ratio | time, fixed | time, run-time |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for pair in derived.chunks_exact(2) {
        let [run_time, fixed] = pair else { continue };
        let peers = peer(folders, &python, fixed)?;
        let slow = measure(folders, run_time, &peers)?;
        let fast = measure(folders, fixed, &peers)?;
        for (routine, function) in routines() {
            let alternatives: Vec<&Peer> = peers.iter().filter(|peer| peer.routine == routine).collect();
            if alternatives.is_empty() {
                continue;
            }
            let least = |figures: &BTreeMap<String, f64>, trigonometry: &str| -> f64 {
                let of = |peer: &&Peer| figures.get(&format!("{trigonometry}_{}", peer.name)).copied();
                alternatives.iter().filter_map(of).fold(f64::INFINITY, f64::min)
            };
            let ours = fast.instructions[function];
            let (own, shared) = (least(&fast.instructions, "own"), least(&fast.instructions, "shared"));
            let time = |figures: &Figures, trigonometry: &str| {
                figures.seconds[function] / least(&figures.seconds, trigonometry)
            };
            let best = stored.best(&fixed.case.name, routine);
            println!(
                "| {} | {routine} | {ours:.0} | {own:.0} | {:.2} | {} | **{:.2}** | **{:.2}** | {shared:.0} | {:.2} | {:.2} | {:.2} |",
                fixed.case.title,
                ours / own,
                best.map_or(String::new(), |best| format!("{:.0} ({})", best.instructions, best.name)),
                time(&fast, "own"),
                time(&slow, "own"),
                ours / shared,
                time(&fast, "shared"),
                time(&slow, "shared"),
            );
        }
    }
    Ok(())
}

/// Has the peer's code of a mechanism written and compiled; its routines.
fn peer(folders: &Folders, python: &Path, derivation: &Derivation<'_>) -> Result<Vec<Peer>, Failure> {
    let case = derivation.case;
    let scripts = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/peer"));
    let folder = folders.work.join("peer").join(&case.name);
    let mut command = Command::new(python);
    match case.origin {
        Origin::Model => {
            command.arg(scripts.join(format!("{}.py", case.name))).arg(&folder);
        }
        Origin::Peer | Origin::Chain(_) => {
            let model = format!("{}.urdf", case.name);
            let urdf = match case.origin {
                Origin::Peer => folders.root.join("tests/data/peers").join(model),
                _ => folders.work.join("models").join(model),
            };
            let floating = derivation.states.first().is_some_and(|state| state.q.len() > state.u.len());
            let base = if floating { "floating" } else { "fixed" };
            command.arg(scripts.join("robot.py")).arg(urdf).arg(base).arg(&folder);
        }
    }
    eprintln!("writing the peer of {}", case.name);
    output(&mut command)?;
    let listed = states::parsed(&std::fs::read_to_string(folder.join("routines.json"))?)?;
    let peers: Vec<Peer> =
        listed.as_object().into_iter().flatten().map(|(name, value)| of_json(name, value)).collect();
    let mut objects = Vec::new();
    for peer in &peers {
        let (source, object) =
            (folder.join(format!("call_{}.c", peer.name)), folder.join(format!("{}.o", peer.name)));
        std::fs::write(&source, peer.calls())?;
        let march = format!("-march={TARGET}");
        output(Command::new("gcc").args(["-O3", &march, "-c", "-o"]).arg(&object).arg(&source))?;
        objects.push(object);
    }
    let library = folder.join("libpeer.a");
    let _ = std::fs::remove_file(&library);
    output(Command::new("ar").arg("rcs").arg(&library).args(&objects))?;
    Ok(peers)
}

fn of_json(name: &str, value: &Value) -> Peer {
    let routine = match name.split('_').next().unwrap_or("") {
        "ml" => "M, one triangle".to_owned(),
        "dfd" => "dFD".to_owned(),
        other => other.to_uppercase(),
    };
    let angle =
        |entry: &Value| (entry[0].as_u64().unwrap_or(0), entry[1].as_str().unwrap_or_default().to_owned());
    Peer {
        name: name.to_owned(),
        routine,
        length: value["length"].as_u64().unwrap_or(0) as usize,
        angles: value["angles"].as_array().into_iter().flatten().map(angle).collect(),
    }
}

/// Compiles the program of a mechanism, compares the numbers, counts and times.
fn measure(folders: &Folders, derivation: &Derivation<'_>, peers: &[Peer]) -> Result<Figures, Failure> {
    let package = format!("{}_times", derivation.package());
    eprintln!("timing {package}");
    harness::write(folders, &package, "module.rs", &derivation.module)?;
    harness::write(folders, &package, "main.rs", &program::main(derivation, peers))?;
    let library = folders.work.join("peer").join(&derivation.case.name);
    let build = folders.work.join("crates").join(&package).join("build.rs");
    std::fs::write(build, program::build(&library))?;
    let built = harness::cargo(folders, &package)?;
    agree(&built, derivation, peers)?;
    let names: Vec<String> = routines()
        .map(|(_, function)| function.to_owned())
        .chain(peers.iter().flat_map(|peer| [format!("own_{}", peer.name), format!("shared_{}", peer.name)]))
        .collect();
    let functions: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), name.as_str())).collect();
    let counted = count::of_functions(folders, &built, &functions)?;
    let instructions = counted.into_iter().map(|(name, count)| (name.to_owned(), count)).collect();
    let timed = output(Command::new(&built.program).arg("times"))?;
    let seconds = timed.lines().filter_map(|line| {
        let (name, time) = line.split_once(' ')?;
        Some((name.to_owned(), time.parse().ok()?))
    });
    Ok(Figures { instructions, seconds: seconds.collect() })
}

/// Holds the numbers of the peer to ours.
fn agree(built: &Built, derivation: &Derivation<'_>, peers: &[Peer]) -> Result<(), Failure> {
    let answers = output(Command::new(&built.program).arg("numbers"))?;
    let names = slopes::names(derivation)?;
    let mut lines = answers.lines();
    let mut next = || -> Vec<f64> {
        lines.next().unwrap_or("").split_whitespace().filter_map(|word| word.parse().ok()).collect()
    };
    for state in &derivation.states {
        let ours: Vec<Vec<f64>> = routines().map(|_| next()).collect();
        for peer in peers {
            let Some(at) = routines().position(|(routine, _)| routine == peer.routine) else {
                continue;
            };
            for trigonometry in ["own", "shared"] {
                let mut found = next();
                let mut ours = ours[at].clone();
                if peer.routine == "dFD" {
                    let of = |list: &Named| list.iter().map(|(name, _)| name.clone()).collect();
                    let theirs =
                        Names { coordinates: of(&state.q), speeds: of(&state.u), inputs: Vec::new() };
                    (found, ours) = (of_motions(&found, &theirs, state), of_motions(&ours, &names, state));
                }
                let off = |turn: usize| {
                    let expected = reordered(&ours, &peer.routine, &derivation.speeds, &state.u, turn);
                    let largest = expected.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
                    let errors = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
                    let error = errors.fold(0.0, f64::max) / largest;
                    if found.len() == expected.len() { error } else { f64::NAN }
                };
                let error = (0..TURNS.len()).map(off).fold(f64::INFINITY, f64::min);
                if !error.is_finite() || error > AGREEMENT {
                    let (package, name) = (derivation.package(), &peer.name);
                    return Err(Failure::new(format!("{package} {trigonometry}_{name}: off by {error:e}")));
                }
            }
        }
    }
    Ok(())
}

/// The turns of our contact basis about the normal N.z: of which row of ours each row of the peer is, and its
/// sign.
const TURNS: [([usize; 3], [f64; 3]); 4] = [
    ([0, 1, 2], [1.0, -1.0, 1.0]),
    ([0, 1, 2], [1.0, 1.0, -1.0]),
    ([0, 2, 1], [1.0, 1.0, 1.0]),
    ([0, 2, 1], [1.0, -1.0, -1.0]),
];

/// Values and their derivatives (by columns) with respect to all motions and all speeds, in the order of the
/// speeds of the state. A motion is what a speed does.
fn of_motions(numbers: &[f64], names: &Names, state: &State) -> Vec<f64> {
    let rows = names.speeds.len();
    let column = |at: usize| -> Vec<f64> {
        let column = numbers.get(rows * at..rows * (at + 1)).unwrap_or_default();
        let place = |name: &String| names.speeds.iter().position(|other| other == name);
        state.u.iter().map(|(name, _)| place(name).map_or(f64::NAN, |row| column[row])).collect()
    };
    let mut all = column(0);
    for (by, before) in [("q", 1), ("v", 1 + names.coordinates.len())] {
        for (speed, _) in &state.u {
            let mut sum = vec![0.0; rows];
            for (at, part) in slopes::column(names, state, speed, by) {
                sum.iter_mut().zip(column(before + at)).for_each(|(sum, entry)| *sum += part * entry);
            }
            all.extend(sum);
        }
    }
    all
}

/// Our numbers in the peer's order of the speeds; `turn` is how our contact basis lies.
fn reordered(ours: &[f64], routine: &str, speeds: &[String], peers: &Named, turn: usize) -> Vec<f64> {
    let place = |name: &String| speeds.iter().position(|other| other == name).unwrap_or(usize::MAX);
    let order: Vec<usize> = peers.iter().map(|(name, _)| place(name)).collect();
    let entry = |at: usize| ours.get(at).copied().unwrap_or(f64::NAN);
    let count = order.len();
    match routine {
        "FD" | "ID" => order.iter().map(|&at| entry(at)).collect(),
        // in this order already
        "dFD" => ours.to_vec(),
        "M, one triangle" => {
            let lower = |a: usize, b: usize| entry(a.max(b) * (a.max(b) + 1) / 2 + a.min(b));
            let of_row = |row: usize| order[..=row].iter().map(|&column| lower(order[row], column)).collect();
            (0..count).flat_map(|row| -> Vec<f64> { of_row(row) }).collect()
        }
        "M" => (0..count * count).map(|at| entry(order[at / count] * count + order[at % count])).collect(),
        _ => {
            // The peer's rows are along z, y, x; our second and third axis are those but for a quarter turn.
            let partial = |row: usize, column: usize| entry(row * count + order[column]);
            let (from, sign) = TURNS[turn];
            let partials = (0..3 * count).map(|at| sign[at / count] * partial(from[at / count], at % count));
            let matrix = |row: usize, column: usize| {
                let (row, column) = (row.min(column), row.max(column));
                entry(3 * count + [0, 3, 5][row] + column - row)
            };
            let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
            let reduced = pairs.map(|(a, b)| sign[a] * sign[b] * matrix(from[a], from[b]));
            partials.chain(reduced).collect()
        }
    }
}
