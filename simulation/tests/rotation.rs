//! Rolling and spinning friction: closed forms, bounds of the torques, and what does not depend on axes and units.

use std::sync::Arc;

use crate::common::{first, run};
use hodograph::{Contacts, Law, State, Surface};
use hodograph_random::Random;
use hodograph_simulation::contact_problem::{Mode, Problem, solve, with_modes};
use hodograph_simulation::{
    ContactLaw, ContactPhase, Drive, ErrorKind, Event, EventKind, Options, Simulation,
};
use nalgebra::{DMatrix, DVector};
use rolling_ball::RollingBall;
use rolling_cart::RollingCart;
use turned_stool::TurnedStool;

hodograph::mechanism!("tests/models/rolling_ball.mech");
hodograph::mechanism!("tests/models/rolling_cart.mech");
hodograph::mechanism!("tests/models/turned_stool.mech");

const G: f64 = 9.81;
/// Mass, radius and moment of inertia of the ball.
const BALL: [f64; 3] = [0.4, 0.11, 0.002];

fn ball(change: impl FnOnce(&mut rolling_ball::Parameters<f64>)) -> RollingBall<f64> {
    let mut parameters = rolling_ball::Parameters::default();
    change(&mut parameters);
    RollingBall::new(parameters).unwrap()
}

fn options(mu: f64, rolling: f64, spinning: f64) -> Options {
    Options {
        surface: Some(Surface { mu, e: 0.4, law: Law::Newton }),
        law: Some(ContactLaw { rolling: Some(rolling), spinning: Some(spinning), ..ContactLaw::default() }),
        ..Options::default()
    }
}

/// A motion from the coordinates of the model.
fn begin<'m>(body: &'m dyn Contacts<f64>, speeds: &[f64], options: Options) -> Simulation<'m> {
    let n = body.count(hodograph::ComponentKind::Coordinate);
    let inputs = vec![0.0; body.count(hodograph::ComponentKind::Input)];
    let (mut q, mut u, mut w) = (vec![0.0; n], vec![0.0; speeds.len()], inputs.clone());
    body.initial_state(&mut q, &mut u, &mut w).unwrap();
    let state = State { time: 0.0, coordinates: &q, speeds, inputs: &inputs };
    Simulation::new(body, &state, options).unwrap()
}

/// The kinds of events, but for the beginning of contact and rest at the start.
fn kinds(events: &[Event]) -> Vec<&'static str> {
    events.iter().filter(|event| event.time > 0.0).map(|event| event.kind.name()).collect()
}

/// When the first event of this kind is.
fn time(events: &[Event], name: &str) -> f64 {
    first(events, name).time
}

fn near(what: &str, ours: f64, theirs: f64, bound: f64) {
    assert!((ours - theirs).abs() <= bound, "{what}: {ours} {theirs} {:e}", ours - theirs);
}

/// Deceleration of a ball that rolls.
fn slows(rolling: f64) -> f64 {
    let [m, r, j] = BALL;
    rolling / r * G / (1.0 + j / (m * r * r))
}

/// A ball that rolls in any direction stops after v / a, a = (rolling / r) g / (1 + J / (m r^2)), and does not creep.
#[test]
fn a_rolling_ball_stops() {
    let [m, r, j] = BALL;
    let body = ball(|_| {});
    for (rolling, angle, v) in
        [(0.002, 0.0_f64, 1.0), (0.01, 0.7, 2.0), (0.0005, 2.3, 0.3), (0.03, -1.9, 5.0)]
    {
        let (ux, uy) = (v * angle.cos(), v * angle.sin());
        let mut simulation = begin(&body, &[ux, uy, 0.0, -uy / r, ux / r, 0.0], options(0.4, rolling, 0.0));
        assert_eq!(simulation.phase(0), Some(ContactPhase::Stick));
        assert_eq!(simulation.rolling_phase(0), Some(ContactPhase::Slide));
        assert_eq!(simulation.spinning_phase(0), None);
        let torque = simulation.contact_torques().unwrap()[0].1;
        near("torque", torque.norm(), rolling * m * G, 1e-12);
        let a = slows(rolling);
        let events = run(&mut simulation, v / a + 10.0);
        assert_eq!(kinds(&events), ["roll_ends", "rest"], "{rolling}");
        near("time", time(&events, "roll_ends"), v / a, 1e-9);
        let way = v * v / (2.0 * a);
        let q = simulation.coordinates().to_vec();
        near("x", q[0], way * angle.cos(), 1e-9);
        near("y", q[1], way * angle.sin(), 1e-9);
        near("work", simulation.energy().unwrap().friction, -0.5 * (m + j / (r * r)) * v * v, 1e-9);
        assert!(run(&mut simulation, 1e5).is_empty());
        assert_eq!(simulation.coordinates(), q);
    }
}

