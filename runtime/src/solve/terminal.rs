//! The terminal arc, after slip has stopped: sticking (45), or renewed sliding in the direction phi_hat (46).
//! All velocities are linear in I_n on it.
//!
//! Theory: docs/theory.md, section 10.

use nalgebra::Vector2;

use super::contact::Contact;
use crate::scalar::{Real, constant, dot, larger, length};
use crate::tangential_block::TangentialBlock;

impl<T: Real> Contact<T> {
    /// The solution x of T x = b of least norm. The tangential impulse -x per I_n keeps the contact from
    /// slipping.
    ///
    /// A second pivot within rounding of zero counts as zero if b lies in the range of T. If b does not, the
    /// pivot is small but not zero: in a positive semidefinite matrix it is at least the square of what
    /// elimination leaves of b.
    #[inline(always)]
    pub fn hold(&self) -> Vector2<T> {
        let Some(elimination) = self.tangential().eliminate(&self.b) else { return Vector2::zeros() };
        if !elimination.is_singular() {
            return elimination.solution(elimination.pivot);
        }
        let left = elimination.left;
        if left.abs() > constant::<T>(4096.0) * T::default_epsilon() * elimination.p.sqrt() {
            elimination.solution(larger(elimination.pivot, left * left))
        } else {
            elimination.least_squares()
        }
    }

    /// dv_n / dI_n while the tangential impulse -`hold` per I_n keeps the contact from slipping.
    #[inline]
    pub fn held_rate(&self, hold: &Vector2<T>) -> T {
        self.tangential().held_rate(&self.b, hold)
    }

    /// T.
    #[inline]
    fn tangential(&self) -> TangentialBlock<T> {
        TangentialBlock { tt: self.tt, ts: self.ts, ss: self.ss }
    }

    /// The direction phi_hat of renewed sliding for mu < mu_c: (mu T + g) d = b with g > 0.
    ///
    /// Newton's method on 1 / |(mu T + g)^-1 b| = 1, from below, where it rises to the root without crossing
    /// it.
    #[inline(always)]
    pub fn renewal(&self) -> Vector2<T> {
        if T::INLINED { self.renewal_here() } else { self.renewal_apart() }
    }

    #[inline(never)]
    fn renewal_apart(&self) -> Vector2<T> {
        self.renewal_here()
    }

    #[inline(always)]
    fn renewal_here(&self) -> Vector2<T> {
        let (mut b, mut tt, mut ts, mut ss) = (self.b, self.mu_tt, self.mu_ts, self.mu_ss);
        if !self.is_ordinary() {
            // The direction depends on ratios of the entries only.
            let unit = T::one() / self.slip_size();
            (b, tt, ts, ss) = (b * unit, tt * unit, ts * unit, ss * unit);
        }
        let size = length(&b);
        let mut g = larger(size - (tt + ss), T::default_epsilon() * size);
        let mut d = b / size;
        let mut settled = false;
        for _ in 0..48 {
            let (p, q) = (tt + g, ss + g);
            let det = dot(p, q, -ts, ts);
            let y = Vector2::new(dot(q, b.x, -ts, b.y), dot(p, b.y, -ts, b.x)) / det;
            let norm = length(&y);
            d = y / norm;
            // d|y|/dg = -d . (mu T + g)^-1 y
            let z = Vector2::new(dot(q, d.x, -ts, d.y), dot(p, d.y, -ts, d.x)) / det;
            let step = (norm - T::one()) / (norm * dot(d.x, z.x, d.y, z.y));
            if settled {
                break;
            }
            let next = g + step;
            if next <= T::zero() {
                g *= constant(0.5);
            } else {
                settled = step.abs() <= constant::<T>(4.0) * T::default_epsilon() * next;
                g = next;
            }
        }
        // The determinant may have lost digits; a turn by h / (-h') makes h zero again.
        let [_, g, h] = self.rates(&d);
        let across = Vector2::new(-d.y, d.x);
        let turn = h / (g - self.convergence(&d));
        if turn.abs() > constant(1e-4) {
            return d;
        }
        d * (T::one() - turn * turn * constant(0.5)) + across * turn
    }
}

/// What happens on the terminal arc, per unit of I_n.
#[derive(Clone, Copy)]
pub(crate) struct Terminal<T: Real> {
    pub sticks: bool,
    /// Minus the change of the tangential impulse.
    pub push: Vector2<T>,
    /// The change of the tangential velocity.
    pub gain: Vector2<T>,
    /// The change of v_n.
    pub rate: T,
    pub mu_c: T,
}

impl<T: Real> Terminal<T> {
    /// Sticking (45) if mu >= mu_c, else renewal (46).
    #[inline(always)]
    pub fn of(contact: &Contact<T>) -> Self {
        let hold = contact.hold();
        let mu_c = length(&hold);
        if mu_c <= contact.mu {
            let rate = contact.held_rate(&hold);
            return Self { sticks: true, push: hold, gain: Vector2::zeros(), rate, mu_c };
        }
        let d = contact.renewal();
        let g = contact.slip_rate(&d).dot(&d);
        // f >= mu g > 0 for a positive semidefinite matrix (theory, 2.9), used where f has lost its digits.
        let rate = contact.normal_rate(&d);
        let rate = if rate > T::zero() { rate } else { contact.mu * g };
        Self { sticks: false, push: d * contact.mu, gain: d * g, rate, mu_c }
    }
}
