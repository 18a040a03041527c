//! Checks shapes by numbers: whether they move with what they are said to be of, their axes, their sizes, and
//! the mass centres of the bodies that they make.

use super::bodies::number;
use super::implicit_surfaces::implicit_surface;
use super::states::{Seen, at_rest};
use super::unit_vectors::length_shown;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::hyper_dual::HyperDual;
use crate::numeric::views::{cross3, dot3, norm3, sub3};
use crate::numeric::{Failure, Level, State, Views};
use crate::span::Span;

/// A place or axis that leaves its frame by this share of its velocity is not fixed in it.
const SLIP: f64 = 1e-9;

/// What is wrong with shapes, each with the number of the shape.
pub fn shapes(m: &Mechanism, state: Option<&State>, seen: &[Seen<'_>]) -> Vec<(ShapeId, Diagnostic)> {
    let mut out = Vec::new();
    let sizes = state.map(|state| impossible_sizes(m, state)).unwrap_or_default();
    for (i, shape) in m.shapes.iter().enumerate() {
        let size = sizes.iter().find(|found| found.shape == ShapeId(i));
        let found = size
            .map(|found| impossible_size(shape, *found))
            .or_else(|| state.and_then(|state| impossible_density(m, state, shape)))
            .or_else(|| implicit_surface(m, state?, shape))
            .or_else(|| stranger(m, shape, seen))
            .or_else(|| long_axis(m, shape, seen))
            .or_else(|| turning_axis(m, shape, seen));
        out.extend(found.map(|found| (ShapeId(i), found)));
    }
    for contact in &m.contacts {
        let Some(pair) = contact.shapes else { continue };
        if !out.iter().any(|(shape, _)| pair.contains(shape)) {
            out.extend(out_of_plane(m, contact, pair, seen).map(|found| (pair[1], found)));
        }
    }
    out
}

/// A rectangle and another shape that do not move in one plane.
fn out_of_plane(
    m: &Mechanism,
    contact: &Contact,
    pair: [ShapeId; 2],
    seen: &[Seen<'_>],
) -> Option<Diagnostic> {
    let shapes = pair.map(|id| &m.shapes[id.0]);
    let [other, rectangle] = match (shapes[0].kind, shapes[1].kind) {
        (_, Kind::Rectangle) => shapes,
        (Kind::Rectangle, _) => [shapes[1], shapes[0]],
        _ => return None,
    };
    let tilted = seen.iter().any(|seen| {
        let views = &seen.views.now;
        let off = || -> Result<f64, Failure> {
            let z = |frame: FrameId| Ok(views.orientation(frame)?.map(|row| row[2].re));
            let own = z(rectangle.axes.unwrap_or(rectangle.frame))?;
            let place = |anchor: &Anchor| -> Result<[f64; 3], Failure> {
                let (at, by) = (views.position(anchor.point)?, views.vector(&anchor.by, Level::Geometry)?);
                Ok([0, 1, 2].map(|i| at[i].re + by[i].re))
            };
            if other.kind.is_flat() {
                let normal = other
                    .axis
                    .as_ref()
                    .map_or(Ok([0.0; 3]), |axis| Ok(views.vector(axis, Level::Geometry)?.map(|c| c.re)))?;
                return Ok(dot3(normal, own).abs());
            }
            let apart = sub3(place(&rectangle.at)?, place(&other.at)?);
            let across = dot3(apart, own).abs() / (1.0 + norm3(apart));
            let turned = match other.axes {
                Some(axes) => norm3(cross3(z(axes)?, own)),
                None => 0.0,
            };
            Ok(across.max(turned))
        };
        off().is_ok_and(|off| off > SLIP)
    });
    tilted.then(|| {
        let [first, second] = shapes.map(|shape| &shape.name);
        let message = format!("`{first}` and `{second}` do not move in one plane");
        let help = format!(
            "`{}` is a rectangle in the plane of x and y of its axes: in space, make it a `box`",
            rectangle.name
        );
        Diagnostic::new(codes::PAIR, contact.span, message).help(help)
    })
}

/// A dimension of a shape that is not positive with some values of the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpossibleSize {
    /// of this shape
    pub shape: ShapeId,
    /// such as `radius`
    pub name: &'static str,
    /// m
    pub value: f64,
    /// where it is stated
    pub span: Span,
}

/// The dimensions of shapes that are not positive with the parameters of a state. What has no value there is
/// passed over.
pub fn impossible_sizes(m: &Mechanism, state: &State) -> Vec<ImpossibleSize> {
    let values = at_rest(m, state);
    let mut found = Vec::new();
    for (i, shape) in m.shapes.iter().enumerate() {
        for Size { name, value, span } in shape.dimensions() {
            let Ok(value) = values.scalar(&value, Level::Geometry) else { continue };
            if value.re <= 0.0 {
                found.push(ImpossibleSize { shape: ShapeId(i), name, value: value.re, span });
            }
        }
    }
    found
}

/// A length that is not positive with the values of the model.
fn impossible_size(shape: &Shape, found: ImpossibleSize) -> Diagnostic {
    let message = format!("the {} of `{}` is {} m", found.name, shape.name, number(found.value));
    let help = match shape.kind {
        Kind::Torus => {
            "the dimensions of a shape are positive, and the tube of a torus is thinner than its radius"
        }
        _ => "the dimensions of a shape are positive",
    };
    Diagnostic::new(codes::SHAPE, found.span, message).help(help)
}

/// A density that is not positive with the values of the model.
fn impossible_density(m: &Mechanism, state: &State, shape: &Shape) -> Option<Diagnostic> {
    let density = at_rest(m, state).scalar(shape.density.as_ref()?, Level::Geometry).ok()?;
    (density.re <= 0.0).then(|| {
        let message = format!("the density of `{}` is {} kg/m^3", shape.name, number(density.re));
        Diagnostic::new(codes::SHAPE, shape.span, message).help("the density of a shape is positive")
    })
}

/// The parts of two velocities, and the size of the velocities of which they are sums.
struct Compared {
    parts: [Vec<[f64; 3]>; 2],
    size: f64,
}

/// The greatest of the lengths.
fn greatest(vectors: &[[f64; 3]]) -> f64 {
    vectors.iter().fold(0.0_f64, |size, v| size.max(norm3(*v)))
}

/// Whether two velocities are the same at every state; `None` where no state tells.
fn always(seen: &[Seen<'_>], pair: impl Fn(&Views<'_>) -> Result<Option<Compared>, Failure>) -> Option<bool> {
    let mut holds = None;
    for seen in seen {
        let Compared { parts: [a, b], size } = pair(&seen.views).ok()??;
        let same = a.iter().zip(&b).all(|(a, b)| norm3(sub3(*a, *b)) <= SLIP * size);
        holds = Some(holds.unwrap_or(true) && same);
    }
    holds
}

/// A place that does not move with the frame of its shape.
fn stranger(m: &Mechanism, shape: &Shape, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    let home = match shape.body {
        Some(body) => m.bodies[body.0].centre,
        None if shape.frame == FrameId::N => PointId::O,
        // no point tells how a frame without a body moves
        None => shape.at.point,
    };
    for anchor in std::iter::once(&shape.at).chain(&shape.vertices) {
        let moves = |views: &Views<'_>| {
            if !views.now.same_root(anchor.point, home) {
                return Ok(None);
            }
            let place = |values: &crate::numeric::Evaluator<'_>| {
                let by = values.vector(&anchor.by, Level::Geometry)?.map(HyperDual::rate);
                let at = values.rate_of_position(anchor.point)?;
                Ok([0, 1, 2].map(|i| at[i] + by[i]))
            };
            let matter = |values: &crate::numeric::Evaluator<'_>| {
                let by = values.vector(&anchor.by, Level::Geometry)?;
                let (at, from) = (values.position(anchor.point)?, values.position(home)?);
                let arm = [0, 1, 2].map(|i| (at[i] + by[i] - from[i]).still());
                let turning = values.angular_velocity(shape.frame)?;
                let of_home = values.velocity(home)?;
                let turned = [
                    turning[1] * arm[2] - turning[2] * arm[1],
                    turning[2] * arm[0] - turning[0] * arm[2],
                    turning[0] * arm[1] - turning[1] * arm[0],
                ];
                Ok([0, 1, 2].map(|i| of_home[i] + turned[i]))
            };
            let parts = [views.vector_parts(place)?, views.vector_parts(matter)?];
            let turning = views.vector_parts(|values| values.angular_velocity(shape.frame))?;
            // rounding of a velocity grows with the lengths that make it, also where that at the place is zero
            let far = |point| Ok(norm3(views.now.position(point)?.map(|c| c.re)));
            let far = far(anchor.point)? + far(home)?;
            let size = greatest(&parts[0]) + greatest(&parts[1]) + far * greatest(&turning);
            Ok(Some(Compared { parts, size }))
        };
        if always(seen, moves) == Some(false) {
            let with = match shape.body {
                Some(body) => &m.bodies[body.0].name,
                None => &m.frames[shape.frame.0].name,
            };
            let message = format!("`{}` does not move with `{with}`", shape.name);
            let help = if shape.frame == FrameId::N && shape.body.is_none() {
                "a shape without `of` is fixed in N: say of which body it is, as in `of: Body`"
            } else {
                "place it from a point that moves with it, such as its mass centre, by a vector along its axes"
            };
            let place = if shape.vertices.is_empty() { shape.at_span } else { shape.span };
            return Some(Diagnostic::new(codes::SHAPE, place, message).help(help));
        }
    }
    None
}

