//! Parses the entries of sections: quantities, points, records, loads, equations.

use super::parser::{Lost, Parser};
use super::token::TokenKind;
use super::tree::*;
use super::units;
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::span::Span;

impl Parser<'_> {
    /// One entry of a section, without what ends it.
    pub(super) fn entry(&mut self, section: Section) -> Result<(), Lost> {
        use Section::*;
        let docs = self.docs();
        if self.is_close() {
            return Ok(());
        }
        self.stray_word(section);
        match section {
            Parameters | Inputs | Coordinates | Speeds | Dependent => {
                let quantity = self.quantity(docs, section)?;
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
                let point = self.point(docs)?;
                self.tree.points.push(point);
            }
            Velocities => {
                let point = self.name("the name of a point")?;
                self.sign('=', " and the velocity")?;
                let value = self.expression()?;
                self.tree.velocities.push(Velocity { point, value });
            }
            Bodies | Particles | Shapes | Contacts => {
                let record = self.record(docs)?;
                match section {
                    Bodies => self.tree.bodies.push(record),
                    Particles => self.tree.particles.push(record),
                    Shapes => self.tree.shapes.push(record),
                    _ => self.tree.contacts.push(record),
                }
            }
            Loads => self.load()?,
            Kinematics | Constraints | Configuration => {
                let equation = self.equation()?;
                match section {
                    Kinematics => self.tree.kinematics.push(equation),
                    Constraints => self.tree.constraints.push(equation),
                    _ => self.tree.configuration.push(equation),
                }
            }
        }
        Ok(())
    }

    /// `P of B = position`, or `P of B: velocity value`
    fn point(&mut self, docs: String) -> Result<Point, Lost> {
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
        Ok(Point { docs, name, of, value, by_velocity })
    }

    /// `name { fields }`
    fn record(&mut self, docs: String) -> Result<Record, Lost> {
        let name = self.name("a name")?;
        let braces = self.peek_at(1).is_some_and(|next| next.kind == TokenKind::Open('{'));
        if braces && (self.is_sign(':') || self.is_sign('=')) {
            let message = format!("expected `{{` and fields such as `mass: m`, found {}", self.found());
            self.colon_meant(&message, format!("write `{} {{ .. }}`", name.text));
        } else if self.is_sign('-') {
            let _ = self.expected("`{` and fields such as `mass: m`");
            let help = format!("a name is made of letters, digits and `_`: `{}_..`", name.text);
            self.advise(help);
            return Err(Lost);
        }
        let fields = self.fields()?;
        Ok(Record { docs, name, fields })
    }

    /// `left = right`
    fn equation(&mut self) -> Result<Equation, Lost> {
        let left = self.expression()?;
        let ends = self.is_sign(';') || self.is_close();
        let sign = self.sign('=', " and the right side of the equation");
        if sign.is_err() && ends {
            self.advise("an equation has two sides, as in `a - b = 0`".to_owned());
        }
        sign?;
        let right = self.expression()?;
        Ok(Equation { left, right })
    }

    /// `=` for `:`, or a sign too many before a brace: said, and read as meant.
    fn colon_meant(&mut self, message: &str, help: String) {
        self.report(Diagnostic::new(codes::EXPECTED, self.here(), message).help(help));
        self.at += 1;
    }

    /// `fixed name: unit = value`
    fn quantity(&mut self, docs: String, section: Section) -> Result<Declaration, Lost> {
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
            let (n, none) = (&name.text, "a plain number has the unit 1");
            let help = match section {
                Section::Coordinates => {
                    format!(
                        "state the unit, as in `{n}: rad` for an angle or `{n}: m` for a length; {none}: `{n}: 1`"
                    )
                }
                Section::Speeds | Section::Dependent => {
                    format!(
                        "state the unit, as in `{n}: rad/s` for the rate of an angle or `{n}: m/s` for that of a length"
                    )
                }
                Section::Inputs => {
                    format!(
                        "state the unit, as in `{n}: N` for a force or `{n}: N*m` for a torque; {none}: `{n}: 1`"
                    )
                }
                _ => format!("state the unit, as in `{n}: kg = 1` for a mass; {none}: `{n}: 1 = 1`"),
            };
            let units: &[&str] = match section {
                Section::Coordinates => &["rad", "m", "1"],
                Section::Speeds | Section::Dependent => &["rad/s", "m/s", "1"],
                Section::Inputs => &["N", "N*m", "1"],
                _ => &["kg", "m", "1"],
            };
            let after = Span { start: name.span.end, end: name.span.end };
            let error = Diagnostic::new(codes::EXPECTED, self.here(), message).help(help);
            let offer =
                |error: Diagnostic, unit: &&str| error.fix(Place::Replace(after), format!(": {unit}"));
            self.report(units.iter().fold(error, offer));
            return Err(Lost);
        }
        self.at += 1;
        let mut unit = self.expression()?;
        self.operator_in_unit(&mut unit);
        let value = if self.take_sign('=') { Some(self.expression()?) } else { None };
        if value.is_some() {
            self.unit_of_value(&name, &unit)?;
        }
        Ok(Declaration { docs, modifier, name, unit, value })
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
                    fields.push(Field { name, value, notes: Vec::new(), fields: None });
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

    /// `Foot on Floor`, `Ball in Bowl`: two shapes in place of a field.
    fn pair(&mut self) -> Option<Field> {
        let word = self.peek_at(1).filter(|word| word.is_word("on") || word.is_word("in"))?;
        let is_name = |ahead| self.peek_at(ahead).is_some_and(|token| token.kind == TokenKind::Name);
        if !is_name(0) || !is_name(2) {
            return None;
        }
        let word = Name { text: word.text.clone(), span: word.span };
        let first = self.take_name()?;
        self.at += 1;
        let second = self.take_name()?;
        let value = Expr { kind: ExprKind::Name(first.text), span: first.span };
        let notes = vec![Note { word: word.clone(), name: Some(second) }];
        Some(Field { name: word, value, notes, fields: None })
    }

    fn field(&mut self) -> Result<Field, Lost> {
        if let Some(pair) = self.pair() {
            return Ok(pair);
        }
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
        // inside of a surface there is no other
        if name.text == "surface" && self.is_open('{') && self.nesting() < 3 {
            let start = self.here();
            let fields = self.fields()?;
            let value = Expr { kind: ExprKind::Error, span: start.to(self.before()) };
            return Ok(Field { name, value, notes: Vec::new(), fields: Some(fields) });
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
        Ok(Field { name, value, notes, fields: None })
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
                let help = match self.is_sign(',') {
                    true => format!("state a {} for each", word.text),
                    false => format!("as in `{}`", example_of_load(&word.text)),
                };
                self.advise(help);
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
