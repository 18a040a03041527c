//! Lowers bodies and particles.

use super::super::mechanism::{Body, FrameId, Inertia, PointId, Scalar};
use super::{Lowering, QuantityFacts};
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::dimension::Dimension;
use crate::number::Number;
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind, Field, Name, Record};
use crate::{suggest, vocabulary, words};

impl Lowering<'_> {
    pub(super) fn bodies(&mut self) {
        let tree = self.tree;
        for record in &tree.bodies {
            let before = self.mistakes();
            let read = match super::shapes::shape_field(record) {
                Some(_) => self.body_of_shape(record).is_some(),
                None => self.body(record).is_some(),
            };
            self.readable.bodies.push(read && self.mistakes() == before);
        }
        for record in &tree.particles {
            let before = self.mistakes();
            let read = self.particle(record).is_some();
            self.readable.bodies.push(read && self.mistakes() == before);
        }
        let no_body = tree.bodies.is_empty() && tree.particles.is_empty();
        let no_speed = tree.speeds.is_empty();
        let unread = tree.incomplete || !tree.broken.is_empty() || tree.name.is_none();
        let place = tree.name.as_ref().map_or(Span::default(), |name| name.span);
        if no_body && !unread {
            let error = Diagnostic::new(codes::EMPTY, place, "the mechanism has no body and no particle")
                .help("add `bodies { .. }` or `particles { .. }`");
            self.report(error);
        }
        if no_speed && !unread {
            let error = Diagnostic::new(codes::EMPTY, place, "the mechanism has no speed")
                .help("add `speeds { u1: rad/s }`");
            self.report(error);
        }
    }

    /// The fields of a record by name; unknown, repeated and missing ones are reported.
    pub(super) fn record<'r, const N: usize>(
        &mut self,
        what: &str,
        owner: &Name,
        fields: &'r [Field],
        known: [&str; N],
        needed: &[&str],
    ) -> [Option<&'r Field>; N] {
        let mut found: [Option<&Field>; N] = [None; N];
        // what is misspelled is not missing
        let mut meant = Vec::new();
        // what could not be read is said already, and may be what is missing
        let unread = |field: &&Field| {
            let unread = matches!(field.value.kind, ExprKind::Error) && field.fields.is_none();
            unread && !known.contains(&field.name.text.as_str())
        };
        let complete = !fields.iter().any(|field| unread(&field));
        for field in fields.iter().filter(|field| !unread(field)) {
            let Some(i) = known.iter().position(|name| *name == field.name.text) else {
                let message = format!("{what} has no field `{}`", field.name.text);
                let error = Diagnostic::new(codes::FIELD, field.name.span, message);
                let near = vocabulary::field(&field.name.text, &known)
                    .or_else(|| suggest::nearest(&field.name.text, known.into_iter()));
                self.report(match near {
                    Some(near) => {
                        meant.push(near);
                        error.did_you_mean(near)
                    }
                    None => error.help(match (what, field.name.text.as_str()) {
                        ("a particle", "inertia" | "frame") => {
                            "a particle has neither frame nor inertia: what has them stands under `bodies`"
                                .to_owned()
                        }
                        ("a contact", "mu" | "e" | "law" | "friction" | "restitution") => {
                            "friction and restitution belong to its surface: `surface: { mu: 0.3, e: 0.5, law: stronge }`".to_owned()
                        }
                        ("a surface", "mu_rolling" | "mu_spinning") => {
                            "rolling and spinning friction have lever arms, in m: `rolling: 0.002`, `spinning: 0.001`".to_owned()
                        }
                        _ => format!("its fields are {}", known.join(", ")),
                    }),
                });
                continue;
            };
            if let Some(first) = found[i] {
                self.given_twice(field, first);
            } else {
                found[i] = Some(field);
            }
        }
        let missing: Vec<String> = known
            .iter()
            .zip(&found)
            .filter(|(name, field)| field.is_none() && needed.contains(name) && !meant.contains(*name))
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        if !missing.is_empty() && complete {
            let code = if what.starts_with("a body") || what.starts_with("a particle") {
                codes::BODY
            } else {
                codes::FIELD
            };
            let message = format!("`{}` has no {}", owner.text, missing.join(" and no "));
            let examples: Vec<String> =
                missing.iter().map(|field| self.example_of(field.trim_matches('`'))).collect();
            let added = examples.join(", ");
            let error = Diagnostic::new(code, owner.span, message).help(format!("add `{added}`"));
            self.report(error.fix(Place::IntoBraces(owner.span), added));
        }
        found
    }

    /// Says that a record has a field that it has already.
    pub(super) fn given_twice(&mut self, field: &Field, first: &Field) {
        let message = format!("`{}` is given twice", field.name.text);
        let error = Diagnostic::new(codes::FIELD, field.name.span, message);
        self.report(error.related(first.name.span, "first here"));
    }

    /// A field as it could be written, with names of the model.
    fn example_of(&self, field: &str) -> String {
        let tree = self.tree;
        let is_mass = |facts: &QuantityFacts| {
            facts.unit.as_ref().is_some_and(|unit| unit.dimension == Dimension::of(0, 1, 0))
        };
        let mut masses = tree.parameters.iter().zip(&self.parameters).filter(|(_, facts)| is_mass(facts));
        let value = match field {
            "mass" => masses.next().map_or("m", |(mass, _)| &mass.name.text),
            "inertia" => "[Ixx, Iyy, Izz]",
            "frame" => tree.frames.first().map_or("B", |frame| &frame.name.text),
            "centre" | "point" => tree.points.first().map_or("P", |point| &point.name.text),
            "normal" => "N.y",
            _ => "..",
        };
        format!("{field}: {value}")
    }

    /// Words beside a value that do not belong there.
    pub(super) fn notes(&mut self, field: &Field, allowed: &[&str]) {
        for (i, note) in field.notes.iter().enumerate() {
            let twice = field.notes[..i].iter().any(|other| other.word.text == note.word.text);
            if !allowed.contains(&note.word.text.as_str()) || twice {
                let message = format!("`{}` cannot stand here", note.word.text);
                self.report(Diagnostic::new(codes::FIELD, note.word.span, message));
            }
        }
    }

    pub(super) fn note<'r>(&self, field: &'r Field, word: &str) -> Option<&'r Name> {
        field.notes.iter().find(|note| note.word.text == word).and_then(|note| note.name.as_ref())
    }

    /// A field whose value is a name.
    pub(super) fn name_in(&mut self, field: &Field, what: &str) -> Option<Name> {
        match &field.value.kind {
            ExprKind::Name(text) => Some(Name { text: text.clone(), span: field.value.span }),
            ExprKind::Error => None,
            _ => {
                let message = format!("`{}` needs the name of {what}", field.name.text);
                let section = if what == "a point" { "points" } else { "frames" };
                let help = format!("declare it under `{section}` and write its name here");
                self.report(Diagnostic::new(codes::WRONG_KIND, field.value.span, message).help(help));
                None
            }
        }
    }

    fn mass(&mut self, field: Option<&Field>) -> Option<Scalar> {
        let before = self.mistakes();
        let mass = field.and_then(|field| self.mass_of(&field.value));
        self.readable.masses.push(mass.is_some() && self.mistakes() == before);
        mass
    }

    fn mass_of(&mut self, expr: &Expr) -> Option<Scalar> {
        let (scalar, typed) = self.scalar_like(expr, Dimension::of(0, 1, 0), "a mass")?;
        self.need_free_of_speeds(&typed, "a mass");
        if typed.traits.moves || typed.traits.time || typed.traits.input.is_some() {
            let error = Diagnostic::new(codes::MASS, typed.span, "a mass must be constant")
                .help("it may depend on parameters only");
            self.report(error);
        }
        if typed.constant.is_some_and(|value| value < 0.0) {
            self.error(codes::MASS, typed.span, "a mass cannot be negative");
        }
        Some(scalar)
    }

    /// A body; `None` if a part of it could not be read.
    fn body(&mut self, record: &Record) -> Option<()> {
        let [frame, centre, mass, inertia] =
            self.record("a body", &record.name, &record.fields, words::BODY, &words::BODY);
        for field in [frame, centre, mass].into_iter().flatten() {
            self.notes(field, &[]);
        }
        let frame =
            frame.and_then(|field| self.name_in(field, "a frame")).and_then(|name| self.proper_frame(&name));
        let centre =
            centre.and_then(|field| self.name_in(field, "a point")).and_then(|name| self.point_named(&name));
        let mass_span = mass.map_or(record.name.span, |field| field.value.span);
        let mass = self.mass(mass);
        let inertia = inertia.and_then(|field| self.inertia(field, frame));
        let zero = || Scalar::Number(Number::integer(0));
        let point_read = |point: PointId| !self.points[point.0].broken;
        let frame_read = |frame: FrameId| !self.frames[frame.0].broken;
        let read = frame.is_some_and(frame_read)
            && centre.is_some_and(point_read)
            && mass.is_some()
            && inertia
                .as_ref()
                .is_some_and(|inertia| frame_read(inertia.frame) && inertia.about.is_none_or(point_read));
        self.out.bodies.push(Body {
            name: record.name.text.clone(),
            docs: record.docs.clone(),
            frame: Some(frame.unwrap_or(FrameId::N)),
            centre: centre.unwrap_or(PointId::O),
            mass: mass.unwrap_or_else(zero),
            mass_span,
            inertia,
            span: record.name.span,
        });
        read.then_some(())
    }

    /// A frame, not a body.
    pub(super) fn proper_frame(&mut self, name: &Name) -> Option<FrameId> {
        use super::super::names::Symbol;
        match self.resolve(name, |s| matches!(s, Symbol::Frame(_)))? {
            Symbol::Frame(f) => Some(FrameId(f)),
            other => {
                self.wrong_kind(name, "a frame", &format!("`{}` is {}", name.text, other.kind()));
                None
            }
        }
    }

    /// A particle; `None` if a part of it could not be read.
    fn particle(&mut self, record: &Record) -> Option<()> {
        let known = words::PARTICLE;
        let [point, mass] = self.record("a particle", &record.name, &record.fields, known, &known);
        for field in [point, mass].into_iter().flatten() {
            self.notes(field, &[]);
        }
        let point =
            point.and_then(|field| self.name_in(field, "a point")).and_then(|name| self.point_named(&name));
        let mass_span = mass.map_or(record.name.span, |field| field.value.span);
        let mass = self.mass(mass);
        let read = point.is_some_and(|point| !self.points[point.0].broken) && mass.is_some();
        self.out.bodies.push(Body {
            name: record.name.text.clone(),
            docs: record.docs.clone(),
            frame: None,
            centre: point.unwrap_or(PointId::O),
            mass: mass.unwrap_or_else(|| Scalar::Number(Number::integer(0))),
            mass_span,
            inertia: None,
            span: record.name.span,
        });
        read.then_some(())
    }

    fn inertia(&mut self, field: &Field, body_frame: Option<FrameId>) -> Option<Inertia> {
        self.notes(field, &["in", "about"]);
        let within =
            self.note(field, "in").map(|name| self.proper_frame(name).map(|frame| (frame, name.span)));
        let about = self.note(field, "about").map(|name| self.point_named(name));
        let ExprKind::List(items) = &field.value.kind else {
            if !matches!(field.value.kind, ExprKind::Error) {
                let error =
                    Diagnostic::new(codes::INERTIA, field.value.span, "an inertia is a list of components")
                        .help("write `[xx, yy, zz]` or `[xx, yy, zz, xy, yz, zx]`");
                self.report(error);
            }
            return None;
        };
        if items.iter().all(|item| matches!(item.kind, ExprKind::List(_))) && !items.is_empty() {
            let error = Diagnostic::new(
                codes::INERTIA,
                field.value.span,
                "an inertia is a list of components, no matrix",
            )
            .help("write `[xx, yy, zz, xy, yz, zx]`, products with a plus sign as in the matrix");
            self.report(error);
            return None;
        }
        let mut components = Vec::new();
        for item in items {
            let what = "a component of inertia";
            let Some((scalar, typed)) = self.scalar_like(item, Dimension::of(2, 1, 0), what) else {
                continue;
            };
            self.need_free_of_speeds(&typed, what);
            if typed.traits.moves || typed.traits.time || typed.traits.input.is_some() {
                let error =
                    Diagnostic::new(codes::INERTIA, typed.span, "an inertia must be constant in its frame")
                        .help(
                            "its components may depend on parameters only; choose a frame in which they do",
                        );
                self.report(error);
            }
            components.push(scalar);
        }
        if items.len() != 3 && items.len() != 6 {
            let message = format!("an inertia has 3 or 6 components, but {} are given", items.len());
            let error = Diagnostic::new(codes::INERTIA, field.value.span, message)
                .help("write `[xx, yy, zz]` or `[xx, yy, zz, xy, yz, zx]`, products with a plus sign");
            self.report(error);
            return None;
        }
        if components.len() == 3 && items.len() == 3 {
            components.extend((0..3).map(|_| Scalar::Number(Number::integer(0))));
        }
        let components: [Scalar; 6] = components.try_into().ok()?;
        let frame = match within {
            None => {
                let frame = body_frame?;
                if self.frames[frame.0].no_axes {
                    let name = self.out.frames[frame.0].name.clone();
                    let message =
                        format!("`{name}` has no axes, so the components of inertia need another frame");
                    let error = Diagnostic::new(codes::NO_AXES, field.value.span, message)
                        .related(
                            self.out.frames[frame.0].span,
                            "it is made by `spin`: its angle is not known",
                        )
                        .help("say in which frame they are: `inertia: [..] in A`");
                    self.report(error);
                    return None;
                }
                frame
            }
            Some(within) => {
                let (frame, span) = within?;
                self.need_axes(frame, span)?
            }
        };
        let about = match about {
            None => None,
            Some(point) => Some(point?),
        };
        Some(Inertia { components: Box::new(components), frame, about, span: field.value.span })
    }
}
