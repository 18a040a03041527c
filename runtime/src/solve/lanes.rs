//! Arrays of four numbers that undergo the same operations, so that the compiler keeps them in one vector
//! register; their exponential.
//!
//! Theory: docs/theory.md, section 5.

use crate::scalar::{Arithmetic, constant, fma};

/// Four numbers.
pub(super) type Lanes<T> = [T; 4];

/// The same number four times.
#[inline(always)]
fn all<T: Arithmetic>(x: T) -> Lanes<T> {
    [x; 4]
}

#[inline(always)]
fn zip<T: Arithmetic>(a: Lanes<T>, b: Lanes<T>, f: impl Fn(T, T) -> T) -> Lanes<T> {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (a, b);
    [f(a0, b0), f(a1, b1), f(a2, b2), f(a3, b3)]
}

#[inline(always)]
fn add<T: Arithmetic>(a: Lanes<T>, b: Lanes<T>) -> Lanes<T> {
    zip(a, b, |a, b| a + b)
}

#[inline(always)]
fn sub<T: Arithmetic>(a: Lanes<T>, b: Lanes<T>) -> Lanes<T> {
    zip(a, b, |a, b| a - b)
}

#[inline(always)]
fn mul<T: Arithmetic>(a: Lanes<T>, b: Lanes<T>) -> Lanes<T> {
    zip(a, b, |a, b| a * b)
}

#[inline(always)]
fn div<T: Arithmetic>(a: Lanes<T>, b: Lanes<T>) -> Lanes<T> {
    zip(a, b, |a, b| a / b)
}

/// a b + c.
#[inline(always)]
fn mul_add<T: Arithmetic>(a: Lanes<T>, b: Lanes<T>, c: Lanes<T>) -> Lanes<T> {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3], [c0, c1, c2, c3]) = (a, b, c);
    [fma(a0, b0, c0), fma(a1, b1, c1), fma(a2, b2, c2), fma(a3, b3, c3)]
}

/// Coefficients of (y coth(y / 2) - 2) / y^2 as a polynomial in y^2, the highest first.
const COTH: [f64; 7] = [
    2.676_507_306_136_935_8e-11,
    -1.056_838_027_737_498_6e-9,
    1.0 / 23_950_080.0,
    -1.0 / 604_800.0,
    1.0 / 15_120.0,
    -1.0 / 360.0,
    1.0 / 6.0,
];

/// The exponential. For abs(x) up to nine its error is a few rounding units of max(e^x, 1); up to twelve it
/// is 5e-14 of that.
///
/// E = e^y - 1 = 2 y / (y coth(y / 2) - y) for y = x / 16, and then four times E <- (1 + E)^2 - 1 = E (E +
/// 2), which loses no digits.
#[inline(always)]
pub(super) fn exp<T: Arithmetic>(x: Lanes<T>) -> Lanes<T> {
    let two = all(constant(2.0));
    let y = mul(x, all(constant(0.0625)));
    let z = mul(y, y);
    let [c7, c6, c5, c4, c3, c2, c1] = COTH;
    let mut g = mul_add(z, all(constant(c7)), all(constant(c6)));
    for c in [c5, c4, c3, c2, c1] {
        g = mul_add(g, z, all(constant(c)));
    }
    let g = mul_add(g, z, two);
    let mut e = div(add(y, y), sub(g, y));
    for _ in 0..4 {
        e = mul(e, add(e, two));
    }
    add(e, all(T::one()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_those_of_the_library() {
        for step in -1200..=1200 {
            let x = f64::from(step) * 0.01;
            let [e, ..] = exp(all(x));
            let tolerance = if x.abs() <= 9.5 { 4e-15 } else { 5e-14 };
            assert!((e - x.exp()).abs() <= tolerance * x.exp().max(0.1), "{x}: {e}");
        }
    }
}
