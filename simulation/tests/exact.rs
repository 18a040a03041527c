//! More answers in closed form: the end of slip in three dimensions, momentum over a chatter, a belt, gaps
//! that are curved or move.

use crate::common::{Body, Line, Part, collisions, first, names, run, start, surface};
use ball_on_block::BallOnBlock;
use ball_on_lift::BallOnLift;
use bead_on_sphere::BeadOnSphere;
use hodograph::{Law, Mechanism};
use hodograph_simulation::{ContactLaw, ContactPhase, Options, Sliding};
use puck_on_incline::PuckOnIncline;

hodograph::mechanism!("tests/models/ball_on_block.mech");
hodograph::mechanism!("tests/models/ball_on_lift.mech");
hodograph::mechanism!("tests/models/bead_on_sphere.mech");
hodograph::mechanism!("tests/models/puck_on_incline.mech");

const G: f64 = 9.81;

/// A puck thrown across an incline that holds it: its path bends until it points downhill, where slip ends
/// (codimension two). With phi from downhill and r = mu / tan alpha the speed is v = C tan(phi / 2)^r /
/// sin(phi), and slip ends at v0 / (2 g sin alpha) ((1 + cos phi0) / (r - 1) + (1 - cos phi0) / (r + 1)).
#[test]
fn slip_ends_in_three_dimensions() {
    let body = PuckOnIncline::<f64>::default();
    let alpha: f64 = 0.4;
    let mut worst = 0.0_f64;
    for r in [1.2, 1.7, 2.5] {
        for phi in [0.3_f64, 1.2, 2.0, 2.9] {
            let (v0, mu) = (1.3, r * alpha.tan());
            // Downhill is -x.
            let u = [-v0 * phi.cos(), v0 * phi.sin(), 0.0];
            let mut simulation = start(&body, &[0.0; 3], &u, surface(mu, 0.5, Law::Stronge));
            let end = v0 / (2.0 * G * alpha.sin())
                * ((1.0 + phi.cos()) / (r - 1.0) + (1.0 - phi.cos()) / (r + 1.0));
            let events = run(&mut simulation, end + 1.0);
            let stick = first(&events, "stick");
            worst = worst.max((stick.time - end).abs() / end);
            assert!((stick.time - end).abs() < 1e-9 * end, "{r} {phi}: {} {end}", stick.time);
            assert_eq!(simulation.phase(0), Some(ContactPhase::Stick));
            assert_eq!(simulation.speeds(), [0.0; 3]);
            let energy = simulation.energy().unwrap();
            let before = v0 * v0;
            let account = energy.total().unwrap() - energy.friction - before;
            assert!(account.abs() < 1e-10 * before, "{r} {phi}: {account:e}");
        }
    }
    println!("the end of slip in three dimensions: {worst:.1e} of its time");
}

/// Where friction is that of the slope (r = 1), the puck ends straight downhill with v0 (1 + cos phi0) / 2: v + v_down
/// is constant.
#[test]
fn slip_does_not_end_where_friction_equals_the_slope() {
    let body = PuckOnIncline::<f64>::default();
    let (alpha, phi, v0): (f64, f64, f64) = (0.4, 1.2, 1.3);
    let u = [-v0 * phi.cos(), v0 * phi.sin(), 0.0];
    let mut simulation = start(&body, &[0.0; 3], &u, surface(alpha.tan(), 0.5, Law::Stronge));
    for k in 1..=20 {
        run(&mut simulation, f64::from(k));
        let u = simulation.speeds();
        let sum = u[0].hypot(u[1]) - u[0];
        assert!((sum - v0 * (1.0 + phi.cos())).abs() < 1e-9, "{k}: {sum}");
    }
}

/// A puck that is fast along the floor strikes it on time, and bounces as it would without that.
#[test]
fn speeds_along_the_floor_do_not_hide_it() {
    let mut body = PuckOnIncline::<f64>::default();
    body.set_parameter_values(&[2.0, G, 0.0]).unwrap();
    let fall = (2.0 / G).sqrt();
    for speed in [1e3, 1e7, 1e10, 1e15, 1e16, 1e20] {
        for mu in [0.0, 0.3] {
            let options = surface(mu, 0.5, Law::Newton);
            let mut simulation = start(&body, &[0.0, 0.0, 1.0], &[speed, 0.0, 0.0], options);
            let events = run(&mut simulation, 1.2);
            let times = collisions(&events);
            assert_eq!(times.len(), 3, "{speed:e} {mu}: {:?}", names(&events));
            for (time, expected) in times.iter().zip([fall, 2.0 * fall, 2.5 * fall]) {
                assert!((time - expected).abs() < 1e-10, "{speed:e} {mu}: {times:?}");
            }
        }
        // One that begins on the floor strikes it at once.
        let options = surface(0.0, 0.5, Law::Newton);
        let mut simulation = start(&body, &[0.0; 3], &[speed, 0.0, -4.4], options);
        let events = run(&mut simulation, 0.1);
        assert_eq!(collisions(&events), [0.0], "{speed:e}");
        assert!((events[0].speeds[2] - 2.2).abs() < 1e-14);
    }
}

