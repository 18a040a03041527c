//! The sections of a part as words, each with what it is: a name that is declared, a name that is referred
//! to, or neither. The parser of models reads them once, however often the part is used.

use std::borrow::Cow;
use std::collections::HashMap;

use super::catalogue::{Catalogue, Families};
use super::outline::{Block, Chunk};
use super::roles::{Kind, Role, roles};
use super::text::shown;
use crate::diagnostics::Diagnostic;
use crate::span::Span;
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::tree::{Expr, Name, Section};
use crate::syntax::{self};

/// A name with indices or through instances: `link[i-1].tip`.
#[derive(Clone, Debug)]
pub struct Path {
    /// the names between the dots
    pub segments: Vec<Segment>,
}

/// A name, perhaps with indices.
#[derive(Clone, Debug)]
pub struct Segment {
    /// the name
    pub name: Name,
    /// its indices
    pub indices: Vec<Vec<Token>>,
}

/// A token, or a path in the place of one.
#[derive(Clone, Debug)]
pub struct Word {
    /// the token; of a path its text and place
    pub token: Token,
    /// what it is
    pub role: Option<Role>,
    /// the path, if it is more than a plain name
    pub path: Option<Path>,
}

/// A stretch of words.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// the section whose entries they are
    pub section: Option<Section>,
    /// its word and brace
    pub head: Vec<Token>,
    /// the words
    pub words: Vec<Word>,
    /// its closing brace
    pub close: Option<Token>,
}

/// `shared g: m/s^2` in a part.
#[derive(Clone, Debug)]
pub struct Shared {
    /// the section
    pub section: Section,
    /// the name, in the part and in the mechanism
    pub name: Name,
    /// the unit, if it could be read
    pub unit: Option<Expr>,
}

/// A block as words.
#[derive(Clone, Debug, Default)]
pub struct Template {
    /// its sections
    pub stretches: Vec<Stretch>,
    /// what it shares with the mechanism
    pub shared: Vec<Shared>,
    /// mistakes of syntax
    pub mistakes: Vec<Diagnostic>,
    /// the units of its quantities
    pub units: HashMap<String, Expr>,
}

impl Template {
    /// The names that it declares, each with its words.
    pub fn declared(&self) -> impl Iterator<Item = (&Word, Kind)> {
        let words = self.stretches.iter().flat_map(|stretch| &stretch.words);
        words.filter_map(|word| match word.role {
            Some(Role::Declared(kind)) => Some((word, kind)),
            _ => None,
        })
    }
}

/// Reads a block. `head` is the place of what it belongs to; absent for that of a mechanism, which has a head
/// of its own.
pub fn template(
    block: &Block,
    head: Option<Span>,
    families: &Families,
    catalogue: &Catalogue<'_>,
) -> Template {
    let mut template = Template::default();
    for chunk in &block.chunks {
        let (section, head_tokens, inner, close) = match chunk {
            Chunk::Section(text) => {
                let inner = match head {
                    Some(_) => own(text.section, &text.inner, &mut template),
                    None => text.inner.clone(),
                };
                (Some(text.section), text.head.clone(), inner, Some(text.close.clone()))
            }
            Chunk::Other(tokens) => (None, Vec::new(), tokens.clone(), None),
        };
        let words = words(&inner, families, catalogue);
        template.stretches.push(Stretch { section, head: head_tokens, words, close });
    }
    let mut tokens = head.map(header).unwrap_or_default();
    for stretch in &template.stretches {
        tokens.extend(stretch.head.iter().cloned());
        tokens.extend(stretch.words.iter().map(|word| word.token.clone()));
        tokens.extend(stretch.close.iter().cloned());
    }
    let (tree, mistakes) = syntax::parse(&tokens);
    template.mistakes.extend(mistakes);
    let roles = roles(&tree);
    for word in template.stretches.iter_mut().flat_map(|stretch| &mut stretch.words) {
        if word.token.kind == TokenKind::Name {
            word.role = roles.get(&word.token.span.start).copied();
        }
    }
    for quantity in tree.parameters.iter().chain(&tree.inputs) {
        template.units.insert(quantity.name.text.clone(), quantity.unit.clone());
    }
    template
}

/// Reads an expression that is given for an argument.
pub fn expression(
    tokens: &[Token],
    families: &Families,
    catalogue: &Catalogue<'_>,
    mistakes: &mut Vec<Diagnostic>,
) -> Vec<Word> {
    let mut words = words(tokens, families, catalogue);
    let span = words.first().map_or(Span::default(), |word| word.token.span);
    let mut text = header(span);
    text.extend(synthetic("definitions { given =", span));
    text.extend(words.iter().map(|word| word.token.clone()));
    text.extend(synthetic("; }", span));
    let (tree, found) = syntax::parse(&text);
    mistakes.extend(found);
    let roles = roles(&tree);
    for word in &mut words {
        if word.token.kind == TokenKind::Name {
            word.role = roles.get(&word.token.span.start).copied();
        }
    }
    words
}

