//! Quantities of many states at once: columns in, columns out.
//!
//! ```text
//! program -> steps on slots (`compile`) -> each step on a block of states (`run`) -> results by rows or by columns
//! ```
//!
//! A slot holds one number of every state of a block and is used again as soon as nobody reads it, so that a block stays in the nearest
//! caches. The steps are loops of fixed length without branches, which compilers turn into vector instructions. The bits of a state's results are
//! those of [`super::Prepared`], whatever states stand beside it and however many there are; a state without result fails alone.

mod compile;
mod lanes;
mod run;
mod table;

use std::ops::Range;

pub use lanes::LANES;
use lanes::Slot;
pub use table::{Column, Table};

use super::Failed;
use crate::program::operation::Value;
use crate::program::{Program, Quantity};

use super::Constants;
use compile::Step;

/// Some quantities of a program, ready to be evaluated at many states at the parameters it was prepared for.
#[derive(Clone, Debug)]
pub struct Columns {
    steps: Vec<Step>,
    /// how many slots the steps need
    slots: usize,
    /// numbers that are the same for all states: which value of the program each is, and the number
    uniforms: Vec<(Value, f64)>,
    /// results that are the same for all states: their place, and which of `uniforms`
    uniform_results: Vec<(usize, u32)>,
    /// how many results a state has
    len: usize,
    /// the guards of the program that are checked, in the order in which they are reported
    guards: Vec<usize>,
}

/// Results of up to [`LANES`] consecutive states.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// the row of the first state
    pub first: usize,
    /// how many states
    pub count: usize,
    results: &'a [Slot],
    failures: &'a [Option<Failed>; LANES],
}

impl<'a> Block<'a> {
    /// A result of all states of the block; of one that fails it has no meaning.
    pub fn column(&self, result: usize) -> &'a [f64] {
        self.results.get(result).and_then(|slot| slot.as_flattened().get(..self.count)).unwrap_or(&[])
    }

    /// Why the states of the block have no results.
    pub fn failures(&self) -> &'a [Option<Failed>] {
        self.failures.get(..self.count).unwrap_or(self.failures)
    }
}

impl Columns {
    /// Prepares those of the quantities that the program has, in this order.
    pub fn new(program: &Program, constants: &Constants, quantities: &[Quantity]) -> Self {
        compile::columns(program, constants, quantities)
    }

    /// Goes over to other parameters.
    pub fn refresh(&mut self, constants: &Constants) {
        for (value, number) in &mut self.uniforms {
            *number = constants.get(*value);
        }
    }

    /// How many results a state has: the quantities one after the other, each by rows.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Are there none, because the program has none of the quantities?
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// How many slots a block needs, of `8 LANES` bytes each.
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// Evaluates the states of these rows; `with` receives them block by block. Rows that the table does not have are left out.
    pub fn for_each_block(&self, table: &Table<'_>, rows: Range<usize>, mut with: impl FnMut(Block<'_>)) {
        let mut scratch = run::Scratch::new(self);
        let end = rows.end.min(table.rows);
        for first in (rows.start..end).step_by(LANES) {
            let count = (end - first).min(LANES);
            self.run(table, first, count, &mut scratch);
            with(Block { first, count, results: &scratch.results, failures: &scratch.failures });
        }
    }

    /// Evaluates the states of these rows into `numbers` (rows x [`Columns::len`], by rows) and `failures` (rows). The numbers of a state that
    /// fails are not numbers.
    pub fn by_rows(
        &self,
        table: &Table<'_>,
        rows: Range<usize>,
        numbers: &mut [f64],
        failures: &mut [Option<Failed>],
    ) {
        let start = rows.start;
        self.for_each_block(table, rows, |block| {
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

    /// Evaluates the states of these rows into one column (rows) for each result, and `failures` (rows). The numbers of a state that fails are
    /// not numbers.
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

#[cfg(test)]
mod tests;
