//! `cargo +nightly fuzz run check --features libfuzzer` in `generator/`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hodograph_fuzz::run(bytes));
