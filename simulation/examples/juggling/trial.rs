//! What is tried: the juggler as it is, what its controller takes it for, where the ball starts, and the
//! heights that are asked for.

use hodograph::nalgebra::convert;
use hodograph::{Law, Scalar, Surface};

use super::control::Control;
use super::juggler::{Coordinates, Juggler, Parameters, Speeds};

/// The time of the trial, s.
pub const UNTIL: f64 = 12.0;

/// The height of the centre of the ball at the top of its flight that is asked for at a time, m.
pub fn command(time: f64) -> f64 {
    match time {
        t if t < 4.0 => 0.5,
        t if t < 8.0 => 0.8,
        _ => 0.3,
    }
}

/// The juggler as it is.
pub fn truth() -> (Parameters<f64>, Surface<f64>) {
    let parameters = Parameters { mb: 0.052, mp: 0.96, Jp: 0.0047, J: 8.5e-6, ..Parameters::default() };
    (parameters, Surface { mu: 0.25, e: 0.71, law: Law::Stronge })
}

/// The controller, which takes it for something else.
pub fn control<T: Scalar>() -> Control<T> {
    Control::new(Juggler::default(), Surface { mu: convert(0.4), e: convert(0.8), law: Law::Stronge })
}

/// The start: the ball is dropped beside the middle, with some spin.
pub fn start() -> (Coordinates<f64>, Speeds<f64>) {
    let coordinates = Coordinates { x: 0.06, y: -0.04, z: 0.5, ..Coordinates::default() };
    (coordinates, Speeds { w1: 3.0, w2: -5.0, w3: 8.0, ..Speeds::default() })
}
