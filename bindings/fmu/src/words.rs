//! Errors in words, after the name of their cause: what importers write to their logs, and programs in C print.

use std::fmt::Display;

use hodograph::{Cause, ParameterError, StateError, UnknownLaw};
use hodograph_simulation::SimulationError;

/// An error that has a stable name.
pub(crate) trait Told: Display {
    /// The name, as `negative_friction`.
    fn name(&self) -> &'static str;

    /// `name: words`.
    fn told(&self) -> String {
        format!("{}: {self}", self.name())
    }
}

macro_rules! told {
    ($($error:ty => $name:expr;)*) => {
        $(impl Told for $error {
            fn name(&self) -> &'static str {
                let name: fn(&Self) -> &'static str = $name;
                name(self)
            }
        })*
    };
}

told! {
    SimulationError => |error| error.kind.name();
    StateError => |error| error.kind();
    ParameterError => |error| error.kind();
    UnknownLaw<'_> => |error| error.kind();
}

/// The words for a number that is not finite.
pub(crate) fn not_finite(what: &str, value: f64) -> String {
    format!("{}: {what} is {value}: it must be finite", Cause::NotFinite.name())
}
