//! Lowers shapes, and what follows from them: contacts between shapes, and the mass properties of bodies.

mod algebra;
mod bodies;
mod boxes;
mod capsule_on_box;
mod capsule_on_polytope;
mod clearance;
mod closed_forms;
mod colours;
mod contacts;
mod ellipsoids;
mod faces;
mod features;
mod iterations;
mod mass_of_polytope;
mod masses;
mod of_place;
mod polytopes;
mod round;
mod round_on_surface;
mod segment;
mod separation;
mod shared;
mod sizes;
mod solids;
mod sphere_on_polytope;
mod sphere_on_surface;

pub(super) use bodies::shape_field;
pub(super) use of_place::PLACES;

use super::super::mechanism::{Anchor, BodyId, FrameId, Kind, PointId, Shape, Vector};
use super::super::names::Symbol;
use super::super::typed::Typed;
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::span::Span;
use crate::syntax::tree::{ExprKind, Field, Name, Record};
use crate::{suggest, vocabulary, words};

/// What carries a shape.
struct Carrier {
    frame: FrameId,
    body: Option<BodyId>,
    /// where its place is if it is not stated
    place: Option<PointId>,
}

impl Lowering<'_> {
    pub(super) fn shapes(&mut self) {
        let tree = self.tree;
        for record in &tree.shapes {
            let before = self.mistakes();
            let shape = self.shape(record);
            self.readable.shapes.push(shape.is_some() && self.mistakes() == before);
            self.out.shapes.push(shape.unwrap_or_else(|| unread(record)));
        }
    }

    /// A shape; `None` if a part of it could not be read.
    fn shape(&mut self, record: &Record) -> Option<Shape> {
        let (kind, field) = self.kind(record)?;
        let other = |word: &str| record.fields.iter().find(|field| field.name.text == word);
        let carrier = self.carrier(other("of"), record);
        let (sizes, size_spans) = self.sizes(kind, field).unzip();
        let (vertices, height) = (self.vertices(kind, field), self.height(kind, field));
        let function = self.function(kind, field);
        let axis = self.axis(kind, field, other("axis"), &record.name);
        let density = other("density").map(|field| self.density(field));
        let colour = other("colour").map(|field| self.colour(field));
        let carrier = carrier?;
        let at = self.at(kind, other("at"), &carrier, &record.name, vertices.as_deref());
        let axes = self.axes(kind, other("axes"), &carrier, &record.name);
        let particle =
            carrier.body.filter(|body| self.out.bodies.get(body.0).is_some_and(|body| body.frame.is_none()));
        if particle.is_some() && (kind != Kind::Sphere || other("at").is_some()) {
            let message = "a particle is a point: only a sphere about it is its shape";
            let error = Diagnostic::new(codes::SHAPE, field.name.span, message);
            self.report(error.help(match kind {
                Kind::Sphere => "leave `at` out, or give it a frame and inertia under `bodies`",
                _ => "give it a frame and inertia under `bodies`",
            }));
            return None;
        }
        let span_of = |field: Option<&Field>| field.map_or(record.name.span, |field| field.value.span);
        Some(Shape {
            name: record.name.text.clone(),
            docs: record.docs.clone(),
            kind,
            frame: carrier.frame,
            body: carrier.body,
            at: at?,
            sizes: sizes?,
            axis: axis?,
            axes: axes?,
            vertices: vertices?,
            height: height?,
            function: function?,
            density: match density {
                Some(density) => Some(density?),
                None => None,
            },
            colour: match colour {
                Some(colour) => Some(colour?),
                None => None,
            },
            at_span: span_of(other("at")),
            size_spans: size_spans.unwrap_or_default(),
            axis_span: if kind.is_flat() { field.value.span } else { span_of(other("axis")) },
            span: record.name.span,
        })
    }

    /// The field that says what the shape is. Unknown, repeated and missing fields are reported.
    fn kind<'r>(&mut self, record: &'r Record) -> Option<(Kind, &'r Field)> {
        let mut found: Option<(Kind, &Field)> = None;
        let mut wrong = false;
        for (i, field) in record.fields.iter().enumerate() {
            let word = field.name.text.as_str();
            let notes: &[&str] = &[];
            self.notes(field, notes);
            if let Some(first) = record.fields[..i].iter().find(|other| other.name.text == word) {
                let message = format!("`{word}` is given twice");
                let error = Diagnostic::new(codes::FIELD, field.name.span, message);
                self.report(error.related(first.name.span, "first here"));
                wrong = true;
                continue;
            }
            match (Kind::of_word(word), found) {
                (Some(_), Some((first, at))) => {
                    let message = format!("`{}` is {} already", record.name.text, first.with_article());
                    let error = Diagnostic::new(codes::SHAPE, field.name.span, message);
                    self.report(error.related(at.name.span, "stated here").help("a shape is one thing"));
                    wrong = true;
                }
                (Some(kind), None) => found = Some((kind, field)),
                (None, _) if words::SHAPE.contains(&word) => {}
                // what could not be read is said already
                (None, _) if matches!(field.value.kind, ExprKind::Error) => wrong = true,
                (None, _) => {
                    let known: Vec<&str> =
                        Kind::ALL.iter().map(|kind| kind.word()).chain(words::SHAPE).collect();
                    let message = format!("there is no shape and no field `{word}`");
                    let error = Diagnostic::new(codes::FIELD, field.name.span, message);
                    let near =
                        vocabulary::shape(word).or_else(|| suggest::nearest(word, known.iter().copied()));
                    self.report(match near {
                        Some(near) => error.did_you_mean(near),
                        None => error.help(format!("what there is: {}", known.join(", "))),
                    });
                    wrong = true;
                }
            }
        }
        if found.is_none() && !wrong {
            let message = format!("it is not said what `{}` is", record.name.text);
            let words: Vec<&str> = Kind::ALL.iter().map(|kind| kind.word()).collect();
            let help = format!("add one of {}, as in `sphere: r`", words.join(", "));
            self.report(Diagnostic::new(codes::SHAPE, record.name.span, message).help(help));
        }
        found.filter(|_| !wrong)
    }

    /// What `of` names; without it the shape is fixed in N.
    fn carrier(&mut self, of: Option<&Field>, record: &Record) -> Option<Carrier> {
        let Some(field) = of else {
            return Some(Carrier { frame: FrameId::N, body: None, place: Some(PointId::O) });
        };
        let ExprKind::Name(text) = &field.value.kind else {
            if !matches!(field.value.kind, ExprKind::Error) {
                let message = "`of` names the body, particle or frame with which the shape moves";
                let error = Diagnostic::new(codes::WRONG_KIND, field.value.span, message);
                self.report(error.help(format!("write `{} {{ of: Body, .. }}`", record.name.text)));
            }
            return None;
        };
        let name = Name { text: text.clone(), span: field.value.span };
        match self.resolve(&name, |s| matches!(s, Symbol::Frame(_) | Symbol::Body(_)))? {
            Symbol::Body(b) => {
                let body = self.out.bodies.get(b)?;
                let (frame, centre) = (body.frame.unwrap_or(FrameId::N), body.centre);
                let stated = self.readable.bodies.get(b).copied().unwrap_or(false);
                stated.then_some(Carrier { frame, body: Some(BodyId(b)), place: Some(centre) })
            }
            Symbol::Frame(f) => {
                let mut bodies =
                    (0..self.out.bodies.len()).filter(|b| self.out.bodies[*b].frame == Some(FrameId(f)));
                let body = match (bodies.next(), bodies.next()) {
                    (Some(body), None) => Some(BodyId(body)),
                    _ => None,
                };
                let place = match body {
                    Some(body) => Some(self.out.bodies[body.0].centre),
                    None => (f == 0).then_some(PointId::O),
                };
                (!self.frames[f].broken).then_some(Carrier { frame: FrameId(f), body, place })
            }
            other => {
                self.wrong_kind(&name, "a body or a frame", &format!("`{text}` is {}", other.kind()));
                None
            }
        }
    }

    /// Where the shape is: stated, or the mass centre of its body, or O.
    fn at(
        &mut self,
        kind: Kind,
        at: Option<&Field>,
        carrier: &Carrier,
        name: &Name,
        vertices: Option<&[Anchor]>,
    ) -> Option<Anchor> {
        if let Some(field) = at {
            let anchor = self.anchor(&field.value)?;
            return (!self.points[anchor.point.0].broken).then_some(anchor);
        }
        if let (Kind::Polytope, Some([first, ..])) = (kind, vertices) {
            return Some(first.clone());
        }
        if let Some(point) = carrier.place {
            return Some(Anchor { point, by: Vector::Zero });
        }
        let frame = self.out.frames[carrier.frame.0].name.clone();
        let message = format!("it is not said where `{}` is", name.text);
        let error = Diagnostic::new(codes::SHAPE, name.span, message);
        self.report(error.help(format!("add `at: P`, a point that moves with `{frame}`")));
        None
    }

    /// A point, or a point and a vector.
    fn anchor(&mut self, value: &crate::syntax::tree::Expr) -> Option<Anchor> {
        let (point, by, _) = self.offset(value)?;
        Some(Anchor { point, by })
    }

    /// The axis of a shape that turns, or the normal of a plane.
    fn axis(
        &mut self,
        kind: Kind,
        own: &Field,
        stated: Option<&Field>,
        name: &Name,
    ) -> Option<Option<Vector>> {
        let field = match (kind.is_flat(), kind.turns(), stated) {
            (true, _, None) => own,
            (_, true, Some(field)) => field,
            (_, true, None) => {
                let message = format!("`{}` has no axis", name.text);
                let error = Diagnostic::new(codes::SHAPE, name.span, message);
                self.report(error.help(format!("{} lies along `axis: B.z`", kind.with_article())));
                return None;
            }
            (flat, _, Some(field)) => {
                let message = format!("{} has no `axis`", kind.with_article());
                let error = Diagnostic::new(codes::SHAPE, field.name.span, message);
                self.report(match flat {
                    true => error.help(format!("its normal stands at once: `{}: N.y`", kind.word())),
                    false if kind.has_axes() => error.help("it lies along those of a frame: `axes: B`"),
                    false => error,
                });
                return None;
            }
            _ => return Some(None),
        };
        let what = if kind.is_flat() { "the normal of a plane" } else { "the axis of a shape" };
        let typed: Typed = self.expression(&field.value);
        if typed.is_zero() {
            let error = Diagnostic::new(codes::SHAPE, typed.span, format!("{what} is the zero vector"));
            self.report(error.help("it is a unit vector, such as `N.y`"));
            return None;
        }
        let vector = self.need_vector(&typed, what)?;
        self.demand(&typed, Dimension::none(), what);
        self.need_free_of_speeds(&typed, what);
        self.need_rate(&typed, what);
        Some(Some(vector))
    }

    /// The frame along whose axes the shape lies: its own, or the one that is stated.
    fn axes(
        &mut self,
        kind: Kind,
        stated: Option<&Field>,
        carrier: &Carrier,
        name: &Name,
    ) -> Option<Option<FrameId>> {
        match (kind.has_axes(), stated) {
            (false, None) => Some(None),
            (false, Some(field)) => {
                let message = format!("{} has no `axes`", kind.with_article());
                let error = Diagnostic::new(codes::SHAPE, field.name.span, message);
                self.report(match kind.turns() {
                    true => error.help("its direction is `axis: B.z`"),
                    false => error,
                });
                None
            }
            (true, Some(field)) => {
                let name = self.name_in(field, "a frame")?;
                let frame = self.proper_frame(&name)?;
                self.need_axes(frame, name.span).map(Some)
            }
            (true, None) => self.need_axes(carrier.frame, name.span).map(Some),
        }
    }

    /// A point that the model does not name.
    fn hidden_point(
        &mut self,
        name: String,
        docs: String,
        frame: FrameId,
        at: &Anchor,
        span: Span,
    ) -> PointId {
        use super::super::mechanism::{Place, Point};
        let place = Place::Material { frame, from: at.point, by: at.by.clone() };
        self.out.points.push(Point { name, docs, place, velocity: None, span, motion_span: span });
        self.points.push(self.points[at.point.0].clone());
        PointId(self.out.points.len() - 1)
    }
}

/// Holds the place of a shape that could not be read.
fn unread(record: &Record) -> Shape {
    let span = record.name.span;
    Shape {
        name: record.name.text.clone(),
        docs: String::new(),
        kind: Kind::Sphere,
        frame: FrameId::N,
        body: None,
        at: Anchor { point: PointId::O, by: Vector::Zero },
        sizes: Vec::new(),
        axis: None,
        axes: None,
        vertices: Vec::new(),
        height: None,
        function: None,
        density: None,
        colour: None,
        at_span: span,
        size_spans: Vec::new(),
        axis_span: span,
        span,
    }
}
