//! The course of a collision over the normal impulse, dense enough to be drawn.
//!
//! Outcomes come from the exact solver; the arc of slip between them is integrated here, in the variable that keeps the
//! equations regular where slip ends (dI_n = s dtau), to more digits than a drawing shows.

use hodograph::{ReducedMatrix, Surface};
use nalgebra::{Vector2, Vector4};

use crate::surface::LAWS;

/// A moment of a collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// normal impulse so far, N s
    pub impulse: f64,
    /// v_n, v_t, v_s, m/s
    pub velocity: [f64; 3],
}

impl Moment {
    /// The speed of slip.
    pub fn slip(&self) -> f64 {
        self.velocity[1].hypot(self.velocity[2])
    }
}

/// A collision for one coefficient of friction.
#[derive(Clone, Debug)]
pub struct Trace {
    /// coefficient of friction
    pub mu: f64,
    /// from approach to the latest end
    pub moments: Vec<Moment>,
    /// where each law ends, in the order of [`LAWS`]; `None`: it has no outcome
    pub ends: [Option<Moment>; 3],
    /// why a law has no outcome
    pub failures: Vec<String>,
}

/// Bound on the number of moments.
const STEPS: usize = 20_000;

/// Follows a collision to the latest of its ends.
pub fn trace(m: &ReducedMatrix<f64>, approach: [f64; 3], mu: f64, e: f64) -> Trace {
    let mut failures = Vec::new();
    let ends = LAWS.map(|(name, law)| match hodograph::solve(m, &approach.into(), &Surface { mu, e, law }) {
        Ok(impact) => Some(Moment { impulse: impact.impulse.x, velocity: impact.velocity.into() }),
        Err(error) => {
            failures.push(format!("mu = {mu}, {name}: {error}"));
            None
        }
    });
    let last = ends.iter().flatten().copied().max_by(|a, b| a.impulse.total_cmp(&b.impulse));
    let moments = last.map_or(Vec::new(), |last| course(m, approach, mu, last));
    Trace { mu, moments, ends, failures }
}

fn course(m: &ReducedMatrix<f64>, approach: [f64; 3], mu: f64, last: Moment) -> Vec<Moment> {
    let b = Vector2::new(m.nt, m.ns);
    let rate = |y: &Vector4<f64>| {
        let v = Vector2::new(y[1], y[2]);
        let (s, friction) = (v.norm(), Vector2::new(m.tt * v.x + m.ts * v.y, m.ts * v.x + m.ss * v.y) * mu);
        let along = b * s - friction;
        Vector4::new(m.nn * s - mu * b.dot(&v), along.x, along.y, s)
    };
    let pace = b.norm() + mu * (m.tt + m.ss);
    let mut y = Vector4::new(approach[0], approach[1], approach[2], 0.0);
    let moment = |y: &Vector4<f64>| Moment { impulse: y[3], velocity: [y[0], y[1], y[2]] };
    let (start, mut moments) = (approach[1].hypot(approach[2]), vec![moment(&y)]);
    for _ in 0..STEPS {
        let slip = y[1].hypot(y[2]);
        if slip <= 1e-5 * start {
            break;
        }
        // Neither more than a small turn or change of slip, nor more than a pixel or two.
        let mut step = (last.impulse / (400.0 * slip)).min(0.05 / pace);
        let ends = y[3] + 1.000_001 * slip * step >= last.impulse;
        if ends {
            step = (last.impulse - y[3]) / slip;
        }
        let k1 = rate(&y);
        let k2 = rate(&(y + k1 * (step / 2.0)));
        let k3 = rate(&(y + k2 * (step / 2.0)));
        let k4 = rate(&(y + k3 * step));
        y += (k1 + (k2 + k3) * 2.0 + k4) * (step / 6.0);
        moments.push(moment(&y));
        if ends {
            break;
        }
    }
    // What follows the end of slip is a straight line.
    moments.push(last);
    moments
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two sleds of the paper.
    const M: [f64; 6] = [0.22510385, -0.10936656, -0.12575887, 0.23598633, -0.11584858, 0.27021211];
    const V: [f64; 3] = [-0.946108022, 1.06306701, 0.0];

    #[test]
    fn the_course_reaches_the_outcome() {
        for mu in [0.6, 1.1, 1.6] {
            let trace = trace(&M.into(), V, mu, 0.8);
            assert!(trace.failures.is_empty());
            let [.., before, last] = trace.moments[..] else { panic!("too short") };
            if mu == 0.6 {
                // Slip to the end: the integration arrives by itself.
                assert!((before.slip() - last.slip()).abs() < 1e-4);
                assert!((before.velocity[0] - last.velocity[0]).abs() < 1e-4);
            } else {
                assert!(before.slip() < 1e-4);
            }
            assert!(trace.moments.len() < 3000);
        }
    }
}
