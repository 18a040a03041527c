//! Serialisation of generated structs, where the feature `serde` of this crate is on.

/// Implements serde's traits for a generated struct, or nothing.
#[doc(hidden)]
#[macro_export]
macro_rules! __serialize_record {
    ($($anything:tt)*) => {};
}
