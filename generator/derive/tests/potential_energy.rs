//! A model has a potential energy where gravity and springs have one: its gradient is minus their force.

use super::Derived;
use hodograph_model::numeric;
use hodograph_program::program::Quantity;

/// A body in space on its way along three axes and about three axes, under these loads.
fn model(loads: &str) -> String {
    format!(
        "mechanism Energies;
        parameters {{
            m: kg = 2, J: kg*m^2 = 0.1, l: m = 0.5, g: m/s^2 = 9.81, k: N/m = 30, c: N*s/m = 0.5, l0: m = 0.2,
            kt: N*m/rad = 4, ct: N*m*s/rad = 0.1, t0: rad = 0.3, w: rad/s = 2,
        }}
        inputs {{ a: m = 0.1, s: N/m = 5, b: m/s^2 = 1, f: rad = 0.2 }}
        coordinates {{ x: m = 0.3, y: m = 0.2, z: m = 0.1, q: rad = 0.4, p: rad = 0.3, r: rad = 0.2 }}
        speeds {{ ux: m/s, uy: m/s, uz: m/s, uq: rad/s, up: rad/s, ur: rad/s }}
        definitions {{ stiffer = k*(1 + x/l); twice = 2*k; away = g*N.vec(0, 0, 1); }}
        frames {{ A = N.rotate(z, q); C = A.rotate(x, p); B = C.rotate(y, r); T = N.rotate(y, t0); S = T.rotate(x, w*time); }}
        points {{
            G = O + x*N.x + y*N.y + z*N.z;
            P of Body = G + l*B.x;
            R of Body = G + x*B.x;
            H = O + 2*l*N.y + l*T.x;
        }}
        bodies {{ Body {{ frame: B, centre: G, mass: m, inertia: [J, 2*J, 3*J] }} }}
        loads {{ {loads} }}
        kinematics {{ d(x)/dt = ux; d(y)/dt = uy; d(z)/dt = uz; d(q)/dt = uq; d(p)/dt = up; d(r)/dt = ur; }}"
    )
}

/// Loads that have a potential energy, at fixed time.
const CONSERVATIVE: [&str; 18] = [
    "",
    "gravity: -g*N.y;",
    "gravity: -g*T.y + 2*g*T.z;",
    "gravity: -away;",
    "gravity: -g*A.z;",
    "gravity: -g*S.z;",
    "gravity: -g*(1 + sin(w*time))*N.z;",
    "gravity: -g*N.y; force on P: stiffer*l*N.x; torque on B: kt*p*N.x;",
    "spring P to H: { stiffness: k, length: l0, damping: c };",
    "spring P to H: { stiffness: twice, length: norm(position(H))/9 };",
    "spring P to H: { stiffness: k, damping: c*x/l };",
    "spring P to H: { length: x, damping: c };",
    "spring P to H: { stiffness: k*(2 + cos(w*time)), length: l0*sin(w*time) };",
    "spring R to H: { damping: c };",
    "torsion A about N.z: { angle: q, rest: t0, stiffness: kt, damping: ct };",
    "torsion A about N.z: { angle: q, rest: w*time, stiffness: kt };",
    "torsion C from A about A.x: { angle: p + w*time - w*time, rest: t0, stiffness: kt };",
    "torsion C from A about A.x: { angle: q, rest: p, damping: ct*x/l };",
];

/// Loads that have none.
const OTHERS: [&str; 16] = [
    "gravity: -g*(1 + x/l)*N.y;",
    "gravity: -g*A.y;",
    "gravity: -g*B.z;",
    "gravity: -g*unit(position(H, G));",
    "gravity: -b*N.y;",
    "spring P to H: { stiffness: stiffer, length: l0 };",
    "spring P to H: { stiffness: k*q/t0, length: l0 };",
    "spring P to H: { stiffness: k, length: x };",
    "spring P to H: { stiffness: k, length: norm(position(P, O))/2 };",
    "spring P to H: { stiffness: s };",
    "spring P to H: { stiffness: k, length: a };",
    "gravity: -g*N.z; spring P to H: { stiffness: k, length: l0 }; torsion A about N.z: { angle: q, rest: p, stiffness: kt };",
    "torsion A about N.z: { angle: q, stiffness: kt*x/l };",
    "torsion A about N.z: { angle: q, rest: f, stiffness: kt };",
    // the force moves the point of the body, and not the place, from which the length is measured
    "spring R to H: { stiffness: k, length: l0 };",
    // the angle is none about this axis
    "torsion B about N.x: { angle: p, stiffness: kt };",
];

