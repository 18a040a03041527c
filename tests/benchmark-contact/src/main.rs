//! Motion with contact beside MuJoCo: seconds of motion per second of computing, on machines that tumble, hop, walk,
//! stand and trot, in turns in one run; and how far a particle creeps that friction holds.
//!
//! The ratio counts: both are measured under the same load, as time of the processor, and the best of several
//! turns is taken. Both run in one thread.

mod peer;

use cpu_time::ThreadTime;
use hodograph::{Contacts, Kind, Law, Mechanism, Surface};
use hodograph_simulation::{Options, Progress, Simulation};
use peer::{Answer, Job};

/// The modules of the models.
#[allow(missing_docs)]
mod generated {
    hodograph::mechanism!("../../simulation/models/tumbling_box.mech");
    hodograph::mechanism!("../../simulation/models/hopper.mech");
    hodograph::mechanism!("../../simulation/tests/models/puck_on_incline.mech");
    hodograph::mechanism!("models/rimless_wheel.mech");
    hodograph::mechanism!("models/two_cubes.mech");
    hodograph::mechanism!("models/three_cubes.mech");
    hodograph::mechanism!("models/quadruped.mech");
}

/// What can go wrong: no Python, no network.
type Failure = Box<dyn std::error::Error>;

const TURNS: usize = 7;
/// MuJoCo's time steps, s: its default, and shorter ones.
const STEPS: [f64; 3] = [2e-3, 5e-4, 1e-4];
/// Tolerances of the integration of ours.
const OURS: [f64; 3] = [1e-12, 1e-9, 1e-6];
/// Durations of the motions, s.
const HOPPER: f64 = 5.0;
const WHEEL: f64 = 5.0;
const BOX: f64 = 2.0;
const CUBES: f64 = 1.0;
const QUADRUPED: f64 = 1.0;
const PUCK: f64 = 10.0;
/// By how much the legs of a quadruped that trots bend, rad.
const LIFT: f64 = 0.3;

/// A motion of ours.
struct Motion<'m> {
    mechanism: &'m dyn Contacts<f64>,
    mu: f64,
    tolerance: f64,
}

/// What a motion came to.
struct Came {
    /// time of the processor, s
    seconds: f64,
    q: Vec<f64>,
    /// speeds at the end
    u: Vec<f64>,
    /// when nothing moved any more, s
    rest: Option<f64>,
    events: usize,
}

impl Motion<'_> {
    fn run(&self, until: f64) -> Result<Came, Failure> {
        let [n, p, w] = [Kind::Coordinate, Kind::Speed, Kind::Input].map(|kind| self.mechanism.count(kind));
        let (mut q, mut u, mut inputs) = (vec![0.0; n], vec![0.0; p], vec![0.0; w]);
        self.mechanism.initial_state(&mut q, &mut u, &mut inputs)?;
        let start = hodograph::State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
        let options = Options {
            surface: Some(Surface { mu: self.mu, e: 0.0, law: Law::Newton }),
            relative_tolerance: self.tolerance,
            absolute_tolerance: self.tolerance,
            ..Options::default()
        };
        let begun = ThreadTime::now();
        let mut simulation = Simulation::new(self.mechanism, &start, options)?;
        let (mut events, mut rest) = (0, None);
        while let Progress::Event(event) = simulation.advance(until)? {
            events += 1;
            if event.kind.name() == "rest" {
                rest = Some(event.time);
            }
        }
        let seconds = begun.elapsed().as_secs_f64();
        Ok(Came {
            seconds,
            q: simulation.coordinates().to_vec(),
            u: simulation.speeds().to_vec(),
            rest,
            events,
        })
    }
}

/// The least time of several turns.
struct Best(f64);

impl Best {
    fn take(&mut self, seconds: f64) {
        self.0 = self.0.min(seconds);
    }
}

fn main() -> Result<(), Failure> {
    let python = peer::python()?;
    let body = generated::tumbling_box::TumblingBox::<f64>::default();
    let hopper = generated::hopper::Hopper::<f64>::default();
    compare(&python, ("hopper", HOPPER), &hopper, 0.9)?;
    let wheel = generated::rimless_wheel::RimlessWheel::<f64>::default();
    compare(&python, ("wheel", WHEEL), &wheel, 0.6)?;
    compare(&python, ("box", BOX), &body, 0.4)?;
    compare(&python, ("two cubes", CUBES), &generated::two_cubes::TwoCubes::<f64>::default(), 0.5)?;
    compare(&python, ("three cubes", CUBES), &generated::three_cubes::ThreeCubes::<f64>::default(), 0.5)?;
    let mut quadruped = generated::quadruped::Quadruped::<f64>::default();
    compare(&python, ("quadruped stands", QUADRUPED), &quadruped, 0.7)?;
    change(&mut quadruped, "lift", LIFT)?;
    compare(&python, ("quadruped trots", QUADRUPED), &quadruped, 0.7)?;
    creep(&python)
}

