//! The models that the documents show are accepted as they stand.

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
