//! Gives bodies the mass properties of their shapes.

use super::super::super::mechanism::{Anchor, Body, FrameId, Inertia, Kind, PointId, Scalar, Shape, Vector};
use super::super::super::names::Symbol;
use super::super::Lowering;
use super::algebra::total;
use super::mass_of_polytope;
use super::masses::mass_properties;
use crate::diagnostics::{Diagnostic, codes};
use crate::number::Number;
use crate::syntax::tree::{ExprKind, Field, Name, Record};
use crate::words;

impl Lowering<'_> {
    /// A body whose mass and inertia are those of a shape, before the shapes are known; `None` if a part of it
    /// could not be read. Its mass centre may be left out.
    pub(in crate::model::lower) fn body_of_shape(&mut self, record: &Record) -> Option<()> {
        let known = words::BODY_OF_SHAPE;
        let [frame, centre, shape] =
            self.record("a body with a shape", &record.name, &record.fields, known, &["frame", "shape"]);
        for field in [frame, centre, shape].into_iter().flatten() {
            self.notes(field, &[]);
        }
        let frame =
            frame.and_then(|field| self.name_in(field, "a frame")).and_then(|name| self.proper_frame(&name));
        let named = centre.map(|field| {
            let point = self.name_in(field, "a point").and_then(|name| self.point_named(&name));
            point.filter(|point| !self.points[point.0].broken)
        });
        let place = match named {
            Some(point) => point,
            None => shape.and_then(|field| self.place_of_shape(record, field)),
        };
        let frame_read = |frame: FrameId| !self.frames[frame.0].broken;
        let read = frame.is_some_and(frame_read) && place.is_some();
        let span = shape.map_or(record.name.span, |field| field.value.span);
        self.readable.masses.push(read);
        self.out.bodies.push(Body {
            name: record.name.text.clone(),
            docs: record.docs.clone(),
            frame: Some(frame.unwrap_or(FrameId::N)),
            centre: place.unwrap_or(PointId::O),
            mass: Scalar::Number(Number::integer(0)),
            mass_span: span,
            inertia: None,
            span: record.name.span,
        });
        read.then_some(())
    }

    /// The point from which the shape of a body is placed: until its mass centre is known, that of the body.
    fn place_of_shape(&mut self, body: &Record, shape: &Field) -> Option<PointId> {
        let ExprKind::Name(name) = &shape.value.kind else { return None };
        let record = self.tree.shapes.iter().find(|record| record.name.text == *name)?;
        let at = record.fields.iter().find(|field| field.name.text == "at");
        let term = at.and_then(|at| {
            let terms: Vec<_> = match &at.value.kind {
                ExprKind::Sum(terms) => terms.iter().map(|(_, term)| term).collect(),
                _ => vec![&at.value],
            };
            terms.into_iter().find_map(|term| match &term.kind {
                ExprKind::Name(text) => match self.names.get(text) {
                    Some(Symbol::Point(point)) => Some(PointId(point)),
                    _ => None,
                },
                _ => None,
            })
        });
        if term.is_none() && !self.diagnostics.iter().any(Diagnostic::hides_meaning) {
            let message = format!("it is not known where the mass centre of `{}` is", body.name.text);
            let error = Diagnostic::new(codes::BODY, body.name.span, message);
            self.report(error.help(format!("add `centre: G`, or place the shape: `{name} {{ at: P, .. }}`")));
        }
        term
    }

    /// Mass, inertia and mass centre of the bodies that take them from shapes.
    pub(in crate::model::lower) fn masses_of_shapes(&mut self) {
        let tree = self.tree;
        for (i, record) in tree.bodies.iter().enumerate() {
            let Some(field) = shape_field(record) else { continue };
            let before = self.mistakes();
            let given = self.readable.bodies[i] && self.mass_of_shape(i, record, field).is_some();
            let read = given && self.mistakes() == before;
            self.readable.bodies[i] = read;
            self.readable.masses[i] = read;
        }
    }

    fn mass_of_shape(&mut self, i: usize, record: &Record, field: &Field) -> Option<()> {
        let ExprKind::Name(text) = &field.value.kind else {
            if !matches!(field.value.kind, ExprKind::Error) {
                let error =
                    Diagnostic::new(codes::WRONG_KIND, field.value.span, "`shape` needs the name of a shape");
                self.report(error.help("declare it under `shapes`, with a density, and write its name here"));
            }
            return None;
        };
        let name = Name { text: text.clone(), span: field.value.span };
        let shape = match self.resolve(&name, |symbol| matches!(symbol, Symbol::Shape(_)))? {
            Symbol::Shape(shape) => shape,
            other => {
                self.wrong_kind(&name, "a shape", &format!("`{text}` is {}", other.kind()));
                return None;
            }
        };
        if !self.readable.shapes.get(shape).copied().unwrap_or(false) {
            return None;
        }
        let shape: Shape = self.out.shapes[shape].clone();
        let frame = self.out.bodies[i].frame;
        if Some(shape.frame) != frame {
            let message = format!("`{text}` does not move with `{}`", record.name.text);
            let error = Diagnostic::new(codes::SHAPE, name.span, message).related(shape.span, "this shape");
            self.report(error.help(format!("write `{text} {{ of: {}, .. }}`", record.name.text)));
            return None;
        }
        let of_polytope = match (&shape.density, shape.kind) {
            (Some(density), Kind::Polytope) => {
                let hull = self.solid(&shape, name.span)?;
                let definitions = &mut self.out.definitions;
                Some(mass_of_polytope::mass_properties(&shape, &hull, density, definitions, name.span))
            }
            _ => None,
        };
        let properties = match of_polytope.map_or_else(|| mass_properties(&shape), Ok) {
            Ok(properties) => properties,
            Err(why) => {
                let message = format!("the mass of `{text}` is not known: {why}");
                let error = Diagnostic::new(codes::SHAPE, name.span, message);
                let error = error.related(shape.span, format!("`{text}` is {}", shape.kind.with_article()));
                self.report(match shape.density {
                    None => error.help("add `density: rho`, a parameter in kg/m^3"),
                    Some(_) => error,
                });
                return None;
            }
        };
        let ([xx, yy, zz], [xy, yz, zx]) = (properties.inertia, properties.products);
        // of a ball the components are the same along all axes, and a frame made by `spin` has none
        let axes = if self.frames[properties.frame.0].no_axes { FrameId::N } else { properties.frame };
        let by = total([shape.at.by.clone(), properties.centre]);
        let stated = record.fields.iter().find(|field| field.name.text == "centre");
        if let Some(centre) = stated {
            // elsewhere, mass and inertia of the shape would be put at a point that is not its centre
            let coincides = matches!(by, Vector::Zero) && shape.at.point == self.out.bodies[i].centre;
            if !coincides {
                let message = format!("the mass centre of `{}` follows from its shape", record.name.text);
                let error = Diagnostic::new(codes::SHAPE, centre.value.span, message);
                let error = error.related(shape.at_span, format!("`{text}` is placed here"));
                self.report(error.help(format!(
                    "leave `centre` out and state `at` of `{text}`, or name the point at which the centre of `{text}` is placed"
                )));
                return None;
            }
        } else {
            let at = Anchor { point: shape.at.point, by: by.clone() };
            self.out.bodies[i].centre = match by {
                Vector::Zero => at.point,
                _ => {
                    let docs = format!("the mass centre of `{}`", record.name.text);
                    let name = format!("{}_centre", record.name.text);
                    self.hidden_point(name, docs, shape.frame, &at, record.name.span)
                }
            };
        }
        let body = &mut self.out.bodies[i];
        body.mass = properties.mass;
        body.inertia = Some(Inertia {
            components: Box::new([xx, yy, zz, xy, yz, zx]),
            frame: axes,
            about: None,
            span: field.value.span,
        });
        Some(())
    }
}

/// The field `shape` of a body.
pub(in crate::model::lower) fn shape_field(record: &Record) -> Option<&Field> {
    record.fields.iter().find(|field| field.name.text == "shape")
}
