//! Evaluates all rows of a table, block by block, and writes the results by rows or by columns.

use std::ops::Range;

use super::compile::Columns;
use super::lanes::{LANES, Slot};
use super::run::{Scratch, Task};
use super::table::Table;
use crate::interpret::prepared::Failed;

/// Results of up to [`LANES`] consecutive states.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// the row of the first state
    pub first: usize,
    /// number of states
    pub count: usize,
    results: &'a [Slot],
    failures: &'a [Option<Failed>; LANES],
}

impl<'a> Block<'a> {
    /// A result for all states of the block. Entries of states that fail have no meaning.
    pub fn column(&self, result: usize) -> &'a [f64] {
        self.results.get(result).and_then(|slot| slot.0.as_flattened().get(..self.count)).unwrap_or(&[])
    }

    /// For each state of the block, why it has no results.
    pub fn failures(&self) -> &'a [Option<Failed>] {
        self.failures.get(..self.count).unwrap_or(self.failures)
    }
}

impl Columns {
    /// Evaluates the states of these rows and passes the results to `with`, block by block. Rows beyond the
    /// table are ignored.
    pub fn for_each_block(&self, table: &Table<'_>, rows: Range<usize>, with: impl FnMut(Block<'_>)) {
        self.for_each_block_in(&mut self.work_space(), table, rows, with);
    }

    /// What an evaluation needs; it can be used again with the same columns and parameters.
    pub fn work_space(&self) -> Scratch {
        Scratch::new(self)
    }

    fn for_each_block_in(
        &self,
        scratch: &mut Scratch,
        table: &Table<'_>,
        rows: Range<usize>,
        mut with: impl FnMut(Block<'_>),
    ) {
        let end = rows.end.min(table.rows);
        for first in (rows.start..end).step_by(LANES) {
            let count = (end - first).min(LANES);
            Task { columns: self, table, first, count, scratch: &mut *scratch }.run();
            with(Block { first, count, results: &scratch.results, failures: &scratch.failures });
        }
    }

    /// Evaluates the states of these rows into `numbers` (rows x [`Columns::len`], by rows) and `failures`
    /// (rows). The results of a state that fails are NaN.
    pub fn by_rows(
        &self,
        table: &Table<'_>,
        rows: Range<usize>,
        numbers: &mut [f64],
        failures: &mut [Option<Failed>],
    ) {
        self.by_rows_in(&mut self.work_space(), table, rows, (numbers, failures));
    }

    /// [`Self::by_rows`] in a work space of these columns.
    pub fn by_rows_in(
        &self,
        scratch: &mut Scratch,
        table: &Table<'_>,
        rows: Range<usize>,
        (numbers, failures): (&mut [f64], &mut [Option<Failed>]),
    ) {
        let start = rows.start;
        self.for_each_block_in(scratch, table, rows, |block| {
            let at = block.first - start;
            let from = numbers.get_mut(at * self.len..(at + block.count) * self.len).unwrap_or(&mut []);
            for result in 0..self.len {
                let places = from.iter_mut().skip(result).step_by(self.len);
                places.zip(block.column(result)).for_each(|(place, &number)| *place = number);
            }
            let reasons = failures.iter_mut().skip(at).zip(block.failures());
            for (lane, (failure, reason)) in reasons.enumerate() {
                *failure = *reason;
                if reason.is_some() {
                    let row = from.iter_mut().skip(lane * self.len).take(self.len);
                    row.for_each(|place| *place = f64::NAN);
                }
            }
        });
    }

    /// Evaluates the states of these rows into one column (rows) for each result, and `failures` (rows). The
    /// results of a state that fails are NaN.
    pub fn by_columns(
        &self,
        table: &Table<'_>,
        rows: Range<usize>,
        columns: &mut [&mut [f64]],
        failures: &mut [Option<Failed>],
    ) {
        let start = rows.start;
        self.for_each_block(table, rows, |block| {
            let at = block.first - start;
            for (result, column) in columns.iter_mut().enumerate() {
                let places = column.iter_mut().skip(at).zip(block.column(result)).zip(block.failures());
                for ((place, &number), failure) in places {
                    *place = if failure.is_some() { f64::NAN } else { number };
                }
            }
            let reasons = failures.iter_mut().skip(at).zip(block.failures());
            reasons.for_each(|(failure, reason)| *failure = *reason);
        });
    }
}
