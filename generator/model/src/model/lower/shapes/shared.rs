//! Expressions that several contacts of a pair share: definitions without a name in the model.

use crate::model::mechanism::{Definition, DefinitionId, DefinitionValue, Scalar, Shape, Vector};
use crate::span::Span;

/// The definitions of a pair of shapes.
pub struct Shared<'d> {
    /// those of the mechanism
    pub definitions: &'d mut Vec<Definition>,
    /// the pair
    pub shapes: [&'d Shape; 2],
    /// where it is stated
    pub at: Span,
}

impl Shared<'_> {
    /// Gives an expression to all that use it.
    pub fn scalar(&mut self, value: Scalar, what: &str) -> Scalar {
        Scalar::Definition(self.keep(DefinitionValue::Scalar(value), what))
    }

    /// The same with a vector.
    pub fn vector(&mut self, value: Vector, what: &str) -> Vector {
        Vector::Definition(self.keep(DefinitionValue::Vector(value), what))
    }

    fn keep(&mut self, value: DefinitionValue, what: &str) -> DefinitionId {
        let [first, second] = self.shapes;
        let name = format!("{what} of `{}` and `{}`", first.name, second.name);
        self.definitions.push(Definition { name, docs: String::new(), value, span: self.at });
        DefinitionId(self.definitions.len() - 1)
    }
}
