//! Mechanisms with several contacts whose motions statics or a closed form knows.

use crate::many::{Ended, Start, follow, model, surface, with_parameters};
use hodograph::{ComponentKind, Contacts, Law, Mechanism, State, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{ContactPhase, Options, Simulation};

const G: f64 = 9.81;

/// A motion with mu and e for all contacts from the start of the model with these changes.
fn run(mechanism: &InterpretedMechanism, changes: &[(&str, f64)], (mu, e): (f64, f64), until: f64) -> Ended {
    let mut start = Start::of(mechanism);
    changes.iter().for_each(|(name, value)| start.set(mechanism, name, *value));
    let end = follow(mechanism, &start, surface(mu, e, Law::Poisson), until);
    assert!(end.error.is_none(), "{}: {:?}", mechanism.name(), end.error);
    end
}

fn coordinate(mechanism: &InterpretedMechanism, end: &Ended, name: &str) -> f64 {
    end.coordinates[mechanism.index(ComponentKind::Coordinate, name).unwrap()]
}

fn speed(mechanism: &InterpretedMechanism, end: &Ended, name: &str) -> f64 {
    end.speeds[mechanism.index(ComponentKind::Speed, name).unwrap()]
}

fn near(value: f64, wanted: f64, within: f64) {
    assert!((value - wanted).abs() <= within * wanted.abs().max(1.0), "{value:e} {wanted:e}");
}

/// Two jaws hold a box at four points where 2 mu F carries its weight; else it falls with what is left.
#[test]
fn a_gripper_holds_what_friction_carries() {
    let gripper = model("gripper");
    for mu in [0.05, 0.12, 0.163, 0.164, 0.3, 0.8] {
        let end = run(&gripper, &[], (mu, 0.0), 0.3);
        let falls = (G - 2.0 * mu * 30.0).max(0.0);
        assert_eq!(end.outcome(), if falls > 0.0 { "moves" } else { "rest" }, "{mu}");
        near(speed(&gripper, &end, "uzb"), -falls * 0.3, 1e-12);
        near(coordinate(&gripper, &end, "qb"), 0.0, 1e-12);
    }
}

/// A light ladder with a heavy man on it, between a rough floor and a rough wall. By the moments about the foot it stands
/// if the load is no further up than (mu tan + mu^2) / (1 + mu^2) of its length.
#[test]
fn a_man_climbs_a_ladder_until_it_slips() {
    let (mut stood, mut slipped) = (0, 0);
    for mu in [0.2, 0.3, 0.5] {
        for k in 0..9 {
            let up = 0.08 + 0.1 * f64::from(k);
            let ladder = with_parameters(&model("ladder_man"), &[("f", up)]);
            let load = (10.0 * 0.5 + 70.0 * up) / 80.0;
            let most = (mu * 1.0_f64.tan() + mu * mu) / (1.0 + mu * mu);
            let end = run(&ladder, &[], (mu, 0.0), 0.05);
            assert_eq!(end.outcome(), if load <= most { "rest" } else { "moves" }, "{mu} {up}");
            if load <= most { stood += 1 } else { slipped += 1 }
        }
    }
    assert!(stood > 8 && slipped > 5, "{stood} {slipped}");
}

/// A load at d beside a pole presses a bracket to it at two points 2 h apart, each with d F / (2 h).
#[test]
fn a_bracket_jams_on_its_pole() {
    let bracket = model("bracket");
    let (m, force, d, h) = (0.1, 20.0, 0.2, 0.05);
    let edge = h * (force + m * G) / (d * force);
    for mu in [0.1, edge - 1e-3, edge + 1e-3, 0.5] {
        let end = run(&bracket, &[], (mu, 0.0), 0.1);
        let slides = ((force + m * G - mu * d * force / h) / m).max(0.0);
        assert_eq!(end.outcome(), if mu < edge { "moves" } else { "rest" }, "{mu}");
        near(speed(&bracket, &end, "uzb"), -0.1 * slides, 1e-11);
    }
}

/// Two planks that lean against each other stand on a floor of mu >= 1 / (2 tan(angle)).
#[test]
fn planks_that_lean_against_each_other_stand() {
    let frame = model("a_frame");
    let edge = 0.5 / 1.1_f64.tan();
    for (mu, outcome) in [(edge - 1e-4, "moves"), (edge + 1e-4, "rest"), (0.6, "rest")] {
        let end = run(&frame, &[], (mu, 0.0), 0.1);
        assert_eq!(end.outcome(), outcome, "{mu}");
        // The motion is symmetric.
        near(coordinate(&frame, &end, "x0"), -coordinate(&frame, &end, "x1"), 1e-13);
        near(coordinate(&frame, &end, "z0"), coordinate(&frame, &end, "z1"), 1e-13);
    }
}

/// A smooth wedge gives way under a block with m g sin cos / (M + m sin^2); a rough one is held by the floor.
#[test]
fn a_wedge_gives_way_under_a_block() {
    let wedge = model("wedge_block");
    let (sin, cos) = 0.5_f64.sin_cos();
    let end = run(&wedge, &[], (0.0, 0.0), 0.1);
    near(speed(&wedge, &end, "uxw"), -0.1 * G * sin * cos / (2.0 + sin * sin), 1e-12);
    let end = run(&wedge, &[], (0.2, 0.0), 0.1);
    near(speed(&wedge, &end, "uxw"), 0.0, 1e-13);
    near(speed(&wedge, &end, "uxb").hypot(speed(&wedge, &end, "uzb")), 0.1 * G * (sin - 0.2 * cos), 1e-12);
}

/// Three smooth cylinders in a trough: by statics the walls carry what the upper one spreads.
#[test]
fn cylinders_in_a_trough_press_as_statics_says() {
    let trough = model("cylinders3");
    let start = Start::of(&trough);
    let mut simulation = Simulation::new(&trough, &start.state(), surface(0.0, 0.0, Law::Poisson)).unwrap();
    simulation.advance_to(0.1).unwrap();
    let (forces, unique) = simulation.contact_forces().unwrap();
    assert!(unique && forces.len() == 6);
    // The line of centres rises by this angle.
    let rise = (0.15_f64 / 0.2).acos();
    let wanted = |name: &str| match &name[..1] {
        "f" => 1.5 * G,
        "w" => 0.5 * G / rise.tan(),
        _ => 0.5 * G / rise.sin(),
    };
    for (contact, force) in forces {
        let name = trough.component(ComponentKind::Contact, contact).unwrap().name;
        near(force.x, wanted(name), 1e-13);
    }
}

/// Three boxes in a row begin to slide together where the push on the first exceeds the friction of all.
#[test]
fn a_row_of_boxes_slides_together() {
    let row = model("row3");
    let friction = 3.0 * 0.3 * G;
    for push in [friction * (1.0 - 1e-6), friction * (1.0 + 1e-3), 20.0] {
        let end = run(&row, &[("push", push)], (0.3, 0.0), 0.2);
        let a = ((push - friction) / 3.0).max(0.0);
        for name in ["ux0", "ux1", "ux2"] {
            near(speed(&row, &end, name), 0.2 * a, 1e-11);
        }
        assert_eq!(end.outcome(), if a > 0.0 { "moves" } else { "rest" });
    }
}

/// A box that slides against a low fence turns about its edge with m v h / J and tips over if that carries it beyond its
/// edge.
#[test]
fn a_box_tips_over_a_fence() {
    let fence = model("fence");
    let (a, h): (f64, f64) = (0.1, 0.2);
    let about_edge = 4.0 / 3.0 * (a * a + h * h);
    let edge = (2.0 * G * about_edge * (a.hypot(h) - h)).sqrt() / h;
    for (share, tips) in [(0.99, false), (1.01, true)] {
        let end = run(&fence, &[("uxb", share * edge)], (0.0, 0.0), 3.0);
        let over = coordinate(&fence, &end, "qb") > 1.0;
        assert_eq!(over, tips, "{share} {:?}", end.coordinates);
        assert!(end.account.abs() < 1e-10, "{:e}", end.account);
    }
}

/// Five balls on strings: elastic ones pass the speed on to the last, plastic ones swing on side by side, for ever
/// touching, without a force between them.
#[test]
fn a_cradle_of_pendulums() {
    let cradle = model("cradle5");
    for mu in [0.0, 0.15, 0.4, 0.9] {
        let end = run(&cradle, &[], (mu, 1.0), 1.9);
        let others = (0..4).map(|i| end.coordinates[i].abs() + end.speeds[i].abs()).fold(0.0, f64::max);
        assert!(others < 1e-12 && end.speeds[4] > 1.0, "{mu}: {:?} {:?}", end.coordinates, end.speeds);
        assert!(end.account.abs() < 1e-12);
        let end = run(&cradle, &[], (mu, 0.0), 2.0);
        for i in 1..5 {
            near(end.coordinates[i], end.coordinates[0], 1e-13);
            near(end.speeds[i], end.speeds[0], 1e-13);
        }
        assert!(end.events.len() < 40 && end.account.abs() < 1e-12, "{mu}: {:?}", end.names());
        // The last impacts leave a fifth of the speed.
        let energy =
            0.5 * 0.5 * (0.3 * end.speeds[0]).powi(2) - 0.5 * G * 0.3 * (end.coordinates[0].cos() - 1.0);
        near(energy, 0.1 * G * 0.3 * (1.0 - 0.5_f64.cos()) / 5.0, 1e-9);
    }
}

/// A ball rolls down a groove with g sin / (1 + 2 / (5 cos^2)), or slides with g sin - mu g cos / cos(half).
#[test]
fn a_ball_rolls_or_slides_down_a_groove() {
    let groove = model("groove_roll");
    let (slope, half): (f64, f64) = (0.2, 0.7);
    let rolls = G * slope.sin() / (1.0 + 0.4 / half.cos().powi(2));
    for mu in [0.02, 0.05, 0.2, 0.5] {
        let end = run(&groove, &[], (mu, 0.0), 1.0);
        let slides = G * slope.sin() - mu * G * slope.cos() / half.cos();
        near(speed(&groove, &end, "uxb"), rolls.max(slides), 1e-10);
    }
}

/// A car that brakes with all wheels stops after v^2 / (2 mu g), straight; with its front wheels alone it slows down with
/// mu g b / (L - mu h), b being the distance of its centre from the rear axle.
#[test]
fn a_car_brakes() {
    let car = model("car");
    for mu in [0.3, 0.7] {
        let end = run(&car, &[], (mu, 0.0), 10.0);
        assert_eq!(end.outcome(), "rest");
        near(coordinate(&car, &end, "xc"), 100.0 / (2.0 * mu * G), 1e-9);
        near(coordinate(&car, &end, "yc"), 0.0, 1e-9);
        near(end.time, 10.0, 0.0);
        near(end.events.last().unwrap().time, 10.0 / (mu * G), 1e-9);
    }
    let mu = 0.5;
    let smooth = Surface { mu: 0.0, e: 0.0, law: Law::Poisson };
    let rear = |name: &str| (car.index(ComponentKind::Contact, name).unwrap(), smooth);
    let options = Options { surfaces: vec![rear("w2"), rear("w3")], ..surface(mu, 0.0, Law::Poisson) };
    let end = follow(&car, &Start::of(&car), options, 1.0);
    assert!(end.error.is_none());
    near(speed(&car, &end, "uxc"), 10.0 - mu * G * 1.0 / (2.4 - mu * 0.5), 1e-11);
}

/// A plank on two rollers that turn towards each other swings with mu g / (a - mu h) as the square of its frequency.
#[test]
fn a_plank_swings_on_two_rollers() {
    let plank = model("plank_rollers");
    for mu in [0.1, 0.3, 0.6] {
        let period = std::f64::consts::TAU / (mu * G / (0.3 - mu * 0.02)).sqrt();
        for (share, x) in [(0.5, -0.05), (1.0, 0.05), (3.0, 0.05)] {
            let end = run(&plank, &[], (mu, 0.0), share * period);
            near(coordinate(&plank, &end, "xb"), x, 1e-10);
        }
    }
}

/// A box on a truck that accelerates stays, slides or tips, as the least of A, mu g and g a / h says.
#[test]
fn a_box_on_a_truck_stays_slides_or_tips() {
    for (mu, truck) in [(0.3, 2.0), (0.3, 3.5), (0.6, 4.8), (0.4, 10.0), (0.6, 5.2)] {
        let mechanism = with_parameters(&model("truck"), &[("A", truck)]);
        let end = run(&mechanism, &[], (mu, 0.0), 0.2);
        let tips = G * 0.5;
        let turned = coordinate(&mechanism, &end, "qb");
        if tips < truck && tips < mu * G {
            assert!(turned < -1e-3, "{mu} {truck}: {turned}");
        } else {
            near(speed(&mechanism, &end, "uxb"), 0.2 * truck.min(mu * G), 1e-9);
            near(turned, 0.0, 1e-12);
        }
    }
}

/// A walker with two feet on a smooth slope: its momentum along the slope grows with its weight alone.
#[test]
fn a_walker_on_smooth_ground_keeps_its_momentum() {
    let walker = model("compass");
    for e in [0.0, 0.5] {
        let end = run(&walker, &[("ux", 0.3), ("u1", -0.3), ("u2", 0.1)], (0.0, e), 0.6);
        let momentum = |q1: f64, q2: f64, u: &[f64]| {
            let leg = |q: f64, turns: f64| 5.0 * (u[0] - 0.5 * q.cos() * turns);
            10.0 * u[0] + leg(q1, u[2]) + leg(q2, u[3])
        };
        let before = momentum(0.2, -0.2, &[0.3, 0.0, -0.3, 0.1]);
        let after = momentum(end.coordinates[2], end.coordinates[3], &end.speeds);
        near(after, before + 0.6 * 20.0 * G * 0.05_f64.sin(), 1e-8);
    }
}

/// A table on three feet that is pushed at its top stays where friction holds it and the resultant of weight and push
/// meets the floor within its feet; slides upright where that of friction does; else it tips about its front foot.
#[test]
fn a_table_on_three_feet_stays_slides_or_tips() {
    let table = model("table3");
    let (m, r, below, above) = (10.0, 0.35, 0.6, 0.1);
    let mut seen = [0; 3];
    for k in 1..=10 {
        let mu = 0.1 * f64::from(k);
        for push in [0.0, 12.0, 25.0, 37.0, 48.5, 49.5, 60.0, 73.0, 87.0, 100.0] {
            let end = run(&table, &[("F", push)], (mu, 0.0), 0.25);
            let friction = (mu * m * G).min(push);
            // Where the floor carries the table, before its centre.
            let ahead = (above * push + below * friction) / (m * G);
            let turned = coordinate(&table, &end, "e2");
            let what = if ahead > r { 2 } else { usize::from(push > friction) };
            seen[what] += 1;
            match what {
                2 => assert!(turned > 1e-4, "{mu} {push}: {turned:e}"),
                _ => {
                    near(turned, 0.0, 1e-12);
                    near(speed(&table, &end, "ux"), 0.25 * (push - friction) / m, 1e-11);
                    assert_eq!(end.outcome(), if what == 0 { "rest" } else { "moves" }, "{mu} {push}");
                }
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 10), "{seen:?}");
}

/// Tables and tripods that tip over rattle on two feet, whose slip turns into jams within no time.
#[test]
fn tables_that_tip_go_on_through_their_jams() {
    for (name, mu, e, push, across) in [
        ("table3", 0.6, 0.0, 60.0, 0.0),
        ("table3", 0.9, 0.0, 50.0, 7.0),
        ("table3", 1.0, 0.0, 50.0, 7.0),
        ("tripod", 1.0, 0.0, 10.0, 2.0),
        ("tripod", 0.6, 0.4, 10.0, 2.0),
        ("tripod", 1.0, 0.4, 10.0, 2.0),
    ] {
        let mechanism = model(name);
        let end = run(&mechanism, &[("F", push), ("Fy", across)], (mu, e), 2.1);
        assert!(end.gain().is_none_or(|(_, gain)| gain < 1e-12), "{name} {mu}: {:?}", end.gain());
    }
}

/// Slip of two feet that begins slowly has settled directions, which depend on each other. Steps of six times the time in
/// which they settle made the motion end with an error.
#[test]
fn two_feet_begin_to_slip_slowly() {
    let table = model("table3");
    for (mu, push, across) in [(0.4, 45.0, 15.0), (1.0, 45.0, 7.0), (0.6, 45.0, 7.0)] {
        let mut begin = Start::of(&table);
        begin.set(&table, "F", push);
        begin.set(&table, "Fy", across);
        let tolerance = 1e-9;
        let mut options = surface(mu, 0.3, Law::Poisson);
        (options.relative_tolerance, options.absolute_tolerance) = (tolerance, tolerance);
        let end = follow(&table, &begin, options, 2.1);
        assert!(end.error.is_none(), "{mu} {push} {across}: {:?}", end.error);
        assert!(end.gain().is_none_or(|(_, gain)| gain < 1e-12), "{mu}: {:?}", end.gain());
        assert!(end.account.abs() < 1e3 * tolerance * end.before, "{mu}: {:e}", end.account);
    }
}

/// A wheel that rolls against a kerb keeps 1 - 2 h / (3 r) of its angular velocity, and climbs where that carries it over.
#[test]
fn a_wheel_climbs_a_kerb() {
    let kerb = model("kerb");
    let (r, h) = (0.3, 0.08);
    let least = (4.0 * G * h / 3.0).sqrt() / (1.0 - 2.0 * h / (3.0 * r));
    for share in [0.8, 0.999, 1.001, 1.2] {
        let v = share * least;
        let end = run(&kerb, &[("uxb", v), ("uqb", v / r)], (3.0, 0.0), 2.5);
        assert_eq!(coordinate(&kerb, &end, "xb") > 0.6, share > 1.0, "{share}: {:?}", end.coordinates);
        assert!(end.account.abs() < 1e-12, "{:e}", end.account);
    }
}

/// A wheel that flies off a kerb comes back to it where its gap is zero. The gap was integrated over the whole flight from
/// five places, and was 1e-7 m there.
#[test]
fn a_flight_that_begins_with_a_lift_off_ends_where_bodies_touch() {
    let kerb = model("kerb");
    let end = run(&kerb, &[("uxb", 3.0)], (0.1, 0.0), 1.0);
    let struck: Vec<_> = end.events.iter().filter(|event| event.kind.name() == "collision").collect();
    assert!(struck.len() >= 3, "{:?}", end.names());
    for event in struck {
        let (q, u) = (&event.coordinates, &event.speeds);
        let state = State { time: event.time, coordinates: q, speeds: u, inputs: &[0.0] };
        let gap = kerb.gap(event.contact.unwrap(), &state).unwrap().unwrap();
        assert!(gap.abs() < 1e-14, "{gap:e}");
    }
    assert!(end.account.abs() < 1e-12, "{:e}", end.account);
}

/// Forces and phases within a step that ends with an event are those of before: a wheel that is driven off a kerb was told
/// to be pulled.
#[test]
fn forces_before_an_event_obey_the_laws() {
    let kerb = model("kerb");
    for (v, torque) in [(0.5, 3.0), (1.5, 3.0)] {
        let mut start = Start::of(&kerb);
        [("uxb", v), ("T", torque)].iter().for_each(|(name, value)| start.set(&kerb, name, *value));
        let mut simulation = Simulation::new(&kerb, &start.state(), surface(0.5, 0.0, Law::Poisson)).unwrap();
        let mut pressed = 0;
        for k in 1..=200 {
            simulation.advance_to(0.01 * f64::from(k)).unwrap();
            let (forces, _) = simulation.contact_forces().unwrap();
            for (contact, force) in forces {
                assert!(force.x > -1e-9 && force.y.hypot(force.z) <= 0.5 * force.x + 1e-9, "{k}: {force}");
                assert!(simulation.phase(contact) != Some(ContactPhase::Open));
                pressed += 1;
            }
        }
        assert!(pressed > 50, "{pressed}");
    }
}

/// A drawer with play that is pulled beside its axis jams in its guide or at its stop, and stays. What its rattling loses at
/// last, with two corners on a lever of a millimetre, was no work of impacts.
#[test]
fn a_drawer_comes_to_rest_with_its_energy_accounted_for() {
    let drawer = model("guide");
    for (mu, y) in [(0.1, 0.06), (0.1, 0.1), (0.3, 0.06), (0.3, 0.1), (0.6, 0.02)] {
        let drawer = with_parameters(&drawer, &[("y", y), ("cl", 1e-3)]);
        let end = run(&drawer, &[], (mu, 0.0), 1.0);
        assert!(end.speeds.iter().all(|speed| speed.abs() < 1e-15), "{mu} {y}: {:?}", end.speeds);
        assert!(end.account.abs() < 1e-10, "{mu} {y}: {:e}", end.account);
    }
}
