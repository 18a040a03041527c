//! Literals have an origin: docs/theory.md lists them, with its derivation or the experiment that fixed it.

use std::fs;
use std::path::{Path, PathBuf};

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Constants of the simulation that are numbers of a method, not literals that could be others.
const OF_METHODS: [&str; 7] = ["WORKS", "STAGES", "ALL_STAGES", "ORDER", "PLACES_OF", "DEGREES", "RATIO"];

/// Every literal of the simulation has its row, by name, in section 18 of the theory.
#[test]
fn literals_of_the_simulation_are_in_the_theory() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let theory = fs::read_to_string(root.join("docs/theory.md")).unwrap();
    let (_, after) = theory.split_once("\n## 18 ").expect("section 18");
    let (section, _) = after.split_once("\n## 19 ").expect("section 19");
    let mut files = Vec::new();
    rust_files(&root.join("simulation/src"), &mut files);
    let mut found = 0;
    let mut missing = Vec::new();
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for line in code.lines() {
            let Some((_, rest)) = line.split_once("const ") else { continue };
            let Some((name, kind)) = rest.split_once(": ") else { continue };
            let is_number =
                ["f64", "usize", "u32", "i32", "[f64", "[usize"].iter().any(|of| kind.starts_with(of));
            let is_name = name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
            if !is_number || !is_name || OF_METHODS.contains(&name) {
                continue;
            }
            found += 1;
            if !section.contains(&format!("`{name}`")) {
                missing.push(format!("{} of {}", name, path.display()));
            }
        }
    }
    assert!(found > 100, "{found}");
    assert!(missing.is_empty(), "section 18 does not say where these come from: {missing:#?}");
}
