//! The meaning of a model: names resolved, dimensions and physics checked.

mod checks;
mod counts;
pub mod dimension;
pub mod entangled;
pub mod habits;
mod lower;
pub mod mechanism;
mod members;
mod names;
mod order;
mod powers;
pub mod similar;
mod typed;
pub mod units;

use crate::diagnostics::{Diagnostic, Severity, Span, codes};
use crate::source::Source;
use crate::syntax::{self, tree::Tree};
use mechanism::Mechanism;

/// What was found in a model.
#[derive(Clone, Debug)]
pub struct Checked {
    /// the mechanism; there if and only if no error was found
    pub mechanism: Option<Mechanism>,
    /// errors and warnings, in the order of their places
    pub diagnostics: Vec<Diagnostic>,
}

impl Checked {
    /// Was an error found?
    pub fn has_errors(&self) -> bool {
        self.mechanism.is_none()
    }
}

/// Most speeds that a mechanism may have, dependent ones included: the factorised mass matrix grows with their cube.
pub const MOST_SPEEDS: usize = 64;
/// Most coordinates: a quaternion for each speed.
pub const MOST_COORDINATES: usize = 4 * MOST_SPEEDS;

fn too_many(tree: &Tree) -> Option<Diagnostic> {
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

/// Reads and checks a model. Reports all mistakes at once; never fails otherwise.
pub fn check(source: &Source) -> Checked {
    let tokens = match source.tokens() {
        Ok(tokens) => tokens,
        Err(error) => return Checked { mechanism: None, diagnostics: vec![*error] },
    };
    let (tree, diagnostics) = syntax::parse(&tokens);
    // without a name nothing else could be read
    let unread = tree.name.is_none() && tree.sections.is_empty();
    let (mechanism, mut diagnostics) = if let Some(error) = too_many(&tree) {
        (None, diagnostics.into_iter().chain([error]).collect())
    } else if unread {
        (None, diagnostics)
    } else {
        let (mechanism, diagnostics) = lower::lower(&tree, diagnostics);
        (Some(mechanism), diagnostics)
    };
    // what follows looks at the mechanism as a whole, so it must be whole
    let unclear = |list: &[Diagnostic]| list.iter().any(Diagnostic::hides_meaning);
    if let Some(mechanism) = mechanism.as_ref().filter(|_| !unclear(&diagnostics)) {
        diagnostics.extend(counts::counts(mechanism));
        if !unclear(&diagnostics) {
            let name = tree.name.as_ref().map_or(Span::default(), |name| name.span);
            diagnostics.extend(checks::physics(mechanism, name));
        }
    }
    // one mistake at a place: what else is found there follows from it
    let mut places = std::collections::HashSet::new();
    diagnostics.retain(|d| d.severity == Severity::Warning || places.insert(d.primary.span));
    diagnostics.sort_by_key(|d| (d.primary.span, d.code));
    let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    Checked { mechanism: mechanism.filter(|_| !failed), diagnostics }
}
