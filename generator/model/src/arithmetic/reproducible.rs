//! Numbers of which every operation gives the same bits on every machine and in every build. Decisions on
//! which a derivation depends are made with them.
//!
//! They have twice the digits of a double, do not depend on fused operations, and have functions of their
//! own, since those of operating systems differ in the last digit. Expressions that are identically 0 come
//! out below 1e-30 of their terms.

use std::ops::{Add, Div, Mul, Neg, Sub};

use hodograph_arithmetic::DoubleDouble;
use num_rational::BigRational;

use super::doubles::{self, Arithmetic};
use super::function::Function;
use super::large_angles;
use crate::number::Number;

/// Angles up to here are reduced here, rad; larger ones need more digits of pi.
const LARGEST: f64 = 524288.0;

/// A number of twice the digits.
#[derive(Clone, Copy, Debug)]
pub struct Reproducible(DoubleDouble<f64>);

/// A function of a double, to the nearest double; NaN if it is one of two.
pub fn call(function: Function, a: f64) -> f64 {
    Reproducible::exactly(a).call(function).rounded()
}

/// A function of two doubles, to the nearest double; NaN if it is one of one.
pub fn call2(function: Function, a: f64, b: f64) -> f64 {
    Reproducible::exactly(a).call2(function, Reproducible::exactly(b)).rounded()
}

impl Reproducible {
    /// The nearest double.
    pub fn rounded(self) -> f64 {
        self.0.rounded()
    }

    /// The nearest number to an exact one.
    pub fn nearest(number: &Number) -> Self {
        let high = number.to_f64();
        let rest = BigRational::from_float(high).map_or(0.0, |high| Number(&number.0 - high).to_f64());
        Self::parts(high, rest)
    }

    /// pi
    pub fn pi() -> Self {
        Self::half_pi() * Self::exactly(2.0)
    }

    fn parts(high: f64, low: f64) -> Self {
        Self::exactly(high) + Self::exactly(low)
    }

    fn half_pi() -> Self {
        Self::parts(std::f64::consts::FRAC_PI_2, 6.123233995736766e-17)
    }

    /// How many times `unit` is in it, and what is left.
    fn reduced(self, unit: Self) -> (f64, Self) {
        let times = (self.rounded() / unit.rounded()).round();
        (times, self - Self::exactly(times) * unit)
    }

    /// The even and the odd part of the exponential series, or with alternating signs those of cosine and
    /// sine; up to pi/4.
    fn series(self, alternating: bool) -> (Self, Self) {
        let (mut term, mut sums) = (Self::exactly(1.0), [Self::exactly(1.0), Self::exactly(0.0)]);
        for power in 1..32_u32 {
            term = term * self / Self::exactly(power.into());
            sums[power as usize % 2] = match alternating && power % 4 > 1 {
                true => sums[power as usize % 2] - term,
                false => sums[power as usize % 2] + term,
            };
        }
        (sums[0], sums[1])
    }

    fn exp(self) -> Self {
        // Beyond, nearly all is infinity or zero.
        let near = self.rounded();
        if near.abs() >= 700.0 || near.is_nan() {
            return Self::exactly(near.exp());
        }
        let (times, rest) = self.reduced(Self::parts(std::f64::consts::LN_2, 2.3190468138462996e-17));
        let (even, odd) = rest.series(false);
        (even + odd) * Self::exactly(2f64.powi(times as i32))
    }

    fn hyperbolic(self, function: Function) -> Self {
        let half = Self::exactly(0.5);
        let size = self.rounded().abs();
        // sinh and cosh: near 0 the series, which cancels nothing, and far from it the larger exponential
        // alone
        let (cosh, sinh) = if size <= 0.7 {
            self.series(false)
        } else if size <= 100.0 {
            let (up, down) = (self.exp(), (-self).exp());
            ((up + down) * half, (up - down) * half)
        } else {
            let sign = Self::exactly(1f64.copysign(self.rounded()));
            // half of it first: the whole may be infinite
            let up = (self * sign - Self::parts(std::f64::consts::LN_2, 2.3190468138462996e-17)).exp();
            (up, up * sign)
        };
        match function {
            Function::Sinh => sinh,
            Function::Cosh => cosh,
            _ if size > 100.0 => Self::exactly(1f64.copysign(self.rounded())),
            _ => sinh / cosh,
        }
    }

    /// The system's logarithm, improved by a step of Newton's method.
    fn log(self) -> Self {
        let near = Self::exactly(self.rounded().ln());
        let rest = self * (-near).exp() - Self::exactly(1.0);
        near.improved(rest)
    }

    /// The angle of (b, self), likewise.
    fn angle(self, b: Self) -> Self {
        let near = Self::exactly(self.rounded().atan2(b.rounded()));
        let (sine, cosine) = near.sin_cos();
        near.improved((self * cosine - b * sine) / (b * cosine + self * sine))
    }

    /// With a correction, where there is one.
    fn improved(self, by: Self) -> Self {
        if by.rounded().is_finite() { self + by } else { self }
    }

    fn sqrt(self) -> Self {
        Reproducible(self.0.sqrt())
    }

    /// The other side of a right triangle whose longest side is 1.
    fn other(self) -> Self {
        let one = Self::exactly(1.0);
        ((one - self) * (one + self)).sqrt()
    }
}

