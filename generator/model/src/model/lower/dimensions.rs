//! Checks dimensions: of terms in sums, of both sides of equations, and of values that must have a certain
//! dimension.

use std::collections::HashMap;

use super::super::mechanism::Scalar;
use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::super::typed::{Typed, TypedValue};
use super::balances::Contradiction;
use super::{Lowering, QuantityFacts};
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::{Dimension, Exponent};
use crate::span::Span;
use crate::syntax::tree::{self, Name};

/// `in m/s`, or that there is no dimension.
pub(super) fn in_words(dimension: Dimension) -> String {
    if dimension.is_none() { "a plain number".to_owned() } else { format!("in {dimension}") }
}

/// The same with a noun.
pub(super) fn quantity(dimension: Dimension) -> String {
    if dimension.is_none() { "a plain number".to_owned() } else { format!("a quantity in {dimension}") }
}

/// Of several things that must have one dimension, the one that the others are measured by: the first of the
/// dimension that most have. Numbers have no vote where there are names.
pub(super) fn model_of<'t>(things: impl Iterator<Item = &'t Typed> + Clone) -> Option<&'t Typed> {
    let mut votes: HashMap<Dimension, usize> = HashMap::new();
    for thing in things.clone().filter(|thing| !thing.provenance.is_empty()) {
        if let Some(dimension) = thing.dimension {
            *votes.entry(dimension).or_default() += 1;
        }
    }
    let most = votes.values().max().copied().unwrap_or(0);
    let mut things = things.filter(|thing| thing.dimension.is_some());
    things.find(|thing| thing.dimension.is_some_and(|d| votes.get(&d).copied().unwrap_or(0) == most))
}

