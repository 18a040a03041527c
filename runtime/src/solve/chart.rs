//! One expansion of the sliding arc: power series in x = tan(phi / 2), phi counted from the present direction of slip.
//!
//! With s = (1 + x^2) sigma the sliding equations (34) become H sigma' = 2 K sigma, H I' = 2 sigma (1 + x^2)^2 with
//! polynomials H, K of degree four and three. Every integral sought is sigma R with H R' + 2 K R = a polynomial, and 1 / sigma solves
//! the same equation without right-hand side: one recurrence, four lanes.

use nalgebra::Vector2;

use super::{ledger::State, terminal::Contact};
use crate::{Scalar, scalar::constant, scalar::fma, scalar::larger};

/// Terms of each series.
const TERMS: usize = 32;

/// The sliding equations about one direction of slip.
pub(super) struct Chart<T> {
    /// H (degree four), where (1 + x^2)^2 h = H.
    pub h: [T; 5],
    /// K (degree three), where (1 + x^2)^2 g = x H + (1 + x^2) K.
    pub k: [T; 4],
    /// F (degree two), where (1 + x^2) f = F.
    pub f: [T; 3],
}

impl<T: Scalar> Chart<T> {
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
        }
    }

    /// A lower bound of the convergence radius as q = |H_0| / r, Cauchy's bound on the roots of H with K as a weak majorant.
    #[inline]
    fn steepness(&self) -> T {
        let [h0, h1, h2, h3, h4] = self.h;
        let h0 = h0.abs();
        let c1 = h1.abs();
        let c2 = h2.abs() * h0;
        let c3 = h3.abs() * h0 * h0;
        let c4 = h4.abs() * h0 * h0 * h0;
        // q^4 = c1 q^3 + c2 q^2 + c3 q + c4, from above.
        let mut q = c1 + c2.sqrt() + (c3 + c4.sqrt()).cbrt();
        let (three, two) = (constant::<T>(3.0), constant::<T>(2.0));
        for _ in 0..3 {
            let p = (((q - c1) * q - c2) * q - c3) * q - c4;
            let slope = ((constant::<T>(4.0) * q - three * c1) * q - two * c2) * q - c3;
            if slope > T::zero() {
                q -= p / slope;
            }
        }
        q
    }
}

/// The series of one step. `theta` in [0, 1] runs from its beginning; x = reach * theta.
pub(super) struct Series<T: Scalar> {
    rows: [[T; 4]; TERMS],
    works: [T; TERMS],
    f: [T; 3],
    /// H(x) / H_0 as a polynomial in theta.
    h: [T; 5],
    rate: T,
    pub reach: T,
    /// The series holds up to here.
    pub limit: T,
    d: Vector2<T>,
    slip: T,
    start: State<T>,
    mu: T,
}

/// A point on a step.
pub(super) struct Point<T: Scalar> {
    pub state: State<T>,
    sigma: T,
    x: T,
}

impl<T: Scalar> Series<T> {
    #[inline(never)]
    pub fn new(chart: &Chart<T>, mu: T, d: Vector2<T>, slip: T, start: State<T>) -> Option<Self> {
        let q0 = chart.steepness();
        let two = constant::<T>(2.0);
        let mut q = larger(q0 * constant(3.0), chart.k[0].abs() * two);
        let eps = T::default_epsilon();
        for _ in 0..8 {
            let s = Self::expand(chart, q, mu, d, slip, start);
            let tail = s.tail();
            if tail <= eps * constant(0.125) {
                return Some(s);
            }
            if tail <= eps * constant(1e8) {
                return Some(Self { limit: constant(0.5), ..s });
            }
            q *= constant(4.0);
        }
        None
    }

    #[inline]
    fn tail(&self) -> T {
        let [.., r1, r2] = &self.rows;
        let [_, first, ..] = &self.rows;
        let big = first[0].abs();
        let lanes =
            larger(r1[0].abs() + r2[0].abs(), larger(r1[2].abs() + r2[2].abs(), r1[1].abs() + r2[1].abs()))
                / big;
        let [.., w1, w2] = &self.works;
        larger(lanes + r1[3].abs() + r2[3].abs(), (w1.abs() + w2.abs()) / (big * big))
    }

