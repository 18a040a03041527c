//! Expressions that several contacts of a pair of shapes share, or the mass properties of a body: definitions without a
//! name in the model.

use crate::model::mechanism::{Definition, DefinitionId, DefinitionValue, Scalar, Shape, Vector};
use crate::span::Span;

/// The definitions of a pair of shapes, or of one.
pub struct Shared<'d> {
    /// those of the mechanism
    definitions: &'d mut Vec<Definition>,
    /// what they are of
    of: String,
    /// where it is stated
    pub at: Span,
}

impl<'d> Shared<'d> {
    /// Those of a pair of shapes.
    pub fn pair([first, second]: [&Shape; 2], definitions: &'d mut Vec<Definition>, at: Span) -> Self {
        Shared { definitions, of: format!("`{}` and `{}`", first.name, second.name), at }
    }

    /// Those of one shape.
    pub fn one(shape: &Shape, definitions: &'d mut Vec<Definition>, at: Span) -> Self {
        Shared { definitions, of: format!("`{}`", shape.name), at }
    }

    /// Gives an expression to all that use it.
    pub fn scalar(&mut self, value: Scalar, what: &str) -> Scalar {
        Scalar::Definition(self.keep(DefinitionValue::Scalar(value), what))
    }

    /// The same with a vector.
    pub fn vector(&mut self, value: Vector, what: &str) -> Vector {
        Vector::Definition(self.keep(DefinitionValue::Vector(value), what))
    }

    fn keep(&mut self, value: DefinitionValue, what: &str) -> DefinitionId {
        let name = format!("{what} of {}", self.of);
        let definition = Definition { name, docs: String::new(), value, of_shapes: true, span: self.at };
        self.definitions.push(definition);
        DefinitionId(self.definitions.len() - 1)
    }
}
