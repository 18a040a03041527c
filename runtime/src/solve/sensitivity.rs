//! Finds why an outcome is sensitive to its input.
//!
//! Theory: docs/theory.md, section 14.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    restitution::{Restitution, State},
};
use crate::{
    Law, Sensitivity,
    scalar::{Real, constant, length},
};

/// How near is near: in |mu / mu_c - 1|, in v_n over the speed of approach, and in radians.
const NEAR: f64 = 1e-3;
/// The change of v_n, at the rate at the end and over the whole impulse, that a law needs to end a collision well.
const STEEP: f64 = 0.05;

impl Sensitivity {
    /// What the slip of approach alone tells.
    #[inline]
    pub(super) fn of_start<T: Real>(contact: &Contact<T>, tangential: &Vector2<T>, slip: T) -> Self {
        let no_slip = slip * slip <= T::default_epsilon();
        Self {
            unstable_direction: !no_slip && unstable(contact, &(tangential / slip)),
            no_slip,
            ..Self::default()
        }
    }

    /// Adds that slip stopped, and friction must reach mu_c = `mu_c` to hold the contact.
    #[inline]
    pub(super) fn stopped<T: Real>(&mut self, mu: T, mu_c: T) {
        self.near_mu_c = (mu - mu_c).abs() < constant::<T>(NEAR) * mu_c;
    }

    /// Adds what the end of the collision tells; `slides` with that velocity, if it slides from before.
    #[inline]
    pub(super) fn ended<T: Real>(
        &mut self,
        contact: &Contact<T>,
        restitution: &mut Restitution<T>,
        end: &State<T>,
        slides: Option<&Vector2<T>>,
    ) {
        let near = constant::<T>(NEAR);
        restitution.grazing.moved(end.velocity);
        self.grazing = restitution.grazing.nearest <= near;
        if let Some(velocity) = slides
            && (restitution.law() == Law::Newton || end.velocity <= near)
        {
            let slip = length(velocity);
            // f < 0: the bodies are about to approach again.
            let flat = slip - contact.mu * contact.b.dot(velocity);
            self.grazing = self.grazing || flat * end.normal < constant::<T>(STEEP) * slip;
        }
    }
}

/// Whether a direction lies near a root of h that repels.
#[inline]
fn unstable<T: Real>(c: &Contact<T>, d: &Vector2<T>) -> bool {
    let [_, g, h] = c.rates(d);
    // h'
    let slope = c.convergence(d) - g;
    let noise = constant::<T>(64.0) * T::default_epsilon() * c.slip_size();
    slope > noise && h.abs() <= constant::<T>(NEAR) * slope
}
