//! The tangential axes of a contact in space follow from its normal, and jump somewhere, for no tangents of a sphere are
//! smooth everywhere. Motions do not depend on where: they are compared with the same motions in turned axes.

use hodograph::Law;
use hodograph_interpreter::NumericMechanism;

use crate::many::{Ended, Start, follow, numeric, surface};

/// The axes in turn: (x, y, z) becomes (y, z, x).
const AXES: [&str; 3] = ["x", "y", "z"];

/// A ball that a spring draws to the middle of what lies there; `down` is the direction of another force.
fn drawn(name: &str, down: usize, radius: f64, below: &str, contact: &str) -> NumericMechanism {
    numeric(
        name,
        &format!(
            "mechanism Drawn;
            parameters {{ m: kg = 1, r: m = {radius}, k: N/m = 50, J: kg*m^2 = 0.016, f: N = 5 }}
            coordinates {{ x: m, y: m, z: m, e0: 1 = 1, e1: 1, e2: 1, e3: 1 }}
            speeds {{ ux: m/s, uy: m/s, uz: m/s, wx: rad/s, wy: rad/s, wz: rad/s }}
            frames {{ B = N.quaternion(e0, e1, e2, e3); }}
            angular_velocities {{ B = wx*N.x + wy*N.y + wz*N.z; }}
            points {{ G = O + x*N.x + y*N.y + z*N.z; }}
            velocities {{ G = ux*N.x + uy*N.y + uz*N.z; }}
            bodies {{ A {{ frame: B, centre: G, mass: m, inertia: [J, J, J] }} }}
            shapes {{ Ball {{ of: A, sphere: r }}, {below} }}
            loads {{ spring G to O: {{ stiffness: k }}; force on G: -f*N.{}; }}
            contacts {{ touch {{ {contact} }} }}",
            AXES[down]
        ),
    )
}

/// A vector whose components belong to the next axes each.
fn turned(v: [f64; 3], by: usize) -> [f64; 3] {
    let mut out = [0.0; 3];
    (0..3).for_each(|axis| out[(axis + by) % 3] = v[axis]);
    out
}

/// A place, a velocity and an angular velocity.
type Motion = [[f64; 3]; 3];

fn begins(from: Motion, by: usize) -> Start {
    let [place, velocity, spin] = from.map(|v| turned(v, by));
    let coordinates = [&place[..], &[1.0, 0.0, 0.0, 0.0]].concat();
    Start { coordinates, speeds: [velocity, spin].concat(), inputs: Vec::new() }
}

fn there(end: &Ended, by: usize) -> Vec<f64> {
    let of = |v: &[f64]| turned([v[0], v[1], v[2]], 3 - by);
    [of(&end.coordinates), of(&end.speeds), of(&end.speeds[3..])].concat()
}

/// The motions with the three axes in turn have the same events and the same end.
fn compare(names: &str, until: f64, from: Motion, mu: f64, of: impl Fn(usize) -> NumericMechanism) {
    let mut ends: Vec<(usize, Ended)> = Vec::new();
    for by in 0..3 {
        let options = surface(mu, 0.0, Law::Poisson);
        let end = follow(&of(by), &begins(from, by), options, until);
        assert!(end.error.is_none(), "{names} {by}: {:?}", end.error);
        ends.push((by, end));
    }
    let list = |end: &Ended| end.events.iter().map(|event| event.kind.name()).collect::<Vec<_>>();
    let (_, one) = &ends[0];
    assert!(!list(one).contains(&"singular"), "{names}: {:?}", one.names());
    for (by, other) in &ends[1..] {
        assert_eq!(list(one), list(other), "{names}: {:?} {:?}", one.names(), other.names());
        for (a, b) in there(one, 0).iter().zip(there(other, *by)) {
            assert!((a - b).abs() < 1e-7, "{names} {by}: {:?} {:?}", there(one, 0), there(other, *by));
        }
    }
}

/// A ball slides and rolls over the equator of a globe, and up and down in a bowl.
#[test]
fn balls_cross_the_equator() {
    for mu in [0.0, 0.02, 0.4, 2.0] {
        let globe = |by: usize| drawn("globe", (2 + by) % 3, 0.1, "Globe { sphere: 9*r }", "Ball on Globe");
        let from = [[0.9, 0.0, 0.435_889_894_354_067_33], [0.484_322_104_837_852_54, 1.0, -1.0], [0.0; 3]];
        compare(&format!("globe {mu}"), 1.0, from, mu, globe);
        let bowl = |by: usize| drawn("bowl", (2 + by) % 3, 0.1, "Bowl { sphere: 10*r }", "Ball in Bowl");
        let from = [[0.0, 0.0, -0.9], [12.0, 0.5, 0.0], [0.0, 1.0, 0.0]];
        compare(&format!("bowl {mu}"), 0.5, from, mu, bowl);
    }
}

/// A ball goes round the edges of a block, from each side to each.
#[test]
fn balls_go_round_all_edges() {
    let block = |_: usize| {
        numeric(
            "block",
            "mechanism Round;
            parameters { m: kg = 1, r: m = 0.1, k: N/m = 50, a: m = 0.6, J: kg*m^2 = 0.004 }
            coordinates { x: m, y: m, z: m, e0: 1 = 1, e1: 1, e2: 1, e3: 1 }
            speeds { ux: m/s, uy: m/s, uz: m/s, wx: rad/s, wy: rad/s, wz: rad/s }
            frames { B = N.quaternion(e0, e1, e2, e3); }
            angular_velocities { B = wx*N.x + wy*N.y + wz*N.z; }
            points { G = O + x*N.x + y*N.y + z*N.z; }
            velocities { G = ux*N.x + uy*N.y + uz*N.z; }
            bodies { A { frame: B, centre: G, mass: m, inertia: [J, J, J] } }
            shapes { Ball { of: A, sphere: r }, Block { box: [a, a, a], axes: N } }
            loads { spring G to O: { stiffness: k }; }
            contacts { touch { Ball on Block } }",
        )
    };
    for (mu, speed) in [(0.0, 0.8), (0.0, 3.0), (0.05, 1.2)] {
        for (side, along) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let from = [[0.4 * side, 0.02, 0.05], [0.0, 0.1, along * speed], [0.0; 3]];
            compare(&format!("block {mu} {speed} {side} {along}"), 0.4, from, mu, block);
        }
    }
}
