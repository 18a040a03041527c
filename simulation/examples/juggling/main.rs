//! A paddle that juggles a ball under a controller of 1 kHz, which asks the generated collision what each
//! strike will do.
//!
//!   cargo run --release -p hodograph-simulation --example juggling -- --svg juggling.svg

mod control;
#[allow(dead_code)] // for firmware, and for the test
pub mod plant;
#[path = "../story/mod.rs"]
mod story;
pub mod trial;

use hodograph_simulation::{Drive, EventKind, Options};
use juggler::{Coordinates, Juggler, Speeds};
use story::{Start, Told};
use trial::{UNTIL, command};

hodograph::mechanism!("models/juggler.mech");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    story::show(&tell()?)
}

/// In the picture one metre of height is as long as so many seconds.
const STRETCH: f64 = 4.0;

/// The story of the juggler.
pub fn tell() -> Told {
    let (parameters, surface) = trial::truth();
    let juggler = Juggler::<f64>::new(parameters)?;
    let (coordinates, speeds) = trial::start();
    let start = Start {
        coordinates: <[f64; 10]>::from(coordinates).to_vec(),
        speeds: <[f64; 9]>::from(speeds).to_vec(),
        inputs: vec![0.0; 3],
    };
    let mut control = trial::control::<f64>();
    let options = Options {
        surface: Some(surface),
        relative_tolerance: 1e-9,
        absolute_tolerance: 1e-9,
        drive: Drive::Sampled {
            period: 1e-3,
            controller: Box::new(move |t: f64, q: &[f64], u: &[f64], inputs: &mut [f64]| {
                let (Ok(q), Ok(u)) = (<[f64; 10]>::try_from(q), <[f64; 9]>::try_from(u)) else { return };
                let needed = control.act(&Coordinates::from(q), &Speeds::from(u), command(t));
                inputs.copy_from_slice(&<[f64; 3]>::from(needed));
            }),
        },
        // The ball neither rises nor falls.
        events: vec![std::sync::Arc::new(|_, _, u: &[f64]| u[5])],
        ..Options::default()
    };
    let (mut ball, mut paddle) = (Vec::new(), Vec::new());
    let mut story = story::follow(&juggler, &start, options, (UNTIL, 0.01), |simulation, _| {
        let (t, q) = (simulation.time(), simulation.coordinates());
        ball.push([t, STRETCH * q[5]]);
        paddle.push([t, STRETCH * q[0]]);
    })?;
    story.picture.line(&paddle, "#888");
    story.picture.line(&ball, "#c33");
    for (from, to) in [(0.0, 4.0), (4.0, 8.0), (8.0, UNTIL)] {
        story.picture.line(&[[from, STRETCH * command(from)], [to, STRETCH * command(from)]], "#58c");
    }
    let mut table = String::from("  t (s)   top (m)   asked for (m)   beside the middle (mm)\n");
    let mut struck = 0.0;
    for event in &story.events {
        match event.kind {
            EventKind::Collision(_) => struck = event.time,
            // Where the vertical speed is zero in flight the ball is at its top.
            EventKind::Zero(_) => {
                let q = &event.coordinates;
                let beside = 1e3 * q[3].hypot(q[4]);
                table += &format!(
                    "{:7.3} {:9.4} {:13.2} {beside:17.1}\n",
                    event.time,
                    q[5],
                    command(struck - 1e-3)
                );
            }
            _ => {}
        }
    }
    story.text = format!(
        "A paddle keeps a ball in the air. At each of 1000 samples a second its controller computes with the generated collision what the next strike will\n\
         do, and changes the paddle's speed and tilts so that the ball rises to the height that is asked for and falls on the middle. It takes the ball's mass,\n\
         friction and restitution for other values than they are, and learns the restitution from the bounces. Each top of the flight:\n\n{table}\n\
         The picture shows the heights of the ball (red) and of the paddle (grey) over time, and the height that is asked for (blue)."
    );
    Ok(story)
}