/// Where rounding of places or speeds hides what a contact does, the motion ends with that error.
#[test]
fn what_rounding_hides_is_an_error() {
    // The floor stands 1e16 m above the origin, where numbers are 2 m apart.
    let floor = Line { offset: 1e16, ..Line::floor(Part::Point(0.0, 0.0)) };
    let body = Body::new(1.0, 1.0, &[floor]);
    let mut simulation = start(&body, &[0.0, 1e16 + 4.0, 0.0], &[0.0; 3], surface(0.2, 0.5, Law::Newton));
    let error = simulation.advance(20.0).unwrap_err();
    assert_eq!((error.kind.name(), error.contact.as_deref()), ("rounding", Some("c0")), "{error}");
    assert!(error.to_string().contains("from a place nearer to the contact"), "{error}");
    // Along a slope the normal velocity is a difference of large numbers.
    let slope = Line { tilt: 0.7, ..Line::floor(Part::Point(0.0, 0.0)) };
    let body = Body::new(1.0, 1.0, &[slope]);
    let u = [1e16 * 0.7_f64.cos(), -1e16 * 0.7_f64.sin(), 0.0];
    let mut simulation = start(&body, &[0.0, 1.0, 0.0], &u, surface(0.2, 0.5, Law::Newton));
    let error = simulation.advance(2.0).unwrap_err();
    assert_eq!((error.kind.name(), error.contact.as_deref()), ("rounding", Some("c0")), "{error}");
}

/// All the bounces of a body that slides: the impulse of friction is that of impacts times the normal one, which is
/// known from the first approach and the weight, whatever the friction of lasting contact is.
#[test]
fn momentum_over_a_chatter() {
    let (m, r) = (0.4, 0.11);
    let laws = [
        (0.15, 0.15, None),
        (0.3, 0.15, Some(ContactLaw { mu_impact: Some(0.15), ..ContactLaw::default() })),
        (0.0, 0.15, Some(ContactLaw { mu_impact: Some(0.15), ..ContactLaw::default() })),
        (
            0.15,
            0.15,
            Some(ContactLaw {
                mu_static: Some(0.6),
                sliding: Sliding::Stribeck { speed: 30.0 },
                ..ContactLaw::default()
            }),
        ),
    ];
    for (mu, in_impacts, law) in laws {
        for e in [0.3, 0.6, 0.9] {
            let body = Body::new(m, 0.4 * m * r * r, &[Line::floor(Part::Rim(r))]);
            let (vx, w, h) = (20.0, 5.0, 0.05);
            let options = Options { law: law.clone(), ..surface(mu, e, Law::Stronge) };
            let mut simulation = start(&body, &[0.0, r + h, 0.0], &[vx, 0.0, w], options);
            let events = run(&mut simulation, 2.2);
            let v0 = (2.0 * G * h).sqrt();
            let chatter = 2.0 * e * v0 / (G * (1.0 - e));
            let contact = first(&events, "contact");
            assert!((contact.time - (v0 / G + chatter)).abs() < 1e-10, "{e}: {}", contact.time);
            // From the first touch to the end: momentum up, m v0 and the weight.
            let friction = in_impacts * (v0 + G * chatter);
            let expected = [vx - friction, 0.0, w - friction * r * m / (0.4 * m * r * r)];
            for (speed, expected) in contact.speeds.iter().zip(expected) {
                assert!(
                    (speed - expected).abs() < 1e-10 * (1.0 + expected.abs()),
                    "{mu} {e}: {:?} {expected:?}",
                    contact.speeds
                );
            }
        }
    }
}

