//! Samples a collision over the normal impulse, densely enough for a curve.

use hodograph::{Hodograph, Law, ReducedMatrix, Surface, phi_bar};

/// A sample of a collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// normal impulse so far, N s
    pub impulse: f64,
    /// v_n, v_t, v_s, m/s
    pub velocity: [f64; 3],
}

impl Sample {
    /// The speed of slip.
    pub fn slip(&self) -> f64 {
        self.velocity[1].hypot(self.velocity[2])
    }
}

impl From<hodograph::Snapshot<f64>> for Sample {
    fn from(snapshot: hodograph::Snapshot<f64>) -> Self {
        Sample { impulse: snapshot.impulse.x, velocity: snapshot.velocity.into() }
    }
}

/// A collision for one coefficient of friction.
#[derive(Clone, Debug)]
pub struct Trace {
    /// coefficient of friction
    pub mu: f64,
    /// from the approach to the latest end
    pub samples: Vec<Sample>,
    /// the end by each law, in the order of [`Law::ALL`]; `None` if it has no outcome
    pub ends: Vec<Option<Sample>>,
    /// the direction in which slip stops, if it stops by itself, rad
    pub phi_bar: Option<f64>,
    /// why a law has no outcome
    pub failures: Vec<String>,
}

/// Number of samples while slip lasts, or of the whole collision if slip does not stop.
const SAMPLES: usize = 400;

/// Samples a collision up to the latest of its ends.
pub fn trace(m: &ReducedMatrix<f64>, approach: [f64; 3], mu: f64, e: f64) -> Trace {
    let mut failures = Vec::new();
    let mut ends = vec![None; Law::ALL.len()];
    let mut longest: Option<Hodograph<f64>> = None;
    for (&law, end) in Law::ALL.iter().zip(&mut ends) {
        match Hodograph::new(m, &approach.into(), &Surface { mu, e, law }) {
            Ok(hodograph) => {
                *end = Some(hodograph.at(hodograph.normal_impulse()).into());
                if longest.is_none_or(|longest| longest.normal_impulse() < hodograph.normal_impulse()) {
                    longest = Some(hodograph);
                }
            }
            Err(error) => failures.push(format!("mu = {mu}, {}: {error}", law.name())),
        }
    }
    let samples = longest.as_ref().map_or(Vec::new(), course);
    let [_, v_t, v_s] = approach;
    let slips = !samples.is_empty() && (v_t != 0.0 || v_s != 0.0);
    let phi_bar = slips.then(|| phi_bar(m, mu, v_s.atan2(v_t))).flatten();
    Trace { mu, samples, ends, phi_bar, failures }
}

fn course(hodograph: &Hodograph<f64>) -> Vec<Sample> {
    let all = hodograph.normal_impulse();
    let stop = hodograph.impact().phases.slip_end.map_or(all, |sample| sample.impulse.x);
    // Slip turns most shortly before it stops, so the steps decrease towards there. After that the curve is a
    // straight line.
    let arc = (0..=SAMPLES).map(|index| {
        let left = 1.0 - index as f64 / SAMPLES as f64;
        hodograph.at(stop * (1.0 - left * left))
    });
    let mut samples: Vec<Sample> = arc.map(Sample::from).collect();
    if stop < all {
        samples.push(hodograph.at(all).into());
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two sleds of the paper.
    const M: [f64; 6] = [0.22510385, -0.10936656, -0.12575887, 0.23598633, -0.11584858, 0.27021211];
    const V: [f64; 3] = [-0.946108022, 1.06306701, 0.0];

    #[test]
    fn the_course_leads_from_the_approach_to_the_last_outcome() {
        for mu in [0.6, 1.1, 1.6] {
            let trace = trace(&M.into(), V, mu, 0.8);
            assert!(trace.failures.is_empty());
            assert_eq!(trace.samples[0].velocity, V);
            assert_eq!(trace.samples.last(), trace.ends[0].as_ref(), "Newton's is the longest");
            assert!(trace.samples.windows(2).all(|pair| pair[0].impulse < pair[1].impulse));
            // Slip stops along phi_bar: the last points before lie in its direction (paper: 0.432, 0.598).
            let near = trace.samples.iter().rev().find(|sample| sample.slip() > 0.0 && sample.slip() < 1e-4);
            if let (Some(phi), Some(near)) = (trace.phi_bar.filter(|_| mu > 1.3), near) {
                assert!((near.velocity[2].atan2(near.velocity[1]) - phi).abs() < 1e-2, "{phi}");
            }
            assert_eq!(trace.phi_bar.is_some(), mu > 1.0);
            // Slip stops in these cases only.
            assert_eq!(trace.samples.iter().any(|sample| sample.slip() == 0.0), mu > 1.0);
            // There are no false corners: consecutive points are close.
            assert!(
                trace
                    .samples
                    .windows(2)
                    .take(SAMPLES)
                    .all(|pair| (0..3).all(|i| (pair[0].velocity[i] - pair[1].velocity[i]).abs() < 0.02))
            );
        }
    }
}
