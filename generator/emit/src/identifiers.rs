//! Converts names and words of a model to Rust tokens: identifiers, names of types, documentation.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use hodograph_model::rust_names::is_keyword;

/// The types of a generated module besides that of the mechanism.
pub const RECORDS: &[&str] = &[
    "Parameters",
    "Coordinates",
    "Speeds",
    "DependentSpeeds",
    "Inputs",
    "Collision",
    "CollisionDerivative",
    "ClosedContact",
    "ContactDerivatives",
    "Derivatives",
    "Linearisation",
];

/// Other names with a meaning in generated code.
const RESERVED: &[&str] = &["T", "Result", "Ok", "Err"];

/// `two_sleds` -> `TwoSleds`; capitals stay.
pub fn pascal_case(name: &str) -> String {
    let mut pascal = String::new();
    for word in name.split('_').filter(|word| !word.is_empty()) {
        let mut characters = word.chars();
        pascal.extend(characters.next().map(char::to_uppercase).into_iter().flatten());
        pascal.push_str(characters.as_str());
    }
    pascal
}

/// The name of the mechanism's type, which differs from those of the other types of its module.
pub fn type_name(mechanism: &str) -> String {
    let name = pascal_case(mechanism);
    let starts_well = name.starts_with(|c: char| c.is_alphabetic());
    let taken = [RECORDS, RESERVED].concat().contains(&name.as_str());
    if taken || is_keyword(&name) || !starts_well { format!("{name}Mechanism") } else { name }
}

/// An identifier, raw if it is a keyword. Any text is converted to a valid identifier.
pub fn ident(name: &str) -> Ident {
    let mut clean: String =
        name.chars().map(|c| if c == '_' || c.is_alphanumeric() { c } else { '_' }).collect();
    if clean.is_empty() || clean == "_" || clean.starts_with(|c: char| c.is_numeric()) {
        clean.insert(0, '_');
    }
    match clean.as_str() {
        "self" | "Self" | "super" | "crate" => Ident::new(&format!("{clean}_"), Span::call_site()),
        keyword if is_keyword(keyword) => Ident::new_raw(keyword, Span::call_site()),
        _ => Ident::new(&clean, Span::call_site()),
    }
}

/// Documentation, an attribute per line.
pub fn docs(text: &str) -> TokenStream {
    let text = prose(text);
    let lines = text.lines().map(|line| if line.is_empty() { String::new() } else { format!(" {line}") });
    quote! { #(#[doc = #lines])* }
}

/// An author's text as documentation for rustdoc. Indented text and fenced blocks without a language are not
/// Rust, but `cargo test` would compile them as examples; they are changed accordingly.
pub fn prose(text: &str) -> String {
    let mut fenced = false;
    let line = |line: &str| {
        let fence = line.trim_start().starts_with("```");
        let opens = fence && !fenced;
        // Inside a fence, blanks are layout; outside, they would start a code block.
        let line = if fenced && !fence { line } else { line.trim_start() };
        fenced ^= fence;
        if opens && line.trim_end() == "```" { "```text".to_owned() } else { line.trim_end().to_owned() }
    };
    let mut lines: Vec<String> = text.trim().lines().map(line).collect();
    // An unclosed fence would extend to the text after it.
    if fenced {
        lines.push("```".to_owned());
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_no_examples() {
        assert_eq!(prose(" A cart.\n\n     __\n    |__|\n"), "A cart.\n\n__\n|__|");
        assert_eq!(prose("```\n  a\n```\nb"), "```text\n  a\n```\nb");
        assert_eq!(prose("```rust\nlet a = 1;\n```"), "```rust\nlet a = 1;\n```");
        assert_eq!(prose("a\n```\nb"), "a\n```text\nb\n```");
    }

    #[test]
    fn cases() {
        assert_eq!(pascal_case("two_sleds"), "TwoSleds");
        assert_eq!(type_name("speeds"), "SpeedsMechanism");
        assert_eq!(ident("loop").to_string(), "r#loop");
    }
}
