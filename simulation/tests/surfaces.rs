//! Laws of contact beyond one mu and one e, against answers in closed form.

use std::sync::Arc;

use crate::common::{Body, Line, Part, collisions, first, names, run, start, surface};
use hodograph::{Law, Selection, State};
use hodograph_simulation::{
    ContactLaw, ContactPhase, Drive, EventKind, ImpactsAtOnce, Options, Restitution, Simulation, Sliding,
};

const G: f64 = 9.81;

fn particle() -> Body {
    Body::new(1.5, 1.0, &[Line::floor(Part::Point(0.0, 0.0))])
}

/// A box on two feet.
fn crate_on_feet() -> Body {
    let foot = |x: f64| Line::floor(Part::Point(x, -0.05));
    Body { mass: 1.5, ..Body::new(1.5, 0.2, &[foot(-0.3), foot(0.3)]) }
}

fn on_incline(mut body: Body, slope: f64) -> Body {
    body.gravity = [-G * slope.sin(), -G * slope.cos()];
    body
}

fn with_static(mu: f64, mu_static: f64, e: f64) -> Options {
    let law = ContactLaw { mu_static: Some(mu_static), ..ContactLaw::default() };
    Options { law: Some(law), ..surface(mu, e, Law::Poisson) }
}

/// The energy account: what kinetic and potential energy lose is the works.
fn balance(simulation: &Simulation<'_>, start: f64) -> f64 {
    let account = simulation.energy().unwrap();
    account.total().unwrap() - start - account.friction - account.impacts - account.inputs
}

/// A block on an incline sticks up to tan alpha = mu_s, and else slides with g (sin alpha - mu cos alpha).
#[test]
fn a_block_sticks_up_to_static_friction_and_slides_with_less() {
    let (mu, mu_static) = (0.3, 0.5_f64);
    for (body, z) in [(particle(), 0.0), (crate_on_feet(), 0.05)] {
        for (beside, sticks) in [(-1e-9, true), (1e-9, false), (0.2, false), (-0.3, true)] {
            let slope = (mu_static * (1.0 + beside)).atan();
            let body = on_incline(body.clone(), slope);
            let mut simulation = start(&body, &[0.0, z, 0.0], &[0.0; 3], with_static(mu, mu_static, 0.0));
            let before = simulation.energy().unwrap().total().unwrap();
            let events = run(&mut simulation, 2.0);
            let x = simulation.coordinates()[0];
            if sticks {
                assert_eq!((x, simulation.speeds()), (0.0, &[0.0; 3][..]), "{beside}");
            } else {
                let expected = -0.5 * G * (slope.sin() - mu * slope.cos()) * 4.0;
                assert!((x - expected).abs() < 1e-9, "{beside}: {x} {expected} {:?}", names(&events));
            }
            assert!(balance(&simulation, before).abs() < 1e-12 * 30.0, "{beside}");
        }
    }
}

/// A push that grows: slip begins where it reaches mu_s m g, and goes on with mu m g.
#[test]
fn slip_begins_where_force_leaves_the_static_cone() {
    let (mu, mu_static, rate) = (0.2, 0.45, 3.0);
    for (body, z) in [(particle(), 0.0), (crate_on_feet(), 0.05)] {
        let push = Drive::Continuous(Arc::new(move |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
            inputs[0] = rate * t;
        }));
        let options = Options { drive: push, ..with_static(mu, mu_static, 0.0) };
        let mut simulation = start(&body, &[0.0, z, 0.0], &[0.0; 3], options);
        let begin = mu_static * body.mass * G / rate;
        let events = run(&mut simulation, begin + 1.0);
        let slip = first(&events, "slip");
        assert!((slip.time - begin).abs() < 1e-11, "{} {begin}", slip.time);
        // a = (F - mu m g) / m with F = mu_s m g + rate s
        let speed = (mu_static - mu) * G + 0.5 * rate / body.mass;
        let way = 0.5 * (mu_static - mu) * G + rate / body.mass / 6.0;
        assert!((simulation.speeds()[0] - speed).abs() < 1e-10, "{}", simulation.speeds()[0] - speed);
        assert!((simulation.coordinates()[0] - way).abs() < 1e-10);
        // Both feet at once, and no more than that.
        let slips = events.iter().filter(|event| event.kind.name() == "slip").count();
        assert_eq!(slips, body.lines.len(), "{:?}", names(&events));
    }
}

