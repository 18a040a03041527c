//! Sets the flags of [`Sensitivity`]: the reasons why a small change of the input would change the outcome,
//! or its derivatives, by much.
//!
//! Theory: docs/theory.md, section 14.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    restitution::{Restitution, State},
    target::Watched,
};
use crate::{
    Sensitivity,
    scalar::{Arithmetic, Mask, Real, constant, length},
};

/// The bound below which a flag is set, of |mu / mu_c - 1|, of v_n over the speed of approach, and of an
/// angle in radians.
const NEAR: f64 = 1e-3;
/// The bound of f I_n2 over the speed of approach below which v_n hardly rises at the end of the collision.
const STEEP: f64 = 0.05;

impl Sensitivity {
    /// The flags that follow from the slip at the start.
    #[inline(always)]
    pub(super) fn of_start<T: Real>(contact: &Contact<T>, tangential: &Vector2<T>, slip: T) -> Self {
        if T::INLINED {
            Self::of_start_here(contact, tangential, slip)
        } else {
            Self::of_start_apart(contact, tangential, slip)
        }
    }

    #[inline(never)]
    fn of_start_apart<T: Real>(contact: &Contact<T>, tangential: &Vector2<T>, slip: T) -> Self {
        Self::of_start_here(contact, tangential, slip)
    }

    #[inline(always)]
    fn of_start_here<T: Real>(contact: &Contact<T>, tangential: &Vector2<T>, slip: T) -> Self {
        let (no_slip, unstable_direction) = starts(contact, &(tangential / slip), slip);
        Self { unstable_direction, no_slip, ..Self::default() }
    }

    /// Sets the flag of mu near mu_c, after slip has stopped.
    #[inline]
    pub(super) fn stopped<T: Real>(&mut self, mu: T, mu_c: T) {
        self.near_mu_c = (mu - mu_c).abs() < constant::<T>(NEAR) * mu_c;
    }

    /// Sets the flag of grazing at the end of the collision. `slides` is the tangential velocity there if
    /// slip has not stopped before.
    #[inline(always)]
    pub(super) fn ended<T: Real>(
        &mut self,
        contact: &Contact<T>,
        restitution: &mut Restitution<T>,
        end: &State<T>,
        slides: Option<&Vector2<T>>,
    ) {
        if T::INLINED {
            self.ended_here(contact, restitution, end, slides)
        } else {
            self.ended_apart(contact, restitution, end, slides)
        }
    }

    #[inline(never)]
    fn ended_apart<T: Real>(
        &mut self,
        contact: &Contact<T>,
        restitution: &mut Restitution<T>,
        end: &State<T>,
        slides: Option<&Vector2<T>>,
    ) {
        self.ended_here(contact, restitution, end, slides)
    }

    #[inline(always)]
    fn ended_here<T: Real>(
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
            && (restitution.watches(Watched::Velocity) || end.velocity <= near)
        {
            let slip = length(velocity);
            // f < 0: the bodies are about to approach again.
            let flat = slip - contact.mu * contact.b.dot(velocity);
            self.grazing = self.grazing || flat * end.normal < constant::<T>(STEEP) * slip;
        }
    }
}

/// Whether there is no slip at the start, or it has an unstable direction.
#[inline(always)]
pub(super) fn starts<T: Arithmetic>(
    contact: &Contact<T>,
    direction: &Vector2<T>,
    slip: T,
) -> (T::Mask, T::Mask) {
    let no_slip = (slip * slip).at_most(T::default_epsilon());
    (no_slip, no_slip.not().and(|| unstable(contact, direction)))
}

/// Whether a direction lies near an unstable zero of h.
#[inline(always)]
fn unstable<T: Arithmetic>(c: &Contact<T>, d: &Vector2<T>) -> T::Mask {
    let [_, g, h] = c.rates(d);
    // h' + g, the rate at which the velocity across the slip changes. Where it is zero nothing moves the
    // contact across the slip (planar systems), and a deviation stays as small as it is.
    let across = c.convergence(d);
    let slope = across - g;
    let noise = constant::<T>(64.0) * T::default_epsilon() * c.slip_size();
    let near = || h.abs().at_most(constant::<T>(NEAR) * slope);
    noise.below(slope).and(near).and(|| noise.below(-across))
}
