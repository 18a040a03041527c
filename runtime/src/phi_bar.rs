//! phi_bar, the direction in which slip stops, and all directions that slip keeps.
//!
//! Theory: docs/theory.md, section 12.

use nalgebra::Vector2;

use crate::{Characteristics, ReducedMatrix, Scalar, rates, scalar::constant, solve::Contact};

/// phi_bar: the direction in which slip that now has the direction `phi` will be when it stops, in radians
/// from t towards s, within a turn of `phi`.
///
/// It is the first zero of h in the direction in which h turns the slip (34a), or `phi` itself if h is zero
/// there. `None` if slip never stops by itself (g >= 0 there; then that direction is phi_hat).
///
/// It takes at most some 10 000 operations: h is a polynomial of degree four in the tangent of half the
/// angle, whose zeros are found by bisection between those of its derivatives.
pub fn phi_bar<T: Scalar>(matrix: &ReducedMatrix<T>, mu: T, phi: T) -> Option<T> {
    let c = Contact::new(matrix, mu);
    let noise = constant::<T>(4.0) * T::default_epsilon() * c.slip_size();
    let right_angle = T::frac_pi_2();
    let side = {
        let (sin, cos) = phi.sin_cos();
        let d = Vector2::new(cos, sin);
        let [.., h] = c.rates(&d);
        if h.abs() <= noise {
            T::zero()
        } else if h > T::zero() {
            T::one()
        } else {
            -T::one()
        }
    };
    let mut found = phi;
    if side != T::zero() {
        // h has no mean over a turn, so it has a zero.
        for quarter in 0..4 {
            let base = phi + side * right_angle * constant::<T>(f64::from(quarter));
            if let Some(x) = first_zero(&polynomial(matrix, mu, base, side)) {
                let two = constant::<T>(2.0);
                found = base + side * two * x.atan();
                break;
            }
        }
    }
    let g = rates(matrix, mu, found).y;
    (g < T::zero()).then_some(found)
}

/// The invariant directions of slip, from t towards s, in radians: the zeros of h(mu, phi) (33) at which it
/// changes its sign, two or four, in order in (-pi, pi].
///
/// Slip that has one of them keeps it. They are the directions in which the circle of radius mu meets the
/// hyperbola h = 0 of Appendix B. Where h is zero everywhere, every direction is one, and there is no answer.
///
/// Like [`phi_bar`] it finds zeros by bisection, some 20 000 operations.
pub fn invariant_directions<T: Scalar>(matrix: &ReducedMatrix<T>, mu: T) -> [Option<T>; 4] {
    let mut found = [None; 4];
    let (mut count, mut wrapped) = (0, 0);
    // Not at an axis, where symmetric contacts have zeros: one at the end of a range may be found twice.
    let start = constant::<T>(BEGIN) - T::pi();
    for quarter in 0..4 {
        let base = start + T::frac_pi_2() * constant::<T>(f64::from(quarter));
        let (zeros, many) = zeros(&polynomial(matrix, mu, base, T::one()));
        for x in zeros.into_iter().take(many) {
            let angle = base + constant::<T>(2.0) * x.atan();
            let beyond = angle > T::pi();
            if let Some(slot) = found.get_mut(count) {
                *slot = Some(if beyond { angle - T::two_pi() } else { angle });
                count += 1;
                wrapped += usize::from(beyond);
            }
        }
    }
    // Those beyond pi come last and are the least.
    if let Some(all) = found.get_mut(..count) {
        all.rotate_right(wrapped);
    }
    found
}

/// Where the search for invariant directions begins, in radians.
const BEGIN: f64 = 0.123_456_789;

impl<T: Scalar> Characteristics<T> {
    /// [`phi_bar`] for slip along t, the paper's case.
    #[inline]
    pub fn phi_bar(matrix: &ReducedMatrix<T>, mu: T) -> Option<T> {
        phi_bar(matrix, mu, T::zero())
    }
}

/// side h(base + side delta) (1 + x^2)^2 / m_nn in x = tan(delta / 2), constant first.
fn polynomial<T: Scalar>(matrix: &ReducedMatrix<T>, mu: T, base: T, side: T) -> [T; 5] {
    let (sin, cos) = base.sin_cos();
    let two = constant::<T>(2.0);
    let m = matrix.turned(cos, sin);
    let unit = T::one() / matrix.nn;
    let (b1, b2, m12) = (m.nt * unit, side * m.ns * unit, side * mu * m.ts * unit);
    let difference = two * mu * (m.tt - m.ss) * unit;
    [b2 - m12, difference - two * b1, constant::<T>(6.0) * m12, -difference - two * b1, -b2 - m12]
}

/// The first zero in (0, 1] of a polynomial that is not negative at 0.
fn first_zero<T: Scalar>(p: &[T; 5]) -> Option<T> {
    let ([first, ..], count) = zeros(p);
    (count > 0).then_some(first)
}

/// The zeros in (0, 1] of a polynomial at which its sign changes, in order, and their number.
fn zeros<T: Scalar>(p: &[T; 5]) -> ([T; 5], usize) {
    // Zeros of the fourth to the first derivative, and of the polynomial itself, in order; one is the end of
    // the range.
    let mut ends = [T::one(); 5];
    let mut count = 0;
    for order in (0..4_usize).rev() {
        let mut next = [T::one(); 5];
        let mut found = 0;
        let mut low = T::zero();
        for high in ends.iter().copied().take(count + 1) {
            if let Some(zero) = bisect(p, order, low, high)
                && let Some(slot) = next.get_mut(found)
            {
                *slot = zero;
                found += 1;
            }
            low = high;
        }
        (ends, count) = (next, found);
    }
    (ends, count)
}

/// A derivative of the polynomial at x.
fn derivative<T: Scalar>(p: &[T; 5], order: usize, x: T) -> T {
    let mut total = T::zero();
    for (power, coefficient) in p.iter().enumerate().skip(order).rev() {
        let factor = (power - order + 1..=power).map(|k| k as f64).product::<f64>();
        total = total * x + *coefficient * constant(factor);
    }
    total
}

/// The zero of a derivative between two places, between which it is monotone.
fn bisect<T: Scalar>(p: &[T; 5], order: usize, mut low: T, mut high: T) -> Option<T> {
    let zero = T::zero();
    let rises = derivative(p, order, low) < zero;
    if (derivative(p, order, high) < zero) == rises {
        return None;
    }
    for _ in 0..64 {
        let middle = (low + high) * constant(0.5);
        if (derivative(p, order, middle) < zero) == rises {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= T::default_epsilon() * high {
            break;
        }
    }
    Some(high)
}
