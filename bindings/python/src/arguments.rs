//! Arguments: arrays of doubles for one row, shape (p,), or many, shape (n, p).

use hodograph::{Cause, Law, Surface};
use hodograph_interpreter::columns::Column;
use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{
    PyArray1, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyList, PyTuple};

use crate::errors;

/// Numbers from Python.
enum Numbers<'py> {
    Borrowed(PyReadonlyArrayDyn<'py, f64>),
    Owned(Vec<f64>),
}

/// A table of `width` columns: `rows` is none where there is one row for all.
pub struct Rows<'py> {
    numbers: Numbers<'py>,
    pub rows: Option<usize>,
    pub width: usize,
}

impl Rows<'_> {
    /// A table of its own.
    pub fn of(numbers: Vec<f64>, rows: Option<usize>, width: usize) -> Self {
        Rows { numbers: Numbers::Owned(numbers), rows, width }
    }

    /// The numbers of a row; one row serves all.
    pub fn row(&self, row: usize) -> &[f64] {
        let row = if self.rows.is_some() { row } else { 0 };
        self.slice().get(row * self.width..(row + 1) * self.width).unwrap_or(&[])
    }

    /// All numbers, by rows.
    pub fn slice(&self) -> &[f64] {
        match &self.numbers {
            Numbers::Borrowed(array) => array.as_slice().unwrap_or(&[]),
            Numbers::Owned(numbers) => numbers,
        }
    }

    /// The columns; one row serves all.
    pub fn columns(&self) -> Vec<Column<'_>> {
        let numbers = self.slice();
        let stride = if self.rows.is_some() { self.width } else { 0 };
        (0..self.width).map(|column| Column::strided(numbers.get(column..).unwrap_or(&[]), stride)).collect()
    }
}

/// Entries that a masked array hides are not there: they have no number.
fn refuse_masked(py: Python<'_>, given: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    if given.is_exact_instance_of::<PyUntypedArray>() || given.is_exact_instance_of::<PyFloat>() {
        return Ok(());
    }
    let Ok(mask) = given.getattr("mask") else { return Ok(()) };
    if mask.call_method0("any")?.is_truthy()? {
        let message =
            format!("`{name}` has masked entries: fill them (`.filled(value)`), or leave their rows out");
        return Err(errors::argument(py, name, "masked", &message));
    }
    Ok(())
}

/// An array of whole numbers, or something that gives one, as an array of doubles; none of what is no array. Whole numbers
/// are doubles without rounding; other kinds of numbers must be converted by who has them.
fn as_doubles<'py>(
    py: Python<'py>,
    given: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
    let Ok(array) = given.cast::<PyUntypedArray>() else {
        // Tensors of other packages, columns of tables.
        if !given.hasattr("__array__")? {
            return Ok(None);
        }
        let array = py.import("numpy")?.call_method1("asarray", (given,))?;
        return match array.cast::<PyArrayDyn<f64>>() {
            Ok(doubles) => Ok(Some(doubles.clone())),
            Err(_) => as_doubles(py, &array, name),
        };
    };
    if matches!(array.dtype().kind(), b'i' | b'u') {
        return Ok(Some(array.call_method1("astype", ("float64",))?.cast_into::<PyArrayDyn<f64>>()?));
    }
    let found = array.dtype().to_string();
    let message = format!("`{name}` has the dtype {found}: expected float64 (`.astype(float)` converts)");
    Err(errors::argument(py, name, "wrong_dtype", &message))
}

/// A table of `width` columns from an array of shape (width,) or (n, width), or `default` where none is
/// given.
pub fn rows<'py>(
    py: Python<'py>,
    given: Option<&Bound<'py, PyAny>>,
    name: &str,
    width: usize,
    default: &[f64],
) -> PyResult<Rows<'py>> {
    let Some(given) = given else {
        return Ok(Rows::of(default.to_vec(), None, width));
    };
    refuse_masked(py, given, name)?;
    let wrong_shape = |found: String, axes: usize| {
        let message = format!(
            "`{name}` has the shape {found}: it must have {width} numbers, ({width},) or (n, {width})"
        );
        let kind = if axes <= 2 { Cause::WrongLength.name() } else { "wrong_shape" };
        errors::argument(py, name, kind, &message)
    };
    if let Ok(array) = given.cast::<PyArrayDyn<f64>>() {
        let shape = array.shape();
        let rows = match *shape {
            [columns] if columns == width => None,
            [rows, columns] if columns == width => Some(rows),
            _ => {
                return Err(wrong_shape(
                    format!("{shape:?}").replace('[', "(").replace(']', ")"),
                    shape.len(),
                ));
            }
        };
        let array = array.try_readonly().map_err(|_| {
            errors::argument(py, name, "borrowed", &format!("`{name}` is being written to elsewhere"))
        })?;
        // in another order the slice would be one too, but by columns
        let numbers = if array.is_c_contiguous() {
            Numbers::Borrowed(array)
        } else {
            Numbers::Owned(array.as_array().iter().copied().collect())
        };
        return Ok(Rows { numbers, rows, width });
    }
    if let Some(converted) = as_doubles(py, given, name)? {
        return rows(py, Some(converted.as_any()), name, width, default);
    }
    if let Ok(several) = given.extract::<Vec<Vec<f64>>>()
        && !several.is_empty()
    {
        let found = several.len();
        return match several.iter().find(|row| row.len() != width) {
            Some(row) => Err(wrong_shape(format!("({found}, {})", row.len()), 2)),
            None => Ok(Rows { numbers: Numbers::Owned(several.concat()), rows: Some(found), width }),
        };
    }
    match given.extract::<Vec<f64>>() {
        Ok(numbers) if numbers.len() == width => {
            Ok(Rows { numbers: Numbers::Owned(numbers), rows: None, width })
        }
        Ok(numbers) => Err(wrong_shape(format!("({},)", numbers.len()), 1)),
        Err(_) => {
            let kind = given.get_type().name()?;
            let message = format!(
                "`{name}` is of type {kind}: expected a float64 array of shape ({width},) or (n, {width})"
            );
            Err(errors::argument(py, name, "wrong_type", &message))
        }
    }
}

