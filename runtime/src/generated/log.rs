//! Implements `defmt::Format` for generated structs where the feature `defmt` is on, and nothing otherwise.
//!
//! defmt's macros name the crate `defmt`, which a user's crate need not have: they find the runtime's. Their
//! format string must be one literal, which the generator writes.

/// Implements `Format` for a generated struct, or nothing.
#[cfg(not(feature = "defmt"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __log {
    ($($anything:tt)*) => {};
}

/// Implements `Format` for a generated struct, or nothing.
#[cfg(feature = "defmt")]
#[doc(hidden)]
#[macro_export]
macro_rules! __log {
    ($name:ident $format:tt $($field:ident)*) => {
        impl<T: $crate::Scalar + $crate::generated::defmt::Format> $crate::generated::defmt::Format for $name<T> {
            fn format(&self, out: $crate::generated::defmt::Formatter<'_>) {
                use $crate::generated::defmt;
                defmt::write!(out, $format, $(self.$field),*);
            }
        }
    };
}