/// What is told of both roads: the potential energy of the program, and that of the numeric evaluation.
fn energies(derived: &Derived, state: &numeric::State) -> (Vec<f64>, Option<f64>) {
    let numeric = numeric::evaluate(&derived.mechanism, state).unwrap();
    (derived.get(state, Quantity::PotentialEnergy), numeric.potential_energy)
}

#[test]
fn its_gradient_is_minus_the_force() {
    for loads in CONSERVATIVE {
        let derived = Derived::of(&model(loads));
        let mut state = derived.state();
        state.time = 0.7;
        let applied = loads.contains("force on");
        let forces = derived.get(&state, Quantity::Forcing);
        let h = 1e-5;
        for (i, force) in forces.into_iter().enumerate() {
            let moved = |by: f64| {
                let mut moved = state.clone();
                moved.coordinates[i] += by;
                let (ours, theirs) = energies(&derived, &moved);
                let theirs = theirs.unwrap_or_else(|| panic!("no potential energy: {loads}"));
                assert!(
                    ours.len() == 1 && (ours[0] - theirs).abs() <= 1e-12 * (1.0 + theirs.abs()),
                    "{loads}: {ours:?} {theirs}"
                );
                theirs
            };
            let slope = (moved(h) - moved(-h)) / (2.0 * h);
            assert!(
                applied || (slope + force).abs() <= 1e-7 * (1.0 + force.abs()),
                "{loads}: {i}: {slope} {force}"
            );
        }
    }
}

#[test]
fn there_is_none_where_coefficients_depend_on_coordinates_or_inputs() {
    for loads in OTHERS {
        let derived = Derived::of(&model(loads));
        assert_eq!(energies(&derived, &derived.state()), (vec![], None), "{loads}");
    }
}

/// Power that is fed by the energy is that of the forces themselves.
#[test]
fn what_is_lost_is_the_power_of_gravity_and_springs() {
    let loads = "gravity: -g*N.y; spring P to H: { stiffness: k, length: l0, damping: c };
        torsion A about N.z: { angle: q, rest: t0, stiffness: kt, damping: ct };";
    let derived = Derived::of(&model(loads));
    let mut state = derived.state();
    state.speeds = vec![0.3, -0.4, 0.5, 1.1, -0.7, 0.9];
    let now = numeric::evaluate(&derived.mechanism, &state).unwrap();
    let moved = |h: f64| {
        let mut moved = state.clone();
        moved.coordinates.iter_mut().zip(&now.rates).for_each(|(q, rate)| *q += h * rate);
        energies(&derived, &moved).1.unwrap()
    };
    let lost = (moved(-1e-5) - moved(1e-5)) / 2e-5;
    assert!((lost - now.conservative_power).abs() < 1e-7 * lost.abs(), "{lost} {}", now.conservative_power);
    assert!((lost - now.power).abs() > 1e-3, "the dampers' power is another: {lost} {}", now.power);
}

/// Also where the ends of a spring have other velocities than their places.
#[test]
fn both_roads_have_the_same_forces() {
    for loads in
        CONSERVATIVE.into_iter().chain(OTHERS).chain(["spring R to H: { stiffness: k, damping: c };"])
    {
        let derived = Derived::of(&model(loads));
        let mut state = derived.state();
        (state.time, state.speeds) = (0.3, vec![0.3, -0.4, 0.5, 1.1, -0.7, 0.9]);
        let theirs = numeric::evaluate(&derived.mechanism, &state).unwrap().forcing;
        for (ours, theirs) in derived.get(&state, Quantity::Forcing).into_iter().zip(theirs) {
            assert!((ours - theirs).abs() <= 1e-12 * (1.0 + theirs.abs()), "{loads}: {ours} {theirs}");
        }
    }
}
