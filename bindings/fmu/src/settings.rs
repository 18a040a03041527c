//! The state of a unit, and its settings, which are fixed after the initialization.

use hodograph::{Law, State};
use serde::{Deserialize, Serialize};

use crate::layout::{Defaults, Layout, TOLERANCE};

/// A state, owned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Now {
    /// s
    pub time: f64,
    /// all coordinates
    pub coordinates: Vec<f64>,
    /// independent speeds
    pub speeds: Vec<f64>,
    /// inputs
    pub inputs: Vec<f64>,
}

impl Now {
    /// The state for the traits of mechanisms.
    pub fn state(&self) -> State<'_> {
        State { time: self.time, coordinates: &self.coordinates, speeds: &self.speeds, inputs: &self.inputs }
    }
}

/// The values that are fixed after the initialization.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// tolerance of the integration
    pub tolerance: f64,
    /// greatest step of the integration, s
    pub max_step: f64,
    /// values of the parameters
    pub parameters: Vec<f64>,
    /// index of each contact that can close, with mu, e and the number of its law, from 1
    pub surfaces: Vec<(usize, f64, f64, i64)>,
    /// the initial state
    pub start: Now,
}

impl Settings {
    /// The settings that the model states.
    pub fn of(layout: &Layout, defaults: &Defaults) -> Self {
        let [parameters, coordinates, speeds, inputs] = layout.start.clone();
        let law =
            |law: Law| Law::ALL.iter().position(|other| *other == law).map_or(1, |place| place as i64 + 1);
        let surfaces = layout.surfaces.iter();
        Self {
            tolerance: TOLERANCE,
            max_step: defaults.max_step,
            parameters,
            surfaces: surfaces.map(|(contact, own)| (*contact, own.mu, own.e, law(own.law))).collect(),
            start: Now { time: 0.0, coordinates, speeds, inputs },
        }
    }
}
