//! What stands between braces, divided at its separators.

use super::items::{Item, Kind};
use crate::syntax::token::TokenKind;

/// What stands between two separators.
#[derive(Clone, Debug, Default)]
pub struct Entry<'i, 'a> {
    /// documentation and comments on lines of their own before it
    pub before: Vec<&'i Item<'a>>,
    /// its items, the separator included
    pub items: &'i [Item<'a>],
    /// comments behind it on its line
    pub behind: Vec<&'i Item<'a>>,
}

impl Entry<'_, '_> {
    /// Whether an empty line stands before it.
    pub fn apart(&self) -> bool {
        let first = self.before.first().copied().or(self.items.first());
        first.is_some_and(|item| item.breaks > 1)
    }
}

/// Divides the items between two braces.
pub fn entries<'i, 'a>(items: &'i [Item<'a>]) -> Vec<Entry<'i, 'a>> {
    let mut entries = Vec::new();
    let mut at = 0;
    while at < items.len() {
        let mut entry = Entry::default();
        let begins = items[at..].iter().position(|item| !item.is_remark()).map_or(items.len(), |n| at + n);
        entry.before = items[at..begins].iter().collect();
        let ends = begins + length(&items[begins..]);
        entry.items = &items[begins..ends];
        at = ends;
        while let Some(item) = items.get(at).filter(|item| behind(item)) {
            entry.behind.push(item);
            at += 1;
            if item.ends_line() {
                break;
            }
        }
        entries.push(entry);
    }
    entries
}

/// Whether a comment stands behind something on its line.
pub fn behind(item: &Item<'_>) -> bool {
    item.breaks == 0 && matches!(item.kind, Kind::CommentLine | Kind::CommentBlock)
}

/// Number of items to the separator, which is included, or to the last token.
fn length(items: &[Item<'_>]) -> usize {
    let mut depth = 0_usize;
    for (i, item) in items.iter().enumerate() {
        match item.kind {
            Kind::Token(TokenKind::Open(_)) => depth += 1,
            Kind::Token(TokenKind::Close(_)) => depth = depth.saturating_sub(1),
            Kind::Token(TokenKind::Sign(',' | ';')) if depth == 0 => return i + 1,
            _ => {}
        }
    }
    // comments behind the last token stand before the brace that closes
    items.iter().rposition(|item| !item.is_remark()).map_or(0, |last| last + 1)
}