/// Impacts have no torques, and bounces lower than any tolerance are impacts: a ball that bounces to its end keeps its
/// spin, and what rolls it is friction alone.
#[test]
fn torques_begin_when_bounces_have_ended() {
    let [m, r, j] = BALL;
    let (mu, e, v, along, spin) = (0.1, 0.4, 1.0, 3.0, 3.0);
    let body = ball(|_| {});
    let mut simulation = begin(&body, &[along, 0.0, v, 0.0, 0.0, spin], options(mu, 0.01, 0.01));
    let events = run(&mut simulation, 0.44);
    let contact = first(&events, "contact");
    let chatter = 2.0 * e * v / (G * (1.0 - e));
    near("time", contact.time, 2.0 * v / G + chatter, 1e-10);
    let friction = mu * (v + G * chatter);
    near("along", contact.speeds[0], along - friction, 1e-11);
    near("about the axis across", contact.speeds[4], friction * r * m / j, 1e-9);
    near("spin", contact.speeds[5], spin, 1e-11);
    let left = simulation.time() - contact.time;
    near("spin at the end", simulation.speeds()[5], spin - 0.01 * m * G / j * left, 1e-9);
}

/// A ball lies on an incline while tan(angle) <= rolling / r, and rolls down beyond.
#[test]
fn a_ball_rolls_down_where_the_incline_exceeds_its_rolling_friction() {
    let [m, r, j] = BALL;
    for (rolling, direction) in [(0.002, 0.0_f64), (0.01, 1.1), (0.02, -2.0)] {
        for factor in [0.5, 1.0 - 1e-9, 1.0 + 1e-9, 1.0 + 1e-6, 1.5] {
            let slope = factor * rolling / r;
            let body = ball(|parameters| {
                parameters.gt = G * slope * direction.cos();
                parameters.gs = G * slope * direction.sin();
            });
            let mut simulation = begin(&body, &[0.0; 6], options(0.5, rolling, 0.001));
            let before = simulation.coordinates().to_vec();
            let events = run(&mut simulation, 2.0);
            assert!(simulation.phase(0) == Some(ContactPhase::Stick), "{:?}", kinds(&events));
            if factor < 1.0 {
                assert_eq!(simulation.rolling_phase(0), Some(ContactPhase::Stick), "{factor}");
                assert_eq!(simulation.coordinates(), before);
                continue;
            }
            assert_eq!(simulation.rolling_phase(0), Some(ContactPhase::Slide), "{factor}");
            let a = (slope - rolling / r) * G / (1.0 + j / (m * r * r));
            near("x", simulation.coordinates()[0], 2.0 * a * direction.cos(), 1e-9);
            near("y", simulation.coordinates()[1], 2.0 * a * direction.sin(), 1e-9);
        }
    }
}

