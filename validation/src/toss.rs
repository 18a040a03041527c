//! One toss.

use std::time::{Duration, Instant};

use hodograph::{Contacts, State};
use hodograph_simulation::{Options, Progress, Simulation};
use serde::{Deserialize, Serialize};

/// The start of a toss, in the order of the model.
#[derive(Deserialize)]
pub struct Toss {
    coordinates: Vec<f64>,
    speeds: Vec<f64>,
    /// number of frames, the start included
    frames: usize,
}

/// A toss that was not predicted to its last frame.
#[derive(Serialize)]
pub struct Failure {
    /// its place in the request
    pub index: usize,
    /// name of the error, or `no_end`
    pub kind: String,
    /// time that was reached, s
    pub time: f64,
    pub message: String,
}

/// Kind, time and message of an end before the last frame.
type Early = (String, f64, String);

/// Coordinates at all frames that are reached.
pub fn follow(
    mechanism: &dyn Contacts<f64>,
    toss: &Toss,
    options: &Options,
    frame: f64,
    patience: f64,
) -> (Vec<Vec<f64>>, Option<Early>) {
    let until = Instant::now() + Duration::from_secs_f64(patience);
    let start = State { time: 0.0, coordinates: &toss.coordinates, speeds: &toss.speeds, inputs: &[] };
    let mut simulation = match Simulation::new(mechanism, &start, options.clone()) {
        Ok(simulation) => simulation,
        Err(error) => {
            let early = (error.kind.name().to_owned(), error.time, error.to_string());
            return (vec![toss.coordinates.clone()], Some(early));
        }
    };
    let mut frames = Vec::with_capacity(toss.frames);
    for index in 0..toss.frames {
        loop {
            match simulation.advance(frame * index as f64) {
                Ok(Progress::Reached) => break,
                Ok(Progress::Event(event)) if Instant::now() > until => {
                    let message = format!("{patience} s of computing are over");
                    return (frames, Some(("no_end".to_owned(), event.time, message)));
                }
                Ok(Progress::Event(_)) => {}
                Err(error) => {
                    let early = (error.kind.name().to_owned(), error.time, error.to_string());
                    return (frames, Some(early));
                }
            }
        }
        frames.push(simulation.coordinates().to_vec());
    }
    (frames, None)
}
