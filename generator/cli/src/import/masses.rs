//! Mass properties of solids of one density.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use super::collision::Solid;
use super::description::Inertial;
use super::poses::Pose;
use super::symmetric::symmetric;

/// Volume of a solid, and its moments of inertia for a mass of 1; `None` for a plane.
pub fn of_solid(solid: Solid) -> Option<(f64, Vector3<f64>)> {
    let flat =
        |[a, b, c]: [f64; 3], part: f64| Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) / part;
    let round = |across: f64, along: f64| Vector3::new(across, across, along);
    Some(match solid {
        Solid::Box(lengths) => (lengths.iter().product(), flat(lengths, 12.0)),
        Solid::Ellipsoid(axes) => (4.0 / 3.0 * PI * axes.iter().product::<f64>(), flat(axes, 5.0)),
        Solid::Sphere(r) => (4.0 / 3.0 * PI * r.powi(3), Vector3::repeat(0.4 * r * r)),
        Solid::Cylinder([r, l]) => (PI * r * r * l, round((3.0 * r * r + l * l) / 12.0, 0.5 * r * r)),
        Solid::Capsule([r, l]) => {
            let (tube, caps) = (PI * r * r * l, 4.0 / 3.0 * PI * r.powi(3));
            let volume = tube + caps;
            let across =
                tube * (3.0 * r * r + l * l) / 12.0 + caps * (0.4 * r * r + 0.25 * l * l + 0.375 * l * r);
            let along = tube * 0.5 * r * r + caps * 0.4 * r * r;
            (volume, round(across, along) / volume)
        }
        Solid::Plane => return None,
    })
}

/// Several bodies as one, given by their masses, their moments of inertia per mass about their own axes, and
/// their poses.
pub fn combined(parts: &[(f64, Vector3<f64>, Pose)]) -> Option<Inertial> {
    let mass: f64 = parts.iter().map(|(mass, ..)| mass).sum();
    if mass <= 0.0 {
        return None;
    }
    let centre = parts.iter().map(|(mass, _, pose)| pose.at * *mass).sum::<Vector3<f64>>() / mass;
    let inertia: Matrix3<f64> = parts
        .iter()
        .map(|(mass, moments, pose)| {
            let own = pose.turn * Matrix3::from_diagonal(moments) * pose.turn.transpose();
            let arm = pose.at - centre;
            (own + Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * *mass
        })
        .sum();
    // products of inertia that are only rounding errors of rotations are zero
    let least = 1e-15 * inertia.amax();
    let inertia = inertia.map(|part| if part.abs() < least { 0.0 } else { part });
    Some(Inertial { mass, centre, rpy: Vector3::zeros(), inertia: symmetric(&inertia) })
}
