//! Evaluates a contact along its axes n, t, s, with t along the slip of approach.

use hodograph::ReducedMatrix;
use hodograph::generated::{self, along_axes, along_slip, contact_axes};
use hodograph_generator::program::ContactQuantity;
use nalgebra::Vector3;

use super::Numbers;

/// The quantities of a contact along n, t, s.
#[derive(Clone, Debug)]
pub struct Contact {
    /// n, t and s along N.x, N.y, N.z
    pub axes: [Vector3<f64>; 3],
    /// gap, m
    pub gap: Option<f64>,
    /// v^R along N.x, N.y, N.z, m/s
    pub velocity: Vector3<f64>,
    /// v^R along n, t, s, m/s: no component along s, and none against t
    pub slip: Vector3<f64>,
    /// partial velocities: rows n, t, s, columns independent speeds
    pub partials: [Vec<f64>; 3],
    /// the part of v^R that depends on no speed, along n, t, s, m/s
    pub remainder: Vector3<f64>,
    /// reduced matrix, 1/kg
    pub reduced: ReducedMatrix<f64>,
}

/// The quantities that are evaluated for a [`Contact`].
pub const QUANTITIES: [ContactQuantity; 9] = [
    ContactQuantity::Normal,
    ContactQuantity::First,
    ContactQuantity::Second,
    ContactQuantity::Velocity,
    ContactQuantity::PartialVelocities,
    ContactQuantity::Remainder,
    ContactQuantity::PrescribedWork,
    ContactQuantity::Reduced,
    ContactQuantity::Gap,
];

impl Contact {
    /// The contact with this index, at these independent speeds. Its axes are those of its collision.
    pub fn new(numbers: &Numbers, index: usize, speeds: &[f64]) -> Self {
        let vector = |quantity| Vector3::from(numbers.three(index, quantity));
        let mut six = [0.0; 6];
        let reduced = numbers.of_contact(index, ContactQuantity::Reduced);
        six.iter_mut().zip(reduced).for_each(|(slot, &number)| *slot = number);
        let contact = generated::Contact {
            normal: vector(ContactQuantity::Normal),
            first: vector(ContactQuantity::First),
            second: vector(ContactQuantity::Second),
            velocity: vector(ContactQuantity::Velocity),
            reduced: six.into(),
            remainder: vector(ContactQuantity::Remainder),
            prescribed_work: vector(ContactQuantity::PrescribedWork),
        };
        let axes = contact_axes(&contact);
        let (reduced, slip) = along_slip(&contact, axes);
        let partials = numbers.of_contact(index, ContactQuantity::PartialVelocities);
        let entry = |row: usize, column: usize| partials.get(row * speeds.len() + column).copied();
        let columns: Vec<Vector3<f64>> = (0..speeds.len())
            .map(|column| Vector3::from_fn(|row, _| entry(row, column).unwrap_or(0.0)))
            .map(|column| along_axes(&column, axes))
            .collect();
        let generated::Contact { normal, first, second, velocity, remainder, .. } = contact;
        let (cos, sin) = axes;
        Contact {
            axes: [normal, first * cos + second * sin, second * cos - first * sin],
            gap: numbers.of_contact(index, ContactQuantity::Gap).first().copied(),
            velocity: normal * velocity.x + first * velocity.y + second * velocity.z,
            slip,
            partials: [0, 1, 2].map(|row| columns.iter().map(|column| column[row]).collect()),
            remainder: along_axes(&remainder, axes),
            reduced,
        }
    }
}
