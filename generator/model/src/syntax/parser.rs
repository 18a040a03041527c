//! The cursor of the parser: reads tokens, reports what is missing, and continues after it.

use std::borrow::Cow;
use std::collections::HashSet;

use super::token::{Bad, Token, TokenKind};
use super::tree::{Name, Section, Tree};
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::span::Span;
use crate::unicode;

/// Brackets, signs and exponents may be nested this deep.
pub const MAX_DEPTH: usize = 64;
/// The parser gives up after this number of messages.
const MAX_ERRORS: usize = 200;

/// Reads a model. The tree holds all that could be read.
pub fn parse(tokens: &[Token]) -> (Tree, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let tokens = in_latin(tokens, &mut diagnostics);
    let tokens: Vec<&Token> = tokens.iter().filter(|token| readable(token, &mut diagnostics)).collect();
    let nesting = match balanced(&tokens) {
        Ok(nesting) => nesting,
        Err(error) => {
            // a comment that is never closed takes the brackets with it
            if diagnostics.iter().all(|d| d.code != codes::UNBALANCED) {
                diagnostics.push(*error);
            }
            return (Tree { incomplete: true, ..Tree::default() }, diagnostics);
        }
    };
    let incomplete = diagnostics.iter().any(|d| d.code == codes::UNBALANCED);
    let tree = Tree { incomplete, ..Tree::default() };
    let mut parser = Parser { tokens, nesting, at: 0, depth: 0, tree, diagnostics };
    parser.model();
    (parser.tree, parser.diagnostics)
}

/// Words in which Cyrillic letters stand among Latin ones are refused, each once, and then read as they look:
/// it is one mistake.
fn in_latin<'t>(tokens: &'t [Token], diagnostics: &mut Vec<Diagnostic>) -> Cow<'t, [Token]> {
    let is_mixed = |token: &Token| token.kind == TokenKind::Name && unicode::mixed(&token.text).is_some();
    if !tokens.iter().any(is_mixed) {
        return Cow::Borrowed(tokens);
    }
    let mut seen = HashSet::new();
    let mut tokens = tokens.to_vec();
    for token in tokens.iter_mut().filter(|token| token.kind == TokenKind::Name) {
        let Some(found) = unicode::mixed(&token.text) else { continue };
        if seen.insert(token.text.clone()) && diagnostics.len() < MAX_ERRORS {
            let message = format!("`{}` has a {} letter among Latin ones", token.text, found.script);
            diagnostics.push(Diagnostic::new(codes::BAD_TOKEN, token.span, message).help(found.advice()));
        }
        token.text = found.latin;
    }
    Cow::Owned(tokens)
}

/// Reports a bad token; the value says whether this one is to be read.
fn readable(token: &Token, diagnostics: &mut Vec<Diagnostic>) -> bool {
    let TokenKind::Bad(bad) = token.kind else { return true };
    if diagnostics.len() >= MAX_ERRORS {
        return false;
    }
    let shown: String = token.text.chars().take(40).collect();
    let (code, message, help) = match bad {
        Bad::Character => (
            codes::BAD_TOKEN,
            format!("`{}` cannot be part of a model", shown.escape_debug()),
            match shown.as_str() {
                "°" => "declare the quantity in `deg`, as in `q1: deg = 30`",
                "×" | "·" | "⋅" => "write `*` for a product, `dot(v, w)` or `cross(v, w)` for vectors",
                "²" => "write `^2`",
                "³" => "write `^3`",
                "−" | "–" => "write the plain minus sign `-`",
                "，" | "、" | "‚" => "write the plain comma `,`",
                "；" | "\u{37e}" => "write the plain semicolon `;`",
                "：" | "∶" => "write the plain colon `:`",
                "＝" => "write the plain equals sign `=`",
                "“" | "”" | "„" | "‘" | "’" | "«" | "»" | "`" => "names stand without quotes",
                _ if shown.chars().all(unicode::is_invisible) => {
                    "remove this character, which cannot be seen"
                }
                _ => "names begin with a letter; comments begin with `//`",
            },
        ),
        Bad::Digits => (
            codes::BAD_NUMBER,
            format!("`{shown}` is not a plain decimal number"),
            "numbers are written with the digits 0 to 9; a fraction is a quotient such as `1/2`",
        ),
        Bad::Quoted => {
            (codes::BAD_TOKEN, "a model has no quoted text".to_owned(), "names stand without quotes")
        }
        Bad::RawName => {
            (codes::BAD_TOKEN, format!("`{shown}` is a raw name"), "use a name that is no Rust keyword")
        }
        Bad::OpenComment => {
            (codes::UNBALANCED, "this comment is never closed".to_owned(), "close it with `*/`")
        }
        Bad::Number => (
            codes::BAD_NUMBER,
            format!("`{shown}` is not a plain decimal number"),
            "numbers look like `3`, `0.5` or `1e-3`: decimal, without `_` and without a suffix",
        ),
        Bad::NumberThenName => (
            codes::BAD_NUMBER,
            format!("`{shown}` runs a number and a name together"),
            if shown.contains('·') {
                "write `*` for a product"
            } else {
                "write `*` between a number and a name; a name begins with a letter; units stand in declarations only"
            },
        ),
    };
    diagnostics.push(Diagnostic::new(code, token.span, message).help(help));
    // these hold the place of something that belongs there
    matches!(bad, Bad::Number | Bad::NumberThenName | Bad::Quoted | Bad::RawName)
}

