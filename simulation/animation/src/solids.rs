//! Outlines of the shapes of a model, and of the planes of contacts without shapes.

use hodograph::{Contacts, State as Borrowed};
use hodograph_model::model::mechanism::{
    Against, FrameId, Height, Kind, Mechanism as Model, PointId, Scalar, Shape,
};
use hodograph_model::numeric::hyper_dual::HyperDual;
use hodograph_model::numeric::{Evaluator, Level, State, Views};
use nalgebra::{Matrix3, Vector3};

use crate::gap::gap;
use crate::{Animation, Frame, Outline, Place, Shape as Shown};

/// Colours of shapes without a stated colour, used in turn.
const COLOURS: [&str; 6] = ["#5b8db8", "#c98a3c", "#6a9f6a", "#a8749b", "#8a8f98", "#b5655b"];
/// The colour of shapes that are fixed in N.
const GROUND: &str = "#8c8c84";
/// A plane is at rest if it turns or moves by less than this, m.
const STILL: f64 = 1e-9;

/// The data of shapes before the motion is known.
pub struct Solids {
    shapes: Vec<(usize, Option<usize>)>,
    /// frames of `Animation::frames` in addition to those of bodies: frame of the model, and the point at its
    /// origin
    pub frames: Vec<(FrameId, PointId)>,
    /// for each contact without shapes its plane, as long as it is at rest
    planes: Vec<ObservedPlane>,
}

/// The observations of the plane of a contact.
#[derive(Clone, Copy)]
enum ObservedPlane {
    Nothing,
    Plane { normal: Vector3<f64>, height: f64, below: Vector3<f64> },
    Moves,
}

impl Solids {
    /// The shapes that can be drawn; frames without a body are added to the animation.
    pub fn of(model: &Model, state: &State, shown: &mut Animation) -> Self {
        let mut solids = Solids {
            shapes: Vec::new(),
            frames: Vec::new(),
            planes: vec![ObservedPlane::Nothing; model.contacts.len()],
        };
        let Ok(views) = Views::at(model, state) else { return solids };
        let with_frames: Vec<(FrameId, PointId)> =
            model.bodies.iter().filter_map(|body| Some((body.frame?, body.centre))).collect();
        for (i, shape) in model.shapes.iter().enumerate() {
            if !views.now.same_root(shape.at.point, PointId::O) {
                continue;
            }
            // a frame made by `spin` has no axes of its own: round shapes are drawn along those of the frame
            // in which it spins
            let mut frame = shape.frame;
            while views.now.orientation(frame).is_err() {
                let Some(parent) = model.frames[frame.0].parent else { break };
                frame = parent;
            }
            let particle = shape.body.is_some_and(|body| model.bodies[body.0].frame.is_none());
            if frame == FrameId::N && !particle && shape.frame == FrameId::N {
                solids.shapes.push((i, None));
                continue;
            }
            let home = shape.body.map(|body| model.bodies[body.0].centre).unwrap_or(shape.at.point);
            let known = with_frames.iter().position(|with| *with == (frame, home));
            let place = known.unwrap_or_else(|| {
                solids.frames.push((frame, home));
                let name = model.frames[frame.0].name.clone();
                shown.frames.push(Frame { name, at: home.0, axes: Vec::new() });
                shown.frames.len() - 1
            });
            solids.shapes.push((i, Some(place)));
        }
        solids
    }

    /// Records a moment of the motion: whether the planes of contacts without shapes are at rest.
    pub fn moment(&mut self, mechanism: &dyn Contacts<f64>, model: &Model, state: &Borrowed<'_>) {
        for (i, contact) in model.contacts.iter().enumerate() {
            let fixed = matches!(contact.against, Against::Fixed) && contact.shapes.is_none();
            if !fixed || matches!(self.planes[i], ObservedPlane::Moves) {
                continue;
            }
            let (Ok(here), Some(gap)) = (mechanism.contact_state(i, state), gap(mechanism, i, state)) else {
                self.planes[i] = ObservedPlane::Moves;
                continue;
            };
            let Ok(place) = mechanism.position(contact.point.0, state) else { continue };
            let below = place - here.normal * gap;
            let now = ObservedPlane::Plane { normal: here.normal, height: here.normal.dot(&below), below };
            self.planes[i] = match self.planes[i] {
                ObservedPlane::Nothing => now,
                ObservedPlane::Plane { normal, height, .. }
                    if (normal - here.normal).norm() > STILL
                        || (height - here.normal.dot(&below)).abs() > STILL * (1.0 + height.abs()) =>
                {
                    ObservedPlane::Moves
                }
                same => same,
            };
        }
    }

