//! The mistakes and warnings of `check`, with their places.

use hodograph_model::diagnostics::{Code, Severity, codes};
use hodograph_model::span::Span;

use crate::{Document, Place};

/// A mistake or a warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// its place in the document; for a place in an imported file that of the use or import
    pub span: Span,
    /// its own place
    pub place: Place,
    /// its code, such as `E012`
    pub code: &'static str,
    /// whether it is an error, else a warning
    pub is_error: bool,
    /// whether it concerns something that can be left out
    pub is_unused: bool,
    /// what is wrong and what to do
    pub message: String,
    /// other places that explain it
    pub related: Vec<(Place, String)>,
}

const UNUSED: [Code; 3] = [codes::UNUSED_PARAMETER, codes::UNUSED_INPUT, codes::UNUSED_DEFINITION];

impl Document {
    /// The mistakes and warnings, in the order of their places.
    pub fn findings(&self) -> Vec<Finding> {
        let finding = |found: &hodograph_model::diagnostics::Diagnostic| {
            let mut message = found.message.clone();
            let label = Some(&found.primary.text).filter(|text| !text.is_empty());
            for more in label.into_iter().chain(&found.help) {
                message.push('\n');
                message.push_str(more);
            }
            let place = self.place(found.primary.span);
            let here = (place, "the mistake itself".to_owned());
            let related = found.related.iter().map(|label| (self.place(label.span), label.text.clone()));
            Finding {
                span: self.source.in_itself(found.primary.span),
                place,
                code: found.code.0,
                is_error: found.severity == Severity::Error,
                is_unused: UNUSED.contains(&found.code),
                message,
                related: Some(here).filter(|_| place.file > 0).into_iter().chain(related).collect(),
            }
        };
        self.analysis.diagnostics.iter().map(finding).collect()
    }
}
