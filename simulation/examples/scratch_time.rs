//! scratch
#[path = "../tests/contact_families/mod.rs"]
mod contact_families;
use contact_families::{Contacts, problem};
use hodograph_simulation::contact_problem::*;
use nalgebra::*;
use std::time::Instant;
fn main() {
    for (family, k) in [
        ("planted", 1),
        ("planted", 2),
        ("planted", 4),
        ("flat", 3),
        ("flat", 4),
        ("stack", 4),
        ("stack", 8),
        ("flat", 8),
        ("stack", 20),
        ("stack", 40),
    ] {
        let reps = if k > 10 { 20 } else { 2000 };
        let made = problem(family, k, 3);
        let k = made.mu.len();
        let calm = DVector::from_fn(3 * k, |row, _| {
            if family == "planted" {
                made.beta[row]
            } else if row % 3 == 0 && (family == "flat" || row < 12) {
                -9.81
            } else if row < 12 || family == "flat" {
                0.3
            } else {
                0.0
            }
        });
        let hard = DVector::from_fn(3 * k, |row, _| {
            calm[row] + if row % 3 == 1 && (row < 12 || family == "flat") { 30.0 } else { 0.0 }
        });
        let modes = vec![Mode::Stick; k];
        for (name, beta) in [("calm", calm), ("hard", hard)] {
            let made = Contacts { w: made.w.clone(), beta, mu: made.mu.clone(), slip: made.slip.clone() };
            let p = Problem { w: &made.w, beta: &made.beta, mu: &made.mu, slip: &made.slip, noise: None };
            let t = Instant::now();
            let mut margin = 0.0;
            let mut unique = false;
            for _ in 0..reps {
                if let Ok(f) = with_modes(&p, &modes) {
                    margin = f.margin;
                    unique = f.unique;
                }
            }
            let plain = t.elapsed().as_secs_f64() * 1e6 / reps as f64;
            let mut near = 0.0;
            if let Ok(f) = with_modes(&p, &modes) {
                let t = Instant::now();
                for _ in 0..reps {
                    let _ = with_modes_near(&p, &modes, Some(&f.force));
                }
                near = t.elapsed().as_secs_f64() * 1e6 / reps as f64;
            }
            println!(
                "{family} {k} {name}: {plain:.1} us near {near:.1} us margin {margin:.3e} unique {unique}"
            );
        }
    }
}