/// A block thrown uphill where mu < tan alpha < mu_s stops after v^2 / (2 g (sin alpha + mu cos alpha)) and stays:
/// static friction holds it, though it could as well slip down, and the event says so.
#[test]
fn a_block_thrown_uphill_stays_where_static_friction_holds_it() {
    let (mu, mu_static, slope, v) = (0.2, 0.6, 0.4_f64.atan(), 1.7);
    for (body, z) in [(particle(), 0.0), (crate_on_feet(), 0.05)] {
        let body = on_incline(body, slope);
        let start = |options| start(&body, &[0.0, z, 0.0], &[v, 0.0, 0.0], options);
        let mut simulation = start(with_static(mu, mu_static, 0.0));
        let before = simulation.energy().unwrap().total().unwrap();
        let events = run(&mut simulation, 3.0);
        let way = v * v / (2.0 * G * (slope.sin() + mu * slope.cos()));
        assert!((simulation.coordinates()[0] - way).abs() < 1e-9, "{:?}", names(&events));
        assert_eq!(simulation.speeds(), [0.0; 3]);
        let stick = first(&events, "stick");
        let EventKind::Stick { selection } = stick.kind else { unreachable!() };
        assert_eq!(selection, Selection::SeveralModes);
        assert!(balance(&simulation, before).abs() < 1e-12 * before.abs().max(1.0));
        // With one coefficient it comes back.
        let mut other = start(surface(mu, 0.0, Law::Poisson));
        run(&mut other, 3.0);
        assert!(other.coordinates()[0] < 0.0);
    }
}

/// A block on a belt and a spring: it sticks for 2 A / v and slips for 2 (pi - atan(A w / v)) / w,
/// A = (mu_s - mu) m g / k, w = (k / m)^(1/2). Its cycles repeat: slip begins and ends finitely often.
#[test]
fn stick_slip_on_a_belt_has_the_period_of_its_closed_form() {
    let (mu, mu_static, v) = (0.25, 0.4, 0.3);
    let mut body = particle();
    body.spring = 40.0;
    body.lines[0].belt = v;
    let (w, amplitude) = ((body.spring / body.mass).sqrt(), (mu_static - mu) * body.mass * G / body.spring);
    let (sticks, slips) =
        (2.0 * amplitude / v, 2.0 * (std::f64::consts::PI - (amplitude * w / v).atan()) / w);
    let mut simulation = start(&body, &[0.0; 3], &[v, 0.0, 0.0], with_static(mu, mu_static, 0.0));
    let cycles = 20;
    let begin = mu_static * body.mass * G / body.spring / v;
    let events = run(&mut simulation, begin + f64::from(cycles) * (sticks + slips) + 1e-6);
    let times = |name: &str| -> Vec<f64> {
        events.iter().filter(|event| event.kind.name() == name).map(|event| event.time).collect()
    };
    let (slip, stick) = (times("slip"), times("stick"));
    assert_eq!((slip.len(), stick.len()), (cycles as usize + 1, cycles as usize), "{:?}", names(&events));
    for (k, time) in slip.iter().enumerate() {
        let expected = begin + k as f64 * (sticks + slips);
        assert!((time - expected).abs() < 1e-9, "slip {k}: {:e}", time - expected);
    }
    for (k, time) in stick.iter().enumerate() {
        let expected = begin + slips + k as f64 * (sticks + slips);
        assert!((time - expected).abs() < 1e-9, "stick {k}: {:e}", time - expected);
    }
}

/// Friction in an impact is mu_impact: a particle that strikes at an angle loses mu_impact (1 + e) v_n of its slip,
/// and mu g afterwards.
#[test]
fn impacts_have_a_friction_of_their_own() {
    let (mu, mu_impact, e, down, along) = (0.5, 0.1, 0.4, 2.0, 3.0);
    let law = ContactLaw { mu_impact: Some(mu_impact), ..ContactLaw::default() };
    for together in [ImpactsAtOnce::Approaching, ImpactsAtOnce::Simultaneous, ImpactsAtOnce::Sequential] {
        let options = Options { law: Some(law.clone()), together, ..surface(mu, e, Law::Stronge) };
        let body = particle();
        let mut simulation = start(&body, &[0.0; 3], &[along, -down, 0.0], options);
        let events = run(&mut simulation, 1e-6);
        let after = simulation.speeds();
        let expected = along - mu_impact * (1.0 + e) * down;
        assert!((after[0] - expected).abs() < 1e-12, "{} {expected} {:?}", after[0], names(&events));
    }
    // A box that falls flat on both feet while it slides.
    let options = Options { law: Some(law), ..surface(mu, 0.0, Law::Stronge) };
    let body = crate_on_feet();
    let mut simulation = start(&body, &[0.0, 0.05, 0.0], &[along, -down, 0.0], options);
    run(&mut simulation, 1e-9);
    // mu_impact acts at the feet below the centre: the box turns unless its feet share the impulse.
    let expected = along - mu_impact * down - mu * G * 1e-9;
    assert!((simulation.speeds()[0] - expected).abs() < 1e-12, "{}", simulation.speeds()[0] - expected);
}

