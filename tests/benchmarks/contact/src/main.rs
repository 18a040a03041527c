//! Motion with contact beside MuJoCo: seconds of motion per second of computing, on machines that tumble, hop, walk,
//! stand and trot, in turns in one run; and how far a particle creeps that friction holds.
//!
//! The ratio counts: both are measured under the same load, as time of the processor, and the best of several
//! turns is taken. Both run in one thread.

mod peer;

use cpu_time::ThreadTime;
use hodograph::Mechanism;
use hodograph_benchmark_contact::{Came, Failure, Motion, generated, motions};
use peer::{Answer, Job};

const TURNS: usize = 7;
/// MuJoCo's time steps, s: its default, and shorter ones.
const STEPS: [f64; 3] = [2e-3, 5e-4, 1e-4];
/// Tolerances of the integration of ours.
const OURS: [f64; 3] = [1e-12, 1e-9, 1e-6];
/// Duration of the creep, s.
const PUCK: f64 = 10.0;

/// The least time of several turns.
struct Best(f64);

impl Best {
    fn take(&mut self, seconds: f64) {
        self.0 = self.0.min(seconds);
    }
}

fn main() -> Result<(), Failure> {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let python = peer::python()?;
    for motion in
        motions()?.iter().filter(|motion| asked.is_empty() || asked.iter().any(|name| name == motion.name))
    {
        compare(&python, motion)?;
    }
    if asked.is_empty() { creep(&python) } else { Ok(()) }
}

/// Both programs in turns.
fn compare(python: &std::path::PathBuf, motion: &Motion) -> Result<(), Failure> {
    let Motion { name: scene, until, .. } = *motion;
    let exact = motion.run(1e-13)?;
    let jobs: Vec<Job> = STEPS.iter().map(|&step| (scene, step, until)).collect();
    let mut best = OURS.map(|_| Best(f64::INFINITY));
    let mut best_peer = STEPS.map(|_| Best(f64::INFINITY));
    let (mut came, mut answers) = (Vec::new(), Vec::new());
    for _ in 0..TURNS {
        answers = peer::run(python, &jobs)?;
        for (best, answer) in best_peer.iter_mut().zip(&answers) {
            best.take(answer.seconds);
        }
        came.clear();
        for (best, tolerance) in best.iter_mut().zip(OURS) {
            let begun = ThreadTime::now();
            let reached: Came = motion.run(tolerance)?;
            best.take(begun.elapsed().as_secs_f64());
            came.push(reached);
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
    let expected = height(&exact.coordinates, place.0);
    let line = |name: String, seconds: f64, z: f64| {
        println!(
            "  {name:32} {:8.0} {:8.3} {z:23.9} {:11.1e}",
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
        line(name, best.0, height(&came.coordinates, place.0));
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
    let came = Motion { name: "puck", mechanism: Box::new(puck), mu: 1.0, until: PUCK }.run(1e-12)?;
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
    println!("  Hodograph: moved by {:e} m in {PUCK} s, speed {:e} m/s", came.coordinates[0], came.speeds[0]);
    Ok(())
}
