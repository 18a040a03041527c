//! Lowers sums, differences and opposites.

use num_rational::BigRational;
use num_traits::Zero;

use super::super::mechanism::{Scalar, Vector};
use super::super::provenance::Provenance;
use super::super::typed::{Traits, Typed, TypedValue, moderate};
use super::Lowering;
use super::dimensions::{model_of, quantity};
use crate::diagnostics::{Diagnostic, codes};
use crate::number::Number;
use crate::span::Span;
use crate::syntax::tree::Expr;

impl Lowering<'_> {
    pub(super) fn sum(&mut self, terms: &[(bool, Expr)], span: Span) -> Typed {
        let typed: Vec<Typed> = terms
            .iter()
            .map(|(negative, term)| {
                let term = self.expression(term);
                if *negative { negated(term) } else { term }
            })
            .collect();
        self.add(typed, span)
    }

    /// The sum of typed terms.
    pub(super) fn add(&mut self, terms: Vec<Typed>, span: Span) -> Typed {
        let traits = terms.iter().fold(Traits::default(), |sum, term| sum.plus(term.traits));
        let constant = terms.iter().try_fold(0.0, |sum, term| Some(sum + term.constant?));
        let exact = terms
            .iter()
            .try_fold(BigRational::zero(), |sum, term| Some(sum + &term.exact.as_ref()?.0))
            .and_then(|sum| moderate(Number(sum)));
        let poisoned = terms.iter().any(Typed::is_poison);
        // what most of them are
        let kinds = |vector: bool| {
            terms.iter().filter(move |t| !t.is_poison() && !t.is_zero() && t.is_vector() == vector)
        };
        let mut model =
            [true, false].map(|vector| (vector, kinds(vector).count(), kinds(vector).next().map(|t| t.span)));
        model.sort_by_key(|(_, count, place)| (std::cmp::Reverse(*count), *place));
        let vector = model[0].2.map(|place| (model[0].0, place));
        let mut summands: Vec<&Typed> = Vec::new();
        let (mut scalars, mut vectors) = (Vec::new(), Vec::new());
        let (mut wrong, mut fit) = (poisoned, true);
        for term in &terms {
            let is_vector = match &term.value {
                TypedValue::Poison => continue,
                // 0 joins scalars and vectors alike
                TypedValue::Scalar(scalar) if term.is_zero() => {
                    scalars.push(scalar.clone());
                    continue;
                }
                TypedValue::Scalar(scalar) => {
                    scalars.push(scalar.clone());
                    false
                }
                TypedValue::Vector(v) => {
                    vectors.push(v.clone());
                    true
                }
            };
            match vector {
                Some((first, place)) if first != is_vector => {
                    let kind = |v: bool| if v { "a vector" } else { "a scalar" };
                    let message = format!("{} is added to {}", kind(is_vector), kind(first));
                    let error = Diagnostic::new(codes::SCALAR_VECTOR, term.span, message)
                        .label(format!("this is {}", kind(is_vector)))
                        .related(place, format!("this is {}", kind(first)))
                        .help("multiply the scalar by an axis such as `N.x`, or take a component with `dot`");
                    self.report(error);
                    (wrong, fit) = (true, false);
                    continue;
                }
                _ => {}
            }
            summands.push(term);
        }
        let model = model_of(summands.iter().copied());
        for term in summands {
            // one mistake at a time: a sum of scalars and vectors has no dimension
            if let Some(model) = model.filter(|_| fit) {
                wrong |= !self
                    .same(model, term, |a, b| format!("{} cannot be added to {}", quantity(b), quantity(a)));
            }
        }
        let dimension = model.and_then(|model| model.dimension);
        let provenance = model.map_or(Provenance::none(), |model| model.provenance.clone());
        if wrong {
            return Typed { traits, ..Typed::poison(span) };
        }
        let value = match vector {
            Some((true, _)) if vectors.len() == 1 => TypedValue::Vector(vectors.remove(0)),
            Some((true, _)) => TypedValue::Vector(Vector::Add(vectors)),
            _ => TypedValue::Scalar(Scalar::Add(scalars)),
        };
        let is_scalar = matches!(value, TypedValue::Scalar(_));
        Typed {
            value,
            dimension,
            provenance,
            traits,
            constant: constant.filter(|_| is_scalar),
            exact: exact.filter(|_| is_scalar),
            span,
        }
    }
}

/// The opposite.
pub(super) fn negated(typed: Typed) -> Typed {
    let value = match typed.value {
        TypedValue::Scalar(scalar) => TypedValue::Scalar(Scalar::Neg(Box::new(scalar))),
        TypedValue::Vector(vector) => TypedValue::Vector(Vector::Neg(Box::new(vector))),
        TypedValue::Poison => TypedValue::Poison,
    };
    Typed { value, constant: typed.constant.map(|c| -c), exact: typed.exact.map(|n| Number(-n.0)), ..typed }
}
