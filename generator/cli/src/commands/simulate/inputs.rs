//! Inputs of a motion: expressions of time, or a table in a file.

use std::path::Path;
use std::sync::Arc;

use hodograph_generator::model::mechanism::Mechanism;
use hodograph_simulation::Drive;

use crate::json::{Failure, Kind};
use crate::spelling;
use crate::stop::{Outcome, Stop};

/// A function of time.
type OfTime = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// What drives the inputs; none where nothing was asked for.
///
/// # Errors
///
/// `unknown_name`, and [`Stop::Call`] for expressions and files that cannot be read.
pub fn drive(mechanism: &Mechanism, expressions: &[String], file: Option<&Path>) -> Outcome<Option<Drive>> {
    let mut functions: Vec<(usize, OfTime)> = Vec::new();
    if let Some(path) = file {
        functions.extend(table(mechanism, path)?);
    }
    for text in expressions {
        let (name, value) = text
            .split_once('=')
            .ok_or_else(|| Stop::Call(format!("--input {text}: give NAME=EXPRESSION, as in F=2*sin(3*t)")))?;
        let index = index(mechanism, name.trim())?;
        functions.push((
            index,
            super::expression::read(value).map_err(|error| Stop::Call(format!("--input {text}: {error}")))?,
        ));
    }
    if functions.is_empty() {
        return Ok(None);
    }
    Ok(Some(Drive::Continuous(Arc::new(move |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
        for (index, function) in &functions {
            if let Some(input) = inputs.get_mut(*index) {
                *input = function(t);
            }
        }
    }))))
}

fn index(mechanism: &Mechanism, name: &str) -> Result<usize, Failure> {
    let names: Vec<&str> = mechanism.inputs.iter().map(|input| input.name.as_str()).collect();
    names.iter().position(|other| *other == name).ok_or_else(|| {
        let hint = spelling::hint(name, names.iter().copied());
        Failure::new(Kind::UnknownName, format!("{} has no input `{name}`: {hint}", mechanism.name))
    })
}

/// The columns of a CSV file, linear between its rows and constant outside.
fn table(mechanism: &Mechanism, path: &Path) -> Outcome<Vec<(usize, OfTime)>> {
    let text = std::fs::read_to_string(path).map_err(|error| Stop::unreadable(path, &error))?;
    let wrong = |line: usize, message: &str| Stop::Call(format!("{}:{line}: {message}", path.display()));
    let mut rows = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let head: Vec<&str> =
        rows.next().ok_or_else(|| wrong(1, "the file is empty"))?.1.split(',').map(str::trim).collect();
    if head.first() != Some(&"t") {
        return Err(wrong(1, "the first column must be `t`"));
    }
    let mut columns = vec![Vec::new(); head.len()];
    for (number, line) in rows {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != head.len() {
            return Err(wrong(number + 1, &format!("{} values for {} columns", cells.len(), head.len())));
        }
        for (column, cell) in columns.iter_mut().zip(cells) {
            match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => column.push(value),
                _ => return Err(wrong(number + 1, &format!("`{cell}` is no finite number"))),
            }
        }
    }
    let times = columns.remove(0);
    if times.is_empty() || times.windows(2).any(|pair| pair[1] <= pair[0]) {
        return Err(wrong(2, "the times must rise from row to row, and there must be one"));
    }
    let times = Arc::new(times);
    let mut functions: Vec<(usize, OfTime)> = Vec::new();
    for (name, column) in head[1..].iter().zip(columns) {
        let times = Arc::clone(&times);
        functions.push((index(mechanism, name)?, Arc::new(move |t| between(&times, &column, t))));
    }
    Ok(functions)
}

/// The value at a time.
fn between(times: &[f64], values: &[f64], t: f64) -> f64 {
    let next = times.partition_point(|&time| time <= t);
    let last = times.len() - 1;
    if next == 0 {
        return values[0];
    }
    if next > last {
        return values[last];
    }
    let share = (t - times[next - 1]) / (times[next] - times[next - 1]);
    values[next - 1] + share * (values[next] - values[next - 1])
}
