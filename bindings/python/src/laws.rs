//! Laws of contact beyond mu, e and law, from Python: numbers, texts, tables and functions.

use std::str::FromStr;
use std::sync::{Arc, Mutex, PoisonError};

use hodograph::Contacts;
use hodograph_simulation::{ContactLaw, GivenLaw, Restitution, Sliding, SpeedFunction};
use pyo3::prelude::*;

use crate::errors;

/// mu_static, mu_impact, sliding, restitution, rolling and spinning as they are given; what is not given is none.
pub type GivenParts =
    (Option<f64>, Option<f64>, Option<Py<PyAny>>, Option<Py<PyAny>>, Option<f64>, Option<f64>);

/// The exception that a function of Python raised, kept until the motion ends for it.
pub type Raised = Arc<Mutex<Option<PyErr>>>;

/// Keeps the first exception.
pub fn keep(raised: &Raised, error: PyErr) {
    raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
}

/// A function of Python as a function of a speed; where it raises, it is no number, which ends the motion.
fn function(callable: &Bound<'_, PyAny>, raised: &Raised) -> SpeedFunction {
    let (callable, raised) = (callable.clone().unbind(), Arc::clone(raised));
    Arc::new(move |speed| {
        Python::attach(|py| callable.bind(py).call1((speed,))?.extract::<f64>()).unwrap_or_else(|error| {
            keep(&raised, error);
            f64::NAN
        })
    })
}

fn wrong(py: Python<'_>, place: &str, message: &str) -> PyErr {
    errors::argument(py, place, "bad_option", message)
}

/// A law from its text.
fn text<L: FromStr<Err = String>>(py: Python<'_>, place: &str, given: &Bound<'_, PyAny>) -> PyResult<L> {
    let expects = || {
        wrong(py, place, &format!("`{place}`: expected a text such as 'constant', or a function of a speed"))
    };
    let text: String = given.extract().map_err(|_| expects())?;
    text.parse().map_err(|message: String| wrong(py, place, &message))
}

/// What is given of a law.
pub fn given(py: Python<'_>, parts: &GivenParts, raised: &Raised) -> PyResult<GivenLaw> {
    let (mu_static, mu_impact, sliding, restitution, rolling, spinning) = parts;
    let sliding = sliding.as_ref().map(|given| {
        let given = given.bind(py);
        if given.is_callable() {
            return Ok(Sliding::Function(function(given, raised)));
        }
        text(py, "sliding", given)
    });
    let restitution = restitution.as_ref().map(|given| {
        let given = given.bind(py);
        if given.is_callable() {
            return Ok(Restitution::Function(function(given, raised)));
        }
        match given.extract::<Vec<[f64; 2]>>() {
            Ok(rows) => Ok(Restitution::Table(rows)),
            Err(_) => text(py, "restitution", given),
        }
    });
    Ok(GivenLaw {
        mu_static: *mu_static,
        mu_impact: *mu_impact,
        sliding: sliding.transpose()?,
        restitution: restitution.transpose()?,
        rolling: *rolling,
        spinning: *spinning,
    })
}

/// The laws of all contacts: their own, and for what these leave open that of all, then that of the model, unless the
/// contact has a surface of its own.
pub fn of_contacts(
    py: Python<'_>,
    mechanism: &dyn Contacts<f64>,
    all: &GivenLaw,
    own: &[(usize, GivenLaw)],
    contacts: usize,
) -> PyResult<Vec<(usize, ContactLaw)>> {
    (0..contacts)
        .map(|contact| {
            let law = match own.iter().rev().find(|(other, _)| *other == contact) {
                Some((_, law)) => law.clone().or(all.clone()),
                None => {
                    let stated = ContactLaw::stated(&mechanism.stated_law(contact))
                        .map_err(|message| wrong(py, "restitution", &message))?;
                    all.clone().or(stated.into())
                }
            };
            Ok((contact, law.law()))
        })
        .collect()
}
