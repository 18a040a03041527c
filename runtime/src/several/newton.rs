//! A semismooth Newton method on the equations of Alart and Curnier, with line search and regularised steps.
//!
//! Theory: docs/theory.md, section 17.10.

use super::{
    dense::NewtonSteps,
    law::{derivative, residual},
    scaled::{Scaled, three},
};
use crate::{
    Scalar,
    scalar::{constant, larger, smaller},
};

/// Vectors of 3 k numbers that the method works in.
pub(super) struct Vectors<'a, T> {
    /// x
    pub x: &'a mut [T],
    /// v = W x + beta + alpha (x - centre)
    pub v: &'a mut [T],
    /// F
    pub f: &'a mut [T],
    pub trial: &'a mut [T],
    pub trial_v: &'a mut [T],
    pub step: &'a mut [T],
    pub centre: &'a mut [T],
    /// The best forces so far.
    pub best: &'a mut [T],
}

/// How a run of the method is made.
#[derive(Clone, Copy)]
pub(super) struct Run<T> {
    /// the parameter of Alart and Curnier's equations
    pub rho: T,
    /// the weight of the proximal term alpha (x - centre)
    pub alpha: T,
    pub steps: usize,
    /// residual at which it ends
    pub enough: T,
}

/// Sets v and F of x and returns the norm of F.
fn evaluate<T: Scalar>(
    scaled: &Scaled<'_, T>,
    run: &Run<T>,
    x: &[T],
    centre: &[T],
    v: &mut [T],
    f: &mut [T],
) -> T {
    scaled.rates(x, v);
    if !run.alpha.is_zero() {
        for ((v, x), centre) in v.iter_mut().zip(x).zip(centre) {
            *v += run.alpha * (*x - *centre);
        }
    }
    let mut sum = T::zero();
    for (i, f) in f.chunks_exact_mut(3).enumerate() {
        let value = residual(&scaled.law(i), run.rho, &three(x, i), &three(v, i));
        f.copy_from_slice(value.as_slice());
        sum += value.norm_squared();
    }
    sum.sqrt()
}

/// Follows Newton's steps from x; the norm of F where it ends.
pub(super) fn newton<T: Scalar, S: NewtonSteps<T>>(
    scaled: &Scaled<'_, T>,
    run: &Run<T>,
    vectors: &mut Vectors<'_, T>,
    steps: &mut S,
) -> T {
    let Vectors { x, v, f, trial, trial_v, step, centre, .. } = vectors;
    let mut size = evaluate(scaled, run, x, centre, v, f);
    let mut wild = 0;
    let settled = larger(constant(1e-9), constant::<T>(64.0) * T::default_epsilon());
    let (mut least, mut since) = (size, 0);
    let mut damped = constant::<T>(1e-2);
    for _ in 0..run.steps {
        if !size.is_finite() || size <= run.enough {
            break;
        }
        for (step, f) in step.iter_mut().zip(f.iter()) {
            *step = -*f;
        }
        // Regularised by a part of the residual, so that steps stay bounded where the matrix is singular and
        // convergence stays fast; by less of it after whole steps, which forces far greater than others need.
        let damping = larger(constant(1e-8), constant::<T>(8.0) * T::default_epsilon())
            + smaller(constant(1e-2), size * damped);
        let blocks = |i: usize| derivative(&scaled.law(i), run.rho, &three(x, i), &three(v, i));
        let mut solved = steps.solve(scaled, &blocks, run.alpha + damping, step);
        if !solved {
            for (step, f) in step.iter_mut().zip(f.iter()) {
                *step = -*f;
            }
            solved = steps.solve(scaled, &blocks, run.alpha + constant(1e-3), step);
        }
        if !solved {
            break;
        }
        let mut part = T::one();
        let (mut best, mut best_part) = (size, T::zero());
        for _ in 0..LINE {
            for ((trial, x), step) in trial.iter_mut().zip(x.iter()).zip(step.iter()) {
                *trial = *x + part * *step;
            }
            let there = evaluate(scaled, run, trial, centre, trial_v, f);
            if there < best {
                (best, best_part) = (there, part);
            }
            if there < size * (T::one() - constant::<T>(1e-4) * part) {
                break;
            }
            part *= constant(0.5);
        }
        damped = if best_part == T::one() {
            larger(damped * constant(0.1), constant(1e-8))
        } else {
            smaller(damped * constant(10.0), constant(1e-2))
        };
        let stalled = since > PATIENCE;
        if stalled {
            (least, since) = (size, 0);
        }
        if best_part.is_zero() || stalled {
            // The norm is not smooth: a few steps are taken although it rises.
            wild += 1;
            if wild > WILD || size <= settled {
                break;
            }
            best_part = if wild % 2 == 1 { T::one() } else { constant(0.1) };
        }
        for (x, step) in x.iter_mut().zip(step.iter()) {
            *x += best_part * *step;
        }
        size = evaluate(scaled, run, x, centre, v, f);
        since += 1;
        if size < least * constant(0.9) {
            (least, since) = (size, 0);
        }
    }
    size
}

/// Halvings in a line search.
const LINE: usize = 12;

/// Steps in which the norm of F rises.
const WILD: usize = 4;

/// Steps in which the norm falls by less than a tenth, after which a whole one is taken.
const PATIENCE: usize = 12;
