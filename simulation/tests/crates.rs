//! Crates in space on tables and on each other: vertices on faces and edges on edges that end (docs/theory.md, 16.10).

use crate::common::{run, start, surface};
use crate::ledge::integrate;
use crate::many::{model, with_parameters};
use hodograph::{ComponentKind, Contacts, Law, State};
use hodograph_random::Random;
use hodograph_simulation::{ContactPhase, ErrorKind, EventKind, Simulation};

/// The first coordinates and speeds: of the mass centre, and the angle about N.z of a quaternion.
fn in_the_plane(simulation: &Simulation<'_>) -> [f64; 6] {
    let (q, u) = (simulation.coordinates(), simulation.speeds());
    [q[0], q[1], 2.0 * q[6].atan2(q[3]), u[0], u[1], u[5]]
}

/// A crate slides without friction until its mass centre is over the edge of the table, at 1 s; then it tips, and slides
/// on the edge, as a block in a plane does.
#[test]
fn a_crate_tips_when_its_mass_centre_passes_the_edge() {
    let table = model("crate_on_table");
    let speed = 0.5;
    let q = [-0.5, 0.1, 0.03, 1.0, 0.0, 0.0, 0.0];
    let u = [speed, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut simulation = start(&table, &q, &u, surface(0.0, 0.0, Law::Newton));
    let events = run(&mut simulation, 1.1);
    let last = events.iter().rfind(|event| matches!(event.kind, EventKind::LiftOff { .. })).unwrap();
    assert!((last.time - 1.0).abs() < 1e-10, "{} {events:#?}", last.time);
    // none of the features that come under the crate, or leave it, is struck
    assert!(events.iter().all(|event| event.kind.name() != "collision"), "{events:#?}");
    let expected = integrate([0.0, 0.1, 0.0, speed, 0.0, 0.0], 0.1, 4000);
    let found = in_the_plane(&simulation);
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() < 1e-9, "{found:?} {expected:?}");
    }
}

/// The same with a crate that is turned about the vertical: its mass centre passes the edge at the same instant.
#[test]
fn a_turned_crate_tips_at_the_same_instant() {
    let table = model("crate_on_table");
    let half = 0.3_f64;
    let q = [-0.5, 0.1, 0.03, half.cos(), 0.0, half.sin(), 0.0];
    let mut simulation = start(&table, &q, &[0.5, 0.0, 0.0, 0.0, 0.0, 0.0], surface(0.0, 0.0, Law::Newton));
    run(&mut simulation, 1.0 - 1e-4);
    assert!(simulation.speeds()[3..].iter().all(|w| w.abs() < 1e-12), "{:?}", simulation.speeds());
    assert!((simulation.coordinates()[1] - 0.1).abs() < 1e-12);
    run(&mut simulation, 1.1);
    let tipped = simulation.speeds()[5];
    assert!(tipped < -0.05, "{:?}", simulation.speeds());
}

/// Two crates, one upon the other, with these coordinates and speeds of the upper one along N.x and about N.z.
fn two(lower: [f64; 7], upper: [f64; 7], [speed, turning]: [f64; 2]) -> (Vec<f64>, Vec<f64>) {
    let mut u = vec![0.0; 12];
    (u[6], u[11]) = (speed, turning);
    ([lower, upper].concat(), u)
}

/// A crate falls flat on another, turned about the vertical, and both come to rest.
#[test]
fn crates_dropped_flat_on_each_other_rest() {
    let crates = model("two_crates");
    for angle in [0.0_f64, 0.4] {
        let (sin, cos) = (0.5 * angle).sin_cos();
        let (q, u) =
            two([0.0, 0.1, 0.0, 1.0, 0.0, 0.0, 0.0], [0.02, 0.35, 0.01, cos, 0.0, sin, 0.0], [0.0; 2]);
        let mut simulation = start(&crates, &q, &u, surface(0.5, 0.0, Law::Newton));
        run(&mut simulation, 1.0);
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        assert!(u.iter().all(|u| u.abs() < 1e-10), "{u:?}");
        assert!((q[8] - 0.3).abs() < 1e-9 && (q[1] - 0.1).abs() < 1e-9, "{q:?}");
        let closed = (0..68)
            .filter(|&contact| simulation.phase(contact).is_some_and(|phase| phase != ContactPhase::Open));
        println!("{angle}: {:?}", closed.collect::<Vec<_>>());
    }
}

