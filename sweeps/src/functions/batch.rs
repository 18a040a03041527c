//! The argument of a model's function: columns of coordinates, speeds, inputs, parameters and surfaces, read
//! row by row.

use std::ops::Range;

use datafusion::arrow::array::{Array, ArrayRef, AsArray, Float64Array, StringArray};
use datafusion::arrow::compute::cast;
use datafusion::arrow::datatypes::{DataType, Float64Type};
use datafusion::common::{Result, plan_err};
use hodograph::{Law, State, Surface};
use hodograph_interpreter::columns::{Column, Table};

use super::places::Place;
use super::{UNKNOWN_CONTACT, UNKNOWN_LAW};

/// The columns of a batch.
pub struct Batch {
    /// number of rows
    pub rows: usize,
    /// the places of the fields of the argument
    pub places: Vec<Place>,
    numbers: Vec<Option<Float64Array>>,
    law: Option<StringArray>,
    contact: Option<StringArray>,
    texts: Vec<(Place, StringArray)>,
    /// whether no argument of the row is NULL
    pub valid: Vec<bool>,
}

impl Batch {
    /// The columns of a struct with these places.
    ///
    /// # Errors
    ///
    /// A column whose type cannot be read.
    pub fn new(argument: &ArrayRef, places: Vec<Place>) -> Result<Self> {
        let Some(columns) = argument.as_struct_opt() else { return plan_err!("the argument is no struct") };
        let rows = argument.len();
        let mut batch = Batch {
            rows,
            numbers: Vec::new(),
            law: None,
            contact: None,
            texts: Vec::new(),
            valid: vec![true; rows],
            places,
        };
        let mut see = |array: &dyn Array| {
            if array.null_count() > 0 {
                batch.valid.iter_mut().enumerate().for_each(|(row, valid)| *valid &= !array.is_null(row));
            }
        };
        see(argument);
        for (place, column) in batch.places.iter().zip(columns.columns()) {
            match place {
                Place::Law | Place::Contact => {
                    let text = cast(column, &DataType::Utf8)?;
                    see(&text);
                    let text = text.as_string::<i32>().clone();
                    *(if *place == Place::Law { &mut batch.law } else { &mut batch.contact }) = Some(text);
                    batch.numbers.push(None);
                }
                place if place.is_text() => {
                    let text = cast(column, &DataType::Utf8)?;
                    see(&text);
                    batch.texts.push((*place, text.as_string::<i32>().clone()));
                    batch.numbers.push(None);
                }
                _ => {
                    let numbers = cast(column, &DataType::Float64)?;
                    see(&numbers);
                    batch.numbers.push(Some(numbers.as_primitive::<Float64Type>().clone()));
                }
            }
        }
        Ok(batch)
    }

    /// The number in a row, if the field is given.
    pub fn number(&self, place: Place, row: usize) -> Option<f64> {
        self.given(place).map(|column| column.get(row))
    }

    /// The text in a row, if the field is given.
    pub fn text(&self, place: Place, row: usize) -> Option<&str> {
        match place {
            Place::Law => self.law.as_ref().map(|texts| texts.value(row)),
            _ => self.texts.iter().find(|(given, _)| *given == place).map(|(_, texts)| texts.value(row)),
        }
    }

