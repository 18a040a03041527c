//! Many states at once: quantities of a mechanism, its collisions, and collisions by themselves, row by row.
//! A row without an answer has its error and does not touch the others; the bits are those of the same call
//! for one state.

use std::ops::Range;

use hodograph::nalgebra::Vector3;
use hodograph::{
    CollisionError, CollisionOutcome, ComponentKind, Impact, ImpactError, Mechanism, ReducedMatrix,
    StateError, Surface, solve,
};
use hodograph_program::interpret::columns::LANES;
pub use hodograph_program::interpret::{Column, Columns, Failed, Table};
use hodograph_program::program::Quantity;

use crate::InterpretedMechanism;
use crate::contacts::{COLLISION_NEEDS, NO_COLLISION};
use crate::routines::{OfContact, Request};

/// So many rows are one task for a core.
const TASK: usize = 16 * LANES;

/// Calls `f` with ranges that make up `0..rows`, on all cores where the feature `parallel` is on; the answers
/// come in the order of the rows. The ranges, and so the bits of what is computed in each, do not depend on
/// the number of cores.
pub fn over_rows<R: Send>(rows: usize, f: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    let range = |task: usize| task * TASK..((task + 1) * TASK).min(rows);
    let tasks = rows.div_ceil(TASK);
    #[cfg(feature = "parallel")]
    if tasks > 1 {
        use rayon::iter::{IntoParallelIterator, ParallelIterator};
        return (0..tasks).into_par_iter().map(|task| f(range(task))).collect();
    }
    (0..tasks).map(|task| f(range(task))).collect()
}

/// Evaluates all states of a table into `numbers` (rows x [`Columns::len`], by rows) and `failures` (rows),
/// on all cores where the feature `parallel` is on. The numbers of a state that fails are not numbers. Rows
/// for which there is no room are left out.
pub fn evaluate_rows(
    columns: &Columns,
    table: &Table<'_>,
    numbers: &mut [f64],
    failures: &mut [Option<Failed>],
) {
    #[cfg(feature = "parallel")]
    if table.rows > TASK && !columns.is_empty() {
        use rayon::iter::{IndexedParallelIterator, ParallelIterator};
        use rayon::slice::ParallelSliceMut;
        let tasks = numbers.par_chunks_mut(TASK * columns.len()).zip(failures.par_chunks_mut(TASK));
        tasks.enumerate().for_each(|(task, (numbers, failures))| {
            columns.by_rows(table, task * TASK..(task + 1) * TASK, numbers, failures);
        });
        return;
    }
    columns.by_rows(table, 0..table.rows, numbers, failures);
}

/// A collision of a mechanism, and the independent speeds after it (as many as the mechanism has).
pub type RowOutcome<'a> = Result<(CollisionOutcome<f64>, &'a [f64]), CollisionError<f64>>;

/// A routine of the collisions of a contact at many states, for the parameters it was prepared for.
#[derive(Clone, Debug)]
pub struct Collisions {
    mechanism: InterpretedMechanism,
    contact: usize,
    columns: Columns,
}

impl InterpretedMechanism {
    /// Prepares quantities for many states, at the mechanism's parameters; those that it has not are left
    /// out.
    pub fn columns(&self, quantities: &[Quantity]) -> Columns {
        Columns::new(&self.program, &self.constants, quantities)
    }

    /// The error of a state that [`Columns`] gives a row.
    pub fn state_error(&self, failed: Failed) -> StateError {
        self.error_of_state(failed)
    }

    /// Prepares the collisions of a contact for many states.
    ///
    /// # Errors
    ///
    /// [`StateError::Missing`] where there is no contact of this number, [`StateError::Undefined`] where it
    /// has no collision.
    pub fn collisions(&self, contact: usize) -> Result<Collisions, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        if COLLISION_NEEDS.iter().any(|&quantity| self.size(contact, quantity) == 0) {
            return Err(StateError::Undefined { what: NO_COLLISION });
        }
        let columns = self.columns(&Request::Contact(contact, OfContact::Collision).quantities());
        Ok(Collisions { mechanism: self.clone(), contact, columns })
    }
}

impl Collisions {
    /// Solves the collisions of the states of these rows, each on the surface of its row; `with` receives the
    /// row and the answer, in order.
    ///
    /// The functions are no generic ones, so that all of this is compiled in this crate, however the caller's
    /// is compiled.
    pub fn solve(
        &self,
        table: &Table<'_>,
        surface: &dyn Fn(usize) -> Surface<f64>,
        rows: Range<usize>,
        with: &mut dyn FnMut(usize, RowOutcome<'_>),
    ) {
        let mechanism = &self.mechanism;
        let mut numbers = vec![0.0; self.columns.len()];
        let freedom = Mechanism::count(mechanism, ComponentKind::Speed);
        let mut speeds = vec![0.0; freedom];
        self.columns.for_each_block(table, rows, |block| {
            let results: Vec<&[f64]> = (0..self.columns.len()).map(|result| block.column(result)).collect();
            for (lane, failure) in block.failures().iter().enumerate() {
                let row = block.first + lane;
                if let Some(failed) = failure {
                    with(row, Err(mechanism.state_error(*failed).into()));
                    continue;
                }
                for (number, results) in numbers.iter_mut().zip(&results) {
                    *number = results[lane];
                }
                let before = (0..freedom)
                    .map(|speed| table.speeds.get(speed).map_or(f64::NAN, |column| column.get(row)));
                speeds.iter_mut().zip(before).for_each(|(speed, before)| *speed = before);
                match mechanism.struck_by_numbers(self.contact, &numbers, &surface(row), &mut speeds) {
                    Ok(outcome) => with(row, Ok((outcome, &speeds))),
                    Err(error) => with(row, Err(error.into())),
                }
            }
        });
    }
}

/// Collisions by themselves: a column for each number of the input of [`solve`].
#[derive(Clone, Copy, Debug)]
pub struct Impacts<'a> {
    /// reduced matrix nn, nt, ns, tt, ts, ss, 1/kg
    pub matrix: [Column<'a>; 6],
    /// velocity of approach along n, t, s, m/s
    pub velocity: [Column<'a>; 3],
}

impl Impacts<'_> {
    /// Solves the collisions of these rows, each on the surface of its row; `with` receives the row and the
    /// answer, in order.
    pub fn solve(
        &self,
        surface: &dyn Fn(usize) -> Surface<f64>,
        rows: Range<usize>,
        with: &mut dyn FnMut(usize, Result<Impact<f64>, ImpactError<f64>>),
    ) {
        for row in rows {
            let matrix = ReducedMatrix::from(self.matrix.map(|column| column.get(row)));
            let velocity = Vector3::from(self.velocity.map(|column| column.get(row)));
            with(row, solve(&matrix, &velocity, &surface(row)));
        }
    }
}
