//! Exceptions: the classes are those of the package, and carry kind, place and number.

use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An exception of this class of the package.
pub fn error(
    py: Python<'_>,
    class: &str,
    message: &str,
    kind: &str,
    place: Option<String>,
    number: Option<f64>,
) -> PyErr {
    let make = || -> PyResult<PyErr> {
        let details = PyDict::new(py);
        details.set_item("kind", kind)?;
        details.set_item("place", place)?;
        details.set_item("number", number)?;
        let class = py.import("hodograph")?.getattr(class)?;
        Ok(PyErr::from_value(class.call((message,), Some(&details))?))
    };
    make().unwrap_or_else(|error| error)
}

/// An argument has the wrong form.
pub fn argument(py: Python<'_>, place: &str, kind: &str, message: &str) -> PyErr {
    error(py, "ArgumentError", message, kind, Some(place.to_owned()), None)
}

/// A number at fault: the value that an error names, if it names one.
pub fn number(error: &hodograph::ImpactError<f64>) -> Option<f64> {
    use hodograph::ImpactError as E;
    match *error {
        E::NotFinite { value } => Some(value),
        E::NegativeFriction { mu } => Some(mu),
        E::RestitutionOutOfRange { e } => Some(e),
        E::NotApproaching { normal_velocity } | E::Wedged { normal_velocity, .. } => Some(normal_velocity),
        E::NotPositiveSemidefinite { minor } => Some(minor),
        E::NoNormalMobility { nn } => Some(nn),
        E::NoImpact { rate } => Some(rate),
        E::Inaccurate { residual, .. } => Some(residual),
        _ => None,
    }
}