/// A ball that spins on its pole stops after J w / (spinning m g).
#[test]
fn a_spinning_ball_stops() {
    let [m, _, j] = BALL;
    let body = ball(|_| {});
    for (spinning, w) in [(0.001, 20.0), (0.01, -300.0), (0.0002, 3.0)] {
        let mut simulation = begin(&body, &[0.0, 0.0, 0.0, 0.0, 0.0, w], options(0.4, 0.002, spinning));
        assert_eq!(simulation.spinning_phase(0), Some(ContactPhase::Slide));
        assert_eq!(simulation.rolling_phase(0), Some(ContactPhase::Stick));
        let end = j * f64::abs(w) / (spinning * m * G);
        let events = run(&mut simulation, end + 1.0);
        assert_eq!(kinds(&events), ["spin_ends", "rest"]);
        near("time", time(&events, "spin_ends"), end, 1e-9 * end.max(1.0));
        near("work", simulation.energy().unwrap().friction, -0.5 * j * w * w, 1e-12 * j * w * w);
    }
}

/// A ball that slides, begins to roll against rolling friction, stops to slide, and stops to roll, while it spins; and
/// one that rolling friction keeps from rolling while it slides.
#[test]
fn a_ball_slides_rolls_and_spins() {
    let [m, r, j] = BALL;
    let body = ball(|_| {});
    let (v, w) = (2.0, 40.0);
    for (mu, rolling, spinning) in [(0.3, 0.004, 0.003), (0.2, 0.015, 0.001)] {
        let mut simulation = begin(&body, &[v, 0.0, 0.0, 0.0, 0.0, w], options(mu, rolling, spinning));
        let events = run(&mut simulation, 60.0);
        let turns = (mu * r - rolling) * m * G / j;
        let slides = v / (mu * G + r * turns);
        let rest = v - mu * G * slides;
        near("slip", time(&events, "stick"), slides, 1e-9);
        near("roll", time(&events, "roll_ends"), slides + rest / slows(rolling), 1e-9);
        near("spin", time(&events, "spin_ends"), j * w / (spinning * m * G), 1e-9);
        let way = v * slides - 0.5 * mu * G * slides * slides + rest * rest / (2.0 * slows(rolling));
        near("x", simulation.coordinates()[0], way, 1e-9);
        assert!(kinds(&events).contains(&"rest"));
        let energy = simulation.energy().unwrap();
        near("work", energy.friction, -0.5 * m * v * v - 0.5 * j * w * w, 1e-9);
    }
    // More rolling friction than friction can turn.
    let (mu, rolling) = (0.1, 0.02);
    let mut simulation = begin(&body, &[v, 0.0, 0.0, 0.0, 0.0, 0.0], options(mu, rolling, 0.0));
    let events = run(&mut simulation, 10.0);
    assert_eq!(kinds(&events), ["stick", "rest"]);
    near("slip", time(&events, "stick"), v / (mu * G), 1e-9);
    assert_eq!(simulation.speeds(), [0.0; 6]);
}

/// Spinning and rolling begin where a torque that grows exceeds the bound.
#[test]
fn torques_that_grow_begin_to_turn_a_ball() {
    let [m, r, j] = BALL;
    let body = ball(|_| {});
    let grows = 0.01;
    for (input, arm, name) in [(0, 0.004, "spin"), (1, 0.004, "roll")] {
        let drive = move |t: f64, _: &[f64], _: &[f64], inputs: &mut [f64]| inputs[input] = grows * t;
        let options = Options { drive: Drive::Continuous(Arc::new(drive)), ..options(0.6, 0.004, 0.004) };
        let mut simulation = begin(&body, &[0.0; 6], options);
        let begins = arm * m * G / grows;
        let events = run(&mut simulation, begins + 2.0);
        assert_eq!(kinds(&events), [name]);
        near("time", time(&events, name), begins, 1e-9);
        // grows t^2 / 2 over what resists the turning
        let inertia = if input == 0 { j } else { j + m * r * r };
        let rate = if input == 0 { simulation.speeds()[5] } else { simulation.speeds()[3] };
        near("rate", rate, 0.5 * grows * 4.0 / inertia, 1e-9);
        if let EventKind::Roll { along, .. } = first(&events, name).kind {
            assert_eq!(along, [1.0, 0.0, 0.0]);
        }
    }
    // The torque about N.x moves the lowest point along N.y, where friction does not hold it.
    let drive = move |t: f64, _: &[f64], _: &[f64], inputs: &mut [f64]| inputs[1] = t;
    let options = Options { drive: Drive::Continuous(Arc::new(drive)), ..options(0.001, 0.0, 0.0) };
    let mut simulation = begin(&body, &[0.0; 6], options);
    let events = run(&mut simulation, 0.1);
    assert_eq!(kinds(&events), ["slip"]);
    let EventKind::Slip { along, direction, .. } = first(&events, "slip").kind else { unreachable!() };
    let apart = along.iter().zip([0.0, 1.0, 0.0]).map(|(along, exact)| f64::abs(along - exact)).sum::<f64>();
    assert!(
        apart < 1e-12 && (direction[0].hypot(direction[1]) - 1.0).abs() < 1e-12,
        "{along:?} {direction:?}"
    );
}