/// Brackets must have partners before anything can be said about what is between them. Gives the number of
/// brackets around each token.
fn balanced(tokens: &[&Token]) -> Result<Vec<u32>, Box<Diagnostic>> {
    let mut open: Vec<(char, Span)> = Vec::new();
    // how many of them are those of a part or a repetition, in which sections stand
    let mut blocks = 0;
    let mut nesting = Vec::with_capacity(tokens.len());
    // the last place at which, judging by the names of sections, a brace should already have been closed
    let mut suspect = None;
    for (i, token) in tokens.iter().enumerate() {
        let closes = usize::from(matches!(token.kind, TokenKind::Close(_)));
        nesting.push(open.len().saturating_sub(closes) as u32);
        match token.kind {
            TokenKind::Open(c) => {
                blocks += usize::from(c == '{' && blocks == open.len() && opens_block(&tokens[..i]));
                open.push((c, token.span));
            }
            TokenKind::Name if suspect.is_none() && open.len() > blocks => {
                let opens = tokens.get(i + 1).is_some_and(|next| next.kind == TokenKind::Open('{'));
                if opens && Section::of_word(&token.text).is_some() {
                    suspect = open.last().map(|&(c, span)| (c, span, token.span));
                }
            }
            TokenKind::Close(c) => {
                let partner = match c {
                    ')' => '(',
                    ']' => '[',
                    _ => '{',
                };
                let closed = open.pop();
                blocks = blocks.min(open.len());
                match closed {
                    Some((o, _)) if o == partner => {}
                    Some((o, span)) => {
                        let message = format!("`{c}` does not close `{o}`");
                        let error = Diagnostic::new(codes::UNBALANCED, token.span, message)
                            .label(format!("`{}` is expected before this", closing(o)))
                            .related(span, "opened here");
                        return Err(Box::new(error));
                    }
                    None => {
                        let message = format!("`{c}` without `{partner}`");
                        let error = Diagnostic::new(codes::UNBALANCED, token.span, message)
                            .help("remove it, or find the bracket that is missing before it");
                        return Err(Box::new(error));
                    }
                }
            }
            _ => {}
        }
    }
    let unclosed =
        |c: char, span: Span| Diagnostic::new(codes::UNBALANCED, span, format!("this `{c}` is never closed"));
    match (suspect, open.last()) {
        (Some((c, span, before)), Some(_)) => {
            let missing = format!("`{}` is missing before this section", closing(c));
            Err(Box::new(unclosed(c, span).related(before, missing)))
        }
        (None, Some(&(c, span))) => {
            Err(Box::new(unclosed(c, span).help(format!("add the missing `{}`", closing(c)))))
        }
        (_, None) => Ok(nesting),
    }
}

/// Whether the statement that these tokens end with begins a part or a repetition.
fn opens_block(tokens: &[&Token]) -> bool {
    let ends = |token: &&Token| {
        token.is_sign(';') || matches!(token.kind, TokenKind::Open('{') | TokenKind::Close('}'))
    };
    let start = tokens.iter().rposition(ends).map_or(0, |end| end + 1);
    let first = tokens[start..].iter().find(|token| token.kind != TokenKind::OuterDoc);
    first.is_some_and(|word| word.is_word("part") || word.is_word("for"))
}

