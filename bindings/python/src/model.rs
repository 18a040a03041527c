//! Models: reading, checking, and evaluation without derivation.

use std::path::Path;

use hodograph_generator::check;
use hodograph_generator::diagnostics::Severity;
use hodograph_generator::files;
use hodograph_generator::source::Source;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors;

/// The model in a file, or in a text that has more than a line.
pub fn source(model: &str) -> Source {
    if model.contains('\n') || model.trim_start().starts_with("mechanism") {
        Source::file("the model", model)
    } else {
        files::model(Path::new(model))
    }
}

/// Diagnostics of a model as dictionaries.
#[pyfunction]
#[pyo3(name = "check")]
pub fn check_model<'py>(py: Python<'py>, model: &str) -> PyResult<Bound<'py, PyList>> {
    let source = source(model);
    let checked = check::check(&source);
    diagnostics(py, &checked, &source)
}

pub fn diagnostics<'py>(
    py: Python<'py>,
    checked: &check::Checked,
    source: &Source,
) -> PyResult<Bound<'py, PyList>> {
    let all = PyList::empty(py);
    for diagnostic in &checked.diagnostics {
        let entry = PyDict::new(py);
        entry.set_item("code", diagnostic.code.to_string())?;
        let severity = if diagnostic.severity == Severity::Error { "error" } else { "warning" };
        entry.set_item("severity", severity)?;
        entry.set_item("message", &diagnostic.message)?;
        let place = source.location(diagnostic.primary.span);
        entry.set_item("line", place.as_ref().map(|place| place.line))?;
        entry.set_item("column", place.as_ref().map(|place| place.column))?;
        entry.set_item("label", &diagnostic.primary.text)?;
        entry.set_item("help", &diagnostic.help)?;
        entry.set_item("text", diagnostic.render(source))?;
        all.append(entry)?;
    }
    Ok(all)
}

/// The exception of a model with mistakes.
pub fn mistakes(py: Python<'_>, checked: &check::Checked, source: &Source) -> PyErr {
    let text = hodograph_generator::rendering::render(&checked.diagnostics, source);
    let first = checked.diagnostics.iter().find(|diagnostic| diagnostic.severity == Severity::Error);
    let place = first.and_then(|first| source.location(first.primary.span));
    let place = place.map(|place| format!("line {}, column {}", place.line, place.column));
    let kind = first.map_or_else(|| "model".to_owned(), |first| first.code.to_string());
    let error = errors::error(py, "ModelError", &text, &kind, place, None);
    let attach =
        || -> PyResult<()> { error.value(py).setattr("_diagnostics", diagnostics(py, checked, source)?) };
    attach().err().unwrap_or(error)
}
