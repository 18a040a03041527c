//! The chart of a sliding arc: slip turns from an unstable invariant direction a^2 towards a stable one b^2,
//! and one parameter w makes all rates rational.
//!
//! With complex numbers for vectors of the contact plane, slip is sigma (a + b w)^2 with w from 0 to
//! infinity. Along lambda = ln w, (34) becomes d ln sigma = (k / q) dlambda, dI_n = (sigma e^2 / q) dlambda
//! and dv_n = (sigma e F / q) dlambda, with quadratics e, q, k and F in w. Normal impulse, tangential impulse
//! and v_n are sums of three integrals: of sigma e / q times 1, w and w^2.
//!
//! With C + i S = a b* (b* the conjugate), h = -2 S w q / e^2. The coefficients of q (of 1, w and w^2) are
//! h'(a^2), 6 m S and -h'(b^2), where m is mu times the off-diagonal entry of T in axes along a b. Those of k
//! follow from (34) in the limits w -> 0 and w -> infinity: g(a^2), C (g(a^2) + g(b^2)) - q_1 and g(b^2) - 2
//! q_2.
//!
//! Theory: docs/theory.md, section 4.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    invariant_directions::{Near, Zero, neighbours, over, times},
    restitution::State,
};
use crate::scalar::{Arithmetic, Mask, constant, decide, dot, fma, larger};

/// The integrals of sigma e / q times 1, w and w^2 over lambda, along a stretch of the arc.
pub(super) type Integrals<T> = [T; 3];

/// The coefficients of an arc.
#[derive(Clone, Copy)]
pub(super) struct SlidingArc<T: Arithmetic> {
    pub mu: T,
    /// a^2, 2 a b and b^2: slip over sigma is this quadratic in w.
    pub slip: [Vector2<T>; 3],
    /// The same times -mu: the tangential impulse for each of the three integrals.
    rub: [Vector2<T>; 3],
    /// e = 1 + middle w + w^2.
    pub middle: T,
    /// dI_n = sigma e^2 / q.
    pub q: [T; 3],
    /// d ln sigma = k / q.
    pub k: [T; 3],
    /// k + q: d ln(sigma w) = central / q.
    pub central: [T; 3],
    /// F = f e (31).
    pub f: [T; 3],
    /// The sum of the sizes of the terms of f, for estimates of rounding.
    pub size: T,
    /// |h| = bend w q / e^2.
    bend: T,
    /// The larger of the moduli of the zeros of q.
    pub outer: T,
    /// The angle between a zero of q and the positive real axis, and the distance of the logarithms of two
    /// real zeros from their mean.
    pub angle: T,
    pub spread: T,
    /// The inverse of the geometric mean of the moduli of the zeros of q.
    pub scale: T,
    /// Whether f may change sign.
    pub may_turn: T::Mask,
}

/// A point of the arc.
#[derive(Clone, Copy)]
pub(super) struct ArcPoint<T: Arithmetic> {
    pub state: State<T>,
    /// Normal work since the latest compression ended, kept apart from the total because it may be much
    /// smaller.
    pub since: T,
    pub w: T,
    pub sigma: T,
}

#[cfg(feature = "lanes")]
impl<T: Arithmetic> ArcPoint<T> {
    /// This point, and where `holds` the other one.
    #[inline(always)]
    pub fn or(self, holds: T::Mask, other: &Self) -> Self {
        Self::of(T::choose_all(holds, || other.numbers(), || self.numbers()))
    }

    #[inline(always)]
    pub fn numbers(&self) -> [T; 8] {
        let State { normal, tangential, velocity, work } = self.state;
        [normal, tangential.x, tangential.y, velocity, work, self.since, self.w, self.sigma]
    }

    #[inline(always)]
    pub fn of([normal, t, s, velocity, work, since, w, sigma]: [T; 8]) -> Self {
        Self { state: State { normal, tangential: Vector2::new(t, s), velocity, work }, since, w, sigma }
    }
}

