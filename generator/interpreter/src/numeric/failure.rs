//! Errors of the numeric evaluation, as the traits say them.

use hodograph::StateError;
use hodograph_model::numeric::{self, Failure};

/// Why there are no numbers, as the traits say it.
pub fn state_error(failure: Failure) -> StateError {
    let what = match failure {
        numeric::SINGULAR => "the equations of motion have no finite numbers",
        Failure::NotFinite(_) => return StateError::NotFinite,
        Failure::Unsupported(what) => return StateError::Undefined { what },
        Failure::DivisionByZero(_) => "a divisor is zero",
        Failure::RatesUndetermined(_) => "the rates of the coordinates are not determined",
        Failure::MotionInconsistent(..) => "a declared motion contradicts the positions",
        Failure::SpeedsUndetermined(_) => "the constraints do not determine the dependent speeds",
        Failure::ConstraintsInconsistent(_) => "the constraints contradict each other",
        Failure::NotClosed(_) => "the configuration equations have no solution",
        Failure::TooDeep => "names refer to names too deeply",
    };
    StateError::Singular { what }
}
