//! The length of the next stretch of the sliding arc: how far one quadrature of sixteen nodes is exact to
//! rounding, and where v_n has a turning point.
//!
//! Theory: docs/theory.md, sections 5.3 and 8.1.

use super::sliding_arc::{ArcPoint, Rates, SlidingArc, wide_ln};
use crate::scalar::{Arithmetic, Mask, Real, constant, decide, dot, fma, larger, smaller};

impl<T: Arithmetic> SlidingArc<T> {
    /// The distance in lambda by which a point lies beyond the mean modulus of the zeros of q, or a lower
    /// bound of it; negative before them.
    #[inline(always)]
    pub fn beyond(&self, point: &ArcPoint<T>) -> T {
        wide_ln(point.w.primal() * self.scale)
    }

    /// The greatest length in lambda that one quadrature from `point` may have.
    ///
    /// If all zeros of q lie outside an ellipse whose foci are the ends of the stretch, and the integrand
    /// grows at a constant rate, the error is about e^(c (rho + 1 / rho - 2) / 2) rho^(-32), where rho is
    /// the sum of the semi-axes (for foci at +-1) and c half the rate times the length.
    #[inline(always)]
    pub fn reach(&self, point: &ArcPoint<T>, rates: &Rates<T>) -> T {
        // rho + 1 / rho at which rho^-32 = 1e-15 (theory, 5.3).
        const SUM: f64 = 3.28;
        // At this length the poles of the map from t to w come as near (theory, 18.4).
        const MOST: f64 = 9.0;
        let to = |d: T| {
            let away = dot(d, d, self.angle, self.angle).sqrt();
            fma(constant::<T>(2.0 * SUM), away, constant::<T>(4.0) * d) * constant(1.0 / (SUM * SUM - 4.0))
        };
        let before = self.beyond(point);
        let poles = to(before - self.spread);
        let poles =
            T::choose(T::zero().below(self.spread), || smaller(poles, to(before + self.spread)), || poles);
        let poles = smaller(poles, constant(0.5 * MOST));
        let one = T::one();
        let rate = larger((rates.growth + one).abs(), (rates.weight + rates.shape).abs()).primal();
        let slip = point.sigma * rates.e;
        let steep = || constant::<T>(12.0).below(poles * rate);
        let works = constant::<T>(0.06).below(slip).or(|| constant::<T>(1e-3).below(slip).and(steep));
        // The integrand of the work has the size of slip times that of the impulse.
        let of_work =
            || larger(rate, (rates.growth + rates.weight + rates.shape + rates.shape).abs().primal());
        let rate = T::choose(works, of_work, || rate);
        // A growth that changes means that sigma has a large power of the distance from the zeros of q; the
        // stretch must keep farther from them.
        let bent = (rates.change.abs().primal() * constant(0.06)).sqrt();
        let both = limited(poles, bent, rate);
        let both = both + both;
        let even = self.central[2].abs().primal().at_most((rate + rate) * self.q[2].primal());
        let [reach] = decide!(
            T: even,
            [both],
            [self.reach_of_growth(point, rates, [poles, bent, rate, both * constant(0.5)], works)]
        );
        reach.primal()
    }

    /// [`Self::reach`] where the growth may rise on the way.
    #[inline(always)]
    fn reach_of_growth(
        &self,
        point: &ArcPoint<T>,
        rates: &Rates<T>,
        [poles, bent, rate, both]: [T; 4],
        works: T::Mask,
    ) -> T {
        let one = T::one();
        // An estimate of the growth at the far end, where it may be larger; what it has risen by is added
        // once more, since it rises on.
        let near = (rates.growth + one).abs().primal();
        let steepest = self.growth_at(point.w, both, near, works);
        let [length] = decide!(T: steepest.at_most(rate + rate), [both], {
            // A length that the growth at its own far end allows, by bisection.
            let (mut least, mut most) = (smaller(both, limited(poles, bent, steepest)), both);
            for _ in 0..4 {
                let middle = (least + most) * constant(0.5);
                let far = self.growth_at(point.w, middle, near, works);
                let allowed = limited(poles, bent, larger(far, rate));
                [least, most] = T::choose_all(
                    middle.at_most(allowed),
                    || [middle, most],
                    || [larger(least, allowed), middle],
                );
            }
            [least]
        });
        length + length
    }