/// A cart on two wheels slows down with (rolling / r) g m / (m + 2 J / r^2), however its wheels share the load, and
/// stands on an incline with tan(angle) <= rolling / r.
#[test]
fn a_cart_on_two_wheels() {
    let cart = RollingCart::<f64>::default();
    let (total, wheel, r, rolling, v) = (4.0, 0.004, 0.12, 0.003, 1.5);
    let law = ContactLaw { rolling: Some(rolling), ..ContactLaw::default() };
    let options = || Options {
        surface: Some(Surface { mu: 0.5, e: 0.0, law: Law::Newton }),
        law: Some(law.clone()),
        ..Options::default()
    };
    let mut simulation = begin(&cart, &[v, 0.0, 0.0, v / r, v / r], options());
    let (forces, _) = simulation.contact_forces().unwrap();
    near("load", forces.iter().map(|(_, force)| force.x).sum(), total * G, 1e-9);
    for ((contact, force), (other, torque)) in forces.iter().zip(simulation.contact_torques().unwrap()) {
        assert_eq!(*contact, other);
        near("bound", torque.norm(), rolling * force.x, 1e-12);
    }
    let a = rolling / r * G * total / (total + 2.0 * wheel / (r * r));
    let events = run(&mut simulation, 60.0);
    near("time", time(&events, "rest"), v / a, 1e-9);
    near("x", simulation.coordinates()[0], v * v / (2.0 * a), 1e-9);
    for factor in [0.9, 1.0 - 1e-9, 1.0 + 1e-9, 1.1] {
        let along = factor * rolling / r * G;
        let parameters = rolling_cart::Parameters { along, ..rolling_cart::Parameters::default() };
        let cart = RollingCart::new(parameters).unwrap();
        let mut simulation = begin(&cart, &[0.0; 5], options());
        let before = simulation.coordinates().to_vec();
        let events = run(&mut simulation, 1.0);
        let rolls = [0, 1].map(|contact| simulation.rolling_phase(contact) == Some(ContactPhase::Slide));
        assert_eq!(rolls, [factor > 1.0; 2], "{factor} {:?}", kinds(&events));
        if factor < 1.0 {
            assert_eq!(simulation.coordinates(), before);
        } else {
            let a = (factor - 1.0) * rolling / r * G * total / (total + 2.0 * wheel / (r * r));
            near("x", simulation.coordinates()[0], 0.5 * a, 1e-9);
        }
    }
}

