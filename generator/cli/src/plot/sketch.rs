//! Draws a mechanism in one state: its shapes, grounds, and the lines between its points.

use hodograph_animation::{Animation, Shape as Solid};
use nalgebra::{Rotation3, Vector3};

use super::canvas::{Colour, Shape, Sheet};

/// Width and height of the picture, and its margin, pixels.
const SIZE: [f64; 2] = [480.0, 360.0];
const MARGIN: f64 = 24.0;
/// Number of points of a circle.
const CIRCLE_POINTS: usize = 48;
/// The direction of view for mechanisms in space, rad: to the side, and from above.
const VIEW_ANGLES: [f64; 2] = [0.55, 0.35];
const DARK: [u8; 3] = [0x33, 0x33, 0x33];

/// The projection of space to the picture.
struct View {
    /// to the right, upwards, and towards the viewer
    axes: [Vector3<f64>; 3],
    /// pixels per metre
    scale: f64,
    /// the centre of the picture, along right and up
    middle: [f64; 2],
}

impl View {
    fn flat(&self, at: Vector3<f64>) -> [f64; 2] {
        [self.axes[0].dot(&at), self.axes[1].dot(&at)]
    }

    fn pixels(&self, flat: [f64; 2]) -> [f64; 2] {
        let at = |i: usize, sign: f64| 0.5 * SIZE[i] + sign * self.scale * (flat[i] - self.middle[i]);
        [at(0, 1.0), at(1, -1.0)]
    }

    fn place(&self, at: Vector3<f64>) -> [f64; 2] {
        self.pixels(self.flat(at))
    }
}

/// Draws a mechanism at a moment of a motion.
pub fn sheet(shown: &Animation, moment: usize) -> Sheet {
    let mut view = View { axes: directions(shown, moment), scale: 1.0, middle: [0.0; 2] };
    let solids: Vec<Placed<'_>> =
        shown.shapes.iter().filter_map(|solid| Placed::at(solid, shown, moment)).collect();
    let points: Vec<Option<Vector3<f64>>> = shown
        .points
        .iter()
        .map(|point| {
            let at = Vector3::from(*point.places.get(moment)?);
            at.iter().all(|x| x.is_finite()).then_some(at)
        })
        .collect();
    fit(&mut view, &solids, &points);
    let mut shapes = Vec::new();
    let depth = |core: &[Vector3<f64>]| {
        core.iter().map(|at| view.axes[2].dot(at)).sum::<f64>() / core.len().max(1) as f64
    };
    let mut order: Vec<usize> = (0..solids.len()).collect();
    // grounds first, then fixed solids, which may contain others, then from far to near
    let rank = |i: usize| {
        let solid = solids[i].solid;
        if solid.ground {
            0
        } else if solid.frame.is_none() {
            1
        } else {
            2
        }
    };
    let far = |i: usize| depth(&solids[i].core);
    order.sort_by(|a, b| rank(*a).cmp(&rank(*b)).then(far(*a).total_cmp(&far(*b))));
    order.into_iter().for_each(|i| draw(&view, &solids[i], &mut shapes));
    for [a, b] in &shown.segments {
        if let (Some(a), Some(b)) = (points[*a], points[*b]) {
            let points = vec![view.place(a), view.place(b)];
            shapes.push(Shape::Line { points, colour: Colour(DARK, 1.0), width: 1.5, dashes: Vec::new() });
        }
    }
    for (point, at) in shown.points.iter().zip(&points).filter(|(point, _)| !point.quiet) {
        let Some(at) = at else { continue };
        let hidden = solids.iter().any(|placed| !placed.solid.ground) && point.name == "O";
        if !hidden {
            let centre = view.place(*at);
            shapes.push(Shape::Circle { centre, radius: 2.0, colour: Colour(DARK, 1.0), width: None });
        }
    }
    Sheet { size: SIZE, shapes }
}

/// Right, up, and towards the viewer: perpendicular to the plane of a plane motion, else from the side and
/// above.
fn directions(shown: &Animation, moment: usize) -> [Vector3<f64>; 3] {
    let up = Vector3::from(shown.up);
    let moves: Vec<Vector3<f64>> = shown
        .points
        .iter()
        .filter(|point| !point.quiet)
        .filter_map(|point| point.places.get(moment).map(|at| Vector3::from(*at)))
        .collect();
    // all points of a plane motion lie in its plane, and its normal is an axis of every frame
    let across = (0..3).rev().map(|k| Vector3::ith(k, 1.0)).find(|axis| {
        let turned = |frame: &hodograph_animation::Frame| {
            let axes = frame.axes.get(moment);
            axes.is_some_and(|axes| {
                axes.iter().any(|own| (Vector3::from(*own).dot(axis).abs() - 1.0).abs() < 1e-9)
            })
        };
        let solid = shown.shapes.iter().any(|shape| {
            let low = shape.core.iter().map(|at| Vector3::from(*at).dot(axis)).fold(f64::INFINITY, f64::min);
            let high =
                shape.core.iter().map(|at| Vector3::from(*at).dot(axis)).fold(f64::NEG_INFINITY, f64::max);
            !shape.ground && high - low > 1e-9
        });
        axis.dot(&up).abs() < 1e-9
            && !solid
            && moves.iter().all(|at| at.dot(axis).abs() < 1e-9)
            && shown.frames.iter().all(turned)
    });
    match across {
        // right is x if the axis is z, and so on cyclically
        Some(eye) => {
            let right = up.cross(&eye);
            if right.sum() < 0.0 { [-right, up, -eye] } else { [right, up, eye] }
        }
        None => {
            let ahead = if up.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
            let ahead = (ahead - up * up.dot(&ahead)).normalize();
            let side = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(up), VIEW_ANGLES[0]);
            let right = side * ahead;
            let level = right.cross(&up);
            let eye = level * VIEW_ANGLES[1].cos() + up * VIEW_ANGLES[1].sin();
            [right, eye.cross(&right), eye]
        }
    }
}

