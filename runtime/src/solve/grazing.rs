//! Grazing: how near v_n turned to a value that ends compression or restitution. Where a turning point just reaches that value the outcome jumps.
//!
//! Theory: docs/theory.md, section 14.

use crate::scalar::Real;

/// The turning points of v_n so far, in units where v_n1 = -1.
#[derive(Clone, Copy)]
pub(crate) struct Grazing<T> {
    rising: bool,
    last: T,
    target: T,
    /// How near v_n turned to zero, or from above to Newton's target.
    pub nearest: T,
}

impl<T: Real> Grazing<T> {
    /// No turning point yet. `target` is that of Newton's law, or zero.
    #[inline]
    pub fn new(target: T) -> Self {
        Self { rising: true, last: -T::one(), target, nearest: T::one() }
    }

    /// None yet, and v_n falls from zero.
    #[inline]
    pub fn falling() -> Self {
        Self { rising: false, last: T::zero(), ..Self::new(T::zero()) }
    }

    /// v_n went to `to` without turning on the way.
    #[inline]
    pub fn moved(&mut self, to: T) {
        let from = self.last;
        self.last = to;
        if to == from || (to > from) == self.rising {
            return;
        }
        self.rising = to > from;
        let to_target = if self.rising { from.abs() } else { (from - self.target).abs() };
        self.missed(from.abs());
        self.missed(to_target);
    }

    /// An event took place, or did not, by this relative distance.
    #[inline]
    pub fn missed(&mut self, distance: T) {
        if distance < self.nearest {
            self.nearest = distance;
        }
    }
}
