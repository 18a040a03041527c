//! Dimensions: powers of metre, kilogram and second. Radians count as 1.

use num_rational::Ratio;
use num_traits::{CheckedAdd, CheckedMul, CheckedSub, Zero};

/// An exponent, such as 2 or 1/2.
pub type Exponent = Ratio<i32>;

/// A dimension: the exponents of metre, kilogram and second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Dimension {
    /// metre, kilogram, second
    pub exponents: [Exponent; 3],
}

impl Dimension {
    /// No dimension: numbers, angles.
    pub fn none() -> Self {
        Dimension { exponents: [Exponent::zero(); 3] }
    }

    /// Whole powers of metre, kilogram and second.
    pub fn of(m: i32, kg: i32, s: i32) -> Self {
        Dimension { exponents: [m, kg, s].map(Exponent::from_integer) }
    }

    /// Whether it is a plain number.
    pub fn is_none(&self) -> bool {
        self.exponents.iter().all(Zero::is_zero)
    }

    /// Of a product; `None` where an exponent leaves all bounds.
    pub fn times(&self, other: &Dimension) -> Option<Dimension> {
        self.combine(other, CheckedAdd::checked_add)
    }

    /// Of a quotient; `None` where an exponent leaves all bounds.
    pub fn over(&self, other: &Dimension) -> Option<Dimension> {
        self.combine(other, CheckedSub::checked_sub)
    }

    /// Of a power; `None` where an exponent leaves all bounds.
    pub fn power(&self, exponent: Exponent) -> Option<Dimension> {
        let mut exponents = self.exponents;
        for e in &mut exponents {
            *e = bounded(e.checked_mul(&exponent)?)?;
        }
        Some(Dimension { exponents })
    }

    fn combine(
        &self,
        other: &Dimension,
        op: fn(&Exponent, &Exponent) -> Option<Exponent>,
    ) -> Option<Dimension> {
        let mut exponents = self.exponents;
        for (e, o) in exponents.iter_mut().zip(&other.exponents) {
            *e = bounded(op(e, o)?)?;
        }
        Some(Dimension { exponents })
    }
}

/// Bounds keep the arithmetic of exponents far from overflow.
fn bounded(e: Exponent) -> Option<Exponent> {
    (e.numer().abs() <= 1000 && *e.denom() <= 1000).then_some(e)
}

impl std::fmt::Display for Dimension {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let known = [
            ((1, 1, -2), "N"),
            ((2, 1, -2), "N*m"),
            ((0, 1, -2), "N/m"),
            ((0, 1, -1), "N*s/m"),
            ((2, 1, -1), "N*m*s"),
            ((0, 0, -1), "rad/s"),
        ];
        if self.is_none() {
            return f.write_str("1");
        }
        if let Some((_, name)) = known.iter().find(|((m, kg, s), _)| *self == Dimension::of(*m, *kg, *s)) {
            return f.write_str(name);
        }
        let symbols = ["m", "kg", "s"];
        let write = |f: &mut std::fmt::Formatter<'_>, symbol: &str, e: Exponent| {
            if e == Exponent::from_integer(1) {
                f.write_str(symbol)
            } else if e.is_integer() {
                write!(f, "{symbol}^{e}")
            } else {
                write!(f, "{symbol}^({e})")
            }
        };
        let mut first = true;
        // kg before m, as it is commonly written
        for i in [1, 0, 2] {
            let e = self.exponents[i];
            if *e.numer() > 0 {
                if !first {
                    f.write_str("*")?;
                }
                first = false;
                write(f, symbols[i], e)?;
            }
        }
        if first {
            f.write_str("1")?;
        }
        for i in [1, 0, 2] {
            let e = self.exponents[i];
            if *e.numer() < 0 {
                f.write_str("/")?;
                write(f, symbols[i], -e)?;
            }
        }
        Ok(())
    }
}
