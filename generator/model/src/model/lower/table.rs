//! Makes the table of names of what was lowered.

use super::super::mechanism::DefinitionValue;
use super::super::names::Symbol;
use super::super::symbols::{Declared, Symbols};
use super::Lowering;
use crate::dimension::Dimension;

impl Lowering<'_> {
    /// The names with what is known of them, and the places that were noted.
    pub(super) fn table(&mut self) -> Symbols {
        let names: Vec<(String, Symbol)> =
            self.names.declared().map(|(name, symbol)| (name.to_owned(), symbol)).collect();
        let declared = names.into_iter().map(|(name, symbol)| Declared {
            place: self.names.place(&name),
            docs: self.docs_of(symbol).to_owned(),
            dimension: self.dimension_of(symbol),
            is_vector: self.is_vector(symbol),
            name,
            symbol,
        });
        let declared = declared.collect();
        let ambiguous = self.names.ambiguous().map(str::to_owned).collect();
        std::mem::take(&mut self.places).table(declared, ambiguous)
    }

    fn docs_of(&self, symbol: Symbol) -> &str {
        let tree = self.tree;
        let docs = match symbol {
            Symbol::Parameter(i) => tree.parameters.get(i).map(|quantity| &quantity.docs),
            Symbol::Input(i) => tree.inputs.get(i).map(|quantity| &quantity.docs),
            Symbol::Coordinate(i) => tree.coordinates.get(i).map(|quantity| &quantity.docs),
            Symbol::Speed(i) => {
                tree.speeds.iter().chain(&tree.dependent).nth(i).map(|quantity| &quantity.docs)
            }
            Symbol::Definition(i) => tree.definitions.get(i).map(|definition| &definition.docs),
            Symbol::Frame(i) => i.checked_sub(1).and_then(|i| tree.frames.get(i)).map(|frame| &frame.docs),
            Symbol::Point(i) => i.checked_sub(1).and_then(|i| tree.points.get(i)).map(|point| &point.docs),
            Symbol::Body(i) => tree.bodies.iter().chain(&tree.particles).nth(i).map(|body| &body.docs),
            Symbol::Contact(i) => self.out.contacts.get(i).map(|contact| &contact.docs),
            Symbol::Shape(i) => tree.shapes.get(i).map(|shape| &shape.docs),
            Symbol::Time | Symbol::Pi | Symbol::Broken => None,
        };
        docs.map_or("", String::as_str)
    }

    fn dimension_of(&self, symbol: Symbol) -> Option<Dimension> {
        let facts = match symbol {
            Symbol::Parameter(i) => self.parameters.get(i),
            Symbol::Input(i) => self.inputs.get(i),
            Symbol::Coordinate(i) => self.coordinates.get(i),
            Symbol::Speed(i) => self.speeds.get(i),
            Symbol::Definition(i) => return self.definitions.get(i)?.typed.as_ref()?.dimension,
            Symbol::Time => return Some(Dimension::of(0, 0, 1)),
            Symbol::Pi => return Some(Dimension::none()),
            _ => None,
        };
        facts?.unit.as_ref().map(|unit| unit.dimension)
    }

    fn is_vector(&self, symbol: Symbol) -> bool {
        let Symbol::Definition(i) = symbol else { return false };
        let known = self.definitions.get(i).is_some_and(|facts| facts.typed.is_some());
        known && matches!(self.out.definitions[i].value, DefinitionValue::Vector(_))
    }
}