/// Two crates that lie flat on each other touch at the corners of what their faces have in common: bars across each other
/// where their edges cross, equal crates that are turned in an octagon, equal crates that are not in four vertices.
#[test]
fn flush_faces_touch_at_the_corners_of_their_common_polygon() {
    let sides = |a: f64, c: f64| [("lower_a", a), ("lower_c", c), ("upper_a", a), ("upper_c", c)];
    for (what, changes, angle, wanted) in [
        ("bars", sides(1.0, 0.1), 1.1_f64, Some(vec![17, 18, 19, 20])),
        ("octagon", sides(0.4, 0.4), 0.6, None),
        ("square", sides(0.4, 0.4), 0.0, Some(vec![3, 4, 7, 8])),
    ] {
        let crates = with_parameters(&model("two_crates"), &changes);
        let (sin, cos) = (0.5 * angle).sin_cos();
        let shift = if what == "bars" { 0.01 } else { 0.0 };
        let upper = [shift, 0.3, 0.0, cos, 0.0, sin, 0.0];
        let (q, u) = two([0.0, 0.1, 0.0, 1.0, 0.0, 0.0, 0.0], upper, [0.0; 2]);
        let mut simulation = start(&crates, &q, &u, surface(0.5, 0.0, Law::Newton));
        run(&mut simulation, 0.1);
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        assert!(u.iter().all(|u| u.abs() < 1e-10), "{what}: {u:?}");
        assert!((q[8] - 0.3).abs() < 1e-12, "{what}: {q:?}");
        let closed =
            |contact: &usize| simulation.phase(*contact).is_some_and(|phase| phase != ContactPhase::Open);
        let closed: Vec<usize> = (16..68).filter(closed).map(|contact| contact - 15).collect();
        match wanted {
            Some(wanted) => assert_eq!(closed, wanted, "{what}"),
            None => assert!(closed.len() == 8 && closed[0] > 16, "{what}: {closed:?}"),
        }
    }
}

/// Bodies that overlap are no start, however deep one is in the other: not at one place, where all coordinates are left
/// at zero, not one within the other, and not bars across each other of which no vertex is within the other.
#[test]
fn bodies_that_overlap_are_refused() {
    let refused = |body: &dyn Contacts<f64>, q: &[f64], what: &str| {
        let u = vec![0.0; body.count(ComponentKind::Speed)];
        let state = State { time: 0.0, coordinates: q, speeds: &u, inputs: &[] };
        let begun = Simulation::new(body, &state, surface(0.3, 0.0, Law::Newton));
        let error = begun.and_then(|mut simulation| simulation.advance(0.1).map(|_| ())).err();
        let kind = error.as_ref().map(|error| &error.kind);
        assert!(matches!(kind, Some(ErrorKind::Overlap(gap)) if *gap < -1e-4), "{what}: {error:?}");
    };
    let (blocks, crates) = (model("two_blocks"), model("two_crates"));
    let long = [("lower_a", 1.0), ("lower_c", 0.1), ("upper_a", 1.0), ("upper_c", 0.1)];
    let bars = with_parameters(&crates, &long);
    let at =
        |place: [f64; 3], turn: [f64; 4]| [&[0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0][..], &place, &turn].concat();
    refused(&crates, &at([0.0, 0.5, 0.0], [1.0, 0.0, 0.0, 0.0]), "one place");
    refused(&bars, &at([0.0, 0.5, 0.0], [0.5_f64.cos(), 0.0, 0.5_f64.sin(), 0.0]), "a cross");
    let mut random = Random::new(0x0e11_a950_0000_0007);
    for _ in 0..300 {
        // the middle of one within the other: half of its least extent
        let mut place = || random.between(-0.05, 0.05);
        let (x, y, z) = (place(), place(), place());
        let mut turn: [f64; 4] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        let size = turn.iter().map(|e| e * e).sum::<f64>().sqrt();
        turn.iter_mut().for_each(|e| *e /= size);
        for body in [&crates, &bars] {
            refused(body, &at([x, 0.5 + 0.9 * y, 0.9 * z], turn), "in space");
        }
        refused(&blocks, &[0.0, 0.5, 0.0, x, 0.5 + y, 7.0 * z], "in a plane");
    }
}

