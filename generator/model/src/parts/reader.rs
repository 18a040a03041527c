//! Reads the outline of a file: imports, counts, parts, uses and repetitions, and the tokens of sections.
//! What it cannot read in a mechanism it leaves to the parser of models.

use super::outline::*;
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::suggest;
use crate::syntax::MAX_DEPTH;
use crate::syntax::token::{Bad, Token, TokenKind};
use crate::syntax::tree::{Name, Section};

/// Whether one of the words of [`WORDS`] begins a statement somewhere outside of braces.
pub fn has_parts(tokens: &[Token]) -> bool {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ if depth == 0 && begins(&tokens[i..]) => return true,
            _ => {}
        }
    }
    false
}

/// Whether these tokens begin with a statement of parts.
fn begins(tokens: &[Token]) -> bool {
    let [word, next, ..] = tokens else { return false };
    let names = next.kind == TokenKind::Name;
    match word.text.as_str() {
        _ if word.kind != TokenKind::Name => false,
        "import" => next.kind == TokenKind::Bad(Bad::Quoted),
        "count" | "part" | "use" | "for" => names,
        _ => false,
    }
}

/// A message is on its way.
struct Lost;

/// Reads the outline of a file, whose brackets have partners.
pub fn read(tokens: &[Token], mechanism: bool, mistakes: &mut Vec<Diagnostic>) -> Outline {
    let mut reader = Reader { tokens, at: 0, depth: 0, mistakes };
    let mut outline = Outline::default();
    while reader.peek().is_some() {
        reader.statement(mechanism, &mut outline);
    }
    outline
}

