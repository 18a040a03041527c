//! What documents say of the repository holds: the models that they show are accepted as they stand, workspaces
//! are named, `unsafe` stands nowhere else, and numbers of equations lead to equations.

use std::path::{Path, PathBuf};

use crate::common::root;
use hodograph_generator::check::check;
use hodograph_generator::source::Source;

/// The code blocks of a page that are whole models, with the line each begins at. Blocks may be indented (in
/// lists).
fn shown(page: &str) -> Vec<(usize, String)> {
    let mut models = Vec::new();
    let mut block: Option<(usize, String)> = None;
    for (index, line) in page.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            match block.take() {
                Some(model) if model.1.lines().any(|line| line.trim_start().starts_with("mechanism ")) => {
                    models.push(model);
                }
                Some(_) => {}
                None => block = Some((index + 2, String::new())),
            }
        } else if let Some((_, text)) = &mut block {
            text.push_str(line);
            text.push('\n');
        }
    }
    models
}

#[test]
fn shown_models_are_accepted() {
    let mut count = 0;
    for page in ["README.md", "CONTRIBUTING.md", "docs/language.md"] {
        let text = std::fs::read_to_string(root().join(page)).expect(page);
        for (line, text) in shown(&text) {
            let source = Source::file(format!("{page} from line {line}"), text);
            let checked = check(&source);
            // not every example is for simulation
            let others = checked.diagnostics.iter().filter(|d| d.code.0 != "W014");
            let messages: Vec<String> = others.map(|d| d.one_line(&source)).collect();
            assert!(messages.is_empty(), "{}", messages.join("\n"));
            count += 1;
        }
    }
    assert!(count >= 3, "{count} models");
}

/// Every page of `docs` stands in the book of the page and in the index.
#[test]
fn pages_are_in_the_book_and_in_the_index() {
    let lists: Vec<(&str, String)> = ["playground/book/contents.js", "docs/index.md"]
        .map(|list| (list, std::fs::read_to_string(root().join(list)).expect(list)))
        .into();
    let mut count = 0;
    for entry in std::fs::read_dir(root().join("docs")).expect("a folder") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") && name != "index.md" {
            for (list, text) in &lists {
                assert!(text.contains(&name), "docs/{name} is not in {list}");
            }
            count += 1;
        }
    }
    assert!(count > 20, "{count} pages");
}

/// All files of the repository with these names or extensions, but what is built.
fn files(folder: &Path, wanted: &dyn Fn(&str) -> bool, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            if name != "target" && !name.starts_with('.') {
                files(&path, wanted, found);
            }
        } else if wanted(&name) {
            found.push(path);
        }
    }
}

/// The folders of the files in which a text stands, from the root.
fn folders_with(wanted: &dyn Fn(&str) -> bool, holds: impl Fn(&str) -> bool) -> Vec<String> {
    let mut paths = Vec::new();
    files(&root(), wanted, &mut paths);
    let mut folders: Vec<String> = paths
        .iter()
        .filter(|path| std::fs::read_to_string(path).is_ok_and(|text| holds(&text)))
        .map(|path| {
            let folder = path.strip_prefix(root()).expect("in the repository").parent().expect("a folder");
            folder.to_string_lossy().replace('\\', "/")
        })
        .collect();
    folders.sort();
    folders.dedup();
    folders
}

#[test]
fn workspaces_are_named() {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let workspaces = folders_with(&|name| name == "Cargo.toml", |text| text.contains("\n[workspace]"));
    assert_eq!(workspaces.len(), 9, "{workspaces:?}");
    for folder in workspaces.iter().filter(|folder| !folder.is_empty()) {
        let named = [format!("`{folder}`"), format!("`{folder}/`")];
        assert!(named.iter().any(|name| page.contains(name)), "ARCHITECTURE.md does not name {folder}");
    }
}

