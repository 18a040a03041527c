//! Checks of generated routines: singular states, numbers that are not finite, impossible parameters, lengths
//! of slices.

use hodograph_arithmetic::POSSIBLE_INERTIA;

use super::{mul_add, number};
use crate::scalar::larger;
use crate::{Number, ParameterError, Scalar, StateError};

/// Whether a value counts as zero relative to its scale, or one of the two is NaN; of several values: one.
#[inline(always)]
pub fn vanishes_beside<T: Number>(value: T, scale: T) -> bool {
    value.vanishes_beside(scale)
}

/// Whether a value is zero or NaN; of several values: one.
#[inline(always)]
pub fn vanishes<T: Number>(value: T) -> bool {
    value.vanishes()
}

/// The error of a state in which `value` counts as zero relative to `scale`.
#[cold]
#[inline(never)]
pub fn singular<T: Number>(value: T, scale: T, what: &'static str) -> StateError {
    value.singular(scale, what)
}

/// Whether all values are finite, by one operation each and without branches.
///
/// From `MANY` values on there are four sums: in one each operation waits for the one before, which takes
/// longer than all else in a mass matrix.
#[inline(always)]
pub fn all_finite<T: Number, const N: usize>(values: [T; N]) -> bool {
    /// Fewer values cost more instructions in four sums than they save time.
    const MANY: usize = 16;
    if N < MANY {
        let sum = values.iter().fold(T::zero(), |sum, &value| mul_add(value, T::zero(), sum));
        return sum == T::zero();
    }
    let mut sums = [T::zero(); 4];
    let mut fours = values.chunks_exact(4);
    for four in fours.by_ref() {
        for (sum, &value) in sums.iter_mut().zip(four) {
            *sum = mul_add(value, T::zero(), *sum);
        }
    }
    for (sum, &value) in sums.iter_mut().zip(fours.remainder()) {
        *sum = mul_add(value, T::zero(), *sum);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) == T::zero()
}

/// Whether all values of a table are finite, likewise. Its rows are long: there are sixteen sums, since in
/// fewer each would wait for the one before.
#[inline(always)]
pub fn all_rows_finite<T: Number, const WIDTH: usize, const ROWS: usize>(rows: &[[T; WIDTH]; ROWS]) -> bool {
    let mut sums = [T::zero(); 16];
    let mut sixteens = rows.as_flattened().chunks_exact(16);
    for sixteen in sixteens.by_ref() {
        for (sum, &value) in sums.iter_mut().zip(sixteen) {
            *sum = mul_add(value, T::zero(), *sum);
        }
    }
    for (sum, &value) in sums.iter_mut().zip(sixteens.remainder()) {
        *sum = mul_add(value, T::zero(), *sum);
    }
    all_finite(sums)
}

/// Checks a mass.
#[inline]
pub fn check_mass<T: Scalar>(mass: T, body: &'static str) -> Result<(), ParameterError> {
    if !mass.is_finite() {
        Err(ParameterError::NotFinite { name: body })
    } else if mass <= T::zero() {
        Err(ParameterError::Mass { body })
    } else {
        Ok(())
    }
}

/// Checks a dimension of a shape, m.
#[inline(never)]
pub fn check_size<T: Scalar>(
    size: T,
    shape: &'static str,
    dimension: &'static str,
) -> Result<(), ParameterError> {
    if !size.is_finite() {
        Err(ParameterError::NotFinite { name: shape })
    } else if size <= T::zero() {
        Err(ParameterError::Size { shape, dimension })
    } else {
        Ok(())
    }
}

/// Checks an inertia matrix with components xx, yy, zz, xy, yz, zx about the mass centre: it must be one of a
/// body, that is `S = (trace / 2) 1 - I`, the second moment of its mass, must be positive semidefinite (up to
/// rounding). The diagonal of S is a, b, c, its other entries are the opposites of xy, yz, zx.
#[inline(never)]
pub fn check_inertia<T: Scalar>(components: [T; 6], body: &'static str) -> Result<(), ParameterError> {
    if !all_finite(components) {
        return Err(ParameterError::NotFinite { name: body });
    }
    let greatest = components.iter().fold(T::zero(), |most, part| larger(most, part.abs()));
    if greatest.is_zero() {
        return Ok(());
    }
    // Products of three of them are numbers then.
    let [xx, yy, zz, xy, yz, zx] = components.map(|part| part / greatest);
    let half = (xx + yy + zz) * number(0.5);
    let size = xx.abs() + yy.abs() + zz.abs() + xy.abs() + yz.abs() + zx.abs();
    let small = size * larger(T::default_epsilon() * number(64.0), number(POSSIBLE_INERTIA));
    let (a, b, c) = (half - xx, half - yy, half - zz);
    let diagonal = a >= -small && b >= -small && c >= -small;
    let minors = a * b - xy * xy >= -small * size
        && b * c - yz * yz >= -small * size
        && a * c - zx * zx >= -small * size;
    let determinant = a * (b * c - yz * yz) - xy * (xy * c + yz * zx) - zx * (xy * yz + b * zx);
    if diagonal && minors && determinant >= -small * size * size {
        Ok(())
    } else {
        Err(ParameterError::Inertia { body })
    }
}
