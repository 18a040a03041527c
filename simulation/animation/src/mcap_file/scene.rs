//! The scene at a moment: points and lines, their names, arrows of forces and impulses.

use crate::{Animation, Happening, Shape};
use nalgebra::Vector3;

use super::messages::{Arrow, Color, Entity, Line, Pose, Sphere, Text, Time, Update, turning, xyz};
use super::transforms::INERTIAL;

const fn color(r: f64, g: f64, b: f64) -> Color {
    Color { r, g, b, a: 1.0 }
}
/// Colours that can be distinguished on light and dark backgrounds.
const POINT: Color = color(0.35, 0.71, 0.91);
const LINE: Color = color(0.55, 0.58, 0.62);
const FORCE: Color = color(0.0, 0.62, 0.45);
const IMPULSE: Color = color(0.84, 0.37, 0.0);
/// Font size, pixels.
const FONT_SIZE: f64 = 14.0;
/// A line through all points in turn.
const LINE_STRIP: u8 = 0;
/// A line for each pair of points.
const LINE_LIST: u8 = 2;
/// Opacity of balls.
const BALL_OPACITY: f64 = 0.5;
/// Lengths as parts of the extent of the motion.
const LONGEST_ARROW: f64 = 0.25;
const POINT_SIZE: f64 = 1.0 / 60.0;
const LINE_SIZE: f64 = 1.0 / 200.0;
/// An impulse is displayed for this part of the motion.
const IMPULSE_TIME: f64 = 0.04;

/// A motion and its scales.
pub struct Scene<'a> {
    shown: &'a Animation,
    /// largest extent of the region that points pass through, m
    extent: f64,
    /// largest force, N, and impulse, N s
    largest: [f64; 2],
    hold: f64,
}

impl<'a> Scene<'a> {
    /// Determines the scales of a motion.
    pub fn new(shown: &'a Animation) -> Self {
        let mut box_ = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for place in shown.points.iter().flat_map(|point| &point.places).filter(|place| finite(place)) {
            for ([low, high], &x) in box_.iter_mut().zip(place) {
                (*low, *high) = (low.min(x), high.max(x));
            }
        }
        let extent = box_.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        let most = |sizes: &mut dyn Iterator<Item = &[f64; 3]>| {
            sizes.map(|v| Vector3::from(*v).norm()).filter(|size| size.is_finite()).fold(0.0, f64::max)
        };
        let span = shown.times.last().zip(shown.times.first()).map_or(0.0, |(last, first)| last - first);
        Scene {
            shown,
            extent: if extent > 0.0 && extent.is_finite() { extent } else { 1.0 },
            largest: [
                most(&mut shown.forces.iter().flat_map(|force| &force.force).flatten()),
                most(&mut shown.events.iter().filter_map(|event| event.impulse.as_ref())),
            ],
            hold: IMPULSE_TIME * span,
        }
    }

    /// The points and the lines between them.
    pub fn mechanism(&self, moment: usize) -> Update {
        let places = self.places(moment);
        let size = POINT_SIZE * self.extent;
        let spheres = places
            .iter()
            .flatten()
            .map(|&place| Sphere { pose: Pose::at(place), size: xyz([size; 3]), color: POINT })
            .collect();
        let ends = |&[a, b]: &[usize; 2]| Some([places[a]?, places[b]?]);
        let points: Vec<_> = self.shown.segments.iter().filter_map(ends).flatten().map(xyz).collect();
        let lines = match points.is_empty() {
            true => Vec::new(),
            false => vec![Line {
                r#type: LINE_LIST,
                pose: Pose::at([0.0; 3]),
                thickness: LINE_SIZE * self.extent,
                scale_invariant: false,
                points,
                color: LINE,
                colors: [],
                indices: [],
            }],
        };
        let time = self.shown.times[moment];
        let mechanism = Entity { spheres, lines, ..self.entity(time, "mechanism") };
        let entities = std::iter::once(mechanism).chain(self.shapes(moment)).collect();
        Update { deletions: [], entities }
    }

    /// The shapes: balls as spheres, others by lines on their surfaces.
    fn shapes(&self, moment: usize) -> Option<Entity> {
        let (mut spheres, mut lines) = (Vec::new(), Vec::new());
        for shape in &self.shown.shapes {
            let Some(place) = self.placed(shape, moment) else { continue };
            let solid = hexadecimal(&shape.colour);
            if let ([centre], true) = (&shape.core[..], shape.round > 0.0) {
                let size = xyz([2.0 * shape.round; 3]);
                let color = Color { a: BALL_OPACITY, ..solid };
                spheres.push(Sphere { pose: Pose::at(place(*centre)), size, color });
            }
            for line in &shape.lines {
                lines.push(Line {
                    r#type: LINE_STRIP,
                    pose: Pose::at([0.0; 3]),
                    thickness: 0.5 * LINE_SIZE * self.extent,
                    scale_invariant: false,
                    points: line.iter().map(|point| xyz(place(*point))).collect(),
                    color: solid,
                    colors: [],
                    indices: [],
                });
            }
        }
        let some = !spheres.is_empty() || !lines.is_empty();
        some.then(|| Entity { spheres, lines, ..self.entity(self.shown.times[moment], "shapes") })
    }

