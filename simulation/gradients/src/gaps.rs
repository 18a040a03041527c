//! The gaps of contacts with their derivatives by the coordinates, and the least change of coordinates that changes them.

use hodograph::State;
use hodograph_interpreter::InterpretedMechanism;
use nalgebra::{DMatrix, DVector};

use crate::Reason;
use crate::field::{At, Field};

/// Singular values below this part of the greatest count as zero.
const SINGULAR: f64 = 1e-9;

/// The gaps of these contacts, and their derivatives by the coordinates (a row each).
pub(crate) fn gaps(
    mechanism: &InterpretedMechanism,
    contacts: &[usize],
    state: &State<'_>,
) -> Result<(DVector<f64>, DMatrix<f64>), Reason> {
    let n = state.coordinates.len();
    let field = Field::new(mechanism, vec![Vec::new(); n], Vec::new(), None);
    let all = [state.coordinates, state.speeds].concat();
    let mut identity = vec![0.0; all.len() * field.k];
    (0..n).for_each(|index| identity[index * field.k + index] = 1.0);
    let at = At { time: state.time, state: &all, by: &identity, time_by: &[], inputs: state.inputs, row: 0 };
    let (mut values, mut by) = (DVector::zeros(contacts.len()), DMatrix::zeros(contacts.len(), n));
    for (row, &contact) in contacts.iter().enumerate() {
        let (gap, own) = field.gap(contact, &at).map_err(Reason::State)?;
        values[row] = gap;
        by.row_mut(row).copy_from_slice(&own[..n]);
    }
    Ok((values, by))
}

/// The least change of coordinates that changes the gaps by these amounts.
pub(crate) fn least(by: &DMatrix<f64>, change: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let decomposed = by.clone().svd(true, true);
    let least = SINGULAR * decomposed.singular_values.max();
    decomposed.solve(change, least).ok()
}
