//! Periodic motions whose multipliers are known in closed form.

use hodograph::{Law, Mechanism, State};
use hodograph_gradients::{
    By, ChangeKind, Exchange, OrbitError, Periodic, Return, find_orbit, follow_branch,
};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use nalgebra::DMatrix;

use compass::Compass;

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
    let periodic =
        Periodic { returns, reset: vec![0, 1, 2], symmetry: Vec::new(), longest: 5.0, segments: 1 };
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
    let periodic =
        Periodic { returns, reset: vec![0, 1, 2], symmetry: Vec::new(), longest: 5.0, segments: 1 };
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
        symmetry: Vec::new(),
        longest: 1.0,
        segments: 1,
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
    assert!(up.ended.is_none() && up.points.last().unwrap().value == 0.004);
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
    let never = Periodic { returns, reset: Vec::new(), symmetry: Vec::new(), longest: 0.3, segments: 1 };
    let found = find_orbit(&mechanism, &start, &options, &never, &[]);
    assert!(matches!(found, Err(OrbitError::NoReturn(_))), "{found:?}");
}

/// The compass by the equations of its two angles alone: of the leg that stands and of the one that swings, from the
/// vertical, as Goswami, Espiau and Keramane give them. One step from the state just after an impact.
mod compass {
    use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

    /// The parameters of the model, in its order.
    #[derive(Clone, Copy)]
    pub struct Compass {
        pub mh: f64,
        pub m: f64,
        pub a: f64,
        pub b: f64,
        pub g: f64,
        pub gamma: f64,
    }

    /// Angles of standing and swinging leg from the normal of the incline, positive with the hips ahead of the foot, and
    /// their rates.
    type State = [f64; 4];

    impl Compass {
        fn rates(&self, y: &State) -> State {
            let Compass { mh, m, a, b, g, gamma } = *self;
            let l = a + b;
            let [s, w, us, uw] = *y;
            let (sine, cosine) = (s - w).sin_cos();
            // The hips move on a circle about the standing foot; the swinging leg hangs from them.
            let mass = Matrix2::new(
                mh * l * l + m * (a * a + l * l),
                -m * l * b * cosine,
                -m * l * b * cosine,
                m * b * b,
            );
            let coupling = m * l * b * sine;
            let gravity = Vector2::new(
                (mh * l + m * a + m * l) * g * (s + gamma).sin(),
                -m * b * g * (w + gamma).sin(),
            );
            let right = Vector2::new(coupling * uw * uw, -coupling * us * us) + gravity;
            let u = mass.lu().solve(&right).unwrap();
            [us, uw, u[0], u[1]]
        }

        fn step(&self, y: &State, h: f64) -> State {
            let add = |a: &State, b: &State, h: f64| -> State { std::array::from_fn(|i| a[i] + h * b[i]) };
            let k1 = self.rates(y);
            let k2 = self.rates(&add(y, &k1, h / 2.0));
            let k3 = self.rates(&add(y, &k2, h / 2.0));
            let k4 = self.rates(&add(y, &k3, h));
            std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
        }

        /// The angular momentum about the new foot, and of the leg that leaves about the hips, are kept. Returns the rates of
        /// the new standing and swinging leg.
        fn impact(&self, y: &State) -> [f64; 2] {
            let Compass { mh, m, a, b, .. } = *self;
            let l = a + b;
            let [s, w, us, uw] = *y;
            let cosine = (s - w).cos();
            let before = Vector2::new(
                ((mh * l * l + 2.0 * m * a * l) * cosine - m * a * b) * us - m * a * b * uw,
                -m * a * b * us,
            );
            let mass = Matrix2::new(
                mh * l * l + m * (a * a + l * l) - m * l * b * cosine,
                m * b * b - m * l * b * cosine,
                -m * l * b * cosine,
                m * b * b,
            );
            let after = mass.lu().solve(&before).unwrap();
            [after[0], after[1]]
        }

        /// From (angle of the standing leg, rates of both) to the same after a step; the angles of the legs are opposite.
        pub fn stride(&self, y: &[f64; 3]) -> ([f64; 3], f64) {
            let mut now: State = [y[0], -y[0], y[1], y[2]];
            let (mut t, h) = (0.0, 4e-4);
            loop {
                let next = self.step(&now, h);
                assert!(t < 10.0, "the compass falls");
                // The foot of the leg ahead comes down.
                if now[0] + now[1] < 0.0 && next[0] + next[1] >= 0.0 && next[1] < next[0] {
                    break;
                }
                (now, t) = (next, t + h);
            }
            let (mut low, mut high) = (0.0, h);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let there = self.step(&now, middle);
                if there[0] + there[1] > 0.0 { high = middle } else { low = middle }
            }
            let last = self.step(&now, low);
            let [us, uw] = self.impact(&last);
            ([last[1], us, uw], t + low)
        }