    /// The map from a shape's axes to N; `None` if its frame is unknown at this moment.
    fn placed(&self, shape: &Shape, moment: usize) -> Option<impl Fn([f64; 3]) -> [f64; 3] + use<>> {
        let (at, axes) = match shape.frame {
            None => ([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
            Some(frame) => {
                let frame = &self.shown.frames[frame];
                (self.shown.points[frame.at].places[moment], *frame.axes.get(moment)?)
            }
        };
        let known = finite(&at) && axes.iter().all(finite);
        known.then_some(move |v: [f64; 3]| {
            std::array::from_fn(|i| at[i] + (0..3).map(|axis| v[axis] * axes[axis][i]).sum::<f64>())
        })
    }

    /// The names of the points, above them.
    pub fn names(&self, moment: usize) -> Update {
        let up = Vector3::from(self.shown.up) * (2.0 * POINT_SIZE * self.extent);
        let text = |(index, place): (usize, Option<[f64; 3]>)| {
            Some(Text {
                pose: Pose::at((Vector3::from(place?) + up).into()),
                billboard: true,
                font_size: FONT_SIZE,
                scale_invariant: true,
                color: LINE,
                text: self.shown.points[index].name.clone(),
            })
        };
        let texts = self.places(moment).into_iter().enumerate().filter_map(text).collect();
        update(Entity { texts, ..self.entity(self.shown.times[moment], "names") })
    }

    /// The contact forces. If none acts, an empty entity replaces the previous arrows.
    pub fn forces(&self, moment: usize) -> Update {
        let arrow =
            |force: &crate::Force| self.arrow(force.at[moment], force.force[moment]?, self.largest[0], FORCE);
        let arrows = self.shown.forces.iter().filter_map(arrow).collect();
        update(Entity { arrows, ..self.entity(self.shown.times[moment], "contact forces") })
    }

    /// The impulse of an event, displayed for a while.
    pub fn impulse(&self, event: &Happening) -> Update {
        let arrow = event.at.zip(event.impulse);
        let arrow = arrow.and_then(|(at, impulse)| self.arrow(at, impulse, self.largest[1], IMPULSE));
        update(Entity {
            arrows: arrow.into_iter().collect(),
            lifetime: Time::of(self.hold),
            ..self.entity(event.time, &format!("{} {}", event.contact, event.time))
        })
    }

    /// The positions of the points, where they are known.
    fn places(&self, moment: usize) -> Vec<Option<[f64; 3]>> {
        self.shown.points.iter().map(|point| Some(point.places[moment]).filter(finite)).collect()
    }

    /// An arrow whose length is proportional to the vector; `None` for a zero vector.
    fn arrow(&self, at: [f64; 3], vector: [f64; 3], largest: f64, color: Color) -> Option<Arrow> {
        let direction = Vector3::from(vector);
        let length = LONGEST_ARROW * self.extent * direction.norm() / largest;
        if !(finite(&at) && length.is_finite() && length > 0.0) {
            return None;
        }
        let width = LINE_SIZE * self.extent;
        let head_length = (3.0 * width).min(0.4 * length);
        Some(Arrow {
            pose: Pose {
                position: xyz(at),
                orientation: turning(Vector3::x(), direction / direction.norm()).into(),
            },
            shaft_length: length - head_length,
            shaft_diameter: width,
            head_length,
            head_diameter: 2.0 * width,
            color,
        })
    }

    /// An empty entity.
    fn entity(&self, time: f64, id: &str) -> Entity {
        Entity {
            timestamp: Time::of(time),
            frame_id: INERTIAL,
            id: id.to_owned(),
            lifetime: Time::of(0.0),
            frame_locked: true,
            metadata: [],
            arrows: Vec::new(),
            cubes: [],
            spheres: Vec::new(),
            cylinders: [],
            lines: Vec::new(),
            triangles: [],
            texts: Vec::new(),
            models: [],
        }
    }
}

fn update(entity: Entity) -> Update {
    Update { deletions: [], entities: vec![entity] }
}

/// The colour of `#rrggbb`.
fn hexadecimal(text: &str) -> Color {
    let part = |at: usize| {
        let digits = text.get(at..at + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        f64::from(digits.unwrap_or(128)) / 255.0
    };
    color(part(1), part(3), part(5))
}

fn finite(place: &[f64; 3]) -> bool {
    place.iter().all(|number| number.is_finite())
}
