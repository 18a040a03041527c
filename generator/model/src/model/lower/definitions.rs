//! Lowers the values of definitions.

use super::super::mechanism::DefinitionValue;
use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::super::typed::TypedValue;
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};

impl Lowering<'_> {
    /// The value of a definition.
    pub(super) fn definition(&mut self, i: usize) {
        let source = &self.tree.definitions[i];
        let mut typed = self.expression(&source.value);
        if let Some(stated) = &source.unit
            && let Some(unit) = self.unit(stated)
        {
            match typed.dimension {
                None => typed.dimension = Some(unit.dimension),
                Some(dimension) if dimension != unit.dimension => {
                    let message = format!(
                        "`{}` is stated in {}, but its value is in {dimension}",
                        source.name.text, unit.text
                    );
                    let mut error = Diagnostic::new(codes::DIMENSION, source.value.span, message)
                        .related(stated.span, "stated here");
                    if typed.constant.is_some() {
                        error = error.help(format!(
                            "a plain number has no unit; declare a parameter `fixed {}: {} = ..`",
                            source.name.text, unit.text
                        ));
                    }
                    let says = format!("its value is in {dimension}");
                    let provenance = Provenance::of(Symbol::Definition(i)).over(&typed.provenance);
                    self.contradiction(error, provenance, dimension.over(&unit.dimension), says);
                    typed.dimension = Some(unit.dimension);
                }
                Some(_) => self.agreement(Provenance::of(Symbol::Definition(i)).over(&typed.provenance)),
            }
            typed.provenance = Provenance::of(Symbol::Definition(i));
        } else {
            typed.provenance = typed.provenance.times(&Provenance::of(Symbol::Definition(i)));
        }
        let value = match &typed.value {
            TypedValue::Scalar(scalar) => DefinitionValue::Scalar(scalar.clone()),
            TypedValue::Vector(vector) => DefinitionValue::Vector(vector.clone()),
            TypedValue::Poison => return,
        };
        self.out.definitions[i].value = value;
        self.definitions[i].typed = Some(typed);
    }
}
