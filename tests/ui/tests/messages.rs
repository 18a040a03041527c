//! What the compiler says of malformed models, inline and in files. `TRYBUILD=overwrite` writes the
//! expectations anew.

#[test]
fn messages_of_the_compiler() {
    let cases = trybuild::TestCases::new();
    cases.compile_fail("*.rs");
}
