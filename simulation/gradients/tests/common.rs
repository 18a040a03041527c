//! Reads models, and differentiates motions by differences.

use std::path::Path;

use hodograph::{Law, Mechanism, State, Surface};
use hodograph_gradients::{Adjoint, By, MotionGradient, differentiate};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Options, Simulation};
use nalgebra::{DMatrix, DVector};

/// A model of these tests, or of another folder from the root of the repository.
pub fn read(name: &str) -> InterpretedMechanism {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let own = root.join("tests/models").join(name);
    let path = if own.exists() { own } else { root.join("../..").join(name) };
    InterpretedMechanism::read(&path).unwrap_or_else(|error| panic!("{name}: {error}"))
}

pub fn options(mu: f64, e: f64, law: Law) -> Options {
    Options { surface: Some(Surface { mu, e, law }), ..Options::default() }
}

/// A motion from a start at t = 0.
pub struct Task {
    pub mechanism: InterpretedMechanism,
    pub q: Vec<f64>,
    pub u: Vec<f64>,
    pub mu: f64,
    pub e: f64,
    pub law: Law,
}

impl Task {
    fn state(&self) -> State<'_> {
        State { time: 0.0, coordinates: &self.q, speeds: &self.u, inputs: &[] }
    }

    pub fn forwards(&self, by: &[By], times: &[f64]) -> MotionGradient {
        let options = options(self.mu, self.e, self.law);
        differentiate(&self.mechanism, &self.state(), options, by, times).unwrap()
    }

    pub fn adjoint(&self, by: &[By], times: &[f64]) -> Adjoint<'_> {
        let options = options(self.mu, self.e, self.law);
        Adjoint::new(&self.mechanism, &self.state(), options, by, times).unwrap()
    }

    /// The derivatives, found forwards and backwards.
    pub fn differentiate(&self, by: &[By], times: &[f64]) -> MotionGradient {
        let forwards = self.forwards(by, times);
        compare(&forwards, &self.adjoint(by, times));
        forwards
    }

    /// The variable, changed by `h`.
    pub fn changed(&self, by: By, h: f64) -> Task {
        let mut task =
            Task { mechanism: self.mechanism.clone(), q: self.q.clone(), u: self.u.clone(), ..*self };
        match by {
            By::Coordinate(index) => task.q[index] += h,
            By::Speed(index) => task.u[index] += h,
            By::Friction(_) => task.mu += h,
            By::Restitution(_) => task.e += h,
            By::Parameter(index) => {
                let mut all = vec![0.0; task.mechanism.count(hodograph::ComponentKind::Parameter)];
                task.mechanism.parameter_values(&mut all).unwrap();
                all[index] += h;
                task.mechanism.set_parameter_values(&all).unwrap();
            }
            By::Input(_) | By::Sample { .. } => unreachable!(),
        }
        // Start states of rotations are of length one.
        task.mechanism.normalise(&mut task.q).unwrap();
        task
    }

    /// The state at a time, and the times of the events up to there.
    pub fn end(&self, until: f64) -> (DVector<f64>, Vec<f64>) {
        let state = State { time: 0.0, coordinates: &self.q, speeds: &self.u, inputs: &[] };
        let mut simulation =
            Simulation::new(&self.mechanism, &state, options(self.mu, self.e, self.law)).unwrap();
        let events = simulation.advance_to(until).unwrap();
        let all = simulation.coordinates().iter().chain(simulation.speeds()).copied();
        let end = DVector::from_iterator(self.q.len() + self.u.len(), all);
        (end, events.iter().map(|event| event.time).collect())
    }

    /// Derivatives of the state at a time and of the times of events by differences: central ones with the steps h, h/2, h/4,
    /// extrapolated, of order six.
    pub fn differences(&self, by: By, h: f64, until: f64) -> (DVector<f64>, DVector<f64>) {
        let central = |h: f64| {
            let (above, below) = (self.changed(by, h).end(until), self.changed(by, -h).end(until));
            assert_eq!(above.1.len(), below.1.len(), "a step of {h} has other events");
            let times = DVector::from_vec(above.1) - DVector::from_vec(below.1);
            ((above.0 - below.0) / (2.0 * h), times / (2.0 * h))
        };
        let [a, b, c] = [h, h / 2.0, h / 4.0].map(central);
        let both = |a: &DVector<f64>, b: &DVector<f64>, c: &DVector<f64>| {
            let (ab, bc) = ((b * 4.0 - a) / 3.0, (c * 4.0 - b) / 3.0);
            (bc * 16.0 - ab) / 15.0
        };
        (both(&a.0, &b.0, &c.0), both(&a.1, &b.1, &c.1))
    }

    /// The greatest difference between the derivatives of the state at a time and their differences, relative to the
    /// greatest derivative by the same variable; and the same of the times of events that have a derivative.
    pub fn compare(&self, by: &[(By, f64)], until: f64) -> Compared {
        let variables: Vec<By> = by.iter().map(|(by, _)| *by).collect();
        let found = self.differentiate(&variables, &[until]);
        assert!(found.undefined.is_none(), "{}", found.undefined.unwrap());
        let exact: &DMatrix<f64> = found.samples[0].derivative.as_ref().unwrap();
        let mut compared = Compared { events: found.events.len(), state: 0.0, times: 0.0 };
        for (column, &(by, h)) in by.iter().enumerate() {
            let (state, times) = self.differences(by, h, until);
            let off = (exact.column(column) - &state).amax() / state.amax();
            compared.state = compared.state.max(off);
            let size = times.amax();
            for (event, time) in found.events.iter().zip(times.iter()) {
                if let Some(exact) = &event.time {
                    compared.times = compared.times.max((exact[column] - time).abs() / size);
                }
            }
        }
        compared
    }
}

