//! Lowers initial values that use parameters and other initial values, as `q3: m = h*cos(q5)`, and
//! `touching(contact)`, the value at which a gap is 0.

use super::super::mechanism::Initial;
use super::super::names::Symbol;
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::syntax::tree::{Expr, ExprKind, Name};

/// What stands before the name of the contact.
const TOUCHING: &str = "touching";

/// Whether a value follows from other quantities.
pub(super) fn has_names(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Name(name) => name != "pi",
        ExprKind::Error | ExprKind::Number(_) => false,
        ExprKind::Sum(parts) | ExprKind::Product(parts) => parts.iter().any(|(_, part)| has_names(part)),
        ExprKind::Power(a, b) => has_names(a) || has_names(b),
        ExprKind::Neg(inner) | ExprKind::Rate(inner) => has_names(inner),
        ExprKind::Call(function, arguments) => function.text == TOUCHING || arguments.iter().any(has_names),
        ExprKind::Method(..) | ExprKind::Field(..) => true,
        ExprKind::List(items) => items.iter().any(has_names),
    }
}

impl Lowering<'_> {
    /// The initial values that follow from other quantities. Their numbers are found when all is known.
    pub(super) fn initial_values(&mut self) {
        let tree = self.tree;
        let mut stated = Vec::new();
        for (i, declaration) in tree.coordinates.iter().enumerate() {
            stated.push((Symbol::Coordinate(i), declaration));
        }
        for (i, declaration) in tree.speeds.iter().enumerate() {
            stated.push((Symbol::Speed(i), declaration));
        }
        for (symbol, declaration) in stated {
            let Some(value) = declaration.value.as_ref().filter(|value| has_names(value)) else { continue };
            let initial = match &value.kind {
                ExprKind::Call(function, arguments) if function.text == TOUCHING => {
                    self.touching(symbol, value, arguments)
                }
                _ => self.initial_expression(symbol, value),
            };
            let variable = match symbol {
                Symbol::Coordinate(i) => self.out.coordinates.get_mut(i),
                Symbol::Speed(i) => self.out.speeds.get_mut(i),
                _ => None,
            };
            if let (Some(variable), Some(initial)) = (variable, initial) {
                variable.initial = Some(initial);
            }
        }
    }

    fn initial_expression(&mut self, symbol: Symbol, value: &Expr) -> Option<Initial> {
        if !self.made_of_values(value) {
            return None;
        }
        let typed = self.expression(value);
        let facts = match symbol {
            Symbol::Coordinate(i) => self.coordinates.get(i),
            Symbol::Speed(i) => self.speeds.get(i),
            _ => None,
        };
        let unit = facts?.unit.clone()?;
        let scalar = self.need_scalar(&typed, "an initial value")?;
        let before = self.mistakes();
        self.demand(&typed, unit.dimension, "this initial value");
        if !unit.is_si() && unit.dimension.is_none() {
            self.plain_numbers(value, &unit.text);
        }
        (self.mistakes() == before).then_some(Initial::Expression { value: scalar, span: value.span })
    }

    /// Beside a quantity a plain number counts in radians, and not in the declared unit, as it does alone.
    fn plain_numbers(&mut self, value: &Expr, unit: &str) {
        let ExprKind::Sum(terms) = &value.kind else { return };
        if let Some((_, plain)) = terms.iter().find(|(_, term)| !has_names(term)) {
            let message = format!("beside a quantity this counts in radians, not in {unit}");
            let help = format!("declare a `fixed` parameter in {unit} for it, or convert it: `30*pi/180`");
            self.report(Diagnostic::new(codes::DIMENSION, plain.span, message).help(help));
        }
    }

    /// Whether the expression has nothing but numbers, functions, parameters and initial values; reports what
    /// else there is.
    fn made_of_values(&mut self, expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Error => false,
            ExprKind::Number(_) => true,
            ExprKind::Name(text) => self.is_value(&Name { text: text.clone(), span: expr.span }),
            ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                let made: Vec<bool> = parts.iter().map(|(_, part)| self.made_of_values(part)).collect();
                made.iter().all(|made| *made)
            }
            ExprKind::Power(a, b) => self.made_of_values(a) & self.made_of_values(b),
            ExprKind::Neg(inner) => self.made_of_values(inner),
            ExprKind::Call(function, arguments) if super::calls::is_function(&function.text) => {
                let made: Vec<bool> = arguments.iter().map(|part| self.made_of_values(part)).collect();
                made.iter().all(|made| *made)
            }
            _ => {
                let message = "an initial value is made of numbers, parameters and other initial values";
                let error = Diagnostic::new(codes::CONSTANT, expr.span, message);
                self.report(error.help(
                    "functions of numbers may stand in it, such as `sqrt(l^2 - h^2)`; a start in contact is `touching(contact)`, alone",
                ));
                false
            }
        }
    }

    fn is_value(&mut self, name: &Name) -> bool {
        use Symbol::{Coordinate, Parameter, Pi, Speed};
        let fits = |symbol| matches!(symbol, Parameter(_) | Coordinate(_) | Speed(_) | Pi);
        let Some(symbol) = self.names.get(&name.text) else {
            self.resolve(name, fits);
            return false;
        };
        let dependent = |i: usize| self.out.speeds.get(i).is_none_or(|speed| speed.dependent);
        let wrong = match symbol {
            Symbol::Broken => return false,
            Speed(i) if dependent(i) => "a dependent speed, which has no value of its own",
            Parameter(i) if self.out.parameters.get(i).is_some_and(|p| p.value.is_none()) => {
                let message =
                    format!("this initial value needs the parameter `{}`, which has no value", name.text);
                let place = self.out.parameters[i].span;
                let error = Diagnostic::new(codes::NEEDS_VALUE, name.span, message);
                self.report(error.related(place, "declared here").help("give the parameter a value"));
                return false;
            }
            symbol if fits(symbol) => return true,
            symbol => symbol.kind(),
        };
        let message = format!(
            "an initial value uses parameters and other initial values, but `{}` is {wrong}",
            name.text
        );
        self.report(Diagnostic::new(codes::CONSTANT, name.span, message));
        false
    }

    /// `touching(contact)` or `touching(contact, guess)`
    fn touching(&mut self, symbol: Symbol, value: &Expr, arguments: &[Expr]) -> Option<Initial> {
        let form = "write `touching(contact)`, or `touching(contact, guess)` with a number near the value";
        let wrong = |message: &str| Diagnostic::new(codes::START, value.span, message).help(form);
        let Symbol::Coordinate(i) = symbol else {
            self.report(wrong("only a coordinate can be such that a contact is closed"));
            return None;
        };
        if self.out.coordinates.get(i).is_some_and(|coordinate| coordinate.dependent) {
            self.report(wrong("a dependent coordinate follows from the configuration equations"));
            return None;
        }
        let Some((Expr { kind: ExprKind::Name(text), span }, rest)) = arguments.split_first() else {
            self.report(wrong("the name of a contact is needed here"));
            return None;
        };
        if rest.len() > 1 {
            self.report(wrong("`touching` has one or two arguments"));
            return None;
        }
        let name = Name { text: text.clone(), span: *span };
        let contact = match self.resolve(&name, |symbol| matches!(symbol, Symbol::Contact(_)))? {
            Symbol::Contact(contact) => contact,
            other => {
                self.wrong_kind(&name, "a contact", &format!("`{text}` is {}", other.kind()));
                return None;
            }
        };
        let guess = match rest.first() {
            None => 0.0,
            Some(guess) => self.constant(guess).constant?,
        };
        Some(Initial::Touching { contact, guess, span: value.span })
    }
}
