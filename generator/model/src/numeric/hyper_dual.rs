//! Hyper-dual numbers, which carry derivatives: `a + b e1 + c e2 + d e1 e2` with e1^2 = e2^2 = 0.
//!
//! The coefficient of e1 gives velocities from positions, that of e2 accelerations from velocities.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A hyper-dual number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HyperDual {
    /// value
    pub re: f64,
    /// coefficient of e1
    pub e1: f64,
    /// coefficient of e2
    pub e2: f64,
    /// coefficient of e1 e2
    pub e12: f64,
}

impl HyperDual {
    /// A constant.
    pub const fn constant(re: f64) -> Self {
        HyperDual { re, e1: 0.0, e2: 0.0, e12: 0.0 }
    }

    /// Zero.
    pub const ZERO: HyperDual = HyperDual::constant(0.0);
    /// One.
    pub const ONE: HyperDual = HyperDual::constant(1.0);

    /// `value + e1 rate`, where both may carry e2.
    pub fn moving(value: HyperDual, rate: HyperDual) -> Self {
        HyperDual { re: value.re, e1: rate.re, e2: value.e2, e12: rate.e2 }
    }

    /// The value without what e1 carries.
    pub fn still(self) -> Self {
        HyperDual { e1: 0.0, e12: 0.0, ..self }
    }

    /// What e1 carries: the rate.
    pub fn rate(self) -> Self {
        HyperDual { re: self.e1, e1: 0.0, e2: self.e12, e12: 0.0 }
    }

    /// Whether all parts are finite.
    pub fn is_finite(self) -> bool {
        self.re.is_finite() && self.e1.is_finite() && self.e2.is_finite() && self.e12.is_finite()
    }

    /// A function of it, given the function's value and first two derivatives.
    fn chain(self, f: f64, f1: f64, f2: f64) -> Self {
        // a part that is exactly 0 stays so, even where a derivative is infinite
        let part = |slope: f64, part: f64| if part == 0.0 { 0.0 } else { slope * part };
        HyperDual {
            re: f,
            e1: part(f1, self.e1),
            e2: part(f1, self.e2),
            e12: part(f1, self.e12) + part(f2, self.e1 * self.e2),
        }
    }

    /// sine
    pub fn sin(self) -> Self {
        let (s, c) = self.re.sin_cos();
        self.chain(s, c, -s)
    }

    /// cosine
    pub fn cos(self) -> Self {
        let (s, c) = self.re.sin_cos();
        self.chain(c, -s, -c)
    }

    /// tangent
    pub fn tan(self) -> Self {
        let t = self.re.tan();
        let d = 1.0 + t * t;
        self.chain(t, d, 2.0 * t * d)
    }

    /// arc sine
    pub fn asin(self) -> Self {
        let w = 1.0 - self.re * self.re;
        self.chain(self.re.asin(), w.powf(-0.5), self.re * w.powf(-1.5))
    }

    /// arc cosine
    pub fn acos(self) -> Self {
        let w = 1.0 - self.re * self.re;
        self.chain(self.re.acos(), -w.powf(-0.5), -self.re * w.powf(-1.5))
    }

    /// arc tangent
    pub fn atan(self) -> Self {
        let w = 1.0 + self.re * self.re;
        self.chain(self.re.atan(), 1.0 / w, -2.0 * self.re / (w * w))
    }

    /// angle of the point (`x`, `self`)
    pub fn atan2(self, x: HyperDual) -> Self {
        // d atan2 = (x dy - y dx)/(x^2 + y^2): take the quotient whose divisor is larger, and put the branch
        // right
        let angle = self.re.atan2(x.re);
        let shape = if x.re.abs() >= self.re.abs() { (self / x).atan() } else { -(x / self).atan() };
        HyperDual { re: angle, ..shape }
    }

    /// square root
    pub fn sqrt(self) -> Self {
        let r = self.re.sqrt();
        self.chain(r, 0.5 / r, -0.25 / (r * self.re))
    }

    /// exponential
    pub fn exp(self) -> Self {
        let e = self.re.exp();
        self.chain(e, e, e)
    }

    /// natural logarithm
    pub fn ln(self) -> Self {
        self.chain(self.re.ln(), 1.0 / self.re, -1.0 / (self.re * self.re))
    }

    /// hyperbolic sine
    pub fn sinh(self) -> Self {
        let (s, c) = (self.re.sinh(), self.re.cosh());
        self.chain(s, c, s)
    }

    /// hyperbolic cosine
    pub fn cosh(self) -> Self {
        let (s, c) = (self.re.sinh(), self.re.cosh());
        self.chain(c, s, c)
    }

    /// hyperbolic tangent
    pub fn tanh(self) -> Self {
        let t = self.re.tanh();
        // 1 - t^2 would have no digits left where t is nearly 1
        let d = self.re.cosh().powi(-2);
        self.chain(t, d, -2.0 * t * d)
    }

    /// size
    pub fn abs(self) -> Self {
        if self.re < 0.0 { -self } else { self }
    }

