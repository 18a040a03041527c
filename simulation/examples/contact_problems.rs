//! Solves random problems of several contacts and prints how it went:
//! `cargo run --release -p hodograph-simulation --example contact_problems [COUNT] [FAMILY] [MOST]`, MOST
//! greatest number of contacts.

#[path = "../tests/contact_families/mod.rs"]
mod contact_families;

use std::time::Instant;

use contact_families::{Contacts, FAMILIES, problem};
use hodograph::several::{Dense, NewtonSteps, Scaled, SeveralContacts, memory_of_several, solve_several};
use hodograph_simulation::contact_problem::{Problem, rest, solve};
use nalgebra::Matrix3;

/// Counts the steps of Newton's method.
struct Counted<'a> {
    inner: Dense<'a, f64>,
    steps: usize,
}

impl NewtonSteps<f64> for Counted<'_> {
    fn solve(
        &mut self,
        matrix: &Scaled<'_, f64>,
        blocks: &dyn Fn(usize) -> (Matrix3<f64>, Matrix3<f64>),
        alpha: f64,
        right: &mut [f64],
    ) -> bool {
        self.steps += 1;
        self.inner.solve(matrix, blocks, alpha, right)
    }
}

/// The steps of Newton's method from no forces, and the violation that it leaves; `None` where it does not end.
fn steps(made: &Contacts) -> (usize, Option<f64>) {
    let n = made.beta.len();
    let contacts = SeveralContacts {
        matrix: made.w.as_slice(),
        beta: made.beta.as_slice(),
        mu: &made.mu,
        slip: &made.slip,
    };
    let (mut memory, mut matrix) = (vec![0.0; memory_of_several(n / 3)], vec![0.0; n * n]);
    let (mut force, mut acceleration) = (vec![0.0; n], vec![0.0; n]);
    let mut counted = Counted { inner: Dense::new(&mut matrix), steps: 0 };
    let found = solve_several(&contacts, &mut force, &mut acceleration, &mut memory, &mut counted);
    (counted.steps, found.ok().map(|found| found.greatest()))
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let count: u64 = arguments.next().and_then(|count| count.parse().ok()).unwrap_or(100);
    let wanted = arguments.next();
    let most: usize = arguments.next().and_then(|most| most.parse().ok()).unwrap_or(32);
    println!(
        "| family | contacts | problems | unsolved | greatest violation | at rest | us | Newton alone: unsolved | violation | steps, median | most |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for family in FAMILIES.into_iter().filter(|family| wanted.as_ref().is_none_or(|wanted| wanted == family))
    {
        for k in [1, 2, 3, 4, 6, 8, 12, 16, 24, 32] {
            if k > most || (family == "stack" && k % 4 != 0) {
                continue;
            }
            let (mut unsolved, mut worst, mut still, mut micros) = (Vec::new(), 0.0_f64, 0, 0.0);
            let (mut counts, mut alone, mut left) = (Vec::new(), Vec::new(), 0.0_f64);
            for seed in 0..count {
                let made = problem(family, k, seed);
                let problem =
                    Problem { w: &made.w, beta: &made.beta, mu: &made.mu, slip: &made.slip, noise: None };
                still += i32::from(rest(&problem).is_some());
                let begin = Instant::now();
                match solve(&problem, None) {
                    Ok(found) => worst = worst.max(found.certificate.greatest()),
                    Err(reason) => unsolved.push((seed, reason)),
                }
                micros += begin.elapsed().as_secs_f64() * 1e6;
                let (steps, violation) = steps(&made);
                counts.push(steps);
                match violation {
                    Some(violation) => left = left.max(violation),
                    None => alone.push(seed),
                }
            }
            counts.sort_unstable();
            println!(
                "| {family} | {k} | {count} | {} | {worst:.1e} | {still} | {:.0} | {} | {left:.1e} | {} | {} |",
                unsolved.len(),
                micros / count as f64,
                alone.len(),
                counts[counts.len() / 2],
                counts[counts.len() - 1],
            );
            for (seed, reason) in unsolved.iter().take(5) {
                println!("    seed {seed}: {reason}");
            }
            if !alone.is_empty() {
                println!("    not by Newton's method alone: {:?}", &alone[..alone.len().min(5)]);
            }
        }
    }
}
