//! Sweeps of collisions as SQL: DataFusion in the process, or Ballista across machines, with the collisions
//! of mechanisms as SQL functions.
//!
//! `docs/sweeps.md` describes the tool `hodograph-sweep`. The modules of this package, each built on the
//! previous ones: `failure`, `stdout`, `models`, `functions`, `rows`, `codec`, `files`, `keys`, `session`, `cluster`,
//! `output`, `progress`, `parts`, `run`, `short`, `describe`, `arguments`.

pub mod arguments;
pub mod cluster;
mod codec;
pub mod describe;
pub mod failure;
pub mod files;
pub mod functions;
pub mod keys;
pub mod models;
pub mod output;
mod parts;
mod progress;
pub mod rows;
pub mod run;
pub mod session;
pub mod short;
pub mod stdout;
