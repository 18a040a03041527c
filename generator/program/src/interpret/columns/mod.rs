//! Quantities of many states at once: columns in, columns out.
//!
//! ```text
//! program -> steps (`compile`) -> sums joined (`chains`) -> slots (`slots`)
//!     -> each step on a block of states (`run`) -> results by rows or by columns
//! ```
//!
//! A slot holds one number of every state of a block and is used again as soon as nobody reads it, so that a
//! block stays in a core's own caches. The steps are loops over groups of eight states without branches, which
//! compilers turn into vector instructions, of which the widest that the processor has are taken. Steps with the
//! same operation that follow each other are one run: what they do is found out once. Sums of products whose parts nobody
//! else reads are one step, and stay in registers. The bits of a state's
//! results are those of [`super::Prepared`], whatever states stand beside it, however many there are and whatever
//! instructions compute them; a state without result fails alone.

mod batch;
mod chains;
mod compile;
mod lanes;
mod run;
mod slots;
mod steps;
mod table;

pub use batch::Block;
pub use compile::Columns;
pub use lanes::LANES;
pub use run::Scratch;
pub use table::{Column, Table};

#[cfg(test)]
mod tests;
