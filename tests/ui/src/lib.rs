//! What the compiler says of malformed models: see the files beside `src`.
