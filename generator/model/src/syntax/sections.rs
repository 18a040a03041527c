//! Parses sections as lists of entries: their separators, and recovery after an entry that cannot be parsed.

use super::parser::{Lost, Parser};
use super::token::TokenKind;
use super::tree::*;
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::span::Span;

impl Parser<'_> {
    /// All entries of a section; stops before the closing brace.
    pub(super) fn entries(&mut self, section: Section) {
        use Section::*;
        let separator = match section {
            Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Shapes
            | Contacts => ',',
            _ => ';',
        };
        let nesting = self.nesting();
        while self.nesting() >= nesting && !self.is_close() {
            let start = self.at;
            if self.take_sign(separator) {
                let message = format!("there is nothing between this `{separator}` and the one before");
                self.report(Diagnostic::new(codes::EXPECTED, self.before(), message).help("remove it"));
                continue;
            }
            let read = self.entry(section);
            let result = match read {
                Ok(()) if separator == ',' => self.comma(false),
                Ok(()) => self.semicolon(),
                Err(_) => Err(Lost),
            };
            if read.is_ok() && result.is_err() {
                self.doubt_last(section);
            }
            if result.is_err() {
                self.skip_entry(separator, nesting);
                let declares = !matches!(
                    section,
                    Section::Loads | Section::Kinematics | Section::Constraints | Section::Configuration
                );
                // whose declaration was lost is not known
                if !self.broken(start, nesting) && declares {
                    self.tree.incomplete = true;
                }
            }
            if self.at == start {
                self.at += 1;
            }
        }
    }

    /// Declares the names of an entry that could not be read: the first, and whatever stands before a `:`,
    /// `=` or `{`. Returns whether it begins with one.
    fn broken(&mut self, start: usize, nesting: u32) -> bool {
        let passed = start..self.at.min(self.tokens.len());
        let (mut first, mut named) = (true, false);
        for i in passed {
            let token = self.tokens[i];
            if token.kind == TokenKind::OuterDoc {
                continue;
            }
            let begins = std::mem::replace(&mut first, false);
            if token.kind != TokenKind::Name || self.nesting[i] != nesting {
                continue;
            }
            let declares = self
                .tokens
                .get(i + 1)
                .is_some_and(|next| matches!(next.kind, TokenKind::Sign(':' | '=') | TokenKind::Open('{')));
            if begins && !declares && (token.is_word("fixed") || token.is_word("dependent")) {
                first = true;
                continue;
            }
            named |= begins && !token.is_word("of");
            if begins || declares {
                self.tree.broken.push(Name { text: token.text.clone(), span: token.span });
            }
        }
        named
    }

    /// The value that was read last goes on behind what was read of it: what it means is not known.
    fn doubt_last(&mut self, section: Section) {
        use Section::*;
        let tree = &mut self.tree;
        let value = match section {
            Definitions => tree.definitions.last_mut().map(|entry| &mut entry.value),
            Frames => tree.frames.last_mut().map(|entry| &mut entry.value),
            AngularVelocities => tree.angular_velocities.last_mut().map(|entry| &mut entry.value),
            Points => tree.points.last_mut().map(|entry| &mut entry.value),
            Velocities => tree.velocities.last_mut().map(|entry| &mut entry.value),
            Loads => tree.loads.last_mut().and_then(|entry| entry.value.as_mut()),
            Kinematics => tree.kinematics.last_mut().map(|entry| &mut entry.right),
            Constraints => tree.constraints.last_mut().map(|entry| &mut entry.right),
            Configuration => tree.configuration.last_mut().map(|entry| &mut entry.right),
            Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Shapes
            | Contacts => None,
        };
        if let Some(value) = value {
            value.kind = ExprKind::Error;
        }
    }

    /// Documentation behind what it is meant for.
    fn trailing_docs(&mut self) {
        let documents = |token: &super::token::Token| token.kind == TokenKind::OuterDoc;
        let ahead = self.tokens[self.at..].iter().take_while(|token| documents(token)).count();
        let closes = self.peek_at(ahead).is_none_or(|token| matches!(token.kind, TokenKind::Close(_)));
        if ahead > 0 && closes {
            self.docs();
        }
    }

    pub(super) fn comma(&mut self, of_fields: bool) -> Result<(), Lost> {
        self.trailing_docs();
        if self.is_close() || self.take_sign(',') {
            return Ok(());
        }
        self.missing(',', of_fields)
    }

    pub(super) fn semicolon(&mut self) -> Result<(), Lost> {
        self.trailing_docs();
        if self.take_sign(';') {
            return Ok(());
        }
        self.missing(';', false)
    }

    /// A separator is missing. If what follows can begin an entry, reading goes on there.
    fn missing(&mut self, separator: char, of_fields: bool) -> Result<(), Lost> {
        let other = if separator == ',' { ';' } else { ',' };
        let found = self.found();
        if self.is_sign(other) {
            let error = Diagnostic::new(
                codes::EXPECTED,
                self.here(),
                format!("expected `{separator}`, found `{other}`"),
            )
            .help("declarations are separated by commas, statements end with semicolons");
            self.report(error);
            // `N,x` for `N.x`: what follows is no entry
            let goes_on = |next: &&super::token::Token| match next.kind {
                TokenKind::Sign(sign) => !matches!(sign, ':' | '='),
                kind => matches!(kind, TokenKind::Open('(') | TokenKind::Close(_)),
            };
            let operand = self.peek_at(1).is_some_and(|token| token.kind == TokenKind::Name);
            if operand && self.peek_at(2).as_ref().is_some_and(goes_on) {
                let before = self.at.checked_sub(1).and_then(|i| self.tokens.get(i));
                if let (Some(frame), Some(axis)) = (before, self.peek_at(1))
                    && frame.kind == TokenKind::Name
                    && ["x", "y", "z"].contains(&axis.text.as_str())
                {
                    self.advise(format!("did you mean `{}.{}`?", frame.text, axis.text));
                }
                return Err(Lost);
            }
            self.at += 1;
            return Ok(());
        }
        let mut error =
            Diagnostic::new(codes::EXPECTED, self.before(), format!("expected `{separator}`, found {found}"))
                .label(format!("`{separator}` is missing after this"));
        let begins = match self.peek().map(|token| token.kind) {
            Some(TokenKind::OuterDoc) => true,
            Some(TokenKind::Name) => self.peek_at(1).is_some_and(|next| {
                let joins = matches!(next.kind, TokenKind::Sign('=' | ':') | TokenKind::Open('{'));
                joins || !of_fields && (next.is_word("of") || next.is_word("in"))
            }),
            _ => false,
        };
        let after = self.at.checked_sub(1).and_then(|i| self.tokens.get(i));
        if after.is_some_and(|token| token.is_word("if")) {
            error =
                error.help("there are no conditions in a model; `min`, `max`, `abs` and `sign` make steps");
        } else if self.at_operand() && !begins {
            error = error.help("or is an operator missing? A product is written `a*b`");
        } else if self.is_open('[') {
            error = error.help("there are no indices; the axes of a frame are `B.x`, `B.y` and `B.z`");
        }
        if self.is_close() || begins {
            let after = Span { start: self.before().end, end: self.before().end };
            self.report(error.fix(Place::Replace(after), separator.to_string()));
            return Ok(());
        }
        self.report(error);
        Err(Lost)
    }

    /// A word before the name that an entry begins with, as in `let x = ..` or `const m: kg`: said, and
    /// passed over.
    pub(super) fn stray_word(&mut self, section: Section) {
        use Section::*;
        let begins = |kind| match section {
            Parameters | Inputs | Coordinates | Speeds | Dependent => kind == TokenKind::Sign(':'),
            Definitions | Frames | Points | Velocities => kind == TokenKind::Sign('='),
            Bodies | Particles | Shapes | Contacts => kind == TokenKind::Open('{'),
            _ => false,
        };
        let [Some(word), Some(name), Some(sign)] = [0, 1, 2].map(|ahead| self.peek_at(ahead)) else { return };
        let modifies = word.is_word("fixed") || word.is_word("dependent");
        if word.kind != TokenKind::Name || name.kind != TokenKind::Name || !begins(sign.kind) || modifies {
            return;
        }
        if word.is_word("of") {
            let error = Diagnostic::new(codes::EXPECTED, word.span, "a name is missing before `of`");
            self.report(error.help(format!("write `P of {} = ..` for a point P", name.text)));
            self.tree.incomplete = true;
            self.tree.doubtful.push(name.span);
            self.at += 1;
            return;
        }
        let message = format!("`{}` cannot stand before `{}`", word.text, name.text);
        let help =
            if matches!(section, Parameters) && matches!(word.text.as_str(), "const" | "static" | "final") {
                format!(
                    "remove it, or write `fixed {}` for a parameter that is folded in at build time",
                    name.text
                )
            } else {
                "remove it: an entry begins with its name".to_owned()
            };
        self.report(Diagnostic::new(codes::EXPECTED, word.span, message).help(help));
        self.tree.broken.push(Name { text: word.text.clone(), span: word.span });
        self.tree.doubtful.push(name.span);
        self.at += 1;
    }
}
