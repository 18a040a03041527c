//! Reads measured motions from a CSV file.

use std::collections::HashSet;
use std::path::Path;

use hodograph::{ComponentKind, Mechanism as _, State};
use hodograph_generator::files;
use hodograph_gradients::{FitError, FittedStart, Trajectory, fit_start};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use nalgebra::DMatrix;

use crate::stop::{Outcome, Stop};

/// The largest file, in bytes.
const MAX_BYTES: usize = 1 << 30;

/// Measured motions.
pub struct Motions {
    pub trajectories: Vec<Trajectory>,
    /// the quantities that are compared: indices into coordinates followed by independent speeds
    pub measured: Vec<usize>,
}

/// The content of a column.
#[derive(Clone, Copy, PartialEq)]
enum Column {
    Time,
    Trajectory,
    /// an index into coordinates followed by independent speeds
    State(usize),
}

/// A row: its line, trajectory, time, and the values of its state columns; NaN for an empty cell.
struct Row {
    line: u64,
    trajectory: String,
    time: f64,
    numbers: Vec<f64>,
}

impl Motions {
    /// Fits the start states to the samples within `flight` s, and puts them in place of those of the first rows.
    pub fn fit_starts(
        &mut self,
        mechanism: &InterpretedMechanism,
        options: &Options,
        units: &[f64],
        flight: f64,
    ) -> Result<Vec<FittedStart>, FitError> {
        let of = |trajectory: &mut Trajectory| {
            let found = fit_start(mechanism, options, (&self.measured, units), trajectory, flight)?;
            trajectory.clone_from(&found.trajectory);
            Ok(found)
        };
        self.trajectories.iter_mut().map(of).collect()
    }

    /// Reads motions. `start` is the state of quantities without a column. Without `outputs` all columns of
    /// the state are compared.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`], with the line and the column.
    pub fn read(
        path: &Path,
        mechanism: &InterpretedMechanism,
        start: &State<'_>,
        outputs: &[String],
    ) -> Outcome<Self> {
        let text = files::text(path, MAX_BYTES).map_err(|error| Stop::unreadable(path, &error))?;
        let wrong = |what: String| Stop::Call(format!("{}: {what}", path.display()));
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        for name in ["t", "trajectory"] {
            if index_of(mechanism, name).is_some() {
                return Err(wrong(format!(
                    "the column `{name}` could be two things, since a quantity of the model has this name too: rename it in the model"
                )));
            }
        }
        let heads = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
        let columns: Result<Vec<Column>, String> = heads.iter().map(|head| column(mechanism, head)).collect();
        let columns = columns.map_err(wrong)?;
        for (place, column) in columns.iter().enumerate() {
            if columns[..place].contains(column) {
                return Err(wrong(format!("the column `{}` occurs twice", &heads[place])));
            }
        }
        if !columns.contains(&Column::Time) {
            return Err(wrong("there is no column `t`, the time in s".to_owned()));
        }
        let states: Vec<usize> = columns
            .iter()
            .filter_map(|column| match column {
                Column::State(index) => Some(*index),
                _ => None,
            })
            .collect();
        let mut measured = Vec::new();
        for name in outputs {
            let index = index_of(mechanism, name.trim()).filter(|index| states.contains(index));
            measured.push(index.ok_or_else(|| {
                Stop::Call(format!("--outputs: the data have no column `{}` of the state", name.trim()))
            })?);
        }
        if outputs.is_empty() {
            measured.clone_from(&states);
        }
        if measured.is_empty() {
            return Err(wrong("no column holds a coordinate or speed of the model".to_owned()));
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| wrong(sentence(&error)))?;
            rows.push(row(&record, &columns, &heads).map_err(wrong)?);
        }
        let each: Vec<&[Row]> = rows.chunk_by(|a, b| a.trajectory == b.trajectory).collect();
        let mut names = HashSet::new();
        for Row { line, trajectory, .. } in each.iter().map(|rows| &rows[0]) {
            if !names.insert(trajectory) {
                return Err(wrong(format!(
                    "line {line}: trajectory {trajectory} has rows in two places: the rows of a trajectory must stand together"
                )));
            }
        }
        let read = |rows: &&[Row]| trajectory(mechanism, start, rows, &states, &measured);
        let trajectories = each.iter().map(read).collect::<Result<Vec<_>, _>>().map_err(wrong)?;
        if trajectories.is_empty() {
            return Err(wrong("there are no rows".to_owned()));
        }
        Ok(Motions { trajectories, measured })
    }

    /// The names of the quantities that are compared.
    pub fn names(&self, mechanism: &InterpretedMechanism) -> Vec<String> {
        let count = mechanism.count(ComponentKind::Coordinate);
        let name = |index: &usize| {
            let component = match index.checked_sub(count) {
                Some(speed) => mechanism.component(ComponentKind::Speed, speed),
                None => mechanism.component(ComponentKind::Coordinate, *index),
            };
            component.map_or_else(String::new, |component| component.name.to_owned())
        };
        self.measured.iter().map(name).collect()
    }

    /// The index of a quantity among those that are compared.
    pub fn place(&self, mechanism: &InterpretedMechanism, name: &str) -> Option<usize> {
        let index = index_of(mechanism, name)?;
        self.measured.iter().position(|other| *other == index)
    }

    /// The standard deviation of each column over all motions; 1 for a constant column.
    pub fn deviations(&self) -> Vec<f64> {
        let deviation = |column: usize| {
            let all = self
                .trajectories
                .iter()
                .flat_map(|one| one.samples.column(column).iter().copied().collect::<Vec<_>>());
            let all: Vec<f64> = all.filter(|value| !value.is_nan()).collect();
            let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
            let square =
                all.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / all.len().max(1) as f64;
            if square > 0.0 { square.sqrt() } else { 1.0 }
        };
        (0..self.measured.len()).map(deviation).collect()
    }
}

