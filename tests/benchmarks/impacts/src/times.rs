//! Time of the exact solver over that of every other method, measured in one process.
//!
//! Turns of all methods alternate, so that whatever slows the machine meets all of them, and the best turn of
//! each counts.

use std::hint::black_box;
use std::time::{Duration, Instant};

use crate::{Case, METHODS, Method, set};

/// Turns of each method.
const TURNS: u32 = 60;

/// About how long a turn lasts: short beside the intervals in which a system interrupts.
const TURN: Duration = Duration::from_micros(500);

/// Prints the time of the exact solver over that of every other method, for each set a column.
pub fn print(sets: &[&str]) {
    let columns: Vec<Vec<f64>> = sets.iter().map(|name| best(&set(name))).collect();
    println!("| method | {} |", sets.join(" | "));
    println!("| --- |{}", " --- |".repeat(sets.len()));
    for (index, (label, ..)) in METHODS.iter().enumerate().skip(1) {
        let ratios = columns.iter().filter_map(|times| Some(times.first()? / times.get(index)?));
        let ratios: String = ratios.map(|ratio| format!(" {ratio:.2} |")).collect();
        println!("| {label} |{ratios}");
    }
}

/// The best time of each method for one run over the collisions, in seconds.
fn best(cases: &[Case]) -> Vec<f64> {
    let rounds: Vec<u32> = METHODS.iter().map(|method| rounds(method, cases)).collect();
    let mut times = vec![f64::INFINITY; METHODS.len()];
    for _ in 0..TURNS {
        for ((method, rounds), least) in METHODS.iter().zip(&rounds).zip(&mut times) {
            *least = least.min(turn(method, cases, *rounds).as_secs_f64() / f64::from(*rounds));
        }
    }
    times
}

/// How many runs over the collisions make a turn.
fn rounds(method: &Method, cases: &[Case]) -> u32 {
    let mut rounds = 1;
    while rounds < 1 << 16 && turn(method, cases, rounds) < TURN {
        rounds *= 2;
    }
    rounds
}

fn turn((_, _, method): &Method, cases: &[Case], rounds: u32) -> Duration {
    let start = Instant::now();
    for _ in 0..rounds {
        for case in cases {
            let _ = black_box(method(black_box(case)));
        }
    }
    start.elapsed()
}