/// A step of free flight leads through the top of a box to its middle, where no distance is known: it is shortened, and
/// every bounce is found.
#[test]
fn a_ball_bounces_on_a_box_that_long_steps_enter() {
    let body = BallOnBlock::<f64>::default();
    for height in [0.5, 0.8, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0] {
        for e in [0.3, 0.5, 0.8, 1.0] {
            let options = surface(0.3, e, Law::Newton);
            let mut simulation = start(&body, &[0.1, -0.2, height], &[0.05, 0.0, 0.0], options);
            let until = 3.0;
            let events = run(&mut simulation, until);
            let (mut time, mut speed) =
                (f64::sqrt(2.0 * (height - 0.3) / G), f64::sqrt(2.0 * (height - 0.3) * G));
            let mut struck = 0;
            for found in collisions(&events) {
                assert!((found - time).abs() < 1e-9, "{height} {e}: {found} {time}");
                speed *= e;
                time += 2.0 * speed / G;
                struck += 1;
            }
            // What is left is more than no bounce at all, or lower than the tolerance.
            assert!(
                struck > 0 && (time > until || speed < 1e-4),
                "{height} {e}: {struck} {:?}",
                names(&events)
            );
        }
    }
}

/// A block on a belt and a spring, from rest: it is dragged, sticks when it is as fast as the belt, and slips
/// when the spring pulls with mu m g; from then on it swings about that place, and touches the speed of the
/// belt once in each closed cycle.
#[test]
fn a_block_on_a_belt_sticks_and_slips_at_the_times_known() {
    let (m, k, v, mu) = (2.0, 50.0, 0.3, 0.4);
    let mut body = Body::new(m, 1.0, &[]);
    body.spring = k;
    body.lines = vec![Line { part: Part::Point(0.0, 0.0), tilt: 0.0, offset: 0.0, belt: v }];
    let (omega, about): (f64, f64) = ((k / m).sqrt(), mu * m * G / k);
    let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], surface(mu, 0.5, Law::Newton));
    let sticks = (v / (about * omega)).asin() / omega;
    let slips = sticks + (about - about * (1.0 - (omega * sticks).cos())) / v;
    let events = run(&mut simulation, slips + 1.0);
    assert!((first(&events, "stick").time - sticks).abs() < 1e-10, "{:?} {sticks}", names(&events));
    assert!((first(&events, "slip").time - slips).abs() < 1e-10, "{:?} {slips}", names(&events));
    // Closed: a whole number of periods later it is where it was, with the belt's speed.
    let period = std::f64::consts::TAU / omega;
    for cycles in [1.0, 2.0, 10.0] {
        run(&mut simulation, slips + cycles * period);
        let (x, u) = (simulation.coordinates()[0], simulation.speeds()[0]);
        assert!((x - about).abs() < 1e-9 && (u - v).abs() < 1e-9, "{cycles}: {x} {about}, {u}");
    }
}

/// A bead that slides on a smooth sphere leaves it where its height above the centre is two thirds of the
/// radius, plus v0^2 / (3 g).
#[test]
fn a_bead_leaves_a_sphere() {
    let body = BeadOnSphere::<f64>::default();
    let radius = 0.7;
    let mut worst = 0.0_f64;
    for v0 in [0.05, 0.4, 1.5] {
        for heading in [0.0_f64, 0.7] {
            let u = [v0 * heading.cos(), v0 * heading.sin(), 0.0];
            let mut simulation = start(&body, &[0.0, 0.0, radius], &u, surface(0.0, 0.5, Law::Newton));
            let events = run(&mut simulation, 1.4);
            let off = first(&events, "lift_off");
            let expected = 2.0 / 3.0 * radius + v0 * v0 / (3.0 * G);
            worst = worst.max((off.coordinates[2] - expected).abs());
            assert!((off.coordinates[2] - expected).abs() < 1e-9, "{v0}: {} {expected}", off.coordinates[2]);
        }
    }
    println!("a bead leaves a sphere: height to {worst:.1e} m");
}

/// A ball on a lift that accelerates upwards: in the lift's frame gravity is g + a, and nothing else changes.
#[test]
fn a_ball_bounces_on_a_lift_that_accelerates() {
    let body = BallOnLift::<f64>::default();
    let (a, v0) = (3.0, 0.4);
    for e in [0.0, 0.3, 0.5] {
        let mut simulation = start(&body, &[0.0, 1.0], &[0.0, v0], surface(0.3, e, Law::Newton));
        let fall = (2.0 / (G + a)).sqrt();
        let end = fall * (1.0 + e) / (1.0 - e);
        let events = run(&mut simulation, end + 2.0);
        let mut expected = fall;
        let mut flight = 2.0 * fall * e;
        for time in collisions(&events) {
            assert!((time - expected).abs() < 1e-9, "{e}: {time} {expected}");
            expected += flight;
            flight *= e;
        }
        let error = first(&events, "contact").time - end;
        // Rounding of a gap of 3 m over the speed of the last bounce.
        assert!(error.abs() < 1e-9, "{e}: {error:e}");
        // It rides on the lift.
        let t = simulation.time();
        assert!((simulation.coordinates()[1] - (v0 * t + 0.5 * a * t * t)).abs() < 1e-10);
        assert!((simulation.speeds()[1] - (v0 + a * t)).abs() < 1e-10);
    }
}

