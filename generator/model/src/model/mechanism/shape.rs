//! Shapes: the surfaces of bodies, of frames and of the ground.

use super::expression::{BodyId, FrameId, PointId, Scalar, Vector};
use crate::span::Span;
use crate::words;

/// What a shape is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Kind {
    Sphere,
    /// all points within a radius of a segment
    Capsule,
    Cylinder,
    /// its place is the centre of its base, its axis points to its apex
    Cone,
    /// a thin rim: a circle
    Disc,
    Torus,
    Ellipsoid,
    Box,
    /// in the plane of motion, which is that of x and y
    Rectangle,
    /// the convex hull of its vertices
    Polytope,
    /// the boundary of a half space; its axis is its normal
    Plane,
    /// all that lies behind a plane
    HalfSpace,
    /// z = h(x, y) along the axes of a frame
    Surface,
    /// y = h(x) along the axes of a frame
    Curve,
    /// f(x, y, z) = 0 along the axes of a frame; f is positive outside
    Implicit,
}

impl Kind {
    /// All.
    pub const ALL: [Kind; 15] = [
        Kind::Sphere,
        Kind::Capsule,
        Kind::Cylinder,
        Kind::Cone,
        Kind::Disc,
        Kind::Torus,
        Kind::Ellipsoid,
        Kind::Box,
        Kind::Rectangle,
        Kind::Polytope,
        Kind::Plane,
        Kind::HalfSpace,
        Kind::Surface,
        Kind::Curve,
        Kind::Implicit,
    ];

    /// Its word in models.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Sphere => "sphere",
            Kind::Capsule => "capsule",
            Kind::Cylinder => "cylinder",
            Kind::Cone => "cone",
            Kind::Disc => "disc",
            Kind::Torus => "torus",
            Kind::Ellipsoid => "ellipsoid",
            Kind::Box => "box",
            Kind::Rectangle => "rectangle",
            Kind::Polytope => "polytope",
            Kind::Plane => "plane",
            Kind::HalfSpace => "half_space",
            Kind::Surface => "surface",
            Kind::Curve => "curve",
            Kind::Implicit => "implicit",
        }
    }

    /// The kind that a word names.
    pub fn of_word(word: &str) -> Option<Kind> {
        Kind::ALL.into_iter().find(|kind| kind.word() == word)
    }

    /// The lengths that make it, in the order in which they are stated.
    pub fn sizes(self) -> &'static [&'static str] {
        match self {
            Kind::Sphere | Kind::Disc => &["radius"],
            Kind::Capsule | Kind::Cylinder => &["radius", "length"],
            Kind::Cone => &["radius", "height"],
            Kind::Torus => &["radius", "radius of its tube"],
            Kind::Ellipsoid => &["semi-axis along x", "semi-axis along y", "semi-axis along z"],
            Kind::Box => &["length along x", "length along y", "length along z"],
            Kind::Rectangle => &["length along x", "length along y"],
            Kind::Polytope | Kind::Plane | Kind::HalfSpace => &[],
            Kind::Surface | Kind::Curve | Kind::Implicit => &[],
        }
    }

    /// Whether it has an axis of rotation, which is stated.
    pub fn turns(self) -> bool {
        matches!(self, Kind::Capsule | Kind::Cylinder | Kind::Cone | Kind::Disc | Kind::Torus)
    }

    /// Whether it lies along the axes of a frame.
    pub fn has_axes(self) -> bool {
        use Kind::*;
        matches!(self, Ellipsoid | Box | Rectangle | Surface | Curve | Implicit)
    }

    /// Whether it is the boundary of a half space.
    pub fn is_flat(self) -> bool {
        matches!(self, Kind::Plane | Kind::HalfSpace)
    }

    /// How many coordinates of a place stand in the expression that states it: none if no such expression does.
    pub fn places(self) -> usize {
        words::places(self.word()).len()
    }

    /// With its article, for messages.
    pub fn with_article(self) -> String {
        let article = if self == Kind::Ellipsoid { "an" } else { "a" };
        match self {
            Kind::Implicit => "an implicit surface".to_owned(),
            _ => format!("{article} {}", self.word().replace('_', " ")),
        }
    }
}

/// A point and a vector from there.
#[derive(Clone, Debug)]
pub struct Anchor {
    /// the point
    pub point: PointId,
    /// from there
    pub by: Vector,
}

/// A function of a place with N coordinates, each in m along an axis of a shape.
#[derive(Clone, Debug)]
pub struct OfPlace<const N: usize> {
    /// the function, in which x, y and z stand for the place; [`OfPlace::value_at`] gives it at one
    pub value: Scalar,
    /// its derivatives by the coordinates: the dimension of the function over m
    pub slopes: [Scalar; N],
}

/// A height above a plane, m, as a function of the place in it.
pub type Height = OfPlace<2>;

/// A shape.
#[derive(Clone, Debug)]
pub struct Shape {
    /// name as spelled
    pub name: String,
    /// documentation
    pub docs: String,
    /// what it is
    pub kind: Kind,
    /// the frame with which it moves; a shape of a particle moves with the point alone, and this is N
    pub frame: FrameId,
    /// the body or particle of which it is, if any
    pub body: Option<BodyId>,
    /// its place: the centre; of a cone, the centre of its base; of a plane, one of its points
    pub at: Anchor,
    /// the lengths that [`Kind::sizes`] names, m
    pub sizes: Vec<Scalar>,
    /// the axis of rotation, or the normal of a plane: a unit vector
    pub axis: Option<Vector>,
    /// the frame along whose axes it lies
    pub axes: Option<FrameId>,
    /// of a polytope
    pub vertices: Vec<Anchor>,
    /// of a surface or curve
    pub height: Option<Height>,
    /// of an implicit surface: what vanishes on it and is positive outside, of any dimension (section 16.15 of
    /// docs/theory.md)
    pub function: Option<OfPlace<3>>,
    /// kg/m^3
    pub density: Option<Scalar>,
    /// red, green and blue, from 0 to 1
    pub colour: Option<[f64; 3]>,
    /// where its place is stated; else where it is declared
    pub at_span: Span,
    /// where each of the sizes is stated
    pub size_spans: Vec<Span>,
    /// where the axis is stated; else where it is declared
    pub axis_span: Span,
    /// where it is declared
    pub span: Span,
}

/// A length of a shape that must be positive.
#[derive(Clone, Debug)]
pub struct Size {
    /// such as `radius`
    pub name: &'static str,
    /// m
    pub value: Scalar,
    /// where it is stated
    pub span: Span,
}

impl Shape {
    /// The lengths that must be positive: those that are stated, and of a torus the radius of its hole, without which it
    /// would pass through itself.
    pub fn dimensions(&self) -> impl Iterator<Item = Size> {
        let stated = self.kind.sizes().iter().zip(&self.sizes).zip(&self.size_spans);
        let hole = match (self.kind, &self.sizes[..], &self.size_spans[..]) {
            (Kind::Torus, [radius, tube], [_, span]) => {
                let value = Scalar::Add(vec![radius.clone(), Scalar::Neg(Box::new(tube.clone()))]);
                Some(Size { name: "radius of the hole", value, span: *span })
            }
            _ => None,
        };
        stated.map(|((name, value), span)| Size { name, value: value.clone(), span: *span }).chain(hole)
    }
}
