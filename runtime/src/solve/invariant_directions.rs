//! Finds the invariant directions on either side of a direction of slip: the zeros of h, in which slip keeps
//! its direction.
//!
//! In the principal axes of T, mirrored so that b = (p, q) has positive components, h = q cos phi - p sin phi + delta
//! sin phi cos phi, where delta is mu times the difference of the principal values. The first
//! quadrant holds one stable zero and the third one unstable zero; the fourth holds one of each or none; the
//! second none. At a zero d is parallel to b - mu T d, so that d = (p / (eta + delta), q / eta) for some eta;
//! abs(d) = 1 is a secular equation for eta.
//!
//! Theory: docs/theory.md, section 3.

use nalgebra::Vector2;

use crate::scalar::{Arithmetic, Mask, constant, decide, dot, either, fma, larger, length};

/// The greatest number of Newton steps; a handful suffices unless two zeros are about to merge.
const STEPS: u32 = 32;

/// The relative change of eta at which the iteration ends: the next step would not change the first half of
/// the digits.
const ROUGH: f64 = 1e-4;

/// The zeros of h next to the direction `d`: the unstable one that slip turns away from, and the stable one
/// that it turns to.
///
/// `turn` is h at d, not zero. `b` is (m_nt, m_ns), `nu` is mu times the deviator of T, ((m_tt - m_ss) / 2,
/// m_ts). The vectors returned are right to half the digits, and their length is one to half the digits only.
#[inline(always)]
pub(super) fn neighbours<T: Arithmetic>(
    b: &Vector2<T>,
    nu: &Vector2<T>,
    d: &Vector2<T>,
    turn: T,
) -> [Vector2<T>; 2] {
    let zero = T::zero();
    let half = length(nu);
    let delta = half + half;
    // The principal axis of the larger principal value has half the angle of nu.
    let halved = || {
        let right = || Vector2::new(half + nu.x, nu.y);
        let axis = either(zero.at_most(nu.x), right, || Vector2::new(nu.y, half - nu.x));
        axis / length(&axis)
    };
    let axis = either(zero.below(half), halved, || Vector2::new(T::one(), zero));
    let seen = |v: &Vector2<T>| over(v, &axis);
    let (pull, slip) = (seen(b), seen(d));
    let sign = |x: T| T::choose(x.below(zero), || -T::one(), || T::one());
    let (sx, sy) = (sign(pull.x), sign(pull.y));
    let slip = Vector2::new(slip.x * sx, slip.y * sy);
    let forward = zero.below(turn * sx * sy);
    // Where a component of b vanishes a zero lies on an axis; replacing it by a tiny number keeps the zero
    // inside its quadrant.
    let eps = T::default_epsilon();
    let none = eps * eps * (pull.x.abs() + pull.y.abs() + delta);
    let (p, q) = (larger(pull.x.abs(), none), larger(pull.y.abs(), none));
    // h' changes sign once in the fourth quadrant, between its zeros: its sign tells on which side of them
    // the direction lies.
    let slope =
        fma(delta, dot(slip.x, slip.x, -slip.y, slip.y), -dot(pull.x.abs(), slip.x, pull.y.abs(), slip.y));
    // Whether the unstable zero and the stable one are those in the fourth quadrant.
    let pair = forward.and(|| crowded(p, q, delta));
    let behind = zero.at_most(slip.y).or(|| zero.below(slip.x).and(|| zero.below(slope)));
    let backward = || forward.not().and(|| zero.at_most(slip.x)).and(|| slip.y.below(zero));
    let (unstable, stable) = (pair.select(|| behind, backward), pair.select(|| behind.not(), backward));
    let [x, y] = decide!(
        T: unstable,
        {
            let (x, y) = paired(p, q, delta);
            [x, -y]
        },
        {
            let (y, x) = alone(q, p, delta);
            [-x, -y]
        }
    );
    let unstable = Vector2::new(x, y);
    // Of the zeros in the fourth quadrant the stable one comes first, anticlockwise.
    let [x, y] = decide!(
        T: stable,
        {
            let (y, x) = paired(q, p, delta);
            [x, -y]
        },
        <[T; 2]>::from(alone(p, q, delta))
    );
    let stable = Vector2::new(x, y);
    [unstable, stable].map(|v| {
        let (x, y) = (v.x * sx, v.y * sy);
        times(&axis, &Vector2::new(x, y))
    })
}

