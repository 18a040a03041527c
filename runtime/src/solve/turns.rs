//! Where v_n turned during a collision: outcomes jump where a turning point only just reaches what ends compression or restitution.

use crate::scalar::Real;

/// The turning points of v_n so far, in units where v_n1 = -1.
#[derive(Clone, Copy)]
pub(crate) struct Turns<T> {
    rising: bool,
    last: T,
    target: T,
    /// How near v_n turned to zero, or from above to Newton's target.
    pub nearest: T,
}

impl<T: Real> Turns<T> {
    /// None yet. `target` is Newton's, or zero.
    #[inline]
    pub fn new(target: T) -> Self {
        Self { rising: true, last: -T::one(), target, nearest: T::one() }
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

    /// Something ended, or did not, by this relative distance.
    #[inline]
    pub fn missed(&mut self, distance: T) {
        if distance < self.nearest {
            self.nearest = distance;
        }
    }
}
