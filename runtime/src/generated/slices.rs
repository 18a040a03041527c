//! Converts between the slices of the trait `Mechanism` and the types of a generated module.

use nalgebra::SMatrix;

use crate::{
    Component, ComponentKind, Scalar, State, StateError,
    mechanism::slices::{check_length, write},
};

/// The names and units of a mechanism, in the order of the model.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    pub name: &'static str,
    pub parameters: &'static [Component<'static>],
    pub coordinates: &'static [Component<'static>],
    /// the numbers of the dependent coordinates
    pub dependent_coordinates: &'static [usize],
    pub speeds: &'static [Component<'static>],
    pub dependent_speeds: &'static [Component<'static>],
    pub inputs: &'static [Component<'static>],
    pub points: &'static [Component<'static>],
    pub frames: &'static [Component<'static>],
    pub contacts: &'static [Component<'static>],
    /// what `Mechanism::quantity` computes
    pub quantities: &'static [Component<'static>],
    /// the numbers of the coordinates of each quaternion
    pub quaternions: &'static [[usize; 4]],
}

impl Description {
    /// The number of components of a kind.
    pub const fn count(&self, kind: ComponentKind) -> usize {
        match kind {
            ComponentKind::DependentCoordinate => self.dependent_coordinates.len(),
            kind => self.list(kind).len(),
        }
    }

    const fn list(&self, kind: ComponentKind) -> &'static [Component<'static>] {
        match kind {
            ComponentKind::Parameter => self.parameters,
            ComponentKind::Coordinate | ComponentKind::DependentCoordinate => self.coordinates,
            ComponentKind::Speed => self.speeds,
            ComponentKind::DependentSpeed => self.dependent_speeds,
            ComponentKind::Input => self.inputs,
            ComponentKind::Point => self.points,
            ComponentKind::Frame => self.frames,
            ComponentKind::Contact => self.contacts,
            ComponentKind::Quantity => self.quantities,
        }
    }

    /// The component of a kind with this number.
    pub fn component(&self, kind: ComponentKind, index: usize) -> Option<Component<'static>> {
        let index = match kind {
            ComponentKind::DependentCoordinate => *self.dependent_coordinates.get(index)?,
            _ => index,
        };
        self.list(kind).get(index).copied()
    }

    /// An error unless the slices of a state have their lengths.
    #[inline]
    pub fn check<T>(&self, state: &State<'_, T>) -> Result<(), StateError> {
        check_length(state.coordinates, self.coordinates.len(), "coordinates")?;
        check_length(state.speeds, self.speeds.len(), "speeds")?;
        check_length(state.inputs, self.inputs.len(), "inputs")
    }

    /// Scales the quaternions among the coordinates to length 1.
    pub fn normalise<T: Scalar>(&self, coordinates: &mut [T]) -> Result<(), StateError> {
        check_length(coordinates, self.coordinates.len(), "coordinates")?;
        normalise_quaternions(coordinates, self.quaternions);
        Ok(())
    }
}

/// Scales quaternions, given by the numbers of their coordinates, to length 1; those of length 0, and those whose
/// length is 1 up to rounding, are not changed: what has been scaled once keeps its bits.
pub fn normalise_quaternions<T: Scalar>(coordinates: &mut [T], quaternions: &[[usize; 4]]) {
    for quaternion in quaternions {
        let parts = quaternion.iter().filter_map(|&index| coordinates.get(index));
        let length = parts.fold(T::zero(), |sum, &part| sum + part * part).sqrt();
        let rounding = T::default_epsilon() + T::default_epsilon();
        if length > T::zero() && (length - T::one()).abs() > rounding {
            for &index in quaternion {
                if let Some(part) = coordinates.get_mut(index) {
                    *part /= length;
                }
            }
        }
    }
}

/// Writes a matrix by rows.
#[inline]
pub fn write_rows<T: Scalar, const R: usize, const C: usize>(
    slice: &mut [T],
    matrix: &SMatrix<T, R, C>,
    what: &'static str,
) -> Result<(), StateError> {
    check_length(slice, R * C, what)?;
    for (row, slice) in matrix.row_iter().zip(slice.chunks_exact_mut(C.max(1))) {
        slice.iter_mut().zip(row.iter()).for_each(|(slot, &number)| *slot = number);
    }
    Ok(())
}

/// Writes numbers into a slice of their length.
#[inline]
pub fn write_array<T: Scalar, const N: usize>(
    slice: &mut [T],
    numbers: impl Into<[T; N]>,
    what: &'static str,
) -> Result<(), StateError> {
    write(slice, &numbers.into(), what)
}

#[cfg(test)]
mod tests {
    use super::normalise_quaternions;

    /// A body at rest keeps every bit of its quaternion, however often its state is looked at.
    #[test]
    fn what_has_length_one_keeps_its_bits() {
        let mut state = 88172645463325252_u64;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for _ in 0..10_000 {
            let mut once: [f64; 4] = core::array::from_fn(|_| random());
            normalise_quaternions(&mut once, &[[0, 1, 2, 3]]);
            let length: f64 = once.iter().map(|part| part * part).sum();
            assert!((length - 1.0).abs() < 1e-15);
            let mut again = once;
            normalise_quaternions(&mut again, &[[0, 1, 2, 3]]);
            assert_eq!(once, again);
        }
        let mut none = [0.0; 4];
        normalise_quaternions(&mut none, &[[0, 1, 2, 3]]);
        assert_eq!(none, [0.0; 4]);
    }
}
