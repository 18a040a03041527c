//! Quantities of a mechanism at one state or many: by routines of its derived equations, or state by state.

use std::sync::{Arc, PoisonError};

use hodograph::StateError;
use hodograph_generator::interpret::Arguments;
use hodograph_generator::program::Quantity;
use hodograph_interpreter::columns::evaluate_rows;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arguments::{Rows, array};
use crate::machine::Machine;
use crate::machines::{self, Asked, Refused, parameter_error};
use crate::mechanism::Mechanism;
use crate::routine::Routine;
use crate::states::States;
use crate::{errors, numeric};

impl Mechanism {
    fn routine(&self, py: Python<'_>, quantity: &str) -> PyResult<Arc<Routine>> {
        let known = self.routines.read().unwrap_or_else(PoisonError::into_inner).get(quantity).cloned();
        if let Some(routine) = known {
            return Ok(routine);
        }
        let found = named(py, quantity)?;
        let inner = self.inner.derived(py, quantity)?;
        let Some(routine) = Routine::new(inner, found) else { return Err(undefined(py, self, quantity)) };
        let routine = Arc::new(routine);
        let mut routines = self.routines.write().unwrap_or_else(PoisonError::into_inner);
        Ok(routines.entry(quantity.to_owned()).or_insert(routine).clone())
    }

    /// What a quantity of a model without equations is: by name, with its shape.
    fn numeric_quantity(&self, py: Python<'_>, quantity: &str) -> PyResult<(Quantity, Vec<usize>)> {
        let found = named(py, quantity)?;
        match numeric::shape(self.inner.contacts(), found) {
            Some(shape) => Ok((found, shape)),
            None => {
                Err(self.inner.derived(py, quantity).err().unwrap_or_else(|| undefined(py, self, quantity)))
            }
        }
    }

    /// A quantity at one state or many.
    pub fn evaluated<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        states: &States<'py>,
        raises: bool,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let contacts = self.inner.contacts();
        let Machine::Derived(inner) = &self.inner else {
            let (quantity, shape) = self.numeric_quantity(py, quantity)?;
            let asked = Asked::Quantity(quantity, shape.iter().product());
            return self.row_by_row(py, states, &asked, &shape, raises);
        };
        let routine = self.routine(py, quantity)?;
        let wrong = states.not_finite();
        if let Some(&row) = wrong.first().filter(|_| raises) {
            return Err(states.error(py, contacts, &StateError::NotFinite, row, wrong.len()));
        }
        let Some(rows) = states.rows else {
            let none: &[f64] = &[];
            let given =
                |rows: &Option<Rows<'_>>| rows.as_ref().map_or(none.to_vec(), |rows| rows.slice().to_vec());
            let (accelerations, tangent) = (given(&states.accelerations), given(&states.tangent));
            let arguments = Arguments {
                time: states.time.as_ref().map_or(0.0, |time| time.slice()[0]),
                coordinates: states.q.slice(),
                speeds: states.u.slice(),
                inputs: states.inputs.slice(),
                accelerations: &accelerations,
                tangent: &tangent,
            };
            let mut numbers = vec![f64::NAN; routine.one.len()];
            if !wrong.is_empty() {
                return array(py, None, &routine.shape, numbers);
            }
            let outcome = routine.one.evaluate(&arguments, |index, number| numbers[index] = number);
            return match outcome {
                Err(failed) if raises => Err(states.error(py, contacts, &inner.state_error(failed), 0, 1)),
                _ => array(py, None, &routine.shape, numbers),
            };
        };
        if self.machines.is_some() {
            let asked = Asked::Routine(&routine.one);
            return self.row_by_row(py, states, &asked, &routine.shape, raises);
        }
        let table = states.table();
        let mut numbers = vec![0.0; rows * routine.many.len()];
        let mut failures = vec![None; rows];
        py.detach(|| evaluate_rows(&routine.many, &table, &mut numbers, &mut failures));
        if raises && let Some((row, Some(failed))) = failures.iter().enumerate().find(|(_, f)| f.is_some()) {
            let count = failures.iter().filter(|failure| failure.is_some()).count();
            return Err(states.error(py, contacts, &inner.state_error(*failed), row, count));
        }
        blank(&mut numbers, rows, &wrong);
        array(py, Some(rows), &routine.shape, numbers)
    }

    /// Evaluates state by state.
    fn row_by_row<'py>(
        &self,
        py: Python<'py>,
        states: &States<'py>,
        asked: &Asked<'_>,
        shape: &[usize],
        raises: bool,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let contacts = self.inner.contacts();
        let wrong = states.not_finite();
        if let Some(&row) = wrong.first().filter(|_| raises) {
            return Err(states.error(py, contacts, &StateError::NotFinite, row, wrong.len()));
        }
        let of = (&self.inner, self.machines.as_ref());
        let table = states.table();
        let rows = table.rows;
        let (mut numbers, refused) = py.detach(|| machines::evaluate(of, asked, &table));
        blank(&mut numbers, rows, &wrong);
        // What is undefined is so in every state: that is no matter of numbers.
        match refused.first() {
            Some((row, Refused::Parameters(error))) if raises => {
                Err(parameter_error(py, error, (*row, rows, refused.len())))
            }
            Some((row, Refused::State(error))) if raises || matches!(error, StateError::Undefined { .. }) => {
                Err(states.error(py, contacts, error, *row, refused.len()))
            }
            _ => array(py, states.rows, shape, numbers),
        }
    }
}

/// The quantity of this name.
fn named(py: Python<'_>, quantity: &str) -> PyResult<Quantity> {
    let words: Vec<&str> = quantity.split(' ').collect();
    Quantity::from_words(&words).ok_or_else(|| {
        let message = format!("there is no quantity '{quantity}'");
        errors::argument(py, "quantity", "unknown_name", &message)
    })
}

fn undefined(py: Python<'_>, mechanism: &Mechanism, quantity: &str) -> PyErr {
    let message = format!("{} does not determine '{quantity}'", mechanism.inner.model().name);
    errors::error(py, "StateError", &message, "undefined", Some(quantity.to_owned()), None)
}

/// Makes these rows numbers that are none.
fn blank(numbers: &mut [f64], rows: usize, which: &[usize]) {
    let width = numbers.len() / rows.max(1);
    for &row in which {
        numbers[row * width..(row + 1) * width].fill(f64::NAN);
    }
}
