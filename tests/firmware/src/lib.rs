//! What the programs share: numbers that are told by their bits, random states, and the surroundings: a board
//! or this machine.

#![cfg_attr(target_os = "none", no_std)]

pub mod bits;
pub mod board;
pub mod hard;
pub mod juggling;
pub mod random;

#[doc(hidden)]
pub use hodograph_models as models;

/// Calls a function with a writer, and each shipped mechanism whose feature is on, in numbers of a type.
///
/// The caller imports this macro by its name, because it calls itself.
#[macro_export]
macro_rules! shipped {
    ($call:ident, $number:ty, $output:expr) => {
        $crate::models::every_mechanism!(shipped, @ $call, $number, $output,)
    };
    (@ $call:ident, $number:ty, $output:expr, $($feature:literal $module:ident $type:ident,)*) => {
        $(#[cfg(feature = $feature)]
        $call::<$number>($output, &$crate::models::$module::$type::<$number>::default());)*
    };
}