    /// power with a constant exponent
    pub fn power(self, exponent: f64) -> Self {
        if exponent == 0.0 {
            return HyperDual::ONE;
        }
        let whole = exponent.fract() == 0.0 && exponent.abs() <= 1000.0;
        let raise = |e: f64| if whole { self.re.powi(e as i32) } else { self.re.powf(e) };
        let slope = |factor: f64, e: f64| if factor == 0.0 { 0.0 } else { factor * raise(e) };
        self.chain(
            raise(exponent),
            slope(exponent, exponent - 1.0),
            slope(exponent * (exponent - 1.0), exponent - 2.0),
        )
    }
}

impl Add for HyperDual {
    type Output = HyperDual;
    fn add(self, o: HyperDual) -> HyperDual {
        HyperDual { re: self.re + o.re, e1: self.e1 + o.e1, e2: self.e2 + o.e2, e12: self.e12 + o.e12 }
    }
}

impl Sub for HyperDual {
    type Output = HyperDual;
    fn sub(self, o: HyperDual) -> HyperDual {
        self + -o
    }
}

impl Neg for HyperDual {
    type Output = HyperDual;
    fn neg(self) -> HyperDual {
        HyperDual { re: -self.re, e1: -self.e1, e2: -self.e2, e12: -self.e12 }
    }
}

impl Mul for HyperDual {
    type Output = HyperDual;
    fn mul(self, o: HyperDual) -> HyperDual {
        HyperDual {
            re: self.re * o.re,
            e1: self.re * o.e1 + self.e1 * o.re,
            e2: self.re * o.e2 + self.e2 * o.re,
            e12: self.re * o.e12 + self.e12 * o.re + self.e1 * o.e2 + self.e2 * o.e1,
        }
    }
}

impl Div for HyperDual {
    type Output = HyperDual;
    fn div(self, o: HyperDual) -> HyperDual {
        let i = 1.0 / o.re;
        self * o.chain(i, -i * i, 2.0 * i * i * i)
    }
}

/// A vector by its components along N.x, N.y, N.z.
pub type Triple = [HyperDual; 3];

/// Sum of two vectors.
pub fn add(a: Triple, b: Triple) -> Triple {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Difference of two vectors.
pub fn sub(a: Triple, b: Triple) -> Triple {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Multiple of a vector.
pub fn scale(s: HyperDual, a: Triple) -> Triple {
    a.map(|c| s * c)
}

/// Dot product.
pub fn dot(a: Triple, b: Triple) -> HyperDual {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Cross product.
pub fn cross(a: Triple, b: Triple) -> Triple {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Rotation matrices and inertia matrices, row by row.
pub type Matrix3 = [Triple; 3];

/// Product of two matrices.
pub fn product(a: &Matrix3, b: &Matrix3) -> Matrix3 {
    let mut out = [[HyperDual::ZERO; 3]; 3];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    out
}

/// Transposed matrix.
pub fn transposed(a: &Matrix3) -> Matrix3 {
    let mut out = *a;
    for (i, row) in out.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = a[j][i];
        }
    }
    out
}

/// Matrix times vector.
pub fn apply(a: &Matrix3, v: Triple) -> Triple {
    a.map(|row| dot(row, v))
}

/// The matrix that changes nothing.
pub const IDENTITY: Matrix3 = [
    [HyperDual::ONE, HyperDual::ZERO, HyperDual::ZERO],
    [HyperDual::ZERO, HyperDual::ONE, HyperDual::ZERO],
    [HyperDual::ZERO, HyperDual::ZERO, HyperDual::ONE],
];

#[cfg(test)]
mod tests {
    use super::HyperDual;

    /// Values and derivatives agree with differences.
    #[test]
    fn derivatives() {
        type Function = fn(HyperDual) -> HyperDual;
        let functions: [Function; 15] = [
            HyperDual::sin,
            HyperDual::cos,
            HyperDual::tan,
            HyperDual::asin,
            HyperDual::acos,
            HyperDual::atan,
            HyperDual::sqrt,
            HyperDual::exp,
            HyperDual::ln,
            HyperDual::sinh,
            HyperDual::cosh,
            HyperDual::tanh,
            |x| x.power(3.0) / (x + HyperDual::constant(2.0)),
            |x| x.power(-1.5),
            |x| x.atan2(HyperDual::constant(0.3) - x),
        ];
        for f in functions {
            let (x, h) = (0.4, 1e-4);
            let d = f(HyperDual { re: x, e1: 1.0, e2: 1.0, e12: 0.0 });
            let at = |x: f64| f(HyperDual::constant(x)).re;
            let first = (at(x + h) - at(x - h)) / (2.0 * h);
            let second = (at(x + h) - 2.0 * at(x) + at(x - h)) / (h * h);
            assert!((d.e1 - first).abs() < 1e-5 * (1.0 + first.abs()));
            assert!((d.e2 - first).abs() < 1e-5 * (1.0 + first.abs()));
            assert!((d.e12 - second).abs() < 1e-3 * (1.0 + second.abs()));
        }
    }
}