/// Four feet that friction and spinning friction hold: a torque that grows turns the stool from (mu d + spinning) m g
/// on, all feet at once, and a table that turns takes it along in J W / ((mu d + spinning) m g).
#[test]
fn a_stool_turns_on_four_feet() {
    let (m, j, d) = (2.0, 0.08, 0.1 * f64::sqrt(2.0));
    let (mu, spinning) = (0.3, 0.02);
    let holds = (mu * d + spinning) * m * G;
    let stool = TurnedStool::<f64>::default();
    let grows = 0.5;
    let drive = move |t: f64, _: &[f64], _: &[f64], inputs: &mut [f64]| inputs[0] = grows * t;
    let with = Options { drive: Drive::Continuous(Arc::new(drive)), ..options(mu, 0.0, spinning) };
    let mut simulation = begin(&stool, &[0.0; 6], with);
    let begins = holds / grows;
    let events = run(&mut simulation, begins + 1.0);
    for name in ["slip", "spin"] {
        let times: Vec<f64> =
            events.iter().filter(|event| event.kind.name() == name).map(|event| event.time).collect();
        assert_eq!(times.len(), 4, "{:?}", kinds(&events));
        times.iter().for_each(|&time| near(name, time, begins, 1e-9));
    }
    near("rate", simulation.speeds()[5], 0.5 * grows / j, 1e-9);
    // It stops when nothing turns it.
    let mut simulation = begin(&stool, &[0.0, 0.0, 0.0, 0.0, 0.0, 3.0], options(mu, 0.0, spinning));
    let events = run(&mut simulation, 2.0);
    near("stops", time(&events, "rest"), j * 3.0 / holds, 1e-9);
    // Table that turns.
    let parameters = turned_stool::Parameters { W: 2.5, ..turned_stool::Parameters::default() };
    let stool = TurnedStool::new(parameters).unwrap();
    let mut simulation = begin(&stool, &[0.0; 6], options(mu, 0.0, spinning));
    let events = run(&mut simulation, 2.0);
    near("goes along", time(&events, "spin_ends"), j * 2.5 / holds, 1e-9);
    near("rate", simulation.speeds()[5], 2.5, 1e-9);
}

/// In random motions no torque exceeds its bound, torques oppose rotation, the account of energy is right, and all
/// comes to rest.
#[test]
fn random_motions_obey_the_laws() {
    let [m, r, j] = BALL;
    let mut random = Random::new(17);
    let mut seen = [0; 3];
    for run_number in 0..12 {
        let (mu, rolling, spinning) =
            (random.between(0.1, 0.5), random.between(0.001, 0.02), random.between(0.001, 0.01));
        let body = ball(|_| {});
        let mut speeds = [0.0; 6];
        for (i, speed) in speeds.iter_mut().enumerate() {
            let most = if i < 3 { 1.5 } else { 30.0 };
            *speed = random.between(-most, most);
        }
        speeds[2] = if run_number % 2 == 0 { 0.0 } else { speeds[2].abs() };
        let mut simulation = begin(&body, &speeds, options(mu, rolling, spinning));
        let before = simulation.energy().unwrap().total().unwrap();
        let mut rests = false;
        for step in 1..=400 {
            let events = run(&mut simulation, 0.1 * f64::from(step));
            rests |= kinds(&events).contains(&"rest");
            let (forces, _) = simulation.contact_forces().unwrap();
            let torques = simulation.contact_torques().unwrap();
            for ((_, force), (_, torque)) in forces.iter().zip(&torques) {
                let slack = 1e-10 * m * G * r;
                assert!(force.x >= -1e-10 && torque.x.abs() <= spinning * force.x + slack);
                assert!(torque.y.hypot(torque.z) <= rolling * force.x + slack);
                // The axes of the contact: n is N.z; the others are seen from the power.
                let spin = simulation.speeds()[5];
                if simulation.spinning_phase(0) == Some(ContactPhase::Slide) && spin.abs() > 1e-6 {
                    near("spins", torque.x, -spinning * force.x * spin.signum(), slack);
                    seen[0] += 1;
                }
                if simulation.rolling_phase(0) == Some(ContactPhase::Slide) {
                    near("rolls", torque.y.hypot(torque.z), rolling * force.x, slack);
                    seen[1] += 1;
                }
            }
            let energy = simulation.energy().unwrap();
            let left = energy.total().unwrap() - before - energy.friction - energy.impacts;
            assert!(left.abs() < 1e-9 * before.abs().max(1.0), "{run_number}: {left:e}");
            assert!(energy.friction <= 1e-15);
            if rests {
                seen[2] += 1;
                break;
            }
        }
        assert!(rests, "{run_number}: {:?}", simulation.speeds());
        assert!(j > 0.0 && simulation.speeds() == [0.0; 6]);
    }
    assert!(seen[0] > 20 && seen[1] > 20 && seen[2] == 12, "{seen:?}");
}