/// Whether the fourth quadrant holds zeros: whether b lies inside the astroid p^(2/3) + q^(2/3) =
/// delta^(2/3).
#[inline]
fn crowded<T: Arithmetic>(p: T, q: T, delta: T) -> T::Mask {
    let inside = fma(delta, delta, -dot(p, p, q, q));
    let product = p * q * delta;
    let far = || (constant::<T>(27.0) * product * product).below(inside * inside * inside);
    T::zero().below(inside).and(far)
}

/// The direction (p / (eta + delta), q / eta) of length one (to half the digits) with eta > 0, by Newton's
/// method on 1 / length = 1, which converges from below (theory, 3.2).
#[inline(always)]
fn alone<T: Arithmetic>(p: T, q: T, delta: T) -> (T, T) {
    let one = T::one();
    // The root is a convex function of delta, so its tangent at delta = 0 lies below it.
    let pp = p * p;
    let square = fma(q, q, pp);
    let mut eta = larger(q, square.sqrt() - delta * pp / square);
    let (mut x, mut y) = (one, one);
    let mut going = T::Mask::all();
    for _ in 0..STEPS {
        let (a, b) = (one / (eta + delta), one / eta);
        let (px, qy) = (p * a, q * b);
        let (xx, yy) = (px * px, qy * qy);
        let square = xx + yy;
        let step = (square.sqrt() - one) * square / dot(xx, a, yy, b);
        let ends = step.at_most(constant::<T>(ROUGH) * eta);
        let better = || [fma(-px * a, step, px), fma(-qy * b, step, qy)];
        [x, y] = T::iterated(going, || T::choose_all(ends, better, || [px, qy]), [x, y]);
        going = going.and(|| ends.not());
        if !going.any() {
            break;
        }
        eta += step;
    }
    (x, y)
}

/// The direction (p / eta, q / (delta - eta)) of length one (to half the digits) with the lesser such eta in
/// (0, delta).
#[inline(always)]
fn paired<T: Arithmetic>(p: T, q: T, delta: T) -> (T, T) {
    let one = T::one();
    let mut eta = p;
    let (mut x, mut y) = (one, one);
    let mut going = T::Mask::all();
    for _ in 0..STEPS {
        let (a, b) = (one / eta, one / (delta - eta));
        let (px, qy) = (p * a, q * b);
        let (xx, yy) = (px * px, qy * qy);
        let slope = dot(xx, a, -yy, b);
        let lost = slope.at_most(T::zero());
        let step = (xx + yy - one) * constant(0.5) / slope;
        let ends = step.at_most(constant::<T>(ROUGH) * eta);
        let better = || [fma(-px * a, step, px), fma(qy * b, step, qy)];
        let last = lost.not().and(|| ends);
        [x, y] = T::iterated(going, || T::choose_all(last, better, || [px, qy]), [x, y]);
        going = going.and(|| lost.or(|| ends).not());
        if !going.any() {
            break;
        }
        eta += step;
    }
    (x, y)
}

/// a b, of complex numbers.
#[inline(always)]
pub(super) fn times<T: Arithmetic>(a: &Vector2<T>, b: &Vector2<T>) -> Vector2<T> {
    Vector2::new(dot(a.x, b.x, -a.y, b.y), dot(a.x, b.y, a.y, b.x))
}

/// a / b of complex numbers, for b of modulus one.
#[inline(always)]
pub(super) fn over<T: Arithmetic>(a: &Vector2<T>, b: &Vector2<T>) -> Vector2<T> {
    Vector2::new(dot(a.x, b.x, a.y, b.y), dot(a.y, b.x, -a.x, b.y))
}

/// A zero of h.
pub(super) struct Zero<T: Arithmetic> {
    pub direction: Vector2<T>,
    /// abs(h') at the zero.
    pub slope: T,
    /// g at the zero without its constant term -mu chi, chi being half the trace of T.
    pub pull: T,
}

