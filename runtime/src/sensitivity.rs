//! Where a small change of the input changes the outcome, or its path, by much.
//!
//! Theory: docs/theory.md, section 14.

use nalgebra::Vector2;

use crate::{
    scalar::{Real, constant, length},
    solve::{Contact, Restitution, State},
};

/// How near is near: in |mu / mu_c - 1|, in v_n over the speed of approach, and in radians.
const NEAR: f64 = 1e-3;
/// The change of v_n, at the rate at the end and over the whole impulse, that a law needs to end a collision well.
const STEEP: f64 = 0.05;

/// Why an outcome is sensitive to its input. None of these is an error: the outcome is right for the input given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Sensitivity {
    /// Slip stopped (or there was none), and mu is within 0.1 % of mu_c: the outcome is continuous there, but its derivatives and its path are not.
    pub near_mu_c: bool,
    /// v_n turned, or was about to, within 0.1 % of the speed of approach from where compression ends, begins again, or the law ends the
    /// collision: beyond that the outcome jumps.
    pub grazing: bool,
    /// The slip of approach lies within 0.001 rad of a direction from which it turns away to either side (h = 0, h' > 0).
    pub unstable_direction: bool,
    /// There was no slip at the start, or so little (below the root of the rounding unit, over the speed of approach) that its direction means
    /// nothing.
    pub no_slip: bool,
    /// An impact without collision began where f is zero but for rounding: dynamic jam. With a little more of f nothing happens.
    pub jam: bool,
}

impl Sensitivity {
    /// Whether there is a reason at all.
    #[inline]
    pub const fn any(self) -> bool {
        self.near_mu_c || self.grazing || self.unstable_direction || self.no_slip || self.jam
    }

    /// The names of the flags that are set.
    #[inline]
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let Self { near_mu_c, grazing, unstable_direction, no_slip, jam } = self;
        let flags = [
            (near_mu_c, "near_mu_c"),
            (grazing, "grazing"),
            (unstable_direction, "unstable_direction"),
            (no_slip, "no_slip"),
            (jam, "jam"),
        ];
        flags.into_iter().filter_map(|(set, name)| set.then_some(name))
    }

    /// What the slip of approach alone tells.
    #[inline]
    pub(crate) fn of_start<T: Real>(contact: &Contact<T>, tangential: &Vector2<T>, slip: T) -> Self {
        let no_slip = slip * slip <= T::default_epsilon();
        Self {
            unstable_direction: !no_slip && unstable(contact, &(tangential / slip)),
            no_slip,
            ..Self::default()
        }
    }

    /// Adds that slip stopped, and friction must reach mu_c = `mu_c` to hold the contact.
    #[inline]
    pub(crate) fn stopped<T: Real>(&mut self, mu: T, mu_c: T) {
        self.near_mu_c = (mu - mu_c).abs() < constant::<T>(NEAR) * mu_c;
    }

    /// Adds what the end of the collision tells; `slides` with that velocity, if it slides from before.
    #[inline]
    pub(crate) fn ended<T: Real>(
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
            && (restitution.law() == crate::Law::Newton || end.velocity <= near)
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
