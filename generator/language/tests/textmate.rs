//! The TextMate grammar of editors is made from the tables of words: `HODOGRAPH_UPDATE=1` writes it anew.

use std::path::Path;

use hodograph_model::model::mechanism::Kind;
use hodograph_model::parts;
use hodograph_model::syntax::units;
use hodograph_model::words::{self, Word};

fn any<'w>(list: impl IntoIterator<Item = &'w str>) -> String {
    let mut list: Vec<&str> = list.into_iter().collect();
    list.sort_by(|a, b| b.len().cmp(&a.len()).then(a.cmp(b)));
    list.dedup();
    list.join("|")
}

fn texts(table: &'static [Word]) -> impl Iterator<Item = &'static str> {
    table.iter().map(|word| word.text)
}

fn grammar() -> String {
    let records = [&words::BODY[..], &words::BODY_OF_SHAPE, &words::SHAPE, &words::PARTICLE, &words::CONTACT];
    let more = [&words::SURFACE[..], &words::SPRING, &words::TORSION];
    let kinds = Kind::ALL.map(|kind| kind.word());
    let fields = records.into_iter().chain(more).flatten().copied().chain(kinds);
    let members = texts(words::MEMBERS);
    let functions = texts(words::FUNCTIONS).chain(texts(words::START_FUNCTIONS));
    let inner = texts(words::WORDS).filter(|word| *word != "velocity" && *word != "none");
    let laws = texts(words::LAWS).chain(texts(words::SLIDING)).chain(texts(words::RESTITUTION));
    let units = any(units::symbols().map(|(symbol, _)| symbol));
    let unit = format!("(?:fp|[fpnumcdhkMGT]|da)?(?:{units})|1");
    let rules: Vec<(&str, String)> = vec![
        ("comment.line.documentation.hodograph", "//[/!].*$".to_owned()),
        ("comment.line.double-slash.hodograph", "//.*$".to_owned()),
        ("string.quoted.double.hodograph", "\"[^\"]*\"".to_owned()),
        ("constant.numeric.hodograph", r"\b[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?\b".to_owned()),
        ("keyword.other.section.hodograph", format!(r"\b(?:{})\b(?=\s*\{{)", any(texts(words::SECTIONS)))),
        ("keyword.control.part.hodograph", format!(r"^\s*(?:{})\b(?=\s+[\w\x22])", any(parts::WORDS))),
        (
            "support.type.unit.hodograph",
            format!(r"(?<=:)\s*\(?(?:{unit})(?:[*/^()]+(?:{unit}|[0-9]+))*\b(?=\s*[=,;}}])"),
        ),
        ("variable.other.member.hodograph", format!(r"(?<=\.)(?:{})\b", any(members))),
        ("support.function.hodograph", format!(r"\b(?:{})\b(?=\s*\()", any(functions))),
        ("keyword.other.load.hodograph", format!(r"\b(?:{})\b(?=[^;{{}}]*:)", any(words::LOADS))),
        ("variable.other.property.hodograph", format!(r"\b(?:{})\b(?=\s*:)", any(fields))),
        ("constant.language.law.hodograph", format!(r"(?<=:)\s*(?:{})\b", any(laws))),
        ("keyword.other.hodograph", format!(r"\b(?:{})\b", any(inner))),
        ("constant.language.hodograph", format!(r"\b(?:{})\b", any(texts(words::GIVEN)))),
    ];
    let quoted = |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
    let block = |indent: &str| {
        format!(
            "{indent}{{ \"name\": \"comment.block.hodograph\", \"begin\": \"/\\\\*\", \"end\": \"\\\\*/\", \"patterns\": [{{ \"include\": \"#comment\" }}] }}"
        )
    };
    let rules: Vec<String> = rules
        .iter()
        .map(|(name, pattern)| {
            format!("    {{ \"name\": {}, \"match\": {} }}", quoted(name), quoted(pattern))
        })
        .collect();
    format!(
        "{{\n  \"name\": \"Hodograph\",\n  \"scopeName\": \"source.hodograph\",\n  \"fileTypes\": [\"mech\"],\n  \"patterns\": [\n    {{ \"include\": \"#comment\" }},\n{}\n  ],\n  \"repository\": {{\n    \"comment\": {{ \"patterns\": [\n{}\n    ] }}\n  }}\n}}\n",
        rules.join(",\n"),
        block("      ")
    )
}

#[test]
fn the_textmate_grammar_is_that_of_the_words() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../editors/vscode/hodograph.tmLanguage.json");
    if std::env::var_os("HODOGRAPH_UPDATE").is_some() {
        std::fs::write(&path, grammar()).unwrap();
    }
    let stored = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(stored == grammar(), "{}: HODOGRAPH_UPDATE=1 writes it anew", path.display());
}
