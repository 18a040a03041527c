//! Inputs of a motion: expressions of time, or a table in a file.

use std::path::Path;
use std::sync::Arc;

use hodograph_generator::files;
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_simulation::Drive;

use crate::json::{Failure, Kind};
use crate::spelling;
use crate::stop::{Outcome, Stop};

/// A function of time.
type OfTime = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// Functions of time with the indices of their inputs.
type Functions = Vec<(usize, OfTime)>;

/// The functions that drive the inputs.
pub struct InputFunctions {
    /// the functions
    pub drive: Drive,
    /// the times of the rows of a table, at which the rates of inputs jump
    pub breaks: Vec<f64>,
}

/// The functions that drive the inputs; `None` if no option gives any.
///
/// # Errors
///
/// `unknown_name`, and [`Stop::Call`] for expressions and files that cannot be read.
pub fn drive(
    mechanism: &Mechanism,
    expressions: &[String],
    file: Option<&Path>,
) -> Outcome<Option<InputFunctions>> {
    let mut functions = Functions::new();
    let mut breaks = Vec::new();
    if let Some(path) = file {
        let (times, columns) = table(mechanism, path)?;
        breaks.clone_from(&times);
        functions.extend(columns);
    }
    for text in expressions {
        let (name, value) = text
            .split_once('=')
            .ok_or_else(|| Stop::Call(format!("--input {text}: give NAME=EXPRESSION, as in F=2*sin(3*t)")))?;
        let index = index(mechanism, name.trim())?;
        if functions.iter().any(|(other, _)| *other == index) {
            return Err(Stop::Call(format!("--input {text}: {} is given twice: leave one out", name.trim())));
        }
        functions.push((
            index,
            crate::expression::of_time(value)
                .map_err(|error| Stop::Call(format!("--input {text}: {error}")))?,
        ));
    }
    if functions.is_empty() {
        return Ok(None);
    }
    let drive = Drive::Continuous(Arc::new(move |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
        for (index, function) in &functions {
            if let Some(input) = inputs.get_mut(*index) {
                *input = function(t);
            }
        }
    }));
    Ok(Some(InputFunctions { drive, breaks }))
}

fn index(mechanism: &Mechanism, name: &str) -> Result<usize, Failure> {
    let names: Vec<&str> = mechanism.inputs.iter().map(|input| input.name.as_str()).collect();
    names.iter().position(|other| *other == name).ok_or_else(|| {
        let hint = spelling::hint(name, names.iter().copied());
        Failure::new(Kind::UnknownName, format!("{} has no input `{name}`: {hint}", mechanism.name))
    })
}

/// The largest table, in bytes.
const MAX_BYTES: usize = 1 << 30;

/// The times and the columns of a CSV file, linear between its rows and constant outside.
fn table(mechanism: &Mechanism, path: &Path) -> Outcome<(Arc<Vec<f64>>, Functions)> {
    let text = files::text(path, MAX_BYTES).map_err(|error| Stop::unreadable(path, &error))?;
    let wrong = |line: usize, message: &str| Stop::Call(format!("{}:{line}: {message}", path.display()));
    // Some programs write a byte order mark first.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut rows = rows(text).map(|(line, row)| match row {
        Ok(row) => Ok((line, row)),
        Err(error) => Err(wrong(line, &error.to_string())),
    });
    let (_, head) = rows.next().ok_or_else(|| wrong(1, "the file is empty"))??;
    if head.get(0) != Some("t") {
        return Err(wrong(
            1,
            "the first line names the columns, separated by commas, and the first of them is `t`: as in t,F",
        ));
    }
    let mut indices = Vec::new();
    for name in head.iter().skip(1) {
        let index = index(mechanism, name)?;
        if indices.contains(&index) {
            return Err(wrong(1, &format!("the column `{name}` stands there twice: leave one out")));
        }
        indices.push(index);
    }
    let mut columns = vec![Vec::new(); head.len()];
    for row in rows {
        let (line, row) = row?;
        if row.len() != head.len() {
            return Err(wrong(line, &format!("{} values for {} columns", row.len(), head.len())));
        }
        let before = columns[0].last().copied();
        for (column, cell) in columns.iter_mut().zip(&row) {
            match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => column.push(value),
                _ => return Err(wrong(line, &format!("`{cell}` is not a finite number"))),
            }
        }
        if let (Some(before), Some(&time)) = (before, columns[0].last())
            && time <= before
        {
            let message = format!("t = {time} after t = {before}: times must rise from row to row");
            return Err(wrong(line, &message));
        }
    }
    let times = Arc::new(columns.remove(0));
    if times.is_empty() {
        return Err(wrong(1, "there is no row below the names of the columns"));
    }
    let function = |(index, column): (usize, Vec<f64>)| {
        let times = Arc::clone(&times);
        let value: OfTime = Arc::new(move |t| between(&times, &column, t));
        (index, value)
    };
    let functions = indices.into_iter().zip(columns).map(function).collect();
    Ok((times, functions))
}

/// The rows of a CSV file that are not blank, each with the number of its line.
fn rows(text: &str) -> impl Iterator<Item = (usize, csv::Result<csv::StringRecord>)> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut row = csv::StringRecord::new();
    std::iter::from_fn(move || {
        loop {
            // The reader skips empty lines before a row; count them.
            let begin = reader.position().byte() as usize;
            let blank = text[begin..].chars().take_while(|c| matches!(c, '\r' | '\n')).filter(|c| *c == '\n');
            let line = reader.position().line() as usize + blank.count();
            match reader.read_record(&mut row) {
                Ok(false) => return None,
                Ok(true) if row.len() == 1 && row[0].is_empty() => {}
                Ok(true) => return Some((line, Ok(row.clone()))),
                Err(error) => return Some((line, Err(error))),
            }
        }
    })
}

/// The linear interpolation of a table at a time.
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
