//! Every file of tests is compiled, and the commands of documents and comments that run one file of tests name one
//! that exists.

use std::path::{Path, PathBuf};

use crate::common::root;

/// Packages whose tests are one program, and their folders.
const PACKAGES: [(&str, &str); 9] = [
    ("hodograph", "runtime"),
    ("hodograph-simulation", "simulation"),
    ("hodograph-gradients", "simulation/gradients"),
    ("hodograph-fmu", "bindings/fmu"),
    ("hodograph-generator", "generator"),
    ("hodograph-derive", "generator/derive"),
    ("hodograph-cli", "generator/cli"),
    ("hodograph-tests", "tests"),
    // a workspace of its own
    ("hodograph-sweeps", "sweeps"),
];

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.map(|entry| entry.expect("an entry").path()).filter(|path| path.is_file()).collect()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn every_file_of_tests_is_compiled() {
    for (package, folder) in PACKAGES {
        let folder = root().join(folder).join("tests");
        let main = read(&folder.join("main.rs"));
        let rust = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "rs");
        for path in files(&folder).into_iter().filter(rust) {
            let stem = path.file_stem().expect("a stem").to_string_lossy();
            let listed = main.lines().any(|line| line == format!("mod {stem};"));
            assert!(listed || stem == "main", "{package}: `mod {stem};` is missing in tests/main.rs");
        }
    }
}

/// What is wrong with a command that runs tests: `before` and `after` are what stands beside `--test `.
fn mistake(before: &str, after: &str) -> Option<String> {
    let end = after.find(['`', '\n', '#', '"']).unwrap_or(after.len());
    let mut words = after[..end].split_whitespace().take_while(|word| *word != "--");
    let program = words.next()?;
    let code = &before[before.rfind('`').unwrap_or(0)..];
    let command = &code[code.rfind("cargo test").unwrap_or(code.len())..];
    if program != "all" {
        return Some(format!("no program of tests {program}"));
    }
    let package = command.split_once("-p ").and_then(|(_, rest)| rest.split_whitespace().next());
    let folders: Vec<PathBuf> = PACKAGES
        .iter()
        .filter(|(name, _)| package.is_none_or(|package| package == *name))
        .map(|(_, folder)| root().join(folder).join("tests"))
        .collect();
    words.find_map(|word| {
        let (file, test) = word.split_once("::")?;
        let texts = folders
            .iter()
            .filter_map(|folder| std::fs::read_to_string(folder.join(file).with_extension("rs")).ok());
        let found = texts.into_iter().any(|text| test.is_empty() || text.contains(&format!("fn {test}(")));
        (!found).then(|| format!("no tests {word} in {package:?}"))
    })
}

#[test]
fn commands_name_tests_that_exist() {
    let mut paths = Vec::new();
    for folder in ["", "docs", "docs/notes", ".ci", "generator/fuzz", "tests/data/many_contacts"] {
        paths.extend(files(&root().join(folder)));
    }
    for (_, folder) in PACKAGES {
        paths.extend(files(&root().join(folder).join("tests")));
    }
    let mut count = 0;
    for path in paths {
        // This file writes of commands.
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        if path.ends_with("tests/commands.rs") {
            continue;
        }
        for (place, _) in text.match_indices("--test ") {
            let (before, after) = (&text[..place], &text[place + "--test ".len()..]);
            assert_eq!(
                mistake(before, after),
                None,
                "{}: {}",
                path.display(),
                after.lines().next().unwrap_or_default()
            );
            count += 1;
        }
    }
    assert!(count > 30, "{count} commands");
}

#[test]
fn a_command_that_names_no_test_is_found() {
    assert_eq!(mistake("`cargo test -p hodograph ", "all slip::`, and more"), None);
    assert_eq!(mistake("cargo test -p hodograph-cli ", "all paper::figures_are_fresh -- --nocapture"), None);
    for (before, after) in [
        ("cargo test -p hodograph ", "slip"),
        ("cargo test -p hodograph ", "all slips::"),
        ("cargo test -p hodograph-cli ", "all slip::"),
        ("cargo test -p hodograph-cli ", "all paper::figures_are_stale"),
    ] {
        assert!(mistake(before, after).is_some(), "{after}");
    }
}