        /// The periodic step and its multipliers, by differences.
        pub fn orbit(&self, mut y: [f64; 3]) -> ([f64; 3], f64, Vec<nalgebra::Complex<f64>>) {
            let slopes = |y: &[f64; 3]| {
                DMatrix::from_fn(3, 3, |row, column| {
                    let at = |h: f64| {
                        let mut y = *y;
                        y[column] += h;
                        self.stride(&y).0[row]
                    };
                    let central = |h: f64| (at(h) - at(-h)) / (2.0 * h);
                    (4.0 * central(1e-4) - central(2e-4)) / 3.0
                })
            };
            for _ in 0..8 {
                let off = DVector::from_fn(3, |row, _| self.stride(&y).0[row] - y[row]);
                let change = (slopes(&y) - DMatrix::identity(3, 3)).lu().solve(&-off).unwrap();
                y = std::array::from_fn(|row| y[row] + change[row]);
            }
            let mut multipliers: Vec<_> = slopes(&y).complex_eigenvalues().iter().copied().collect();
            multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
            (y, self.stride(&y).1, multipliers)
        }
    }
}

/// The step after which both legs have changed their places.
fn stride(mechanism: &InterpretedMechanism) -> Periodic {
    let exchange = |text: &str| Exchange::named(mechanism, text).unwrap();
    Periodic {
        returns: Return::At { event: "collision".to_owned(), contact: Some(1), count: 1 },
        reset: vec![0],
        symmetry: ["q1=q2", "q2=q1", "u1=u2", "u2=u1"].map(exchange).to_vec(),
        longest: 8.0,
        segments: 1,
    }
}

/// Coordinates and speeds with both feet on the ground, the first of which stands.
fn standing(q: f64, u: [f64; 2]) -> ([f64; 4], [f64; 4]) {
    ([-q.sin(), q.cos(), -q, q], [q.cos() * u[0], q.sin() * u[0], u[0], u[1]])
}

/// A compass walks downhill, and so does the simplest walker, whose legs have hardly any mass: their legs change with
/// every step. States, periods and multipliers are those of the equations of two angles.
#[test]
fn a_compass_walks_downhill() {
    let of = |mh, m, a, b, g, gamma| Compass { mh, m, a, b, g, gamma };
    let goswami = (of(10.0, 5.0, 0.5, 0.5, 9.81, 3.0_f64.to_radians()), 0.53, 0.271, [1.09, 0.38], 1.0);
    // Light legs cost digits.
    let garcia = (of(1.0, 1e-6, 0.0, 1.0, 1.0, 0.009), 0.398, 0.2, [0.2, 0.184], 100.0);
    for (compass, tiles, q, u, loss) in [goswami, garcia] {
        let Compass { mh, m, a, b, g, gamma } = compass;
        let mut mechanism = read("compass_walker.mech");
        mechanism.set_parameter_values(&[mh, m, a, b, g, gamma, tiles, 0.2]).unwrap();
        let (coordinates, speeds) = standing(q, u);
        let start = State { time: 0.0, coordinates: &coordinates, speeds: &speeds, inputs: &[] };
        let options = options(2.0, 0.0, Law::Poisson);
        let orbit = find_orbit(&mechanism, &start, &options, &stride(&mechanism), &[]).unwrap();
        let (exact, period, multipliers) = compass.orbit([-q, u[0], u[1]]);
        println!("{:?} {exact:?} {} {period}", orbit.state, orbit.period);
        println!("{:?} {multipliers:?}", orbit.multipliers);
        for (place, exact) in [2, 6, 7].into_iter().zip(exact) {
            assert!(
                (orbit.state[place] - exact).abs() < 1e-11 * loss,
                "{} instead of {exact}",
                orbit.state[place]
            );
        }
        // The same in three segments.
        let divided = Periodic { segments: 3, ..stride(&mechanism) };
        let divided = find_orbit(&mechanism, &start, &options, &divided, &[]).unwrap();
        assert!((divided.period - orbit.period).abs() < 1e-11 * loss && divided.nodes.len() == 3);
        for (one, other) in orbit.state.iter().zip(&divided.state) {
            assert!((one - other).abs() < 1e-11 * loss, "{one} {other}");
        }
        assert!(
            (orbit.period - period).abs() < 1e-11 * loss
                && orbit.is_stable()
                && orbit.residual < 1e-12 * loss
        );
        for (found, exact) in orbit.multipliers.iter().zip(multipliers) {
            // Those of a pair come in any order.
            let off = (found - exact).norm().min((found - exact.conj()).norm());
            assert!(off < 1e-8 * loss, "{found} instead of {exact}");
        }
        assert!(
            orbit.multipliers[3..].iter().all(|other| other.norm() < 1e-9 * loss),
            "{:?}",
            orbit.multipliers
        );
        if m < 1e-3 {
            // Garcia, Chatterjee, Ruina and Coleman (1998), for legs without mass.
            assert!(
                (orbit.state[3] - 0.200_310_9).abs() < 1e-6 && (orbit.state[6] - 0.199_832_5).abs() < 1e-6
            );
        }
    }
}