impl<T: Arithmetic> Zero<T> {
    /// The zero next to the direction `v` at which h' has the given sign. Steps solve the quadratic
    /// approximation of h, so that another zero close by is not taken for it.
    #[inline(always)]
    pub fn close(b: &Vector2<T>, nu: &Vector2<T>, mut v: Vector2<T>, sign: T) -> Self {
        let enough = if T::refined() { constant::<T>(8.0) * T::default_epsilon() } else { constant(3e-8) };
        let (mut slope, mut pull) = (T::zero(), T::zero());
        let mut going = T::Mask::all();
        for left in (0..6).rev() {
            let (along, double) = (over(b, &v), over(&over(nu, &v), &v));
            let h = along.y - double.y;
            let (steep, pulled) = ((double.x + double.x - along.x) * sign, along.x - double.x);
            let bend = fma(constant::<T>(4.0), double.y, -along.y);
            let turn = to_zero(h * sign, steep, bend * sign);
            let size = turn.abs();
            // A large step is NaN or leads to another zero and is not taken; nor is the last one, since the
            // steps are rounding where zeros merge.
            let taken = size.at_most(constant(if left > 0 { 0.1 } else { -1.0 }));
            let again = taken.and(|| enough.below(size));
            let turned = || {
                let along = fma(turn * turn, constant(-0.5), T::one());
                let v = Vector2::new(dot(v.x, along, -v.y, turn), dot(v.y, along, v.x, turn));
                let v = either(again, || v / length(&v), || v);
                let last = || [steep + bend * turn * sign, pulled + (h - double.y) * turn];
                let [slope, pull] = T::choose_all(again, || [steep, pulled], last);
                [v.x, v.y, slope, pull]
            };
            let step = || T::choose_all(taken, turned, || [v.x, v.y, steep, pulled]);
            [v.x, v.y, slope, pull] = T::iterated(going, step, [v.x, v.y, slope, pull]);
            going = going.and(|| again);
            if !going.any() {
                break;
            }
        }
        Self { direction: v, slope, pull }
    }
}

/// The unit vector at half the angle of `v`, counted from the axis in the sense of `side` (1 anticlockwise,
/// -1 clockwise); this angle is at most 240 degrees (theory, 3.3).
#[inline(always)]
fn halved<T: Arithmetic>(v: &Vector2<T>, side: T) -> Vector2<T> {
    let (one, half) = (T::one(), constant::<T>(0.5));
    let obtuse = || {
        let sin = ((one - v.x) * half).sqrt() * side;
        Vector2::new(v.y * half / sin, sin)
    };
    let acute = || {
        let cos = ((one + v.x) * half).sqrt();
        Vector2::new(cos, v.y * half / cos)
    };
    either(v.x.below(T::zero()), obtuse, acute)
}

/// h as a function of x = tan(angle / 2), the angle being counted from the direction in which the arc begins.
pub(super) struct Near<T> {
    /// The coefficients of (1 + x^2)^2 h (theory, 3.8), the constant first.
    pub h: [T; 5],
}

impl<T: Arithmetic> Near<T> {
    /// The zero next to the approximate zero `rough`, and the unit vector at half the angle to it. `b` and
    /// `nu` as for [`neighbours`].
    #[inline(always)]
    pub fn exact(&self, [b, nu, rough]: [&Vector2<T>; 3], side: T, sign: T) -> (Vector2<T>, Zero<T>) {
        let zero = Zero::close(b, nu, rough / length(rough), sign);
        let direction = &zero.direction;
        let near = T::zero().below(direction.x).and(|| direction.y.abs().at_most(constant(0.125)));
        let [x, y, along, across, slope, pull] = decide!(
            T: near,
            {
                let (half, exact) = self.beside(direction, side, sign);
                let (along, double) = (over(b, &exact), over(&over(nu, &exact), &exact));
                let (slope, pull) = ((double.x + double.x - along.x) * sign, along.x - double.x);
                [half.x, half.y, exact.x, exact.y, slope, pull]
            },
            {
                let half = halved(direction, side);
                [half.x, half.y, direction.x, direction.y, zero.slope, zero.pull]
            }
        );
        (Vector2::new(x, y), Zero { direction: Vector2::new(along, across), slope, pull })
    }

    /// The unit vectors at half the angle and at the angle of a zero near the axis. The angle has the same
    /// relative error as h.
    #[inline(always)]
    pub fn beside(&self, v: &Vector2<T>, side: T, sign: T) -> (Vector2<T>, Vector2<T>) {
        let one = T::one();
        let x = self.close(v.y / (one + v.x), sign);
        // An angle on the other side is rounding: a zero there lies at more than 240 degrees.
        let x = larger(x * side, T::default_epsilon() * T::default_epsilon()) * side;
        let square = x * x;
        let inverse = one / (one + square);
        let cos = inverse.sqrt();
        (Vector2::new(cos, x * cos), Vector2::new((one - square) * inverse, (x + x) * inverse))
    }

