//! Measures the time to compile a module with all of its methods called in doubles: the worst case, since
//! methods that are not called are not compiled.

use std::fmt::Write;

use crate::derive::Derivation;
use crate::harness;
use crate::tools::{Failure, Folders};

/// The mechanism whose module is compiled as a whole.
const LARGEST: &str = "anymal";

/// Prints how long it takes and how large the code is.
pub fn print(folders: &Folders, derivations: &[Derivation<'_>]) -> Result<(), Failure> {
    for derivation in derivations.iter().filter(|derivation| derivation.case.name == LARGEST) {
        let (text, methods) = library(derivation);
        let package = format!("{}_whole", derivation.package());
        harness::write_library(folders, &package, &text, &derivation.module)?;
        let built = harness::cargo(folders, &package)?;
        println!(
            "\nThe module of the {} with all its {methods} methods compiles in {:.1} s ({}).",
            derivation.case.title,
            built.seconds,
            derivation.package()
        );
    }
    Ok(())
}

/// A library that instantiates every method for doubles, and how many those are.
fn library(derivation: &Derivation<'_>) -> (String, usize) {
    let mut text = format!(
        "#![allow(unused)]\ninclude!(\"module.rs\");\nuse {}::*;\ntype T = f64;\ntype Machine = {}<T>;\n",
        harness::module_name(derivation),
        harness::type_name(derivation)
    );
    let mut methods = 0;
    // Methods of the mechanism; what collisions are asked for stands in other blocks.
    let blocks = derivation.module.split("\n    impl<T: ::hodograph::Scalar> ");
    let name = format!("{}<T>", harness::type_name(derivation));
    let own = blocks.filter(|block| block.starts_with(&name));
    for part in own.flat_map(|block| block.split("\n        pub fn ").skip(1)) {
        let Some((name, rest)) = part.split_once('(') else { continue };
        let Some((arguments, _)) = rest.split_once(')') else { continue };
        let arguments: Vec<&str> =
            arguments.split(',').map(str::trim).filter(|text| !text.is_empty()).collect();
        if arguments.first() != Some(&"&self") {
            continue;
        }
        let names: Vec<&str> =
            arguments[1..].iter().filter_map(|argument| argument.split(':').next()).collect();
        let typed: Vec<&str> = std::iter::once("m: &Machine").chain(arguments[1..].iter().copied()).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "pub fn all_{methods}({}) -> impl Sized {{ m.{name}({}) }}",
            typed.join(", "),
            names.join(", ")
        );
        methods += 1;
    }
    (text, methods)
}
