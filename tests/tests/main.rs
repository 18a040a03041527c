//! Derived, emitted and interpreted models against independent computations, and what users build.
//!
//! One program holds all of them: `cargo test -p hodograph-tests --test all impacts::`
//! runs those of `tests/impacts.rs`.

mod accelerations;
mod answers_for_python;
mod bicycle;
mod closed_contacts;
mod columns;
mod commands;
mod common;
mod contact_and_rolling;
mod contacts_by_number;
mod cost;
mod derivations;
mod derivatives;
mod descriptions;
mod documents;
mod doors;
mod downstream;
mod emitted_equals_interpreted;
mod emitted_models;
mod evaluate;
mod events_as_json;
mod gallery;
mod impacts;
mod inlined;
mod laws;
mod many_contacts;
mod mechanisms_by_slices;
mod parts;
mod peers;
mod records;
mod reference;
mod rolling;
mod rotation;
mod rounding;
mod saltation;
mod second_road;
mod specialised;