/// `mechanism P;`
fn header(span: Span) -> Vec<Token> {
    synthetic("mechanism Part;", span)
}

/// Tokens of a text, all at one place.
pub fn synthetic(text: &str, span: Span) -> Vec<Token> {
    let mut tokens = syntax::lexer::tokens(text, 1000);
    tokens.iter_mut().for_each(|token| token.span = span);
    tokens
}

/// The entries of a section without those that are shared with the mechanism, which are noted.
fn own(section: Section, tokens: &[Token], template: &mut Template) -> Vec<Token> {
    if !matches!(section, Section::Parameters | Section::Inputs) {
        return tokens.to_vec();
    }
    let mut kept = Vec::new();
    for entry in entries(tokens, ',') {
        let documented = entry.iter().take_while(|token| token.kind == TokenKind::OuterDoc).count();
        let [word, name, unit @ ..] = &entry[documented..] else {
            kept.extend_from_slice(entry);
            continue;
        };
        if !word.is_word("shared") || name.kind != TokenKind::Name {
            kept.extend_from_slice(entry);
            continue;
        }
        let mut text = header(word.span);
        text.extend(synthetic("parameters {", word.span));
        text.push(name.clone());
        text.extend(unit.iter().cloned());
        text.extend(synthetic("}", word.span));
        let (tree, mistakes) = syntax::parse(&text);
        template.mistakes.extend(mistakes);
        let declared = tree.parameters.into_iter().next();
        if let Some(value) = declared.as_ref().and_then(|declared| declared.value.as_ref()) {
            let message = format!("`{}` is shared: its value is that of the mechanism", name.text);
            let error = Diagnostic::new(crate::diagnostics::codes::EXPECTED, value.span, message);
            template.mistakes.push(error.help("remove the value"));
        }
        let name = Name { text: name.text.clone(), span: name.span };
        template.shared.push(Shared { section, name, unit: declared.map(|declared| declared.unit) });
    }
    kept
}

/// Entries with their separators.
pub fn entries(tokens: &[Token], separator: char) -> Vec<&[Token]> {
    let (mut depth, mut start, mut entries) = (0_usize, 0, Vec::new());
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            TokenKind::Sign(sign) if sign == separator && depth == 0 => {
                entries.push(&tokens[start..=i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    if start < tokens.len() {
        entries.push(&tokens[start..]);
    }
    entries
}

/// Tokens as words: names with indices and paths through instances become one word each.
fn words(tokens: &[Token], families: &Families, catalogue: &Catalogue<'_>) -> Vec<Word> {
    let mut words: Vec<Word> = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while at < tokens.len() {
        let token = &tokens[at];
        let member = at.checked_sub(1).is_some_and(|before| tokens[before].is_sign('.'));
        let (path, end) = match token.kind {
            TokenKind::Name if !member => path(tokens, at, families, catalogue),
            _ => (None, at + 1),
        };
        let token = match &path {
            None => token.clone(),
            Some(_) => Token {
                kind: TokenKind::Name,
                text: shown(&tokens[at..end]),
                span: token.span.to(tokens[end - 1].span),
            },
        };
        words.push(Word { token, role: None, path });
        at = end;
    }
    words
}

/// The path that begins here, and where it ends.
fn path(
    tokens: &[Token],
    start: usize,
    families: &Families,
    catalogue: &Catalogue<'_>,
) -> (Option<Path>, usize) {
    let mut families = Cow::Borrowed(families);
    let (mut segments, mut at) = (Vec::new(), start);
    while let Some(token) = tokens.get(at).filter(|token| token.kind == TokenKind::Name) {
        at += 1;
        let mut indices = Vec::new();
        while tokens.get(at).is_some_and(|token| token.kind == TokenKind::Open('[')) {
            let Some(length) = closing(&tokens[at..]) else { break };
            indices.push(tokens[at + 1..at + length].to_vec());
            at += length + 1;
        }
        segments.push(Segment { name: Name { text: token.text.clone(), span: token.span }, indices });
        let Some(parts) = families.get(&token.text) else { break };
        let goes_on = tokens.get(at).is_some_and(|token| token.is_sign('.'))
            && tokens.get(at + 1).is_some_and(|token| token.kind == TokenKind::Name);
        if !goes_on {
            break;
        }
        families = Cow::Owned(catalogue.families_of(parts));
        at += 1;
    }
    let plain = segments.len() == 1 && segments[0].indices.is_empty();
    ((!plain).then_some(Path { segments }), at)
}

/// How far the partner of the bracket is that begins here.
fn closing(tokens: &[Token]) -> Option<usize> {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => {
                depth -= 1;
                if depth == 0 {
                    return Some(i);
                }
            }
            _ => {}
        }
    }
    None
}
