//! Tests of all packages together; see the files beside `src`.
