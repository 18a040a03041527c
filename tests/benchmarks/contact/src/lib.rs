//! Motions with contact that are measured: their mechanisms, surfaces and durations.

use hodograph::{ComponentKind, Contacts, Law, Mechanism, Surface};
use hodograph_simulation::{Options, Progress, Simulation};

/// The modules of the models.
#[allow(missing_docs)]
pub mod generated {
    hodograph::mechanism!("../../../simulation/models/tumbling_box.mech");
    hodograph::mechanism!("../../../simulation/models/hopper.mech");
    hodograph::mechanism!("../../../simulation/tests/models/puck_on_incline.mech");
    hodograph::mechanism!("models/rimless_wheel.mech");
    hodograph::mechanism!("models/two_cubes.mech");
    hodograph::mechanism!("models/three_cubes.mech");
    hodograph::mechanism!("models/quadruped.mech");
}

/// What can go wrong: no Python, no network, a motion that cannot be followed.
pub type Failure = Box<dyn std::error::Error>;

/// By how much the legs of a quadruped that trots bend, rad.
const LIFT: f64 = 0.3;

/// A motion: a mechanism from its initial state, with e = 0 and one coefficient of friction.
pub struct Motion {
    /// its name
    pub name: &'static str,
    /// what moves
    pub mechanism: Box<dyn Contacts<f64>>,
    /// coefficient of friction
    pub mu: f64,
    /// duration, s
    pub until: f64,
}

/// What a motion came to.
pub struct Came {
    /// coordinates at the end
    pub coordinates: Vec<f64>,
    /// speeds at the end
    pub speeds: Vec<f64>,
    /// when nothing moved any more, s
    pub rest: Option<f64>,
    /// number of events
    pub events: usize,
}

/// The motions that are compared, in the order of the table of `docs/contact.md`.
///
/// # Errors
///
/// A model has no such parameter.
pub fn motions() -> Result<Vec<Motion>, Failure> {
    use generated::{
        hopper::Hopper, quadruped::Quadruped, rimless_wheel::RimlessWheel, three_cubes::ThreeCubes,
        tumbling_box::TumblingBox, two_cubes::TwoCubes,
    };
    let motion = |name, mu, until, mechanism| Motion { name, mechanism, mu, until };
    let mut trotting = Quadruped::<f64>::default();
    change(&mut trotting, "lift", LIFT)?;
    Ok(vec![
        motion("hopper", 0.9, 5.0, Box::new(Hopper::<f64>::default())),
        motion("wheel", 0.6, 5.0, Box::new(RimlessWheel::<f64>::default())),
        motion("box", 0.4, 2.0, Box::new(TumblingBox::<f64>::default())),
        motion("two cubes", 0.5, 1.0, Box::new(TwoCubes::<f64>::default())),
        motion("three cubes", 0.5, 1.0, Box::new(ThreeCubes::<f64>::default())),
        motion("quadruped stands", 0.7, 1.0, Box::new(Quadruped::<f64>::default())),
        motion("quadruped trots", 0.7, 1.0, Box::new(trotting)),
    ])
}

/// Gives a parameter another value.
///
/// # Errors
///
/// There is no such parameter, or it may not have this value.
pub fn change(mechanism: &mut dyn Mechanism<f64>, name: &str, value: f64) -> Result<(), Failure> {
    let mut parameters = vec![0.0; mechanism.count(ComponentKind::Parameter)];
    mechanism.parameter_values(&mut parameters)?;
    parameters[mechanism.index(ComponentKind::Parameter, name).ok_or("no such parameter")?] = value;
    Ok(mechanism.set_parameter_values(&parameters)?)
}

impl Motion {
    /// Follows the motion to its end, with this tolerance of the integration.
    ///
    /// # Errors
    ///
    /// It cannot be followed.
    pub fn run(&self, tolerance: f64) -> Result<Came, Failure> {
        self.run_until(tolerance, self.until)
    }

    /// Follows the motion to a time, s.
    ///
    /// # Errors
    ///
    /// It cannot be followed.
    pub fn run_until(&self, tolerance: f64, until: f64) -> Result<Came, Failure> {
        let mechanism = &*self.mechanism;
        let [n, p, w] = [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
            .map(|kind| mechanism.count(kind));
        let (mut q, mut u, mut inputs) = (vec![0.0; n], vec![0.0; p], vec![0.0; w]);
        mechanism.initial_state(&mut q, &mut u, &mut inputs)?;
        let start = hodograph::State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
        let options = Options {
            surface: Some(Surface { mu: self.mu, e: 0.0, law: Law::Newton }),
            relative_tolerance: tolerance,
            absolute_tolerance: tolerance,
            ..Options::default()
        };
        let mut simulation = Simulation::new(mechanism, &start, options)?;
        let (mut events, mut rest) = (0, None);
        while let Progress::Event(event) = simulation.advance(until)? {
            events += 1;
            if event.kind.name() == "rest" {
                rest = Some(event.time);
            }
        }
        Ok(Came {
            coordinates: simulation.coordinates().to_vec(),
            speeds: simulation.speeds().to_vec(),
            rest,
            events,
        })
    }
}
