//! Converts the input of a macro to the source of a model. Its places are indices of the macro's tokens, so that
//! a message can underline these.

use proc_macro2::{Delimiter, Span as RustSpan, TokenStream, TokenTree};

use hodograph_model::parts::Files;
use hodograph_model::source::Source;
use hodograph_model::span::Span;
use hodograph_model::syntax::lexer::classify_number;
use hodograph_model::syntax::token::{Bad, Token, TokenKind};
use hodograph_model::unicode;

use super::compiler;

/// A model in the input of a macro.
#[derive(Clone, Debug)]
pub struct Inline {
    /// its tokens
    pub source: Source,
    /// their places in the user's source
    places: Vec<RustSpan>,
}

impl Inline {
    /// The model of these tokens. `name` is its name in messages.
    pub fn new(name: impl Into<String>, stream: TokenStream) -> Inline {
        let mut reader = Reader::default();
        reader.read(stream);
        let locations = reader.places.iter().map(|&place| compiler::location(place)).collect();
        Inline { source: Source::inline(name, reader.tokens, locations), places: reader.places }
    }

    /// The same model with the files that it imports.
    pub fn importing(self, files: &dyn Files) -> Inline {
        Inline { source: self.source.importing(files), places: self.places }
    }

    /// The user's tokens at a place: the first and the last. A place in an imported file is represented by
    /// the tokens that use or import it.
    pub fn rust_spans(&self, span: Span) -> Option<(RustSpan, RustSpan)> {
        let span = self.source.in_itself(span);
        let first = self.places.get(span.start as usize).or(self.places.last())?;
        let last = (span.end as usize).checked_sub(1).and_then(|i| self.places.get(i)).unwrap_or(first);
        Some((*first, *last))
    }
}

#[derive(Default)]
struct Reader {
    tokens: Vec<Token>,
    places: Vec<RustSpan>,
}

impl Reader {
    fn push(&mut self, kind: TokenKind, text: String, place: RustSpan) {
        let start = self.tokens.len() as u32;
        self.tokens.push(Token { kind, text, span: Span { start, end: start + 1 } });
        self.places.push(place);
    }

    /// Groups are kept on an explicit stack, since streams may be nested arbitrarily deep.
    fn read(&mut self, stream: TokenStream) {
        let mut open = vec![(stream.into_iter().collect::<Vec<_>>().into_iter().peekable(), None)];
        while let Some((trees, closing)) = open.last_mut() {
            let Some(tree) = trees.next() else {
                if let Some((close, place)) = closing.take() {
                    self.push(TokenKind::Close(close), String::new(), place);
                }
                open.pop();
                continue;
            };
            match tree {
                TokenTree::Ident(name) => {
                    let (text, place) = (name.to_string(), name.span());
                    let raw = text.starts_with("r#");
                    let text = unicode::normal(&text).into_owned();
                    self.push(if raw { TokenKind::Bad(Bad::RawName) } else { TokenKind::Name }, text, place);
                }
                TokenTree::Literal(literal) => self.literal(&literal),
                TokenTree::Punct(sign) if sign.as_char() == '#' => {
                    let inner = matches!(trees.peek(), Some(TokenTree::Punct(p)) if p.as_char() == '!');
                    let bang = if inner { trees.next() } else { None };
                    let words = match trees.peek() {
                        Some(TokenTree::Group(group)) => documentation(group),
                        _ => None,
                    };
                    match words {
                        Some(words) => {
                            let kind = if inner { TokenKind::InnerDoc } else { TokenKind::OuterDoc };
                            let place = trees.next().map_or(sign.span(), |group| group.span());
                            self.push(kind, words, place);
                        }
                        None => {
                            self.push(TokenKind::Sign('#'), String::new(), sign.span());
                            if let Some(bang) = bang {
                                self.push(TokenKind::Sign('!'), String::new(), bang.span());
                            }
                        }
                    }
                }
                TokenTree::Punct(sign) => {
                    self.push(TokenKind::Sign(sign.as_char()), String::new(), sign.span());
                }
                TokenTree::Group(group) => {
                    let pair = match group.delimiter() {
                        Delimiter::Parenthesis => Some(('(', ')')),
                        Delimiter::Bracket => Some(('[', ']')),
                        Delimiter::Brace => Some(('{', '}')),
                        Delimiter::None => None,
                    };
                    if let Some((c, _)) = pair {
                        self.push(TokenKind::Open(c), String::new(), group.span_open());
                    }
                    let trees = group.stream().into_iter().collect::<Vec<_>>().into_iter().peekable();
                    open.push((trees, pair.map(|(_, c)| (c, group.span_close()))));
                }
            }
        }
    }

    fn literal(&mut self, literal: &proc_macro2::Literal) {
        let (text, place) = (literal.to_string(), literal.span());
        // a literal made by another macro may carry its sign
        let text = match text.strip_prefix('-') {
            Some(positive) => {
                self.push(TokenKind::Sign('-'), String::new(), place);
                positive.to_owned()
            }
            None => text,
        };
        if text.starts_with(|c: char| c.is_ascii_digit()) {
            self.push(classify_number(&text), text, place);
        } else {
            self.push(TokenKind::Bad(Bad::Quoted), text, place);
        }
    }
}

/// The words of `[doc = "words"]`.
fn documentation(group: &proc_macro2::Group) -> Option<String> {
    let mut trees = group.stream().into_iter();
    let named = matches!(trees.next()?, TokenTree::Ident(name) if name == "doc");
    let equals = matches!(trees.next()?, TokenTree::Punct(sign) if sign.as_char() == '=');
    match trees.next()? {
        TokenTree::Literal(literal) if named && equals => unquote(&literal.to_string()),
        // inside an invisible group if another macro passed the text on
        TokenTree::Group(group) if named && equals && group.delimiter() == Delimiter::None => {
            unquote(&group.stream().to_string())
        }
        _ => None,
    }
}

/// The content of a string literal.
fn unquote(literal: &str) -> Option<String> {
    if let Some(raw) = literal.strip_prefix('r') {
        return Some(raw.trim_matches('#').strip_prefix('"')?.strip_suffix('"')?.to_owned());
    }
    let inner = literal.strip_prefix('"')?.strip_suffix('"')?;
    let mut out = String::with_capacity(inner.len());
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        match chars.next()? {
            'n' => out.push('\n'),
            'r' => out.push('\r'),
            't' => out.push('\t'),
            '0' => out.push('\0'),
            'x' => {
                let code: String = chars.by_ref().take(2).collect();
                out.push(char::from(u8::from_str_radix(&code, 16).ok()?));
            }
            'u' => {
                let code: String = chars.by_ref().skip(1).take_while(|&c| c != '}').collect();
                out.push(char::from_u32(u32::from_str_radix(&code, 16).ok()?)?);
            }
            other => out.push(other),
        }
    }
    Some(out)
}