fn closing(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// A message is on its way; the caller finds the next place from which to read on.
pub(super) struct Lost;

pub(super) struct Parser<'a> {
    pub(super) tokens: Vec<&'a Token>,
    pub(super) nesting: Vec<u32>,
    pub(super) at: usize,
    pub(super) depth: usize,
    pub(super) tree: Tree,
    pub(super) diagnostics: Vec<Diagnostic>,
}

impl<'a> Parser<'a> {
    pub(super) fn peek(&self) -> Option<&'a Token> {
        self.tokens.get(self.at).copied()
    }

    pub(super) fn peek_at(&self, ahead: usize) -> Option<&'a Token> {
        self.tokens.get(self.at + ahead).copied()
    }

    /// Where the next token stands; behind the last one at the end.
    pub(super) fn here(&self) -> Span {
        match self.peek() {
            Some(token) => token.span,
            None => self.tokens.last().map_or(Span::default(), |token| token.span),
        }
    }

    /// Where the token before stands.
    pub(super) fn before(&self) -> Span {
        match self.at.checked_sub(1).and_then(|i| self.tokens.get(i)) {
            Some(token) => token.span,
            None => self.here(),
        }
    }

    pub(super) fn before_is(&self, sign: char) -> bool {
        self.at.checked_sub(1).and_then(|i| self.tokens.get(i)).is_some_and(|token| token.is_sign(sign))
    }

    /// How many brackets are around the next token.
    pub(super) fn nesting(&self) -> u32 {
        self.nesting.get(self.at).copied().unwrap_or(0)
    }

    pub(super) fn found(&self) -> String {
        self.peek().map_or("the end of the model".to_owned(), |token| token.describe())
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.len() < MAX_ERRORS {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Says what to do about the mistake that was reported last.
    pub(super) fn advise(&mut self, help: String) {
        if let Some(error) = self.diagnostics.last_mut() {
            error.help = Some(help);
        }
    }

    pub(super) fn is_sign(&self, sign: char) -> bool {
        self.peek().is_some_and(|token| token.is_sign(sign))
    }

    pub(super) fn is_word(&self, word: &str) -> bool {
        self.peek().is_some_and(|token| token.is_word(word))
    }

    pub(super) fn is_open(&self, open: char) -> bool {
        self.peek().is_some_and(|token| token.kind == TokenKind::Open(open))
    }

    /// Whether what stands here could be multiplied.
    pub(super) fn at_operand(&self) -> bool {
        self.peek().is_some_and(|token| {
            matches!(token.kind, TokenKind::Name | TokenKind::Number | TokenKind::Open('('))
        })
    }

    pub(super) fn is_close(&self) -> bool {
        self.peek().is_none_or(|token| matches!(token.kind, TokenKind::Close(_)))
    }

    pub(super) fn take_sign(&mut self, sign: char) -> bool {
        let there = self.is_sign(sign);
        self.at += usize::from(there);
        there
    }

    pub(super) fn take_word(&mut self, word: &str) -> Option<Name> {
        if self.is_word(word) { self.take_name() } else { None }
    }

    pub(super) fn take_name(&mut self) -> Option<Name> {
        let token = self.peek().filter(|token| token.kind == TokenKind::Name)?;
        self.at += 1;
        Some(Name { text: token.text.clone(), span: token.span })
    }

    /// `what` completes "expected ..".
    pub(super) fn expected(&mut self, what: &str) -> Lost {
        let message = format!("expected {what}, found {}", self.found());
        let error = Diagnostic::new(codes::EXPECTED, self.here(), message);
        self.report(match self.peek().map(|token| token.kind) {
            // a message says so already
            Some(TokenKind::Bad(_)) => return Lost,
            None => error.label("the model ends here"),
            Some(TokenKind::Sign('\'')) if what.starts_with("the name") => {
                error.help("names stand without quotes")
            }
            Some(TokenKind::Sign('\'')) => error.help("a time derivative is written `d(q1)/dt`"),
            Some(TokenKind::Sign('#' | '%')) if what.starts_with("the name") || what.starts_with("a ") => {
                error.help("comments begin with `//`")
            }
            Some(TokenKind::Sign('%')) => error.help("there is no remainder; the operators are + - * / ^"),
            Some(TokenKind::Sign('|')) => error.help("the magnitude is `abs(x)`, of a vector `norm(v)`"),
            Some(TokenKind::Open('{')) if what == "an expression" => {
                error.help("parts of an expression are grouped by `(` and `)`")
            }
            Some(TokenKind::Sign('.')) if what == "an expression" => {
                error.help("a number has a digit before its point, as `0.5`")
            }
            Some(TokenKind::Sign(':')) if what.starts_with("`=`") => {
                let here = self.here();
                error.fix(Place::Replace(here), "=")
            }
            Some(TokenKind::Sign('=')) if what.starts_with("`:`") => {
                let here = self.here();
                error.fix(Place::Replace(here), ":")
            }
            Some(TokenKind::Sign('=')) if self.before_is('=') => error.help("an equation has one `=`"),
            Some(TokenKind::Sign('<' | '>')) => error.help("there are no inequalities in a model"),
            Some(_) => match cure(what) {
                Some(help) => error.help(help),
                None => error,
            },
        });
        Lost
    }

    pub(super) fn name(&mut self, what: &str) -> Result<Name, Lost> {
        match self.take_name() {
            Some(name) => Ok(name),
            None => Err(self.expected(what)),
        }
    }

    pub(super) fn sign(&mut self, sign: char, why: &str) -> Result<(), Lost> {
        if self.take_sign(sign) {
            return Ok(());
        }
        Err(self.expected(&format!("`{sign}`{why}")))
    }

    pub(super) fn open(&mut self, open: char, why: &str) -> Result<(), Lost> {
        if self.is_open(open) {
            self.at += 1;
            return Ok(());
        }
        Err(self.expected(&format!("`{open}`{why}")))
    }

    /// Brackets are balanced, so a bracket that closes can only be the one that was opened.
    pub(super) fn close(&mut self, why: &str) -> Result<(), Lost> {
        match self.peek() {
            Some(token) if matches!(token.kind, TokenKind::Close(_)) => {
                self.at += 1;
                Ok(())
            }
            _ => Err(self.expected(why)),
        }
    }

    /// Passes over what cannot be read: to the sign that separates entries at this nesting (which is passed)
    /// or to the bracket that closes them (which is not).
    pub(super) fn skip_entry(&mut self, separator: char, nesting: u32) {
        while let Some(token) = self.peek() {
            if self.nesting() < nesting {
                return;
            }
            self.at += 1;
            if token.is_sign(separator) && self.nesting[self.at - 1] == nesting {
                return;
            }
        }
    }

    /// Passes over a bracket and all in it.
    pub(super) fn skip_group(&mut self) {
        let mut depth = 0_usize;
        while let Some(token) = self.peek() {
            self.at += 1;
            match token.kind {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close(_) => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                return;
            }
        }
    }

    /// The documentation that stands here, lines joined.
    pub(super) fn docs(&mut self) -> String {
        let mut docs = Docs::default();
        while let Some(token) = self.peek().filter(|token| token.kind == TokenKind::OuterDoc) {
            docs.line(&token.text);
            self.at += 1;
        }
        if !docs.0.is_empty() && self.is_close() {
            let error =
                Diagnostic::new(codes::STRAY_DOCS, self.before(), "there is no entry that this documents")
                    .help("`///` stands before what it documents; `//` begins a plain comment");
            self.report(error);
        }
        docs.0
    }
}

/// What to write where this was expected.
fn cure(what: &str) -> Option<String> {
    let begins = |with: &str| what.starts_with(with);
    let help = if what == "an expression" {
        "an expression consists of numbers, names, functions and `+ - * / ^`"
    } else if begins("the name of an axis") {
        "as in `N.x`, `N.rotate(z, q)` or `N.vec(a, b, c)`"
    } else if begins("the name") || begins("a name") {
        "names begin with a letter, and consist of letters, digits and `_`"
    } else if begins("`:` after the name of a field") {
        "a field is written `name: value`"
    } else {
        return begins("a section")
            .then(|| format!("the sections are {}", Section::ALL.map(Section::word).join(", ")));
    };
    Some(help.to_owned())
}

/// Lines of documentation on their way to one text.
#[derive(Default)]
pub(super) struct Docs(pub(super) String);

impl Docs {
    pub(super) fn line(&mut self, words: &str) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        self.0.push_str(words.strip_prefix(' ').unwrap_or(words).trim_end());
    }
}
