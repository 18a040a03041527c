//! Hodographs as in Fig. 3 of the paper.

pub mod figure;
pub mod trace;