struct Reader<'a> {
    tokens: &'a [Token],
    at: usize,
    depth: usize,
    mistakes: &'a mut Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<&'a Token> {
        self.tokens.get(self.at)
    }

    fn is(&self, kind: TokenKind) -> bool {
        self.peek().is_some_and(|token| token.kind == kind)
    }

    fn take(&mut self, kind: TokenKind) -> bool {
        let there = self.is(kind);
        self.at += usize::from(there);
        there
    }

    fn here(&self) -> Span {
        self.peek().or(self.tokens.last()).map_or(Span::default(), |token| token.span)
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.mistakes.push(diagnostic);
    }

    fn expected(&mut self, what: &str, help: &str) -> Lost {
        let found = self.peek().map_or("the end of the file".to_owned(), Token::describe);
        let message = format!("expected {what}, found {found}");
        let error = Diagnostic::new(codes::EXPECTED, self.here(), message);
        self.report(if help.is_empty() { error } else { error.help(help) });
        Lost
    }

    fn name(&mut self, what: &str, help: &str) -> Result<Name, Lost> {
        match self.peek().filter(|token| token.kind == TokenKind::Name) {
            Some(token) => {
                self.at += 1;
                Ok(Name { text: token.text.clone(), span: token.span })
            }
            None => Err(self.expected(what, help)),
        }
    }

    fn sign(&mut self, kind: TokenKind, what: &str, help: &str) -> Result<(), Lost> {
        if self.take(kind) { Ok(()) } else { Err(self.expected(what, help)) }
    }

    fn word(&mut self, word: &str, help: &str) -> Result<(), Lost> {
        if self.peek().is_some_and(|token| token.is_word(word)) {
            self.at += 1;
            return Ok(());
        }
        Err(self.expected(&format!("`{word}`"), help))
    }

    /// The tokens up to one at which a stretch ends, outside of brackets.
    fn until(&mut self, ends: impl Fn(&[Token]) -> bool) -> Vec<Token> {
        let (start, mut depth) = (self.at, 0_usize);
        while let Some(token) = self.peek() {
            if depth == 0 && (ends(&self.tokens[self.at..]) || matches!(token.kind, TokenKind::Close(_))) {
                break;
            }
            match token.kind {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close(_) => depth -= 1,
                _ => {}
            }
            self.at += 1;
        }
        self.tokens[start..self.at].to_vec()
    }

    /// As [`Reader::until`] a sign; there must be something.
    fn some_until(&mut self, sign: char, what: &str) -> Result<Vec<Token>, Lost> {
        let tokens = self.until(|rest| rest[0].is_sign(sign) || rest[0].is_sign(';'));
        if tokens.is_empty() { Err(self.expected(what, "")) } else { Ok(tokens) }
    }

    /// Passes over a statement that could not be read: to behind its `;` or its braces.
    fn pass_over(&mut self, start: usize) {
        self.at = start;
        let mut depth = 0_usize;
        while let Some(token) = self.peek() {
            match token.kind {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close('}') if depth <= 1 => {
                    self.at += depth;
                    return;
                }
                TokenKind::Close(_) => depth = depth.saturating_sub(1),
                _ => {}
            }
            self.at += 1;
            if depth == 0 && token.is_sign(';') {
                return;
            }
        }
    }

    /// A statement of a file.
    fn statement(&mut self, mechanism: bool, outline: &mut Outline) {
        let start = self.at;
        // documentation belongs to what follows it
        while self.is(TokenKind::OuterDoc) {
            self.at += 1;
        }
        let word = self.peek().filter(|_| begins(&self.tokens[self.at..])).map(|token| token.text.as_str());
        let read = match word {
            Some("import") => self.import().map(|import| outline.imports.push(import)),
            Some("count") if mechanism => self.count().map(|count| outline.counts.push(count)),
            Some("part") => self.part().map(|part| outline.parts.push(part)),
            Some("use") if mechanism => self.instance().map(|item| outline.block.items.push(Item::Use(item))),
            Some("for") if mechanism => {
                self.repetition().map(|item| outline.block.items.push(Item::For(item)))
            }
            _ if mechanism => {
                self.at = start;
                let chunk = self.chunk();
                outline.block.chunks.push(chunk);
                Ok(())
            }
            _ if self.is(TokenKind::InnerDoc) => {
                self.at += 1;
                Ok(())
            }
            _ => {
                let found = self.peek().map_or("the end".to_owned(), Token::describe);
                let message = format!("a file of parts holds `import` and `part` only, found {found}");
                let error = Diagnostic::new(codes::IMPORT, self.here(), message);
                self.report(error.help("put it into a part, or into the mechanism that imports this file"));
                self.at = self.tokens.len();
                return;
            }
        };
        if read.is_err() {
            self.pass_over(start);
            self.at = self.at.max(start + 1);
        }
    }

    /// A section of the mechanism, or what stands before the next one.
    fn chunk(&mut self) -> Chunk {
        if let Some(section) = self.section() {
            return Chunk::Section(section);
        }
        let start = self.at;
        let mut depth = 0_usize;
        while let Some(token) = self.peek() {
            match token.kind {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close(_) => depth = depth.saturating_sub(1),
                _ => {}
            }
            self.at += 1;
            let ends = token.is_sign(';') || token.kind == TokenKind::Close('}');
            if depth == 0 && (ends || self.at_section() || begins(&self.tokens[self.at..])) {
                break;
            }
        }
        Chunk::Other(self.tokens[start..self.at].to_vec())
    }

    fn at_section(&self) -> bool {
        let [word, open, ..] = &self.tokens[self.at..] else { return false };
        open.kind == TokenKind::Open('{')
            && word.kind == TokenKind::Name
            && Section::of_word(&word.text).is_some()
    }

    fn section(&mut self) -> Option<SectionText> {
        if !self.at_section() {
            return None;
        }
        let section = Section::of_word(&self.tokens[self.at].text)?;
        let head = self.tokens[self.at..self.at + 2].to_vec();
        self.at += 2;
        let inner = self.until(|_| false);
        let close = self.peek()?.clone();
        self.at += 1;
        Some(SectionText { section, head, inner, close })
    }

    /// `import "path";`
    fn import(&mut self) -> Result<Import, Lost> {
        let token = &self.tokens[self.at + 1];
        self.at += 2;
        let path = token.text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
        self.sign(TokenKind::Sign(';'), "`;` after the path", "")?;
        match path.filter(|path| !path.contains(['"', '\\'])) {
            Some(path) => Ok(Import { path: path.to_owned(), span: token.span }),
            None => {
                let error = Diagnostic::new(codes::IMPORT, token.span, "this is no path of a file");
                self.report(error.help("write `import \"leg.mech\";`, with `/` between folders"));
                Err(Lost)
            }
        }
    }

    /// `count n = 5;`
    fn count(&mut self) -> Result<Count, Lost> {
        self.at += 1;
        let help = "write `count n = 5;`";
        let name = self.name("the name of a count", help)?;
        self.sign(TokenKind::Sign('='), "`=` and a whole number", help)?;
        let value = self.some_until(';', "a whole number")?;
        self.sign(TokenKind::Sign(';'), "`;`", help)?;
        Ok(Count { name, value })
    }

    /// `part Name(arguments) { .. }`
    fn part(&mut self) -> Result<Part, Lost> {
        self.at += 1;
        let help = "write `part Leg(hip: point of Body) { .. }`";
        let name = self.name("the name of the part", help)?;
        let mut arguments = Vec::new();
        if self.take(TokenKind::Open('(')) {
            while !self.is(TokenKind::Close(')')) {
                arguments.push(self.argument()?);
                if !self.take(TokenKind::Sign(',')) {
                    break;
                }
            }
            self.sign(TokenKind::Close(')'), "`,` or `)`", help)?;
        }
        let block = self.block(help)?;
        Ok(Part { name, arguments, block })
    }

    /// `name: kind`
    fn argument(&mut self) -> Result<Argument, Lost> {
        let help = "an argument is `hip: point of Body`, `base: frame`, `arm: body`, `n: count = 3`, or a \
                    quantity with its unit: `side: 1 = +1`, `length: m`";
        let name = self.name("the name of an argument", help)?;
        self.sign(TokenKind::Sign(':'), "`:` and what the argument is", help)?;
        let word = self.peek().filter(|token| token.kind == TokenKind::Name).map(|token| token.text.as_str());
        let ends = |rest: &[Token]| rest[0].is_sign(',') || rest[0].is_sign('=');
        let kind = match word {
            Some("point") => {
                self.at += 1;
                let belongs = self.peek().is_some_and(|token| token.is_word("of"));
                self.at += usize::from(belongs);
                let of = if belongs { Some(self.name("a name after `of`", help)?) } else { None };
                ArgumentKind::Point { of }
            }
            Some("frame") => {
                self.at += 1;
                ArgumentKind::Frame
            }
            Some("body") => {
                self.at += 1;
                ArgumentKind::Body
            }
            Some("count") => {
                self.at += 1;
                ArgumentKind::Count { default: self.default()? }
            }
            _ => {
                let unit = self.until(ends);
                if unit.is_empty() {
                    return Err(self.expected("what the argument is", help));
                }
                ArgumentKind::Value { unit, default: self.default()? }
            }
        };
        Ok(Argument { name, kind })
    }

    fn default(&mut self) -> Result<Option<Vec<Token>>, Lost> {
        if !self.take(TokenKind::Sign('=')) {
            return Ok(None);
        }
        self.some_until(',', "a value").map(Some)
    }

    /// `use Part as name[index](arguments);`
    fn instance(&mut self) -> Result<Use, Lost> {
        let start = self.here();
        self.at += 1;
        let help = "write `use Leg as front_left(hip: H1 of Trunk);`";
        let part = self.name("the name of a part", help)?;
        self.word("as", help)?;
        let name = self.name("the name of this instance", help)?;
        let mut indices = Vec::new();
        while self.take(TokenKind::Open('[')) {
            indices.push(self.until(|_| false));
            self.sign(TokenKind::Close(']'), "`]`", help)?;
        }
        let mut actuals = Vec::new();
        let has_brackets = self.take(TokenKind::Open('('));
        if has_brackets {
            while !self.is(TokenKind::Close(')')) {
                let name = self.name("the name of an argument", help)?;
                self.sign(TokenKind::Sign(':'), "`:` and what is given", help)?;
                let tokens = self.some_until(',', "what is given")?;
                actuals.push(Actual { name, tokens });
                if !self.take(TokenKind::Sign(',')) {
                    break;
                }
            }
            self.sign(TokenKind::Close(')'), "`,` or `)`", help)?;
        }
        let span = start.to(self.tokens[self.at - 1].span);
        self.sign(TokenKind::Sign(';'), "`;` after the use", help)?;
        Ok(Use { part, name, indices, actuals, has_brackets, span })
    }

    /// `for i in from..to { .. }`
    fn repetition(&mut self) -> Result<For, Lost> {
        let start = self.here();
        self.at += 1;
        let help = "write `for i in 1..n { .. }`: i takes the values 1, 2, .. n";
        let variable = self.name("the name of the index", help)?;
        self.word("in", help)?;
        let dots = |rest: &[Token]| rest[0].is_sign('.') && rest.get(1).is_some_and(|next| next.is_sign('.'));
        let from = self.until(|rest| dots(rest) || rest[0].kind == TokenKind::Open('{'));
        if from.is_empty() || !dots(&self.tokens[self.at..]) {
            return Err(self.expected("a range such as `1..n`", help));
        }
        self.at += 2;
        if self.is(TokenKind::Sign('=')) {
            return Err(self.expected("the last value of the index", "`1..n` holds n: there is no `..=`"));
        }
        let to = self.until(|rest| rest[0].kind == TokenKind::Open('{') || rest[0].is_sign(';'));
        if to.is_empty() {
            return Err(self.expected("the last value of the index", help));
        }
        let span = start.to(self.tokens[self.at - 1].span);
        let block = self.block(help)?;
        Ok(For { variable, from, to, block, span })
    }

    /// `{ sections, uses and repetitions }`
    fn block(&mut self, help: &str) -> Result<Block, Lost> {
        self.sign(TokenKind::Open('{'), "`{`", help)?;
        self.depth += 1;
        let mut block = Block::default();
        let result = loop {
            if self.depth > MAX_DEPTH {
                let error = Diagnostic::new(codes::TOO_DEEP, self.here(), "braces are nested too deeply");
                self.report(error);
                break Err(Lost);
            }
            let start = self.at;
            while matches!(
                self.peek().map(|token| token.kind),
                Some(TokenKind::OuterDoc | TokenKind::InnerDoc)
            ) {
                self.at += 1;
            }
            if self.take(TokenKind::Close('}')) || self.peek().is_none() {
                break Ok(());
            }
            let word = self.peek().filter(|_| begins(&self.tokens[self.at..])).map(|word| word.text.as_str());
            let read = match word {
                Some("use") => self.instance().map(|item| block.items.push(Item::Use(item))),
                Some("for") => self.repetition().map(|item| block.items.push(Item::For(item))),
                _ => match self.section() {
                    Some(section) => {
                        block.chunks.push(Chunk::Section(section));
                        Ok(())
                    }
                    None => Err(self.stray()),
                },
            };
            if read.is_err() {
                self.pass_over(start);
                self.at = self.at.max(start + 1);
            }
        };
        self.depth -= 1;
        result.map(|()| block)
    }

    /// What cannot stand in a part.
    fn stray(&mut self) -> Lost {
        let Some(token) = self.peek() else { return Lost };
        let word = token.text.as_str();
        if token.kind == TokenKind::Name && WORDS.contains(&word) {
            let message = format!("`{word}` stands outside of parts only");
            let error = Diagnostic::new(codes::EXPECTED, token.span, message);
            self.report(error.help("a part holds sections, `use` and `for`"));
            return Lost;
        }
        let opens = self.tokens.get(self.at + 1).is_some_and(|next| next.kind == TokenKind::Open('{'));
        if token.kind == TokenKind::Name && opens {
            let message = format!("there is no section `{word}`");
            let error = Diagnostic::new(codes::SECTION_UNKNOWN, token.span, message);
            let near = suggest::nearest(word, Section::ALL.map(Section::word).into_iter());
            self.report(match near {
                Some(near) => error.did_you_mean(near),
                None => error.help("a part holds the sections of a mechanism, `use` and `for`"),
            });
            return Lost;
        }
        self.expected("a section, `use`, `for` or `}`", "")
    }
}
