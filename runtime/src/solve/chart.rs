//! The sliding equations about one direction of slip, as polynomials in a projective coordinate.
//!
//! With x = tan(phi / 2), phi counted from that direction, and x = y / (1 + kappa y), slip is v_t = sigma c, v_s = sigma z, s = sigma e
//! with quadratics c, z, e in y, and (34) becomes H sigma' = 2 K sigma, H I_n' = 2 sigma e^2, where H has degree four and K three.

use nalgebra::Vector2;

use super::terminal::Contact;
use crate::{scalar::Real as Scalar, scalar::constant, scalar::fma};

/// H, K and F for one direction and one choice of kappa.
#[derive(Clone, Copy)]
pub(super) struct Chart<T> {
    /// H: dy/dtau = H / (2 e) where s dtau = dI_n.
    pub h: [T; 5],
    /// K: (ln sigma)' = 2 K / H.
    pub k: [T; 4],
    /// F = f e (31).
    pub f: [T; 3],
    /// e = 1 + 2 kappa y + (1 + kappa^2) y^2.
    pub kappa: T,
}

impl<T: Scalar> Chart<T> {
    /// The chart about the direction d, with kappa = 0.
    #[inline]
    pub fn about(c: &Contact<T>, d: &Vector2<T>) -> Self {
        let two = constant::<T>(2.0);
        let b1 = c.b.dot(d);
        let b2 = c.b.y * d.x - c.b.x * d.y;
        let (cc, cs, ss) = (d.x * d.x, d.x * d.y, d.y * d.y);
        let m11 = c.mu * (c.tt * cc + two * c.ts * cs + c.ss * ss);
        let m22 = c.mu * (c.tt * ss - two * c.ts * cs + c.ss * cc);
        let m12 = c.mu * (c.ts * (cc - ss) + (c.ss - c.tt) * cs);
        let delta = two * (m11 - m22);
        let mb1 = c.mu * b1;
        Self {
            h: [b2 - m12, delta - two * b1, constant::<T>(6.0) * m12, -delta - two * b1, -b2 - m12],
            k: [b1 - m11, b2 - constant::<T>(3.0) * m12, b1 + m11 - two * m22, b2 + m12],
            f: [T::one() - mb1, -two * c.mu * b2, T::one() + mb1],
            kappa: T::zero(),
        }
    }

    /// The same chart with another kappa; this one's must be zero.
    #[inline]
    pub fn with_kappa(&self, kappa: T) -> Self {
        // H(y / (1 + kappa y)) (1 + kappa y)^4, by shifting the reversed polynomial.
        let [a0, a1, a2, a3, a4] = self.h;
        let (p1, c) = (fma(kappa, a0, a1), a2);
        let p2 = fma(kappa, p1, c);
        let p3 = fma(kappa, p2, a3);
        let h4 = fma(kappa, p3, a4);
        let p1 = fma(kappa, a0, p1);
        let p2 = fma(kappa, p1, p2);
        let h3 = fma(kappa, p2, p3);
        let p1 = fma(kappa, a0, p1);
        let h2 = fma(kappa, p1, p2);
        let h1 = fma(kappa, a0, p1);
        let h = [a0, h1, h2, h3, h4];
        let [k0, k1, k2, k3] = self.k;
        let r1 = fma(kappa, k0, k1);
        let r2 = fma(kappa, r1, k2);
        let t3 = fma(kappa, r2, k3);
        let r1 = fma(kappa, k0, r1);
        let t2 = fma(kappa, r1, r2);
        let t1 = fma(kappa, k0, r1);
        // K = (shifted K - kappa H) / (1 + kappa y), exactly divisible.
        let [g0, g1, g2, g3, _] = h;
        let c0 = k0 - kappa * g0;
        let c1 = t1 - kappa * (g1 + c0);
        let c2 = t2 - kappa * (g2 + c1);
        let c3 = t3 - kappa * (g3 + c2);
        let [f0, f1, f2] = self.f;
        Self {
            h,
            k: [c0, c1, c2, c3],
            f: [f0, fma(kappa + kappa, f0, f1), fma(kappa, fma(kappa, f0, f1), f2)],
            kappa,
        }
    }
}
