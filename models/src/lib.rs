//! Ready-made mechanisms.
#![no_std]
