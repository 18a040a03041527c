//! A model in an editor: its text and all that is known of it.

use std::cell::OnceCell;

use hodograph_model::check::{self, Analysis};
use hodograph_model::diagnostics::codes;
use hodograph_model::model::symbols::Symbols;
use hodograph_model::source::{MAX_TOKENS, Source};
use hodograph_model::span::Span;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Tree;
use hodograph_model::syntax::{lexer, repair};

use crate::text::Text;

/// A model in an editor.
pub struct Document {
    pub(crate) text: Text,
    pub(crate) source: Source,
    pub(crate) analysis: Analysis,
    /// the tree and the names where brackets have no partners, so that the parser reads nothing
    repaired: OnceCell<(Tree, Symbols)>,
}

impl Document {
    /// Reads and checks a text.
    pub fn new(text: impl Into<String>) -> Document {
        let text = text.into();
        Document::read(&text, Source::file("", text.as_str()))
    }

    /// Reads and checks a text that may import others: `source` knows these.
    pub fn read(text: &str, source: Source) -> Document {
        let mut analysis = check::analyse(&source);
        if source.expansion().is_some() {
            analysis.tokens = lexer::tokens(text, MAX_TOKENS);
            // a file of parts is no mechanism, and right as it is
            let library = source.is_library();
            analysis.diagnostics.retain(|found| !(library && found.code == codes::EMPTY));
        }
        Document { text: Text::new(text.to_owned()), source, analysis, repaired: OnceCell::new() }
    }

    /// Whether it uses parts, so that its names are those of the expanded model.
    pub(crate) fn has_parts(&self) -> bool {
        self.source.expansion().is_some()
    }

    /// The text.
    pub fn text(&self) -> &Text {
        &self.text
    }

    /// The text with what it imports.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// What `check` knows of it.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Whether brackets lack their partners.
    pub(crate) fn is_unbalanced(&self) -> bool {
        self.analysis.diagnostics.iter().any(|mistake| mistake.code == codes::UNBALANCED)
    }

    fn completed(&self) -> Option<&(Tree, Symbols)> {
        let unread = self.analysis.tree.sections.is_empty() && self.is_unbalanced();
        unread.then(|| self.repaired.get_or_init(|| check::names(&repair::balanced(&self.analysis.tokens))))
    }

    /// What of the text could be parsed, after its brackets were completed.
    pub fn tree(&self) -> &Tree {
        self.completed().map_or(&self.analysis.tree, |(tree, _)| tree)
    }

    /// Its names and their places.
    pub fn symbols(&self) -> &Symbols {
        self.completed().map_or(&self.analysis.symbols, |(_, symbols)| symbols)
    }

    /// Its tokens.
    pub(crate) fn tokens(&self) -> &[Token] {
        &self.analysis.tokens
    }

    /// The token that holds a place; of two that touch, a name.
    pub(crate) fn token_at(&self, offset: u32) -> Option<(usize, &Token)> {
        let tokens = self.tokens();
        let after = tokens.partition_point(|token| token.span.end < offset);
        let touching = (after..tokens.len()).take_while(|i| tokens[*i].span.start <= offset);
        let is_word = |i: &usize| tokens[*i].kind == TokenKind::Name;
        let found = touching.clone().find(is_word).or_else(|| touching.last())?;
        Some((found, &tokens[found]))
    }

    /// The place of the name of the mechanism.
    pub fn name_place(&self) -> Option<Span> {
        self.tree().name.as_ref().map(|name| name.span)
    }
}
