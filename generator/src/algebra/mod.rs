//! Computer algebra: the only folder that names the engine.

mod expr;
mod intermediates;
mod sample;
mod session;

pub use expr::{Expr, SymbolId, View};
pub use intermediates::{Direction, Export, Intermediates, Meaning, size};
pub use sample::Sample;
pub use session::{SessionError, exclusively, lock_path};
