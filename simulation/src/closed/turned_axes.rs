//! Rotations of the tangential axes of a contact about its normal. Axes that are chosen by the normal jump somewhere,
//! for no tangents of a sphere are smooth everywhere; the motion of the bodies does not.

use nalgebra::Vector2;

/// The rotation about the normal that takes the tangential rows of partial velocities V (3 x p, by rows) nearest to those
/// of others: a unit vector with its cosine and sine.
pub(crate) fn turn_of_tangents(from: &[f64], to: &[f64]) -> Vector2<f64> {
    let p = from.len() / 3;
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let ([t, s], [other_t, other_s]) = ([&from[p..2 * p], &from[2 * p..]], [&to[p..2 * p], &to[2 * p..]]);
    let turn = Vector2::new(dot(t, other_t) + dot(s, other_s), dot(s, other_t) - dot(t, other_s));
    let size = turn.norm();
    if size > 0.0 { turn / size } else { Vector2::x() }
}

/// Partial velocities (3 x p, by rows) along tangential axes that are turned about the normal.
pub(crate) fn turned(rows: &[f64], turn: Vector2<f64>) -> Vec<f64> {
    let p = rows.len() / 3;
    let mut turned = rows.to_vec();
    for column in 0..p {
        let (t, s) = (rows[p + column], rows[2 * p + column]);
        turned[p + column] = turn.x * t + turn.y * s;
        turned[2 * p + column] = turn.x * s - turn.y * t;
    }
    turned
}

/// Components of a tangential vector along axes that are turned.
pub(crate) fn along_turned(vector: Vector2<f64>, turn: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(turn.x * vector.x + turn.y * vector.y, turn.x * vector.y - turn.y * vector.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_are_turned_are_turned_back() {
        let rows: Vec<f64> = (0..12).map(|i| (1.7 * f64::from(i)).sin()).collect();
        for angle in [-3.0_f64, -0.4, 0.0, 0.9, 2.5] {
            let turn = Vector2::new(angle.cos(), angle.sin());
            let other = turned(&rows, turn);
            assert!((turn_of_tangents(&rows, &other) - turn).norm() < 1e-14);
            let back = turned(&other, turn_of_tangents(&other, &rows));
            assert!(rows.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-14));
        }
        assert_eq!(turn_of_tangents(&[0.0; 6], &[0.0; 6]), Vector2::x());
        let d = along_turned(Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0));
        assert!((d - Vector2::new(0.0, -1.0)).norm() < 1e-15);
    }
}
