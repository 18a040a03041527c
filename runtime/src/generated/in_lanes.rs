//! Several states of a generated module at once, with the feature `lanes`.

/// Implements `from_lanes` and `lane` for a record.
#[cfg(feature = "lanes")]
#[doc(hidden)]
#[macro_export]
macro_rules! __record_in_lanes {
    ($name:ident $count:literal $($field:ident)*) => {
        impl<L: $crate::lanes::Lanes> $name<L> {
            /// Several at once: the one of each lane.
            #[inline]
            #[must_use]
            pub fn from_lanes(mut of: impl ::core::ops::FnMut(usize) -> $name<f64>) -> Self {
                let [$($field),*] = L::gather(|lane| <[f64; $count]>::from(of(lane)));
                Self { $($field),* }
            }

            /// The one of this lane; of the last past it.
            #[inline]
            #[must_use]
            pub fn lane(&self, lane: usize) -> $name<f64> {
                $name { $($field: self.$field.lane(lane)),* }
            }
        }
    };
}

/// Implements `from_lanes` for a mechanism with values that depend on parameters alone, and with parameters or
/// without.
#[cfg(feature = "lanes")]
#[doc(hidden)]
#[macro_export]
macro_rules! __in_lanes {
    ($name:ident $($parameters:ident)?) => {
        impl<L: $crate::lanes::Lanes> $name<L> {
            /// The mechanism at several states at once: one machine for all lanes (`from_lanes(|_| machine)`),
            /// or one for each. Values and derivatives have the bits that they have one by one.
            #[must_use]
            pub fn from_lanes(mut of: impl ::core::ops::FnMut(usize) -> $name<f64>) -> Self {
                Self {
                    $($parameters: Parameters::from_lanes(|lane| of(lane).$parameters),)?
                    hoisted: L::gather(|lane| of(lane).hoisted),
                }
            }
        }
    };
}

/// Nothing without the feature.
#[cfg(not(feature = "lanes"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __record_in_lanes {
    ($($record:tt)*) => {};
}

/// Nothing without the feature.
#[cfg(not(feature = "lanes"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __in_lanes {
    ($($mechanism:tt)*) => {};
}
