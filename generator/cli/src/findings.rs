//! Mistakes in models for programs: as JSON objects, and as a log in SARIF.

use hodograph_generator::diagnostics::codes::ALL;
use hodograph_generator::diagnostics::{Diagnostic, Label, Severity};
use hodograph_generator::source::Source;
use serde::Serialize;
use serde_json::{Value, json};

/// A mistake.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// such as `E020`
    pub code: &'static str,
    /// `error` or `warning`
    pub severity: &'static str,
    /// what is wrong
    pub message: String,
    /// what to do
    pub help: Option<String>,
    /// where
    #[serde(flatten)]
    pub place: Place,
    /// other places that explain it
    pub related: Vec<Related>,
}

/// A place in a file. Lines and columns count from 1, columns in characters; the end is the place after the
/// last character.
#[derive(Clone, Debug, Serialize)]
pub struct Place {
    /// the file, as it was named
    pub file: String,
    /// where it begins
    pub line: usize,
    /// in characters
    pub column: usize,
    /// where it ends
    pub end_line: usize,
    /// in characters
    pub end_column: usize,
}

/// A place that explains a mistake.
#[derive(Clone, Debug, Serialize)]
pub struct Related {
    /// what is there
    pub message: String,
    /// where
    #[serde(flatten)]
    pub place: Place,
}

impl Place {
    fn new(label: &Label, source: &Source) -> Self {
        let (source, span) = source.locate(label.span);
        let at = source.location_here(span);
        let (line, column) = at.map_or((1, 1), |at| (at.line, at.column));
        // An inline model has places of tokens, not of characters: its end is unknown.
        let end = match (source.is_inline(), source.text()) {
            (false, Some(_)) => {
                let mut behind = span;
                behind.start = behind.end;
                source.location_here(behind)
            }
            _ => None,
        };
        let (end_line, end_column) = end.map_or((line, column), |end| (end.line, end.column));
        Place { file: source.name().to_owned(), line, column, end_line, end_column }
    }
}

impl Finding {
    /// Of a model.
    pub fn new(found: &Diagnostic, source: &Source) -> Self {
        let related = found
            .related
            .iter()
            .map(|label| Related { message: label.text.clone(), place: Place::new(label, source) });
        Finding {
            code: found.code.0,
            severity: match found.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            },
            message: found.message.clone(),
            help: found.help.clone(),
            place: Place::new(&found.primary, source),
            related: related.collect(),
        }
    }
}

/// All mistakes as a log of SARIF 2.1.0.
pub fn sarif(findings: &[Finding]) -> Value {
    let location = |place: &Place| {
        json!({
            "artifactLocation": { "uri": uri(&place.file) },
            "region": {
                "startLine": place.line,
                "startColumn": place.column,
                "endLine": place.end_line,
                "endColumn": place.end_column,
            },
        })
    };
    let text = |finding: &Finding| match &finding.help {
        Some(help) => format!("{}; {help}", finding.message),
        None => finding.message.clone(),
    };
    let results: Vec<Value> = findings
        .iter()
        .map(|finding| {
            let related: Vec<Value> = finding
                .related
                .iter()
                .map(|related| {
                    json!({
                        "physicalLocation": location(&related.place),
                        "message": { "text": related.message },
                    })
                })
                .collect();
            json!({
                "ruleId": finding.code,
                "level": finding.severity,
                "message": { "text": text(finding) },
                "locations": [{ "physicalLocation": location(&finding.place) }],
                "relatedLocations": related,
            })
        })
        .collect();
    let rules: Vec<Value> = ALL
        .iter()
        .filter(|(code, _)| findings.iter().any(|finding| finding.code == code.0))
        .map(|(code, title)| json!({ "id": code.0, "shortDescription": { "text": title } }))
        .collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "hodograph",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": rules,
            } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
}

/// A path as a URI reference: with `/` between its parts, other special characters percent-encoded.
fn uri(path: &str) -> String {
    let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte);
    path.replace(std::path::MAIN_SEPARATOR, "/")
        .bytes()
        .map(|byte| match byte {
            byte if allowed(byte) => char::from(byte).to_string(),
            byte => format!("%{byte:02X}"),
        })
        .collect()
}