/// Derivatives with respect to lambda, and e, 1 / q and f, at a point of the arc.
pub(super) struct Rates<T> {
    pub e: T,
    /// 1 / q.
    pub inverse: T,
    /// The derivative of I_n, and f = dv_n / dI_n.
    pub impulse: T,
    pub slope: T,
    /// The derivatives of ln sigma (`growth`) and of ln(sigma e / q) (`weight`).
    pub growth: T,
    pub weight: T,
    /// The derivative of `growth`.
    pub change: T,
    /// The derivatives of ln e (`shape`) and of ln F (`turn`).
    pub shape: T,
    pub turn: T,
}

/// Higher derivatives with respect to lambda: the third of ln sigma (`growth`), and the second of ln(sigma e
/// / q), ln e and ln F.
pub(super) struct RateChanges<T> {
    pub growth: T,
    pub weight: T,
    pub shape: T,
    pub turn: T,
}

impl<T: Arithmetic> SlidingArc<T> {
    /// The arc through the direction `d`, at which h is not zero, and the parameter w of `d`.
    #[inline(always)]
    pub fn through(c: &Contact<T>, d: &Vector2<T>) -> (Self, T) {
        let (zero, one, two) = (T::zero(), T::one(), constant::<T>(2.0));
        let (half, four, six) = (constant::<T>(0.5), constant::<T>(4.0), constant::<T>(6.0));
        // b, and mu times mean and deviator of T, in axes in which d is (1, 0).
        let b = over(&c.b, d);
        let mean = (c.mu_tt + c.mu_ss) * half;
        let nu = over(&over(&Vector2::new((c.mu_tt - c.mu_ss) * half, c.mu_ts), d), d);
        let ahead = Vector2::new(one, zero);
        let h = b.y - nu.y;
        let rough =
            neighbours(&b.map(T::primal), &nu.map(T::primal), &ahead, h.primal()).map(|v| v.map(T::primal));
        let noise = T::default_epsilon() * (mean + b.x.abs() + b.y.abs());
        let near = Near {
            h: [h, fma(four, nu.x, -two * b.x), six * nu.y, fma(-four, nu.x, -two * b.x), -b.y - nu.y],
        };
        let [u, s] = rough;
        // Unit vectors at half the angles to the zeros: `a` to the one behind, `z` to the one ahead.
        let forward = T::choose(zero.below(h), || one, || -one);
        let (a, Zero { direction: u, slope: q0, pull: g_u }) = near.exact([&b, &nu, &u], -forward, one);
        let (z, Zero { direction: s, slope: q2, pull: g_s }) = near.exact([&b, &nu, &s], forward, -one);
        let (q0, q2, g_u, g_s) = (larger(q0, noise), larger(q2, noise), g_u - mean, g_s - mean);
        let start = -a.y / z.y;
        let turn = over(&a, &z);
        let (cos, sin) = (turn.x, turn.y);
        let product = times(&a, &z);
        let q1 = six * over(&over(&nu, &product), &product).y * sin;
        let mu_b = over(&c.mu_b, d);
        let cross = over(&mu_b, &product).x;
        let mean_root = (q0 * q2).sqrt().primal();
        let lean = -(q1 * half).primal() / mean_root;
        let modulus = (q0 / q2).sqrt().primal();
        let factor = T::choose(lean.below(-one), || fma(lean, lean, -one).sqrt() - lean, || one);
        let f = [c.nn - over(&mu_b, &u).x, two * fma(c.nn, cos, -cross), c.nn - over(&mu_b, &s).x];
        let k = [g_u, fma(cos, g_u + g_s, -q1), fma(-two, q2, g_s)];
        let slip = [times(&u, d), times(&product, d) * two, times(&s, d)];
        let arc = Self {
            mu: c.mu,
            slip,
            rub: slip.map(|x| x * -c.mu),
            middle: cos + cos,
            q: [q0, q1, q2],
            k,
            central: [k[0] + q0, k[1] + q1, k[2] + q2],
            f,
            size: c.normal_size(),
            bend: (sin + sin).abs(),
            outer: (modulus * factor).primal(),
            angle: angle(lean).primal(),
            spread: T::choose(one.below(factor), || rough_ln(factor).primal(), || zero),
            scale: (one / modulus).primal(),
            may_turn: may_turn(&f),
        };
        (arc, start)
    }

    /// e = abs(a + b w)^2.
    #[inline(always)]
    pub fn e(&self, w: T) -> T {
        fma(w + self.middle, w, T::one())
    }

