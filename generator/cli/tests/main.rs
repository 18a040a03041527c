//! The tool as its users call it.
//!
//! One program holds all of them: `cargo test -p hodograph-cli --test all files::`
//! runs those of `tests/files.rs`.

mod accepted;
mod adverse;
mod builds;
mod chains;
mod client;
mod common;
mod contact_laws;
mod contacts;
mod docs;
mod doors;
mod drawn;
mod editor_imports;
#[path = "../../../tests/tests/common/expectations.rs"]
mod expectations;
mod export;
mod files;
mod first_minutes;
mod fit;
mod gradient;
mod import;
mod in_the_compiler;
mod inputs;
mod language_server;
mod mechanisms;
mod motion;
mod neovim;
mod orbit;
mod own_crate;
mod pages;
mod paper;
mod recordings;
mod reference;
mod rolling;
mod serve;
mod sketches;
mod solve;
mod state;
mod stated;
mod structure;
mod tutorial;
mod unusual;
mod validate;
mod writing;
