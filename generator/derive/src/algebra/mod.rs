//! Computer algebra. Only this folder uses the algebra engine.

mod export;
mod expr;
mod intermediates;
mod sample;
mod session;

pub use export::Export;
pub use expr::{Expr, SymbolId, View};
pub use intermediates::{Direction, Intermediates, Meaning, size};
pub use sample::Sample;
pub use session::{SessionError, exclusively, lock_path};
