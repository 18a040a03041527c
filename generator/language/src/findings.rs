//! All that `check` says, at the same places.

use hodograph_model::diagnostics::{Code, Severity, codes};
use hodograph_model::span::Span;

use crate::Document;

/// A mistake or a warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// where
    pub span: Span,
    /// its kind, as `E012`
    pub code: &'static str,
    /// an error; else a warning
    pub is_error: bool,
    /// something that can be left out
    pub is_unused: bool,
    /// what is wrong and what to do
    pub message: String,
    /// other places that explain it
    pub related: Vec<(Span, String)>,
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
            Finding {
                span: found.primary.span,
                code: found.code.0,
                is_error: found.severity == Severity::Error,
                is_unused: UNUSED.contains(&found.code),
                message,
                related: found.related.iter().map(|label| (label.span, label.text.clone())).collect(),
            }
        };
        self.analysis.diagnostics.iter().map(finding).collect()
    }
}
