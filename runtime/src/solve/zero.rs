//! A zero of h made exact, and the half angle to it from where the arc is entered.

use nalgebra::Vector2;

use crate::scalar::{Real, constant, fma};

/// a b, of complex numbers.
#[inline(always)]
pub(super) fn times<T: Real>(a: &Vector2<T>, b: &Vector2<T>) -> Vector2<T> {
    Vector2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

/// a over b, if b is of length one.
#[inline(always)]
pub(super) fn over<T: Real>(a: &Vector2<T>, b: &Vector2<T>) -> Vector2<T> {
    Vector2::new(a.x * b.x + a.y * b.y, a.y * b.x - a.x * b.y)
}

/// A zero of h.
pub(super) struct Zero<T: Real> {
    pub direction: Vector2<T>,
    /// The size of h' there.
    pub slope: T,
    /// g there, but for the mean of T.
    pub pull: T,
}

impl<T: Real> Zero<T> {
    /// The one close to a direction where h' has the given sign: to second order, so that another zero close by does no harm.
    #[inline(always)]
    pub fn close(b: &Vector2<T>, nu: &Vector2<T>, mut v: Vector2<T>, sign: T) -> Self {
        let enough = if T::refined() { constant::<T>(8.0) * T::default_epsilon() } else { constant(3e-8) };
        let (mut slope, mut pull) = (T::zero(), T::zero());
        for left in (0..6).rev() {
            let (along, double) = (over(b, &v), over(&over(nu, &v), &v));
            let h = along.y - double.y;
            slope = (double.x + double.x - along.x) * sign;
            pull = along.x - double.x;
            let bend = constant::<T>(4.0) * double.y - along.y;
            let turn = to_zero(h * sign, slope, bend * sign);
            let size = turn.abs();
            // Not a number, or another zero. Where zeros merge all steps are rounding, and the last one is not taken.
            if size <= constant(0.1) && left > 0 {
                let half = turn * turn * constant(0.5);
                v = Vector2::new(v.x - v.x * half - v.y * turn, v.y - v.y * half + v.x * turn);
                if size > enough {
                    v /= (v.x * v.x + v.y * v.y).sqrt();
                    continue;
                }
                slope += bend * turn * sign;
                pull += (h - double.y) * turn;
            }
            break;
        }
        Self { direction: v, slope, pull }
    }
}

/// Half the angle of a direction, on the side of the axis that `side` tells.
#[inline(always)]
pub(super) fn halved<T: Real>(v: &Vector2<T>, side: T) -> Vector2<T> {
    let (one, half) = (T::one(), constant::<T>(0.5));
    if v.x < T::zero() {
        let sin = ((one - v.x) * half).sqrt() * side;
        return Vector2::new(v.y * half / sin, sin);
    }
    let cos = ((one + v.x) * half).sqrt();
    let sin = v.y * half / cos;
    if sin * side < T::zero() { Vector2::new(-cos, -sin) } else { Vector2::new(cos, sin) }
}

/// The zeros of h as seen from the direction where the arc is entered.
pub(super) struct Near<T> {
    /// h over tan of half the angle, times e^2.
    pub h: [T; 5],
}

impl<T: Real> Near<T> {
    /// The same for a zero beside the axis, and its direction: as exact as h itself.
    #[inline(always)]
    pub fn beside(&self, v: &Vector2<T>, side: T, sign: T) -> (Vector2<T>, Vector2<T>) {
        let one = T::one();
        let x = self.close(v.y / (one + v.x), sign);
        // The rest of the way round is no small angle.
        let least = T::default_epsilon() * T::default_epsilon();
        let (x, turn) = if x * side >= least {
            (x, one)
        } else if x.abs() > constant(0.01) {
            (x, -one)
        } else {
            (least * side, one)
        };
        let square = x * x;
        let inverse = one / (one + square);
        let cos = inverse.sqrt() * turn;
        (Vector2::new(cos, x * cos), Vector2::new((one - square) * inverse, (x + x) * inverse))
    }

    /// The zero close to x, where h' has the given sign.
    #[inline(always)]
    fn close(&self, x: T, sign: T) -> T {
        let [h0, h1, h2, h3, h4] = self.h;
        let three = constant::<T>(3.0);
        let value = fma(fma(fma(fma(h4, x, h3), x, h2), x, h1), x, h0);
        let slope = fma(fma(fma(constant::<T>(4.0) * h4, x, three * h3), x, h2 + h2), x, h1);
        let bend = fma(fma(constant::<T>(12.0) * h4, x, constant::<T>(6.0) * h3), x, h2 + h2);
        let step = to_zero(value * sign, slope * sign, bend * sign);
        if step.abs() <= constant(0.01) { x + step } else { x }
    }
}

/// The distance to the zero of h + s x + b x^2 / 2 where it rises, or to the extremum if it has none. s must be positive there, up to rounding.
#[inline(always)]
fn to_zero<T: Real>(value: T, slope: T, bend: T) -> T {
    let two = constant::<T>(2.0);
    let square = slope * slope - two * value * bend;
    if square.plain() <= T::zero() {
        -slope / bend
    } else if slope > T::zero() {
        -two * value / (slope + square.sqrt())
    } else {
        (square.sqrt() - slope) / bend
    }
}