    /// Whether slip falls.
    #[inline(always)]
    pub fn slows(&self, point: &ArcPoint<T>) -> T::Mask {
        let Rates { growth, shape, .. } = self.rates(point);
        (growth + shape).below(T::zero())
    }

    /// Whether abs(h) is at most `than`.
    #[inline(always)]
    pub fn turns_slower(&self, point: &ArcPoint<T>, than: T) -> T::Mask {
        let ([q0, q1, q2], w, e) = (self.q, point.w, self.e(point.w));
        let inverse = T::one() / fma(fma(q2, w, q1), w, q0);
        (self.bend * w).at_most(than * inverse * e * e)
    }

    /// q / e, without derivatives.
    #[inline(always)]
    pub fn q_over_e(&self, w: T) -> T {
        let [q0, q1, q2] = self.q;
        (fma(fma(q2, w, q1), w, q0) / self.e(w)).primal()
    }

    /// Tangential velocity.
    #[inline(always)]
    pub fn slip(&self, point: &ArcPoint<T>) -> Vector2<T> {
        let [a, ab, b] = &self.slip;
        let w = point.w;
        Vector2::new(fma(fma(b.x, w, ab.x), w, a.x), fma(fma(b.y, w, ab.y), w, a.y)) * point.sigma
    }

    /// g at the stable direction: ds / dI_n there.
    #[inline(always)]
    pub fn last_rate(&self) -> T {
        fma(constant::<T>(2.0), self.q[2], self.k[2])
    }

    /// All rates at a point.
    #[inline(always)]
    pub fn rates(&self, point: &ArcPoint<T>) -> Rates<T> {
        let w = point.w;
        let poly = |[p0, p1, p2]: [T; 3]| fma(fma(p2, w, p1), w, p0);
        let steep = |p1: T, p2: T| fma(p2 + p2, w, p1) * w;
        let e = self.e(w);
        let inverse = T::one() / poly(self.q);
        let fall = poly(self.f);
        let growth = poly(self.k) * inverse;
        let shape = steep(self.middle, T::one()) / e;
        let pole = steep(self.q[1], self.q[2]) * inverse;
        Rates {
            e,
            inverse,
            impulse: point.sigma * e * e * inverse,
            slope: fall / e,
            growth,
            weight: growth + shape - pole,
            change: dot(steep(self.k[1], self.k[2]), inverse, -growth, pole),
            shape,
            turn: steep(self.f[1], self.f[2]) / fall,
        }
    }

    /// The higher derivatives at a point.
    #[inline(always)]
    pub fn rate_changes(&self, point: &ArcPoint<T>, rates: &Rates<T>) -> RateChanges<T> {
        let w = point.w;
        let first = |p1: T, p2: T| fma(p2 + p2, w, p1) * w;
        let second = |p1: T, p2: T| fma(p2 * constant(4.0), w, p1) * w;
        let ([_, q1, q2], [_, k1, k2], [_, f1, f2]) = (self.q, self.k, self.f);
        let inverse = rates.inverse;
        let (pole, rising) = (first(q1, q2) * inverse, second(q1, q2) * inverse);
        let shape = fma(-rates.shape, rates.shape, second(self.middle, T::one()) / rates.e);
        RateChanges {
            growth: dot(second(k1, k2), inverse, -(rates.change + rates.change), pole)
                - rates.growth * rising,
            weight: rates.change + shape - fma(-pole, pole, rising),
            shape,
            turn: fma(-rates.turn, rates.turn, second(f1, f2) / (rates.slope * rates.e)),
        }
    }

    /// Adds to impulses and v_n of a state what the three integrals contribute (theory, 4.15); the work is
    /// left as it is.
    #[inline(always)]
    pub fn add(&self, [m0, m1, m2]: Integrals<T>, state: &mut State<T>) {
        let [f0, f1, f2] = self.f;
        let [a, ab, b] = &self.rub;
        state.normal += fma(self.middle, m1, m0 + m2);
        state.tangential.x = fma(a.x, m0, fma(ab.x, m1, fma(b.x, m2, state.tangential.x)));
        state.tangential.y = fma(a.y, m0, fma(ab.y, m1, fma(b.y, m2, state.tangential.y)));
        state.velocity += fma(f0, m0, fma(f1, m1, f2 * m2));
    }
}

