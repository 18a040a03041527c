//! Lowers parameters, inputs, coordinates and speeds, with their units and values.

use std::collections::{HashMap, HashSet};

use super::super::mechanism::{Scalar, Variable};
use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::super::typed::{Traits, Typed, TypedValue};
use super::{Lowering, QuantityFacts};
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::span::Span;
use crate::syntax::tree::{self, Expr, Modifier};
use crate::syntax::units::{self, Unit};

impl Lowering<'_> {
    /// Reads a unit; reports a mistake in it.
    pub fn unit(&mut self, expr: &Expr) -> Option<Unit> {
        match units::read(expr) {
            Ok(unit) => Some(unit),
            Err(error) => {
                self.diagnostics.extend(error.map(|error| *error));
                None
            }
        }
    }

    pub(super) fn quantities(&mut self) {
        let tree = self.tree;
        for quantity in &tree.parameters {
            let (quantity, facts) = self.quantity(quantity, Symbol::Parameter(0), false);
            self.out.parameters.push(quantity);
            self.parameters.push(facts);
        }
        for quantity in &tree.inputs {
            let (quantity, facts) = self.quantity(quantity, Symbol::Input(0), false);
            self.out.inputs.push(quantity);
            self.inputs.push(facts);
        }
        for quantity in &tree.coordinates {
            let (quantity, facts) = self.quantity(quantity, Symbol::Coordinate(0), false);
            self.out.coordinates.push(quantity);
            self.coordinates.push(facts);
        }
        for (list, dependent) in [(&tree.speeds, false), (&tree.dependent, true)] {
            for quantity in list {
                let (quantity, facts) = self.quantity(quantity, Symbol::Speed(0), dependent);
                self.out.speeds.push(quantity);
                self.speeds.push(facts);
            }
        }
        self.forget_ambiguous();
        self.initial_values();
    }

    /// Where two quantities of one name have different dimensions, it is not known which is meant.
    fn forget_ambiguous(&mut self) {
        let mut lists = [
            (&self.out.parameters, &mut self.parameters),
            (&self.out.inputs, &mut self.inputs),
            (&self.out.coordinates, &mut self.coordinates),
            (&self.out.speeds, &mut self.speeds),
        ];
        let mut seen: HashMap<&str, Option<Dimension>> = HashMap::new();
        let mut different: HashSet<&str> = HashSet::new();
        for (quantities, facts) in &lists {
            for (quantity, facts) in quantities.iter().zip(facts.iter()) {
                let dimension = facts.unit.as_ref().map(|unit| unit.dimension);
                if *seen.entry(&quantity.name).or_insert(dimension) != dimension {
                    different.insert(&quantity.name);
                }
            }
        }
        for (quantities, facts) in &mut lists {
            for (quantity, facts) in quantities.iter().zip(facts.iter_mut()) {
                if different.contains(quantity.name.as_str()) {
                    facts.unit = None;
                }
            }
        }
    }

    fn quantity(
        &mut self,
        source: &tree::Declaration,
        kind: Symbol,
        dependent: bool,
    ) -> (Variable, QuantityFacts) {
        let unit = self.unit(&source.unit);
        let initial = matches!(kind, Symbol::Coordinate(_) | Symbol::Speed(_)) && !dependent;
        let stated = source.value.as_ref().filter(|value| !initial || !super::initial::has_names(value));
        let value = stated.map(|value| self.constant(value));
        let (mut is_fixed, mut is_dependent) = (false, dependent);
        match (source.modifier, kind) {
            (None, _) => {}
            (Some((Modifier::Fixed, _)), Symbol::Parameter(_)) => is_fixed = true,
            (Some((Modifier::Dependent, _)), Symbol::Coordinate(_)) => is_dependent = true,
            (Some((Modifier::Fixed, span)), _) => {
                let error = Diagnostic::new(codes::EXPECTED, span, "only a parameter can be `fixed`");
                self.report(error.help("remove `fixed`"));
            }
            (Some((Modifier::Dependent, span)), Symbol::Speed(_)) => {
                let error = Diagnostic::new(
                    codes::EXPECTED,
                    span,
                    "dependent speeds are declared in a section of their own",
                );
                self.report(error.help("move it to `dependent { .. }`"));
            }
            (Some((Modifier::Dependent, span)), _) => {
                let error =
                    Diagnostic::new(codes::EXPECTED, span, "only a coordinate or a speed can be dependent");
                self.report(error.help("remove `dependent`"));
            }
        }
        if dependent && let Some(value) = &source.value {
            let message = format!("the dependent speed `{}` has no value of its own", source.name.text);
            let error = Diagnostic::new(codes::CONSTANT, value.span, message);
            self.report(error.help("it follows from the constraints: remove the value"));
        }
        if is_fixed && value.is_none() {
            let message = format!("the fixed parameter `{}` has no value", source.name.text);
            let error = Diagnostic::new(codes::NEEDS_VALUE, source.name.span, message);
            self.report(error.help("give it one, as in `fixed l: m = 1`, or remove `fixed`"));
        }
        let number = value.as_ref().and_then(|typed| typed.constant);
        let quantity = Variable {
            name: source.name.text.clone(),
            docs: source.docs.clone(),
            unit: unit.as_ref().map_or(String::new(), |unit| unit.text.clone()),
            value: number,
            initial: None,
            typical: unit.as_ref().map_or(1.0, Unit::typical),
            factor: unit.as_ref().map_or(1.0, Unit::factor),
            fixed: is_fixed,
            dependent: is_dependent,
            span: source.name.span,
        };
        (quantity, QuantityFacts { unit, fixed: value.filter(|_| is_fixed) })
    }

    /// A constant expression: numbers, pi and functions.
    pub(super) fn constant(&mut self, expr: &Expr) -> Typed {
        self.constant_only = true;
        let typed = self.expression(expr);
        self.constant_only = false;
        match &typed.value {
            TypedValue::Poison => typed,
            TypedValue::Scalar(_) if typed.constant.is_some() => typed,
            _ => {
                let error = Diagnostic::new(codes::CONSTANT, expr.span, "a value is a number, not a vector");
                self.report(error);
                Typed::poison(expr.span)
            }
        }
    }

    /// A parameter, input, coordinate or speed in an expression, in SI units.
    pub(super) fn quantity_in_expression(&mut self, symbol: Symbol, span: Span) -> Typed {
        let mut traits = Traits::default();
        let (facts, scalar) = match symbol {
            Symbol::Parameter(i) => {
                (self.parameters.get(i), Scalar::Parameter(super::super::mechanism::ParameterId(i)))
            }
            Symbol::Input(i) => {
                traits.input = Some(span);
                (self.inputs.get(i), Scalar::Input(super::super::mechanism::InputId(i)))
            }
            Symbol::Coordinate(i) => {
                traits.moves = true;
                (self.coordinates.get(i), Scalar::Coordinate(super::super::mechanism::CoordinateId(i)))
            }
            Symbol::Speed(i) => {
                traits = Traits::speed(span);
                (self.speeds.get(i), Scalar::Speed(super::super::mechanism::SpeedId(i)))
            }
            _ => return Typed::poison(span),
        };
        let Some(facts) = facts else { return Typed::poison(span) };
        let Some(unit) = facts.unit.clone() else {
            return Typed { traits, ..Typed::poison(span) };
        };
        let fixed = facts.fixed.clone();
        let fixed_parameter = matches!(symbol, Symbol::Parameter(i) if self.out.parameters[i].fixed);
        match fixed {
            Some(value) => match value.value {
                TypedValue::Scalar(number) => Typed {
                    value: TypedValue::Scalar(in_si(number, &unit)),
                    dimension: Some(unit.dimension),
                    constant: value.constant.map(|c| c * unit.factor()),
                    exact: value.exact.filter(|_| unit.is_si()),
                    traits,
                    span,
                    provenance: Provenance::of(symbol),
                },
                _ => Typed::poison(span),
            },
            None if fixed_parameter => Typed::poison(span),
            None => Typed::scalar(in_si(scalar, &unit), Some(unit.dimension), traits, span)
                .from(Provenance::of(symbol)),
        }
    }
}

/// A scalar counted in a unit, in SI.
fn in_si(scalar: Scalar, unit: &Unit) -> Scalar {
    if unit.is_si() {
        return scalar;
    }
    let mut factors = Vec::new();
    if !unit.number.is_one() {
        factors.push(Scalar::Number(unit.number.clone()));
    }
    let pi = |n: i32| (0..n).map(|_| Scalar::Pi);
    factors.extend(pi(unit.pi_power));
    factors.push(scalar);
    let product = Scalar::Mul(factors);
    if unit.pi_power >= 0 {
        return product;
    }
    let divisor: Vec<Scalar> = pi(-unit.pi_power).collect();
    Scalar::Div(Box::new(product), Box::new(Scalar::Mul(divisor)), Span::default())
}
