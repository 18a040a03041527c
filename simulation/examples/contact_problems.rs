//! Solves random problems of several contacts and prints how it went: `contact_problems [COUNT]`.

#[path = "../tests/contact_families/mod.rs"]
mod contact_families;

use std::time::Instant;

use contact_families::{FAMILIES, problem};
use hodograph_simulation::contact_problem::{Problem, enumerate, rest, solve};

fn main() {
    let count: u64 = std::env::args().nth(1).and_then(|count| count.parse().ok()).unwrap_or(100);
    println!("| family | contacts | problems | unsolved | greatest violation | rest | us |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for family in FAMILIES {
        for k in [1, 2, 3, 4, 6, 8, 12, 16, 24, 32] {
            if family == "stack" && k % 4 != 0 {
                continue;
            }
            let (mut many, mut none) = (0, 0);
            let (mut unsolved, mut worst, mut still) = (Vec::new(), 0.0_f64, 0);
            let begin = Instant::now();
            for seed in 0..count {
                let made = problem(family, k, seed);
                let problem =
                    Problem { w: &made.w, beta: &made.beta, mu: &made.mu, slip: &made.slip, noise: None };
                still += i32::from(rest(&problem).is_some());
                if k <= 3 {
                    many += usize::from(enumerate(&problem).len() > 1);
                    none += usize::from(enumerate(&problem).is_empty());
                }
                match solve(&problem, None) {
                    Ok(found) => worst = worst.max(found.certificate.greatest()),
                    Err(reason) => unsolved.push((seed, reason)),
                }
            }
            let time = begin.elapsed().as_secs_f64() * 1e6 / count as f64;
            println!(
                "| {family} | {k} | {count} | {} | {worst:.1e} | {still} | {many} {none} | {time:.0} |",
                unsolved.len()
            );
            for (seed, reason) in unsolved.iter().take(3) {
                println!("    seed {seed}: {reason}");
            }
        }
    }
}
