//! Periodic motions whose multipliers are known in closed form.

use hodograph::{Law, Mechanism, State};
use hodograph_gradients::{By, ChangeKind, OrbitError, Periodic, Return, find_orbit, follow_branch};
use nalgebra::DMatrix;

use crate::common::{options, read};

/// A rimless wheel: with eta = (J + m l^2 cos 2 alpha) / (J + m l^2) the rate after a step follows from that before by
/// w'^2 = eta^2 (w^2 + K), K = 4 m g l sin(gamma) sin(alpha) / (J + m l^2); so w^2 = eta^2 K / (1 - eta^2), and the
/// multiplier is eta^2.
#[test]
fn a_rimless_wheel_rolls_downhill() {
    let mechanism = read("rimless_wheel.mech");
    let (l, alpha, gamma, inertia, g) = (1.0_f64, std::f64::consts::PI / 8.0, 0.08_f64, 0.1, 9.81);
    let about_foot = inertia + l * l;
    let eta = (inertia + l * l * (2.0 * alpha).cos()) / about_foot;
    let k = 4.0 * g * l * gamma.sin() * alpha.sin() / about_foot;
    let w = (eta * eta * k / (1.0 - eta * eta)).sqrt();
    // It stands on its first spoke, which is ahead of the hub.
    let rate = 1.2 * w;
    let (q, u) = ([0.0, l * alpha.cos(), -alpha], [l * rate * alpha.cos(), l * rate * alpha.sin(), rate]);
    let start = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    let returns = Return::At { event: "collision".to_owned(), contact: Some(1), count: 1 };
    let periodic = Periodic { returns, reset: vec![0, 1, 2], longest: 5.0 };
    let by = [By::Parameter(4)];
    let orbit = find_orbit(&mechanism, &start, &options(2.0, 0.0, Law::Poisson), &periodic, &by).unwrap();
    assert!((orbit.state[5] - w).abs() < 1e-11, "{} instead of {w}", orbit.state[5]);
    assert!((orbit.multipliers[0].re - eta * eta).abs() < 1e-11, "{:?}", orbit.multipliers);
    assert!(orbit.multipliers[1..].iter().all(|other| other.norm() < 1e-11), "{:?}", orbit.multipliers);
    assert!(orbit.is_stable() && orbit.residual < 1e-13);
    // By the slope: d(w'^2) = eta^2 dK.
    let exact = eta * eta * k / gamma.tan() / (2.0 * w);
    assert!((orbit.by[(5, 0)] - exact).abs() < 1e-11 * exact, "{} {exact}", orbit.by[(5, 0)]);
}

/// A passive walker with feet of radius r, whose middles are at rho = l - r from the hub. With the hub at (B, A) from the
/// contact that ends, A = r + rho cos(alpha), B = rho sin(alpha), and at (-B, A) from the one that begins,
/// eta = (J + m (A^2 - B^2)) / (J + m (A^2 + B^2)); a step leads 2 (r alpha + B) downhill. The multiplier is eta^2.
#[test]
fn a_walker_with_curved_feet() {
    let mechanism = read("passive_walker.mech");
    let (l, r, alpha, gamma) = (1.0_f64, 0.3, std::f64::consts::PI / 8.0, 0.04_f64);
    let (inertia, g) = (0.1, 9.81);
    let (a, b) = (r + (l - r) * alpha.cos(), (l - r) * alpha.sin());
    let about_contact = inertia + a * a + b * b;
    let eta = (inertia + a * a - b * b) / about_contact;
    let k = 4.0 * g * gamma.sin() * (r * alpha + b) / about_contact;
    let w = (eta * eta * k / (1.0 - eta * eta)).sqrt();
    let rate = 1.1 * w;
    let (q, u) = ([0.0, a, -alpha], [rate * a, rate * b, rate]);
    let start = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    let returns = Return::At { event: "collision".to_owned(), contact: Some(1), count: 1 };
    let periodic = Periodic { returns, reset: vec![0, 1, 2], longest: 5.0 };
    let by = [By::Parameter(5)];
    let orbit = find_orbit(&mechanism, &start, &options(2.0, 0.0, Law::Poisson), &periodic, &by).unwrap();
    assert!((orbit.state[5] - w).abs() < 1e-11, "{} instead of {w}", orbit.state[5]);
    assert!((orbit.multipliers[0].re - eta * eta).abs() < 1e-11, "{:?}", orbit.multipliers);
    assert!(orbit.multipliers[1..].iter().all(|other| other.norm() < 1e-11), "{:?}", orbit.multipliers);
    assert!(orbit.is_stable() && orbit.residual < 1e-13);
    let exact = eta * eta * k / gamma.tan() / (2.0 * w);
    assert!((orbit.by[(5, 0)] - exact).abs() < 1e-11 * exact, "{} {exact}", orbit.by[(5, 0)]);
}

