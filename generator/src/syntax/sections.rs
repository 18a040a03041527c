//! What stands in the sections.

use super::parser::{Lost, Parser};
use super::token::TokenKind;
use super::tree::*;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::units;

impl Parser<'_> {
    /// All entries of a section; stops before the closing brace.
    pub(super) fn entries(&mut self, section: Section) {
        use Section::*;
        let separator = match section {
            Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Contacts => ',',
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

    /// What could not be read still declares its names: the first, and whatever stands before a `:`, `=` or `{`. Does it begin with one?
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
            Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Contacts => None,
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

    fn comma(&mut self, of_fields: bool) -> Result<(), Lost> {
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
        self.report(error);
        if self.is_close() || begins { Ok(()) } else { Err(Lost) }
    }

    /// A word before the name that an entry begins with, as in `let x = ..` or `const m: kg`: said, and passed over.
    fn stray_word(&mut self, section: Section) {
        use Section::*;
        let begins = |kind| match section {
            Parameters | Inputs | Coordinates | Speeds | Dependent => kind == TokenKind::Sign(':'),
            Definitions | Frames | Points | Velocities => kind == TokenKind::Sign('='),
            Bodies | Particles | Contacts => kind == TokenKind::Open('{'),
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

    /// `=` for `:`, or a sign too many before a brace: said, and read as meant.
    fn colon_meant(&mut self, message: &str, help: String) {
        self.report(Diagnostic::new(codes::EXPECTED, self.here(), message).help(help));
        self.at += 1;
    }

    fn entry(&mut self, section: Section) -> Result<(), Lost> {
        use Section::*;
        let docs = self.docs();
        if self.is_close() {
            return Ok(());
        }
        self.stray_word(section);
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
                if self.is_word("in") || self.is_word("on") {
                    let _ = self.expected("`of`, `=` or `:`");
                    self.advise(format!("write `{} of B` for a point of the body or frame B", name.text));
                    return Err(Lost);
                }
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
                let braces = self.peek_at(1).is_some_and(|next| next.kind == TokenKind::Open('{'));
                if braces && (self.is_sign(':') || self.is_sign('=')) {
                    let message =
                        format!("expected `{{` and fields such as `mass: m`, found {}", self.found());
                    self.colon_meant(&message, format!("write `{} {{ .. }}`", name.text));
                } else if self.is_sign('-') {
                    let _ = self.expected("`{` and fields such as `mass: m`");
                    let help = format!("a name is made of letters, digits and `_`: `{}_..`", name.text);
                    self.advise(help);
                    return Err(Lost);
                }
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
                let ends = self.is_sign(';') || self.is_close();
                let sign = self.sign('=', " and the right side of the equation");
                if sign.is_err() && ends {
                    self.advise("an equation has two sides, as in `a - b = 0`".to_owned());
                }
                sign?;
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
        if self.before_is(',') && self.peek().is_some_and(|token| token.kind == TokenKind::Number) {
            let _ = self.expected("the name of a quantity");
            self.advise("decimals are written with a point, as in `9.81`".to_owned());
            return Err(Lost);
        }
        let name = self.name("the name of a quantity")?;
        if !self.is_sign(':') {
            let message = format!("expected `:` and the unit of `{}`, found {}", name.text, self.found());
            let error = Diagnostic::new(codes::EXPECTED, self.here(), message).help(format!(
                "state the unit, as in `{0}: kg = 1` for a mass; a plain number has the unit 1: `{0}: 1 = 1`",
                name.text
            ));
            self.report(error);
            return Err(Lost);
        }
        self.at += 1;
        let mut unit = self.expression()?;
        self.operator_in_unit(&mut unit);
        let value = if self.take_sign('=') { Some(self.expression()?) } else { None };
        if value.is_some() {
            self.unit_of_value(&name, &unit)?;
        }
        Ok(Quantity { docs, modifier, name, unit, value })
    }

    /// `tau: N m = 1`: what follows is of the unit, unless it begins the next entry.
    fn operator_in_unit(&mut self, unit: &mut Expr) {
        let begins = |next: &super::token::Token| next.is_sign(':') || next.kind == TokenKind::Name;
        let is_unit =
            |token: &super::token::Token| token.kind == TokenKind::Name && units::is_symbol(&token.text);
        let is_power = self.peek().is_some_and(|token| token.kind == TokenKind::Number)
            && self.peek_at(1).is_some_and(|next| next.is_sign('='));
        if !is_power && (!self.peek().is_some_and(is_unit) || self.peek_at(1).is_some_and(begins)) {
            return;
        }
        let start = unit.span;
        let Ok(rest) = self.expression() else { return };
        let span = start.to(rest.span);
        let error = Diagnostic::new(codes::EXPECTED, span, "an operator is missing in this unit")
            .help("products of units are written `N*m`, quotients `m/s`, powers `m^2`");
        self.report(error);
        *unit = Expr { kind: ExprKind::Error, span };
    }

    /// `q: rad = 30 deg`: a value has no unit of its own.
    fn unit_of_value(&mut self, name: &Name, stated: &Expr) -> Result<(), Lost> {
        let is_unit =
            |token: &super::token::Token| token.kind == TokenKind::Name && units::is_symbol(&token.text);
        let declares = self.peek_at(1).is_some_and(|next| next.is_sign(':'));
        if declares || !self.peek().is_some_and(is_unit) {
            return Ok(());
        }
        let start = self.here();
        let written = self.expression()?;
        let span = start.to(self.before());
        let text = |unit: &Expr| units::read(unit).ok().map(|unit| unit.text);
        let help = match (text(stated), text(&written)) {
            (Some(stated), Some(written)) if stated == written => {
                format!("remove it: `{}` is in {stated} already", name.text)
            }
            (_, Some(written)) => {
                format!("the value is counted in the declared unit: write `{}: {written} = ..`", name.text)
            }
            _ => "the value is counted in the declared unit".to_owned(),
        };
        self.report(Diagnostic::new(codes::EXPECTED, span, "a value has no unit of its own").help(help));
        Ok(())
    }

    /// `{ name: value, .. }`
    fn fields(&mut self) -> Result<Vec<Field>, Lost> {
        self.open('{', " and fields such as `mass: m`")?;
        let mut fields = Vec::new();
        let nesting = self.nesting();
        while self.nesting() >= nesting && !self.is_close() {
            let start = self.at;
            let result = match self.field() {
                Ok(mut field) => {
                    let result = self.comma(true);
                    if result.is_err() {
                        field.value.kind = ExprKind::Error;
                    }
                    fields.push(field);
                    result
                }
                Err(lost) => {
                    // a field that could not be read is not missing, whatever its name
                    self.at = start;
                    let span = self.here();
                    let name = self.take_name().unwrap_or(Name { text: String::new(), span });
                    let value = Expr { kind: ExprKind::Error, span: name.span };
                    fields.push(Field { name, value, notes: Vec::new() });
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
        if self.is_sign('=') {
            let help = format!("fields are written `{}: ..`", name.text);
            self.colon_meant("expected `:` after the name of a field, found `=`", help);
        } else {
            self.sign(':', " after the name of a field")?;
        }
        if name.text == "inertia" && self.is_open('{') {
            let _ = self.expected("the components of inertia");
            self.advise("write `[xx, yy, zz]` or `[xx, yy, zz, xy, yz, zx]`".to_owned());
            return Err(Lost);
        }
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
        let named = [0, 1, 2].map(|ahead| self.peek_at(ahead));
        if let [Some(name), Some(colon), Some(word)] = named
            && name.kind == TokenKind::Name
            && colon.is_sign(':')
            && ["force", "torque", "spring", "torsion"].contains(&word.text.as_str())
            && self.peek_at(3).is_some_and(|next| next.kind == TokenKind::Name)
        {
            let error = Diagnostic::new(codes::EXPECTED, name.span, "a load has no name");
            self.report(error.help(format!("remove `{}:`; say what it is in a `//` comment", name.text)));
            self.at += 2;
        }
        let start = self.here();
        let word = self.name("a load: gravity, force, torque, spring or torsion")?;
        let (mut ends, mut about) = (Vec::new(), None);
        while !self.is_sign(':') && !self.is_sign('=') {
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
                let lost = self.expected("a name or `:`");
                if self.is_sign(',') {
                    self.advise(format!("state a {} for each", word.text));
                }
                return Err(lost);
            }
            let name = self.name("a name")?;
            ends.push((mark, name));
        }
        if self.is_sign('=') {
            let help = format!("loads are stated with `:`, as in `{}`", example_of_load(&word.text));
            self.colon_meant("expected `:` before the value of the load, found `=`", help);
        } else {
            self.sign(':', " before the value of the load")?;
        }
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

fn example_of_load(word: &str) -> &'static str {
    match word {
        "force" => "force on P: F*N.x;",
        "torque" => "torque on B: tau*N.z;",
        "spring" => "spring P to H: { stiffness: k };",
        "torsion" => "torsion B about N.z: { angle: q1, stiffness: k };",
        _ => "gravity: -g*N.z;",
    }
}

fn is_call(kind: TokenKind) -> bool {
    kind == TokenKind::Open('(')
}
