//! Lowers contacts, and warns of names that are never used.

use super::super::mechanism::{Against, BodyId, Contact, ContactLaw, FrameId, PointId, Vector};
use super::super::names::Symbol;
use super::super::pairs;
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::syntax::tree::{ExprKind, Field, Name, Record};
use crate::words;

impl Lowering<'_> {
    pub(super) fn contacts(&mut self) {
        let tree = self.tree;
        let names = pairs::names(tree, self.hulls);
        for (i, record) in tree.contacts.iter().enumerate() {
            if let Some(pair) = pairs::pair(record) {
                let own = names.iter().filter(|(_, of)| *of == i).map(|(name, _)| name);
                self.contacts_of_shapes(record, pair, &own.collect::<Vec<_>>());
                continue;
            }
            let before = self.mistakes();
            let read = self.contact(record).is_some();
            self.readable.contacts.push(read && self.mistakes() == before);
        }
    }

    /// A contact; `None` if a part of it could not be read.
    fn contact(&mut self, record: &Record) -> Option<()> {
        let known = words::CONTACT;
        let [point, against, normal, gap, surface] =
            self.record("a contact", &record.name, &record.fields, known, &["point", "normal"]);
        let mut body = None;
        let [point_span, against_span] =
            [point, against].map(|field| field.map_or(record.name.span, |field| field.value.span));
        let point = point.and_then(|field| {
            self.notes(field, &["of"]);
            body = self.note(field, "of").and_then(|name| self.body_named(name));
            self.name_in(field, "a point").and_then(|name| self.point_named(&name))
        });
        let against = against.map_or(Some(Against::Fixed), |field| self.against(field, point));
        let span_of = |field: Option<&Field>| field.map_or(record.name.span, |field| field.value.span);
        let [normal_span, gap_span] = [normal, gap].map(span_of);
        let normal = normal.and_then(|field| {
            self.notes(field, &[]);
            let typed = self.expression(&field.value);
            if typed.is_zero() {
                let error = Diagnostic::new(codes::NORMAL, typed.span, "the normal is the zero vector")
                    .help("it is a unit vector from what is struck to what strikes, such as `N.y`");
                self.report(error);
                return None;
            }
            let vector = self.need_vector(&typed, "the normal")?;
            self.demand(&typed, Dimension::none(), "the normal");
            self.need_free_of_speeds(&typed, "the normal");
            Some(vector)
        });
        // `gap: none`, unless a quantity has this name
        let is_none = |field: &&Field| matches!(&field.value.kind, ExprKind::Name(name) if name == "none");
        let without_gap = gap.filter(is_none).is_some() && self.names.get("none").is_none();
        let gap = gap.map(|field| {
            self.notes(field, &[]);
            if without_gap {
                return Some(None);
            }
            let (scalar, typed) = self.scalar_like(&field.value, Dimension::of(1, 0, 0), "a gap")?;
            self.need_free_of_speeds(&typed, "a gap");
            Some(Some(scalar))
        });
        let (surface, law) = surface.map(|field| self.surface(field)).unzip();
        if let (Some(p), Some(Against::Point(q, _))) = (point, &against)
            && p == *q
        {
            let error = Diagnostic::new(codes::CONTACT, record.name.span, "a point cannot strike itself")
                .help("`point` and `against` must name two points");
            self.report(error);
        }
        if let (Some(p), Some(Against::Body(b))) = (point, &against) {
            self.coincident(p, *b, record);
        }
        let law: ContactLaw = law.unwrap_or_default();
        let turning = match &against {
            Some(against) if law.asks_for_rotation() => self.turning(record, body, against),
            _ => None,
        };
        let gap_read = gap.as_ref().is_none_or(Option::is_some);
        let read = point.is_some() && against.is_some() && normal.is_some() && gap_read;
        self.out.contacts.push(Contact {
            name: record.name.text.clone(),
            docs: record.docs.clone(),
            point: point.unwrap_or(PointId::O),
            body,
            against: against.unwrap_or(Against::Fixed),
            normal: normal.unwrap_or(Vector::Zero),
            point_span,
            against_span,
            normal_span,
            gap: gap.flatten().flatten(),
            without_gap,
            validity: None,
            tangent: None,
            clearance: None,
            first_of_pair: None,
            gap_span,
            surface,
            law,
            shapes: None,
            turning,
            span: record.name.span,
        });
        read.then_some(())
    }

    /// Warns of contacts that no simulation sees, where a gap could be stated and it is not said that there is
    /// none.
    pub(super) fn without_gap(&mut self) {
        let mut warnings = Vec::new();
        for contact in
            self.out.contacts.iter().filter(|contact| contact.gap.is_none() && !contact.without_gap)
        {
            let root = |point: PointId| self.points[point.0].root;
            let other = match contact.against {
                Against::Fixed | Against::Velocity(_) => 0,
                Against::Point(point, _) => root(point),
                Against::Body(body) => self.out.bodies.get(body.0).map_or(0, |body| root(body.centre)),
            };
            // between places that are not known there is no distance
            if root(contact.point) != other {
                continue;
            }
            let message =
                format!("the contact `{}` has no gap: a simulation never sees it close", contact.name);
            let point = &self.out.points[contact.point.0].name;
            let distance = match contact.against {
                Against::Point(struck, _) => {
                    format!("dot(position({point}, {}), n)", self.out.points[struck.0].name)
                }
                _ => format!("dot(position({point}), n)"),
            };
            let help = format!(
                "add `gap: ..`, the distance along the normal n, as in `gap: {distance}` plus a length, or `gap: none` where collisions happen at given instants alone"
            );
            warnings.push(Diagnostic::new(codes::NO_GAP, contact.span, message).help(help));
        }
        self.diagnostics.extend(warnings);
    }

    /// The material point of a body that coincides with P is known only if both positions are.
    fn coincident(&mut self, point: PointId, body: BodyId, record: &Record) {
        let Some(body) = self.out.bodies.get(body.0) else { return };
        let (a, b) = (self.points[point.0].root, self.points[body.centre.0].root);
        if a == b {
            return;
        }
        let unknown = if a != 0 { a } else { b };
        let (name, place) = (self.out.points[unknown].name.clone(), self.out.points[unknown].span);
        let message = "it is not known which point of the body is struck";
        let error = Diagnostic::new(codes::NO_POSITION, record.name.span, message)
            .related(place, format!("`{name}` is given by its velocity only"))
            .help("state its position, or name the point that is struck");
        self.report(error);
    }

    fn against(&mut self, field: &Field, point: Option<PointId>) -> Option<Against> {
        self.notes(field, &["velocity", "of", "about"]);
        let about = self.note(field, "about").cloned();
        let of = self.note(field, "of").map(|name| self.body_named(name));
        let by_velocity = field.notes.iter().any(|note| note.word.text == "velocity");
        let speed = Dimension::of(1, 0, -1);
        let value = match &field.value.kind {
            // `velocity (expression)` reads like a call
            ExprKind::Call(function, arguments) if function.text == "velocity" && arguments.len() == 1 => {
                let names_point = matches!(&arguments[0].kind, ExprKind::Name(name)
                    if matches!(self.names.get(name), Some(Symbol::Point(_))));
                Some(if names_point { &field.value } else { &arguments[0] })
            }
            _ if by_velocity => Some(&field.value),
            _ => None,
        };
        if let Some(value) = value {
            if let Some(Some(_)) = of {
                self.error(
                    codes::CONTACT,
                    field.value.span,
                    "a surface with its own velocity belongs to no body",
                );
            }
            let (vector, _) = self.velocity_like(value, speed, "the velocity of the surface");
            return vector.map(Against::Velocity);
        }
        let ExprKind::Name(text) = &field.value.kind else {
            if !self.expression(&field.value).is_poison() {
                let error = Diagnostic::new(
                    codes::CONTACT,
                    field.value.span,
                    "a point, a body or a velocity is needed here",
                )
                .help("write `against: P of Body`, `against: Body` or `against: velocity v`");
                self.report(error);
            }
            return None;
        };
        let name = Name { text: text.clone(), span: field.value.span };
        let symbol = self.resolve(&name, |s| matches!(s, Symbol::Point(_) | Symbol::Body(_)))?;
        if let (Symbol::Frame(1..), None) = (symbol, &of) {
            return self.against_frame(symbol, &name, about, point);
        }
        if let Some(about) = about {
            let message = "only a frame is struck `about` a point";
            self.report(Diagnostic::new(codes::CONTACT, about.span, message).help("remove `about`"));
            return None;
        }
        match symbol {
            Symbol::Point(p) => match of {
                None => Some(Against::Point(PointId(p), None)),
                Some(body) => Some(Against::Point(PointId(p), Some(body?))),
            },
            Symbol::Body(b) if of.is_none() => {
                if self.out.bodies.get(b).is_some_and(|body| body.frame.is_some()) {
                    return Some(Against::Body(BodyId(b)));
                }
                let centre = self.out.bodies.get(b).map_or(PointId::O, |body| body.centre);
                Some(Against::Point(centre, Some(BodyId(b))))
            }
            symbol => {
                let mut error = Diagnostic::new(
                    codes::CONTACT,
                    name.span,
                    format!("`against` needs a point or a body, but `{}` is {}", name.text, symbol.kind()),
                );
                if symbol == Symbol::Frame(0) {
                    error = error.help("leave `against` out: then a point fixed in N is struck");
                }
                self.report(error);
                None
            }
        }
    }

    /// The point of a frame that coincides with P: of its body if it has one, else of the frame itself, which
    /// turns about O or the point that is named.
    fn against_frame(
        &mut self,
        symbol: Symbol,
        name: &Name,
        about: Option<Name>,
        point: Option<PointId>,
    ) -> Option<Against> {
        let Symbol::Frame(frame) = symbol else { return None };
        let pivot = match &about {
            Some(about) => self.point_named(about)?,
            None => PointId::O,
        };
        let of = FrameId(frame);
        if self.frames[frame].broken {
            return None;
        }
        let bodies: Vec<usize> =
            (0..self.out.bodies.len()).filter(|b| self.out.bodies[*b].frame == Some(of)).collect();
        match (&bodies[..], &about) {
            ([body], None) => return Some(Against::Body(BodyId(*body))),
            ([_, _, ..], None) => {
                let message = format!("several bodies have the frame `{}`", name.text);
                let error = Diagnostic::new(codes::CONTACT, name.span, message);
                self.report(error.help("name the body that is struck"));
                return None;
            }
            _ => {}
        }
        let point = point?;
        let (a, b) = (self.points[point.0].root, self.points[pivot.0].root);
        if a != b {
            let unknown = if a != 0 { a } else { b };
            let (called, place) = (self.out.points[unknown].name.clone(), self.out.points[unknown].span);
            let message = format!("it is not known which point of `{}` is struck", name.text);
            let error = Diagnostic::new(codes::NO_POSITION, name.span, message)
                .related(place, format!("`{called}` is given by its velocity only"))
                .help("state its position, or name the point that is struck");
            self.report(error);
            return None;
        }
        let turning = Vector::AngularVelocity { of, in_frame: FrameId::N };
        let arm = Vector::Position { of: point, from: pivot };
        let turned = Vector::Cross(Box::new(turning), Box::new(arm));
        Some(Against::Velocity(match pivot {
            PointId::O => turned,
            pivot => Vector::Add(vec![Vector::Velocity(pivot), turned]),
        }))
    }

    /// Warns of what is declared and never used.
    pub(super) fn unused(&mut self) {
        let tree = self.tree;
        let mut warnings = Vec::new();
        let mut warn = |code, symbol: Symbol, name: &Name, what: &str, help: &str| {
            if !self.places.is_used(symbol) {
                let message = format!("the {what} `{}` is never used", name.text);
                warnings.push(Diagnostic::new(code, name.span, message).help(help));
            }
        };
        for (i, parameter) in tree.parameters.iter().enumerate() {
            warn(
                codes::UNUSED_PARAMETER,
                Symbol::Parameter(i),
                &parameter.name,
                "parameter",
                "remove it, or use it",
            );
        }
        for (i, input) in tree.inputs.iter().enumerate() {
            let help = "remove it, or use it under `loads`";
            warn(codes::UNUSED_INPUT, Symbol::Input(i), &input.name, "input", help);
        }
        for (i, definition) in tree.definitions.iter().enumerate() {
            warn(
                codes::UNUSED_DEFINITION,
                Symbol::Definition(i),
                &definition.name,
                "definition",
                "remove it, or use it",
            );
        }
        // one mistake may hide the use of many names
        if !self.diagnostics.iter().any(Diagnostic::hides_meaning) {
            self.diagnostics.extend(warnings);
        }
    }
}
