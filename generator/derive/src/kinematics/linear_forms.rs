//! Scalars and vectors as forms linear in the generalised speeds: every velocity is such a form.

use std::collections::BTreeMap;

use crate::algebra::{Expr, Intermediates};

/// Components along three axes.
pub type Triple = [Expr; 3];

/// A triple of zeros.
pub fn zero() -> Triple {
    [Expr::zero(), Expr::zero(), Expr::zero()]
}

/// Whether all components are the number 0.
pub fn is_zero(v: &Triple) -> bool {
    v.iter().all(Expr::is_zero)
}

/// `a + b`.
pub fn add(a: &Triple, b: &Triple) -> Triple {
    std::array::from_fn(|i| a[i].add(&b[i]))
}

/// `k v`.
pub fn scale(k: &Expr, v: &Triple) -> Triple {
    std::array::from_fn(|i| k.mul(&v[i]))
}

/// `a . b`.
pub fn dot(a: &Triple, b: &Triple) -> Expr {
    Expr::sum(&std::array::from_fn::<_, 3, _>(|i| a[i].mul(&b[i])))
}

/// `a x b`.
pub fn cross(a: &Triple, b: &Triple) -> Triple {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].mul(&b[k]).sub(&a[k].mul(&b[j]))
    })
}

/// Each component named.
pub fn name(z: &mut Intermediates, v: Triple) -> Triple {
    v.map(|component| z.name(component))
}

/// A scalar, linear in numbered unknowns: sum of `terms[slot] * unknown(slot)`, plus `rest`.
#[derive(Clone, Debug)]
pub struct LinearScalar {
    /// coefficients, none of them 0
    pub terms: BTreeMap<usize, Expr>,
    /// what is free of the unknowns
    pub rest: Expr,
}

impl LinearScalar {
    /// A form without unknowns.
    pub fn constant(rest: Expr) -> Self {
        LinearScalar { terms: BTreeMap::new(), rest }
    }

    /// One unknown.
    pub fn unknown(slot: usize) -> Self {
        LinearScalar { terms: [(slot, Expr::one())].into(), rest: Expr::zero() }
    }

    /// Whether it is identically 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty() && self.rest.is_zero()
    }

    /// Coefficient of an unknown.
    pub fn coefficient(&self, slot: usize) -> Expr {
        self.terms.get(&slot).cloned().unwrap_or_else(Expr::zero)
    }

    /// Sum.
    pub fn add(&self, other: &Self) -> Self {
        let mut terms = self.terms.clone();
        for (&slot, coefficient) in &other.terms {
            let sum = terms.get(&slot).map_or_else(|| coefficient.clone(), |c| c.add(coefficient));
            terms.insert(slot, sum);
        }
        terms.retain(|_, coefficient| !coefficient.is_zero());
        LinearScalar { terms, rest: self.rest.add(&other.rest) }
    }

    /// Product with an expression free of the unknowns.
    pub fn scale(&self, k: &Expr) -> Self {
        self.map(|c| c.mul(k))
    }

    /// Difference.
    pub fn sub(&self, other: &Self) -> Self {
        self.add(&other.scale(&Expr::integer(-1)))
    }

    /// Every coefficient mapped.
    pub fn map(&self, mut f: impl FnMut(&Expr) -> Expr) -> Self {
        let mut terms: BTreeMap<_, _> = self.terms.iter().map(|(&slot, c)| (slot, f(c))).collect();
        terms.retain(|_, coefficient| !coefficient.is_zero());
        LinearScalar { terms, rest: f(&self.rest) }
    }

    /// Unknowns replaced by forms in other unknowns, where `by` knows one.
    pub fn substitute(&self, mut by: impl FnMut(usize) -> Option<LinearScalar>) -> Self {
        let mut result = Self::constant(self.rest.clone());
        for (&slot, coefficient) in &self.terms {
            let value = by(slot).unwrap_or_else(|| Self::unknown(slot));
            result = result.add(&value.scale(coefficient));
        }
        result
    }
}

/// A vector in given axes, linear in numbered unknowns.
#[derive(Clone, Debug)]
pub struct LinearVector {
    /// partial velocities, none of them 0
    pub terms: BTreeMap<usize, Triple>,
    /// the remainder
    pub rest: Triple,
}

impl LinearVector {
    /// The zero form.
    pub fn zero() -> Self {
        Self::constant(zero())
    }

    /// A form without unknowns.
    pub fn constant(rest: Triple) -> Self {
        LinearVector { terms: BTreeMap::new(), rest }
    }

    /// Whether it is identically 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty() && is_zero(&self.rest)
    }

    /// Sum.
    pub fn add(&self, other: &Self) -> Self {
        let mut terms = self.terms.clone();
        for (&slot, partial) in &other.terms {
            let sum = terms.get(&slot).map_or_else(|| partial.clone(), |p| add(p, partial));
            terms.insert(slot, sum);
        }
        terms.retain(|_, partial| !is_zero(partial));
        LinearVector { terms, rest: add(&self.rest, &other.rest) }
    }

    /// Every partial velocity, and the remainder, mapped.
    pub fn map(&self, mut f: impl FnMut(&Triple) -> Triple) -> Self {
        let mut terms: BTreeMap<_, _> = self.terms.iter().map(|(&slot, p)| (slot, f(p))).collect();
        terms.retain(|_, partial| !is_zero(partial));
        LinearVector { terms, rest: f(&self.rest) }
    }

    /// Dot product with a vector free of the unknowns, in the same axes.
    pub fn dot(&self, v: &Triple) -> LinearScalar {
        let mut terms: BTreeMap<_, _> = self.terms.iter().map(|(&slot, p)| (slot, dot(p, v))).collect();
        terms.retain(|_, coefficient: &mut Expr| !coefficient.is_zero());
        LinearScalar { terms, rest: dot(&self.rest, v) }
    }

    /// The component along one of the axes.
    pub fn component(&self, i: usize) -> LinearScalar {
        let mut terms: BTreeMap<_, _> = self.terms.iter().map(|(&slot, p)| (slot, p[i].clone())).collect();
        terms.retain(|_, coefficient: &mut Expr| !coefficient.is_zero());
        LinearScalar { terms, rest: self.rest[i].clone() }
    }

    /// A scalar form along a vector free of the unknowns.
    pub fn along(form: &LinearScalar, v: &Triple) -> Self {
        let mut terms: BTreeMap<_, _> = form.terms.iter().map(|(&slot, c)| (slot, scale(c, v))).collect();
        terms.retain(|_, partial: &mut Triple| !is_zero(partial));
        LinearVector { terms, rest: scale(&form.rest, v) }
    }

    /// Unknowns replaced by forms in other unknowns, where `by` knows one.
    pub fn substitute(&self, mut by: impl FnMut(usize) -> Option<LinearScalar>) -> Self {
        let mut result = Self::constant(self.rest.clone());
        for (&slot, partial) in &self.terms {
            let value = by(slot).unwrap_or_else(|| LinearScalar::unknown(slot));
            result = result.add(&Self::along(&value, partial));
        }
        result
    }
}
