//! Many states at once: quantities of a mechanism, its collisions, and collisions by themselves, row by row.
//! A row without an answer has its error and does not touch the others; the bits are those of the same call
//! for one state.

use std::ops::Range;

use hodograph::nalgebra::Vector3;
use hodograph::{
    CollisionError, CollisionOutcome, ComponentKind, Impact, ImpactError, Mechanism, ReducedMatrix,
    StateError, Surface,
};
use hodograph_program::interpret::columns::LANES;
pub use hodograph_program::interpret::{Column, Columns, Failed, Table};
use hodograph_program::program::Quantity;

use crate::InterpretedMechanism;
use crate::contacts::{COLLISION_NEEDS, NO_COLLISION};
use crate::routines::{OfContact, Request};

/// So many rows are one task for a core.
const TASK: usize = 11 * LANES;

/// So many collisions are solved together.
const TOGETHER: usize = 8 * LANES;

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
        tasks.enumerate().for_each_init(
            || columns.work_space(),
            |scratch, (task, rows)| {
                columns.by_rows_in(scratch, table, task * TASK..(task + 1) * TASK, rows);
            },
        );
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
        for start in rows.clone().step_by(TOGETHER) {
            self.solve_together(
                table,
                surface,
                start..(start + TOGETHER).min(rows.end).min(table.rows),
                with,
            );
        }
    }

    /// [`Self::solve`] for so few rows that what is known of all of them stays near the core.
    fn solve_together(
        &self,
        table: &Table<'_>,
        surface: &dyn Fn(usize) -> Surface<f64>,
        rows: Range<usize>,
        with: &mut dyn FnMut(usize, RowOutcome<'_>),
    ) {
        let (mechanism, contact, width) = (&self.mechanism, self.contact, self.columns.len());
        let mut numbers = vec![0.0; rows.len() * width];
        let mut failures = vec![None; rows.len()];
        self.columns.by_rows(table, rows.clone(), &mut numbers, &mut failures);
        let regular: Vec<usize> =
            (0..rows.len()).filter(|&place| failures.get(place).is_some_and(Option::is_none)).collect();
        let numbers_of = |place: usize| numbers.get(place * width..(place + 1) * width).unwrap_or(&[]);
        let known =
            |&place: &usize| (mechanism.known(contact, numbers_of(place)), surface(rows.start + place));
        let collisions: Vec<_> = regular.iter().map(known).collect();
        let mut hits: Vec<Option<_>> = vec![None; collisions.len()];
        mechanism.resolve_each(contact, &collisions, |place, hit| {
            hits.get_mut(place).into_iter().for_each(|slot| *slot = Some(hit));
        });
        let freedom = Mechanism::count(mechanism, ComponentKind::Speed);
        let mut speeds = vec![0.0; freedom];
        let mut solved = collisions.iter().zip(hits);
        for (place, (row, failure)) in rows.clone().zip(failures).enumerate() {
            if let Some(failed) = failure {
                with(row, Err(mechanism.state_error(failed).into()));
                continue;
            }
            match solved.next() {
                Some(((known, _), Some(Ok(hit)))) => {
                    let before = (0..freedom)
                        .map(|speed| table.speeds.get(speed).map_or(f64::NAN, |column| column.get(row)));
                    speeds.iter_mut().zip(before).for_each(|(speed, before)| *speed = before);
                    let outcome = mechanism.told(contact, numbers_of(place), &mut speeds, known, hit);
                    with(row, Ok((outcome, &speeds)));
                }
                Some((_, Some(Err(error)))) => with(row, Err(error.into())),
                _ => {}
            }
        }
    }
}

/// Collisions by themselves: a column for each number of the input of [`hodograph::solve`].
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
        let collision = |row: usize| {
            let matrix = ReducedMatrix::from(self.matrix.map(|column| column.get(row)));
            let velocity = Vector3::from(self.velocity.map(|column| column.get(row)));
            (matrix, velocity, surface(row))
        };
        #[cfg(feature = "lanes")]
        for start in rows.clone().step_by(TOGETHER) {
            let rows = start..(start + TOGETHER).min(rows.end);
            let mut answers: Vec<Option<_>> = vec![None; rows.len()];
            hodograph::lanes::solve_each(rows.clone().map(collision), |place, answer| {
                answers.get_mut(place).into_iter().for_each(|slot| *slot = Some(answer));
            });
            rows.zip(answers.into_iter().flatten()).for_each(|(row, answer)| with(row, answer));
        }
        #[cfg(not(feature = "lanes"))]
        for row in rows {
            let (matrix, velocity, surface) = collision(row);
            with(row, hodograph::solve(&matrix, &velocity, &surface));
        }
    }
}
