//! States and surfaces that make collisions dear: slip that hardly is, is fast or lies next to an invariant
//! direction, friction next to mu_c, steep friction.

use hodograph::nalgebra::{Matrix3, Vector2, Vector3};
use hodograph::{Characteristics, Law, ReducedMatrix, Surface, rates};

use crate::random::Random;

/// How many families there are.
pub const FAMILIES: u32 = 8;

/// A power of ten with an exponent between these.
pub fn power(random: &mut Random, low: i32, high: i32) -> f64 {
    let steps = f64::from(high - low) * 0.5 * (1.0 + random.number());
    let whole = steps as i32;
    let mut number = 1.0 + 9.0 * (steps - f64::from(whole));
    for _ in 0..(low + whole).abs() {
        number *= if low + whole < 0 { 0.1 } else { 10.0 };
    }
    number
}

/// The velocity of approach and the surface of a family, for a contact with this reduced matrix.
pub fn case(
    random: &mut Random,
    family: u32,
    matrix: &ReducedMatrix<f64>,
    ordinary: &Vector3<f64>,
) -> (Vector3<f64>, Surface<f64>) {
    let mut v = *ordinary;
    let pick = |random: &mut Random, count: f64| {
        ((0.5 * (1.0 + random.number()) * count) as usize).min(count as usize - 1)
    };
    let law = Law::ALL[pick(random, 3.0)];
    let e = [0.0, 1.0, 0.5 + 0.5 * random.number()][pick(random, 3.0)];
    let mut mu = 0.75 + 0.75 * random.number();
    match family {
        1 => mu = power(random, -2, 1),
        2 => mu = power(random, 1, 4),
        3 => {
            let side = if random.number() > 0.0 { 1.0 } else { -1.0 };
            mu = Characteristics::of(matrix, 1.0).mu_c * (1.0 + side * power(random, -7, -1));
        }
        4 => (v.y, v.z) = (v.y * power(random, -12, -2), v.z * power(random, -12, -2)),
        5 => (v.y, v.z) = (v.y * power(random, 1, 6), v.z * power(random, 1, 6)),
        6 => {
            mu = power(random, -2, 1);
            if let Some(direction) = invariant(random, matrix, mu) {
                let aside = power(random, -12, -1);
                let slip = v.yz().norm() * power(random, -1, 1);
                (v.y, v.z) =
                    (slip * (direction.x - aside * direction.y), slip * (direction.y + aside * direction.x));
            }
        }
        _ => {}
    }
    if !(mu.is_finite() && mu > 0.0) {
        mu = 0.5;
    }
    (v, Surface { mu, e, law })
}

/// A zero of h, where slip keeps its direction, by bisection along a polygon around the circle.
fn invariant(random: &mut Random, matrix: &ReducedMatrix<f64>, mu: f64) -> Option<Vector2<f64>> {
    let h = |phi: f64| rates(matrix, mu, phi).z;
    let begin = 3.0 * random.number();
    let at = |k: u32| begin + 0.1 * f64::from(k);
    let k = (0..64).find(|&k| (h(at(k)) > 0.0) != (h(at(k + 1)) > 0.0))?;
    let (mut low, mut high) = (at(k), at(k + 1));
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if (h(middle) > 0.0) == (h(low) > 0.0) { low = middle } else { high = middle }
    }
    let (sin, cos) = hodograph::nalgebra::ComplexField::sin_cos(low);
    Some(Vector2::new(cos, sin))
}

/// A contact of no mechanism: a matrix of rank 1 to 3, now and then ill-conditioned, and a velocity of
/// approach.
pub fn contact(random: &mut Random) -> (ReducedMatrix<f64>, Vector3<f64>) {
    let kind = (4.0 * (1.0 + random.number())) as u32;
    let (rank, scale) = match kind {
        0 => (1, 1.0),
        1 => (2, 1.0),
        2 => (3, power(random, -8, 0)),
        _ => (3, 1.0),
    };
    let b = Matrix3::from_fn(|_, column| {
        let entry = random.number() * if column == 2 { scale } else { 1.0 };
        if column < rank { entry } else { 0.0 }
    });
    let speeds = Vector3::from_fn(|_, _| 1.5 * random.number());
    let mut v = if rank < 3 { b * speeds } else { speeds };
    if v.x > 0.0 {
        v = -v;
    }
    (ReducedMatrix::from(b * b.transpose()), v)
}
