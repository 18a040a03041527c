//! A quantity of derived equations, prepared.

use hodograph_generator::interpret::Prepared;
use hodograph_generator::program::Quantity;
use hodograph_generator::program::quantity::{Description, Entries, Extent};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::Columns;

/// A quantity, ready for one state and for many.
pub struct Routine {
    pub one: Prepared,
    pub many: Columns,
    /// of its array at one state
    pub shape: Vec<usize>,
}

impl Routine {
    /// Prepares a quantity; `None` where the mechanism does not determine it.
    pub fn new(mechanism: &InterpretedMechanism, quantity: Quantity) -> Option<Self> {
        let output = mechanism.program().output(quantity)?;
        let Description { shape: [_, columns], entries, .. } = *quantity.description();
        let shape = match (entries, columns) {
            (Entries::Scalar, _) => vec![],
            (_, Extent::Count(1)) => vec![output.values.len()],
            _ => vec![output.rows, output.columns],
        };
        Some(Routine {
            one: Prepared::new(mechanism.program(), mechanism.constants(), &[quantity]),
            many: mechanism.columns(&[quantity]),
            shape,
        })
    }
}
