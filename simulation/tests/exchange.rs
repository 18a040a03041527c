//! Motions that another program drives: an integrator of its own between events gives the motion of the simulation, and so do
//! inputs that are changed from outside.

use hodograph::{Contacts, Law, State};
use hodograph_simulation::{Event, IndicatorKind, Options, Progress, Simulation};

use crate::common::{Body, Line, Part, names, run, surface};

/// An importer of FMI's model exchange: the classical method of Runge and Kutta with fixed steps, and zeros of indicators by
/// bisection, up to a width of this, s.
const WIDTH: f64 = 1e-13;

struct Importer<'s, 'm> {
    simulation: &'s mut Simulation<'m>,
    t: f64,
    y: Vec<f64>,
    n: usize,
    inputs: Vec<f64>,
}

impl Importer<'_, '_> {
    fn state<'y>(&'y self, time: f64, y: &'y [f64]) -> State<'y> {
        State { time, coordinates: &y[..self.n], speeds: &y[self.n..], inputs: &self.inputs }
    }

    fn rates(&self, t: f64, y: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; y.len()];
        self.simulation.rates(&self.state(t, y), &mut rates).unwrap();
        rates
    }

    fn step(&self, h: f64) -> Vec<f64> {
        let moved = |rates: &[f64], h: f64| -> Vec<f64> {
            self.y.iter().zip(rates).map(|(y, rate)| y + h * rate).collect()
        };
        let a = self.rates(self.t, &self.y);
        let b = self.rates(self.t + h / 2.0, &moved(&a, h / 2.0));
        let c = self.rates(self.t + h / 2.0, &moved(&b, h / 2.0));
        let d = self.rates(self.t + h, &moved(&c, h));
        let mean: Vec<f64> = (0..a.len()).map(|i| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0).collect();
        moved(&mean, h)
    }

    fn is_past(&self, h: f64) -> bool {
        let y = self.step(h);
        let values = self.simulation.indicator_values(&self.state(self.t + h, &y)).unwrap();
        values.iter().any(|value| *value <= 0.0)
    }

    /// Follows the motion with steps of at most `h`, and gives the events.
    fn follow(&mut self, until: f64, h: f64) -> Vec<Event> {
        let mut events = Vec::new();
        while self.t < until - 1e-15 {
            let due = self.simulation.next_time().map_or(until, |time| time.min(until));
            let mut step = h.min(due - self.t);
            let event = self.is_past(step);
            if event {
                let (mut low, mut high) = (0.0, step);
                while high - low > WIDTH {
                    let middle = 0.5 * (low + high);
                    if self.is_past(middle) { high = middle } else { low = middle }
                }
                step = high;
            }
            self.y = self.step(step);
            self.t += step;
            let (t, y) = (self.t, self.y.clone());
            let (n, inputs) = (self.n, self.inputs.clone());
            let state = State { time: t, coordinates: &y[..n], speeds: &y[n..], inputs: &inputs };
            if event || t >= due {
                events.extend(self.simulation.continue_from(&state).unwrap());
                self.y = [self.simulation.coordinates(), self.simulation.speeds()].concat();
            } else {
                self.simulation.step_completed(&state).unwrap();
            }
        }
        events
    }
}

/// The motion by the simulation and by an importer with steps of `h` have the same events, and the same end within `near`.
fn agrees(
    mechanism: &dyn Contacts<f64>,
    state: &State<'_>,
    options: &Options,
    until: f64,
    h: f64,
    near: f64,
) {
    let mut own = Simulation::new(mechanism, state, options.clone()).unwrap();
    let expected = run(&mut own, until);
    let mut driven = Simulation::new(mechanism, state, options.clone()).unwrap();
    let mut begun = Vec::new();
    while let Progress::Event(event) = driven.advance(state.time).unwrap() {
        begun.push(event);
    }
    let y = [driven.coordinates(), driven.speeds()].concat();
    let inputs = state.inputs.to_vec();
    let mut importer =
        Importer { simulation: &mut driven, t: state.time, y, n: state.coordinates.len(), inputs };
    begun.extend(importer.follow(until, h));
    let kinds = |events: &[Event]| events.iter().map(|event| event.kind.name()).collect::<Vec<_>>();
    assert_eq!(kinds(&begun), kinds(&expected), "{:?} {:?}", names(&begun), names(&expected));
    for (found, expected) in begun.iter().zip(&expected) {
        assert!((found.time - expected.time).abs() < near, "{found:?} {expected:?}");
        assert_eq!(found.contact, expected.contact);
    }
    let end = [own.coordinates(), own.speeds()].concat();
    for (found, expected) in importer.y.iter().zip(&end) {
        assert!((found - expected).abs() < near, "{:?} {end:?}", importer.y);
    }
}

fn options(mu: f64, e: f64, lowest: f64) -> Options {
    Options { absolute_tolerance: lowest, ..surface(mu, e, Law::Stronge) }
}

/// A ball bounces until its bounces are too low, and rests.
#[test]
fn a_ball_bounces_to_rest() {
    let body = Body::new(1.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))]);
    let state = State { time: 0.0, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    agrees(&body, &state, &options(0.0, 0.5, 1e-9), 2.0, 1e-2, 1e-8);
}