/// Whether a quadratic has, or up to rounding may have, zeros at positive w.
#[inline(always)]
fn may_turn<T: Arithmetic>([f0, f1, f2]: &[T; 3]) -> T::Mask {
    let zero = T::zero();
    let (falls, rises) = (f0.at_most(zero), f2.at_most(zero));
    let apart = falls.select(|| rises.not(), || rises);
    let none = |f: T| f.at_most(zero).and(|| zero.at_most(f));
    let up = zero.below(*f0).and(|| zero.below(*f2));
    let between = up.select(|| f1.below(zero), || zero.below(*f1));
    let large = || (constant::<T>(3.9) * *f0 * *f2).at_most(*f1 * *f1);
    apart.or(|| none(*f0)).or(|| none(*f2)).or(|| between.and(large))
}

/// ln x with a relative error of about one per cent between 1/8 and 8; beyond, its size is too small.
#[inline(always)]
pub(super) fn rough_ln<T: Arithmetic>(x: T) -> T {
    // 2 atanh((x - 1) / (x + 1))
    let u = (x - T::one()) / (x + T::one());
    let z = u * u;
    (u + u) * fma(constant::<T>(-4.0), z, constant(15.0)) / fma(constant::<T>(-9.0), z, constant(15.0))
}

/// ln x with a relative error of about one per cent between 1/4000 and 4000, and of a size between 8 and 14.7
/// beyond.
#[inline(always)]
pub(super) fn wide_ln<T: Arithmetic>(x: T) -> T {
    let beyond = x.below(constant(0.125)).or(|| constant::<T>(8.0).below(x));
    let [ln] = decide!(T: beyond, [constant::<T>(4.0) * rough_ln(x.sqrt().sqrt())], [rough_ln(x)]);
    ln
}

/// The angle with this cosine, with an error of about one per cent; pi for cosines below -1.
#[inline]
fn angle<T: Arithmetic>(cos: T) -> T {
    let one = T::one();
    let x = cos.abs();
    let x = T::choose(x.below(one), || x, || one);
    let acute = (one - x).sqrt() * fma(constant::<T>(-0.1565), x, constant(core::f64::consts::FRAC_PI_2));
    T::choose(T::zero().at_most(cos), || acute, || constant::<T>(core::f64::consts::PI) - acute)
}

#[cfg(feature = "lanes")]
impl<T: Arithmetic> SlidingArc<T> {
    /// The numbers of which the others follow, those of quadratures first; without `may_turn`.
    #[inline(always)]
    pub fn numbers(&self) -> ArcNumbers<T> {
        let ([a, ab, b], [q0, q1, q2], [k0, k1, k2], [f0, f1, f2]) = (self.slip, self.q, self.k, self.f);
        let Self { mu, middle, size, bend, outer, angle, spread, scale, .. } = *self;
        let fill = scale;
        [
            mu, middle, a.x, a.y, ab.x, ab.y, b.x, b.y, q0, q1, q2, k0, k1, k2, f0, f1, f2, scale, size,
            bend, outer, angle, spread, fill,
        ]
    }

    /// The arc of these numbers.
    #[inline(always)]
    pub fn of(numbers: &ArcNumbers<T>, may_turn: T::Mask) -> Self {
        let [
            mu,
            middle,
            ax,
            ay,
            abx,
            aby,
            bx,
            by,
            q0,
            q1,
            q2,
            k0,
            k1,
            k2,
            f0,
            f1,
            f2,
            scale,
            size,
            bend,
            outer,
            angle,
            spread,
            ..,
        ] = *numbers;
        let slip = [Vector2::new(ax, ay), Vector2::new(abx, aby), Vector2::new(bx, by)];
        Self {
            mu,
            slip,
            rub: slip.map(|x| x * -mu),
            middle,
            q: [q0, q1, q2],
            k: [k0, k1, k2],
            central: [k0 + q0, k1 + q1, k2 + q2],
            f: [f0, f1, f2],
            size,
            bend,
            outer,
            angle,
            spread,
            scale,
            may_turn,
        }
    }
}

/// The numbers of an arc, some of them to fill the last four.
#[cfg(feature = "lanes")]
pub(super) type ArcNumbers<T> = [T; 24];
