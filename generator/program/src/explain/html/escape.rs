//! Escapes text for HTML.

/// Text with the special characters of HTML escaped.
pub fn plain(text: &str) -> String {
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    escaped.chars().filter(|letter| !letter.is_control() || *letter == '\n').collect()
}
