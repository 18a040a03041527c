//! The states that a call is given: one, or rows of them.

use hodograph::{ComponentKind, Contacts, State, StateError};
use hodograph_interpreter::columns::{Column, Table};
use pyo3::prelude::*;

use crate::arguments::Rows;
use crate::errors;

/// The state arguments of a call.
pub struct States<'py> {
    pub q: Rows<'py>,
    pub u: Rows<'py>,
    pub inputs: Rows<'py>,
    pub time: Option<Rows<'py>>,
    pub accelerations: Option<Rows<'py>>,
    pub tangent: Option<Rows<'py>>,
    pub rows: Option<usize>,
}

impl States<'_> {
    /// The state, where it is one.
    pub fn one(&self) -> State<'_> {
        State {
            time: self.time.as_ref().map_or(0.0, |time| time.slice()[0]),
            coordinates: self.q.slice(),
            speeds: self.u.slice(),
            inputs: self.inputs.slice(),
        }
    }

    /// The columns of the rows.
    pub fn table(&self) -> Table<'_> {
        fn columns<'a>(rows: &'a Option<Rows<'_>>) -> Vec<Column<'a>> {
            rows.as_ref().map(Rows::columns).unwrap_or_default()
        }
        Table {
            rows: self.rows.unwrap_or(1),
            time: columns(&self.time).into_iter().next(),
            coordinates: self.q.columns(),
            speeds: self.u.columns(),
            inputs: self.inputs.columns(),
            accelerations: columns(&self.accelerations),
            tangent: columns(&self.tangent),
        }
    }

    /// The rows that hold what is no finite number: the model may not read it, but such a state is none.
    pub fn not_finite(&self) -> Vec<usize> {
        let given = [Some(&self.q), Some(&self.u), Some(&self.inputs)].into_iter().flatten();
        let given = given.chain(&self.time).chain(&self.accelerations).chain(&self.tangent);
        let wrong: Vec<&Rows<'_>> = given.filter(|table| !are_finite(table.slice())).collect();
        if wrong.is_empty() {
            return Vec::new();
        }
        let holds = |row: &usize| wrong.iter().any(|table| !are_finite(table.row(*row)));
        (0..self.rows.unwrap_or(1)).filter(holds).collect()
    }

    /// The exception of a row; `count` rows have none.
    pub fn error(
        &self,
        py: Python<'_>,
        mechanism: &dyn Contacts<f64>,
        failure: &StateError,
        row: usize,
        count: usize,
    ) -> PyErr {
        let table = self.table();
        let at_fault = [
            (&table.coordinates, ComponentKind::Coordinate, "q"),
            (&table.speeds, ComponentKind::Speed, "u"),
            (&table.inputs, ComponentKind::Input, "inputs"),
        ]
        .into_iter()
        .flat_map(|(columns, kind, name)| {
            columns.iter().enumerate().map(move |(index, column)| (kind, name, index, column.get(row)))
        })
        .find(|(.., number)| !number.is_finite());
        let other = [("accelerations", &self.accelerations), ("tangent", &self.tangent)];
        let other = other.into_iter().find_map(|(name, given)| {
            let number = given.as_ref()?.row(row).iter().find(|number| !number.is_finite())?;
            Some((name, *number))
        });
        let (mut message, mut number) = (failure.to_string(), None);
        let mut place = self.rows.map(|_| format!("row {row}"));
        let time = table.time.as_ref().map(|time| time.get(row)).filter(|time| !time.is_finite());
        if let Some(value) = time {
            message = format!("`time` is {value}: it must be finite");
            number = Some(value);
            place = Some(place.map_or("time".to_owned(), |row| format!("{row}, time")));
        } else if let Some((kind, argument, index, value)) = at_fault {
            let name = mechanism.component(kind, index).map_or(String::new(), |c| c.name.to_owned());
            message = format!("`{argument}` holds {value} for {name}: it must be finite");
            number = Some(value);
            place = Some(place.map_or(name.clone(), |row| format!("{row}, {name}")));
        } else if let Some((name, value)) = other {
            message = format!("`{name}` holds {value}: it must be finite");
            number = Some(value);
            place = Some(place.map_or(name.to_owned(), |row| format!("{row}, {name}")));
        }
        if let Some(rows) = self.rows {
            message = format!(
                "row {row}: {message} ({count} of {rows} rows have no answer; errors='nan' answers them with NaN)"
            );
        }
        errors::error(py, "StateError", &message, failure.kind(), place, number)
    }
}

/// Whether all numbers are finite. A block has no branch, so that several are compared at once.
fn are_finite(numbers: &[f64]) -> bool {
    numbers
        .chunks(64)
        .all(|block| block.iter().fold(true, |finite, number| finite & (number.abs() <= f64::MAX)))
}