/// Gives a parameter another value.
fn change(mechanism: &mut dyn Mechanism<f64>, name: &str, value: f64) -> Result<(), Failure> {
    let mut parameters = vec![0.0; mechanism.count(Kind::Parameter)];
    mechanism.parameter_values(&mut parameters)?;
    parameters[mechanism.index(Kind::Parameter, name).ok_or("no such parameter")?] = value;
    Ok(mechanism.set_parameter_values(&parameters)?)
}

/// Both programs in turns.
fn compare(
    python: &std::path::PathBuf,
    (scene, until): (&'static str, f64),
    mechanism: &dyn Contacts<f64>,
    mu: f64,
) -> Result<(), Failure> {
    let ours = OURS.map(|tolerance| Motion { mechanism, mu, tolerance });
    let exact = Motion { mechanism, mu, tolerance: 1e-13 }.run(until)?;
    let jobs: Vec<Job> = STEPS.iter().map(|&step| (scene, step, until)).collect();
    let mut best = OURS.map(|_| Best(f64::INFINITY));
    let mut best_peer = STEPS.map(|_| Best(f64::INFINITY));
    let (mut came, mut answers) = (Vec::new(), Vec::new());
    for _ in 0..TURNS {
        answers = peer::run(python, &jobs)?;
        for (best, answer) in best_peer.iter_mut().zip(&answers) {
            best.take(answer.seconds);
        }
        came = ours.iter().map(|motion| motion.run(until)).collect::<Result<Vec<Came>, Failure>>()?;
        for (best, came) in best.iter_mut().zip(&came) {
            best.take(came.seconds);
        }
    }
    println!(
        "\n{scene}, {until} s{}",
        match exact.rest {
            Some(time) => format!(", at rest from {time:.3} s"),
            None => String::new(),
        }
    );
    println!("  program                          s per s    ratio    height at the end, m   off by, m");
    let height = |q: &[f64], place: usize| q.get(place).copied().unwrap_or(f64::NAN);
    let reference = best_peer[0].0;
    let place = place_of_height(scene);
    let expected = height(&exact.q, place.0);
    let line = |name: String, seconds: f64, z: f64| {
        println!(
            "  {name:32} {:8.0} {:8.2} {z:23.9} {:11.1e}",
            until / seconds,
            reference / seconds,
            (z - expected).abs()
        );
    };
    for ((step, best), answer) in STEPS.iter().zip(&best_peer).zip(&answers) {
        line(format!("MuJoCo, {step:.0e} s"), best.0, height(&answer.q, place.1) + place.2);
    }
    for ((tolerance, best), came) in OURS.iter().zip(&best).zip(&came) {
        let name = format!("Hodograph, {tolerance:.0e}, {} events", came.events);
        line(name, best.0, height(&came.q, place.0));
    }
    Ok(())
}

/// Where the height stands among our coordinates and among MuJoCo's, and what is added there.
fn place_of_height(scene: &str) -> (usize, usize, f64) {
    match scene {
        "hopper" => (1, 1, 1.0),
        "wheel" => (1, 1, 0.923_879_532_511_286_7),
        _ => (2, 2, 0.0),
    }
}

/// A particle that friction holds with twenty times what is needed.
fn creep(python: &std::path::PathBuf) -> Result<(), Failure> {
    let mut puck = generated::puck_on_incline::PuckOnIncline::<f64>::default();
    let mut parameters = [0.0; 3];
    puck.parameter_values(&mut parameters)?;
    parameters[2] = 0.05;
    puck.set_parameter_values(&parameters)?;
    let came = Motion { mechanism: &puck, mu: 1.0, tolerance: 1e-12 }.run(PUCK)?;
    println!("\na particle on an incline of 0.05 rad, mu = 1: how fast it creeps, um/s");
    let jobs: Vec<Job> = ["puck", "puck, impratio 100"]
        .into_iter()
        .flat_map(|scene| STEPS.map(|step| (scene, step, PUCK)))
        .collect();
    let answers: Vec<Answer> = peer::run(python, &jobs)?;
    for ((scene, step, until), answer) in jobs.iter().zip(&answers) {
        // The first fifth, in which the contact is compressed, is left out.
        println!("  MuJoCo, {scene}, {step:.0e} s: {:.3}", answer.drift.abs() / (0.8 * until) * 1e6);
    }
    println!("  Hodograph: moved by {:e} m in {PUCK} s, speed {:e} m/s", came.q[0], came.u[0]);
    Ok(())
}
