//! Compares the grammar of editors with the parser, on all models and all cases of mistakes.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use hodograph_model::diagnostics::{Code, codes};
use hodograph_model::source::Source;
use hodograph_model::syntax::{self, lexer};
use tree_sitter::Parser;
use tree_sitter_language::LanguageFn;

unsafe extern "C" {
    fn tree_sitter_hodograph() -> *const ();
}

/// What the parser reports and a grammar of editors does not: the order of sections, the places of
/// documentation, and bounds.
const BEYOND: [Code; 4] = [codes::SECTION_ORDER, codes::SECTION_TWICE, codes::STRAY_DOCS, codes::TOO_DEEP];

/// Here letters of two scripts in one word are refused, which no grammar tells.
const MIXED: [&str; 1] = ["letters_cyrillic.mech"];

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    // SAFETY: the function is the one that the generated parser exports.
    let language = unsafe { LanguageFn::from_raw(tree_sitter_hodograph) };
    let mut parser = Parser::new();
    parser.set_language(&language.into()).expect("the generated parser has a version that tree-sitter knows");
    let (mut both, mut neither, mut differ) = (0, 0, 0);
    for folder in ["models", "generator/tests/diagnostics", "tests/models"] {
        for path in models(&root.join(folder)) {
            let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap_or_default()).into_owned();
            let source = Source::file("", text.as_str());
            // of a model with parts, what is wrong with the syntax of its own text
            let (named, found) = match source.expansion() {
                Some(expansion) => (true, expansion.syntax.clone()),
                None => {
                    let (tree, found) = syntax::parse(&lexer::tokens(&text, 1_000_000));
                    (tree.name.is_some(), found)
                }
            };
            let mistakes: Vec<&str> =
                found.iter().filter(|d| !BEYOND.contains(&d.code)).map(|d| d.code.0).collect();
            let accepted = mistakes.is_empty() && named;
            let parsed = parser.parse(&text, None).expect("no time limit is set");
            match (accepted, !parsed.root_node().has_error()) {
                _ if MIXED.iter().any(|name| path.ends_with(name)) => {}
                (true, true) => both += 1,
                (false, false) => neither += 1,
                (accepted, _) => {
                    differ += 1;
                    let word = if accepted { "only the parser accepts" } else { "only the grammar accepts" };
                    println!("{}: {word} it {mistakes:?}", path.display());
                }
            }
        }
    }
    println!("{both} texts accepted by both, {neither} by neither, {differ} by one");
    if differ == 0 && both > 0 && neither > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn models(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut out: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|e| e == "mech")).collect();
    out.sort();
    out
}