    /// All outlines, after the extent of the motion is known.
    pub fn finish(self, model: &Model, state: &State, shown: &Animation) -> Vec<Shown> {
        let Ok(views) = Views::at(model, state) else { return Vec::new() };
        let (middle, extent) = extent(model, &views.now, shown);
        let mut out = Vec::new();
        for (i, frame) in &self.shapes {
            let home = frame.map(|frame| (shown.frames[frame].at, frame));
            let turned = match home {
                None => Matrix3::identity(),
                Some((_, frame)) => {
                    let name = &shown.frames[frame].name;
                    let id = model.frames.iter().position(|frame| frame.name == *name).unwrap_or(0);
                    let Ok(rows) = views.now.orientation(FrameId(id)) else { continue };
                    Matrix3::from_fn(|r, c| rows[r][c].re)
                }
            };
            let origin = home.map_or(Some(Vector3::zeros()), |(at, _)| place(&views.now, PointId(at)));
            let Some(origin) = origin else { continue };
            let local = Local { values: &views.now, origin, turned, middle, extent };
            let shape = &model.shapes[*i];
            let colour = shape.colour.map_or_else(
                || if frame.is_none() { GROUND.to_owned() } else { COLOURS[i % COLOURS.len()].to_owned() },
                hexadecimal,
            );
            if let Some(outline) = local.outline(shape, frame.is_none()) {
                let endless = shape.kind.is_flat() || shape.kind.places() > 0;
                out.push(outline.shape(&shape.name, colour, *frame, endless));
            }
        }
        let mut known: Vec<(Vector3<f64>, f64)> = Vec::new();
        for (contact, seen) in model.contacts.iter().zip(&self.planes) {
            let ObservedPlane::Plane { normal, height, below } = *seen else { continue };
            let same = |(other, at): &(Vector3<f64>, f64)| {
                (other - normal).norm() < STILL && (at - height).abs() < 1e-6 * (1.0 + height.abs())
            };
            if known.iter().any(same) || !below.iter().all(|x| x.is_finite()) {
                continue;
            }
            known.push((normal, height));
            let at = middle - normal * (normal.dot(&middle) - height);
            let outline = Outline::plane(Place::along(at, normal), extent);
            out.push(outline.shape(&contact.name, GROUND.to_owned(), None, true));
        }
        out
    }
}

/// The frame in which a shape is described.
struct Local<'a> {
    values: &'a Evaluator<'a>,
    /// the origin of the frame, and its axes as columns
    origin: Vector3<f64>,
    turned: Matrix3<f64>,
    /// centre of the motion
    middle: Vector3<f64>,
    extent: f64,
}

impl Local<'_> {
    fn vector(&self, vector: &hodograph_model::model::mechanism::Vector) -> Option<Vector3<f64>> {
        let v = self.values.vector(vector, Level::Geometry).ok()?.map(|c| c.re);
        let v = Vector3::from(v);
        v.iter().all(|x| x.is_finite()).then(|| self.turned.transpose() * v)
    }

    fn anchor(&self, anchor: &hodograph_model::model::mechanism::Anchor) -> Option<Vector3<f64>> {
        let at = place(self.values, anchor.point)? - self.origin;
        Some(self.turned.transpose() * at + self.vector(&anchor.by)?)
    }

    fn outline(&self, shape: &Shape, fixed: bool) -> Option<Outline> {
        let at = self.anchor(&shape.at)?;
        let sizes: Option<Vec<f64>> = shape
            .sizes
            .iter()
            .map(|size| self.values.scalar(size, Level::Geometry).ok().map(|size| size.re))
            .collect();
        let place = match (&shape.axis, shape.axes) {
            (Some(axis), _) => Place::along(at, self.vector(axis)?),
            (None, Some(frame)) => {
                let rows = self.values.orientation(frame).ok()?;
                let axes = self.turned.transpose() * Matrix3::from_fn(|r, c| rows[r][c].re);
                Place { at, axes: [0, 1, 2].map(|i| axes.column(i).into_owned()) }
            }
            (None, None) => Place { at, axes: [Vector3::x(), Vector3::y(), Vector3::z()] },
        };
        // unbounded shapes at rest are drawn around the centre of the motion
        let endless = |up: usize| {
            let mut place = place;
            if fixed {
                let off = self.middle - place.at;
                let across: Vector3<f64> =
                    (0..3).filter(|i| *i != up).map(|i| place.axes[i] * place.axes[i].dot(&off)).sum();
                place.at += across;
            }
            place
        };
        let height = |height: &Height, x: f64, y: f64| {
            let (shifted, up) = (endless(2), if shape.kind == Kind::Surface { 2 } else { 1 });
            let shifted = if up == 2 { shifted } else { endless(1) };
            let off = shifted.at - place.at;
            height_at(self.values, height, [x + place.axes[0].dot(&off), y + place.axes[1].dot(&off)])
        };
        Some(match (shape.kind, &sizes?[..]) {
            (Kind::Sphere, [r]) => Outline::sphere(place, *r),
            (Kind::Capsule, [r, l]) => Outline::capsule(place, [*r, *l]),
            (Kind::Cylinder, [r, l]) => Outline::cylinder(place, [*r, *l]),
            (Kind::Disc, [r]) => Outline::cylinder(place, [*r, 0.0]),
            (Kind::Cone, [r, h]) => Outline::cone(place, [*r, *h]),
            (Kind::Torus, [big, r]) => Outline::torus(place, [*big, *r]),
            (Kind::Ellipsoid, [a, b, c]) => Outline::ellipsoid(place, [*a, *b, *c]),
            (Kind::Box, [a, b, c]) => Outline::cuboid(place, [*a, *b, *c]),
            (Kind::Rectangle, [a, b]) => Outline::cuboid(place, [*a, *b, 0.0]),
            (Kind::Polytope, _) => {
                let vertices: Option<Vec<[f64; 3]>> =
                    shape.vertices.iter().map(|vertex| Some(self.anchor(vertex)?.into())).collect();
                Outline::polytope(vertices?)
            }
            (Kind::Plane | Kind::HalfSpace, _) => {
                Outline::plane(endless(2), if fixed { self.extent } else { 0.6 * self.extent })
            }
            (Kind::Surface, _) => {
                let own = shape.height.as_ref()?;
                Outline::height(endless(2), self.extent, |x, y| height(own, x, y))
            }
            (Kind::Curve, _) => {
                let own = shape.height.as_ref()?;
                Outline::curve(endless(1), self.extent, |x| height(own, x, 0.0))
            }
            (Kind::Implicit, _) => {
                let own = shape.function.as_ref()?;
                let (centre, width) =
                    if fixed { (self.middle, self.extent) } else { (place.at, 0.6 * self.extent) };
                let off = centre - place.at;
                let value = |at: [f64; 3]| {
                    let at = [0, 1, 2].map(|i| at[i] + place.axes[i].dot(&off));
                    value_of(self.values, &own.value_at(at)?)
                };
                Outline::implicit(Place { at: centre, ..place }, width, value)
            }
            _ => return None,
        })
    }
}