/// Elastic bounces down a smooth incline: equal times, and hops that grow by the same length.
#[test]
fn elastic_bounces_down_an_incline() {
    let alpha: f64 = 0.35;
    let mut body = Body::new(1.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))]);
    body.lines[0].tilt = alpha;
    let h = 0.5;
    // From a height h over the incline, straight up from its line.
    let mut simulation = start(&body, &[0.0, h, 0.0], &[0.0; 3], surface(0.0, 1.0, Law::Poisson));
    let events = run(&mut simulation, 20.0);
    let fall = (2.0 * h / G).sqrt();
    let times = collisions(&events);
    assert!(times.len() > 20);
    let mut before = (0.0, 0.0);
    for (k, event) in events.iter().filter(|event| event.kind.name() == "collision").enumerate() {
        let time = fall * (2.0 * k as f64 + 1.0);
        assert!((event.time - time).abs() < 1e-9, "{k}: {} {time}", event.time);
        let along = event.coordinates[0].hypot(event.coordinates[1]);
        if k > 1 {
            // Hops grow by 8 h sin(alpha).
            let grown = (along - before.0) - before.1;
            assert!((grown - 8.0 * h * alpha.sin()).abs() < 1e-8, "{k}: {grown}");
        }
        before = (along, along - before.0);
    }
}

/// Thrown up an incline that does not hold it, a block stops, turns, and slides down with the speed that is
/// known.
#[test]
fn slip_turns_round_on_a_steep_incline() {
    let body = PuckOnIncline::<f64>::default();
    let (alpha, mu, v0): (f64, f64, f64) = (0.4, 0.2, 1.7);
    let (up, down) = (G * (alpha.sin() + mu * alpha.cos()), G * (alpha.sin() - mu * alpha.cos()));
    for heading in [0.0, 1e-6] {
        let u = [v0, v0 * heading, 0.0];
        let mut simulation = start(&body, &[0.0; 3], &u, surface(mu, 0.5, Law::Stronge));
        run(&mut simulation, 2.0);
        let stop = v0 / up;
        let x = 0.5 * v0 * stop - 0.5 * down * (2.0 - stop).powi(2);
        let error = (simulation.coordinates()[0] - x).abs();
        assert!(error < if heading == 0.0 { 1e-10 } else { 1e-5 }, "{heading}: {error:e}");
        assert_eq!(simulation.phase(0), Some(ContactPhase::Slide));
    }
}

/// Two contacts with different friction: the moment of the forces decides how the weight is shared, and so
/// the deceleration.
#[test]
fn a_block_slides_on_two_surfaces() {
    let (half, b, m) = (0.3, 0.1, 2.0);
    let inertia = 2.0 * (half * half + b * b) / 3.0;
    let body =
        Body::new(m, inertia, &[Line::floor(Part::Point(-half, -b)), Line::floor(Part::Point(half, -b))]);
    let of = |mu| hodograph::Surface { mu, e: 0.5, law: Law::Newton };
    let options = Options { surfaces: vec![(0, of(0.2)), (1, of(0.7))], ..Options::default() };
    let mut simulation = start(&body, &[0.0, b, 0.0], &[1.5, 0.0, 0.0], options);
    // N0 + N1 = m g; half (N1 - N0) = b (0.2 N0 + 0.7 N1), for friction is below the mass centre and against
    // +x.
    let n0 = m * G * (half - 0.7 * b) / (2.0 * half + (0.2 - 0.7) * b);
    let n1 = m * G - n0;
    let a = (0.2 * n0 + 0.7 * n1) / m;
    let events = run(&mut simulation, 3.0);
    assert!((first(&events, "stick").time - 1.5 / a).abs() < 1e-10, "{:?} {}", names(&events), 1.5 / a);
    assert!((simulation.coordinates()[0] - 1.5 * 1.5 / (2.0 * a)).abs() < 1e-10);
    first(&events, "rest");
}
