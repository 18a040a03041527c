//! The force that keeps a contact from slipping and from separating.
//!
//! Theory: docs/theory.md, section 17.1.

use nalgebra::{Vector2, Vector3};

use super::tangential::Closed;
use crate::scalar::{Real, constant, larger, length, smaller};

/// The force of a contact that sticks.
#[derive(Clone, Copy)]
pub(super) struct Stuck<T: Real> {
    pub force: Vector3<T>,
    /// mu lambda_n - |lambda_tan|
    pub cone: T,
    /// The rounding error of lambda_n and of `cone`.
    pub noise: T,
    pub unique: bool,
}

impl<T: Real> Stuck<T> {
    /// Whether the normal force is not negative and friction suffices.
    pub fn fits(&self) -> bool {
        self.force.x >= -self.noise && self.cone >= -self.noise
    }
}

/// The force that makes the acceleration of the contact zero; `None` where no force does.
pub(super) fn stuck<T: Real>(closed: &Closed<T>) -> Option<Stuck<T>> {
    let hold = closed.hold(&closed.b).x;
    let pull = closed.hold(&closed.tangential);
    let lost = T::default_epsilon().sqrt();
    if pull.left > lost {
        return None;
    }
    let pull = pull.x;
    let rate = closed.held_rate(&hold);
    let free = closed.normal - closed.b.dot(&pull);
    let eps = constant::<T>(16.0) * T::default_epsilon();
    if rate > T::zero() {
        let lambda = -free / rate;
        let tangential = -(pull + hold * lambda);
        let terms = (closed.normal.abs() + length(&closed.b) * length(&pull)) / rate;
        let noise = eps * (terms * (T::one() + length(&hold) + closed.mu) + length(&pull));
        return Some(Stuck {
            force: Vector3::new(lambda, tangential.x, tangential.y),
            cone: closed.mu * lambda - length(&tangential),
            noise,
            unique: true,
        });
    }
    // While the contact sticks, no normal force accelerates it: it is wedged. If its free acceleration is
    // consistent with that, it stays at rest under every force in the cone of friction.
    if free.abs() > lost * (closed.normal.abs() + length(&closed.b) * length(&pull)) {
        return None;
    }
    let lambda = wedged(closed.mu, &hold, &pull);
    let tangential = -(pull + hold * lambda);
    Some(Stuck {
        force: Vector3::new(lambda, tangential.x, tangential.y),
        cone: closed.mu * lambda - length(&tangential),
        noise: eps * (lambda * (T::one() + length(&hold) + closed.mu) + length(&pull)),
        unique: false,
    })
}

/// The normal force of the least force (lambda, -(pull + hold lambda)) in the cone of friction, or the one
/// nearest to it.
fn wedged<T: Real>(mu: T, hold: &Vector2<T>, pull: &Vector2<T>) -> T {
    let zero = T::zero();
    let couple = hold.dot(pull);
    let square = hold.dot(hold);
    let least = larger(zero, -couple / (T::one() + square));
    // The force lies in the cone where a lambda^2 - 2 b lambda - c >= 0.
    let (a, b, c) = (mu * mu - square, couple, pull.dot(pull));
    let outside = |x: T| a * x * x - (b + b) * x - c < zero;
    if !outside(least) {
        return least;
    }
    // b^2 + a c = mu^2 c - (hold x pull)^2; the terms of the left side cancel where there is little friction.
    let (held, across) = (mu * mu * c, hold.perp(pull) * hold.perp(pull));
    let disc = held - across;
    if disc <= constant::<T>(16.0) * T::default_epsilon() * (held + across) {
        // Friction suffices for no force or for one only: the force for which least is missing.
        return if a < zero { larger(zero, b / a) } else { least };
    }
    let root = disc.sqrt();
    let q = if b < zero { b - root } else { b + root };
    let first = if a.abs() > zero { q / a } else { zero };
    let second = if q.abs() > zero { -c / q } else { zero };
    let (low, high) = (smaller(first, second), larger(first, second));
    // The cone holds above the larger root if a > 0, and between the roots otherwise.
    if a > zero {
        larger(high, zero)
    } else if least < low {
        larger(low, zero)
    } else {
        larger(high, zero)
    }
}