/// For each point, whether it is the contact point of a pair of shapes.
pub fn places_of_shapes(model: &Model) -> Vec<bool> {
    let mut out = vec![false; model.points.len()];
    for contact in model.contacts.iter().filter(|contact| contact.shapes.is_some()) {
        // a particle is its own contact point
        let particle = contact.body.is_some_and(|body| model.bodies[body.0].frame.is_none());
        out[contact.point.0] |= !particle;
        if let Against::Point(struck, _) = contact.against {
            out[struck.0] |= model.points[struck.0].span == contact.span;
        }
    }
    out
}

/// The height of a surface at a place.
fn height_at(values: &Evaluator<'_>, height: &Height, place: [f64; 2]) -> Option<f64> {
    value_of(values, &height.value_at(place)?)
}

fn value_of(values: &Evaluator<'_>, scalar: &Scalar) -> Option<f64> {
    let value = values.scalar(scalar, Level::Geometry).ok()?.re;
    value.is_finite().then_some(value)
}

fn place(values: &Evaluator<'_>, point: PointId) -> Option<Vector3<f64>> {
    let at: [HyperDual; 3] = values.position(point).ok()?;
    let at = Vector3::from(at.map(|c| c.re));
    at.iter().all(|x| x.is_finite()).then_some(at)
}

/// The centre and the width of the region that points and shapes pass through, with a margin.
fn extent(model: &Model, values: &Evaluator<'_>, shown: &Animation) -> (Vector3<f64>, f64) {
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let places = shown.points.iter().flat_map(|point| &point.places);
    for at in places.map(|place| Vector3::from(*place)).filter(|at| at.iter().all(|x| x.is_finite())) {
        low = low.inf(&at);
        high = high.sup(&at);
    }
    if low.x > high.x {
        return (Vector3::zeros(), 1.0);
    }
    let size = |shape: &Shape| {
        let sizes = shape.sizes.iter().filter_map(|size| values.scalar(size, Level::Geometry).ok());
        sizes.map(|size| size.re).filter(|size| size.is_finite()).fold(0.0, f64::max)
    };
    let largest = model.shapes.iter().map(size).fold(0.0, f64::max);
    let width = (high - low).max() + 2.0 * largest;
    ((low + high) * 0.5, if width > 0.0 { 1.5 * width } else { 1.0 })
}

fn hexadecimal(colour: [f64; 3]) -> String {
    let part = |x: f64| format!("{:02x}", (x * 255.0).round() as u8);
    format!("#{}{}{}", part(colour[0]), part(colour[1]), part(colour[2]))
}