    /// The zero next to x at which h' has the given sign.
    #[inline(always)]
    fn close(&self, x: T, sign: T) -> T {
        let [h0, h1, h2, h3, h4] = self.h;
        let three = constant::<T>(3.0);
        let value = fma(fma(fma(fma(h4, x, h3), x, h2), x, h1), x, h0);
        let slope = fma(fma(fma(constant::<T>(4.0) * h4, x, three * h3), x, h2 + h2), x, h1);
        let bend = fma(fma(constant::<T>(12.0) * h4, x, constant::<T>(6.0) * h3), x, h2 + h2);
        let step = to_zero(value * sign, slope * sign, bend * sign);
        T::choose(step.abs().at_most(constant(0.01)), || x + step, || x)
    }
}

/// The zero x of `value` + `slope` x + `bend` x^2 / 2 at which this rises, or its extremum if it has no zero.
/// `slope` must be positive up to rounding.
#[inline(always)]
fn to_zero<T: Arithmetic>(value: T, slope: T, bend: T) -> T {
    let two = constant::<T>(2.0);
    let square = dot(slope, slope, -two * value, bend);
    let [x] = decide!(
        T: square.primal().at_most(T::zero()),
        [-slope / bend],
        decide!(
            T: T::zero().below(slope),
            [-two * value / (slope + square.sqrt())],
            [(square.sqrt() - slope) / bend]
        )
    );
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_rise_at_their_zero() {
        for value in [-0.4, -1e-9, 0.0, 1e-12, 0.1] {
            for slope in [1.0, 1e-3, 1e-8, 0.0, -1e-8, -1e-3] {
                for bend in [-2.0, -1e-3, 1e-3, 3.0] {
                    let x: f64 = to_zero(value, slope, bend);
                    let rises = slope + bend * x;
                    if slope * slope > 2.0 * value * bend {
                        let rest = value + x * (slope + 0.5 * bend * x);
                        assert!(
                            rest.abs() < 1e-14 && rises > 0.0,
                            "{value} {slope} {bend}: {x} {rest} {rises}"
                        );
                    } else {
                        assert!(rises.abs() < 1e-14, "{value} {slope} {bend}: {x} {rises}");
                    }
                }
            }
        }
    }

    /// Half angles to both zeros next to the axis: their doubles are zeros of h, on the side on which they
    /// are sought, with the right sign of h'.
    #[test]
    fn half_angles_lead_to_the_zeros_on_either_side() {
        let (mut far, mut near) = (0, 0);
        for k in 1..4000 {
            let [p, q, r] =
                [0.754_877_666, 0.569_840_291, 0.324_717_957].map(|step: f64| (f64::from(k) * step).fract());
            let (b, nu) = (Vector2::new(2.0 * p - 1.0, 2.0 * q - 1.0), Vector2::new(2.0 * r - 1.0, q - p));
            let h = |d: &Vector2<f64>| over(&b, d).y - over(&over(&nu, d), d).y;
            let axis = Vector2::new(1.0, 0.0);
            let start = h(&axis);
            // Every fourth of them begins close to a zero.
            let (b, start) =
                if k % 4 == 0 { (Vector2::new(b.x, b.y - start + 1e-6), 1e-6) } else { (b, start) };
            let h = |d: &Vector2<f64>| over(&b, d).y - over(&over(&nu, d), d).y;
            let forward = start.signum();
            let near_axis =
                Near { h: [start, 4.0 * nu.x - 2.0 * b.x, 6.0 * nu.y, -4.0 * nu.x - 2.0 * b.x, -b.y - nu.y] };
            let [behind, ahead] = neighbours(&b, &nu, &axis, start);
            for (rough, side, sign) in [(behind, -forward, 1.0), (ahead, forward, -1.0)] {
                let (half, zero) = near_axis.exact([&b, &nu, &rough], side, sign);
                let angle = 2.0 * (half.y * side).atan2(half.x);
                assert!(angle > 0.0 && angle < 240.1_f64.to_radians(), "{k}: {angle}");
                assert!((times(&half, &half) - zero.direction).norm() < 1e-14);
                assert!(h(&zero.direction).abs() < 1e-14, "{k}: {}", h(&zero.direction));
                // h keeps its sign on the way.
                for part in 1..24 {
                    let (sin, cos) = (side * angle * f64::from(part) / 24.0).sin_cos();
                    assert!(h(&Vector2::new(cos, sin)) * start > -1e-14, "{k}: {angle} {part}");
                }
                far += u32::from(angle > 2.1);
                near += u32::from(angle < 1e-4);
            }
        }
        assert!(far > 100 && near > 500, "{far} {near}");
    }
}