/// A block that is pushed away from a place with k x, and returns to it only if it stays there: deviations grow by
/// exp((k / m)^(1/2) T) in a period, 1e10 here. One motion over the whole period does not know its own start any more; in
/// four segments they grow by 316.
#[test]
fn deviations_that_grow_much_need_segments() {
    let mut mechanism = read("block_on_spring.mech");
    let (m, k, period) = (2.0_f64, 50.0_f64, 4.6);
    mechanism.set_parameter_values(&[m, -k, 0.0]).unwrap();
    let start = State { time: 0.0, coordinates: &[0.1, 1.0], speeds: &[-0.05, 0.0], inputs: &[] };
    let options = options(0.0, 0.0, Law::Newton);
    let find = |segments| {
        let returns = Return::After(period);
        let periodic = Periodic { returns, reset: vec![1], symmetry: Vec::new(), longest: 1.0, segments };
        find_orbit(&mechanism, &start, &options, &periodic, &[])
    };
    let orbit = find(4).unwrap();
    println!("{orbit:?}");
    assert!(orbit.state[0].abs() < 1e-12 && orbit.state[2].abs() < 1e-12 && orbit.nodes.len() == 4);
    let growth = ((k / m).sqrt() * period).exp();
    assert!((orbit.multipliers[0].re / growth - 1.0).abs() < 1e-10, "{:?} {growth}", orbit.multipliers);
    let none = Periodic {
        returns: Return::After(period),
        reset: vec![1],
        symmetry: Vec::new(),
        longest: 1.0,
        segments: 0,
    };
    let found = find_orbit(&mechanism, &start, &options, &none, &[]);
    assert!(matches!(found, Err(OrbitError::BadRequest(_))), "{found:?}");
}

/// The woodpecker's cycle: the bird swings, the sleeve jams on the pole, slips and is free, the beak strikes, the other edge
/// stops the sleeve. Its one multiplier beside differences of the motion, in one segment and in several; through mu it
/// doubles its period.
#[test]
fn a_woodpecker_pecks_down_its_pole() {
    let mechanism = read("woodpecker.mech");
    let (q, u) = ([0.0, -0.10090092472062445, -0.44576], [0.0, 0.0, -1.1257]);
    let start = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    let options = Options::default();
    let returns = Return::At { event: "stick".to_owned(), contact: Some(1), count: 1 };
    let periodic = Periodic { returns, reset: vec![0], symmetry: Vec::new(), longest: 1.0, segments: 1 };
    let orbit = find_orbit(&mechanism, &start, &options, &periodic, &[]).unwrap();
    let names = |orbit: &hodograph_gradients::Orbit| -> Vec<&'static str> {
        orbit.events.iter().map(|event| event.kind.name()).filter(|name| *name != "contact").collect()
    };
    let expected = ["slip", "lift_off", "collision", "collision", "slip", "lift_off", "collision", "stick"];
    assert_eq!(names(&orbit), expected);
    for segments in [2, 5] {
        let found = find_orbit(&mechanism, &start, &options, &Periodic { segments, ..periodic.clone() }, &[]);
        let found = found.unwrap();
        assert_eq!(names(&found), expected);
        let off = orbit.state.iter().zip(&found.state).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-10 && (orbit.period - found.period).abs() < 1e-12, "{segments} {off:e}");
        let off = (orbit.multipliers[0] - found.multipliers[0]).norm();
        assert!(off < 1e-10, "{segments} {off:e}");
    }
    // Slip of the upper edge turns back at once and begins anew with no speed: whatever rounding makes of it, its direction
    // is that in which it began.
    for rounded in [-0.100_900_924_72, -0.100_900_924_7, -0.100_901] {
        let q = [0.0, rounded, q[2]];
        let start = State { coordinates: &q, ..start };
        let found = find_orbit(&mechanism, &start, &options, &periodic, &[]).unwrap();
        let off = (&orbit.matrix - &found.matrix).amax() / orbit.matrix.amax();
        assert!(off < 1e-9, "{rounded}: {off:e}");
    }
    // The angle of the bird and its rate when the sleeve comes to rest again, from other ones.
    let again = |qb: f64, ub: f64| {
        let (q, u) = ([0.0, orbit.state[1], qb], [0.0, 0.0, ub]);
        let start = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
        let mut simulation =
            hodograph_simulation::Simulation::new(&mechanism, &start, options.clone()).unwrap();
        loop {
            match simulation.advance(1.0).unwrap() {
                hodograph_simulation::Progress::Event(event)
                    if event.kind.name() == "stick" && event.contact == Some(1) =>
                {
                    return [event.coordinates[2], event.speeds[2]];
                }
                hodograph_simulation::Progress::Event(_) => {}
                hodograph_simulation::Progress::Reached => panic!("the sleeve does not come to rest"),
            }
        }
    };
    let difference = DMatrix::from_fn(2, 2, |row, column| {
        let h = [1e-5, 1e-3][column];
        let moved = |h: f64| {
            let mut state = [orbit.state[2], orbit.state[5]];
            state[column] += h;
            again(state[0], state[1])[row]
        };
        (8.0 * (moved(h) - moved(-h)) - (moved(2.0 * h) - moved(-2.0 * h))) / (12.0 * h)
    });
    // The map has one direction: its determinant vanishes, and the multiplier is the trace.
    println!("{:?} {} {}", orbit.multipliers, difference.trace(), difference.determinant());
    assert!((orbit.multipliers[0].re - difference.trace()).abs() < 1e-7, "{}", difference.trace());
    assert!(orbit.multipliers[1..].iter().all(|other| other.norm() < 1e-9) && orbit.is_stable());
    let (q, u) = ([0.0, orbit.state[1], -0.47278], [0.0, 0.0, -4.6]);
    let start = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    let branch =
        follow_branch(&mechanism, &start, &options, &periodic, (By::Friction(None), 0.306, 0.3084), 80);
    let branch = branch.unwrap();
    println!(
        "{} points, {:?}, {:?}",
        branch.points.len(),
        branch.changes.first().map(|c| c.at.value),
        branch.ended
    );
    let [change] = &branch.changes[..] else { panic!("{:?}", branch.changes) };
    assert_eq!(change.kind, ChangeKind::PeriodDoubling);
    assert!((change.at.value - 0.308_294).abs() < 1e-6, "{}", change.at.value);
}

