//! The solver in other numbers than `f64`: single precision, and dual numbers of the crate `num-dual`.

use crate::common::reference_cases;
use hodograph::{ReducedMatrix, Surface, solve};
use nalgebra::{Const, Vector3};
use num_dual::{Derivative, DualSVec};

#[test]
fn single_precision_is_good_to_1e5() {
    let mut worst: f64 = 0.0;
    let mut count = 0;
    for case in reference_cases() {
        let inexact = case.family == "near_mu_c" || case.family == "straight";
        if case.condition > 30.0 || inexact {
            continue;
        }
        let m = <[f64; 6]>::from(case.matrix).map(|x| x as f32);
        let surface = Surface { mu: case.surface.mu as f32, e: case.surface.e as f32, law: case.surface.law };
        let hit = solve(&ReducedMatrix::from(m), &case.approach.cast::<f32>(), &surface)
            .unwrap_or_else(|e| panic!("{e}: {}", case.line));
        let impulse = (hit.impulse.cast::<f64>() - case.impulse).amax() / case.impulse.amax();
        let velocity = (hit.velocity.cast::<f64>() - case.velocity).amax()
            / (case.velocity.amax() + case.approach.amax());
        let error = impulse.max(velocity);
        // What rounding the input alone may do.
        let bound = 1e-5_f64.max(case.condition * 4.0 * f64::from(f32::EPSILON));
        assert!(error <= bound, "{error:e}: {}", case.line);
        worst = worst.max(error);
        count += 1;
    }
    println!("{count} cases, worst {worst:e}");
    assert_eq!(count, 92);
}

type Number = DualSVec<f64, 11>;

fn input(value: f64, index: usize) -> Number {
    Number::new(value, Derivative::derivative_generic(Const::<11>, Const::<1>, index))
}

/// Against the derivative of the runtime: two kinds of dual numbers through one solver.
#[test]
fn num_dual_gives_the_same_derivative() {
    let mut count = 0;
    let mut worst: f64 = 0.0;
    for case in reference_cases() {
        let direct = hodograph::derivative(&case.matrix, &case.approach, &case.surface).expect("solved");
        if direct.non_smoothness.is_some() || case.condition > 1e3 || case.surface.e == 0.0 {
            continue;
        }
        let [nn, nt, ns, tt, ts, ss] = <[f64; 6]>::from(case.matrix);
        let m = ReducedMatrix::new(
            input(nn, 3),
            input(nt, 4),
            input(ns, 5),
            input(tt, 6),
            input(ts, 7),
            input(ss, 8),
        );
        let v = case.approach;
        let v = Vector3::new(input(v.x, 0), input(v.y, 1), input(v.z, 2));
        let surface =
            Surface { mu: input(case.surface.mu, 9), e: input(case.surface.e, 10), law: case.surface.law };
        let hit = solve(&m, &v, &surface).expect("solved");
        for row in 0..3 {
            for column in 0..11 {
                let pairs = [
                    (hit.impulse[row], direct.impulse.row(row).amax(), direct.impulse[(row, column)]),
                    (hit.velocity[row], direct.velocity.row(row).amax(), direct.velocity[(row, column)]),
                ];
                for (number, scale, partial) in pairs {
                    let other = number.eps.unwrap_generic(Const::<11>, Const::<1>)[column];
                    let error = (other - partial).abs() / (1.0 + scale);
                    // With next to no slip its direction is known to that many digits less.
                    let slip = case.approach.yz().norm() / case.approach.x.abs();
                    assert!(
                        error <= 1e-10_f64.max(1e-14 / slip),
                        "{row} {column}: {other} {partial}: {}",
                        case.line
                    );
                    worst = worst.max(error * slip.min(1.0));
                }
            }
        }
        count += 1;
    }
    println!("{count} cases, worst {worst:e}");
    assert_eq!(count, 91);
}
