//! What the programs share: numbers that are told by their bits, random states, and the surroundings: a board or this machine.

#![cfg_attr(target_os = "none", no_std)]

pub mod bits;
pub mod board;
pub mod juggling;
pub mod random;