    /// The estimate of [`Self::reach`] for the growth at twice the length `both` from `w`.
    #[inline(always)]
    fn growth_at(&self, w: T, both: T, near: T, works: T::Mask) -> T {
        let one = T::one();
        let part = both * constant(0.125);
        let ratio = (one + part) / (one - part);
        let ratio = ratio * ratio;
        let ratio = ratio * ratio;
        let w = w * ratio * ratio;
        let poly = |[p0, p1, p2]: [T; 3]| fma(fma(p2, w, p1), w, p0);
        let far = (poly(self.central) / poly(self.q)).abs().primal();
        let far = far + larger(far - near, T::zero());
        T::choose(works, || far + far, || far)
    }
}

impl<T: Real> SlidingArc<T> {
    /// Whether v_n has a turning point ahead.
    #[inline(always)]
    pub fn turns_ahead(&self, point: &ArcPoint<T>) -> bool {
        self.may_turn && if T::INLINED { self.turns_here(point) } else { self.turns(point) }
    }

    #[inline(never)]
    fn turns(&self, point: &ArcPoint<T>) -> bool {
        self.turns_here(point)
    }

    #[inline(always)]
    fn turns_here(&self, point: &ArcPoint<T>) -> bool {
        self.turning_point(point, &self.rates(point)).1.is_some()
    }

    /// Whether v_n rises from here, and the length in lambda to the next zero of f, if there is one ahead.
    #[inline(always)]
    pub fn turning_point(&self, point: &ArcPoint<T>, rates: &Rates<T>) -> (bool, Option<T>) {
        if !self.may_turn {
            return (rates.slope > T::zero(), None);
        }
        let [_, f1, f2] = self.f;
        let zero = T::zero();
        // F(w (1 + x)) = c + b x + a x^2
        let w = point.w;
        let mut c = (rates.slope * rates.e).primal();
        let tiny = constant::<T>(64.0) * T::default_epsilon();
        let a = (f2 * w * w).primal();
        let b = (f1 * w).primal() + a + a;
        let mut rising = c > zero;
        // A zero of f at the beginning, up to the rounding of f, has been passed.
        if c.abs() <= tiny * self.size * rates.e {
            c = zero;
            rising = b > zero;
        }
        let mut best = None;
        for x in quadratic(a, b, c) {
            let x = x.primal();
            if x > tiny && best.is_none_or(|y| x < y) {
                best = Some(x);
            }
        }
        (rising, best.map(if T::INLINED { length_to_apart } else { length_to }))
    }
}

/// The length in lambda that poles at the distance `poles`, a growth of this rate and its change `bent` allow.
#[inline(always)]
fn limited<T: Arithmetic>(poles: T, bent: T, rate: T) -> T {
    let one = T::one();
    // A fit to the length at which the error with growth is 1e-15 (theory, 18.4).
    let c = poles * rate;
    let fit = fma(fma(c, constant(3e-5), constant(1.2e-3)), c, constant(0.01));
    let steep = smaller(poles, constant::<T>(7.0) / rate);
    larger(poles / fma(fit, c, fma(bent, poles, one)), steep / fma(bent, steep, one))
}

/// The length in lambda to w (1 + x).
#[inline(always)]
fn length_to<T: Real>(x: T) -> T {
    (T::one() + x).ln().primal()
}

/// [`length_to`] as a function of its own: few arcs turn.
#[cold]
#[inline(never)]
fn length_to_apart<T: Real>(x: T) -> T {
    length_to(x)
}

/// Both real roots of a x^2 + b x + c, without cancellation; roots that do not exist come out as zero.
#[inline(always)]
fn quadratic<T: Real>(a: T, b: T, c: T) -> [T; 2] {
    let disc = dot(b, b, constant::<T>(-4.0) * a, c);
    if disc < T::zero() {
        return [T::zero(); 2];
    }
    let root = disc.sqrt();
    let q = if b < T::zero() { root - b } else { -root - b } * constant(0.5);
    let first = if q != T::zero() { c / q } else { T::zero() };
    let second = if a != T::zero() { q / a } else { T::zero() };
    [first, second]
}
