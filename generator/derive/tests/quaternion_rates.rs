//! Rates of quaternions relative to frames that turn by coordinates, where angular velocities are stated in N.

use super::Derived;
use hodograph_program::program::Quantity;

type Q = [f64; 4];

fn product(a: Q, b: Q) -> Q {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// B = P(a) C(e), so that e' = P^-1 (B' - P' e), with B' = w B / 2 and P' = a' y P / 2.
#[test]
fn a_quaternion_in_a_frame_that_turns_has_the_rate_of_both() {
    let text = "mechanism Turning;
        parameters { m: kg = 1, J: kg*m^2 = 1 }
        coordinates { a: rad = 0.4, e0: 1 = 0.5, e1: 1 = 0.5, e2: 1 = -0.5, e3: 1 = 0.5 }
        speeds { w1: rad/s = 1, w2: rad/s = -2, w3: rad/s = 0.3, ua: rad/s = 0.7 }
        frames { P = N.rotate(y, a); B = P.quaternion(e0, e1, e2, e3); }
        angular_velocities { B = w1*N.x + w2*N.y + w3*N.z; }
        bodies {
            Ball { frame: B, centre: O, mass: m, inertia: [J, 2*J, 2.5*J] },
            Plate { frame: P, centre: O, mass: m, inertia: [J, J, J] },
        }
        kinematics { d(a)/dt = ua; }";
    let derived = Derived::of(text);
    let state = derived.state();
    let rates = derived.get(&state, Quantity::CoordinateRates);
    let (a, e): (f64, Q) = (0.4, [0.5, 0.5, -0.5, 0.5]);
    let p = [(a / 2.0).cos(), 0.0, (a / 2.0).sin(), 0.0];
    let half = |w: [f64; 3], q: Q| product([0.0, w[0] / 2.0, w[1] / 2.0, w[2] / 2.0], q);
    let of_b = half([1.0, -2.0, 0.3], product(p, e));
    let of_p = product(half([0.0, 0.7, 0.0], p), e);
    let apart: Q = std::array::from_fn(|i| of_b[i] - of_p[i]);
    let expected = product([p[0], -p[1], -p[2], -p[3]], apart);
    assert!((rates[0] - 0.7).abs() < 1e-15, "{rates:?}");
    for (found, expected) in rates[1..].iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{rates:?} {expected:?}");
    }
    // The motion of the ball alone decides its energy: w.J w / 2, in its own axes.
    let energy = derived.get(&state, Quantity::KineticEnergy)[0];
    let b = product(p, e);
    let own = product([b[0], -b[1], -b[2], -b[3]], product([0.0, 1.0, -2.0, 0.3], b));
    let exact = 0.5 * (own[1].powi(2) + 2.0 * own[2].powi(2) + 2.5 * own[3].powi(2)) + 0.5 * 0.7 * 0.7;
    assert!((energy - exact).abs() < 1e-14, "{energy} {exact}");
}
