//! Functions and macros that generated modules call. Only generated code names them; the error types are
//! public.

mod angles;
mod arithmetic;
mod checks;
mod closed;
#[doc(hidden)]
pub mod construction;
mod contact;
mod feature;
mod in_lanes;
mod log;
mod records;
mod saltation;
mod serial;
mod slices;

#[doc(hidden)]
pub use crate::mechanism::slices::{array, check_length, write};
pub use crate::mechanism::{ClosedContactError, CollisionError, ParameterError, StateError};
#[doc(hidden)]
pub use angles::{sines_cosines, sines_cosines_inlined};
#[doc(hidden)]
pub use arithmetic::*;
#[doc(hidden)]
pub use checks::*;
#[doc(hidden)]
pub use closed::{closed_contact, kept_contact, slip_noise};
#[cfg(feature = "lanes")]
pub use contact::resolve_each;
pub use contact::{
    Contact, Resolved, along_axes, along_slip, contact_axes, resolve, resolve_inlined, resolve_structured,
    resolve_structured_inlined, resolve_without_collision,
};
#[doc(hidden)]
pub use feature::Feature;
#[doc(hidden)]
pub use saltation::{by_coordinate, by_coordinates, reset, salted, state};
#[doc(hidden)]
pub use slices::{Description, normalise_quaternions, write_array, write_rows};

#[doc(hidden)]
pub use crate::specialised::{AnyLaw, KnownLaw, OneLaw, solve_inlined};

#[cfg(feature = "defmt")]
#[doc(hidden)]
pub use defmt;
#[cfg(feature = "serde")]
#[doc(hidden)]
pub use serde;
#[cfg(feature = "serde")]
#[doc(hidden)]
pub use serial::{FieldIndex, FieldNames};

#[doc(hidden)]
pub use crate::{
    __in_lanes as in_lanes, __log as log, __record as record, __record_in_lanes as record_in_lanes,
    __serialize_outcome as serialize_outcome, __serialize_record as serialize_record,
};

/// Generated code names this constant, so that a module made by a generator of another version does not
/// compile with this runtime.
#[doc(hidden)]
pub const GENERATED_CODE_FORMAT_7: () = ();
