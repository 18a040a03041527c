//! Bodies that come to the end of a face: a block that tips over a ledge, a ball that rolls off it.

use crate::common::{first, names, run, start, surface};
use ball_on_ledge::BallOnLedge;
use block_on_ledge::BlockOnLedge;
use hodograph::Law;
use hodograph_simulation::{ContactPhase, Event, EventKind, Simulation};

hodograph::mechanism!("tests/models/ball_on_ledge.mech");
hodograph::mechanism!("tests/models/block_on_ledge.mech");

pub const G: f64 = 9.81;
const MASS: f64 = 2.0;
/// Width and height of the block.
const SIDES: [f64; 2] = [0.3, 0.2];

/// The numbers of the contacts of the ledge: lower vertices of the block, and the ledge's edge.
const LEADING: usize = 2;
const TRAILING: usize = 3;
const EDGE: usize = 4;

/// Rates of a block that slides without friction on the edge of the ledge, at O: x, y, q and their rates; and the
/// force. The lower side stays on the edge: n . G = height / 2, with n normal to the side.
fn on_the_edge(s: &[f64; 6]) -> ([f64; 6], f64) {
    let [x, y, q, vx, vy, w] = *s;
    let (sin, cos) = q.sin_cos();
    let inertia = MASS * (SIDES[0].powi(2) + SIDES[1].powi(2)) / 12.0;
    let (along, above) = (x * cos + y * sin, y * cos - x * sin);
    let slip = vx * cos + vy * sin;
    let force = (G * cos + 2.0 * w * slip + w * w * above) / (1.0 / MASS + along * along / inertia);
    ([vx, vy, w, -force * sin / MASS, force * cos / MASS - G, -force * along / inertia], force)
}

/// Runge and Kutta's method of order four.
pub fn integrate(mut s: [f64; 6], time: f64, steps: usize) -> [f64; 6] {
    let h = time / steps as f64;
    let moved = |s: &[f64; 6], k: &[f64; 6], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
    for _ in 0..steps {
        let a = on_the_edge(&s).0;
        let b = on_the_edge(&moved(&s, &a, 0.5 * h)).0;
        let c = on_the_edge(&moved(&s, &b, 0.5 * h)).0;
        let d = on_the_edge(&moved(&s, &c, h)).0;
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    s
}

fn state(simulation: &Simulation<'_>) -> [f64; 6] {
    let (q, u) = (simulation.coordinates(), simulation.speeds());
    [q[0], q[1], q[2], u[0], u[1], u[2]]
}

/// Without friction the block goes on as it is until its mass centre is over the edge; then it tips, and slides on the
/// edge, until the edge no longer presses.
#[test]
fn a_block_tips_when_its_mass_centre_passes_the_edge() {
    let block = BlockOnLedge::<f64>::default();
    let speed = 0.5;
    let free = surface(0.0, 0.0, Law::Newton);
    let mut simulation = start(&block, &[-0.5, 0.1, 0.0], &[speed, 0.0, 0.0], free.clone());
    let events = run(&mut simulation, 1.1);
    let (reached, tips) = ((0.5 - 0.5 * SIDES[0]) / speed, 0.5 / speed);
    // the edge comes under the block as its leading vertex leaves the ledge; neither is struck
    let story: Vec<(&str, Option<usize>)> =
        events.iter().map(|event| (event.kind.name(), event.contact)).collect();
    assert_eq!(
        story,
        [
            ("contact", Some(LEADING)),
            ("contact", Some(TRAILING)),
            ("lift_off", Some(LEADING)),
            ("contact", Some(EDGE)),
            ("lift_off", Some(TRAILING)),
        ],
        "{:?}",
        names(&events)
    );
    for (event, time, bound) in
        [(&events[2], reached, 1e-7), (&events[3], reached, 1e-7), (&events[4], tips, 1e-10)]
    {
        assert!((event.time - time).abs() < bound, "{:?} {time}", names(&events));
    }
    let begin = [0.0, 0.1, 0.0, speed, 0.0, 0.0];
    let expected = integrate(begin, 1.1 - tips, 4000);
    let found = state(&simulation);
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() < 1e-9, "{found:?} {expected:?}");
    }
    // the edge lets go where its force vanishes
    let events = run(&mut simulation, 1.5);
    let last = events.iter().find(|event| event.contact == Some(EDGE)).unwrap();
    assert!(matches!(last.kind, EventKind::LiftOff { .. }), "{:?}", names(&events));
    let there = integrate(begin, last.time - tips, 4000);
    assert!(there[2] < -0.3 && on_the_edge(&there).1.abs() < 1e-7, "{there:?}");
}

/// A fast block leaves the ledge where its side ends, while the edge still presses: the trailing vertex passes the corner of
/// the ledge.
#[test]
fn a_fast_block_leaves_where_its_side_ends() {
    let block = BlockOnLedge::<f64>::default();
    for speed in [1.4, 2.0, 2.5, 3.0, 5.0, 8.0] {
        let mut simulation =
            start(&block, &[-0.5, 0.1, 0.0], &[speed, 0.0, 0.0], surface(0.0, 0.0, Law::Newton));
        let events = run(&mut simulation, 1.0);
        let leaves =
            |event: &&Event| event.contact == Some(EDGE) && matches!(event.kind, EventKind::LiftOff { .. });
        let last = events.iter().find(leaves).unwrap_or_else(|| panic!("{speed}: {:?}", names(&events)));
        let tips = 0.5 / speed;
        let there = integrate([0.0, 0.1, 0.0, speed, 0.0, 0.0], last.time - tips, 4000);
        let (sin, cos) = there[2].sin_cos();
        let along = there[0] * cos + there[1] * sin;
        let force = on_the_edge(&there).1;
        assert!((along - 0.5 * SIDES[0]).abs() < 1e-7 && force > 0.5, "{speed}: {along} {force}");
    }
}

