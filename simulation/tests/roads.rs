//! Contacts that solve an equation: wheels and balls on roads and waves, and ellipsoids on each other (docs/theory.md,
//! 16.13).

use crate::common::{run, start, surface};
use crate::many::{model, with_parameters};
use hodograph::Law;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{EventKind, Progress, Simulation};

const G: f64 = 9.81;

/// A model of the gallery.
fn shipped(name: &str) -> InterpretedMechanism {
    let path = format!("{}/../models/{name}.mech", env!("CARGO_MANIFEST_DIR"));
    InterpretedMechanism::read(path.as_ref()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A road y = h sin(k x), with its slope and second derivative.
fn road(h: f64, k: f64, x: f64) -> [f64; 3] {
    let (sin, cos) = (k * x).sin_cos();
    [h * sin, h * k * cos, -h * k * k * sin]
}

/// A wheel on it: the place x of contact and the speed v of its middle, whose path has the length
/// a dx = (s - r h''/s^2) dx with s^2 = 1 + h'^2. `heavy` is the share of the weight that drives it: m/(m + J/r^2).
struct Wheel {
    radius: f64,
    height: f64,
    number: f64,
    heavy: f64,
}

impl Wheel {
    fn rates(&self, [x, v]: [f64; 2]) -> [f64; 2] {
        let [_, slope, bend] = road(self.height, self.number, x);
        let s = slope.hypot(1.0);
        [v / (s - self.radius * bend / (s * s)), -self.heavy * G * slope / s]
    }

    fn middle(&self, x: f64) -> [f64; 2] {
        let [level, slope, _] = road(self.height, self.number, x);
        let s = slope.hypot(1.0);
        [x - self.radius * slope / s, level + self.radius / s]
    }

    /// By Runge and Kutta's method of order four.
    fn after(&self, mut state: [f64; 2], time: f64) -> [f64; 2] {
        let steps = 20_000;
        let h = time / f64::from(steps);
        let moved = |s: [f64; 2], k: [f64; 2], h: f64| [s[0] + h * k[0], s[1] + h * k[1]];
        for _ in 0..steps {
            let a = self.rates(state);
            let b = self.rates(moved(state, a, 0.5 * h));
            let c = self.rates(moved(state, b, 0.5 * h));
            let d = self.rates(moved(state, c, h));
            state = [0, 1].map(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        state
    }
}

/// Where the middle of a wheel is, and its speeds, beside the wheel on its path.
fn compare(simulation: &mut Simulation<'_>, wheel: &Wheel, start: [f64; 2], axes: [usize; 2], limit: f64) {
    for step in 1..=6 {
        let time = 0.3 * f64::from(step);
        let events = run(simulation, time);
        let state = wheel.after(start, time);
        let middle = wheel.middle(state[0]);
        for i in [0, 1] {
            let found = simulation.coordinates()[axes[i]];
            assert!((found - middle[i]).abs() < limit, "{time}: {found} {} {events:?}", middle[i]);
        }
        let speeds = axes.map(|axis| simulation.speeds()[axis]);
        let speed = speeds[0].hypot(speeds[1]);
        assert!((speed - state[1].abs()).abs() < limit, "{time}: {speed} {}", state[1]);
    }
}

/// From rest on a slope, through the hollow and back, without friction and rolling.
#[test]
fn a_wheel_on_a_road_keeps_to_its_path() {
    let machine = model("ball_on_road");
    for (mu, heavy) in [(0.0, 1.0), (0.9, 2.0 / (2.0 + 0.03 / 0.04))] {
        let wheel = Wheel { radius: 0.2, height: 0.1, number: 3.0, heavy };
        let [x, y] = wheel.middle(0.1);
        let mut simulation = start(&machine, &[x, y, 0.0], &[0.0; 3], surface(mu, 0.0, Law::Newton));
        compare(&mut simulation, &wheel, [0.1, 0.0], [0, 1], 1e-9);
        assert!(simulation.phase(0).is_some());
    }
}

/// A wheel that rolls into a hollow narrower than itself comes to its other side: that is an error, and it is not in the
/// ground there.
#[test]
fn a_wheel_that_does_not_fit_into_a_hollow_is_refused() {
    let (radius, height, number) = (0.6, 0.1, 6.0);
    let machine = with_parameters(&model("ball_on_road"), &[("r", radius), ("h", height), ("k", number)]);
    let wheel = Wheel { radius, height, number, heavy: 1.0 };
    for mu in [0.0, 0.9] {
        // just beyond a crest: the hollow is to the right of it
        let [x, y] = wheel.middle(std::f64::consts::FRAC_PI_2 / number + 0.03);
        let mut simulation = start(&machine, &[x, y, 0.0], &[0.2, 0.0, 0.0], surface(mu, 0.0, Law::Newton));
        let error = loop {
            match simulation.advance(5.0) {
                Ok(Progress::Event(_)) => {}
                Ok(Progress::Reached) => panic!("it rolls on: {:?}", simulation.coordinates()),
                Err(error) => break error.to_string(),
            }
        };
        let [x, y] = [0, 1].map(|i| simulation.coordinates()[i]);
        let highest = (-1000..=1000)
            .map(|i| 1e-3 * radius * f64::from(i))
            .map(|a| road(height, number, x + a)[0] + (radius * radius - a * a).sqrt())
            .fold(f64::NEG_INFINITY, f64::max);
        println!("{error}, at {x} {y}, {:.1e} of the radius in the ground", (highest - y) / radius);
        assert!((highest - y) / radius < 5e-3, "{highest} {y}");
    }
}

/// A ball over waves that do not change across its way.
#[test]
fn a_ball_on_waves_rolls_as_a_wheel_does() {
    let machine = shipped("shapes/ball_on_waves");
    for (mu, heavy) in [(0.0, 1.0), (2.0, 5.0 / 7.0)] {
        let wheel = Wheel { radius: 0.15, height: 0.1, number: 4.0, heavy };
        let [x, z] = wheel.middle(0.2);
        let q = [x, 0.0, z, 1.0, 0.0, 0.0, 0.0];
        let mut simulation = start(&machine, &q, &[0.0; 6], surface(mu, 0.0, Law::Newton));
        compare(&mut simulation, &wheel, [0.2, 0.0], [0, 2], 1e-9);
    }
}

/// A ball that slides down from a ball without friction leaves it where the cosine of its angle is 2/3 of that at its start,
/// from rest; and so do ellipsoids whose semi-axes are equal.
#[test]
fn ellipsoids_that_are_balls_leave_each_other_where_balls_do() {
    let (r, large) = (0.05, 0.3);
    let machine = with_parameters(&model("egg_on_egg"), &[("a", r), ("b", r), ("c", large), ("d", large)]);
    let angle = 0.2_f64;
    let q = [(r + large) * angle.sin(), 0.0, (r + large) * angle.cos(), 1.0, 0.0, 0.0, 0.0];
    let mut simulation = start(&machine, &q, &[0.0; 6], surface(0.0, 0.0, Law::Newton));
    let events = run(&mut simulation, 1.0);
    let left =
        events.iter().find(|event| matches!(event.kind, EventKind::LiftOff { .. })).expect("it leaves");
    let before = left.time;
    let mut simulation = start(&machine, &q, &[0.0; 6], surface(0.0, 0.0, Law::Newton));
    run(&mut simulation, before);
    let cosine = simulation.coordinates()[2] / (r + large);
    assert!((cosine - 2.0 / 3.0 * angle.cos()).abs() < 1e-9, "{cosine}");
}

/// An egg that is thrown on a rock keeps its account of energy, whatever it does.
#[test]
fn eggs_on_a_rock_keep_their_energy() {
    let machine = model("egg_on_egg");
    let mut events = 0;
    for throw in 0..20 {
        let turn = 0.3 * f64::from(throw);
        let q = [0.01 * turn, 0.02, 0.5, turn.cos(), turn.sin() * 0.6, turn.sin() * 0.8, 0.0];
        let u = [0.2 * turn.sin(), 0.0, 0.0, 3.0 * turn.cos(), 5.0, 1.0];
        let mut simulation = start(&machine, &q, &u, surface(0.6, 0.4, Law::Poisson));
        let unworked = |simulation: &Simulation<'_>| {
            let account = simulation.energy().unwrap();
            account.total().unwrap() - account.friction - account.impacts - account.inputs
        };
        let before = unworked(&simulation);
        events += run(&mut simulation, 0.6).len();
        let off = unworked(&simulation) - before;
        assert!(off.abs() < 1e-10, "{throw}: {off:e}");
    }
    println!("20 throws with {events} events");
    assert!(events > 40);
}
