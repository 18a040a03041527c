//! The commands, one file each.

pub mod check;
pub mod collide;
pub mod completions;
pub mod contacts;
pub mod derive;
pub mod derive_worker;
pub mod eval;
pub mod expand;
pub mod explain;
pub mod export;
pub mod fit;
pub mod fmt;
pub mod gradient;
pub mod import;
pub mod lsp;
mod motion_arguments;
pub mod new;
pub mod orbit;
pub mod plot;
pub mod serve;
pub mod simulate;
pub mod solve;
pub mod validate;
