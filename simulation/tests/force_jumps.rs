//! Sticking contacts of shapes whose force jumps where their curvature does: slip that begins there begins once, in the
//! direction of its acceleration behind the jump.

use hodograph::Law;
use hodograph_interpreter::NumericMechanism;

use crate::many::{Start, follow, numeric, surface};

/// A ball and a cone, both free, which a spring pulls together.
fn ball_and_cone() -> NumericMechanism {
    numeric(
        "ball-on-free-cone",
        "mechanism Pair;
        parameters {
            m: kg = 0.7, J: kg*m^2 = 0.03, M: kg = 1.3, I: kg*m^2 = 0.06,
            r: m = 0.3, c: m = 0.4, h: m = 0.7, k: N/m = 60, l: m = 0.2,
        }
        coordinates { x: m, y: m, z: m, a: rad, b: rad, c1: rad, X: m, Y: m, Z: m, A: rad, B: rad, C: rad }
        speeds {
            u: m/s, v: m/s, w: m/s, o1: rad/s, o2: rad/s, o3: rad/s,
            U: m/s, V: m/s, W: m/s, O1: rad/s, O2: rad/s, O3: rad/s,
        }
        frames {
            F1 = N.rotate(x, a); F2 = F1.rotate(y, b); F = F2.rotate(z, c1);
            G1 = N.rotate(x, A); G2 = G1.rotate(y, B); G = G2.rotate(z, C);
        }
        points { P = O + x*N.x + y*N.y + z*N.z; R = O + X*N.x + Y*N.y + Z*N.z; }
        bodies {
            Q { frame: F, centre: P, mass: m, inertia: [J, J, J] },
            S { frame: G, centre: R, mass: M, inertia: [I, I, I] },
        }
        shapes { Ball { of: Q, sphere: r }, Cone { of: S, cone: [c, h], axis: G.z } }
        loads { spring P to R: { stiffness: k, length: l }; }
        kinematics {
            d(x)/dt = u; d(y)/dt = v; d(z)/dt = w; d(a)/dt = o1; d(b)/dt = o2; d(c1)/dt = o3;
            d(X)/dt = U; d(Y)/dt = V; d(Z)/dt = W; d(A)/dt = O1; d(B)/dt = O2; d(C)/dt = O3;
        }
        contacts { strike { Ball on Cone } }",
    )
}

/// Starts from which the ball rolls from the flank of the cone over its rim, and slips there at once.
const STARTS: [([f64; 12], [f64; 12]); 2] = [
    (
        [
            0.36175996675190525,
            -0.011538833185262389,
            0.8713535761972521,
            26.211165181441952,
            -0.7492286496214051,
            -0.7781187965468302,
            0.480088227073247,
            -0.14663488582773815,
            1.1471126786884758,
            12.78860513230464,
            0.010674515295408131,
            2.0992845317542126,
        ],
        [
            -1.1683219288548936,
            1.5601402535579307,
            0.15865764017489065,
            1.2424126751466527,
            1.785403800494395,
            -10.037158615467435,
            0.8576086574741586,
            -0.9544819455448325,
            0.2595517277929428,
            3.798407010406786,
            -8.198342433262333,
            -0.00613494100996176,
        ],
    ),
    (
        [
            1.770268140557397,
            0.10550789075712795,
            1.285795149660081,
            -27.590621023452183,
            -1.0369903076701141,
            -5.721291952856695,
            1.5831613695531548,
            -0.11153978706565074,
            1.1945720273294191,
            -4.2964359832388,
            -0.6032065752556687,
            0.8741224772345425,
        ],
        [
            -0.20118490582202067,
            0.9409048274861017,
            -1.0998830049023045,
            -10.237137123590278,
            -7.966054625550624,
            -5.13862282257345,
            1.1041362895126499,
            -0.561824555085667,
            1.0119028830642915,
            -11.149188500201856,
            -13.243268164588562,
            -2.0905086440718694,
        ],
    ),
];

#[test]
fn slip_begins_once_where_the_force_jumps() {
    let mechanism = ball_and_cone();
    for (i, (coordinates, speeds)) in STARTS.iter().enumerate() {
        let start = Start { coordinates: coordinates.to_vec(), speeds: speeds.to_vec(), inputs: Vec::new() };
        let end = follow(&mechanism, &start, surface(0.8, 0.0, Law::Newton), 0.15);
        let told = format!("{i}: {:?} {:?}", end.names(), end.error);
        assert!(end.error.is_none() && end.account.abs() < 1e-10 * end.before, "{told} {}", end.account);
        let slips: Vec<f64> =
            end.events.iter().filter(|event| event.kind.name() == "slip").map(|event| event.time).collect();
        assert!(!slips.is_empty(), "{told}");
        assert!(slips.windows(2).all(|pair| pair[1] - pair[0] > 1e-9), "{told}");
    }
}
