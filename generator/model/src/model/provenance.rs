//! The declared names from which the dimension of an expression follows, with their powers.

use num_traits::{CheckedAdd, CheckedMul, Zero};

use super::names::Symbol;
use crate::dimension::Exponent;

/// What depends on more names than this is not traced back to them.
const MOST_NAMES: usize = 32;

/// The powers in which names enter a product, in the order of names, none of them 0; `None` where there are
/// too many.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance(Option<Vec<(Symbol, Exponent)>>);

impl Default for Provenance {
    fn default() -> Self {
        Provenance::none()
    }
}

impl Provenance {
    /// Of what holds no name.
    pub fn none() -> Self {
        Provenance(Some(Vec::new()))
    }

    /// Of a name.
    pub fn of(symbol: Symbol) -> Self {
        Provenance(Some(vec![(symbol, Exponent::from_integer(1))]))
    }

    /// Of a product.
    pub fn times(&self, other: &Provenance) -> Provenance {
        self.combine(other, Exponent::from_integer(1))
    }

    /// Of a quotient.
    pub fn over(&self, other: &Provenance) -> Provenance {
        self.combine(other, Exponent::from_integer(-1))
    }

    /// Of a power.
    pub fn power(&self, exponent: Exponent) -> Provenance {
        Provenance::none().combine(self, exponent)
    }

    fn combine(&self, other: &Provenance, factor: Exponent) -> Provenance {
        let (Some(a), Some(b)) = (&self.0, &other.0) else { return Provenance(None) };
        let mut sum = a.clone();
        for (symbol, exponent) in b {
            let Some(exponent) = exponent.checked_mul(&factor) else { return Provenance(None) };
            match sum.binary_search_by_key(symbol, |(symbol, _)| *symbol) {
                Ok(i) => match sum[i].1.checked_add(&exponent) {
                    Some(total) => sum[i].1 = total,
                    None => return Provenance(None),
                },
                Err(i) => sum.insert(i, (*symbol, exponent)),
            }
        }
        sum.retain(|(_, exponent)| !exponent.is_zero());
        let bounded = |e: &Exponent| e.numer().abs() <= 1000 && *e.denom() <= 1000;
        let moderate = sum.len() <= MOST_NAMES && sum.iter().all(|(_, e)| bounded(e));
        Provenance(moderate.then_some(sum))
    }

    /// Whether it holds no name.
    pub fn is_empty(&self) -> bool {
        self.0.as_ref().is_some_and(Vec::is_empty)
    }

    /// The names and their powers; nothing where there are too many.
    pub fn names(&self) -> &[(Symbol, Exponent)] {
        self.0.as_deref().unwrap_or_default()
    }

    /// The power of a name.
    pub fn of_name(&self, symbol: Symbol) -> Exponent {
        let names = self.names();
        names.binary_search_by_key(&symbol, |(symbol, _)| *symbol).map_or(Exponent::zero(), |i| names[i].1)
    }
}
