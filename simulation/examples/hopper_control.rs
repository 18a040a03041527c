//! A hopper under a controller of 1 kHz: it hops to the heights that it is told.
//!
//!   cargo run --release -p hodograph-simulation --example hopper_control -- --svg hopper.svg

mod story;

use std::sync::Arc;

use hodograph::{ComponentKind, Law, Mechanism, State, Surface};
use hodograph_simulation::{Drive, EventKind, Options};
use hopper::Hopper;
use story::{Start, Told};

hodograph::mechanism!("models/hopper.mech");

/// Length of the leg at which its spring is without force in flight, m.
const LEG: f64 = 0.6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    story::show(&tell()?)
}

/// The height of the body at the top of a hop that is asked for at a time, m.
fn command(time: f64) -> f64 {
    match time {
        t if t < 6.0 => 1.0,
        t if t < 13.0 => 1.3,
        _ => 0.9,
    }
}

/// After M. H. Raibert: the leg is made longer when the body is lowest. By how much follows from the height
/// that is asked for, from what the last one lacked and from what all so far lacked.
#[derive(Clone, Default)]
struct Control {
    /// by how much the leg is made longer, m
    thrust: f64,
    /// whether it is
    thrusting: bool,
    /// vertical speed of the body at the sample before, m/s
    rise: f64,
    /// what the heights so far lacked, times its gain, m
    lacked: f64,
}

impl Control {
    fn act(&mut self, time: f64, q: &[f64], u: &[f64], inputs: &mut [f64]) {
        let (body, rise, foot) = (q[1], u[1], q[1] - q[4] * q[3].cos());
        let stands = foot < 1e-9;
        if !stands && self.rise > 0.0 && rise <= 0.0 {
            let height = command(time);
            let lack = height - body;
            self.lacked += 0.005 * lack;
            self.thrust = (0.027 + 0.0225 * (height - 1.0) + 0.05 * lack + self.lacked).clamp(0.0, 0.2);
        }
        self.rise = rise;
        self.thrusting = stands && (self.thrusting || rise > 0.0);
        inputs[1] = LEG + if self.thrusting { self.thrust } else { 0.0 };
    }
}

/// The story of the hopper.
pub fn tell() -> Told {
    let hopper = Hopper::<f64>::default();
    let start = Start::of(&hopper)?;
    let mut control = Control { thrust: 0.027, ..Control::default() };
    let options = Options {
        surface: Some(Surface { mu: 0.9, e: 0.0, law: Law::Newton }),
        relative_tolerance: 1e-9,
        absolute_tolerance: 1e-9,
        drive: Drive::Sampled {
            period: 1e-3,
            controller: Box::new(move |t: f64, q: &[f64], u: &[f64], inputs: &mut [f64]| {
                control.act(t, q, u, inputs);
            }),
        },
        // The body neither rises nor falls.
        events: vec![Arc::new(|_, _, u: &[f64]| u[1])],
        ..Options::default()
    };
    let points: Vec<usize> = ["B1", "B2", "H", "F"]
        .iter()
        .filter_map(|name| Mechanism::index(&hopper, ComponentKind::Point, name))
        .collect();
    let mut trail = Vec::new();
    let mut story = story::follow(&hopper, &start, options, (20.0, 0.02), |simulation, story| {
        let (t, q, u) = (simulation.time(), simulation.coordinates(), simulation.speeds());
        trail.push([t, q[1]]);
        if trail.len() % 10 == 1 {
            let state = State { time: t, coordinates: q, speeds: u, inputs: simulation.inputs() };
            let places: Vec<[f64; 2]> = points
                .iter()
                .filter_map(|&point| Mechanism::position(&hopper, point, &state).ok())
                .map(|place| [t + place.x, place.z])
                .collect();
            story.picture.line(&places, "#9bd");
        }
    })?;
    story.picture.line(&trail, "#c33");
    let mut table = String::from("  t (s)   top (m)   asked for (m)\n");
    for event in &story.events {
        let q = &event.coordinates;
        // Where the vertical speed is zero in flight the body is at its top.
        if matches!(event.kind, EventKind::Zero(_)) && q[1] - q[4] * q[3].cos() > 1e-3 {
            table += &format!("{:7.3} {:9.4} {:15.2}\n", event.time, q[1], command(event.time - 1e-3));
        }
    }
    let count = |name: &str| story.events.iter().filter(|event| event.kind.name() == name).count();
    story.text = format!(
        "A hopper with a springy leg drops from 1 m. Its controller samples the state 1000 times a second, and makes the leg longer when the\n\
         body is lowest: by how much follows from the height that is asked for and from what the heights so far lacked. Each top of a hop:\n\n{table}\n\
         The foot struck the ground {} times and lifted off {} times, at any time between the samples.\n\
         The picture shows the body's height over time in red.",
        count("collision"),
        count("lift_off"),
    );
    Ok(story)
}