/// Why a row cannot be read.
fn sentence(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!(
                "line {line}: it has {len} cells, and the head {expected_len}: leave cells of what was not measured empty, with their commas"
            )
        }
        _ => error.to_string(),
    }
}

/// The number of a coordinate or independent speed among both.
fn index_of(mechanism: &InterpretedMechanism, name: &str) -> Option<usize> {
    let speed = || {
        let count = mechanism.count(ComponentKind::Coordinate);
        mechanism.index(ComponentKind::Speed, name).map(|index| count + index)
    };
    mechanism.index(ComponentKind::Coordinate, name).or_else(speed)
}

/// What a column with this head holds: a name, and in brackets its unit.
fn column(mechanism: &InterpretedMechanism, head: &str) -> Result<Column, String> {
    let (name, unit) = match head.split_once('[') {
        Some((name, rest)) => {
            let unit =
                rest.strip_suffix(']').ok_or_else(|| format!("the head `{head}` lacks a bracket `]`"))?;
            (name.trim(), Some(unit.trim()))
        }
        None => (head.trim(), None),
    };
    let check = |own: &str| match unit {
        Some(unit) if unit != own => {
            Err(format!("the column `{name}` is in {unit}, the model counts it in {own}: convert it"))
        }
        _ => Ok(()),
    };
    if let Some(index) = index_of(mechanism, name) {
        let count = mechanism.count(ComponentKind::Coordinate);
        let component = match index.checked_sub(count) {
            Some(speed) => mechanism.component(ComponentKind::Speed, speed),
            None => mechanism.component(ComponentKind::Coordinate, index),
        };
        check(component.map_or("1", |component| component.unit))?;
        return Ok(Column::State(index));
    }
    match name {
        "t" => check("s").map(|()| Column::Time),
        "trajectory" => Ok(Column::Trajectory),
        _ => Err(format!(
            "the column `{name}` is neither t, trajectory, nor a coordinate or independent speed of the model: rename it or leave it out"
        )),
    }
}

fn row(record: &csv::StringRecord, columns: &[Column], heads: &csv::StringRecord) -> Result<Row, String> {
    let line = record.position().map_or(0, csv::Position::line);
    let mut row = Row { line, trajectory: "1".to_owned(), time: f64::NAN, numbers: Vec::new() };
    for ((cell, column), head) in record.iter().zip(columns).zip(heads) {
        let number = || match cell.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("line {line}: `{cell}` in the column `{head}` is not a finite number")),
        };
        match column {
            Column::Trajectory => cell.clone_into(&mut row.trajectory),
            Column::Time => row.time = number()?,
            Column::State(_) => row.numbers.push(if cell.is_empty() { f64::NAN } else { number()? }),
        }
    }
    Ok(row)
}

fn trajectory(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    rows: &[Row],
    states: &[usize],
    measured: &[usize],
) -> Result<Trajectory, String> {
    let first = &rows[0];
    let mut state = [start.coordinates, start.speeds].concat();
    for (&index, &number) in states.iter().zip(&first.numbers) {
        if number.is_nan() {
            return Err(format!(
                "line {}: a cell is empty in the first row of trajectory {}, which is its start state",
                first.line, first.trajectory
            ));
        }
        state[index] = number;
    }
    let count = start.coordinates.len();
    mechanism.normalise(&mut state[..count]).map_err(|error| format!("line {}: {error}", first.line))?;
    for (before, row) in rows.iter().zip(&rows[1..]) {
        if row.time <= before.time {
            return Err(format!("line {}: the time {} does not follow {}", row.line, row.time, before.time));
        }
    }
    if rows.len() < 2 {
        return Err(format!(
            "line {}: trajectory {} has one row: give its start and samples",
            first.line, first.trajectory
        ));
    }
    let place = |index: &usize| states.iter().position(|other| other == index).unwrap_or(0);
    let places: Vec<usize> = measured.iter().map(place).collect();
    Ok(Trajectory {
        name: first.trajectory.clone(),
        start: first.time,
        state,
        times: rows[1..].iter().map(|row| row.time).collect(),
        samples: DMatrix::from_fn(rows.len() - 1, places.len(), |row, column| {
            rows[row + 1].numbers[places[column]]
        }),
    })
}
