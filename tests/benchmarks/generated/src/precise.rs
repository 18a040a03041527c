//! Numbers with twice the digits of a double: the unevaluated sum of two (Dekker 1971), some 31 decimal
//! digits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use hodograph_generator::arithmetic::Function;
use hodograph_generator::program::Program;
use hodograph_generator::program::Quantity;
use hodograph_generator::program::graph::Input;
use hodograph_generator::program::operation::{Operation, Value};

/// `high + low`, where `low` is at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precise {
    /// the nearest double
    pub high: f64,
    /// what it lacks
    pub low: f64,
}

/// pi/2 = `HALF_PI[0] + HALF_PI[1] + HALF_PI[2]`
const HALF_PI: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123233995736766e-17, -1.4973849048591698e-33];

/// Sum of two doubles and its rounding error.
fn sum(a: f64, b: f64) -> Precise {
    let high = a + b;
    let part = high - a;
    Precise { high, low: (a - (high - part)) + (b - part) }
}

/// Product of two doubles and its rounding error.
fn product(a: f64, b: f64) -> Precise {
    let high = a * b;
    Precise { high, low: a.mul_add(b, -high) }
}

impl From<f64> for Precise {
    fn from(high: f64) -> Self {
        Precise { high, low: 0.0 }
    }
}

impl Add for Precise {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let first = sum(high.high, high.low + low.high);
        sum(first.high, first.low + low.low)
    }
}

impl Neg for Precise {
    type Output = Self;
    fn neg(self) -> Self {
        Precise { high: -self.high, low: -self.low }
    }
}

impl Sub for Precise {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Precise {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let main = product(self.high, other.high);
        sum(main.high, main.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Precise {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = Precise::from(self.high / other.high);
        let rest = self - first * other;
        let second = Precise::from(rest.high / other.high);
        let rest = rest - second * other;
        first + second + Precise::from(rest.high / other.high)
    }
}

impl Precise {
    /// Square root of a positive number.
    pub fn sqrt(self) -> Self {
        let near = Precise::from(self.high.sqrt());
        // one step of Newton's method doubles the digits
        (near + self / near) * Precise::from(0.5)
    }

    /// Sine and cosine of an angle of some turns: power series about the nearest multiple of pi/2.
    pub fn sin_cos(self) -> (Self, Self) {
        let turns = (self.high / HALF_PI[0]).round();
        let away = HALF_PI.iter().fold(self, |rest, &part| rest - product(turns, part));
        let square = -(away * away);
        let (mut sine, mut cosine) = (Precise::from(0.0), Precise::from(0.0));
        let mut term = Precise::from(1.0);
        for n in 0..15 {
            cosine = cosine + term;
            let odd = term * away / Precise::from(f64::from(2 * n + 1));
            sine = sine + odd;
            term = term * square / Precise::from(f64::from((2 * n + 1) * (2 * n + 2)));
        }
        match (turns as i64).rem_euclid(4) {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
}

/// The numbers of some quantities, one after the other, as a program finds them in these numbers; or the
/// operation that is not known in them.
pub fn evaluate(
    program: &Program,
    quantities: &[Quantity],
    input: impl Fn(Input) -> Precise,
) -> Result<Vec<Precise>, String> {
    let slice = program.slice(quantities);
    let zero = Precise::from(0.0);
    let mut numbers = vec![(zero, zero); program.operations.len()];
    for &value in &slice.order {
        let at = |value: Value| numbers[value.index()].0;
        use Operation::{
            Add, Constant, Cosine, Div, Mul, MulAdd, MulSub, Neg, NegMulAdd, Recip, SinCos, Sine, Sub,
        };
        let number = match program.operation(value) {
            Constant(bits) => Precise::from(bits.get()),
            Operation::Input(from) => input(from),
            Neg(a) => -at(a),
            Add(a, b) => at(a) + at(b),
            Sub(a, b) => at(a) - at(b),
            Mul(a, b) => at(a) * at(b),
            Div(a, b) => at(a) / at(b),
            Recip(a) => Precise::from(1.0) / at(a),
            MulAdd(a, b, c) => at(a) * at(b) + at(c),
            MulSub(a, b, c) => at(a) * at(b) - at(c),
            NegMulAdd(a, b, c) => at(c) - at(a) * at(b),
            SinCos(a) => {
                numbers[value.index()] = at(a).sin_cos();
                continue;
            }
            Sine(a) => at(a),
            Cosine(a) => numbers[a.index()].1,
            Operation::Call(Function::Sin, a) => at(a).sin_cos().0,
            Operation::Call(Function::Cos, a) => at(a).sin_cos().1,
            Operation::Call(Function::Abs, a) => {
                if at(a).high < 0.0 {
                    -at(a)
                } else {
                    at(a)
                }
            }
            other => return Err(format!("{other:?} is not known to twice the digits")),
        };
        numbers[value.index()].0 = number;
    }
    let values = slice.outputs.iter().flat_map(|output| &output.values);
    Ok(values.map(|value| numbers[value.index()].0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Precise, b: Precise, to: f64) {
        let off = a - b;
        assert!((off.high + off.low).abs() <= to, "{a:?} {b:?}");
    }

    #[test]
    fn arithmetic_has_thirty_digits() {
        let third = Precise::from(1.0) / Precise::from(3.0);
        close(third * Precise::from(3.0), Precise::from(1.0), 1e-31);
        let two = Precise::from(2.0);
        close(two.sqrt() * two.sqrt(), two, 1e-30);
    }

    #[test]
    fn sines_and_cosines_have_thirty_digits() {
        for k in -40..40 {
            let angle = Precise::from(0.37 * f64::from(k));
            let ((s, c), (s2, c2)) = (angle.sin_cos(), (angle + angle).sin_cos());
            close(s * s + c * c, Precise::from(1.0), 1e-30);
            close((s * c) + (s * c), s2, 1e-30);
            close(c * c - s * s, c2, 1e-30);
            assert!((s.high - angle.high.sin()).abs() < 1e-15);
        }
        // sin 1, cos 1
        let (s, c) = Precise::from(1.0).sin_cos();
        close(s, Precise { high: 0.8414709848078965, low: 1.776_845_092_935_536e-18 }, 1e-24);
        close(c, Precise { high: 0.5403023058681398, low: -4.760_954_612_604_417e-17 }, 1e-23);
    }
}