/// What a ball and the plate are at the locked motion with the period T = 2 pi / w: it strikes at the phase phi with
/// a w cos phi = (g T / 2) (1 - e) / (1 + e); trace 1 + e^2 - (1 + e)^2 a w^2 sin(phi) / g, determinant e^2.
struct Locked {
    g: f64,
    w: f64,
    e: f64,
}

impl Locked {
    fn plate(&self) -> f64 {
        std::f64::consts::PI * self.g / self.w * (1.0 - self.e) / (1.0 + self.e)
    }

    fn phase(&self, a: f64) -> f64 {
        (self.plate() / (a * self.w)).acos()
    }

    fn trace(&self, a: f64) -> f64 {
        let Self { g, w, e } = *self;
        1.0 + e * e - (1.0 + e).powi(2) * a * w * w * self.phase(a).sin() / g
    }

    /// The state at the time [`START`], in flight.
    fn start(&self, a: f64) -> [f64; 2] {
        let period = 2.0 * std::f64::consts::PI / self.w;
        let since = START - self.phase(a) / self.w;
        let v = 0.5 * self.g * period;
        [a * self.phase(a).sin() + v * since - 0.5 * self.g * since * since, v - self.g * since]
    }
}

/// When the motion is looked at, s.
const START: f64 = 0.05;
const LOCKED: Locked = Locked { g: 9.81, w: 60.0, e: 0.7 };

fn periodic() -> Periodic {
    Periodic {
        returns: Return::After(2.0 * std::f64::consts::PI / LOCKED.w),
        reset: Vec::new(),
        longest: 1.0,
    }
}

#[test]
fn a_ball_is_locked_to_a_plate() {
    let mechanism = read("ball_on_plate.mech");
    let a = 0.002;
    let exact = LOCKED.start(a);
    let (q, u) = ([exact[0] + 2e-4], [exact[1] - 5e-3]);
    let start = State { time: START, coordinates: &q, speeds: &u, inputs: &[] };
    let options = options(0.0, LOCKED.e, Law::Newton);
    let orbit = find_orbit(&mechanism, &start, &options, &periodic(), &[]).unwrap();
    assert!((orbit.state[0] - exact[0]).abs() < 1e-14 && (orbit.state[1] - exact[1]).abs() < 1e-12);
    let (first, second) = (orbit.multipliers[0], orbit.multipliers[1]);
    assert!(((first * second).re - LOCKED.e.powi(2)).abs() < 1e-11, "{:?}", orbit.multipliers);
    assert!(((first + second).re - LOCKED.trace(a)).abs() < 1e-11, "{:?}", orbit.multipliers);
    assert!(orbit.events.len() == 1 && orbit.is_stable());
    // The same matrix by differences of the motion.
    let end = |state: [f64; 2]| {
        let start = State { time: START, coordinates: &state[..1], speeds: &state[1..], inputs: &[] };
        let mut simulation =
            hodograph_simulation::Simulation::new(&mechanism, &start, options.clone()).unwrap();
        simulation.advance_to(START + orbit.period).unwrap();
        [simulation.coordinates()[0], simulation.speeds()[0]]
    };
    let difference = DMatrix::from_fn(2, 2, |row, column| {
        let h = [1e-5, 1e-3][column];
        let moved = |h: f64| {
            let mut state = exact;
            state[column] += h;
            end(state)[row]
        };
        (8.0 * (moved(h) - moved(-h)) - (moved(2.0 * h) - moved(-2.0 * h))) / (12.0 * h)
    });
    assert!((&orbit.matrix - &difference).amax() < 1e-7 * difference.amax(), "{}{difference}", orbit.matrix);
}

