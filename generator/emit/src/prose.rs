//! Converts an author's words to documentation in Rust.

use proc_macro2::TokenStream;
use quote::quote;

/// Documentation, an attribute per line.
pub fn docs(text: &str) -> TokenStream {
    let text = prose(text);
    let lines = text.lines().map(|line| if line.is_empty() { String::new() } else { format!(" {line}") });
    quote! { #(#[doc = #lines])* }
}

/// The fence at the beginning of a line: three or more backticks or tildes.
pub fn fence(line: &str) -> Option<&str> {
    let mark = line.chars().next().filter(|c| matches!(c, '`' | '~'))?;
    let length = line.chars().take_while(|c| *c == mark).count();
    (length >= 3).then(|| line.get(..length)).flatten()
}

/// The length of the mark of a list or of a quotation at the beginning of a line.
fn mark(line: &str) -> Option<usize> {
    let digits = line.chars().take_while(char::is_ascii_digit).count();
    let rest = line.get(digits..)?;
    let ends = if digits > 0 { rest.starts_with(['.', ')']) } else { rest.starts_with(['>', '-', '*', '+']) };
    let after = rest.get(1..)?;
    (ends && (after.starts_with(' ') || rest.starts_with('>'))).then_some(digits + 1)
}

/// A line outside of fenced blocks without the blanks that would make an example of it: before it, and after the marks of
/// lists and quotations.
fn unindented(line: &str) -> String {
    let mut out = String::new();
    let mut rest = line.trim();
    while let Some(length) = mark(rest) {
        let (mark, after) = rest.split_at(length);
        out += mark;
        out.push(' ');
        rest = after.trim_start();
    }
    // A fence after a mark would be one too.
    if !out.is_empty() && fence(rest).is_some() {
        out.push('\\');
    }
    (out + rest).trim_end().to_owned()
}

/// An author's text as documentation for rustdoc. Indented text and fenced blocks without a language are not
/// Rust, but `cargo test` would compile them as examples; they are changed accordingly.
pub fn prose(text: &str) -> String {
    let mut open: Option<String> = None;
    let mut lines = Vec::new();
    for line in text.trim().lines() {
        let trimmed = line.trim();
        let found = fence(trimmed);
        lines.push(match (&open, found) {
            (Some(own), Some(found)) if found.starts_with(own.as_str()) && found == trimmed => {
                open = None;
                found.to_owned()
            }
            // Inside a fence, blanks are layout.
            (Some(_), _) => line.trim_end().to_owned(),
            (None, Some(found)) => {
                open = Some(found.to_owned());
                if found == trimmed { format!("{found}text") } else { trimmed.to_owned() }
            }
            (None, None) => unindented(line),
        });
    }
    // An unclosed fence would extend to the text after it.
    lines.extend(open);
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::prose;

    #[test]
    fn comments_are_no_examples() {
        assert_eq!(prose(" A cart.\n\n     __\n    |__|\n"), "A cart.\n\n__\n|__|");
        assert_eq!(prose("```\n  a\n```\nb"), "```text\n  a\n```\nb");
        assert_eq!(prose("```rust\nlet a = 1;\n```"), "```rust\nlet a = 1;\n```");
        assert_eq!(prose("a\n```\nb"), "a\n```text\nb\n```");
        assert_eq!(prose("~~~\n  a\n~~~\nb"), "~~~text\n  a\n~~~\nb");
        assert_eq!(prose("````\n```\na\n````"), "````text\n```\na\n````");
        assert_eq!(prose("1.     a\n>      b\n- c\n2.5 m\n-3 kg"), "1. a\n> b\n- c\n2.5 m\n-3 kg");
        assert_eq!(prose("> ```\n> a"), "> \\```\n> a");
    }
}
