//! The messages of the file, with the field names of Foxglove's schemas.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

/// A time since the start of the simulation's clock, to the nanosecond.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Time {
    sec: u64,
    nsec: u64,
}

impl Time {
    /// The time of a number of seconds, which is not negative.
    pub fn of(seconds: f64) -> Self {
        let all = nanoseconds(seconds);
        Time { sec: all / 1_000_000_000, nsec: all % 1_000_000_000 }
    }
}

/// Seconds, which are not negative, in whole nanoseconds.
pub fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

/// A vector or a position, along the axes of its frame.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Xyz {
    x: f64,
    y: f64,
    z: f64,
}

/// The vector of three numbers.
pub fn xyz([x, y, z]: [f64; 3]) -> Xyz {
    Xyz { x: x + 0.0, y: y + 0.0, z: z + 0.0 }
}

/// A unit quaternion.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

impl From<UnitQuaternion<f64>> for Quaternion {
    fn from(turn: UnitQuaternion<f64>) -> Self {
        Quaternion { x: turn.i, y: turn.j, z: turn.k, w: turn.w }
    }
}

/// The smallest rotation from one direction to another; for opposite directions about an axis perpendicular
/// to the first.
pub fn turning(from: Vector3<f64>, to: Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&from, &to).unwrap_or_else(|| {
        let beside = if from.x.abs() < 0.9 * from.norm() { Vector3::x() } else { Vector3::y() };
        let axis = nalgebra::Unit::new_normalize(from.cross(&beside));
        UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI)
    })
}

/// `foxglove.FrameTransforms`.
#[derive(Debug, Serialize)]
pub struct Transforms {
    /// of all frames
    pub transforms: Vec<Transform>,
}

/// `foxglove.FrameTransform`: the pose of a frame in its parent.
#[derive(Debug, Serialize)]
pub struct Transform {
    /// when
    pub timestamp: Time,
    /// the parent
    pub parent_frame_id: String,
    /// the frame
    pub child_frame_id: String,
    /// its origin, m
    pub translation: Xyz,
    /// its axes
    pub rotation: Quaternion,
}

/// `foxglove.Log`.
#[derive(Debug, Serialize)]
pub struct Log<'a> {
    /// when
    pub timestamp: Time,
    /// 2 informs
    pub level: u8,
    /// in words
    pub message: String,
    /// the contact; may be empty
    pub name: &'a str,
    /// empty
    pub file: &'a str,
    /// zero
    pub line: u32,
}

/// `foxglove.SceneUpdate`.
#[derive(Debug, Serialize)]
pub struct Update {
    /// none: an entity replaces the previous one of the same name
    pub deletions: [(); 0],
    /// the entities of the scene
    pub entities: Vec<Entity>,
}

/// `foxglove.SceneEntity`.
#[derive(Debug, Serialize)]
pub struct Entity {
    /// when
    pub timestamp: Time,
    /// the frame of all positions in it
    pub frame_id: &'static str,
    /// its name; an entity replaces the previous one of the same name
    pub id: String,
    /// how long it is displayed; zero: until it is replaced
    pub lifetime: Time,
    /// whether it moves with its frame
    pub frame_locked: bool,
    /// none
    pub metadata: [(); 0],
    /// arrows
    pub arrows: Vec<Arrow>,
    /// none
    pub cubes: [(); 0],
    /// points
    pub spheres: Vec<Sphere>,
    /// none
    pub cylinders: [(); 0],
    /// lines between points
    pub lines: Vec<Line>,
    /// none
    pub triangles: [(); 0],
    /// names
    pub texts: Vec<Text>,
    /// none
    pub models: [(); 0],
}

/// A place and an attitude.
#[derive(Debug, Serialize)]
pub struct Pose {
    /// m
    pub position: Xyz,
    /// its axes
    pub orientation: Quaternion,
}

impl Pose {
    /// A position without rotation.
    pub fn at(place: [f64; 3]) -> Self {
        Pose { position: xyz(place), orientation: UnitQuaternion::identity().into() }
    }
}

/// Red, green, blue and opacity, 0 to 1.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Color {
    /// red
    pub r: f64,
    /// green
    pub g: f64,
    /// blue
    pub b: f64,
    /// opacity
    pub a: f64,
}

/// `foxglove.ArrowPrimitive`: along +x of its pose; lengths in m.
#[derive(Debug, Serialize)]
pub struct Arrow {
    /// its tail and direction
    pub pose: Pose,
    /// without the head
    pub shaft_length: f64,
    /// of the shaft
    pub shaft_diameter: f64,
    /// of the head
    pub head_length: f64,
    /// of the head
    pub head_diameter: f64,
    /// of the whole
    pub color: Color,
}

/// `foxglove.SpherePrimitive`.
#[derive(Debug, Serialize)]
pub struct Sphere {
    /// its centre
    pub pose: Pose,
    /// diameters, m
    pub size: Xyz,
    /// of the whole
    pub color: Color,
}

/// `foxglove.LinePrimitive`.
#[derive(Debug, Serialize)]
pub struct Line {
    /// 0: from point to point; 2: a line for each pair of points
    pub r#type: u8,
    /// the origin of its points
    pub pose: Pose,
    /// m
    pub thickness: f64,
    /// whether the thickness is in pixels
    pub scale_invariant: bool,
    /// in their order
    pub points: Vec<Xyz>,
    /// of the whole
    pub color: Color,
    /// none: one colour for all
    pub colors: [(); 0],
    /// none: points in their order
    pub indices: [(); 0],
}

/// `foxglove.TextPrimitive`.
#[derive(Debug, Serialize)]
pub struct Text {
    /// its middle
    pub pose: Pose,
    /// whether the text faces the viewer
    pub billboard: bool,
    /// of a line, in pixels
    pub font_size: f64,
    /// whether the size is in pixels
    pub scale_invariant: bool,
    /// of the letters
    pub color: Color,
    /// the words
    pub text: String,
}
