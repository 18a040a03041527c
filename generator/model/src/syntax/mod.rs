//! Parses text to an untyped tree. Parsing never fails: it returns a tree and the mistakes found.

mod entries;
mod expressions;
pub mod lexer;
mod outline;
mod parser;
pub mod repair;
mod sections;
pub mod token;
pub mod tree;
pub mod units;
pub mod visit;

pub use parser::{MAX_DEPTH, parse};
