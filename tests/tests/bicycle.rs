//! The Whipple bicycle against the benchmark: J. P. Meijaard, J. M. Papadopoulos, A. Ruina and A. L. Schwab,
//! "Linearized dynamics equations for the balance and steer of a bicycle: a benchmark and review", Proc. R.
//! Soc. A 463 (2007), 1955-1982.
//!
//! There M x'' + v C1 x' + (g K0 + v^2 K2) x = 0 with x = (lean, steer).

use hodograph_models::whipple_bicycle::{Coordinates, Speeds, WhippleBicycle};
use nalgebra::{Matrix2, Matrix4};

const M: [[f64; 2]; 2] = [[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]];
const C1: [[f64; 2]; 2] = [[0.0, 33.86641391492494], [-0.85035641456978, 1.6854039739756]];
const K0: [[f64; 2]; 2] = [[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]];
const K2: [[f64; 2]; 2] = [[0.0, 76.59734589573222], [0.0, 2.65431523794604]];

/// The matrix of x' = A x for x = (lean, steer, their rates) at the forward speed v, as published.
fn published(v: f64) -> Matrix4<f64> {
    let of = |rows: [[f64; 2]; 2]| Matrix2::from_fn(|i, j| rows[i][j]);
    let inverse = of(M).try_inverse().expect("M is regular");
    let stiffness: Matrix2<f64> = -inverse * (of(K0) * 9.81 + of(K2) * (v * v));
    let damping: Matrix2<f64> = -inverse * of(C1) * v;
    let mut a = Matrix4::zeros();
    a.fixed_view_mut::<2, 2>(0, 2).copy_from(&Matrix2::identity());
    a.fixed_view_mut::<2, 2>(2, 0).copy_from(&stiffness);
    a.fixed_view_mut::<2, 2>(2, 2).copy_from(&damping);
    a
}

/// The same from the derived equations, linearised about straight upright running.
fn derived(v: f64) -> Matrix4<f64> {
    let bicycle = WhippleBicycle::<f64>::default();
    let upright = Coordinates { q1: 0.0, q2: 0.0, q5: 0.0, q4: 0.0 };
    let running = Speeds { u2: 0.0, u3: v / bicycle.parameters().WRrad, u5: 0.0 };
    let a = bicycle.linearise(&upright, &running).expect("a regular state").a;
    // The states are q1, q2, q5, u2, u3, u5: lean, steer and their rates are four of them.
    let of = [1, 2, 3, 5];
    Matrix4::from_fn(|i, j| a[(of[i], of[j])])
}

#[test]
fn linearisation_is_the_benchmark() {
    for speed in 0..=10 {
        let v = f64::from(speed);
        let (ours, theirs) = (derived(v), published(v));
        let off = (ours - theirs).abs().max() / theirs.abs().max();
        assert!(off < 1e-12, "at {v} m/s off by {off:e}:\n{ours}{theirs}");
    }
}

/// Eigenvalues at 5 m/s, where the bicycle balances itself: weave, capsize and castering.
#[test]
fn eigenvalues_at_five_metres_per_second() {
    let mut values: Vec<_> = derived(5.0).complex_eigenvalues().iter().copied().collect();
    values.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    let expected = [
        (-14.0783896927982, 0.0),
        (-0.775341882195845, -4.46486771378823),
        (-0.775341882195845, 4.46486771378823),
        (-0.322866429004087, 0.0),
    ];
    for (value, (re, im)) in values.iter().zip(expected) {
        assert!((value.re - re).abs() < 1e-7 && (value.im - im).abs() < 1e-7, "{value} {re} {im}");
    }
}
