//! The ball on a turntable against its equations by hand.

use hodograph_models::ball_on_turntable::{BallOnTurntable, Coordinates, Parameters, Speeds};

/// With F the force of the table, a the acceleration of the centre, n the normal and W the rate of the table:
/// m a = F + m g, J w' = -r n x F, and where the two points of contact move together a = W' n x p + W n x v +
/// r w' x n. Without F: (1 + m r^2 / J) a = W' n x p + W n x v + m r^2 / J g, along the plane.
#[test]
fn the_centre_moves_as_by_hand() {
    for (tilt, w, t) in [(0.0, 0.0, 0.0), (0.2, 3.0, 0.7), (-0.4, 1.3, 2.1)] {
        let parameters = Parameters { tilt, w, ..Parameters::default() };
        let ball = BallOnTurntable::<f64>::new(parameters).unwrap();
        let (q, u) = (Coordinates::default(), Speeds { w1: 1.3, w2: -0.7, w3: 2.9 });
        let v = ball.dependent_speeds(t, &q, &u).unwrap();
        let a = ball.dependent_accelerations(t, &q, &u).unwrap();
        let Parameters { m, r, J, g, W, swing, .. } = parameters;
        let (rate, change) = (W + swing * w * (w * t).cos(), -swing * w * w * (w * t).sin());
        let share = m * r * r / J;
        let expected = [
            (-change * q.y - rate * v.vy) / (1.0 + share),
            (change * q.x + rate * v.vx - share * g * tilt.sin()) / (1.0 + share),
        ];
        assert!((v.vx - (r * u.w2 - rate * q.y)).abs() < 1e-14, "{v:?}");
        assert!((v.vy - (rate * q.x - r * u.w1)).abs() < 1e-14, "{v:?}");
        assert!(
            (a.vx - expected[0]).abs() < 1e-12 && (a.vy - expected[1]).abs() < 1e-12,
            "{a:?} {expected:?}"
        );
        // Nothing acts about the normal.
        assert_eq!(ball.accelerations(t, &q, &u).unwrap().w3, 0.0);
    }
}

/// On a level table that turns uniformly the centre of a uniform ball goes round at 2/7 of the table's rate.
#[test]
fn two_sevenths() {
    let parameters = Parameters { tilt: 0.0, swing: 0.0, ..Parameters::default() };
    let ball = BallOnTurntable::<f64>::new(parameters).unwrap();
    let (q, u) = (Coordinates::default(), Speeds::default());
    let v = ball.dependent_speeds(0.0, &q, &u).unwrap();
    let a = ball.dependent_accelerations(0.0, &q, &u).unwrap();
    let rate = 2.0 / 7.0 * parameters.W;
    assert!((a.vx + rate * v.vy).abs() < 1e-14 && (a.vy - rate * v.vx).abs() < 1e-14, "{a:?}");
}
