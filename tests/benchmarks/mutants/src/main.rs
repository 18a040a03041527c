//! Judges mutants of the sources by the test suite.
//!
//! `cargo mutants` lists the mutants. Instead of building each one, this program builds all of them into one
//! copy of the sources, where a number selects one while the tests run. A mutant costs the tests alone, which
//! stop at the first failure.
//!
//! ```text
//! hodograph-mutants PACKAGE FILES [COUNT [ONLY [TESTS]]]
//! ```
//!
//! PACKAGE is the package that holds the sources and whose tests judge; FILES is the pattern of the sources;
//! COUNT limits the mutants to a random sample; ONLY takes the mutants whose names contain it, TESTS the
//! tests. The standard output is one line for each mutant that survives.

mod build;
mod copy;
mod instrument;
mod judge;
mod list;

use std::{error::Error, path::Path};

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [package, files, rest @ ..] = &arguments[..] else {
        return Err(
            "say the package and the pattern of its files, for example: hodograph 'runtime/src/solve/**'"
                .into(),
        );
    };
    let count = rest.first().map(|count| count.parse::<usize>()).transpose()?.unwrap_or(usize::MAX);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").canonicalize()?;
    let copy = copy::of_the_repository(&root)?;
    let only = rest.get(1).map_or("", String::as_str);
    let listed = list::of(&copy, package, files)?;
    println!("{} mutants are listed", listed.len());
    let mutants = list::sample(listed, count, only);
    let built = build::all_in_one(&copy, package, &mutants)?;
    println!(
        "{} of {} are built in; the others do not compile, or cannot be selected while running",
        built.ids.len(),
        mutants.len()
    );
    judge::all(
        &copy.join(list::folder(package)),
        &built.tests,
        rest.get(2).map(String::as_str),
        &mutants,
        &built.ids,
    )
}
