//! The meaning of a model: names resolved, dimensions and physics checked.

mod checks;
mod counts;
pub mod dimension;
pub mod habits;
mod lower;
pub mod mechanism;
mod members;
mod names;
mod order;
pub mod similar;
mod typed;
pub mod units;

use crate::diagnostics::{Diagnostic, Severity, codes};
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

/// A mechanism has at most so many coordinates, and so many speeds.
const MAX_FREEDOMS: usize = 1000;

fn too_many(tree: &Tree) -> Option<Diagnostic> {
    let (quantity, what) = match (tree.coordinates.get(MAX_FREEDOMS), tree.speeds.get(MAX_FREEDOMS)) {
        (Some(quantity), _) => (quantity, "coordinates"),
        (None, Some(quantity)) => (quantity, "speeds"),
        (None, None) => (tree.dependent.get(MAX_FREEDOMS)?, "dependent speeds"),
    };
    let message = format!("a mechanism has at most {MAX_FREEDOMS} {what}");
    Some(
        Diagnostic::new(codes::TOO_LARGE, quantity.name.span, message)
            .help("quantities that do not move are parameters"),
    )
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
            diagnostics.extend(checks::physics(mechanism));
        }
    }
    // one mistake at a place: what else is found there follows from it
    let mut places = std::collections::HashSet::new();
    diagnostics.retain(|d| d.severity == Severity::Warning || places.insert(d.primary.span));
    diagnostics.sort_by_key(|d| (d.primary.span, d.code));
    let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    Checked { mechanism: mechanism.filter(|_| !failed), diagnostics }
}