/// A solid at its place.
struct Placed<'s> {
    solid: &'s Solid,
    /// the points whose convex hull it is
    core: Vec<Vector3<f64>>,
    lines: Vec<Vec<Vector3<f64>>>,
}

impl<'s> Placed<'s> {
    fn at(solid: &'s Solid, shown: &Animation, moment: usize) -> Option<Self> {
        let (origin, axes) = match solid.frame {
            None => (Vector3::zeros(), [Vector3::x(), Vector3::y(), Vector3::z()]),
            Some(frame) => {
                let frame = shown.frames.get(frame)?;
                let origin = shown.points.get(frame.at)?.places.get(moment)?;
                (Vector3::from(*origin), frame.axes.get(moment)?.map(Vector3::from))
            }
        };
        let place = |at: &[f64; 3]| origin + axes[0] * at[0] + axes[1] * at[1] + axes[2] * at[2];
        let core: Vec<Vector3<f64>> = solid.core.iter().map(place).collect();
        let lines = solid.lines.iter().map(|line| line.iter().map(place).collect()).collect();
        core.iter().all(|at| at.iter().all(|x| x.is_finite())).then_some(Placed { solid, core, lines })
    }
}

/// Chooses scale and centre: all solids are visible except grounds, of which the part nearby is.
fn fit(view: &mut View, solids: &[Placed<'_>], points: &[Option<Vector3<f64>>]) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut add = |at: [f64; 2], round: f64| {
        for i in 0..2 {
            low[i] = low[i].min(at[i] - round);
            high[i] = high[i].max(at[i] + round);
        }
    };
    for Placed { solid, core, .. } in solids.iter().filter(|placed| !placed.solid.ground) {
        core.iter().for_each(|at| add(view.flat(*at), solid.round));
    }
    points.iter().flatten().for_each(|at| add(view.flat(*at), 0.0));
    if low[0] > high[0] {
        return;
    }
    let widest = [0, 1].map(|i| (high[i] - low[i]) / (SIZE[i] - 2.0 * MARGIN));
    let room = widest[0].max(widest[1]);
    view.scale = if room > 0.0 { 1.0 / room } else { 1.0 };
    view.middle = [0, 1].map(|i| 0.5 * (low[i] + high[i]));
}

fn draw(view: &View, Placed { solid, core, lines }: &Placed<'_>, shapes: &mut Vec<Shape>) {
    let colour = rgb(&solid.colour);
    let dark = colour.map(|part| (f64::from(part) * 0.55) as u8);
    let mut outline = Vec::new();
    for at in core {
        let [x, y] = view.flat(*at);
        match solid.round > 0.0 {
            false => outline.push([x, y]),
            true => outline.extend((0..CIRCLE_POINTS).map(|k| {
                let angle = std::f64::consts::TAU * k as f64 / CIRCLE_POINTS as f64;
                [x + solid.round * angle.cos(), y + solid.round * angle.sin()]
            })),
        }
    }
    let mut outline: Vec<[f64; 2]> = hull(outline).into_iter().map(|at| view.pixels(at)).collect();
    let opacity = match (solid.ground, solid.frame) {
        (true, _) => 0.18,
        (false, None) => 0.4,
        (false, Some(_)) => 0.75,
    };
    if outline.len() > 2 {
        shapes.push(Shape::Polygon { points: outline.clone(), colour: Colour(colour, opacity) });
    }
    let faint = if solid.ground { 0.35 } else { 0.6 };
    for line in lines {
        let points: Vec<[f64; 2]> = line.iter().map(|at| view.place(*at)).collect();
        shapes.push(Shape::Line { points, colour: Colour(dark, faint), width: 0.7, dashes: Vec::new() });
    }
    if let Some(first) = outline.first().copied() {
        outline.push(first);
        let width = if solid.ground { 1.0 } else { 1.2 };
        shapes.push(Shape::Line { points: outline, colour: Colour(dark, 1.0), width, dashes: Vec::new() });
    }
}

/// The convex hull of points, in order (Andrew's monotone chain).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turn =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut out: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = out[..]
                && turn(a, b, point) <= 0.0
            {
                out.pop();
            }
            out.push(point);
        }
        out.pop();
        out
    };
    let mut out = chain(&mut points.iter().copied());
    out.extend(chain(&mut points.iter().rev().copied()));
    out
}

/// The components of a colour such as `#c8362e`.
fn rgb(colour: &str) -> [u8; 3] {
    let part =
        |i: usize| colour.get(i..i + 2).and_then(|part| u8::from_str_radix(part, 16).ok()).unwrap_or(0x80);
    [part(1), part(3), part(5)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_goes_round_once() {
        let square = vec![[0.0, 0.0], [1.0, 1.0], [0.5, 0.5], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.0, 0.0]];
        assert_eq!(hull(square), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(hull(vec![[1.0, 2.0], [1.0, 2.0]]), [[1.0, 2.0]]);
        assert_eq!(hull(vec![[0.0, 0.0], [2.0, 2.0], [1.0, 1.0]]).len(), 2);
    }

    #[test]
    fn colours_are_read() {
        assert_eq!(rgb("#c8362e"), [0xc8, 0x36, 0x2e]);
        assert_eq!(rgb("none"), [0x80, 0x80, 0x80]);
    }
}
