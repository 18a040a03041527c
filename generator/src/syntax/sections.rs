//! Sections and what stands in them.

use super::parser::{Docs, Lost, Parser};
use super::token::TokenKind;
use super::tree::*;
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::model::similar;

impl Parser<'_> {
    /// The whole model.
    pub(super) fn model(&mut self) {
        let mut docs = Docs::default();
        while let Some(token) = self.peek() {
            match token.kind {
                TokenKind::InnerDoc => docs.line(&token.text),
                TokenKind::OuterDoc => {
                    let error = Diagnostic::new(
                        codes::STRAY_DOCS,
                        token.span,
                        "`///` does not document the mechanism",
                    )
                    .help("the documentation of the mechanism begins with `//!`");
                    self.report(error);
                }
                _ => break,
            }
            self.at += 1;
        }
        self.tree.docs = docs.0;
        if self.header().is_err() {
            while self.peek().is_some_and(|t| !t.is_sign(';') && Section::of_word(&t.text).is_none()) {
                self.at += 1;
            }
            self.take_sign(';');
        }
        while self.peek().is_some() {
            self.section();
        }
    }

    fn header(&mut self) -> Result<(), Lost> {
        if !self.is_word("mechanism") {
            let message = format!("a model begins with `mechanism Name;`, found {}", self.found());
            let error = Diagnostic::new(codes::EXPECTED, self.here(), message)
                .help("write `mechanism Name;` before the first section");
            self.report(error);
            return Err(Lost);
        }
        self.at += 1;
        self.tree.name = Some(self.name("the name of the mechanism")?);
        self.semicolon()
    }

    fn section(&mut self) {
        let docs = self.docs();
        let Some(token) = self.peek() else { return };
        if token.kind == TokenKind::InnerDoc {
            let error =
                Diagnostic::new(codes::STRAY_DOCS, token.span, "`//!` stands at the top of a model only")
                    .help("use `///` before what you document, or `//` for a plain comment");
            self.report(error);
            self.at += 1;
            return;
        }
        let section = Section::of_word(&token.text).filter(|_| token.kind == TokenKind::Name);
        let opens = self.peek_at(1).is_some_and(|next| next.kind == TokenKind::Open('{'));
        let Some(section) = section else {
            self.no_section(opens);
            return;
        };
        if !docs.is_empty() {
            let error =
                Diagnostic::new(codes::STRAY_DOCS, self.before(), "a section is not documented with `///`")
                    .help("use `//` for a plain comment");
            self.report(error);
        }
        self.at += 1;
        self.body(section, token.span);
    }

    /// What follows the word of a section.
    fn body(&mut self, section: Section, span: Span) {
        self.order(section, span);
        if self.open('{', &format!(" after `{}`", section.word())).is_err() {
            return;
        }
        self.entries(section);
        // the closing brace; what is before it has been read or passed over
        self.at += 1;
    }

    fn no_section(&mut self, opens: bool) {
        let Some(token) = self.peek() else { return };
        let (span, kind) = (token.span, token.kind);
        if kind == TokenKind::Name {
            let words = Section::ALL.map(Section::word);
            let error = Diagnostic::new(
                codes::SECTION_UNKNOWN,
                span,
                format!("there is no section `{}`", token.text),
            );
            let near = similar::nearest(&token.text, words.into_iter());
            let error = match near {
                Some(word) => error.help(format!("did you mean `{word}`?")),
                None => error.help(format!("the sections are {}", words.join(", "))),
            };
            self.report(error);
            // read on as if it had been written right
            if let Some(section) = near.and_then(Section::of_word).filter(|_| opens) {
                self.at += 1;
                self.body(section, span);
                return;
            }
        } else {
            self.expected("a section such as `parameters { .. }`");
        }
        self.tree.incomplete = true;
        self.at += usize::from(!matches!(kind, TokenKind::Open(_)));
        // pass over to behind the next braces, or to the next section
        if opens || matches!(kind, TokenKind::Open(_)) {
            self.skip_group();
            return;
        }
        while let Some(token) = self.peek() {
            let opens = self.peek_at(1).is_some_and(|next| next.kind == TokenKind::Open('{'));
            if token.kind == TokenKind::Name && opens && Section::of_word(&token.text).is_some() {
                return;
            }
            if matches!(token.kind, TokenKind::Open(_)) {
                self.skip_group();
                return;
            }
            self.at += 1;
        }
    }

    fn order(&mut self, section: Section, span: Span) {
        if let Some(&(_, first)) = self.tree.sections.iter().find(|(s, _)| *s == section) {
            let message = format!("the section `{}` appears twice", section.word());
            let error = Diagnostic::new(codes::SECTION_TWICE, span, message)
                .related(first, "first here")
                .help("put all entries into one section");
            self.report(error);
        } else if let Some(&(before, place)) = self.tree.sections.iter().find(|(s, _)| *s > section) {
            let message = format!("`{}` stands after `{}`", section.word(), before.word());
            let error = Diagnostic::new(codes::SECTION_ORDER, span, message)
                .label(format!("this belongs before `{}`", before.word()))
                .related(place, format!("`{}` is here", before.word()))
                .help("sections stand in a fixed order; move this one up");
            self.report(error);
        }
        self.tree.sections.push((section, span));
    }

    /// All entries of a section; stops before the closing brace.
    fn entries(&mut self, section: Section) {
        use Section::*;
        let separator = match section {
            Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Contacts => ',',
            _ => ';',
        };
        let nesting = self.nesting();
        while self.nesting() >= nesting && !self.is_close() {
            let start = self.at;
            let result = match self.entry(section) {
                Ok(()) if separator == ',' => self.comma(),
                Ok(()) => self.semicolon(),
                Err(lost) => {
                    self.broken(start);
                    Err(lost)
                }
            };
            if result.is_err() {
                self.skip_entry(separator, nesting);
            }
            if self.at == start {
                self.at += 1;
            }
        }
    }

    /// An entry that could not be read still declares its name.
    fn broken(&mut self, start: usize) {
        let words = self.tokens[start..].iter().take(40);
        let name = words
            .skip_while(|t| t.kind == TokenKind::OuterDoc || t.is_word("fixed") || t.is_word("dependent"))
            .find(|_| true)
            .filter(|token| token.kind == TokenKind::Name);
        if let Some(token) = name {
            self.tree.broken.push(Name { text: token.text.clone(), span: token.span });
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

    fn comma(&mut self) -> Result<(), Lost> {
        self.trailing_docs();
        if self.is_close() || self.take_sign(',') {
            return Ok(());
        }
        self.missing(',')
    }

    fn semicolon(&mut self) -> Result<(), Lost> {
        self.trailing_docs();
        if self.take_sign(';') {
            return Ok(());
        }
        self.missing(';')
    }

    /// A separator is missing. If what follows can begin an entry, reading goes on there.
    fn missing(&mut self, separator: char) -> Result<(), Lost> {
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
            self.at += 1;
            return Ok(());
        }
        let error =
            Diagnostic::new(codes::EXPECTED, self.before(), format!("expected `{separator}`, found {found}"))
                .label(format!("`{separator}` is missing after this"));
        self.report(error);
        let begins = match self.peek().map(|token| token.kind) {
            Some(TokenKind::OuterDoc) => true,
            Some(TokenKind::Name) => self.peek_at(1).is_some_and(|next| {
                let joins = matches!(next.kind, TokenKind::Sign('=' | ':') | TokenKind::Open('{'));
                joins || next.is_word("of") || next.is_word("in")
            }),
            _ => false,
        };
        if self.is_close() || begins { Ok(()) } else { Err(Lost) }
    }

    fn entry(&mut self, section: Section) -> Result<(), Lost> {
        use Section::*;
        let docs = self.docs();
        if self.is_close() {
            return Ok(());
        }
        match section {
            Parameters | Inputs | Coordinates | Speeds | Dependent => {
                let quantity = self.quantity(docs)?;
                match section {
                    Parameters => self.tree.parameters.push(quantity),
                    Inputs => self.tree.inputs.push(quantity),
                    Coordinates => self.tree.coordinates.push(quantity),
                    Speeds => self.tree.speeds.push(quantity),
                    _ => self.tree.dependent.push(quantity),
                }
            }
            Definitions => {
                let name = self.name("the name of a definition")?;
                let unit = if self.take_sign(':') { Some(self.expression()?) } else { None };
                self.sign('=', " and the value of the definition")?;
                let value = self.expression()?;
                self.tree.definitions.push(Definition { docs, name, unit, value });
            }
            Frames => {
                let name = self.name("the name of a frame")?;
                self.sign('=', " and how the frame is oriented")?;
                let value = self.expression()?;
                self.tree.frames.push(Frame { docs, name, value });
            }
            AngularVelocities => {
                let frame = self.name("the name of a frame")?;
                let within = match self.take_word("in") {
                    Some(_) => Some(self.name("the name of a frame after `in`")?),
                    None => None,
                };
                self.sign('=', " and the angular velocity")?;
                let value = self.expression()?;
                self.tree.angular_velocities.push(AngularVelocity { frame, within, value });
            }
            Points => {
                let name = self.name("the name of a point")?;
                let of = match self.take_word("of") {
                    Some(_) => Some(self.name("the name of a body or frame after `of`")?),
                    None => None,
                };
                let by_velocity = self.take_sign(':');
                if by_velocity {
                    if self.take_word("velocity").is_none() {
                        return Err(self.expected("`velocity` after `:` (a position is stated with `=`)"));
                    }
                } else {
                    self.sign('=', " and the position, or `: velocity ..`")?;
                }
                let value = self.expression()?;
                self.tree.points.push(Point { docs, name, of, value, by_velocity });
            }
            Velocities => {
                let point = self.name("the name of a point")?;
                self.sign('=', " and the velocity")?;
                let value = self.expression()?;
                self.tree.velocities.push(Velocity { point, value });
            }
            Bodies | Particles | Contacts => {
                let name = self.name("a name")?;
                let fields = self.fields()?;
                let record = Record { docs, name, fields };
                match section {
                    Bodies => self.tree.bodies.push(record),
                    Particles => self.tree.particles.push(record),
                    _ => self.tree.contacts.push(record),
                }
            }
            Loads => self.load()?,
            Kinematics | Constraints | Configuration => {
                let left = self.expression()?;
                self.sign('=', " and the right side of the equation")?;
                let right = self.expression()?;
                let equation = Equation { left, right };
                match section {
                    Kinematics => self.tree.kinematics.push(equation),
                    Constraints => self.tree.constraints.push(equation),
                    _ => self.tree.configuration.push(equation),
                }
            }
        }
        Ok(())
    }

    /// `fixed name: unit = value`
    fn quantity(&mut self, docs: String) -> Result<Quantity, Lost> {
        let mut modifier = None;
        let named = self.peek_at(1).is_some_and(|token| token.kind == TokenKind::Name);
        if named {
            if let Some(word) = self.take_word("fixed") {
                modifier = Some((Modifier::Fixed, word.span));
            } else if let Some(word) = self.take_word("dependent") {
                modifier = Some((Modifier::Dependent, word.span));
            }
        }
        let name = self.name("the name of a quantity")?;
        if !self.is_sign(':') {
            let message = format!("expected `:` and the unit of `{}`, found {}", name.text, self.found());
            let error = Diagnostic::new(codes::EXPECTED, self.here(), message).help(format!(
                "write `{}: m` for a length, `{}: 1` for a plain number",
                name.text, name.text
            ));
            self.report(error);
            return Err(Lost);
        }
        self.at += 1;
        let unit = self.expression()?;
        let value = if self.take_sign('=') { Some(self.expression()?) } else { None };
        Ok(Quantity { docs, modifier, name, unit, value })
    }

    /// `{ name: value, .. }`
    fn fields(&mut self) -> Result<Vec<Field>, Lost> {
        self.open('{', " and fields such as `mass: m`")?;
        let mut fields = Vec::new();
        let nesting = self.nesting();
        while self.nesting() >= nesting && !self.is_close() {
            let start = self.at;
            let result = match self.field() {
                Ok(field) => {
                    fields.push(field);
                    self.comma()
                }
                Err(lost) => {
                    // a field that could not be read is not missing
                    self.at = start;
                    if let Some(name) = self.take_name() {
                        let value = Expr { kind: ExprKind::Error, span: name.span };
                        fields.push(Field { name, value, notes: Vec::new() });
                    }
                    Err(lost)
                }
            };
            if result.is_err() {
                self.skip_entry(',', nesting);
            }
            if self.at == start {
                self.at += 1;
            }
        }
        self.close("`}`")?;
        Ok(fields)
    }

    fn field(&mut self) -> Result<Field, Lost> {
        let name = self.name("the name of a field")?;
        self.sign(':', " after the name of a field")?;
        let mut notes = Vec::new();
        // `velocity` is a word here unless it is all there is: then it is the name of a point
        let alone = self.peek_at(1).is_none_or(|next| {
            matches!(next.kind, TokenKind::Sign(',') | TokenKind::Close(_)) || next.is_word("of")
        });
        if !alone && self.is_word("velocity") && self.peek_at(1).is_some_and(|t| !is_call(t.kind)) {
            notes.extend(self.take_name().map(|word| Note { word, name: None }));
        }
        let value = self.expression()?;
        while let Some(word) =
            self.take_word("in").or_else(|| self.take_word("about")).or_else(|| self.take_word("of"))
        {
            let name = self.name(&format!("a name after `{}`", word.text))?;
            notes.push(Note { word, name: Some(name) });
        }
        Ok(Field { name, value, notes })
    }

    fn load(&mut self) -> Result<(), Lost> {
        let start = self.here();
        let word = self.name("a load: gravity, force, torque, spring or torsion")?;
        let (mut ends, mut about) = (Vec::new(), None);
        while !self.is_sign(':') {
            if self.take_word("about").is_some() {
                about = Some(self.expression()?);
                break;
            }
            let marked = self.peek_at(1).is_some_and(|token| token.kind == TokenKind::Name);
            let mark = if marked {
                ["on", "from", "to"].into_iter().find_map(|word| self.take_word(word))
            } else {
                None
            };
            if self.peek().is_none_or(|token| token.kind != TokenKind::Name) {
                return Err(self.expected("a name or `:`"));
            }
            let name = self.name("a name")?;
            ends.push((mark, name));
        }
        self.sign(':', " before the value of the load")?;
        let (mut value, mut fields) = (None, Vec::new());
        if self.is_open('{') {
            fields = self.fields()?;
        } else {
            value = Some(self.expression()?);
        }
        let span = start.to(self.before());
        self.tree.loads.push(Load { word, ends, about, value, fields, span });
        Ok(())
    }
}

fn is_call(kind: TokenKind) -> bool {
    kind == TokenKind::Open('(')
}
