//! Gives a model its meaning: resolves names and checks dimensions.

pub(crate) mod constancy;
mod dependency_order;
pub mod hulls;
mod lower;
pub mod mechanism;
pub mod names;
pub(crate) mod pairs;
mod provenance;
mod readable;
pub mod symbols;
mod typed;

use crate::diagnostics::{Diagnostic, codes};
use crate::syntax::tree::Tree;

pub use lower::{Lowered, lower};
pub use readable::Readable;

/// Most speeds that a mechanism may have, dependent ones included. Nothing overflows beyond; but programs of the
/// mass matrix grow with the square of their number, and checks in numbers take time with its cube.
pub const MOST_SPEEDS: usize = 256;
/// Most coordinates: a quaternion for each speed.
pub const MOST_COORDINATES: usize = 4 * MOST_SPEEDS;

/// Says so if a model has more coordinates or speeds than are allowed.
pub fn too_many(tree: &Tree) -> Option<Diagnostic> {
    let speed = tree.speeds.iter().chain(&tree.dependent).nth(MOST_SPEEDS);
    let coordinate = tree.coordinates.get(MOST_COORDINATES);
    let error =
        |span, message: String, help: &str| Diagnostic::new(codes::TOO_LARGE, span, message).help(help);
    match (coordinate, speed) {
        (Some(coordinate), _) => Some(error(
            coordinate.name.span,
            format!(
                "a mechanism has at most {MOST_COORDINATES} coordinates, this has {}",
                tree.coordinates.len()
            ),
            "quantities that do not move are parameters",
        )),
        (None, Some(speed)) => Some(error(
            speed.name.span,
            format!(
                "a mechanism has at most {MOST_SPEEDS} speeds, this has {}",
                tree.speeds.len() + tree.dependent.len()
            ),
            "divide the mechanism, or lump links that hardly move against each other",
        )),
        (None, None) => None,
    }
}
