//! The program that valgrind executes for motions with contact: `motions NAME TOLERANCE SECONDS` follows one of those that
//! are compared with MuJoCo; without arguments it prints those that are counted.

use hodograph_benchmark_contact::{Failure, Motion, motions};

/// What is counted: a motion, the tolerance of its integration, and how far it is followed, s. Short ones, for valgrind
/// takes fifty times as long. The rimless wheel is missing: valgrind does not know an instruction of its routines.
const COUNTED: [(&str, &str, &str); 8] = [
    ("hopper", "1e-9", "1"),
    ("box", "1e-9", "0.9"),
    ("box", "1e-12", "0.9"),
    ("two cubes", "1e-9", "0.1"),
    ("three cubes", "1e-9", "0.1"),
    ("quadruped stands", "1e-9", "0.2"),
    ("quadruped trots", "1e-9", "0.3"),
    ("quadruped trots", "1e-12", "0.2"),
];

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [name, tolerance, seconds] = &words[..] else {
        COUNTED.iter().for_each(|(name, tolerance, seconds)| println!("{name},{tolerance},{seconds}"));
        return Ok(());
    };
    let motions = motions()?;
    let motion = motions.iter().find(|motion| motion.name == name).ok_or("there is no such motion")?;
    let events = follow(motion, tolerance.parse()?, seconds.parse()?)?;
    println!("{events} events");
    Ok(())
}

/// Follows a motion; what is counted is this function, by its name.
#[inline(never)]
fn follow(motion: &Motion, tolerance: f64, seconds: f64) -> Result<usize, Failure> {
    Ok(motion.run_until(tolerance, seconds)?.events)
}
