//! Throughput of many collisions: together ([`solve_each`]) over one by one ([`solve`]), in turns in one process and thread.
//! What counts is the ratio of the best turns. All bits of impulses and velocities are compared.

use std::hint::black_box;
use std::time::Instant;

use hodograph::lanes::solve_each;
use hodograph::{Impact, ImpactError, Law, ReducedMatrix, Surface, solve};
use nalgebra::{Matrix3, Vector3};

/// Collisions in a turn.
const ROWS: usize = 4096;
const TURNS: usize = 200;

type Collision = (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>);

/// A number between -1 and 1 that those of its neighbours do not tell (the finalizer of SplitMix64).
fn random(row: usize, index: usize) -> f64 {
    let mut bits = ((row * 64 + index + 1) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits ^ (bits >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
}

/// Random contacts of rank three, mu from 0 to 1.5, e from 0 to 1.
fn contact(row: usize, law: Law) -> Collision {
    let b = Matrix3::from_fn(|i, j| random(row, 3 * i + j));
    let approach = Vector3::new(-0.1 - random(row, 9).abs(), 2.0 * random(row, 10), 2.0 * random(row, 11));
    let (mu, e) = (1.5 * random(row, 12).abs(), random(row, 13).abs());
    (ReducedMatrix::from(b * b.transpose()), approach, Surface { mu, e, law })
}

/// The two sleds as in `sweeps/queries/billion.sql`: one reduced matrix, Newton's hypothesis, 100 coefficients of friction.
fn sleds(row: usize) -> Collision {
    let matrix = ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);
    let approach = Vector3::new(-0.9 - random(row, 0).abs(), 1.0 + random(row, 1), 0.5 * random(row, 2));
    (matrix, approach, Surface { mu: (row % 100) as f64 / 49.5, e: 0.8, law: Law::Newton })
}

/// Bits of impulse and velocity of separation, and whether there is an outcome.
fn bits(answer: Result<Impact<f64>, ImpactError<f64>>) -> [u64; 6] {
    let Ok(Impact { impulse, velocity, .. }) = answer else { return [0; 6] };
    [impulse.x, impulse.y, impulse.z, velocity.x, velocity.y, velocity.z].map(f64::to_bits)
}

fn compare(what: &str, collision: impl Fn(usize) -> Collision) {
    let collisions: Vec<Collision> = (0..ROWS).map(collision).collect();
    let mut best = [f64::INFINITY; 2];
    for _ in 0..TURNS {
        let mut answers = [vec![[0; 6]; ROWS], vec![[0; 6]; ROWS]];
        let [single, together] = &mut answers;
        let start = Instant::now();
        for (answer, (matrix, approach, surface)) in single.iter_mut().zip(black_box(&collisions)) {
            *answer = bits(solve(matrix, approach, surface));
        }
        best[0] = best[0].min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        let all = black_box(&collisions).iter().copied();
        solve_each(all, |row, answer| together[row] = bits(answer));
        best[1] = best[1].min(start.elapsed().as_secs_f64());
        assert_eq!(answers[0], answers[1], "{what}");
    }
    println!("{what}: throughput of all together over one by one: {:.2}", best[0] / best[1]);
}

fn main() {
    for &law in Law::ALL {
        compare(&format!("random contacts, {law:?}"), |row| contact(row, law));
    }
    compare("random contacts, all laws in turn", |row| contact(row, Law::ALL[row % Law::ALL.len()]));
    compare("the two sleds, Newton", sleds);
}
