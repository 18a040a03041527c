//! Sums, products and functions of expressions, as the closed forms of contacts need them.

use crate::arithmetic::Function;
use crate::model::mechanism::{Anchor, Axis, FrameId, Scalar, Vector};
use crate::number::Number;
use crate::span::Span;

/// A whole number.
pub fn integer(n: i64) -> Scalar {
    Scalar::Number(Number::integer(n))
}

/// The quotient of two whole numbers.
pub fn ratio(n: i64, d: i64) -> Scalar {
    Scalar::Number(Number::ratio(n, d))
}

/// A product.
pub fn product<const N: usize>(factors: [Scalar; N]) -> Scalar {
    Scalar::Mul(factors.into())
}

/// A sum.
pub fn sum<const N: usize>(terms: [Scalar; N]) -> Scalar {
    Scalar::Add(terms.into())
}

/// a - b
pub fn less(a: Scalar, b: Scalar) -> Scalar {
    sum([a, Scalar::Neg(Box::new(b))])
}

/// -a
pub fn opposite_of(a: Scalar) -> Scalar {
    Scalar::Neg(Box::new(a))
}

/// a, or -a.
pub fn signed(sign: i64, a: Scalar) -> Scalar {
    if sign < 0 { opposite_of(a) } else { a }
}

/// The sum of any number of terms.
pub fn all(terms: impl IntoIterator<Item = Scalar>) -> Scalar {
    Scalar::Add(terms.into_iter().collect())
}

/// a^2
pub fn square(a: Scalar) -> Scalar {
    Scalar::Pow(Box::new(a), Box::new(integer(2)))
}

/// a/2
pub fn half(a: &Scalar) -> Scalar {
    product([ratio(1, 2), a.clone()])
}

/// a/b
pub fn quotient(a: Scalar, b: Scalar, at: Span) -> Scalar {
    Scalar::Div(Box::new(a), Box::new(b), at)
}

/// A square root.
pub fn root(a: Scalar) -> Scalar {
    Scalar::Call(Function::Sqrt, vec![a])
}

/// The greater of two.
pub fn greater(a: Scalar, b: Scalar) -> Scalar {
    Scalar::Call(Function::Max, vec![a, b])
}

/// The lesser of two.
pub fn lesser(a: Scalar, b: Scalar) -> Scalar {
    Scalar::Call(Function::Min, vec![a, b])
}

/// The size of a number.
pub fn size(a: Scalar) -> Scalar {
    Scalar::Call(Function::Abs, vec![a])
}

/// -1 below 0, else 1.
pub fn sign(a: Scalar) -> Scalar {
    Scalar::Call(Function::Sign, vec![a])
}

/// 0 below 0, else 1.
pub fn step(a: Scalar) -> Scalar {
    product([ratio(1, 2), sum([integer(1), sign(a)])])
}

/// The value nearest to `a` between -`bound` and `bound`.
pub fn between_bounds(a: Scalar, bound: &Scalar) -> Scalar {
    let below = Scalar::Call(Function::Min, vec![a, bound.clone()]);
    greater(below, Scalar::Neg(Box::new(bound.clone())))
}

/// A symmetric matrix from its entries on and above the diagonal, row by row.
pub fn symmetric<T: Clone, const N: usize>(mut entry: impl FnMut(usize, usize) -> T) -> [[T; N]; N] {
    let rows: Vec<Vec<T>> = (0..N).map(|i| (i..N).map(|j| entry(i, j)).collect()).collect();
    std::array::from_fn(|i| std::array::from_fn(|j| rows[i.min(j)][i.max(j) - i.min(j)].clone()))
}

/// A dot product.
pub fn dot(a: &Vector, b: &Vector) -> Scalar {
    Scalar::Dot(Box::new(a.clone()), Box::new(b.clone()))
}

/// A cross product.
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    Vector::Cross(Box::new(a.clone()), Box::new(b.clone()))
}

/// The length of a vector.
pub fn norm(a: &Vector) -> Scalar {
    Scalar::Norm(Box::new(a.clone()))
}

/// The unit vector along a vector.
pub fn unit(a: &Vector, at: Span) -> Vector {
    Vector::Unit(Box::new(a.clone()), at)
}

/// A multiple of a vector.
pub fn scaled(a: Scalar, v: &Vector) -> Vector {
    Vector::Scale(Box::new(a), Box::new(v.clone()))
}

/// The opposite vector.
pub fn opposite(v: &Vector) -> Vector {
    Vector::Neg(Box::new(v.clone()))
}

/// The sum of vectors; zeros are left out.
pub fn total(terms: impl IntoIterator<Item = Vector>) -> Vector {
    let mut terms: Vec<Vector> = terms.into_iter().filter(|term| !matches!(term, Vector::Zero)).collect();
    match terms.len() {
        0 => Vector::Zero,
        1 => terms.remove(0),
        _ => Vector::Add(terms),
    }
}

/// An axis of a frame: 0 for x, 1 for y, 2 for z.
pub fn axis(frame: FrameId, which: usize) -> Vector {
    Vector::Components(frame, Box::new(std::array::from_fn(|i| integer(i64::from(i == which)))))
}

/// Which axis of a frame this is, as it is written, and whether it is its opposite.
pub fn as_axis(v: &Vector) -> Option<(FrameId, Axis)> {
    match v {
        Vector::Neg(inner) => as_axis(inner),
        Vector::Components(frame, components) => {
            let is = |c: &Scalar, n: i64| matches!(c, Scalar::Number(value) if *value == Number::integer(n));
            let unit = |which: usize| (0..3).all(|i| is(&components[i], i64::from(i == which)));
            let axes = [Axis::X, Axis::Y, Axis::Z];
            (0..3).find(|which| unit(*which)).map(|which| (*frame, axes[which]))
        }
        _ => None,
    }
}

impl Anchor {
    /// The same, further by a vector.
    pub(super) fn plus(&self, by: Vector) -> Anchor {
        Anchor { point: self.point, by: total([self.by.clone(), by]) }
    }

    /// Its position from another.
    pub(super) fn from(&self, other: &Anchor) -> Vector {
        let apart = if self.point == other.point {
            Vector::Zero
        } else {
            Vector::Position { of: self.point, from: other.point }
        };
        let behind = match &other.by {
            Vector::Zero => Vector::Zero,
            by => opposite(by),
        };
        total([apart, self.by.clone(), behind])
    }
}