/// With friction a block whose mass centre hangs over turns about the edge. It falls to the floor, comes to rest
/// there, and never gains energy.
#[test]
fn a_block_that_hangs_over_turns_about_the_edge() {
    let block = BlockOnLedge::<f64>::default();
    let over = 0.02;
    let rough = surface(0.9, 0.0, Law::Newton);
    let mut simulation = start(&block, &[over, 0.1, 0.0], &[0.0; 3], rough.clone());
    run(&mut simulation, 0.15);
    assert_eq!(simulation.phase(EDGE), Some(ContactPhase::Stick));
    let [x, y, _, _, _, w] = state(&simulation);
    let radius = over * over + 0.01;
    let inertia = MASS * ((SIDES[0].powi(2) + SIDES[1].powi(2)) / 12.0 + radius);
    assert!((x * x + y * y - radius).abs() < 1e-12, "{x} {y}");
    assert!((0.5 * inertia * w * w - MASS * G * (0.1 - y)).abs() < 1e-10 && w < -0.1, "{w}");
    let mut before = simulation.energy().unwrap();
    for step in 16..400 {
        run(&mut simulation, 0.01 * f64::from(step));
        let now = simulation.energy().unwrap();
        let sum = |energy: &hodograph_simulation::EnergyAccount| energy.kinetic + energy.potential.unwrap();
        assert!(sum(&now) < sum(&before) + 1e-9, "{step}: {now:?} {before:?}");
        before = now;
    }
    assert!(simulation.is_at_rest(), "{:?}", state(&simulation));
    let turned = simulation.coordinates()[2] / std::f64::consts::FRAC_PI_2;
    assert!((turned - turned.round()).abs() < 1e-9, "{turned}");
}

/// A ball that slides without friction leaves the edge where its speed carries it off, v^2 = g r cos(theta): with
/// v^2 = v0^2 + 2 g r (1 - cos(theta)) at cos(theta) = 2/3 + v0^2 / (3 g r).
#[test]
fn a_ball_slides_off_the_edge() {
    let ball = BallOnLedge::<f64>::default();
    let (r, v0) = (0.1, 0.3_f64);
    let mut simulation = start(&ball, &[-0.2, r, 0.0], &[v0, 0.0, 0.0], surface(0.0, 0.0, Law::Newton));
    let events = run(&mut simulation, 3.0);
    let leaves = first(&events, "lift_off");
    let cos = 2.0 / 3.0 + v0 * v0 / (3.0 * G * r);
    assert!((leaves.coordinates[1] / r - cos).abs() < 1e-9, "{:?}", names(&events));
    assert!((leaves.coordinates[0].hypot(leaves.coordinates[1]) - r).abs() < 1e-12);
    let speed = |angle: f64| (v0 * v0 + 2.0 * G * r * (1.0 - angle.cos())).sqrt();
    let time = 0.2 / v0 + simpson(|angle| r / speed(angle), cos.acos());
    assert!((leaves.time - time).abs() < 1e-9, "{} {time}", leaves.time);
}

/// A ball that rolls on the face rolls over the edge, v^2 = v0^2 + 10/7 g r (1 - cos(theta)), until its friction
/// 2/7 m g sin(theta) exceeds mu (m g cos(theta) - m v^2 / r).
#[test]
fn a_ball_rolls_over_the_edge() {
    let ball = BallOnLedge::<f64>::default();
    let (r, v0, mu) = (0.1, 0.25_f64, 0.6);
    let mut simulation = start(&ball, &[-0.2, r, 0.0], &[v0, 0.0, -v0 / r], surface(mu, 0.0, Law::Newton));
    let events = run(&mut simulation, 3.0);
    let slips = first(&events, "slip");
    let square = |angle: f64| v0 * v0 + 10.0 / 7.0 * G * r * (1.0 - angle.cos());
    let lacks = |angle: f64| 2.0 / 7.0 * G * angle.sin() - mu * (G * angle.cos() - square(angle) / r);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if lacks(middle) < 0.0 { low = middle } else { high = middle }
    }
    let angle = slips.coordinates[0].atan2(slips.coordinates[1]);
    assert!((angle - low).abs() < 1e-8, "{angle} {low} {:?}", names(&events));
    let time = 0.2 / v0 + simpson(|angle| r / square(angle).sqrt(), low);
    assert!((slips.time - time).abs() < 1e-8, "{} {time}", slips.time);
    // without slip it has turned by the way on the face over r, and by the angle about the edge
    assert!((slips.coordinates[2] + 0.2 / r + angle).abs() < 1e-8, "{:?}", slips.coordinates);
}

/// The integral from 0 to `end`.
fn simpson(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    let n = 2000;
    let h = end / f64::from(n);
    let weight = |i: i32| if i == 0 || i == n { 1.0 } else { 4.0 - 2.0 * f64::from(1 - i % 2) };
    (0..=n).map(|i| weight(i) * f(f64::from(i) * h)).sum::<f64>() * h / 3.0
}