/// Exchanges that are no symmetry of any state.
#[test]
fn impossible_exchanges_are_refused() {
    let mechanism = read("compass_walker.mech");
    let (coordinates, speeds) = standing(0.271, [1.09, 0.38]);
    let start = State { time: 0.0, coordinates: &coordinates, speeds: &speeds, inputs: &[] };
    for exchanges in [["q1=q2", "q1=q2"], ["q1=u2", "q2=q1"]] {
        let symmetry = exchanges.map(|text| Exchange::named(&mechanism, text).unwrap()).to_vec();
        let periodic = Periodic { symmetry, ..stride(&mechanism) };
        let found = find_orbit(&mechanism, &start, &options(2.0, 0.0, Law::Poisson), &periodic, &[]);
        assert!(matches!(found, Err(OrbitError::BadRequest(_))), "{found:?}");
    }
}

/// The compass on steeper inclines: its step doubles its period at 4.39 degrees.
#[test]
fn the_step_of_a_compass_doubles_its_period() {
    let mechanism = read("compass_walker.mech");
    let (coordinates, speeds) = standing(0.271, [1.09, 0.38]);
    let start = State { time: 0.0, coordinates: &coordinates, speeds: &speeds, inputs: &[] };
    let options = options(2.0, 0.0, Law::Poisson);
    let range = (By::Parameter(5), 3.0_f64.to_radians(), 0.08);
    let divided = Periodic { segments: 2, ..stride(&mechanism) };
    let found = follow_branch(&mechanism, &start, &options, &divided, range, 60);
    let branch = found.unwrap();
    println!("{} points, ended {:?}", branch.points.len(), branch.ended);
    for change in &branch.changes {
        println!("{:?} at {} degrees", change.kind, change.at.value.to_degrees());
    }
    let [change] = &branch.changes[..] else { panic!("{:?}", branch.changes) };
    assert_eq!(change.kind, ChangeKind::PeriodDoubling);
    // Goswami, Espiau and Keramane found it near 4.37 degrees. By the equations of two angles -1 is a multiplier there.
    assert!((change.at.value.to_degrees() - 4.37).abs() < 0.03, "{}", change.at.value.to_degrees());
    let compass = Compass { mh: 10.0, m: 5.0, a: 0.5, b: 0.5, g: 9.81, gamma: change.at.value };
    let at = &change.at.orbit.state;
    let (_, _, multipliers) = compass.orbit([at[2], at[6], at[7]]);
    let least = multipliers.iter().map(|multiplier| (multiplier + 1.0).norm()).fold(f64::INFINITY, f64::min);
    assert!(least < 1e-6, "{multipliers:?}");
}
