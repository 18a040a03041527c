//! How far forces are from the laws.
//!
//! Theory: docs/theory.md, section 17.10.

use super::scaled::{Scaled, three};
use crate::{
    Scalar,
    scalar::{constant, larger, smaller},
};

/// The greatest violation of each law over all contacts, relative to its terms: accelerations beside
/// sum |W_ij lambda_j| + |beta_i|, forces beside these over tr(W_ii) and beside the force itself. Terms count as at most
/// 0.01 eps^(-1/2) times the greatest beta (7e5 times in doubles): forces that only cancel each other leave nothing but
/// rounding of what beta asks for, and are no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
#[non_exhaustive]
pub struct Certificate<T> {
    /// -a_n where it is positive: bodies that approach each other; and what the rounding of great terms leaves unknown.
    pub approach: T,
    /// -lambda_n where it is positive: a contact that pulls.
    pub pull: T,
    /// The smaller one of lambda_n and a_n: a force at a contact that opens.
    pub complementarity: T,
    /// abs(lambda_tan) - mu lambda_n where it is positive: more friction than there is.
    pub cone: T,
    /// What friction lacks to be opposite to slip, or slip to be zero.
    pub friction: T,
}

impl<T: Scalar> Certificate<T> {
    /// No violation.
    pub(super) fn none() -> Self {
        let zero = T::zero();
        Self { approach: zero, pull: zero, complementarity: zero, cone: zero, friction: zero }
    }

    /// The greatest one.
    #[inline]
    pub fn greatest(&self) -> T {
        [self.pull, self.complementarity, self.cone, self.friction]
            .into_iter()
            .fold(self.approach, larger_or_nan)
    }
}

/// The larger one; what is not a number stays.
fn larger_or_nan<T: Scalar>(a: T, b: T) -> T {
    if !a.is_finite() || b <= a { a } else { b }
}

/// Terms count as at most this many times the greatest beta over eps^(1/2).
const MOST_TERMS: f64 = 0.01;

/// The certificate of forces `x` with accelerations `v` and their terms.
pub(super) fn certificate<T: Scalar>(
    scaled: &Scaled<'_, T>,
    x: &[T],
    v: &[T],
    terms: &[T],
) -> Certificate<T> {
    let zero = T::zero();
    let mut worst = Certificate::none();
    let free = scaled.beta.iter().fold(zero, |free, beta| larger(free, beta.abs()));
    // Without beta forces that cancel each other move nothing, whatever their size.
    let most = (!free.is_zero()).then(|| free * constant(MOST_TERMS) / T::default_epsilon().sqrt());
    let bounded = |terms: T| most.map_or(terms, |most| smaller(terms, most));
    for i in 0..scaled.contacts() {
        let (law, x, v, terms) = (scaled.law(i), three(x, i), three(v, i), three(terms, i));
        let terms = larger(terms.x, larger(terms.y, terms.z));
        let rate = bounded(terms);
        let force = rate + bounded(x.norm());
        if force.is_zero() {
            continue;
        }
        let note = |worst: &mut T, value: T| *worst = larger_or_nan(*worst, value);
        note(&mut worst.pull, -x.x / force);
        // Accelerations are known up to the rounding of their terms.
        if terms > rate {
            note(&mut worst.approach, T::default_epsilon() * terms / rate);
        }
        // Without terms there is no acceleration.
        if !rate.is_zero() {
            note(&mut worst.approach, -v.x / rate);
            note(&mut worst.complementarity, smaller(x.x / force, v.x / rate));
        }
        let most = law.mu * larger(x.x, zero);
        if let Some(d) = law.slip {
            let (t, s) = (x.y + most * d.x, x.z + most * d.y);
            note(&mut worst.friction, (t * t + s * s).sqrt() / force);
            continue;
        }
        let size = (x.y * x.y + x.z * x.z).sqrt();
        note(&mut worst.cone, (size - most) / force);
        // The natural map: the point of the disc next to x_tan - v_tan is x_tan.
        let (t, s) = (x.y - v.y, x.z - v.z);
        let length = (t * t + s * s).sqrt();
        let onto = if length > most { most / length } else { T::one() };
        let (t, s) = (x.y - t * onto, x.z - s * onto);
        note(&mut worst.friction, (t * t + s * s).sqrt() / force);
    }
    worst
}