/// The events of a motion do not depend on how the plane stands in space, nor on the units.
#[test]
fn events_do_not_depend_on_axes_and_units() {
    let v: [f64; 6] = [1.0, 0.5, 0.0, 3.0, -8.0, 25.0];
    let law = |length: f64| options(0.25, 0.004 * length, 0.002 * length);
    let times =
        |body: &RollingBall<f64>, place: &[f64], speeds: &[f64], law: Options| -> Vec<(String, f64)> {
            let mut q = vec![0.0; 7];
            q[..3].copy_from_slice(place);
            q[3] = 1.0;
            let state = State { time: 0.0, coordinates: &q, speeds, inputs: &[0.0; 2] };
            let mut simulation = Simulation::new(body, &state, law).unwrap();
            let events = simulation.advance_to(1e6).unwrap();
            events.iter().map(|event| (event.kind.name().to_owned(), event.time)).collect()
        };
    let plain = times(&ball(|_| {}), &[0.0, 0.0, 0.11], &v, law(1.0));
    let expected = ["stick", "roll_ends", "spin_ends", "rest"];
    assert!(expected.iter().all(|name| plain.iter().any(|(known, _)| known == name)), "{plain:?}");
    let same = |what: &str, other: &[(String, f64)], unit: f64| {
        assert_eq!(plain.len(), other.len(), "{what}: {plain:?} {other:?}");
        for ((name, time), (other, there)) in plain.iter().zip(other) {
            assert_eq!(name, other, "{what}");
            near(what, there / unit, *time, 1e-9);
        }
    };
    for (a, b) in [(0.4_f64, -0.9_f64), (2.5, 1.2), (-1.0, 3.0)] {
        // Plane.x, Plane.y, Plane.z along N.
        let (sa, ca, sb, cb) = (a.sin(), a.cos(), b.sin(), b.cos());
        let axes = [[cb, sa * sb, -ca * sb], [0.0, ca, sa], [sb, -sa * cb, ca * cb]];
        let turned =
            |v: &[f64]| -> Vec<f64> { (0..3).map(|k| (0..3).map(|i| v[i] * axes[i][k]).sum()).collect() };
        let body = ball(|parameters| (parameters.a, parameters.b) = (a, b));
        let speeds = [turned(&v[..3]), turned(&v[3..])].concat();
        same("axes", &times(&body, &turned(&[0.0, 0.0, 0.11]), &speeds, law(1.0)), 1.0);
    }
    // Millimetres, grams, milliseconds.
    let body = ball(|parameters| {
        (parameters.m, parameters.r, parameters.J) = (400.0, 110.0, 0.002e9);
        parameters.gn = 9.81e-3;
    });
    let speeds: Vec<f64> = v.iter().enumerate().map(|(i, v)| if i < 3 { *v } else { 1e-3 * v }).collect();
    same("units", &times(&body, &[0.0, 0.0, 110.0], &speeds, law(1e3)), 1e3);
}

