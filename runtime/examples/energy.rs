//! Searches for collisions that gain energy under Poisson's hypothesis, and measures by how much rounding
//! alone makes the work of collisions positive that gain none.
//!
//! `cargo run --release -p hodograph --example energy [STARTS] [COUNT]`: 40 000 starts of the search and 3000
//! collisions without loss, if nothing else is said.

use hodograph::nalgebra::{Matrix3, Vector3};
use hodograph::{Impact, Law, ReducedMatrix, Surface, solve};
use hodograph_random::Random;

/// A collision: nine entries of a B with M = B B^T, slip along t and s, the logarithm of mu, and e.
type Place = [f64; 13];

fn begin(random: &mut Random) -> Place {
    std::array::from_fn(|index| match index {
        9 | 10 => 2.0 * random.number(),
        11 => 1.5 * random.number(),
        12 => 0.5 + 0.5 * random.number(),
        _ => random.number(),
    })
}

fn collision(place: &Place) -> (ReducedMatrix<f64>, Vector3<f64>, f64, f64) {
    let b = Matrix3::from_column_slice(&place[..9]);
    let matrix = ReducedMatrix::from(b * b.transpose());
    (matrix, Vector3::new(-1.0, place[9], place[10]), place[11].exp(), place[12].clamp(0.0, 1.0))
}

/// (|I_n| (|v_n1| + |v_n2|) + ..) / 2, the terms of the work (23).
fn terms(hit: &Impact<f64>) -> f64 {
    0.5 * hit.impulse.abs().dot(&(hit.approach.abs() + hit.velocity.abs()))
}

/// The work under Poisson's hypothesis over its terms, and the normal work over what friction takes. Energy
/// is gained if the first is positive, or the second greater than one.
fn gains(place: &Place) -> Option<[f64; 2]> {
    let (matrix, approach, mu, e) = collision(place);
    let hit = solve(&matrix, &approach, &Surface { mu, e, law: Law::Poisson }).ok()?;
    let taken = hit.normal_work - hit.contact_work;
    // Where friction takes nothing, or nothing but rounding, the quotient has no digits.
    let quotient = if taken > 1e-6 * terms(&hit) { hit.normal_work / taken } else { f64::NEG_INFINITY };
    Some([hit.contact_work / terms(&hit), quotient])
}

/// What a search found.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// collisions solved
    pub solved: u64,
    /// the greatest work over its terms
    pub work: f64,
    /// the greatest normal work over what friction takes
    pub quotient: f64,
}

/// Climbs from random collisions, first towards more work, then towards more normal work for what friction
/// takes.
pub fn search(starts: u64) -> Found {
    let mut found = Found { solved: 0, work: f64::NEG_INFINITY, quotient: f64::NEG_INFINITY };
    let mut random = Random::new(35);
    for start in 0..starts {
        let aim = (start % 2) as usize;
        let mut at = begin(&mut random);
        let mut best = f64::NEG_INFINITY;
        let mut step = 0.5;
        for _ in 0..60 {
            let mut next = at;
            next.iter_mut().for_each(|x| *x += step * random.number());
            let Some(gain) = gains(&next) else { continue };
            found.solved += 1;
            found.work = found.work.max(gain[0]);
            found.quotient = found.quotient.max(gain[1]);
            if gain[aim] > best {
                (at, best) = (next, gain[aim]);
            } else {
                step *= 0.93;
            }
        }
    }
    found
}

/// Random collisions without friction for e = 1, which lose nothing, under a law: how many have a positive
/// work, how many are said to gain, and the greatest work in roundings of its terms.
pub fn lossless(count: u32, law: Law) -> (u32, u32, f64) {
    let mut random = Random::new(7);
    let (mut positive, mut gain, mut most) = (0, 0, 0.0_f64);
    for _ in 0..count {
        let (matrix, approach, ..) = collision(&begin(&mut random));
        let Ok(hit) = solve(&matrix, &approach, &Surface { mu: 0.0, e: 1.0, law }) else { continue };
        positive += u32::from(hit.contact_work > 0.0);
        gain += u32::from(hit.energy_gained().is_some());
        most = most.max(hit.contact_work / (f64::EPSILON * terms(&hit)));
    }
    (positive, gain, most)
}

#[allow(dead_code, reason = "a test includes this file")]
fn main() {
    let argument = |place: usize| std::env::args().nth(place).and_then(|text| text.parse().ok());
    let starts = argument(1).unwrap_or(40_000);
    let count = argument(2).unwrap_or(3000) as u32;
    for &law in Law::ALL {
        let (positive, gain, most) = lossless(count, law);
        print!("{count} collisions with mu = 0 and e = 1 under {}: the work of {positive} ", law.name());
        println!("is positive, at most {most:.1} roundings of its terms; {gain} gain energy");
    }
    let Found { solved, work, quotient } = search(starts);
    println!("{starts} starts, {solved} collisions under poisson: greatest work over its terms {work:.2e}");
    println!("greatest normal work over what friction takes {quotient:.6}");
}
