//! Computer algebra: the only folder that names the engine.

mod expr;
mod intermediates;
mod session;

pub use expr::{Expr, SymbolId, View};
pub use intermediates::{Direction, Export, Intermediates, Meaning, size};
pub use session::{SessionError, exclusively, lock_path};