    #[inline]
    fn expand(chart: &Chart<T>, q: T, mu: T, d: Vector2<T>, slip: T, start: State<T>) -> Self {
        let (zero, one, two) = (T::zero(), T::one(), constant::<T>(2.0));
        let reach = chart.h[0] / q;
        let x2 = reach * reach;
        let iq = one / q;
        let scale = [iq, iq * reach, iq * x2, iq * x2 * reach];
        let [h0, h1, h2, h3, h4] = chart.h;
        let step = [h1 * scale[0], h2 * scale[1], h3 * scale[2], h4 * scale[3]];
        let [k0, k1, k2, k3] = chart.k;
        let k = [two * k0 * scale[0], two * k1 * scale[1], two * k2 * scale[2], two * k3 * scale[3]];
        let mut s = Self {
            rows: [[zero; 4]; TERMS],
            works: [zero; TERMS],
            f: chart.f,
            h: [one, step[0], step[1], step[2], step[3]],
            rate: two * iq,
            reach,
            limit: one,
            d,
            slip,
            start,
            mu,
        };
        let _ = h0;
        let mut r0 = [zero, zero, zero, one];
        let (mut r1, mut r2, mut r3) = ([zero; 4], [zero; 4], [zero; 4]);
        let (mut w0, mut w1, mut w2, mut w3) = (zero, zero, zero, zero);
        let mut v = [zero; 5];
        let mut m = [k[0], k[1] - step[1], k[2] - two * step[2], k[3] - constant::<T>(3.0) * step[3]];
        let t = two * iq;
        let mut source = [
            [t, zero, zero],
            [zero, t * reach, zero],
            [t * x2, zero, t * x2],
            [zero, t * x2 * reach, zero],
            [zero, zero, t * x2 * x2],
        ]
        .into_iter();
        let mut n = zero;
        let mut first = true;
        for (row, work) in s.rows.iter_mut().zip(s.works.iter_mut()) {
            if first {
                first = false;
                *row = r0;
                continue;
            }
            let inverse = one / (n + one);
            let src = source.next().unwrap_or([zero; 3]);
            let mut new = [zero; 4];
            for (lane, out) in new.iter_mut().enumerate() {
                let pick = |r: &[T; 4]| r.get(lane).copied().unwrap_or(zero);
                let add = src.get(lane).copied().unwrap_or(zero);
                *out = (add - m[0] * pick(&r0) - m[1] * pick(&r1) - m[2] * pick(&r2) - m[3] * pick(&r3))
                    * inverse;
            }
            // v_n of the previous order feeds the work of this one.
            v = [s.f[0] * r0[0] + s.f[1] * r0[1] + s.f[2] * r0[2], v[0], v[1], v[2], v[3]];
            let new_work = (t * (v[0] + two * x2 * v[2] + x2 * x2 * v[4])
                - (m[0] + k[0]) * w0
                - (m[1] + k[1]) * w1
                - (m[2] + k[2]) * w2
                - (m[3] + k[3]) * w3)
                * inverse;
            *row = new;
            *work = new_work;
            (r3, r2, r1, r0) = (r2, r1, r0, new);
            (w3, w2, w1, w0) = (w2, w1, w0, new_work);
            for (a, b) in m.iter_mut().zip(step) {
                *a += b;
            }
            n += one;
        }
        s
    }

    #[inline]
    pub fn at(&self, theta: T) -> Point<T> {
        let mut sum = [T::zero(); 4];
        let mut work = T::zero();
        for (row, w) in self.rows.iter().zip(self.works.iter()).rev() {
            for (total, term) in sum.iter_mut().zip(row) {
                *total = fma(*total, theta, *term);
            }
            work = fma(work, theta, *w);
        }
        let sigma = T::one() / sum[3];
        let slip = self.slip * sigma;
        let [a, b, c, _] = sum;
        let normal = slip * (a + c);
        let along = -self.mu * slip * (a - c);
        let across = -self.mu * slip * (b + b);
        Point {
            state: State {
                normal: self.start.normal + normal,
                tangential: self.start.tangential
                    + Vector2::new(
                        along * self.d.x - across * self.d.y,
                        along * self.d.y + across * self.d.x,
                    ),
                velocity: self.start.velocity + slip * (self.f[0] * a + self.f[1] * b + self.f[2] * c),
                work: self.start.work + self.start.velocity * normal + slip * slip * work,
            },
            sigma,
            x: self.reach * theta,
        }
    }

    /// dI_n / dtheta and f at a point.
    #[inline]
    pub fn rates(&self, theta: T, p: &Point<T>) -> (T, T) {
        let e = T::one() + p.x * p.x;
        let [h0, h1, h2, h3, h4] = self.h;
        let h = (((h4 * theta + h3) * theta + h2) * theta + h1) * theta + h0;
        let f = ((self.f[2] * p.x + self.f[1]) * p.x + self.f[0]) / e;
        (self.rate * self.slip * p.sigma * e * e / h, f)
    }

    /// The first theta in (0, limit) where f changes sign, if there is one.
    #[inline]
    pub fn turning(&self) -> Option<T> {
        let [c, b, a] = [self.f[0], self.f[1] * self.reach, self.f[2] * self.reach * self.reach];
        if b.abs() + a.abs() < c.abs() {
            return None;
        }
        let root = crate::solve::quadratic(a, b, c);
        let mut best = None;
        for r in root {
            let tiny = constant::<T>(8.0) * T::default_epsilon();
            if r > tiny && r < self.limit && best.is_none_or(|x| r < x) {
                best = Some(r);
            }
        }
        best
    }

    /// Direction and speed of slip at a point.
    #[inline]
    pub fn slip(&self, p: &Point<T>) -> (Vector2<T>, T) {
        let x2 = p.x * p.x;
        let e = T::one() + x2;
        let (c, s) = ((T::one() - x2) / e, (p.x + p.x) / e);
        let d = Vector2::new(self.d.x * c - self.d.y * s, self.d.y * c + self.d.x * s);
        (d, self.slip * p.sigma * e)
    }
}