/// Without friction no contact passes on a push along its plane: the upper block tips over the edge of the lower
/// one and pushes it away, and the momentum along the floor stays what it was. The lower block was held, as if
/// it stuck.
#[test]
fn blocks_without_friction_keep_their_momentum_along_the_floor() {
    let blocks = model("two_blocks");
    let (q, u) = ([0.0, 0.1, 0.0, 0.0, 0.3, 0.0], [0.0, 0.0, 0.0, 0.5, 0.0, 0.0]);
    let mut simulation = start(&blocks, &q, &u, surface(0.0, 0.0, Law::Newton));
    let momentum = |u: &[f64]| 300.0 * (0.5 * 0.2 * 0.4 * u[0] + 0.3 * 0.2 * 0.24 * u[3]);
    let first = momentum(&u);
    for step in 1..=60 {
        run(&mut simulation, 0.02 * f64::from(step));
        let now = momentum(simulation.speeds());
        assert!((now - first).abs() < 1e-9 * first, "{step}: {now} of {first}");
    }
    assert!(simulation.speeds()[0].abs() > 0.01, "{:?}", simulation.speeds());
}

/// What two boxes do that move in a plane two rectangles do: the upper crate slides off the lower one, tips over its
/// edge and falls to the floor; a domino knocks over the next.
#[test]
fn crates_that_move_in_a_plane_do_what_rectangles_do() {
    let domino = |x: f64| [x, 0.025, 0.0, 1.0, 0.0, 0.0, 0.0];
    let sides = [("lower_a", 0.008), ("lower_b", 0.05), ("upper_a", 0.008), ("upper_b", 0.05)];
    let depths = [("lower_c", 0.02), ("upper_c", 0.02)];
    let slides = two([0.0, 0.1, 0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 0.3, 0.0, 1.0, 0.0, 0.0, 0.0], [0.5, 0.0]);
    let falls = two(domino(0.02), domino(0.0), [0.1, -4.0]);
    for (what, (q, u), changes, mu, until) in [
        ("slides off", slides, Vec::new(), 0.05, 1.1),
        ("dominoes", falls, [&sides[..], &depths].concat(), 0.2, 0.14),
    ] {
        let (crates, blocks) = (
            with_parameters(&model("two_crates"), &changes),
            with_parameters(&model("two_blocks"), &changes),
        );
        let options = || surface(mu, 0.0, Law::Newton);
        let mut in_space = start(&crates, &q, &u, options());
        let flat = |all: &[f64], places: [usize; 6]| places.map(|place| all[place]);
        let mut in_plane =
            start(&blocks, &flat(&q, [0, 1, 2, 7, 8, 9]), &flat(&u, [0, 1, 5, 6, 7, 11]), options());
        let mut worst = 0.0_f64;
        for step in 1..=40 {
            let time = until * f64::from(step) / 40.0;
            run(&mut in_space, time);
            run(&mut in_plane, time);
            let (q, u) = (in_space.coordinates(), in_space.speeds());
            let angle = |at: usize| 2.0 * q[at + 6].atan2(q[at + 3]);
            let found = [q[0], q[1], angle(0), q[7], q[8], angle(7), u[0], u[1], u[5], u[6], u[7], u[11]];
            let wanted = [in_plane.coordinates(), in_plane.speeds()].concat();
            let off = found.iter().zip(&wanted).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
            assert!(off < 1e-9, "{what} at {time}: {off:e} {found:?} {wanted:?}");
            worst = worst.max(off);
        }
        println!("{what}: {worst:.1e} between space and plane, {:?}", &in_plane.coordinates()[3..6]);
        assert!(in_plane.coordinates()[5] < -0.1, "it has not turned");
    }
}
