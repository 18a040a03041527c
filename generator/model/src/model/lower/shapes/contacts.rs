//! Lowers contacts between shapes to contacts of points with normals and gaps.

use super::super::super::hulls::{Hull, NoHull};
use super::super::super::mechanism::{
    Against, Anchor, BodyId, Contact, FrameId, Kind, PointId, Scalar, Shape, ShapeId, Vector,
};
use super::super::super::names::Symbol;
use super::super::super::pairs::{self, MOST_CONTACTS, Outline, Pair};
use super::super::Lowering;
use super::boxes;
use super::capsule_on_box;
use super::capsule_on_polytope;
use super::clearance;
use super::closed_forms::touches;
use super::ellipsoids;
use super::features::Touch;
use super::polytopes;
use super::round_on_surface;
use super::solids::corners_of_a_cube;
use super::sphere_on_polytope;
use super::sphere_on_surface;
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::syntax::tree::{Field, Name, Record};

impl Lowering<'_> {
    /// The contacts of a pair, one for each of its names.
    pub(in crate::model::lower) fn contacts_of_shapes(
        &mut self,
        record: &Record,
        pair: Pair<'_>,
        names: &[&Name],
    ) {
        let before = self.mistakes();
        let touches = self.pair(record, pair);
        let fields: Vec<Field> =
            record.fields.iter().filter(|f| f.name != pair.field.name).cloned().collect();
        for field in fields.iter().filter(|field| field.name.text != "surface") {
            let follows = ["point", "against", "normal", "gap"].contains(&field.name.text.as_str());
            let what = if follows { "follows from the shapes" } else { "is no field of a contact of shapes" };
            let message = format!("`{}` {what}", field.name.text);
            let error = Diagnostic::new(codes::FIELD, field.name.span, message);
            self.report(error.help("two shapes have a `surface` besides: friction and restitution"));
        }
        let mut surfaces = fields.iter().filter(|field| field.name.text == "surface");
        let surface = surfaces.next();
        for (again, first) in surfaces.zip(surface.into_iter().cycle()) {
            self.given_twice(again, first);
        }
        let (surface, law) = surface.map(|field| self.surface(field)).unzip();
        let law = law.unwrap_or_default();
        let turning = match &touches {
            Some((ids, _)) if law.asks_for_rotation() => self.turning_of_shapes(record, *ids),
            _ => None,
        };
        let readable = touches.is_some() && self.mistakes() == before;
        let (ids, touches) = touches.map_or((None, Vec::new()), |(ids, touches)| (Some(ids), touches));
        let mut clearance = ids.and_then(|ids| {
            let pair = ids.map(|id| &self.out.shapes[id.0]);
            clearance::of_pair(pair, touches.len(), &mut self.out.definitions, record.name.span)
        });
        let first_of_pair = clearance.as_ref().map(|_| self.out.contacts.len());
        let mut touches = touches.into_iter();
        for name in names {
            let parts = match (touches.next(), ids) {
                (Some(touch), Some(ids)) => self.parts(name, &record.docs, ids, touch),
                _ => Parts::none(),
            };
            let plane = ids.map(|ids| &self.out.shapes[ids[1].0]).filter(|shape| shape.kind.is_flat());
            let (span, struck) = (record.name.span, pair.struck.span);
            let contact = Contact {
                name: name.text.clone(),
                docs: record.docs.clone(),
                point: parts.point,
                body: parts.body,
                against: parts.against,
                normal: parts.normal,
                point_span: pair.field.value.span,
                against_span: struck,
                normal_span: plane.map_or(span, |plane| plane.axis_span),
                gap: parts.gap,
                // nothing is to be said of a gap where a pair could not be read
                without_gap: ids.is_none(),
                validity: parts.validity,
                tangent: parts.tangent,
                clearance: clearance.take(),
                first_of_pair,
                gap_span: pair.field.value.span.to(struck),
                surface,
                law: law.clone(),
                shapes: ids,
                turning,
                span,
            };
            self.readable.contacts.push(readable);
            self.out.contacts.push(contact);
        }
    }

    /// The two shapes of a contact, and where they touch.
    fn pair(&mut self, record: &Record, pair: Pair<'_>) -> Option<([ShapeId; 2], Vec<Touch>)> {
        let first = Name { text: pair.striking.to_owned(), span: pair.field.value.span };
        let ids = [&first, pair.struck].map(|name| self.shape_named(name));
        let [Some(a), Some(b)] = ids else { return None };
        if ![a, b].iter().all(|id| self.readable.shapes.get(id.0).copied().unwrap_or(false)) {
            return None;
        }
        let shapes = [a, b].map(|id| self.out.shapes[id.0].clone());
        let [striking, struck] = &shapes;
        let span = pair.field.value.span.to(pair.struck.span);
        let moves_together = match (striking.body, struck.body) {
            (Some(a), Some(b)) => a == b,
            (None, None) => striking.frame == struck.frame,
            _ => false,
        };
        if moves_together || a == b {
            let message = format!("`{}` and `{}` move together: they never meet", striking.name, struck.name);
            let error = Diagnostic::new(codes::CONTACT, span, message);
            self.report(error.help("a contact is between shapes of two bodies, or of a body and N"));
            return None;
        }
        let of = |shape: &Shape| Outline::of(shape.kind, shape.vertices.len(), self.hull(shape).ok());
        let Some(count) = pairs::contacts(of(striking), pair.inside(), of(struck)) else {
            self.refuse(striking, pair, struck, span);
            return None;
        };
        if count > MOST_CONTACTS {
            let message = format!(
                "`{}` and `{}` would have {count} contacts, of vertices with faces and of edges with edges: \
                 more than {MOST_CONTACTS}",
                striking.name, struck.name
            );
            let help = "take simpler polytopes: the number grows with the product of their numbers of edges";
            self.report(Diagnostic::new(codes::PAIR, span, message).help(help));
            return None;
        }
        let roots = [striking, struck].map(|shape| self.points[shape.at.point.0].root);
        if roots[0] != roots[1] {
            let unknown = if roots[0] != 0 { roots[0] } else { roots[1] };
            let (name, place) = (self.out.points[unknown].name.clone(), self.out.points[unknown].span);
            let message = format!("the distance of `{}` and `{}` is not known", striking.name, struck.name);
            let error = Diagnostic::new(codes::NO_POSITION, record.name.span, message);
            let error = error.related(place, format!("`{name}` is given by its velocity only"));
            self.report(error.help("state its position"));
            return None;
        }
        let at = record.name.span;
        let touches = match (striking.kind, pair.inside(), struck.kind) {
            (Kind::Box, false, Kind::Box) => boxes::between(striking, struck, &mut self.out.definitions, at),
            (Kind::Polytope, false, Kind::Box | Kind::Polytope) | (Kind::Box, false, Kind::Polytope) => {
                let (own, other) = (self.solid(striking, span)?, self.solid(struck, span)?);
                let definitions = &mut self.out.definitions;
                polytopes::between([striking, struck], [&own, &other], definitions, at)
            }
            (Kind::Sphere, false, Kind::Polytope) => {
                let hull = self.solid(struck, span)?;
                sphere_on_polytope::between([striking, struck], &hull, &mut self.out.definitions, at)
            }
            (Kind::Capsule, false, Kind::Polytope) => {
                let hull = self.solid(struck, span)?;
                capsule_on_polytope::between([striking, struck], &hull, &mut self.out.definitions, at)
            }
            (Kind::Capsule, false, Kind::Box | Kind::Rectangle) => {
                capsule_on_box::between(striking, struck, &mut self.out.definitions, at)
            }
            (Kind::Sphere, false, Kind::Ellipsoid) => {
                ellipsoids::under_sphere([striking, struck], &mut self.out.definitions, at)
            }
            (Kind::Ellipsoid, false, Kind::Ellipsoid) => {
                ellipsoids::between([striking, struck], &mut self.out.definitions, at)
            }
            (Kind::Sphere, false, Kind::Surface | Kind::Curve) => {
                sphere_on_surface::between([striking, struck], &mut self.out.definitions, at)
            }
            (Kind::Sphere, false, Kind::Implicit)
            | (
                Kind::Disc | Kind::Torus | Kind::Ellipsoid,
                false,
                Kind::Surface | Kind::Curve | Kind::Implicit,
            ) => round_on_surface::between([striking, struck], &mut self.out.definitions, at),
            (_, inside, _) => touches(striking, inside, struck, span),
        };
        Some(([a, b], touches))
    }

    /// The hull of a polytope.
    fn hull(&self, shape: &Shape) -> Result<&Hull, NoHull> {
        self.hulls.get(&shape.name).map_or(Err(NoHull::Unknown), |hull| hull.as_ref().map_err(|why| *why))
    }

    /// The hull of a box or polytope, whose contacts or mass follow from its faces and edges.
    pub(super) fn solid(&mut self, shape: &Shape, span: Span) -> Option<Hull> {
        if shape.kind == Kind::Box {
            return Hull::of(&corners_of_a_cube()).ok();
        }
        let why = match self.hull(shape) {
            Ok(hull) => return Some(hull.clone()),
            Err(why) => why,
        };
        let name = &shape.name;
        let (message, help) = match why {
            NoHull::Flat => (
                format!("`{name}` is no solid: all of its vertices are in one plane"),
                "a solid has at least four vertices that are not in one plane, with the values that the model gives",
            ),
            NoHull::NoVertex(vertex) => (
                format!("point {} of `{name}` is no vertex", vertex + 1),
                "it lies within the hull of the others, or where another is: leave it out",
            ),
            NoHull::Unknown => (
                format!("the faces of `{name}` are not known"),
                "they follow from the places of its vertices, with the values that the model gives to its parameters",
            ),
        };
        let error = Diagnostic::new(codes::PAIR, span, message);
        self.report(error.related(shape.span, "its vertices").help(help));
        None
    }

    /// A pair between which no contact is compiled.
    fn refuse(&mut self, striking: &Shape, pair: Pair<'_>, struck: &Shape, span: Span) {
        let word = &pair.word.text;
        let message = format!(
            "`{}` is {} and `{}` {}: no contact of one {word} the other is compiled",
            striking.name,
            striking.kind.with_article(),
            struck.name,
            struck.kind.with_article()
        );
        let [own, other] =
            [striking, struck].map(|shape| Outline::of(shape.kind, shape.vertices.len(), None));
        let turned = pairs::contacts(other, pair.inside(), own);
        let help = match (turned, pairs::possible(striking.kind)) {
            (Some(_), _) => format!("write `{} {word} {}`", struck.name, striking.name),
            (None, list) if list.is_empty() => {
                format!("{} is struck, it does not strike: state it second", striking.kind.with_article())
            }
            (None, list) => {
                format!("{} can be {}", striking.kind.with_article(), list.join("; and "))
            }
        };
        self.report(Diagnostic::new(codes::PAIR, span, message).help(help));
    }

    fn shape_named(&mut self, name: &Name) -> Option<ShapeId> {
        match self.resolve(name, |s| matches!(s, Symbol::Shape(_)))? {
            Symbol::Shape(i) => Some(ShapeId(i)),
            other => {
                let is = format!("`{}` is {}", name.text, other.kind());
                self.wrong_kind(name, "a shape", &is);
                None
            }
        }
    }

    /// The parts of a contact that follow from where two shapes touch.
    fn parts(&mut self, name: &Name, docs: &str, ids: [ShapeId; 2], touch: Touch) -> Parts {
        let [striking, struck] = ids.map(|id| self.out.shapes[id.0].clone());
        let bodies = &self.out.bodies;
        let is_particle = |shape: &Shape| shape.body.is_some_and(|body| bodies[body.0].frame.is_none());
        // a particle is where its centre is: nothing of it turns
        let (of_particle, on_particle) = (is_particle(&striking), is_particle(&struck));
        let point = if of_particle {
            striking.at.point
        } else {
            let nearest = format!("where `{}` is nearest to `{}`", striking.name, struck.name);
            let docs = if docs.is_empty() { nearest } else { docs.to_owned() };
            self.hidden_point(name.text.clone(), docs, striking.frame, &touch.point, name.span)
        };
        let against = match struck.body {
            None if struck.frame == FrameId::N => Against::Fixed,
            Some(body) if on_particle => Against::Point(struck.at.point, Some(body)),
            Some(body) if !of_particle => Against::Body(body),
            body => {
                // the matter of the frame, or of the body, that is at the place of contact
                let origin = Anchor { point: struck.at.point, by: Vector::Zero };
                let there = Anchor { by: touch.point.from(&origin), ..origin };
                let docs = format!("what of `{}` is nearest to `{}`", struck.name, striking.name);
                let name_of_it = format!("{}_struck", name.text);
                Against::Point(self.hidden_point(name_of_it, docs, struck.frame, &there, name.span), body)
            }
        };
        let (normal, gap, validity) = (touch.normal, Some(touch.gap), touch.validity);
        Parts { point, body: striking.body, against, normal, gap, validity, tangent: touch.tangent }
    }
}

/// What two shapes give to a contact.
struct Parts {
    point: PointId,
    body: Option<BodyId>,
    against: Against,
    normal: Vector,
    gap: Option<Scalar>,
    validity: Option<Scalar>,
    tangent: Option<Vector>,
}

impl Parts {
    /// Those of a pair that could not be read.
    fn none() -> Self {
        let (against, normal) = (Against::Fixed, Vector::Zero);
        Parts { point: PointId::O, body: None, against, normal, gap: None, validity: None, tangent: None }
    }
}
