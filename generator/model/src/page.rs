//! What all written pages have in common: their style sheet, and texts as HTML and SVG want them.

/// Colours, letters and what has the focus, in light and dark. Each page adds what it alone has.
pub const STYLE: &str = include_str!("page.css");

/// Text as SVG and HTML want it.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            letter if letter.is_control() => {}
            _ => out.push(letter),
        }
    }
    out
}