/// An axis that is not a unit vector. Normals of planes in contacts are looked at as normals.
fn long_axis(m: &Mechanism, shape: &Shape, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    let axis = shape.axis.as_ref()?;
    let lengths = seen.iter().filter_map(|seen| {
        let values = at_rest(m, seen.state);
        let v = values.vector(axis, Level::Geometry).ok()?;
        Some(norm3(v.map(|c| c.re)))
    });
    let off = |length: &f64| length.is_finite() && (length - 1.0).abs() > 1e-9;
    let length = lengths.collect::<Vec<f64>>().into_iter().find(off)?;
    let what = if shape.kind.is_flat() { "normal" } else { "axis" };
    let message = format!("the {what} of `{}` has the length {}, not 1", shape.name, length_shown(length));
    let help = if length < 1e-12 { "it is zero" } else { "`unit(v)` is the unit vector along v" };
    Some(Diagnostic::new(codes::SHAPE, shape.axis_span, message).help(help))
}

/// An axis that turns in the frame of its shape; it may be one about which the shape spins.
fn turning_axis(m: &Mechanism, shape: &Shape, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    let particle = shape.body.is_some_and(|body| m.bodies[body.0].frame.is_none());
    let frame = (!particle).then_some(shape.frame)?;
    let own = shape.axis.clone().map(|axis| vec![axis]);
    let of_frame = shape.axes.map(|axes| {
        let axis = |which: usize| {
            let one = |i| crate::number::Number::integer(i64::from(i == which));
            Vector::Components(axes, Box::new([0, 1, 2].map(|i| Scalar::Number(one(i)))))
        };
        vec![axis(0), axis(1), axis(2)]
    });
    for axis in own.into_iter().chain(of_frame).flatten() {
        let turns = |views: &Views<'_>| {
            let rate = views
                .vector_parts(|values| Ok(values.vector(&axis, Level::Geometry)?.map(HyperDual::rate)))?;
            let now = views.now.vector(&axis, Level::Geometry)?.map(|c| c.re);
            let turning = views.vector_parts(|values| values.angular_velocity(frame))?;
            let size = greatest(&rate) + greatest(&turning) * norm3(now);
            let turned = turning.into_iter().map(|w| cross3(w, now)).collect();
            Ok(Some(Compared { parts: [rate, turned], size }))
        };
        if always(seen, turns) == Some(false) {
            let what = match (shape.kind.is_flat(), shape.axes) {
                (true, _) => "the normal",
                (_, Some(_)) => "the frame of the axes",
                (_, None) => "the axis",
            };
            let with = &m.frames[frame.0].name;
            let message = format!("{what} of `{}` turns in `{with}`", shape.name);
            let help = format!("it is fixed in `{with}`, as `{with}.z` is; or the shape is of another frame");
            return Some(Diagnostic::new(codes::SHAPE, shape.axis_span, message).help(help));
        }
    }
    None
}
