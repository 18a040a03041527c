//! The states of a batch: a column of numbers for each input of the program.

use super::lanes::{LANES, Slot};
use crate::program::graph::Input;

/// A borrowed column of numbers: that of row `i` is at `i * stride`.
#[derive(Clone, Copy, Debug)]
pub struct Column<'a> {
    numbers: &'a [f64],
    stride: usize,
}

impl<'a> Column<'a> {
    /// Numbers one after the other.
    pub fn new(numbers: &'a [f64]) -> Self {
        Column { numbers, stride: 1 }
    }

    /// Every `stride`-th of the numbers, for a column of a matrix stored by rows. With the stride 0 all rows
    /// have the first number.
    pub fn strided(numbers: &'a [f64], stride: usize) -> Self {
        Column { numbers, stride }
    }

    /// The columns of a matrix that is stored by rows.
    pub fn of_rows(matrix: &'a [f64], columns: usize) -> Vec<Self> {
        (0..columns).map(|column| Column::strided(matrix.get(column..).unwrap_or(&[]), columns)).collect()
    }

    /// The number in a row; NaN if there is none.
    pub fn get(&self, row: usize) -> f64 {
        self.numbers.get(row * self.stride).copied().unwrap_or(f64::NAN)
    }

    /// Copies the numbers of a block. The last number fills the remaining lanes.
    #[inline]
    pub(super) fn gather(&self, first: usize, count: usize, slot: &mut Slot) {
        let slot = slot.0.as_flattened_mut();
        match self.numbers.get(first..first + LANES) {
            Some(numbers) if self.stride == 1 && count == LANES => slot.copy_from_slice(numbers),
            _ => {
                for (lane, place) in slot.iter_mut().enumerate() {
                    *place = self.get(first + lane.min(count - 1));
                }
            }
        }
    }
}

/// Inputs for many states, in file order and in the units that the model declares. Missing columns read as
/// NaN.
#[derive(Clone, Debug, Default)]
pub struct Table<'a> {
    /// how many states
    pub rows: usize,
    /// time in s; `None` means 0
    pub time: Option<Column<'a>>,
    /// coordinates
    pub coordinates: Vec<Column<'a>>,
    /// independent speeds
    pub speeds: Vec<Column<'a>>,
    /// named inputs
    pub inputs: Vec<Column<'a>>,
    /// rates of the independent speeds
    pub accelerations: Vec<Column<'a>>,
    /// direction of a linearisation
    pub tangent: Vec<Column<'a>>,
}

impl Table<'_> {
    pub(super) fn gather(&self, input: Input, first: usize, count: usize, slot: &mut Slot) {
        let (list, index) = match input {
            Input::Time => {
                match &self.time {
                    Some(time) => time.gather(first, count, slot),
                    None => *slot = Slot::of(0.0),
                }
                return;
            }
            Input::Parameter(_) => (&Vec::new(), 0),
            Input::Coordinate(index) => (&self.coordinates, index),
            Input::Speed(index) => (&self.speeds, index),
            Input::Input(index) => (&self.inputs, index),
            Input::Acceleration(index) => (&self.accelerations, index),
            Input::Tangent(index) => (&self.tangent, index),
        };
        match list.get(index as usize) {
            Some(column) => column.gather(first, count, slot),
            None => *slot = Slot::of(f64::NAN),
        }
    }
}
