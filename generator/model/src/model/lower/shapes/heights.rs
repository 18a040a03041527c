//! Heights z = h(x, y) of surfaces: derivatives, and values at places.

use super::algebra::*;
use crate::arithmetic::Function;
use crate::model::mechanism::{DefinitionId, Height, Scalar};
use crate::number::Number;
use crate::span::Span;

impl Height {
    /// Stands for x and y in a height: no definition has such an index.
    pub(in crate::model::lower) const PLACES: [DefinitionId; 2] =
        [DefinitionId(usize::MAX), DefinitionId(usize::MAX - 1)];

    /// A height with its slopes; `None` if it depends on its place in a way that has none here.
    pub(super) fn of(value: Scalar, at: Span) -> Option<Height> {
        let [x, y] = Height::PLACES.map(|place| slope(&value, place, at));
        Some(Height { slopes: [x?, y?], value })
    }
}

impl Height {
    /// The height at a place, m: an expression of parameters. `None` if the place is no number.
    pub fn value_at(&self, place: [f64; 2]) -> Option<Scalar> {
        Some(self.value.at(&numbers(place)?))
    }

    /// The slopes at a place: expressions of parameters. `None` if the place is no number.
    pub fn slopes_at(&self, place: [f64; 2]) -> Option<[Scalar; 2]> {
        let place = numbers(place)?;
        Some(self.slopes.each_ref().map(|slope| slope.at(&place)))
    }
}

/// A place as numbers.
fn numbers(place: [f64; 2]) -> Option<[Scalar; 2]> {
    let number = |x: f64| num_rational::BigRational::from_float(x).map(|x| Scalar::Number(Number(x)));
    let [x, y] = place.map(number);
    Some([x?, y?])
}

impl Scalar {
    /// The value of a height, or of its slope, at a place.
    pub(super) fn at(&self, places: &[Scalar; 2]) -> Scalar {
        let all = |list: &[Scalar]| list.iter().map(|part| part.at(places)).collect();
        let one = |part: &Scalar| Box::new(part.at(places));
        match self {
            Scalar::Definition(id) => match Height::PLACES.iter().position(|place| place == id) {
                Some(which) => places[which].clone(),
                None => self.clone(),
            },
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

/// The derivative by x or y; `None` where there is no rule.
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
