//! Instructions of contacts between shapes: generated modules beside the narrow phases of parry3d and MuJoCo, at the same
//! poses. A free body is at a random pose over a fixed one, at most a tenth of a metre away.
//!
//! What is counted of ours is the distances (and validities) of all contacts of the pair, in one pass from the
//! coordinates; and these with the whole contact (basis, velocity and reduced matrix) of the nearest. Of parry it is one
//! call of `query::contact`, which gives the nearest points and the normal, of MuJoCo one of `mj_collision` on two bodies
//! whose poses are known.

mod counts;
mod pairs;
mod parry;
mod poses;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use hodograph::{Contacts, Distance, State};
use poses::Pose;

/// What can go wrong: no valgrind, no compiler, no network, a model that has no numbers.
pub type Failure = Box<dyn std::error::Error>;

/// So many poses are counted.
const POSES: usize = 500;
/// The peer of which the library is taken from its package for Python.
const MUJOCO: &str = "mujoco==4.0.0";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [program, pair, poses] if ["ours", "whole", "parry"].contains(&program) => {
            run(program, pair, poses.as_ref())
        }
        ref asked => table(asked),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Counts all pairs, or those that are asked for.
fn table(asked: &[&str]) -> Result<(), Failure> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../target/narrow"));
    std::fs::create_dir_all(folder)?;
    let peer = peer(folder)?;
    println!(
        "instructions                 contacts   distances   + nearest     parry3d      MuJoCo   apart by"
    );
    for pair in pairs::PAIRS.iter().filter(|pair| asked.is_empty() || asked.contains(pair)) {
        let machine = pairs::machine(pair)?;
        let all = poses::of(pair, machine.as_ref(), POSES)?;
        let file = folder.join(format!("{pair}.txt"));
        std::fs::write(&file, poses::written(&all))?;
        let own = std::env::current_exe()?;
        let of_ours = |program: &str| {
            let arguments = [program.as_ref(), pair.as_ref(), file.as_os_str()];
            counts::of(&own, &arguments, "*narrow_counted*", folder)
        };
        let model = folder.join(format!("{pair}.xml"));
        std::fs::write(&model, pairs::peer_model(pair)?)?;
        let of_peer = counts::of(&peer, &[model.as_os_str(), file.as_os_str()], "narrow_collide", folder)?;
        let per_pose = |count: u64| count / POSES as u64;
        let of_parry = if parry::knows(pair) {
            format!("{:11}", per_pose(of_ours("parry")?))
        } else {
            format!("{:>11}", "-")
        };
        println!(
            "{pair:28} {:8} {:11} {:11} {of_parry} {:11}   {}",
            machine.count(hodograph::ComponentKind::Contact),
            per_pose(of_ours("ours")?),
            per_pose(of_ours("whole")?),
            per_pose(of_peer),
            difference(pair, machine.as_ref(), &all)?,
        );
    }
    Ok(())
}

/// The greatest and the median difference between the least gap and the distance that parry gives, m.
fn difference(pair: &str, machine: &dyn Contacts<f64>, poses: &[Pose]) -> Result<String, Failure> {
    if !parry::knows(pair) {
        return Ok("-".to_owned());
    }
    let shapes = parry::shapes(pair)?;
    let contacts: Vec<usize> = (0..machine.count(hodograph::ComponentKind::Contact)).collect();
    let mut distances = vec![Distance { gap: None, validity: None }; contacts.len()];
    let mut all = Vec::new();
    for pose in poses {
        let gap = narrow_counted(machine, &contacts, pose, &mut distances, false)?;
        all.push((gap - parry::narrow_counted(&shapes, pose)).abs());
    }
    all.sort_by(f64::total_cmp);
    Ok(format!("{:.0e}, median {:.0e}", all[all.len() - 1], all[all.len() / 2]))
}

/// Runs one program at the poses of a file; valgrind counts it.
fn run(program: &str, pair: &str, poses: &Path) -> Result<(), Failure> {
    let poses = poses::read(&std::fs::read_to_string(poses)?)?;
    let sum: f64 = match program {
        "parry" => {
            let shapes = parry::shapes(pair)?;
            poses.iter().map(|pose| parry::narrow_counted(&shapes, pose)).sum()
        }
        program => {
            let machine = pairs::machine(pair)?;
            let contacts: Vec<usize> = (0..machine.count(hodograph::ComponentKind::Contact)).collect();
            let mut distances = vec![Distance { gap: None, validity: None }; contacts.len()];
            let whole = program == "whole";
            let mut sum = 0.0;
            for pose in &poses {
                sum += narrow_counted(machine.as_ref(), &contacts, pose, &mut distances, whole)?;
            }
            sum
        }
    };
    println!("{sum:e}");
    Ok(())
}

/// The least gap of all contacts; with the whole contact that has it.
#[inline(never)]
fn narrow_counted(
    machine: &dyn Contacts<f64>,
    contacts: &[usize],
    pose: &Pose,
    distances: &mut [Distance<f64>],
    whole: bool,
) -> Result<f64, Failure> {
    let state = State { time: 0.0, coordinates: pose, speeds: &[0.1; 6], inputs: &[] };
    machine.gaps(contacts, &state, distances)?;
    let gap = |contact: &usize| distances[*contact].gap.unwrap_or(f64::INFINITY);
    let nearest = contacts.iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).ok_or("no contact")?;
    let mut sum = gap(nearest);
    if whole {
        sum += machine.contact_state(*nearest, &state)?.normal.x;
    }
    Ok(sum)
}

/// The program that calls MuJoCo, compiled against the library of its package for Python.
fn peer(folder: &Path) -> Result<PathBuf, Failure> {
    let environment = folder.join("../python");
    let python = environment.join("bin/python");
    if !python.exists() {
        eprintln!("fetching {MUJOCO}");
        counts::done(Command::new("python3").args(["-m", "venv"]).arg(&environment))?;
    }
    counts::done(Command::new(&python).args(["-m", "pip", "--quiet", "install", MUJOCO]))?;
    let ask = "import mujoco, os; print(os.path.dirname(mujoco.__file__))";
    let answer = Command::new(&python).args(["-c", ask]).output()?;
    let package = PathBuf::from(String::from_utf8(answer.stdout)?.trim());
    let program = folder.join("collide");
    let library = std::fs::read_dir(&package)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .find(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("libmujoco.so")))
        .ok_or("MuJoCo's package has no library")?;
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/peer/collide.c");
    let mut compile = Command::new("cc");
    compile.args(["-O2", "-o"]).arg(&program).arg(source).arg("-I").arg(package.join("include"));
    compile.arg(&library).arg(format!("-Wl,-rpath,{}", package.display()));
    counts::done(&mut compile)?;
    Ok(program)
}
