//! One mechanism described in two ways has the same equations.

use crate::common::{Model, difference};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::{ContactQuantity as C, Quantity as Q};

/// The quaternion of three rotations about new axes x, y, z.
fn quaternion(angles: [f64; 3]) -> [f64; 4] {
    let mut total = [1.0, 0.0, 0.0, 0.0];
    for (axis, angle) in angles.iter().enumerate() {
        let (sin, cos) = (angle / 2.0).sin_cos();
        let mut turn = [cos, 0.0, 0.0, 0.0];
        turn[axis + 1] = sin;
        let ([a, b, c, d], [e, f, g, h]) = (total, turn);
        total = [
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ];
    }
    total
}

#[test]
fn angles_and_quaternion() {
    let (angles, quaternions) = (Model::load("free_box_corner"), Model::load("free_box_quaternion"));
    for step in 0..10 {
        let t = f64::from(step);
        let orientation = [0.3 + 0.4 * t, -0.9 + 0.17 * t, 2.0 - 0.5 * t];
        let place = [0.1, -0.2, 0.7];
        let with_angles = Inputs { coordinates: [place, orientation].concat(), ..angles.initial() };
        let coordinates = [&place[..], &quaternion(orientation)[..]].concat();
        let with_quaternion = Inputs { coordinates, ..with_angles.clone() };
        let contact = |quantity| Q::Contact(0, quantity);
        let quantities = [
            Q::MassMatrix,
            Q::Forcing,
            Q::Accelerations,
            Q::KineticEnergy,
            Q::PotentialEnergy,
            contact(C::Gap),
            contact(C::Velocity),
            contact(C::PartialVelocities),
            contact(C::Reduced),
        ];
        for quantity in quantities {
            let ours = quaternions.get(&with_quaternion, quantity).values;
            let theirs = angles.get(&with_angles, quantity).values;
            assert!(difference(&ours, &theirs) < 1e-13, "{quantity:?}: {ours:?} {theirs:?}");
        }
    }
}