    fn given(&self, place: Place) -> Option<Column<'_>> {
        let index = self.places.iter().position(|&given| given == place)?;
        self.numbers.get(index)?.as_ref().map(|numbers| Column::new(numbers.values()))
    }

    fn list<'a>(&'a self, defaults: &'a [f64], place: fn(usize) -> Place) -> Vec<Column<'a>> {
        let column = |index: usize| {
            self.given(place(index)).unwrap_or(Column::strided(defaults.get(index..).unwrap_or(&[]), 0))
        };
        (0..defaults.len()).map(column).collect()
    }

    /// The states of the rows; missing fields take the defaults: coordinates, speeds, inputs, parameters.
    pub fn table<'a>(&'a self, defaults: &'a [Vec<f64>; 4]) -> Table<'a> {
        let [coordinates, speeds, inputs, _] = defaults;
        Table {
            rows: self.rows,
            time: self.given(Place::Time),
            coordinates: self.list(coordinates, Place::Coordinate),
            speeds: self.list(speeds, Place::Speed),
            inputs: self.list(inputs, Place::Input),
            ..Table::default()
        }
    }

    /// The surfaces of the rows.
    pub fn surfaces(&self) -> Surfaces<'_> {
        Surfaces { mu: self.given(Place::Mu), e: self.given(Place::E), law: self.law.as_ref() }
    }

    /// The contact of a row: the named one, or the only one.
    ///
    /// # Errors
    ///
    /// The kind of a row whose contact is unknown.
    pub fn contact(&self, contacts: &[String], row: usize) -> Result<usize, &'static str> {
        match (&self.contact, contacts) {
            (None, [_]) => Ok(0),
            (None, _) => Err(UNKNOWN_CONTACT),
            (Some(names), _) => {
                contacts.iter().position(|contact| contact == names.value(row)).ok_or(UNKNOWN_CONTACT)
            }
        }
    }

    /// The ranges of consecutive rows with the same parameters, and the parameters of each.
    pub fn stretches(&self, defaults: &[f64]) -> Vec<(Range<usize>, Vec<f64>)> {
        let columns = self.list(defaults, Place::Parameter);
        let of = |row: usize| columns.iter().map(|column| column.get(row)).collect::<Vec<f64>>();
        let mut all: Vec<(Range<usize>, Vec<f64>)> = Vec::new();
        for row in 0..self.rows {
            let parameters = of(row);
            let same = |known: &[f64]| known.iter().zip(&parameters).all(|(a, b)| a.to_bits() == b.to_bits());
            match all.last_mut() {
                Some((range, known)) if same(known) => range.end = row + 1,
                _ => all.push((row..row + 1, parameters)),
            }
        }
        all
    }
}

/// The columns of the surfaces.
pub struct Surfaces<'a> {
    mu: Option<Column<'a>>,
    e: Option<Column<'a>>,
    law: Option<&'a StringArray>,
}

impl Surfaces<'_> {
    /// The surface of a row; missing parts are those of `stated`.
    ///
    /// # Errors
    ///
    /// The kind of a row whose law is unknown.
    pub fn of(&self, row: usize, stated: Option<Surface<f64>>) -> Result<Surface<f64>, &'static str> {
        let number = |given: Option<Column<'_>>, stated: Option<f64>| {
            given.map(|column| column.get(row)).or(stated).unwrap_or(f64::NAN)
        };
        let law = match self.law {
            Some(law) => Law::named(law.value(row)),
            None => stated.map(|stated| stated.law),
        };
        let (mu, e) = (stated.map(|stated| stated.mu), stated.map(|stated| stated.e));
        Ok(Surface { mu: number(self.mu, mu), e: number(self.e, e), law: law.ok_or(UNKNOWN_LAW)? })
    }
}

/// The numbers of one row of a table.
pub struct Row {
    time: f64,
    lists: [Vec<f64>; 3],
}

impl Row {
    /// The defaults: coordinates, speeds, inputs, parameters.
    pub fn new(defaults: &[Vec<f64>; 4]) -> Self {
        let [q, u, inputs, _] = defaults;
        Row { time: 0.0, lists: [q.clone(), u.clone(), inputs.clone()] }
    }

    /// Reads a row.
    pub fn read(&mut self, table: &Table<'_>, row: usize) {
        self.time = table.time.map_or(0.0, |time| time.get(row));
        for (list, columns) in self.lists.iter_mut().zip([&table.coordinates, &table.speeds, &table.inputs]) {
            list.iter_mut().zip(columns).for_each(|(number, column)| *number = column.get(row));
        }
    }

    /// The state of the row that was read last.
    pub fn state(&self) -> State<'_> {
        let [coordinates, speeds, inputs] = &self.lists;
        State { time: self.time, coordinates, speeds, inputs }
    }
}