impl Arithmetic for Reproducible {
    fn exactly(number: f64) -> Self {
        Reproducible(DoubleDouble::new(number))
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    fn sin_cos(self) -> (Self, Self) {
        let near = self.rounded();
        if !near.is_finite() {
            return (Self::exactly(f64::NAN), Self::exactly(f64::NAN));
        }
        let (quarter, rest) = if near.abs() > LARGEST {
            let low = (self - Self::exactly(near)).rounded();
            let (quarter, [high, low]) = large_angles::reduced(near, low);
            (quarter, Self::parts(high, low))
        } else {
            let (turns, rest) = self.reduced(Self::half_pi());
            (turns.rem_euclid(4.0) as u8, rest)
        };
        let (cosine, sine) = rest.series(true);
        match quarter {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }

    fn call(self, function: Function) -> Self {
        match function {
            Function::Sin => self.sin_cos().0,
            Function::Cos => self.sin_cos().1,
            Function::Tan => {
                let (sine, cosine) = self.sin_cos();
                sine / cosine
            }
            Function::Asin => self.angle(self.other()),
            Function::Acos => self.other().angle(self),
            Function::Atan => self.angle(Self::exactly(1.0)),
            Function::Exp => self.exp(),
            Function::Log => self.log(),
            Function::Sinh | Function::Cosh | Function::Tanh => self.hyperbolic(function),
            Function::Sqrt | Function::Abs => Reproducible(self.0.call(function)),
            Function::Sign => Self::exactly(doubles::call(function, self.rounded())),
            Function::Frozen => self,
            Function::Atan2 | Function::Min | Function::Max => Self::exactly(f64::NAN),
        }
    }

    fn call2(self, function: Function, b: Self) -> Self {
        match function {
            Function::Atan2 => self.angle(b),
            Function::Min | Function::Max => Reproducible(self.0.call2(function, b.0)),
            _ => Self::exactly(f64::NAN),
        }
    }
}

impl Add for Reproducible {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Reproducible(self.0 + other.0)
    }
}

impl Sub for Reproducible {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Reproducible(self.0 - other.0)
    }
}

impl Mul for Reproducible {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Reproducible(self.0 * other.0)
    }
}

impl Div for Reproducible {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Reproducible(self.0 / other.0)
    }
}

impl Neg for Reproducible {
    type Output = Self;
    fn neg(self) -> Self {
        Reproducible(-self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Function::*;

    fn of(number: f64) -> Reproducible {
        Reproducible::exactly(number)
    }

    fn vanishes(difference: Reproducible, context: &str) {
        assert!(difference.rounded().abs() < 1e-28, "{context}: {difference:?}");
    }

    #[test]
    fn functions_keep_twice_the_digits() {
        for step in -40..=40 {
            let x = f64::from(step) * 0.0371;
            let ((s, c), one) = ((of(3.0) * of(x)).sin_cos(), of(1.0));
            let name = format!("{x}");
            vanishes(s * s + c * c - one, &name);
            let (s1, c1) = of(x).sin_cos();
            vanishes(s - (of(3.0) * s1 - of(4.0) * s1 * s1 * s1), &name);
            vanishes(of(x).exp() * of(-x).exp() - one, &name);
            vanishes(of(x).exp().log() - of(x), &name);
            let [sinh, cosh, tanh] = [Sinh, Cosh, Tanh].map(|function| of(x).call(function));
            vanishes(cosh * cosh - sinh * sinh - one, &name);
            vanishes(cosh + sinh - of(x).exp(), &name);
            vanishes(tanh * cosh - sinh, &name);
            vanishes(of(x).call(Tan).call(Atan) - of(x), &name);
            vanishes(s1.call2(Atan2, c1) - of(x), &name);
            let (s, c) = of(x * 1e13).sin_cos();
            vanishes(s * s + c * c - one, &name);
            let (s2, _) = (of(2.0) * of(x * 1e13)).sin_cos();
            vanishes(s2 - of(2.0) * s * c, &name);
            vanishes(s1.call(Asin).sin_cos().0 - s1, &name);
            vanishes(c1.call(Acos).sin_cos().1 - c1, &name);
        }
    }

    #[test]
    fn functions_are_those_of_the_system_but_for_its_last_digit() {
        for function in [Sin, Cos, Tan, Asin, Acos, Atan, Sqrt, Exp, Log, Sinh, Cosh, Tanh, Abs, Sign] {
            for x in
                [0.0, 1e-300, 0.3, 1.0, -0.7, 2.5, -40.0, 699.0, 1e4, 1e9, 1e300, f64::INFINITY, f64::NAN]
            {
                let (found, expected) = (call(function, x), doubles::call(function, x));
                let same = found == expected || found.is_nan() && expected.is_nan();
                assert!(
                    same || (found - expected).abs() <= 4e-16 * expected.abs(),
                    "{function:?} {x}: {found} {expected}"
                );
            }
        }
        for (a, b) in [(0.0, 0.0), (1.0, 0.0), (0.0, -1.0), (-2.0, -3.0), (1e300, 1e-300)] {
            for function in [Atan2, Min, Max] {
                let (found, expected) = (call2(function, a, b), doubles::call2(function, a, b));
                assert!((found - expected).abs() <= 4e-16 * expected.abs(), "{function:?} {a} {b}: {found}");
            }
        }
        assert!(call(Max, 1.0).is_nan() && call2(Sin, 1.0, 1.0).is_nan());
    }

    #[test]
    fn the_nearest_double_to_digits_from_a_table() {
        assert_eq!(call(Sin, 1.0), 0.841_470_984_807_896_5);
        assert_eq!(call(Sin, std::f64::consts::PI), 1.224_646_799_147_353_2e-16);
        assert_eq!(call(Exp, 1.0), std::f64::consts::E);
        assert_eq!(call(Log, 10.0), std::f64::consts::LN_10);
        assert_eq!(call(Acos, -1.0), std::f64::consts::PI);
    }
}
