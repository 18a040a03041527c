//! Painleve's rod: no finite force holds it while it slides. The impact without collision is compared with a
//! stiff compliant contact.
//!
//! The floor is a spring of stiffness k (with k / e^2 on the way out, so that e^2 of the work comes back:
//! Stronge's law) and dry friction. With eps = k^-1/2, time tau = t / eps and z = penetration / eps the
//! compliant motion is a regular perturbation in eps: its final speeds are a power series in eps. They are
//! integrated for a sequence of stiffnesses, eps halved each time, and extrapolated to eps = 0 (Richardson);
//! that the differences fall by two each time is asserted.

use crate::common::{Body, Line, Part, first, run, start, surface};
use hodograph::{Contacts, Law, Mechanism, State};
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

/// What friction does at the moment.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Friction {
    Slides(f64),
    Sticks,
}

/// Coordinates, speeds, z.
type Compliant = [f64; 7];

/// The rates with respect to tau; the stiffness is 1, or 1 / e^2 about another length on the way out.
fn rates(body: &Body, y: &Compliant, eps: f64, friction: Friction, spring: (f64, f64)) -> Compliant {
    let (q, u, z) = (&y[..3], &y[3..6], y[6]);
    let state = State { time: 0.0, coordinates: q, speeds: u, inputs: &[0.0] };
    let velocity = body.contact_velocity(0, &state).unwrap();
    let m = body.contact_state(0, &state).unwrap().reduced;
    let normal = spring.0 * (z - spring.1);
    let tangential = match friction {
        Friction::Slides(sign) => -sign * MU * normal,
        // The velocity along the floor stays zero, but for the turn of the rod in this time.
        Friction::Sticks => -(m.nt * normal + eps * body.free_acceleration(0, &state).unwrap().y) / m.tt,
    };
    let mut response = [0.0; 9];
    body.response(0, &state, &mut response).unwrap();
    let mut rates = [0.0; 7];
    for i in 0..3 {
        rates[i] = eps * u[i];
        rates[3 + i] = response[3 * i] * normal + response[3 * i + 1] * tangential;
    }
    rates[6] = -velocity.x;
    rates
}

