//! A model in a file.
#![no_std]
#![deny(warnings, missing_docs)]

hodograph::mechanism!("models/cart.mech");
