//! Emits the module of a mechanism with the methods that the arguments of the macro request, or the mistakes
//! in these arguments.

use proc_macro2::{Span, TokenStream};

use super::arguments::Arguments;
use super::report;
use hodograph_emit::{self as emit, Options};
use hodograph_model::model::mechanism::Mechanism;
use hodograph_program::program::Program;

/// The module of a mechanism whose program `found` finds, or the errors: those about arguments at their
/// places, others at `at`.
pub fn emitted(
    mechanism: &Mechanism,
    arguments: &Arguments,
    at: Span,
    options: &Options,
    found: impl FnOnce() -> Result<Program, String>,
) -> Result<TokenStream, TokenStream> {
    if let Some(errors) = arguments.errors(&[]) {
        return Err(errors);
    }
    let program = found().map_err(|message| report::error(at, at, &message))?;
    if let Some(errors) = arguments.errors(&emit::mistakes(mechanism, &program, &arguments.requests)) {
        return Err(errors);
    }
    emit::module(mechanism, &program, options).map_err(|message| report::error(at, at, &message))
}
