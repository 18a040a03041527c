//! Functions of the place by which surfaces are stated, heights z = h(x, y) and f(x, y, z) = 0: derivatives, and values
//! at places.

use super::algebra::*;
use crate::arithmetic::Function;
use crate::model::mechanism::{DefinitionId, Kind, OfPlace, Scalar, Shape};
use crate::number::Number;
use crate::span::Span;

/// What stands for x, y and z in a function of the place: no definition has such an index.
pub(in crate::model::lower) const PLACES: [DefinitionId; 3] =
    [DefinitionId(usize::MAX), DefinitionId(usize::MAX - 1), DefinitionId(usize::MAX - 2)];

impl<const N: usize> OfPlace<N> {
    /// A function with its slopes; `None` if it depends on its place in a way that has none here.
    pub(super) fn of(value: Scalar, at: Span) -> Option<Self> {
        let slopes = all_of(std::array::from_fn(|i| slope(&value, PLACES[i], at)))?;
        Some(OfPlace { slopes, value })
    }

    /// The second derivatives; `None` where there is no rule.
    pub(super) fn curvatures(&self, at: Span) -> Option<[[Scalar; N]; N]> {
        all_of(symmetric(|i, j| slope(&self.slopes[i], PLACES[j], at)).map(all_of))
    }

    /// The value at a place, m: an expression of parameters. `None` if the place is no number.
    pub fn value_at(&self, place: [f64; N]) -> Option<Scalar> {
        Some(self.value.at(&numbers(place)?))
    }

    /// The slopes at a place, m: expressions of parameters. `None` if the place is no number.
    pub fn slopes_at(&self, place: [f64; N]) -> Option<[Scalar; N]> {
        let place = numbers(place)?;
        Some(self.slopes.each_ref().map(|slope| slope.at(&place)))
    }
}

impl OfPlace<3> {
    /// z - h(x, y) of a surface, y - h(x) of a curve, or the function of an implicit surface.
    pub(super) fn above(surface: &Shape) -> Option<Self> {
        let up = match surface.kind {
            Kind::Implicit => return surface.function.clone(),
            Kind::Curve => 1,
            _ => 2,
        };
        let height = surface.height.as_ref()?;
        let value = less(Scalar::Definition(PLACES[up]), height.value.clone());
        let slopes = std::array::from_fn(|i| match i {
            i if i < up => opposite_of(height.slopes[i].clone()),
            i => integer(i64::from(i == up)),
        });
        Some(OfPlace { value, slopes })
    }
}

/// A place as numbers.
fn numbers<const N: usize>(place: [f64; N]) -> Option<[Scalar; N]> {
    let number = |x: f64| num_rational::BigRational::from_float(x).map(|x| Scalar::Number(Number(x)));
    all_of(place.map(number))
}

/// All of what there is, or nothing.
fn all_of<T, const N: usize>(parts: [Option<T>; N]) -> Option<[T; N]> {
    let parts: Option<Vec<T>> = parts.into_iter().collect();
    parts?.try_into().ok()
}

impl Scalar {
    /// Whether it depends on the place.
    pub(super) fn has_a_place(&self) -> bool {
        match self {
            Scalar::Definition(id) => PLACES.contains(id),
            Scalar::Neg(a) => a.has_a_place(),
            Scalar::Add(list) | Scalar::Mul(list) | Scalar::Call(_, list) => {
                list.iter().any(Scalar::has_a_place)
            }
            Scalar::Div(a, b, _) | Scalar::Pow(a, b) => a.has_a_place() || b.has_a_place(),
            _ => false,
        }
    }