/// With a greater amplitude the locked motion doubles its period at the trace -(1 + e^2); with a lesser one it turns back
/// where it strikes at the greatest speed of the plate.
#[test]
fn the_branch_of_a_locked_ball_doubles_and_turns_back() {
    let mechanism = read("ball_on_plate.mech");
    let Locked { g, w, e } = LOCKED;
    let a = 0.002;
    let exact = LOCKED.start(a);
    let (q, u) = ([exact[0]], [exact[1]]);
    let start = State { time: START, coordinates: &q, speeds: &u, inputs: &[] };
    let options = options(0.0, e, Law::Newton);
    let amplitude = By::named(&mechanism, "a").unwrap();
    let up = follow_branch(&mechanism, &start, &options, &periodic(), (amplitude, a, 0.004), 200).unwrap();
    let doubling: f64 = 2.0 * g * (1.0 + e * e) / ((1.0 + e).powi(2) * w * w);
    let at = doubling.hypot(LOCKED.plate() / w);
    assert_eq!(up.changes.len(), 1, "{:?}", up.changes);
    let change = &up.changes[0];
    assert_eq!(change.kind, ChangeKind::PeriodDoubling);
    assert!((change.at.value - at).abs() < 1e-11, "{} instead of {at}", change.at.value);
    let least = change.at.orbit.multipliers.iter().map(|m| m.re).fold(0.0, f64::min);
    assert!((least + 1.0).abs() < 1e-9, "{:?}", change.at.orbit.multipliers);
    assert!(up.ended.is_none() && up.points.last().unwrap().value > 0.004);
    for point in &up.points {
        assert_eq!(point.orbit.is_stable(), point.value < at, "at {}", point.value);
    }
    let down = follow_branch(&mechanism, &start, &options, &periodic(), (amplitude, a, 0.001), 60).unwrap();
    let fold = down.changes.iter().find(|change| change.kind == ChangeKind::Fold).unwrap();
    let at = LOCKED.plate() / w;
    assert!((fold.at.value - at).abs() < 1e-10, "{} instead of {at}", fold.at.value);
    assert!((fold.at.orbit.multipliers[0].re - 1.0).abs() < 1e-5, "{:?}", fold.at.orbit.multipliers);
}

#[test]
fn motions_that_do_not_return_say_so() {
    let mut mechanism = read("ball_on_plate.mech");
    mechanism.set_parameter_values(&[1.0, 9.81, 0.0, 60.0]).unwrap();
    let start = State { time: 0.0, coordinates: &[0.1], speeds: &[0.0], inputs: &[] };
    let options = options(0.0, 0.5, Law::Newton);
    // Without the plate's motion the ball loses energy: what is periodic is rest, which has no derivative.
    let found = find_orbit(&mechanism, &start, &options, &periodic(), &[]);
    assert!(matches!(found, Err(OrbitError::NotFound(_))), "{found:?}");
    let returns = Return::At { event: "stick".to_owned(), contact: None, count: 9 };
    let never = Periodic { returns, reset: Vec::new(), longest: 0.3 };
    let found = find_orbit(&mechanism, &start, &options, &never, &[]);
    assert!(matches!(found, Err(OrbitError::NoReturn(_))), "{found:?}");
}
