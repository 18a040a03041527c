//! Impact with friction in three dimensions.
#![no_std]
#[cfg(feature = "std")]
extern crate std;
