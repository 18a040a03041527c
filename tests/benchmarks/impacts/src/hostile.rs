//! Two thousand collisions, most of them chosen to be difficult, to find the greatest cost of one.

use hodograph::{Characteristics, Law, ReducedMatrix, Surface, rates};
use nalgebra::{Matrix3, Vector3};

use crate::Case;

/// A linear congruential generator (Knuth's constants), the upper 53 bits of which are used: the tables of
/// docs/benchmarks.md are of the collisions that it draws.
struct Random(u64);

impl Random {
    /// Between -1 and 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A place in a list of so many.
    fn pick(&mut self, count: usize) -> usize {
        ((0.5 * (self.next() + 1.0) * count as f64) as usize).min(count - 1)
    }

    /// Between two positive numbers, evenly in the logarithm.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(0.5 * (self.next() + 1.0))
    }
}

/// Random contacts of rank 1 to 3 and conditions to 1e16; slip that hardly is or is fast, along a root of h
/// or nearly, stopping nearly at mu_c; steep friction.
pub fn hostile() -> Vec<Case> {
    let mut random = Random(2012);
    let mut cases = Vec::new();
    while cases.len() < 2000 {
        let kind = random.pick(10);
        let scale = if kind == 1 { random.between(1e-8, 1.0) } else { 1.0 };
        let rank = if kind == 2 {
            2
        } else if kind == 3 {
            1
        } else {
            3
        };
        let b = Matrix3::from_fn(|_, j| {
            let entry = random.next() * if j == 2 { scale } else { 1.0 };
            if j < rank { entry } else { 0.0 }
        });
        let matrix = ReducedMatrix::from(b * b.transpose());
        let speeds = Vector3::from_fn(|_, _| 1.5 * random.next());
        let mut v = if rank < 3 { b * speeds } else { speeds };
        if v.x > 0.0 {
            v = -v;
        }
        let e = [0.0, 1.0, 0.5 + 0.5 * random.next()][random.pick(3)];
        let law = Law::ALL[random.pick(Law::ALL.len())];
        let mut mu = random.between(0.01, 5.0);
        let slip = match kind {
            4 => random.between(1e-12, 1e-2),
            5 => random.between(10.0, 1e6),
            _ => 1.0,
        };
        (v.y, v.z) = (slip * v.y, slip * v.z);
        match kind {
            6 => {
                mu = Characteristics::of(&matrix, 1.0).mu_c
                    * (1.0 + random.between(1e-12, 1e-1) * [-1.0, 1.0][random.pick(2)])
            }
            7 => mu = random.between(5.0, 1e4),
            8 => {
                let h = |phi: f64| rates(&matrix, mu, phi).z;
                let begin = 7.0 * random.next();
                let step = |k: i32| begin + 0.1 * f64::from(k);
                if let Some(k) = (0..64).find(|&k| (h(step(k)) > 0.0) != (h(step(k + 1)) > 0.0)) {
                    let (mut low, mut high) = (step(k), step(k + 1));
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        if (h(middle) > 0.0) == (h(low) > 0.0) { low = middle } else { high = middle }
                    }
                    let (sin, cos) = (low + random.between(1e-17, 1e-2)).sin_cos();
                    let speed = v.yz().norm();
                    (v.y, v.z) = (speed * cos, speed * sin);
                }
            }
            _ => {}
        }
        if v.x < -1e-2 && matrix.nn > 1e-3 && mu.is_finite() && mu > 0.0 {
            cases.push(Case::unanswered(matrix, v, Surface { mu, e, law }));
        }
    }
    cases
}
