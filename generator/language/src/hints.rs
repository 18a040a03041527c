//! Dimensions for names and equations that do not state them.

use hodograph_model::dimension::Dimension;
use hodograph_model::span::Span;

use crate::Document;

/// A dimension that the text does not state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hint {
    /// the place after which it is shown
    pub offset: u32,
    /// the dimension, such as `: N*m`
    pub label: String,
}

impl Document {
    /// The dimensions of definitions without unit, and of equations, that begin inside a range.
    pub fn hints(&self, within: Span) -> Vec<Hint> {
        let (tree, symbols) = (self.tree(), self.symbols());
        let mut out = Vec::new();
        let label = |dimension: Dimension| format!(": {dimension}");
        for definition in tree.definitions.iter().filter(|definition| definition.unit.is_none()) {
            let dimension = symbols.named(&definition.name.text).and_then(|declared| declared.dimension);
            out.extend(dimension.map(|d| Hint { offset: definition.name.span.end, label: label(d) }));
        }
        for equation in tree.kinematics.iter().chain(&tree.constraints).chain(&tree.configuration) {
            let sides = [&equation.left, &equation.right];
            let dimension = sides.iter().find_map(|side| symbols.value(side.span)?.dimension);
            out.extend(dimension.map(|d| Hint { offset: equation.right.span.end, label: label(d) }));
        }
        out.retain(|hint| within.start <= hint.offset && hint.offset <= within.end);
        out.sort_by_key(|hint| hint.offset);
        out
    }
}
