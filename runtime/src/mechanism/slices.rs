//! Checked access to the slices of a call.

use crate::StateError;

/// An error unless the slice has this length.
#[inline]
pub fn check_length<T>(slice: &[T], expected: usize, what: &'static str) -> Result<(), StateError> {
    if slice.len() == expected {
        Ok(())
    } else {
        Err(StateError::Length { what, expected, found: slice.len() })
    }
}

/// An error unless the slice has this length or more.
#[inline]
pub fn check_room<T>(slice: &[T], needed: usize, what: &'static str) -> Result<(), StateError> {
    if slice.len() >= needed {
        Ok(())
    } else {
        Err(StateError::Length { what, expected: needed, found: slice.len() })
    }
}

/// The slice as an array; an error if it has another length.
#[inline]
pub fn array<T: Copy, const N: usize>(slice: &[T], what: &'static str) -> Result<[T; N], StateError> {
    <[T; N]>::try_from(slice).map_err(|_| StateError::Length { what, expected: N, found: slice.len() })
}

/// Writes numbers into a slice of their length.
#[inline]
pub fn write<T: Copy>(slice: &mut [T], numbers: &[T], what: &'static str) -> Result<(), StateError> {
    check_length(slice, numbers.len(), what)?;
    slice.copy_from_slice(numbers);
    Ok(())
}
