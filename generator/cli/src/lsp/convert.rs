//! Places and kinds, as the protocol counts and calls them.

use gen_lsp_types as lsp;
use hodograph_generator::model::names::Symbol;
use hodograph_language::Span;
use hodograph_language::colours::Kind;
use hodograph_language::completion::Proposed;
use hodograph_language::text::{Edit, Encoding, Position, Text};

/// A text and how its client counts.
#[derive(Clone, Copy)]
pub struct Places<'t> {
    pub text: &'t Text,
    pub encoding: Encoding,
}

impl Places<'_> {
    pub fn position(&self, offset: u32) -> lsp::Position {
        let Position { line, character } = self.text.position(offset, self.encoding);
        lsp::Position { line, character }
    }

    pub fn range(&self, span: Span) -> lsp::Range {
        lsp::Range { start: self.position(span.start), end: self.position(span.end) }
    }

    pub fn offset(&self, position: lsp::Position) -> u32 {
        let lsp::Position { line, character } = position;
        self.text.offset(Position { line, character }, self.encoding)
    }

    pub fn span(&self, range: lsp::Range) -> Span {
        Span { start: self.offset(range.start), end: self.offset(range.end) }
    }

    pub fn edits(&self, edits: Vec<Edit>) -> Vec<lsp::TextEdit> {
        let edit = |edit: Edit| lsp::TextEdit { range: self.range(edit.span), new_text: edit.text };
        edits.into_iter().map(edit).collect()
    }
}

/// The types of words, in the order in which [`colour`] counts them.
pub const TYPES: [&str; 13] = [
    "comment",
    "keyword",
    "number",
    "type",
    "property",
    "function",
    "enumMember",
    "parameter",
    "variable",
    "macro",
    "class",
    "struct",
    "event",
];
/// The modifiers, in the order of their bits.
pub const MODIFIERS: [&str; 4] = ["declaration", "documentation", "readonly", "defaultLibrary"];

/// Type and modifiers of a word.
pub fn colour(kind: Kind, declares: bool) -> (u32, u32) {
    let (kind, more) = match kind {
        Kind::Comment => (0, 0),
        Kind::Documentation => (0, 2),
        Kind::Keyword => (1, 0),
        Kind::Number => (2, 0),
        Kind::Unit => (3, 0),
        Kind::Field | Kind::Member => (4, 0),
        Kind::Function => (5, 8),
        Kind::Law => (6, 0),
        Kind::Parameter => (7, 4),
        Kind::Input => (7, 0),
        Kind::Coordinate | Kind::Speed => (8, 0),
        Kind::Definition => (9, 0),
        Kind::Frame => (10, 0),
        Kind::Given => (10, 8),
        Kind::Point => (6, 0),
        Kind::Body | Kind::Shape => (11, 0),
        Kind::Contact => (12, 0),
    };
    (kind, more | u32::from(declares))
}

/// How an outline shows a symbol; sections have none.
pub fn symbol(symbol: Option<Symbol>) -> lsp::SymbolKind {
    match symbol {
        None => lsp::SymbolKind::Namespace,
        Some(Symbol::Parameter(_) | Symbol::Pi) => lsp::SymbolKind::Constant,
        Some(Symbol::Definition(_)) => lsp::SymbolKind::Function,
        Some(Symbol::Frame(_)) => lsp::SymbolKind::Class,
        Some(Symbol::Point(_)) => lsp::SymbolKind::EnumMember,
        Some(Symbol::Body(_) | Symbol::Shape(_)) => lsp::SymbolKind::Struct,
        Some(Symbol::Contact(_)) => lsp::SymbolKind::Event,
        Some(_) => lsp::SymbolKind::Variable,
    }
}

/// How a list of proposals shows one.
pub fn proposed(kind: Proposed) -> lsp::CompletionItemKind {
    match kind {
        Proposed::Word => lsp::CompletionItemKind::Keyword,
        Proposed::Section => lsp::CompletionItemKind::Module,
        Proposed::Field | Proposed::Member => lsp::CompletionItemKind::Field,
        Proposed::Function => lsp::CompletionItemKind::Function,
        Proposed::Unit => lsp::CompletionItemKind::Unit,
        Proposed::Name(Symbol::Parameter(_) | Symbol::Pi) => lsp::CompletionItemKind::Constant,
        Proposed::Name(Symbol::Frame(_)) => lsp::CompletionItemKind::Class,
        Proposed::Name(Symbol::Point(_)) => lsp::CompletionItemKind::EnumMember,
        Proposed::Name(Symbol::Body(_) | Symbol::Shape(_)) => lsp::CompletionItemKind::Struct,
        Proposed::Name(Symbol::Contact(_)) => lsp::CompletionItemKind::Event,
        Proposed::Name(_) => lsp::CompletionItemKind::Variable,
    }
}
