//! A crate that uses another's model, and with the feature `absent` has one of its own without a derivation.
#![no_std]
#![deny(warnings, missing_docs)]

pub use cart::cart::Cart;

#[cfg(feature = "absent")]
pub mod parts;