/// Runge and Kutta's method of order 4.
fn stepped(y: &Compliant, h: f64, f: &dyn Fn(&Compliant) -> Compliant) -> Compliant {
    let moved = |k: &Compliant, by: f64| -> Compliant { std::array::from_fn(|i| y[i] + by * k[i]) };
    let a = f(y);
    let b = f(&moved(&a, 0.5 * h));
    let c = f(&moved(&b, 0.5 * h));
    let d = f(&moved(&c, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

/// The speeds with which the tip leaves a floor of stiffness eps^-2.
fn compliant(body: &Body, q: [f64; 3], u: [f64; 3], e: f64, eps: f64) -> [f64; 3] {
    // Weightless: what sets it off is a speed of approach of 1e-9, whose square is its share of the outcome's
    // energy.
    let mut body = body.clone();
    body.gravity = [0.0, 0.0];
    let mut y: Compliant = [q[0], q[1], q[2], u[0], u[1] - 1e-9, u[2], 0.0];
    let slip = |y: &Compliant| contact_velocity(&body, y).1;
    let sinks = |y: &Compliant| contact_velocity(&body, y).0;
    let mut friction = Friction::Slides(slip(&y).signum());
    let mut spring = (1.0, 0.0);
    let mut out = false;
    let h = 2e-3;
    for _ in 0..200_000 {
        let f = |y: &Compliant| rates(&body, y, eps, friction, spring);
        // What ends this phase: above zero while it lasts.
        let left = |y: &Compliant| -> f64 {
            let slides = match friction {
                Friction::Slides(sign) => sign * slip(y),
                Friction::Sticks => 1.0,
            };
            if out { slides.min(y[6] - spring.1) } else { slides.min(-sinks(y)) }
        };
        let next = stepped(&y, h, &f);
        if left(&next) > 0.0 {
            y = next;
            continue;
        }
        let (mut low, mut high) = (0.0, h);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if left(&stepped(&y, middle, &f)) > 0.0 { low = middle } else { high = middle }
        }
        y = stepped(&y, high, &f);
        if let Friction::Slides(sign) = friction
            && sign * slip(&y) <= 1e-13
        {
            // Friction holds what stopped, or slip turns round.
            let state = State { time: 0.0, coordinates: &y[..3], speeds: &y[3..6], inputs: &[0.0] };
            let m = body.contact_state(0, &state).unwrap().reduced;
            friction = if m.nt.abs() <= MU * m.tt { Friction::Sticks } else { Friction::Slides(-sign) };
            continue;
        }
        if out {
            return [y[3], y[4], y[5]];
        }
        // The end of compression: the force stays, the spring becomes stiffer.
        out = true;
        spring = (1.0 / (e * e), y[6] * (1.0 - e * e));
    }
    panic!("the rod does not leave the floor");
}

/// Normal and tangential velocity of the tip.
fn contact_velocity(body: &Body, y: &Compliant) -> (f64, f64) {
    let state = State { time: 0.0, coordinates: &y[..3], speeds: &y[3..6], inputs: &[0.0] };
    let velocity = body.contact_velocity(0, &state).unwrap();
    (velocity.x, velocity.y)
}

/// The limit of a sequence whose terms are power series in eps, halved each time, and how fast the first
/// differences fall.
fn extrapolated(mut terms: Vec<f64>) -> (f64, f64) {
    let n = terms.len();
    let falls = (terms[n - 3] - terms[n - 2]) / (terms[n - 2] - terms[n - 1]);
    let mut power = 2.0;
    while terms.len() > 1 {
        terms = terms.windows(2).map(|pair| (power * pair[1] - pair[0]) / (power - 1.0)).collect();
        power *= 2.0;
    }
    (terms[0], falls)
}

#[test]
fn the_rod_jumps_as_on_a_stiff_floor() {
    let (body, q) = rod();
    let mut worst = 0.0_f64;
    for (velocity, e) in [(1.0, 1.0), (1.0, 0.6), (2.5, 0.3)] {
        // The tip slides and does not leave the floor.
        let u = [-velocity, 0.0, 0.0];
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[0.0] };
        let m = body.contact_state(0, &state).unwrap().reduced;
        let f = m.nn - MU * m.nt * u[0].signum();
        let u = if f < 0.0 { u } else { [velocity, 0.0, 0.0] };
        let mut simulation = start(&body, &q, &u, surface(MU, e, Law::Stronge));
        let events = run(&mut simulation, 1e-6);
        let jump = first(&events, "impact_without_collision");
        assert_eq!(jump.time, 0.0);
        let EventKind::ImpactWithoutCollision(struck) = &jump.kind else { panic!() };
        assert!(struck.outcome.impact.velocity.x > 0.05 && struck.outcome.energy_change < 0.0);
        // Stiffnesses from 1e6 to 2.5e8.
        let sequence: Vec<[f64; 3]> =
            (0..5).map(|j| compliant(&body, q, u, e, 1e-3 / f64::from(1 << j))).collect();
        for i in 0..3 {
            let (limit, falls) = extrapolated(sequence.iter().map(|speeds| speeds[i]).collect());
            assert!((falls - 2.0).abs() < 0.02, "{velocity} {e}: order {}", falls.log2());
            worst = worst.max((jump.speeds[i] - limit).abs());
        }
    }
    println!("Painleve's rod: rigid and compliant, extrapolated, differ by {worst:.1e} m/s");
    assert!(worst < 1e-7, "{worst:e}");
}

/// On a belt the contact's work is not the change of kinetic energy: the belt takes a part, (24).
#[test]
fn the_energy_of_a_jump_on_a_belt_is_that_of_the_speeds() {
    let (mut body, q) = rod();
    let mut seen = 0;
    for belt in [-3.0, 0.7, 2.0] {
        body.lines[0].belt = belt;
        let surface = surface(MU, 0.6, Law::Stronge);
        for slip in [-1.0, 1.0] {
            let u = [belt + slip, 0.0, 0.0];
            let mut simulation = start(&body, &q, &u, surface.clone());
            let events = run(&mut simulation, 1e-6);
            let Some(jump) = events.iter().find(|event| event.kind.name() == "impact_without_collision")
            else {
                continue;
            };
            let EventKind::ImpactWithoutCollision(struck) = &jump.kind else { panic!() };
            let kinetic = |speeds: &[f64]| {
                let state = State { time: 0.0, coordinates: &q, speeds, inputs: &[0.0] };
                body.kinetic_energy(&state).unwrap()
            };
            let change = kinetic(&jump.speeds) - kinetic(&struck.speeds_before);
            let outcome = &struck.outcome;
            assert!((outcome.energy_change - change).abs() < 1e-12, "{belt}: {change} {outcome:?}");
            assert!((outcome.impact.contact_work - change).abs() > 0.01, "{belt}: the belt takes nothing");
            assert!((simulation.energy().unwrap().impacts - change).abs() < 1e-12, "{belt}");
            seen += 1;
        }
    }
    assert_eq!(seen, 3, "one direction of slip jams on each belt");
}
