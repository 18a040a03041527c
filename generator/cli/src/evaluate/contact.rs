//! Evaluates a contact along its axes n, t, s, with t along the slip of approach.

use hodograph_generator::program::ContactQuantity;
use nalgebra::Vector3;

use super::Numbers;

/// Everything of a contact along n, t, s.
#[derive(Clone, Debug)]
pub struct Contact {
    /// n, t and s along N.x, N.y, N.z
    pub axes: [Vector3<f64>; 3],
    /// gap, m
    pub gap: Option<f64>,
    /// v^R along N.x, N.y, N.z, m/s
    pub velocity: Vector3<f64>,
    /// v^R along n, t, s, m/s: no slip along s, none against t
    pub slip: Vector3<f64>,
    /// partial velocities: rows n, t, s, columns independent speeds
    pub partials: [Vec<f64>; 3],
    /// the part of v^R that depends on no speed, along n, t, s, m/s
    pub remainder: Vector3<f64>,
    /// reduced matrix: nn, nt, ns, tt, ts, ss, 1/kg
    pub reduced: [f64; 6],
    /// cosine and sine of the angle from the program's first tangential axis to t
    turn: (f64, f64),
}

/// What must be evaluated for a [`Contact`].
pub const QUANTITIES: [ContactQuantity; 8] = [
    ContactQuantity::Normal,
    ContactQuantity::First,
    ContactQuantity::Second,
    ContactQuantity::Velocity,
    ContactQuantity::PartialVelocities,
    ContactQuantity::Remainder,
    ContactQuantity::Reduced,
    ContactQuantity::Gap,
];

impl Contact {
    /// The contact of that index, at these independent speeds.
    pub fn new(numbers: &Numbers, index: usize, speeds: &[f64]) -> Self {
        let vector = |quantity| Vector3::from(numbers.three(index, quantity));
        let [n, first, second] =
            [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second].map(vector);
        let velocity = vector(ContactQuantity::Velocity);
        let remainder = vector(ContactQuantity::Remainder);
        let count = speeds.len();
        let partials = numbers.of_contact(index, ContactQuantity::PartialVelocities);
        let row = |row: usize| partials.get(row * count..(row + 1) * count).unwrap_or(&[]);
        let (mut slip, slips) = tangential(&velocity, &remainder, [row(1), row(2)], speeds);
        let (cos, sin) = match slips {
            true => (velocity.y / slip, velocity.z / slip),
            false => {
                slip = 0.0;
                without_slip(&n, &first, &second)
            }
        };
        let turned = |a: f64, b: f64| (cos * a + sin * b, cos * b - sin * a);
        let along: Vec<(f64, f64)> = row(1).iter().zip(row(2)).map(|(&a, &b)| turned(a, b)).collect();
        let mut m = [0.0; 6];
        m.iter_mut()
            .zip(numbers.of_contact(index, ContactQuantity::Reduced))
            .for_each(|(slot, &number)| *slot = number);
        let [nn, n1, n2, m11, m12, m22] = m;
        let (nt, ns) = turned(n1, n2);
        let reduced = [
            nn,
            nt,
            ns,
            cos * cos * m11 + 2.0 * cos * sin * m12 + sin * sin * m22,
            cos * sin * (m22 - m11) + (cos * cos - sin * sin) * m12,
            sin * sin * m11 - 2.0 * cos * sin * m12 + cos * cos * m22,
        ];
        let (rt, rs) = turned(remainder.y, remainder.z);
        Contact {
            axes: [n, first * cos + second * sin, second * cos - first * sin],
            gap: numbers.of_contact(index, ContactQuantity::Gap).first().copied(),
            velocity: n * velocity.x + first * velocity.y + second * velocity.z,
            slip: Vector3::new(velocity.x, slip, 0.0),
            partials: [
                row(0).to_vec(),
                along.iter().map(|pair| pair.0).collect(),
                along.iter().map(|pair| pair.1).collect(),
            ],
            remainder: Vector3::new(remainder.x, rt, rs),
            reduced,
            turn: (cos, sin),
        }
    }

    /// A vector along n, t, s in the basis of the program.
    pub fn in_basis(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        let (cos, sin) = self.turn;
        Vector3::new(vector.x, cos * vector.y - sin * vector.z, sin * vector.y + cos * vector.z)
    }
}

/// The speed of slip, and whether it is more than the rounding of what it is the sum of.
fn tangential(
    velocity: &Vector3<f64>,
    remainder: &Vector3<f64>,
    rows: [&[f64]; 2],
    speeds: &[f64],
) -> (f64, bool) {
    let sizes =
        rows.map(|row| row.iter().zip(speeds).map(|(partial, speed)| (partial * speed).abs()).sum::<f64>());
    let terms = sizes[0] + sizes[1] + remainder.y.abs() + remainder.z.abs();
    let slip = velocity.y.hypot(velocity.z);
    (slip, slip > 16.0 * f64::EPSILON * terms)
}

/// Direction of the projection on the contact plane of the first of N.x, N.y, N.z not within 30 degrees of n.
fn without_slip(n: &Vector3<f64>, first: &Vector3<f64>, second: &Vector3<f64>) -> (f64, f64) {
    let limit = 3f64.sqrt() / 2.0;
    let axis = (0..3).find(|&axis| n[axis].abs() <= limit).unwrap_or(0);
    let (a, b) = (first[axis], second[axis]);
    let length = a.hypot(b);
    if length > 0.0 { (a / length, b / length) } else { (1.0, 0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_slip_t_is_near_an_axis() {
        let (cos, sin) = without_slip(&Vector3::z(), &Vector3::y(), &-Vector3::x());
        assert_eq!((cos, sin), (0.0, -1.0));
        let (cos, sin) = without_slip(&-Vector3::x(), &Vector3::y(), &-Vector3::z());
        assert_eq!((cos, sin), (1.0, 0.0));
    }
}
