//! Models of unusual sizes, which are right: none is refused because of rounding.

use hodograph_generator::check::check;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

fn errors(text: &str) -> String {
    let source = Source::file("model.mech", text);
    let checked = check(&source);
    if checked.has_errors() { render(&checked.diagnostics, &source) } else { String::new() }
}

#[test]
fn an_inertia_about_a_far_point_is_judged_by_what_rounding_leaves() {
    let text = "mechanism PointInertia;
        parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }
        coordinates { q: rad = 0.3 }
        speeds { u: rad/s }
        frames { B = N.rotate(z, q); }
        points { P = O - l*B.y; }
        bodies { Bob { frame: B, centre: P, mass: m, inertia: [m*l^2, 0, m*l^2] about O } }
        loads { gravity: -g*N.y; }";
    assert_eq!(errors(text), "");
    let text = "mechanism Lam;
        parameters { m: kg = 1.3, r: m = 1e-3, d: m = 10, g: m/s^2 = 9.81 }
        coordinates { q: rad = 0.3 }
        speeds { u: rad/s }
        frames { B = N.rotate(z, q); }
        points { P = O + d*B.x; }
        bodies { Disc { frame: B, centre: P, mass: m, inertia: [m*r^2/4, m*(r^2/4 + d^2), m*(r^2/2 + d^2)] about O } }
        loads { gravity: -g*N.y; }";
    assert_eq!(errors(text), "");
}

#[test]
fn gears_and_wheels_of_any_size_are_determined() {
    let text = "mechanism RatioMin;
        parameters { m: kg = 1, J: kg*m^2 = 1, i1: 1 = 1e5, i2: 1 = 1e5 }
        coordinates { q: rad, q0: rad, q1: rad }
        speeds { u: rad/s }
        dependent { u0: rad/s, u1: rad/s }
        frames { A = N.rotate(z, q); A0 = N.rotate(z, q0); A1 = N.rotate(z, q1); }
        bodies { B { frame: A, centre: O, mass: m, inertia: [J,J,J] }, B0 { frame: A0, centre: O, mass: m, inertia: [J,J,J] }, B1 { frame: A1, centre: O, mass: m, inertia: [J,J,J] } }
        kinematics { d(q)/dt = u; }
        constraints { u0 = i1*u; u1 = i2*u0; }";
    assert_eq!(errors(text), "");
    let text = "mechanism Kinr;
        parameters { m: kg = 1, k: 1 = 1e5 }
        coordinates { q0: m, q1: m }
        speeds { u: m/s, w: m/s }
        points { P0 = O + q0*N.x; P1 = O + q1*N.y; }
        particles { A0 { point: P0, mass: m }, A1 { point: P1, mass: m } }
        kinematics { d(q0)/dt = k*d(q1)/dt + w; d(q1)/dt = k*u; }";
    assert_eq!(errors(text), "");
    let text = "mechanism Wheel2;
        parameters { m: kg = 1, r: m = 1/1e12, J: kg*m^2 = 1/1e12/1e12 }
        coordinates { x: m, a: rad, b: rad }
        speeds { u: m/s }
        dependent { wa: rad/s, wb: rad/s }
        frames { A = N.rotate(z, a); B = N.rotate(z, b); }
        points { G = O + x*N.x; C of A = G - r*N.y; D of B = G + r*N.y; }
        bodies { W { frame: A, centre: G, mass: m, inertia: [J,J,J] }, V { frame: B, centre: G, mass: m, inertia: [J,J,J] } }
        kinematics { d(x)/dt = u; d(a)/dt = wa; d(b)/dt = wb; }
        constraints { dot(velocity(C), N.x) = 0; dot(velocity(D), N.x) = 0; }";
    assert_eq!(errors(text), "");
}

#[test]
fn what_has_values_at_the_start_only_is_accepted() {
    let text = "mechanism T;
        parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, T: s = 0.001 }
        coordinates { q1: rad = 0.3 }
        speeds { u1: rad/s }
        frames { B = N.rotate(z, q1); }
        points { G = O - l/2*B.y; P = O - l*B.y; }
        bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
        loads { gravity: -g*N.y; torque on B: m*g*l*sqrt(1 - time/T)*N.z; }";
    assert_eq!(errors(text), "");
    let text = "mechanism T;
        parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, T: s = 0.1 }
        coordinates { q1: rad = 0.3 }
        speeds { u1: rad/s }
        frames { B = N.rotate(z, q1); }
        points { G = O - l/2*B.y; P = O - l*B.y + l*acos(1 - time/T)*N.x; }
        bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
        loads { gravity: -g*N.y; }";
    assert_eq!(errors(text), "");
}

/// A point that only slides over its body, and a centre that is known by its velocity, are no mistakes.
#[test]
fn centres_that_are_known_by_velocities_are_accepted() {
    let coin = "mechanism Coin;
        parameters { m: kg = 1, r: m = 0.1, J: kg*m^2 = 3e-3, g: m/s^2 = 9.81 }
        coordinates { q1: rad, q2: rad = 0.3 }
        speeds { u1: rad/s, u2: rad/s, u3: rad/s }
        frames { A = N.rotate(z, q1); L = A.rotate(x, q2); W = L.spin(u3*L.y); }
        points { C velocity 0*N.x; G of W = C + r*L.z; }
        bodies { Disc { frame: W, centre: G, mass: m, inertia: [J, 2*J, J] in L } }
        loads { gravity: -g*N.z; }";
    assert!(!errors(coin).contains("E054"), "{}", errors(coin));
}

#[test]
fn a_chain_of_gears_is_determined() {
    let n = 12;
    let list = |each: &dyn Fn(usize) -> String| (0..n).map(each).collect::<Vec<_>>().join(" ");
    let text = format!(
        "mechanism Gears;
        parameters {{ J: kg*m^2 = 1, m: kg = 1, k: 1 = 10 }}
        coordinates {{ q: rad }}
        speeds {{ u: rad/s }}
        dependent {{ {} }}
        frames {{ A = N.rotate(z, q); }}
        bodies {{ Shaft {{ frame: A, centre: O, mass: m, inertia: [J, J, J] }} }}
        loads {{ torque on A: {}*J/k^30*A.z; }}
        kinematics {{ d(q)/dt = u; }}
        constraints {{ {} }}",
        list(&|i| format!("w{i}: rad/s,")),
        "w11^2",
        list(&|i| if i == 0 { "w0 = k*u;".to_owned() } else { format!("w{i} = k*w{};", i - 1) })
    );
    assert_eq!(errors(&text), "");
}