/// A body with spin strikes with friction, slides, and sticks.
#[test]
fn a_wheel_strikes_slides_and_rolls() {
    let body = Body::new(1.0, 0.4, &[Line::floor(Part::Rim(1.0))]);
    let state = State { time: 0.0, coordinates: &[0.0, 1.5, 0.0], speeds: &[0.5, 0.0, 3.0], inputs: &[0.0] };
    agrees(&body, &state, &options(0.2, 0.0, 1e-10), 2.0, 1e-3, 1e-9);
}

/// A spring pulls a body that sticks, slips, turns back and sticks again; slip ends in both directions.
#[test]
fn a_body_on_a_spring_slips_to_and_fro() {
    let mut body = Body::new(1.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))]);
    body.spring = 40.0;
    let state = State { time: 0.0, coordinates: &[1.0, 0.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    agrees(&body, &state, &options(0.3, 0.0, 1e-11), 3.0, 1e-3, 1e-9);
}

/// A box tips over its edge: two contacts, of which one lifts off, and strikes again.
#[test]
fn a_box_rocks_on_two_feet() {
    let feet = [Line::floor(Part::Point(-0.3, -0.5)), Line::floor(Part::Point(0.3, -0.5))];
    let body = Body::new(1.0, 0.1, &feet);
    let state = State { time: 0.0, coordinates: &[0.0, 0.6, 0.2], speeds: &[0.3, 0.0, -0.4], inputs: &[0.0] };
    agrees(&body, &state, &options(0.4, 0.2, 1e-9), 0.6, 1e-3, 1e-8);
}

/// A push that comes and goes at times of the caller's choice is that of a break in a function of time.
#[test]
fn inputs_change_at_times_of_the_callers_choice() {
    let body = Body::new(1.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))]);
    let state = State { time: 0.0, coordinates: &[0.0, 0.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    let mut simulation = Simulation::new(&body, &state, options(0.3, 0.0, 1e-8)).unwrap();
    let mut advance = |until: f64, push: f64| {
        simulation.set_inputs(&[push]).unwrap();
        let mut kinds = Vec::new();
        while let Progress::Event(event) = simulation.advance_exactly(until).unwrap() {
            kinds.push(event.kind.name());
        }
        (kinds, simulation.coordinates()[0], simulation.speeds()[0])
    };
    // Friction holds a push of 2.9 N, not one of 4.9 N: (4.9 - 0.3 9.81) t^2 / 2.
    let mut seen = advance(0.5, 2.9).0;
    let (kinds, x, v) = advance(1.0, 4.9);
    seen.extend(kinds);
    let rate = 4.9 - 0.3 * 9.81;
    assert!((x - rate / 8.0).abs() < 1e-11 && (v - rate / 2.0).abs() < 1e-11, "{x} {v}");
    let (kinds, x, v) = advance(2.0, 0.0);
    seen.extend(kinds);
    assert!(v == 0.0 && (x - rate / 8.0 * (1.0 + rate / (0.3 * 9.81))).abs() < 1e-10, "{x} {v}");
    assert!(seen.contains(&"slip") && seen.contains(&"stick"), "{seen:?}");
    // Beyond the time at which it looks, nothing can be changed any more.
    assert!(simulation.advance(2.5).is_ok());
    let refused = simulation.set_inputs(&[f64::NAN]).unwrap_err();
    assert_eq!(refused.kind.name(), "bad_input");
    assert_eq!(simulation.set_inputs(&[]).unwrap_err().kind.name(), "bad_input");
}

/// Every function that is watched has a kind and a contact, as many as there are values.
#[test]
fn indicators_are_named() {
    let feet = [Line::floor(Part::Point(-0.3, -0.5)), Line::floor(Part::Point(0.3, -0.5))];
    let body = Body::new(1.0, 0.1, &feet);
    let state = State { time: 0.0, coordinates: &[0.0, 0.6, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    let simulation = Simulation::new(&body, &state, options(0.4, 0.2, 1e-8)).unwrap();
    let told: Vec<(Option<usize>, &str)> =
        simulation.indicators().iter().map(|one| (one.contact, one.kind.name())).collect();
    let of = |contact| ["gap", "normal_force", "friction", "slip"].map(|name| (Some(contact), name));
    assert_eq!(told, [&of(0)[..], &of(1), &[(None, IndicatorKind::Jam.name())]].concat());
    let values = simulation.indicator_values(&state).unwrap();
    assert_eq!(values.len(), told.len());
    assert!((values[0] - 0.1).abs() < 1e-15 && values[1] == 1.0);
}

/// A block slides off a ledge: contacts of faces end, its edge begins to press, and it tips over.
#[test]
fn a_block_tips_over_a_ledge() {
    let block = crate::ledge::block_on_ledge::BlockOnLedge::<f64>::default();
    let state = State { time: 0.0, coordinates: &[-0.5, 0.1, 0.0], speeds: &[0.5, 0.0, 0.0], inputs: &[] };
    agrees(&block, &state, &options(0.0, 0.0, 1e-9), 1.2, 1e-3, 1e-8);
}
