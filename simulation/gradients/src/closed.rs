//! Start states with closed contacts: coordinates and their derivatives are changed as little as possible, so that
//! contacts stay closed.
//!
//! Theory: docs/theory.md, section 20.1.

use hodograph::{ComponentKind, Contacts, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{ContactPhase, Simulation};
use nalgebra::DMatrix;

use crate::Reason;
use crate::field::{At, Field};
use crate::gaps::{gaps, least};

/// A contact is meant to be closed if its gap is this part of the greatest coordinate at most.
const CLOSED: f64 = 1e-6;
/// Largest number of Newton steps.
const STEPS: usize = 8;

/// The contacts that are closed in a start state, or meant to be.
#[derive(Clone, Debug)]
pub(crate) struct Closed {
    /// all of them
    contacts: Vec<usize>,
    /// those that do not separate, and the number of components of their velocities that vanish: 1 along the normal, 3 if
    /// they do not slip
    held: Vec<(usize, usize)>,
}

impl Closed {
    /// The contacts of a start state that is given by hand.
    pub fn new(mechanism: &InterpretedMechanism, start: &State<'_>) -> Self {
        let size = |numbers: &[f64]| numbers.iter().fold(1e-3_f64, |size, value| size.max(value.abs()));
        let (far, fast) = (CLOSED * size(start.coordinates), CLOSED * size(start.speeds));
        let mut closed = Closed { contacts: Vec::new(), held: Vec::new() };
        for contact in 0..mechanism.count(ComponentKind::Contact) {
            if !matches!(mechanism.gap(contact, start), Ok(Some(gap)) if gap.abs() <= far) {
                continue;
            }
            closed.contacts.push(contact);
            let Ok(state) = mechanism.contact_state(contact, start) else { continue };
            if state.velocity.x.abs() <= fast {
                let sticks = state.velocity.amax() <= fast;
                closed.held.push((contact, if sticks { 3 } else { 1 }));
            }
        }
        closed
    }

    /// The contacts that are closed in a motion now.
    pub fn of(simulation: &Simulation<'_>) -> Self {
        let mut closed = Closed { contacts: Vec::new(), held: Vec::new() };
        for contact in 0..simulation.mechanism().count(ComponentKind::Contact) {
            let axes = match simulation.phase(contact) {
                Some(ContactPhase::Stick) => 3,
                Some(ContactPhase::Slide) => 1,
                _ => continue,
            };
            closed.contacts.push(contact);
            closed.held.push((contact, axes));
        }
        closed
    }

    /// Moves coordinates so that the contacts are closed, and speeds by the least kinetic energy so that those which are
    /// held keep still.
    pub fn close(
        &self,
        mechanism: &InterpretedMechanism,
        start: &State<'_>,
        state: &mut [f64],
    ) -> Result<(), Reason> {
        let (coordinates, speeds) = state.split_at_mut(start.coordinates.len());
        close(mechanism, &self.contacts, coordinates, &State { speeds, ..*start })?;
        // Twice: what the first projection leaves is rounding of its change, which may be large.
        for _ in 0..2 {
            self.hold(mechanism, &State { coordinates, ..*start }, speeds)?;
        }
        Ok(())
    }

    fn hold(
        &self,
        mechanism: &InterpretedMechanism,
        start: &State<'_>,
        speeds: &mut [f64],
    ) -> Result<(), Reason> {
        if self.held.is_empty() {
            return Ok(());
        }
        let field = Field::new(mechanism, Vec::new(), Vec::new(), None);
        let state = [start.coordinates, speeds].concat();
        let by = vec![0.0; state.len()];
        let at = At { time: start.time, state: &state, by: &by, time_by: &[], inputs: start.inputs, row: 0 };
        let contacts: Vec<usize> = self.held.iter().map(|(contact, _)| *contact).collect();
        let terms = field.contact_terms(&contacts, &at).map_err(Reason::State)?;
        let rows: Vec<(usize, usize)> = self
            .held
            .iter()
            .enumerate()
            .flat_map(|(place, (_, axes))| (0..*axes).map(move |axis| (place, axis)))
            .collect();
        let p = speeds.len();
        let response = |row: usize, speed| terms.value(terms.response(rows[row].0, rows[row].1, speed));
        let matrix = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
            let partial = |speed| terms.value(terms.partial(rows[i].0, rows[i].1, speed));
            (0..p).map(|speed| partial(speed) * response(j, speed)).sum()
        });
        let velocity =
            DMatrix::from_fn(rows.len(), 1, |i, _| terms.value(terms.velocity(rows[i].0, rows[i].1)));
        let impulse = least(&matrix, &velocity).ok_or(Reason::ForcesNotUnique)?;
        for (speed, value) in speeds.iter_mut().enumerate() {
            *value -= (0..rows.len()).map(|row| response(row, speed) * impulse[row]).sum::<f64>();
        }
        Ok(())
    }
}

/// Moves coordinates so that these contacts are closed.
fn close(
    mechanism: &InterpretedMechanism,
    contacts: &[usize],
    coordinates: &mut [f64],
    start: &State<'_>,
) -> Result<(), Reason> {
    if contacts.is_empty() {
        return Ok(());
    }
    let mut before = f64::INFINITY;
    for _ in 0..STEPS {
        let (values, by) = gaps(mechanism, contacts, &State { coordinates, ..*start })?;
        let left = values.amax();
        if left == 0.0 || left >= 0.5 * before {
            break;
        }
        before = left;
        let Some(change) = least(&by, &DMatrix::from_column_slice(values.len(), 1, values.as_slice())) else {
            break;
        };
        coordinates.iter_mut().zip(change.iter()).for_each(|(value, change)| *value -= change);
    }
    Ok(())
}

/// Projects derivatives of the coordinates (n rows of `k` columns) so that these contacts stay closed.
pub(crate) fn project(
    mechanism: &InterpretedMechanism,
    contacts: &[usize],
    state: &State<'_>,
    by: &mut [f64],
    k: usize,
) -> Result<(), Reason> {
    if contacts.is_empty() {
        return Ok(());
    }
    let n = state.coordinates.len();
    let (_, gradient) = gaps(mechanism, contacts, state)?;
    let columns = DMatrix::from_row_slice(n, k, &by[..n * k]);
    let change = least(&gradient, &(&gradient * &columns)).ok_or(Reason::ForcesNotUnique)?;
    for (row, numbers) in by[..n * k].chunks_exact_mut(k).enumerate() {
        numbers.iter_mut().enumerate().for_each(|(column, by)| *by -= change[(row, column)]);
    }
    Ok(())
}
