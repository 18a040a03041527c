//! Other motions of contacts: of few by their modes, of many from other starts.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::DVector;

use super::{Problem, Solution, certified::attempt};

/// Accelerations that differ by more than this part of their terms are those of two motions.
const DIFFERS: f64 = 1e-8;
/// Starts for up to [`FEW`] contacts, and the least number for more, each of which takes longer.
const STARTS: usize = 24;
const FEW: usize = 12;
const LEAST: usize = 2;
/// The part of the contacts that a start has open, and the greatest factor of the normal forces of others.
const OPEN: f64 = 0.4;
const GREATEST: f64 = 3.0;

/// Whether forces that obey the laws and cause other accelerations than these were found. `false` does not mean that
/// there are none.
pub fn another(problem: &Problem<'_>, force: &DVector<f64>) -> bool {
    others(problem, force).next().is_some()
}

/// Solutions with other accelerations than these forces cause: found by the method for unknown modes, from starts in
/// which some contacts are open and others press and rub otherwise. One may appear again.
pub(super) fn others<'a>(
    problem: &'a Problem<'a>,
    force: &DVector<f64>,
) -> impl Iterator<Item = Solution> + 'a {
    let k = problem.contacts();
    let acceleration = problem.w * force + problem.beta;
    let terms = problem.beta.amax() + (problem.w.abs() * force.abs()).amax();
    let smooth = vec![0.0; k];
    let pressed = attempt(&Problem { mu: &smooth, ..*problem }, None);
    let pressed = pressed.map_or_else(|_| force.clone(), |found| found.force);
    let count = if k <= FEW { STARTS } else { (STARTS * FEW * FEW / (k * k)).max(LEAST) };
    let mut places = Places(0.0);
    (0..count).filter_map(move |_| {
        let mut start = DVector::zeros(3 * k);
        for i in 0..k {
            let (opens, size, angle, share) = (places.next(), places.next(), places.next(), places.next());
            if opens >= OPEN {
                let normal = GREATEST * size * pressed[3 * i];
                let (sin, cos) = (std::f64::consts::TAU * angle).sin_cos();
                let friction = problem.mu[i] * normal * share;
                // A contact in a plane of motion has no friction across it.
                let across = problem.w[(3 * i + 2, 3 * i + 2)] > 0.0;
                start[3 * i] = normal;
                start[3 * i + 1] = friction * if across { cos } else { cos.signum() };
                start[3 * i + 2] = if across { friction * sin } else { 0.0 };
            }
        }
        let found = attempt(problem, Some(&start)).ok()?;
        ((&found.acceleration - &acceleration).amax() > DIFFERS * terms).then_some(found)
    })
}

/// Numbers in [0, 1) that fill it evenly and repeat on every machine: multiples of the golden ratio.
struct Places(f64);

impl Places {
    fn next(&mut self) -> f64 {
        const RATIO: f64 = 0.618_033_988_749_894_9;
        self.0 = (self.0 + RATIO).fract();
        self.0
    }
}
