//! Outlines of shapes, along the axes of the frame that carries them.

use nalgebra::Vector3;
use serde::Serialize;

use crate::sections::sections;

/// Number of points of a circle.
const CIRCLE_POINTS: usize = 40;
/// Number of lines of a grid in each direction.
const GRID: usize = 10;

/// A shape for drawing: the silhouette of all points within a distance of a convex hull, and lines on the
/// surface.
#[derive(Clone, Debug, Serialize)]
pub struct Shape {
    /// name in the model
    pub name: String,
    /// colour, such as `#c8362e`
    pub colour: String,
    /// the frame that carries it, an index in `frames`; `None`: fixed in N
    pub frame: Option<usize>,
    /// the points of the convex hull, relative to the origin of the frame and along its axes, m
    pub core: Vec<[f64; 3]>,
    /// the distance of the surface from the hull, m
    pub round: f64,
    /// lines on its surface
    pub lines: Vec<Vec<[f64; 3]>>,
    /// whether it is a ground: drawn first, and ignored for the extent of the picture
    pub ground: bool,
}

/// The position and the axes of a shape.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// its centre
    pub at: Vector3<f64>,
    /// its axes: the third is the axis of rotation or the normal of a plane
    pub axes: [Vector3<f64>; 3],
}

impl Place {
    /// A position with an axis, and two others perpendicular to it.
    pub fn along(at: Vector3<f64>, axis: Vector3<f64>) -> Self {
        let least = if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let first = axis.cross(&least).normalize();
        Place { at, axes: [first, axis.cross(&first), axis] }
    }

    fn point(&self, x: f64, y: f64, z: f64) -> [f64; 3] {
        (self.at + self.axes[0] * x + self.axes[1] * y + self.axes[2] * z).into()
    }

    /// A closed ellipse; its semi-axes `a` and `b` lie along the axes `i` and `j`.
    fn ellipse(&self, [i, j]: [usize; 2], [a, b]: [f64; 2], height: f64) -> Vec<[f64; 3]> {
        let at = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / CIRCLE_POINTS as f64;
            let mut place = [0.0; 3];
            place[i] = a * angle.cos();
            place[j] = b * angle.sin();
            place[3 - i - j] = height;
            self.point(place[0], place[1], place[2])
        };
        (0..=CIRCLE_POINTS).map(at).collect()
    }
}

/// The points of the hull and the lines of an outline, and the distance of the surface from the hull.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    core: Vec<[f64; 3]>,
    round: f64,
    lines: Vec<Vec<[f64; 3]>>,
}

impl Outline {
    /// The shape with this outline.
    pub fn shape(self, name: &str, colour: String, frame: Option<usize>, ground: bool) -> Shape {
        let Outline { core, round, lines } = self;
        Shape { name: name.to_owned(), colour, frame, core, round, lines, ground }
    }

    /// A sphere, with two great circles that show its rotation.
    pub fn sphere(place: Place, r: f64) -> Self {
        let lines = vec![place.ellipse([0, 1], [r, r], 0.0), place.ellipse([0, 2], [r, r], 0.0)];
        Outline { core: vec![place.at.into()], round: r, lines }
    }

    /// A capsule: all points within a radius of a segment.
    pub fn capsule(place: Place, [r, l]: [f64; 2]) -> Self {
        let ends = [0.5 * l, -0.5 * l];
        let lines = ends.map(|z| place.ellipse([0, 1], [r, r], z)).into();
        Outline { core: ends.map(|z| place.point(0.0, 0.0, z)).into(), round: r, lines }
    }

    /// A cylinder; a disc if its length is zero.
    pub fn cylinder(place: Place, [r, l]: [f64; 2]) -> Self {
        let rims: Vec<Vec<[f64; 3]>> = [0.5 * l, -0.5 * l].map(|z| place.ellipse([0, 1], [r, r], z)).into();
        let mut lines = rims.clone();
        lines.push(vec![place.point(-r, 0.0, 0.5 * l), place.point(r, 0.0, 0.5 * l)]);
        Outline { core: rims.concat(), round: 0.0, lines }
    }