impl Lowering<'_> {
    /// Two dimensions are the same, as they must be.
    pub(super) fn agreement(&mut self, provenance: Provenance) {
        if !provenance.is_empty() {
            self.balances.agreements.push(provenance);
        }
    }

    /// Two dimensions are not the same: `provenance` is that of their quotient, and `missing` what it lacks.
    pub(super) fn contradiction(
        &mut self,
        error: Diagnostic,
        provenance: Provenance,
        missing: Option<Dimension>,
        says: String,
    ) {
        if let Some(missing) = missing.filter(|missing| !missing.is_none()) {
            let error = self.diagnostics.len();
            self.balances.contradictions.push(Contradiction { error, provenance, missing, says });
        }
        self.report(error);
    }

    /// Demands a dimension; 0 has any.
    pub fn demand(&mut self, typed: &Typed, wanted: Dimension, what: &str) {
        self.places.wants(typed.span, Some(wanted), None, what);
        let Some(dimension) = typed.dimension else { return };
        if typed.is_poison() {
            return;
        }
        if dimension == wanted {
            self.agreement(typed.provenance.clone());
            return;
        }
        let needed = match (wanted.is_none(), typed.is_vector()) {
            (true, true) => "without dimension".to_owned(),
            (true, false) => "in rad or a plain number".to_owned(),
            (false, _) => format!("in {wanted}"),
        };
        let message = format!("{what} must be {needed}, but this is {}", in_words(dimension));
        let error = Diagnostic::new(codes::DIMENSION, typed.span, message)
            .label(format!("this is {}", in_words(dimension)));
        let error = match self.declaration(typed) {
            // the use is right and the declaration wrong, or the reverse: both are shown
            Some((name, place)) => error
                .related(place, format!("`{name}` is declared here"))
                .help(format!("correct this expression, or the unit of `{name}`")),
            None if dimension.is_none() => error.help(format!(
                "a number has no unit; declare a parameter with one, such as `a: {wanted} = ..`"
            )),
            None if wanted.is_none() && dimension == Dimension::of(0, 0, 1) => error.help(
                "a number has no unit; declare an angular frequency, such as `w: rad/s = ..`, and write `w*time`",
            ),
            None => error.help("multiply by what is missing, or correct the unit of a declaration"),
        };
        let says = format!("{what} must be {needed}");
        self.contradiction(error, typed.provenance.clone(), wanted.over(&dimension), says);
    }

    /// Demands that two things have one dimension; 0 has any. Returns whether they do.
    pub(super) fn same(
        &mut self,
        model: &Typed,
        other: &Typed,
        message: impl Fn(Dimension, Dimension) -> String,
    ) -> bool {
        let (Some(wanted), Some(dimension)) = (model.dimension, other.dimension) else { return true };
        let provenance = other.provenance.over(&model.provenance);
        if wanted == dimension {
            self.agreement(provenance);
            return true;
        }
        let error = Diagnostic::new(codes::DIMENSION, other.span, message(wanted, dimension))
            .label(format!("this is {}", in_words(dimension)))
            .related(model.span, format!("this is {}", in_words(wanted)));
        let is_number =
            |typed: &Typed, dimension: Dimension| dimension.is_none() && typed.provenance.is_empty();
        let mut error = error;
        if is_number(model, wanted) || is_number(other, dimension) {
            error = error.help("a plain number has no unit; declare a parameter with one");
        } else {
            error = error.help("multiply by what is missing, or correct the unit of a declaration");
        }
        let says = format!("this stands beside {}", quantity(wanted));
        self.contradiction(error, provenance, wanted.over(&dimension), says);
        self.balances.incomplete = true;
        false
    }

    /// The quantity or definition that an expression is, alone or with a factor that is a number, and its
    /// place.
    fn declaration(&self, typed: &Typed) -> Option<(String, Span)> {
        let definition = match &typed.value {
            TypedValue::Poison => return None,
            TypedValue::Scalar(scalar) => definition_of(scalar),
            TypedValue::Vector(_) => None,
        };
        let symbol = match (definition, typed.provenance.names()) {
            (Some(symbol), _) => symbol,
            (None, [(symbol, power)]) if *power == Exponent::from_integer(1) => *symbol,
            _ => return None,
        };
        self.declared(symbol).map(|declared| (declared.name.text.clone(), declared.name.span))
    }

    /// A declaration that has a dimension.
    pub(super) fn declared(&self, symbol: Symbol) -> Option<Declared<'_>> {
        let tree = self.tree;
        fn quantity<'d>(
            source: Option<&'d tree::Declaration>,
            facts: Option<&'d QuantityFacts>,
        ) -> Option<Declared<'d>> {
            let (source, unit) = (source?, facts?.unit.as_ref()?);
            let (name, place) = (&source.name, source.unit.span);
            let dimension = unit.dimension;
            Some(Declared { name, place, stated: true, unit: Some(&unit.text), dimension })
        }
        match symbol {
            Symbol::Parameter(i) => quantity(tree.parameters.get(i), self.parameters.get(i)),
            Symbol::Input(i) => quantity(tree.inputs.get(i), self.inputs.get(i)),
            Symbol::Coordinate(i) => quantity(tree.coordinates.get(i), self.coordinates.get(i)),
            Symbol::Speed(i) => {
                quantity(tree.speeds.iter().chain(&tree.dependent).nth(i), self.speeds.get(i))
            }
            Symbol::Definition(i) => {
                let source = tree.definitions.get(i)?;
                let place = source.unit.as_ref().map_or(source.value.span, |unit| unit.span);
                let dimension = self.definitions.get(i)?.typed.as_ref()?.dimension?;
                let (name, stated) = (&source.name, source.unit.is_some());
                Some(Declared { name, place, stated, unit: None, dimension })
            }
            _ => None,
        }
    }
}

/// A declaration that has a dimension.
pub(super) struct Declared<'t> {
    pub name: &'t Name,
    /// its unit, or the value of a definition without
    pub place: Span,
    /// whether it is stated.
    pub stated: bool,
    /// as written, of a quantity
    pub unit: Option<&'t str>,
    pub dimension: Dimension,
}

fn definition_of(scalar: &Scalar) -> Option<Symbol> {
    match scalar {
        Scalar::Neg(inner) => definition_of(inner),
        Scalar::Definition(i) => Some(Symbol::Definition(i.0)),
        _ => None,
    }
}
