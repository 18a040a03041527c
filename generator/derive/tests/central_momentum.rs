//! The angular momentum about the mass centre is the same wherever the mechanism is and however fast it flies.

use super::Derived;
use hodograph_program::program::Quantity;

/// Two bodies on a hinge that fly freely.
const CHAIN: &str = "mechanism Chain;
    parameters { m: kg = 2, n: kg = 3, J: kg*m^2 = 0.1, l: m = 0.5 }
    coordinates { x: m, y: m, z: m, q: rad = 0.4, p: rad = 0.3, r: rad = 0.7 }
    speeds { ux: m/s = 0.1, uy: m/s = -0.3, uz: m/s = 0.2, wq: rad/s = 1.1, wp: rad/s = -0.7, wr: rad/s = 0.4 }
    frames { A = N.rotate(z, q); B = A.rotate(x, p); C = B.rotate(y, r); }
    points { P = O + x*N.x + y*N.y + z*N.z; G = P + l*B.x; Q = P + 2*l*B.x; H = Q + l*C.z; }
    bodies {
        First { frame: B, centre: G, mass: m, inertia: [J, 2*J, 3*J] },
        Second { frame: C, centre: H, mass: n, inertia: [J, J, 2*J] },
    }
    kinematics { d(x)/dt = ux; d(y)/dt = uy; d(z)/dt = uz; d(q)/dt = wq; d(p)/dt = wp; d(r)/dt = wr; }";

/// Three particles, each of which has its place from O.
const SLEDGE: &str = "mechanism Sledge;
    parameters { m: kg = 2, n: kg = 3, l: m = 0.5 }
    coordinates { x: m, y: m, z: m, a: m = 0.4, q: rad = 0.3 }
    speeds { ux: m/s = 0.1, uy: m/s = -0.3, uz: m/s = 0.2, ua: m/s = 0.5, w: rad/s = 0.9 }
    frames { A = N.rotate(z, q); }
    points {
        P = O + x*N.x + y*N.y + z*N.z;
        Q = O + (x + a)*N.x + y*N.y + (z - l)*N.z;
        R = O + x*N.x + (l + y)*N.y + z*N.z + l*A.x;
    }
    particles { First { point: P, mass: m }, Second { point: Q, mass: n }, Third { point: R, mass: n } }
    kinematics { d(x)/dt = ux; d(y)/dt = uy; d(z)/dt = uz; d(a)/dt = ua; d(q)/dt = w; }";

#[test]
fn it_keeps_its_digits_far_away_and_in_fast_flight() {
    for text in [CHAIN, SLEDGE] {
        let derived = Derived::of(text);
        let at = |distance: f64, speed: f64| {
            let mut state = derived.state();
            for (i, along) in [1.0, -0.7, 0.3].into_iter().enumerate() {
                state.coordinates[i] = distance * along;
                state.speeds[i] += speed * [0.2, 1.0, -0.5][i];
            }
            derived.get(&state, Quantity::CentralAngularMomentum)
        };
        let expected = at(0.0, 0.0);
        let size = expected.iter().fold(0.0_f64, |size, h| size.max(h.abs()));
        assert!(size > 0.1, "{expected:?}");
        for (distance, speed) in [(1e8, 0.0), (0.0, 1e8), (1e8, 1e8)] {
            let found = at(distance, speed);
            for (found, expected) in found.iter().zip(&expected) {
                let off = (found - expected).abs() / size;
                assert!(
                    off <= 1e-12,
                    "{} {distance:e} m, {speed:e} m/s: off by {off:e}",
                    derived.mechanism.name
                );
            }
        }
    }
}
