//! Finds all directions in which slip of a contact at rest may begin.
//!
//! Slip begins in the direction of the acceleration: (b - mu T d) lambda_n + beta_tan = gamma d with gamma >
//! 0, and without normal acceleration. Eliminating lambda_n gives d' . (c + mu S d) = 0 with c = beta_tan -
//! beta_n b and S = beta_n T - beta_tan b^T (in units where m_nn = 1), a quartic in the tangent of
//! half the angle.
//!
//! Theory: docs/theory.md, section 17.2.

use nalgebra::Vector2;

use super::{roots::zeros, tangential::Closed};
use crate::{
    scalar::{Real, constant, length},
    tangential_block::TangentialBlock,
};

/// A way to begin to slip.
#[derive(Clone, Copy)]
pub(super) struct Beginning<T: Real> {
    pub direction: Vector2<T>,
    pub lambda: T,
    pub f: T,
}

/// At most so many: the quartic has four zeros.
pub(super) const MOST: usize = 4;

/// All ways in which slip may begin. `wedged` says that the force of sticking is not unique; directions
/// without acceleration are then recognised with a wider tolerance.
pub(super) fn beginnings<T: Real>(closed: &Closed<T>, wedged: bool) -> [Option<Beginning<T>>; MOST] {
    let mut found = [None; MOST];
    let mut count = 0;
    let Closed { mu, b, block: TangentialBlock { tt, ts, ss }, normal, tangential, .. } = *closed;
    let c = tangential - b * normal;
    let (s11, s12) = (normal * tt - tangential.x * b.x, normal * ts - tangential.x * b.y);
    let (s21, s22) = (normal * ts - tangential.y * b.x, normal * ss - tangential.y * b.y);
    // Relative to the terms of c and S: for a wedged contact these cancel to rounding.
    let (pull, couple) = (length(&tangential), length(&b));
    let size = pull + normal.abs() * couple + mu * (normal.abs() * (tt + ss) + pull * couple);
    let few = if wedged { constant::<T>(4096.0) } else { constant(64.0) };
    let noise = few * T::default_epsilon() * size;
    let two = constant::<T>(2.0);
    // The half of the circle about t, then the half about -t.
    for side in [T::one(), -T::one()] {
        let (c1, c2) = (c.x * side, c.y * side);
        let difference = two * mu * (s22 - s11);
        let quartic = [
            c2 + mu * s21,
            difference - two * c1,
            -two * mu * (s21 + s12 + s12),
            -difference - two * c1,
            mu * s21 - c2,
        ];
        for x in zeros(&quartic).iter() {
            let square = x * x;
            let inverse = side / (T::one() + square);
            let d = Vector2::new((T::one() - square) * inverse, (x + x) * inverse);
            let rate = Vector2::new(c.x + mu * (s11 * d.x + s12 * d.y), c.y + mu * (s21 * d.x + s22 * d.y));
            let f = closed.f(&d);
            let along = rate.dot(&d);
            if along.abs() <= noise || f.abs() <= closed.f_noise() {
                continue;
            }
            let (lambda, gamma) = (-normal / f, along / f);
            let known = found
                .iter()
                .flatten()
                .any(|other: &Beginning<T>| length(&(other.direction - d)) <= T::default_epsilon().sqrt());
            if lambda >= T::zero()
                && gamma > T::zero()
                && !known
                && let Some(slot) = found.get_mut(count)
            {
                *slot = Some(Beginning { direction: d, lambda, f });
                count += 1;
            }
        }
    }
    found
}