    /// A cone.
    pub fn cone(place: Place, [r, h]: [f64; 2]) -> Self {
        let (rim, apex) = (place.ellipse([0, 1], [r, r], 0.0), place.point(0.0, 0.0, h));
        let sides = [0, CIRCLE_POINTS / 2].map(|k| vec![rim[k], apex]);
        let lines = [vec![rim.clone()], sides.into()].concat();
        Outline { core: [rim, vec![apex]].concat(), round: 0.0, lines }
    }

    /// A torus.
    pub fn torus(place: Place, [big, r]: [f64; 2]) -> Self {
        let lines = [big + r, big - r].map(|a| place.ellipse([0, 1], [a, a], 0.0));
        let mut lines: Vec<Vec<[f64; 3]>> = lines.into();
        lines.push(vec![place.point(big - r, 0.0, 0.0), place.point(big + r, 0.0, 0.0)]);
        Outline { core: place.ellipse([0, 1], [big, big], 0.0), round: r, lines }
    }

    /// An ellipsoid.
    pub fn ellipsoid(place: Place, [a, b, c]: [f64; 3]) -> Self {
        let lines = vec![
            place.ellipse([0, 1], [a, b], 0.0),
            place.ellipse([1, 2], [b, c], 0.0),
            place.ellipse([0, 2], [a, c], 0.0),
        ];
        // points at equal steps of height, turned by the golden angle
        let core = (0..240).map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / 240.0;
            let (ring, angle) = ((1.0 - z * z).sqrt(), 2.399_963_229_728_653 * i as f64);
            place.point(a * ring * angle.cos(), b * ring * angle.sin(), c * z)
        });
        Outline { core: core.collect(), round: 0.0, lines }
    }

    /// A box.
    pub fn cuboid(place: Place, [a, b, c]: [f64; 3]) -> Self {
        let corner = |i: usize| {
            let side = |k: usize, length: f64| if i >> k & 1 == 0 { 0.5 * length } else { -0.5 * length };
            place.point(side(0, a), side(1, b), side(2, c))
        };
        let edges = (0..8).flat_map(|i| (0..3).map(move |k| (i, i ^ (1 << k)))).filter(|(i, j)| i < j);
        let lines = edges.map(|(i, j)| vec![corner(i), corner(j)]).collect();
        Outline { core: (0..8).map(corner).collect(), round: 0.0, lines }
    }

    /// The convex hull of vertices; with lines between them if there are few.
    pub fn polytope(vertices: Vec<[f64; 3]>) -> Self {
        let n = if vertices.len() <= 4 { vertices.len() } else { 0 };
        let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
        let lines = pairs.map(|(i, j)| vec![vertices[i], vertices[j]]).collect();
        Outline { core: vertices, round: 0.0, lines }
    }

    /// A square part of a plane with a given width.
    pub fn plane(place: Place, width: f64) -> Self {
        let patch = Outline::height(place, width, |_, _| Some(0.0));
        let half = 0.5 * width;
        let corners = [(half, half), (-half, half), (-half, -half), (half, -half)];
        Outline { core: corners.map(|(x, y)| place.point(x, y, 0.0)).into(), ..patch }
    }

    /// A square part of a surface z = h(x, y) with a given width.
    pub fn height(place: Place, width: f64, height: impl Fn(f64, f64) -> Option<f64>) -> Self {
        let flat =
            height(0.37 * width, 0.21 * width) == Some(0.0) && height(-0.2 * width, 0.1 * width) == Some(0.0);
        let steps = if flat { 1 } else { 6 * GRID };
        let at = |k: usize, of: usize| width * (k as f64 / of as f64 - 0.5);
        let mut lines = Vec::new();
        for line in 0..=GRID {
            let ways: [&dyn Fn(f64) -> [f64; 2]; 2] = [&|t| [at(line, GRID), t], &|t| [t, at(line, GRID)]];
            for way in ways {
                let points = (0..=steps).filter_map(|k| {
                    let [x, y] = way(at(k, steps));
                    Some(place.point(x, y, height(x, y)?))
                });
                lines.push(points.collect());
            }
        }
        Outline { core: Vec::new(), round: 0.0, lines }
    }

    /// The part of a surface f(x, y, z) = 0 that is in a cube of a given width about the place.
    pub fn implicit(place: Place, width: f64, f: impl Fn([f64; 3]) -> Option<f64>) -> Self {
        let lines = sections(width, f).into_iter();
        let lines = lines.map(|line| line.into_iter().map(|[x, y, z]| place.point(x, y, z)).collect());
        Outline { core: Vec::new(), round: 0.0, lines: lines.collect() }
    }

    /// A part of a curve y = h(x) with a given width.
    pub fn curve(place: Place, width: f64, height: impl Fn(f64) -> Option<f64>) -> Self {
        let points = (0..=12 * GRID).filter_map(|k| {
            let x = width * (k as f64 / (12 * GRID) as f64 - 0.5);
            Some(place.point(x, height(x)?, 0.0))
        });
        Outline { core: Vec::new(), round: 0.0, lines: vec![points.collect()] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place() -> Place {
        Place::along(Vector3::new(0.3, -0.2, 0.5), Vector3::new(2.0, -1.0, 2.0) / 3.0)
    }

    fn far(points: &[[f64; 3]], from: Vector3<f64>) -> (f64, f64) {
        let sizes = points.iter().map(|p| (Vector3::from(*p) - from).norm());
        sizes.fold((f64::INFINITY, 0.0), |(low, high), x| (low.min(x), high.max(x)))
    }

    #[test]
    fn axes_are_right_handed() {
        let Place { axes: [a, b, c], .. } = place();
        assert!((a.cross(&b) - c).norm() < 1e-15 && (a.norm() - 1.0).abs() < 1e-15);
    }

    /// Lines lie on the surfaces, and the rounded hull has the size of the shape.
    #[test]
    fn outlines_have_the_sizes_of_their_shapes() {
        let at = place().at;
        let sphere = Outline::sphere(place(), 0.2);
        let (low, high) = far(&sphere.lines.concat(), at);
        assert!((low - 0.2).abs() < 1e-12 && (high - 0.2).abs() < 1e-12 && sphere.round == 0.2);
        let cuboid = Outline::cuboid(place(), [0.2, 0.4, 0.4]);
        assert_eq!((cuboid.core.len(), cuboid.lines.len()), (8, 12));
        let (low, high) = far(&cuboid.core, at);
        assert!((low - 0.3).abs() < 1e-12 && (high - 0.3).abs() < 1e-12);
        let torus = Outline::torus(place(), [0.4, 0.1]);
        assert!((far(&torus.core, at).1 - 0.4).abs() < 1e-12);
        let (low, high) = far(&torus.lines.concat(), at);
        assert!((low - 0.3).abs() < 1e-12 && (high - 0.5).abs() < 1e-12);
        let [a, b, c] = place().axes;
        for p in Outline::ellipsoid(place(), [0.1, 0.2, 0.3]).core {
            let d = Vector3::from(p) - at;
            let value = (a.dot(&d) / 0.1).powi(2) + (b.dot(&d) / 0.2).powi(2) + (c.dot(&d) / 0.3).powi(2);
            assert!((value - 1.0).abs() < 1e-12);
        }
        let wave = Outline::height(place(), 2.0, |x, _| Some(0.1 * x.sin()));
        for p in wave.lines.concat() {
            let d = Vector3::from(p) - at;
            assert!((c.dot(&d) - 0.1 * a.dot(&d).sin()).abs() < 1e-12);
        }
    }
}
