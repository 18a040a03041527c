//! What an editor asks of the models of the repository, and the grammars that follow from the words.
//!
//! One program holds all of them: `cargo test -p hodograph-language --test all models::`
//! runs those of `tests/models.rs`.

mod models;
mod newcomer;
mod parts;
mod renaming;
mod textmate;
