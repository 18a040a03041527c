//! From the text of a model to Rust code, in stages.