/// What is wrong is refused, with its cure.
#[test]
fn impossible_arms_and_mechanisms_without_rotation_are_refused() {
    let body = ball(|_| {});
    let refused = |body: &dyn Contacts<f64>, q: &[f64], u: &[f64], inputs: &[f64], options: Options| {
        let state = State { time: 0.0, coordinates: q, speeds: u, inputs };
        let error = Simulation::new(body, &state, options).map(|_| ()).unwrap_err();
        let ErrorKind::BadOption(message) = error.kind else { panic!("{error}") };
        message
    };
    let q = [0.0, 0.0, 0.11, 1.0, 0.0, 0.0, 0.0];
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        for (rolling, spinning) in [(bad, 0.0), (0.0, bad)] {
            let message = refused(&body, &q, &[0.0; 6], &[0.0; 2], options(0.3, rolling, spinning));
            assert!(message.contains("lever arm"), "{message}");
        }
    }
    let plain =
        crate::common::Body::new(1.0, 1.0, &[crate::common::Line::floor(crate::common::Part::Rim(0.1))]);
    let message = refused(&plain, &[0.0, 0.1, 0.0], &[0.0; 3], &[0.0], options(0.3, 0.01, 0.0));
    assert!(message.contains("derive it anew"), "{message}");
    // Arms of zero are none.
    let state = State { time: 0.0, coordinates: &[0.0, 0.1, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    assert!(Simulation::new(&plain, &state, options(0.3, 0.0, 0.0)).is_ok());
}

/// Contacts with friction of rolling and spinning as contacts that share normal forces (docs/theory.md, section 17.17):
/// the forces that are found obey the laws as they are stated for torques.
#[test]
fn forces_of_random_problems_obey_the_laws_of_torques() {
    let mut random = Random::new(5);
    let mut seen = [0; 4];
    for number in 0..400 {
        let k = 1 + number % 3;
        // Six components for each contact: force n, t, s and torque n, t, s.
        let n = 6 * k;
        let spread = DMatrix::from_fn(n, n, |_, _| random.between(-1.0, 1.0));
        let w = &spread * spread.transpose() * 0.1 + DMatrix::identity(n, n);
        let beta =
            DVector::from_fn(n, |row, _| random.between(-1.0, 1.0) - if row % 6 == 0 { 3.0 } else { 0.0 });
        let limits: Vec<[f64; 3]> = (0..k).map(|_| [0; 3].map(|_| random.between(0.02, 0.4))).collect();
        // Contact, rolling, spinning: three contacts each; the numbers are the places of their components.
        let places = |j: usize| -> [Option<usize>; 3] {
            let i = 6 * (j / 3);
            match j % 3 {
                0 => [Some(i), Some(i + 1), Some(i + 2)],
                1 => [None, Some(i + 4), Some(i + 5)],
                _ => [None, Some(i + 3), None],
            }
        };
        let mut all = DMatrix::zeros(9 * k, 9 * k);
        let mut pulls = DVector::zeros(9 * k);
        let place = |row: usize| places(row / 3)[row % 3];
        for row in 0..9 * k {
            match place(row) {
                Some(from) => {
                    pulls[row] = beta[from];
                    for column in 0..9 * k {
                        if let Some(to) = place(column) {
                            all[(row, column)] = w[(from, to)];
                        }
                    }
                }
                None => {
                    all[(row, row)] = 1.0;
                    if row % 3 == 0 {
                        all[(row, 9 * (row / 9))] = -1.0;
                    }
                }
            }
        }
        let mu: Vec<f64> = (0..3 * k).map(|j| limits[j / 3][j % 3]).collect();
        let slip = vec![None; 3 * k];
        let problem = Problem { w: &all, beta: &pulls, mu: &mu, slip: &slip, noise: None };
        let solution = solve(&problem, None).unwrap_or_else(|error| panic!("{number}: {error}"));
        let mut force = DVector::zeros(n);
        for row in 0..9 * k {
            if let Some(to) = place(row) {
                force[to] = solution.force[row];
            }
        }
        let a = &w * &force + &beta;
        for (i, [friction, rolling, spinning]) in limits.iter().enumerate() {
            let (f, a) = (force.rows(6 * i, 6), a.rows(6 * i, 6));
            assert!(f[0] >= 0.0 && a[0] > -1e-9 && (f[0] * a[0]).abs() < 1e-9, "{number}");
            for (rows, limit, kind) in
                [(&[1_usize, 2][..], friction, 0), (&[4, 5], rolling, 1), (&[3], spinning, 2)]
            {
                let size = |v: &DVector<f64>| v.norm();
                let part = DVector::from_iterator(rows.len(), rows.iter().map(|&row| f[row]));
                let rate = DVector::from_iterator(rows.len(), rows.iter().map(|&row| a[row]));
                assert!(size(&part) <= limit * f[0] + 1e-9, "{number}");
                if f[0] > 0.0 && size(&rate) > 1e-9 {
                    let opposes = &part + &rate * (limit * f[0] / size(&rate));
                    assert!(size(&opposes) < 1e-9, "{number}: {part} {rate}");
                    seen[kind] += 1;
                } else if f[0] > 0.0 {
                    seen[3] += 1;
                }
            }
        }
    }
    assert!(seen.iter().all(|&seen| seen > 20), "{seen:?}");
}

/// W and beta of the stool under a torque about its normal, with its spinning friction.
fn stool_problem(torque: f64, gravity: f64) -> (DMatrix<f64>, DVector<f64>) {
    let (m, jx, jz, c, h, l) = (2.0, 0.05, 0.08, 0.1, 0.2, 0.25);
    let feet = [[c, c], [-c, c], [-c, -c], [c, -c]];
    let mut rows = DMatrix::zeros(24, 6);
    for (i, [x, y]) in feet.into_iter().enumerate() {
        let arm = [x, y, -h];
        for (row, axis) in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].into_iter().enumerate() {
            for k in 0..3 {
                rows[(3 * i + row, k)] = axis[k];
                let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                rows[(3 * i + row, 3 + k)] = arm[a] * axis[b] - arm[b] * axis[a];
            }
        }
        rows[(12 + 3 * i + 1, 5)] = l;
    }
    let inverse = DMatrix::from_diagonal(&DVector::from_vec(vec![
        1.0 / m,
        1.0 / m,
        1.0 / m,
        1.0 / jx,
        1.0 / jx,
        1.0 / jz,
    ]));
    let mut w = &rows * &inverse * rows.transpose();
    for i in 0..4 {
        let size = w[(3 * i, 3 * i)];
        w[(12 + 3 * i, 12 + 3 * i)] = size;
        w[(12 + 3 * i, 3 * i)] = -size;
        w[(12 + 3 * i + 2, 12 + 3 * i + 2)] = size;
    }
    let loads = DVector::from_vec(vec![0.0, 0.0, -m * gravity, 0.0, 0.0, torque]);
    let beta = &rows * inverse * loads;
    (w, beta)
}