/// One number for all rows, or an array of shape (n,).
pub fn column<'py>(py: Python<'py>, given: &Bound<'py, PyAny>, name: &str) -> PyResult<Rows<'py>> {
    refuse_masked(py, given, name)?;
    if let Ok(number) = given.extract::<f64>() {
        return Ok(Rows { numbers: Numbers::Owned(vec![number]), rows: None, width: 1 });
    }
    let given = if given.cast::<PyArrayDyn<f64>>().is_ok() {
        None
    } else if given.is_instance_of::<PyList>() || given.is_instance_of::<PyTuple>() {
        given.extract::<Vec<f64>>().ok().map(|numbers| PyArray1::from_vec(py, numbers).to_dyn().clone())
    } else {
        as_doubles(py, given, name)?
    }
    .map_or_else(|| given.clone(), Bound::into_any);
    let array = match given.cast::<PyArrayDyn<f64>>() {
        Ok(array) if array.shape().len() == 1 => array.try_readonly().ok(),
        _ => None,
    };
    let Some(array) = array else {
        let message = format!("`{name}`: expected a number, or a float64 array of shape (n,)");
        return Err(errors::argument(py, name, "wrong_type", &message));
    };
    let count = array.shape()[0];
    let numbers = if array.is_c_contiguous() {
        Numbers::Borrowed(array)
    } else {
        Numbers::Owned(array.as_array().iter().copied().collect())
    };
    Ok(Rows { numbers, rows: Some(count), width: 1 })
}

/// The number of rows that all tables have that have some; none if each has one row for all.
pub fn common(py: Python<'_>, tables: &[(&str, &Rows<'_>)]) -> PyResult<Option<usize>> {
    let mut found: Option<(&str, usize)> = None;
    for (name, table) in tables {
        if let Some(rows) = table.rows {
            match found {
                Some((first, count)) if count != rows => {
                    let message =
                        format!("`{name}` has {rows} rows, `{first}` has {count}: expected as many");
                    return Err(errors::argument(py, name, "wrong_shape", &message));
                }
                _ => found = Some((name, rows)),
            }
        }
    }
    Ok(found.map(|(_, rows)| rows))
}

/// The law of this name.
pub fn law_named(py: Python<'_>, name: &str) -> PyResult<Law> {
    Law::read(name).map_err(|error| errors::argument(py, "law", error.kind(), &error.to_string()))
}

/// Friction, restitution and law of every row.
pub struct Surfaces<'py> {
    pub mu: Rows<'py>,
    pub e: Rows<'py>,
    law: Law,
}

impl<'py> Surfaces<'py> {
    pub fn new(py: Python<'py>, mu: &Bound<'py, PyAny>, e: &Bound<'py, PyAny>, law: &str) -> PyResult<Self> {
        let law = law_named(py, law)?;
        Ok(Surfaces { mu: column(py, mu, "mu")?, e: column(py, e, "e")?, law })
    }

    /// The surface of the only row.
    pub fn one(&self) -> Surface<f64> {
        self.of_rows()(0)
    }

    /// The surface of each row, for other threads.
    pub fn of_rows(&self) -> impl Fn(usize) -> Surface<f64> + Sync + '_ {
        let [mu, e] = [&self.mu, &self.e].map(|rows| (rows.slice(), usize::from(rows.rows.is_some())));
        let law = self.law;
        let get = |(numbers, stride): (&[f64], usize), row: usize| {
            numbers.get(row * stride).copied().unwrap_or(f64::NAN)
        };
        move |row| Surface { mu: get(mu, row), e: get(e, row), law }
    }
}

/// An array of this shape, with the rows before it if there are some.
pub fn array<'py>(
    py: Python<'py>,
    rows: Option<usize>,
    shape: &[usize],
    numbers: Vec<f64>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let mut all: Vec<usize> = rows.into_iter().collect();
    all.extend_from_slice(shape);
    let array = ArrayD::from_shape_vec(IxDyn(&all), numbers)
        .map_err(|error| errors::argument(py, "result", "wrong_shape", &error.to_string()))?;
    Ok(PyArrayDyn::from_owned_array(py, array))
}

/// How rows without an answer are told of: by an exception, or by numbers that are not numbers.
pub fn raises(py: Python<'_>, errors: &str) -> PyResult<bool> {
    match errors {
        "raise" => Ok(true),
        "nan" => Ok(false),
        other => {
            let message = format!("errors is '{other}': expected 'raise' or 'nan'");
            Err(errors::argument(py, "errors", "unknown_option", &message))
        }
    }
}
