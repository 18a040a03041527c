//! Painleve's rod: no finite force holds it while it slides. The impact without collision is compared with a stiff elastic contact.

mod common;

use common::{Body, Line, Part, first, run, start, surface};
use hodograph::{Contacts, Law, State};
use hodograph_simulation::EventKind;

const MU: f64 = 1.6;

/// A rod of length 2 whose tip slides on the floor; the tangent of its angle with the floor is 2.
fn rod() -> (Body, [f64; 3]) {
    let mut body = Body::new(1.0, 1.0 / 3.0, &[Line::floor(Part::Point(-1.0, 0.0))]);
    // Hardly any weight: the impact is over long before it acts.
    body.gravity = [0.0, -1e-3];
    let theta = 2.0_f64.atan();
    (body, [0.0, theta.sin(), theta])
}

/// Speeds of a rod whose tip slides with this velocity and does not leave the floor.
fn sliding(velocity: f64) -> [f64; 3] {
    [velocity, 0.0, 0.0]
}

/// The same on an elastic floor, by Euler's method in short steps: speeds when the tip leaves it.
fn elastic(body: &Body, q: [f64; 3], u: [f64; 3], stiffness: f64) -> [f64; 3] {
    let (mut q, mut u) = (q, u);
    let dt = 2e-4 / stiffness.sqrt();
    let mut deepest = 0.0_f64;
    for _ in 0..4_000_000 {
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[0.0] };
        let gap = body.gap(0, &state).unwrap().unwrap();
        let velocity = body.contact_velocity(0, &state).unwrap();
        deepest = deepest.min(gap);
        if deepest < -1e-12 && gap >= 0.0 {
            return u;
        }
        let normal = stiffness * (-gap).max(0.0);
        let mut response = [0.0; 9];
        body.response(0, &state, &mut response).unwrap();
        // Friction against slip, or what just stops it in this step.
        let tt = body.contact_state(0, &state).unwrap().reduced.tt;
        let nt = body.contact_state(0, &state).unwrap().reduced.nt;
        let stops = -(velocity.y / dt + nt * normal) / tt;
        let friction = stops.clamp(-MU * normal, MU * normal);
        for i in 0..3 {
            let free = if i == 1 { body.gravity[1] } else { 0.0 };
            u[i] += dt * (free + response[3 * i] * normal + response[3 * i + 1] * friction);
        }
        for i in 0..3 {
            q[i] += dt * u[i];
        }
    }
    panic!("the rod does not leave the floor");
}

#[test]
fn the_rod_jumps_as_on_a_stiff_floor() {
    let (body, q) = rod();
    let mut tried = 0;
    for velocity in [1.0, -1.0] {
        let u = sliding(velocity);
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[0.0] };
        let m = body.contact_state(0, &state).unwrap().reduced;
        if m.nn - MU * m.nt * velocity > 0.0 {
            continue;
        }
        tried += 1;
        // Elastic: all the work of the normal force comes back.
        let mut simulation = start(&body, &q, &u, surface(MU, 1.0, Law::Stronge));
        let events = run(&mut simulation, 1e-6);
        let jump = first(&events, "impact_without_collision");
        assert_eq!(jump.time, 0.0);
        let EventKind::ImpactWithoutCollision(struck) = &jump.kind else { panic!() };
        assert!(struck.outcome.impact.velocity.x > 0.1 && struck.outcome.energy_change < 0.0);
        // The stiffer the floor, the nearer.
        let stiff = elastic(&body, q, u, 1e12);
        for (rigid, stiff) in jump.speeds.iter().zip(stiff) {
            assert!((rigid - stiff).abs() < 1e-3, "{:?} {stiff:?}", jump.speeds);
        }
    }
    assert_eq!(tried, 1);
}
