//! Recursive summation (56) of the paper's example with the paper's unit of impulse, 1 N s: its steps, and
//! how far it is from the exact outcome, beside the agreement that section 6.1 of the paper states.
//!
//! `cargo run --release -p hodograph --example summation`

use std::fmt::Write;

use hodograph::methods::{Summation, sum};
use hodograph::{Impact, Law, ReducedMatrix, Surface, solve};
use nalgebra::Vector3;

/// Coefficient of friction, refinement, agreement as printed in percent.
const PRINTED: [(f64, u32, &str); 6] =
    [(0.6, 1, "96"), (1.1, 1, "70"), (1.6, 1, "70"), (0.6, 5, "98"), (1.1, 5, "90"), (1.6, 5, "90")];

/// What a summation gets wrong, in percent.
pub struct Error {
    /// the law of restitution
    pub law: Law,
    /// steps of the summation
    pub steps: u32,
    /// of v_n2
    pub v_n: f64,
    /// of the impulse, as a vector
    pub impulse: f64,
}

/// The errors under the three laws, for D = 1 / k N s.
pub fn errors(mu: f64, k: u32) -> Vec<Error> {
    let matrix = ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);
    let approach = Vector3::new(-0.946108022, 1.06306701, 0.0);
    let of = |&law: &Law| {
        let surface = Surface { mu, e: 0.8, law };
        let exact: Impact<f64> = solve(&matrix, &approach, &surface).ok()?;
        let found = sum(&matrix, &approach, &surface, &Summation { k, unit: Some(1.0) }).ok()?;
        let v_n = 100.0 * (found.impact.velocity.x / exact.velocity.x - 1.0).abs();
        let impulse = 100.0 * (found.impact.impulse - exact.impulse).norm() / exact.impulse.norm();
        Some(Error { law, steps: found.steps, v_n, impulse })
    };
    Law::ALL.iter().filter_map(of).collect()
}

/// The table of all errors.
pub fn table() -> String {
    let mut out =
        String::from("| mu | k | agreement, paper | steps: Newton, Poisson, Stronge | error of v_n2 ");
    out += "| error of the impulse |\n| --- | --- | --- | --- | --- | --- |\n";
    for (mu, k, printed) in PRINTED {
        let errors = errors(mu, k);
        let list = |of: &dyn Fn(&Error) -> String| errors.iter().map(of).collect::<Vec<_>>().join(", ");
        let steps = list(&|error| error.steps.to_string());
        let v_n = list(&|error| format!("{:.1} %", error.v_n));
        let impulse = list(&|error| format!("{:.1} %", error.impulse));
        let _ = writeln!(out, "| {mu} | {k} | {printed} % | {steps} | {v_n} | {impulse} |");
    }
    out
}

#[allow(dead_code, reason = "a test includes this file")]
fn main() {
    print!("{}", table());
}