    /// The value of a function of the place, or of its slope, at a place.
    pub(super) fn at(&self, places: &[Scalar]) -> Scalar {
        let all = |list: &[Scalar]| list.iter().map(|part| part.at(places)).collect();
        let one = |part: &Scalar| Box::new(part.at(places));
        match self {
            Scalar::Definition(id) => {
                let which = PLACES.iter().position(|place| place == id);
                which.and_then(|which| places.get(which)).unwrap_or(self).clone()
            }
            Scalar::Neg(a) => Scalar::Neg(one(a)),
            Scalar::Add(list) => Scalar::Add(all(list)),
            Scalar::Mul(list) => Scalar::Mul(all(list)),
            Scalar::Div(a, b, at) => Scalar::Div(one(a), one(b), *at),
            Scalar::Pow(a, b) => Scalar::Pow(one(a), one(b)),
            Scalar::Call(function, list) => Scalar::Call(*function, all(list)),
            other => other.clone(),
        }
    }
}

/// The derivative by x, y or z; `None` where there is no rule.
pub fn slope(value: &Scalar, by: DefinitionId, at: Span) -> Option<Scalar> {
    let of = |part: &Scalar| slope(part, by, at);
    Some(match value {
        Scalar::Definition(id) if *id == by => integer(1),
        Scalar::Number(_)
        | Scalar::Pi
        | Scalar::Time
        | Scalar::Parameter(_)
        | Scalar::Definition(_)
        | Scalar::Input(_)
        | Scalar::Coordinate(_)
        | Scalar::Speed(_) => integer(0),
        Scalar::Neg(a) => Scalar::Neg(Box::new(of(a)?)),
        Scalar::Add(list) => Scalar::Add(list.iter().map(of).collect::<Option<_>>()?),
        Scalar::Mul(list) => {
            let term = |i: usize| {
                let mut factors = list.clone();
                factors[i] = of(&list[i])?;
                Some(Scalar::Mul(factors))
            };
            Scalar::Add((0..list.len()).map(term).collect::<Option<_>>()?)
        }
        Scalar::Div(a, b, place) => {
            let (numerator, denominator) = ((**a).clone(), (**b).clone());
            let first = Scalar::Div(Box::new(of(a)?), b.clone(), *place);
            let rest = quotient(product([numerator, of(b)?]), square(denominator), *place);
            less(first, rest)
        }
        Scalar::Pow(a, n) if is_constant(n) => {
            let lower = Scalar::Pow(a.clone(), Box::new(less((**n).clone(), integer(1))));
            product([(**n).clone(), lower, of(a)?])
        }
        Scalar::Call(function, list) => {
            let [argument] = &list[..] else { return None };
            product([outer(*function, argument, value, at)?, of(argument)?])
        }
        _ => return None,
    })
}

fn is_constant(value: &Scalar) -> bool {
    match value {
        Scalar::Number(_) | Scalar::Pi | Scalar::Parameter(_) => true,
        Scalar::Neg(a) => is_constant(a),
        Scalar::Add(list) | Scalar::Mul(list) => list.iter().all(is_constant),
        Scalar::Div(a, b, _) => is_constant(a) && is_constant(b),
        _ => false,
    }
}

/// The derivative of a function by its argument; `value` is the function's value.
fn outer(function: Function, a: &Scalar, value: &Scalar, at: Span) -> Option<Scalar> {
    let call = |function, a: &Scalar| Scalar::Call(function, vec![a.clone()]);
    let one = || integer(1);
    Some(match function {
        Function::Sin => call(Function::Cos, a),
        Function::Cos => Scalar::Neg(Box::new(call(Function::Sin, a))),
        Function::Tan => sum([one(), square(value.clone())]),
        Function::Asin => quotient(one(), root(less(one(), square(a.clone()))), at),
        Function::Acos => quotient(integer(-1), root(less(one(), square(a.clone()))), at),
        Function::Atan => quotient(one(), sum([one(), square(a.clone())]), at),
        Function::Sqrt => quotient(one(), product([integer(2), value.clone()]), at),
        Function::Exp => value.clone(),
        Function::Log => quotient(one(), a.clone(), at),
        Function::Sinh => call(Function::Cosh, a),
        Function::Cosh => call(Function::Sinh, a),
        Function::Tanh => less(one(), square(value.clone())),
        // a surface with an edge has no normal there
        Function::Frozen => integer(0),
        Function::Abs | Function::Sign | Function::Min | Function::Max | Function::Atan2 => return None,
    })
}