/// Next to the greatest torque that friction and spinning friction hold together the reserve that is left is exact, and
/// tells whether the stool turns to a thousandth of a billionth.
#[test]
fn friction_and_torques_share_a_load_up_to_their_bound() {
    let (mu, spinning, l) = (0.3, 0.02, 0.25);
    let most = (mu * 0.1 * f64::sqrt(2.0) + spinning) * 2.0 * G;
    let mus: Vec<f64> = (0..8).map(|i| if i < 4 { mu } else { spinning / l }).collect();
    let at = |off: f64| {
        let (w, beta) = stool_problem(most * (1.0 + off), G);
        let problem = Problem { w: &w, beta: &beta, mu: &mus, slip: &[None; 8], noise: None };
        let margin = with_modes(&problem, &[Mode::Stick; 8]).unwrap().margin;
        let modes = solve(&problem, None).unwrap().modes;
        (margin / off, modes.iter().all(|mode| *mode == Mode::Stick))
    };
    for (sign, reference) in [(-1.0, at(-1e-3).0), (1.0, at(1e-3).0)] {
        for (off, close) in [(1e-6, 1e-3), (1e-9, 1e-3), (1e-11, 0.1)] {
            let (ratio, sticks) = at(sign * off);
            near("reserve", ratio / reference, 1.0, close);
            assert_eq!(sticks, sign < 0.0, "{sign} {off:e}");
        }
        assert_eq!(at(sign * 1e-12).1, sign < 0.0);
    }
}
