//! Contacts, and what is never used.

use super::super::mechanism::{Against, BodyId, Contact, PointId, Vector};
use super::super::names::Symbol;
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::syntax::tree::{ExprKind, Field, Name, Record};

impl Lowering<'_> {
    pub(super) fn contacts(&mut self) {
        let tree = self.tree;
        for record in &tree.contacts {
            self.contact(record);
        }
    }

    fn contact(&mut self, record: &Record) {
        let known = ["point", "against", "normal", "gap"];
        let [point, against, normal, gap] =
            self.record("a contact", &record.name, &record.fields, known, &["point", "normal"]);
        let mut body = None;
        let point = point.and_then(|field| {
            self.notes(field, &["of"]);
            body = self.note(field, "of").and_then(|name| self.body_named(name));
            self.name_in(field, "a point").and_then(|name| self.point_named(&name))
        });
        let against = against.map_or(Some(Against::Fixed), |field| self.against(field));
        let normal_span = normal.map_or(record.name.span, |field| field.value.span);
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
        let gap = gap.map(|field| {
            self.notes(field, &[]);
            let (scalar, typed) = self.scalar_like(&field.value, Dimension::of(1, 0, 0), "a gap")?;
            self.need_free_of_speeds(&typed, "a gap");
            Some(scalar)
        });
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
        self.out.contacts.push(Contact {
            name: record.name.text.clone(),
            docs: record.docs.clone(),
            point: point.unwrap_or(PointId::O),
            body,
            against: against.unwrap_or(Against::Fixed),
            normal: normal.unwrap_or(Vector::Zero),
            normal_span,
            gap: gap.flatten(),
            span: record.name.span,
        });
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
        let message = "which point of the body is struck is not known";
        let error = Diagnostic::new(codes::NO_POSITION, record.name.span, message)
            .related(place, format!("`{name}` is given by its velocity only"))
            .help("state its position, or name the point that is struck");
        self.report(error);
    }

    fn against(&mut self, field: &Field) -> Option<Against> {
        self.notes(field, &["velocity", "of"]);
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
        match self.resolve(&name, |s| matches!(s, Symbol::Point(_) | Symbol::Body(_)))? {
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
                    format!("a point or a body is struck, but `{}` is {}", name.text, symbol.kind()),
                );
                if symbol == Symbol::Frame(0) {
                    error = error.help("leave `against` out: then a point fixed in N is struck");
                }
                self.report(error);
                None
            }
        }
    }

    /// Warns of what is declared and never used.
    pub(super) fn unused(&mut self) {
        let tree = self.tree;
        let mut warnings = Vec::new();
        let mut warn = |code, symbol: Symbol, name: &Name, what: &str, help: &str| {
            if !self.used.contains(&symbol) {
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