/// Files with code that is `unsafe`; those of the tool hold it as text, for the crates that it writes.
#[test]
fn unsafe_code_stands_where_the_architecture_says() {
    let holds = |text: &str| {
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        // Put together, so that this file holds none.
        let words = ["{", "fn", "impl", "extern"].map(|word| format!("{} {word}", "unsafe"));
        code.into_iter().any(|line| words.iter().any(|word| line.contains(word)))
    };
    let found = folders_with(&|name| name.ends_with(".rs"), holds);
    let expected = [
        "bindings/casadi/src",
        "bindings/fmu/src",
        "generator/cli/src/export",
        "generator/editors/acceptance/src",
        "playground/src",
        "tests/benchmarks/generated/src/times",
        "tests/firmware/src",
        "tests/fixtures/freestanding/src",
        "tests/gpu/src",
    ];
    assert_eq!(found, expected);
}

/// The numbers in parentheses, such as 13.3 of "(13.3)".
fn numbers(line: &str) -> impl Iterator<Item = &str> {
    line.split('(').skip(1).filter_map(|rest| {
        let number = rest.split(')').next()?;
        let (section, equation) = number.split_once('.')?;
        let digits = |text: &str| (1..=2).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
        (digits(section) && digits(equation.trim_end_matches('a'))).then_some(number)
    })
}

/// Every equation of the theory that a document or a comment names is there, and so is every section in parentheses.
#[test]
fn equations_that_are_named_are_there() {
    let theory = std::fs::read_to_string(root().join("docs/theory.md")).expect("docs/theory.md");
    let tagged = theory.lines().filter_map(|line| {
        let line = line.trim_end();
        numbers(line).last().filter(|number| line.ends_with(&format!("({number})")))
    });
    let heads = theory.lines().filter_map(|line| line.strip_prefix("### ")?.split(' ').next());
    let there: std::collections::BTreeSet<&str> = tagged.chain(heads).collect();
    assert!(there.contains("13.3") && there.contains("18.9") && there.len() > 100, "{there:?}");
    let mut paths = Vec::new();
    files(&root(), &|name| name.ends_with(".rs") || name.ends_with(".md"), &mut paths);
    let mut named = 0;
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("a text");
        let is_theory = path.ends_with("docs/theory.md");
        for line in text.lines() {
            let of_equations = ["equation (", "equations (", "theory, (", "theory: ("];
            if is_theory || of_equations.iter().any(|words| line.contains(words)) {
                let code =
                    !is_theory && path.extension().is_some_and(|end| end == "rs") && !line.contains("//");
                // 18.13 and the like have bounds as well as equations
                let bound = |number: &&str| number.starts_with('0') || is_theory && line.starts_with('|');
                for number in numbers(line).filter(|number| !code && !bound(number)) {
                    assert!(there.contains(number), "{}: ({number})", path.display());
                    named += 1;
                }
            }
        }
    }
    assert!(named > 150, "{named}");
}

/// The cells of the rows of a table whose head begins so.
fn table(page: &str, head: &str) -> Vec<Vec<String>> {
    let rows = page.lines().skip_while(|line| !line.starts_with(head)).skip(2);
    rows.take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect())
        .collect()
}

/// The two tables of benchmarks.md that have instructions of derivatives say the same.
#[test]
fn instructions_of_derivatives_are_the_same_in_both_tables() {
    let page = std::fs::read_to_string(root().join("docs/benchmarks.md")).expect("docs/benchmarks.md");
    let all = table(&page, "| mechanism | routine | run-time |");
    let derivatives = table(&page, "| mechanism | dFD | ratio | CasADi | dID | A, B |");
    assert!(derivatives.len() >= 4, "{derivatives:?}");
    for row in &derivatives {
        for (routine, column) in [("dFD", 1), ("dID", 4), ("A, B", 5)] {
            let found = all.iter().find(|other| other[0] == row[0] && other[1] == routine);
            let found = found.unwrap_or_else(|| panic!("{} has no row of {routine}", row[0]));
            assert_eq!(found[4], row[column], "{}: {routine}", row[0]);
        }
    }
}
