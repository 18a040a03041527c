//! A model in an editor: its text, and the results of reading and checking it.

use std::cell::OnceCell;
use std::rc::Rc;

use hodograph_model::check::{self, Analysis};
use hodograph_model::diagnostics::codes;
use hodograph_model::model::symbols::Symbols;
use hodograph_model::parts::{Files, Imported, NoFiles};
use hodograph_model::source::{MAX_TOKENS, Source};
use hodograph_model::span::Span;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Tree;
use hodograph_model::syntax::{lexer, repair};

use crate::entries::Written;
use crate::text::Text;

/// A place in a text: the index 0 is the document, imported files are counted from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// index of the text
    pub file: usize,
    /// place in the text
    pub span: Span,
}

/// A model in an editor.
pub struct Document {
    pub(crate) text: Text,
    pub(crate) source: Source,
    pub(crate) analysis: Analysis,
    /// the files that it may import
    pub(crate) files: Rc<dyn Files>,
    /// the tree and the names if brackets are not balanced, so that the parser reads nothing
    repaired: OnceCell<(Tree, Symbols)>,
}

impl Document {
    /// Reads and checks a text that imports nothing.
    pub fn new(text: impl Into<String>) -> Document {
        Document::importing(text, "", Rc::new(NoFiles))
    }

    /// Reads and checks a text that may import files. `name` is its name in messages.
    pub fn importing(text: impl Into<String>, name: &str, files: Rc<dyn Files>) -> Document {
        let text = text.into();
        let source = Source::file(name, text.as_str()).importing(&*files);
        let mut analysis = check::analyse(&source);
        if source.expansion().is_some() {
            analysis.tokens = lexer::tokens(&text, MAX_TOKENS);
            // the absence of bodies is not a mistake in a file of parts
            let library = source.is_library();
            analysis.diagnostics.retain(|found| !(library && found.code == codes::EMPTY));
        }
        Document { text: Text::new(text), source, analysis, files, repaired: OnceCell::new() }
    }

    /// The place in the texts of a place in the expanded model.
    pub(crate) fn place(&self, span: Span) -> Place {
        let (file, span) = self.source.place(span);
        Place { file, span }
    }

    /// An imported file, by its index in places.
    pub fn imported(&self, file: usize) -> Option<&Imported> {
        self.source.expansion()?.files.get(file.checked_sub(1)?)
    }

    /// Its own text and tokens.
    pub(crate) fn written(&self) -> Written<'_> {
        Written { text: &self.text, tokens: self.tokens() }
    }

    /// Whether it uses parts, so that its names are those of the expanded model.
    pub(crate) fn has_parts(&self) -> bool {
        self.source.expansion().is_some()
    }

    /// The text.
    pub fn text(&self) -> &Text {
        &self.text
    }

    /// The text with its imports.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The results of `check`.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Whether brackets are not balanced.
    pub(crate) fn is_unbalanced(&self) -> bool {
        self.analysis.diagnostics.iter().any(|mistake| mistake.code == codes::UNBALANCED)
    }

    fn completed(&self) -> Option<&(Tree, Symbols)> {
        let unread = self.analysis.tree.sections.is_empty() && self.is_unbalanced();
        unread.then(|| self.repaired.get_or_init(|| check::names(&repair::balanced(&self.analysis.tokens))))
    }

    /// The tree of the parts of the text that could be parsed, after missing brackets were added.
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

    /// The token at a place; of two tokens that touch there, a name.
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
