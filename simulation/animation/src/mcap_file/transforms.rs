//! The poses of the frames: `world`, whose z points upwards, the inertial frame N in it, and the frames of
//! bodies in N.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::messages::{Time, Transform, Transforms, turning, xyz};
use crate::Animation;

/// The inertial frame of models.
pub const INERTIAL: &str = "N";
/// The parent of the inertial frame.
const WORLD: &str = "world";

/// The transforms at a moment; a frame that is unknown there is left out.
pub fn at(shown: &Animation, moment: usize) -> Transforms {
    let timestamp = Time::of(shown.times[moment]);
    let transform = |parent: &str, child: String, place: [f64; 3], turned: UnitQuaternion<f64>| Transform {
        timestamp,
        parent_frame_id: parent.to_owned(),
        child_frame_id: child,
        translation: xyz(place),
        rotation: turned.into(),
    };
    let upright = turning(Vector3::from(shown.up), Vector3::z());
    let world = transform(&world(shown), INERTIAL.to_owned(), [0.0; 3], upright);
    let frames = shown.frames.iter().enumerate().filter_map(|(index, frame)| {
        let axes = frame.axes[moment];
        let place = shown.points[frame.at].places[moment];
        if !axes.iter().flatten().chain(&place).all(|number| number.is_finite()) {
            return None;
        }
        // Its columns are the axes along N.
        let matrix = Matrix3::from_columns(&axes.map(Vector3::from));
        let turned = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
        Some(transform(INERTIAL, name(shown, index), place, turned))
    });
    Transforms { transforms: std::iter::once(world).chain(frames).collect() }
}

/// The name of a frame: that of the model, followed by the point where it is drawn if it is drawn at several.
fn name(shown: &Animation, index: usize) -> String {
    let frame = &shown.frames[index];
    match shown.frames.iter().filter(|other| other.name == frame.name).count() {
        1 => frame.name.clone(),
        _ => format!("{}/{}", frame.name, shown.points[frame.at].name),
    }
}

/// A name that no frame of the model has.
fn world(shown: &Animation) -> String {
    let mut name = WORLD.to_owned();
    while shown.frames.iter().any(|frame| frame.name == name) {
        name.push('_');
    }
    name
}