/// The speeds of a ball after each bounce: v_(k+1) = e(v_k) v_k; flights last 2 v / g.
#[test]
fn bounces_follow_the_ladder_of_their_law() {
    let laws =
        ["power(2, 0.25)", "loss(3, 0.2)", "table(0, 0.9, 1, 0.7, 4, 0.3)", "threshold(0.5)", "constant"];
    let (e, height) = (0.6, 1.0_f64);
    for text in laws {
        let restitution: Restitution = text.parse().unwrap();
        let value = restitution.clone();
        let same = Restitution::Function(Arc::new(move |v| value.at(e, v)));
        for restitution in [restitution.clone(), same] {
            let law = ContactLaw { restitution: restitution.clone(), ..ContactLaw::default() };
            let options = Options { law: Some(law), ..surface(0.0, e, Law::Newton) };
            let body = particle();
            let mut simulation = start(&body, &[0.0, height, 0.0], &[0.0; 3], options);
            let before = simulation.energy().unwrap().total().unwrap();
            let events = run(&mut simulation, 6.0);
            let (mut speed, mut time) = ((2.0 * G * height).sqrt(), (2.0 * height / G).sqrt());
            for (k, at) in collisions(&events).into_iter().take(12).enumerate() {
                assert!((at - time).abs() < 1e-10, "{text}, bounce {k}: {at} {time}");
                speed *= restitution.at(e, speed);
                time += 2.0 * speed / G;
            }
            assert!(balance(&simulation, before).abs() < 1e-12 * before, "{text}");
            if text.starts_with("threshold") {
                // 4.43, 2.66, 1.59, 0.96, 0.57, 0.34 m/s: the sixth strikes below the threshold.
                assert_eq!(collisions(&events).len(), 6);
                assert!((first(&events, "contact").time - time).abs() < 1e-10);
                assert_eq!(simulation.speeds(), [0.0; 3]);
            }
        }
    }
}

/// Viscoelastic bounces, e = 1 - c v^(1/5), fade more slowly than any geometric series, but end in a finite time:
/// the sum of the whole ladder.
#[test]
fn viscoelastic_bounces_end_when_their_ladder_does() {
    let restitution = Restitution::Loss { speed: 1.0, exponent: 0.2 };
    let (e, height) = (0.3, 0.1_f64);
    let law = ContactLaw { restitution: restitution.clone(), ..ContactLaw::default() };
    let options = Options {
        law: Some(law),
        relative_tolerance: 1e-10,
        absolute_tolerance: 1e-10,
        ..surface(0.0, e, Law::Stronge)
    };
    let body = particle();
    let mut simulation = start(&body, &[0.0, height, 0.0], &[0.0; 3], options);
    let (mut speed, mut end) = ((2.0 * G * height).sqrt(), (2.0 * height / G).sqrt());
    while speed > 1e-14 {
        speed *= restitution.at(e, speed);
        end += 2.0 * speed / G;
    }
    let events = run(&mut simulation, end + 0.1);
    let contact = first(&events, "contact");
    assert!((contact.time - end).abs() < 1e-8, "{} {end} after {}", contact.time, collisions(&events).len());
    assert_eq!(simulation.phase(0), Some(ContactPhase::Stick));
}

