//! Vectors as sums of components along several sets of axes, and operations on them.

use super::linear_forms::{self, LinearScalar, LinearVector, Triple};
use super::{AxesId, Kinematics, Mixed, MixedLinear};
use crate::algebra::Expr;

/// A vector along one set of axes.
pub fn mixed(axes: AxesId, v: Triple) -> Mixed {
    if linear_forms::is_zero(&v) { Mixed::new() } else { Mixed::from([(axes, v)]) }
}

/// Sum.
pub fn add(a: &Mixed, b: &Mixed) -> Mixed {
    let mut sum = a.clone();
    for (&axes, v) in b {
        let total = sum.get(&axes).map_or_else(|| v.clone(), |have| linear_forms::add(have, v));
        if linear_forms::is_zero(&total) {
            sum.remove(&axes);
        } else {
            sum.insert(axes, total);
        }
    }
    sum
}

/// `k v`.
pub fn scale(k: &Expr, v: &Mixed) -> Mixed {
    if k.is_zero() {
        return Mixed::new();
    }
    v.iter().map(|(&axes, v)| (axes, linear_forms::scale(k, v))).collect()
}

/// Sum of linear forms.
pub fn add_linear(a: &MixedLinear, b: &MixedLinear) -> MixedLinear {
    let mut sum = a.clone();
    for (&axes, v) in b {
        let total = sum.get(&axes).map_or_else(|| v.clone(), |have| have.add(v));
        if total.is_zero() {
            sum.remove(&axes);
        } else {
            sum.insert(axes, total);
        }
    }
    sum
}

/// `k v` for a linear form.
pub fn scale_linear(k: &Expr, v: &MixedLinear) -> MixedLinear {
    let scaled = v.iter().map(|(&axes, v)| (axes, v.map(|p| linear_forms::scale(k, p))));
    scaled.filter(|(_, v)| !v.is_zero()).collect()
}

/// A vector free of unknowns, as a form.
pub fn constant(v: &Mixed) -> MixedLinear {
    v.iter().map(|(&axes, v)| (axes, LinearVector::constant(v.clone()))).collect()
}

fn entries(v: &Triple) -> usize {
    v.iter().filter(|c| !c.is_zero()).count()
}

impl Kinematics<'_> {
    /// The vector along one set of axes.
    pub fn express(&mut self, v: &Mixed, axes: AxesId) -> Triple {
        let mut sum = linear_forms::zero();
        for (&from, part) in v {
            let part = self.tree.convert(&mut self.z, part, from, axes);
            sum = linear_forms::add(&sum, &part);
        }
        if v.len() > 1 { linear_forms::name(&mut self.z, sum) } else { sum }
    }

    /// The linear form along one set of axes.
    pub fn express_linear(&mut self, v: &MixedLinear, axes: AxesId) -> LinearVector {
        let mut sum = LinearVector::zero();
        for (&from, part) in v {
            let part = part.map(|p| self.tree.convert(&mut self.z, p, from, axes));
            sum = sum.add(&part);
        }
        sum
    }

    /// Axes along which two vectors are best brought together: one's own if all of it lies there.
    pub fn meeting(&self, a: impl Iterator<Item = AxesId>, b: impl Iterator<Item = AxesId>) -> AxesId {
        let (a, b): (Vec<_>, Vec<_>) = (a.collect(), b.collect());
        match (&a[..], &b[..]) {
            ([], [axes, ..]) | ([axes, ..], []) => *axes,
            ([a], [b]) if self.tree.descends(*b, *a) => *b,
            ([a], [b]) if self.tree.descends(*a, *b) => *a,
            _ => a.iter().chain(&b).copied().reduce(|x, y| self.tree.common(x, y)).unwrap_or(0),
        }
    }

    /// `a . b`, pair by pair of axes: the sparser vector of each pair is turned to the other's axes.
    pub fn dot(&mut self, a: &Mixed, b: &Mixed) -> Expr {
        let mut sum = Expr::zero();
        for (&axes_a, part_a) in a {
            for (&axes_b, part_b) in b {
                let term = if entries(part_a) <= entries(part_b) {
                    let turned = self.tree.convert(&mut self.z, part_a, axes_a, axes_b);
                    linear_forms::dot(&turned, part_b)
                } else {
                    let turned = self.tree.convert(&mut self.z, part_b, axes_b, axes_a);
                    linear_forms::dot(&turned, part_a)
                };
                sum = sum.add(&term);
            }
        }
        self.z.simplify(&sum)
    }

    /// `form . b`.
    pub fn dot_linear(&mut self, form: &MixedLinear, b: &Mixed) -> LinearScalar {
        let mut sum = LinearScalar::constant(Expr::zero());
        for (&axes, part) in form {
            let turned = self.express(b, axes);
            sum = sum.add(&part.dot(&turned));
        }
        sum.map(|c| self.z.simplify(c))
    }

    /// `a x b`.
    pub fn cross(&mut self, a: &Mixed, b: &Mixed) -> Mixed {
        if a.is_empty() || b.is_empty() {
            return Mixed::new();
        }
        let axes = self.meeting(a.keys().copied(), b.keys().copied());
        let (a, b) = (self.express(a, axes), self.express(b, axes));
        let product = linear_forms::cross(&a, &b);
        mixed(axes, linear_forms::name(&mut self.z, product))
    }

    /// `|v|`.
    pub fn norm(&mut self, v: &Mixed) -> Expr {
        let square = self.dot(v, v);
        self.z.call(hodograph_model::arithmetic::Function::Sqrt, vec![square])
    }
}