/// Compares all derivatives with those that are found backwards.
pub fn compare(forwards: &MotionGradient, adjoint: &Adjoint<'_>) {
    assert_eq!(forwards.undefined, adjoint.undefined().cloned());
    let mut bits = 7_u64;
    let mut weight = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let mut weights: Vec<DVector<f64>> = Vec::new();
    let mut expected = DVector::zeros(forwards.by.len());
    let mut size = 0.0;
    for (sample, own) in forwards.samples.iter().zip(adjoint.samples()) {
        assert_eq!((sample.time, &sample.state), (own.time, &own.state));
        let mut of = DVector::from_fn(sample.state.len(), |_, _| weight());
        match &sample.derivative {
            Some(by) => {
                expected += by.transpose() * &of;
                size += by.amax();
            }
            None => {
                // Asked for alone, it says why.
                let mut alone = vec![DVector::zeros(of.len()); forwards.samples.len()];
                alone[weights.len()] = of.clone();
                assert_eq!(adjoint.of_states(&alone).err(), forwards.undefined);
                of.fill(0.0);
            }
        }
        weights.push(of);
    }
    let found = adjoint.of_states(&weights).unwrap();
    assert!((&found - &expected).amax() <= 1e-9 * size, "{}", found - expected);
    // At most twenty of the events, spread over the motion.
    let step = forwards.events.len().div_ceil(20).max(1);
    for (index, event) in forwards.events.iter().enumerate().step_by(step) {
        match (&event.time, adjoint.of_time(index)) {
            (Some(time), Ok(Some(found))) => {
                assert!((&found - time).amax() <= 1e-9 * time.amax(), "{}", found - time);
            }
            (None, Ok(None)) => {}
            (None, Err(why)) => assert_eq!(Some(why), forwards.undefined),
            (forwards, backwards) => panic!("{forwards:?} {backwards:?}"),
        }
    }
}

/// How far derivatives are from differences.
#[derive(Debug)]
pub struct Compared {
    pub events: usize,
    pub state: f64,
    pub times: f64,
}