/// Slip under Stribeck's friction mu + (mu_s - mu) exp(-s / c) ends after c / (mu g) ln((mu exp(s0 / c) + mu_s -
/// mu) / mu_s).
#[test]
fn friction_that_falls_with_slip_stops_a_block_in_the_time_of_its_integral() {
    let (mu, mu_static, c, v) = (0.2, 0.5, 0.3, 1.1_f64);
    let falls = ContactLaw {
        mu_static: Some(mu_static),
        sliding: Sliding::Stribeck { speed: c },
        ..ContactLaw::default()
    };
    let function = ContactLaw {
        sliding: Sliding::Function(Arc::new(move |s| mu + (mu_static - mu) * (-s / c).exp())),
        ..ContactLaw::default()
    };
    let end = c / (mu * G) * ((mu * (v / c).exp() + mu_static - mu) / mu_static).ln();
    for (law, body, z) in
        [(falls.clone(), particle(), 0.0), (function, particle(), 0.0), (falls, crate_on_feet(), 0.05)]
    {
        let options = Options { law: Some(law), ..surface(mu, 0.0, Law::Poisson) };
        let mut simulation = start(&body, &[0.0, z, 0.0], &[v, 0.0, 0.0], options);
        let before = simulation.energy().unwrap().total().unwrap();
        let events = run(&mut simulation, end + 1.0);
        let stick = first(&events, "stick");
        assert!((stick.time - end).abs() < 1e-10, "{:e} {:?}", stick.time - end, names(&events));
        assert_eq!(simulation.speeds(), [0.0; 3]);
        assert!(balance(&simulation, before).abs() < 1e-12 * before.abs().max(1.0));
    }
}

/// Contacts may have different laws.
#[test]
fn contacts_have_laws_of_their_own() {
    let foot = |x: f64| Line::floor(Part::Point(x, 0.0));
    let body = Body::new(1.0, 1.0, &[foot(-0.5), foot(0.5)]);
    let law = ContactLaw { mu_static: Some(0.9), ..ContactLaw::default() };
    let push = Drive::Continuous(Arc::new(|t, _: &[f64], _: &[f64], inputs: &mut [f64]| inputs[0] = t));
    // Friction shared by two feet of half the weight each: 0.5 (0.9 + 0.2) m g.
    let options = Options { laws: vec![(1, law)], drive: push, ..surface(0.2, 0.0, Law::Newton) };
    let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], options);
    let events = run(&mut simulation, 6.0);
    let slip = first(&events, "slip");
    assert!((slip.time - 0.55 * G).abs() < 1e-9, "{:?}", names(&events));
}

/// Laws that are impossible are refused, before the motion where that can be seen, with what is wrong.
#[test]
fn impossible_laws_are_refused() {
    let body = particle();
    let tried = |law: ContactLaw| {
        let state =
            State { time: 0.0, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.3, 0.0, 0.0], inputs: &[0.0] };
        let options = Options { law: Some(law), ..surface(0.3, 0.5, Law::Newton) };
        let mut simulation = match Simulation::new(&body, &state, options) {
            Ok(simulation) => simulation,
            Err(error) => return format!("start: {error}"),
        };
        simulation.advance_to(2.0).err().map_or(String::new(), |error| error.to_string())
    };
    let restitution = |restitution: Restitution| ContactLaw { restitution, ..ContactLaw::default() };
    let function = |value: f64| restitution(Restitution::Function(Arc::new(move |_| value)));
    for (law, says) in [
        (ContactLaw { mu_static: Some(0.2), ..ContactLaw::default() }, "less than that of sliding friction"),
        (ContactLaw { mu_static: Some(f64::NAN), ..ContactLaw::default() }, "static friction is NaN"),
        (ContactLaw { mu_impact: Some(-0.1), ..ContactLaw::default() }, "friction in impacts is -0.1"),
        (ContactLaw { sliding: Sliding::Stribeck { speed: 0.1 }, ..ContactLaw::default() }, "give that too"),
        (restitution(Restitution::Power { speed: 0.0, exponent: 0.2 }), "speed of restitution is 0"),
        (restitution(Restitution::Loss { speed: 1.0, exponent: -1.0 }), "exponent of restitution is -1"),
        (restitution(Restitution::Table(vec![[1.0, 0.5], [1.0, 0.4]])), "rise"),
        (restitution(Restitution::Table(vec![[1.0, 1.5]])), "at 1 m/s is 1.5"),
        (function(1.5), "is 1.5 at 1 m/s"),
    ] {
        let told = tried(law);
        assert!(told.starts_with("start:") && told.contains(says), "{told}");
    }
    // Functions that fail later.
    let late = |v: f64| if v > 3.0 { f64::NAN } else { 0.5 };
    let told = tried(restitution(Restitution::Function(Arc::new(late))));
    assert!(told.contains("is NaN at 4.42"), "{told}");
    let slow = |s: f64| if s < 0.2 { 0.3 } else { -1.0 };
    let told = tried(ContactLaw { sliding: Sliding::Function(Arc::new(slow)), ..ContactLaw::default() });
    assert!(told.is_empty() || told.contains("sliding friction gives -1"), "{told}");
}
