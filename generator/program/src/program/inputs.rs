//! The input numbers of a program.

use super::graph::Input;

/// The inputs of a program, each in the unit that the model declares, in file order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    /// all parameters, also those that are `fixed` (which are not read)
    pub parameters: Vec<f64>,
    /// time, s
    pub time: f64,
    /// coordinates
    pub coordinates: Vec<f64>,
    /// independent speeds
    pub speeds: Vec<f64>,
    /// named inputs
    pub inputs: Vec<f64>,
    /// derivatives of the independent speeds; only inverse dynamics reads them
    pub accelerations: Vec<f64>,
    /// direction of a linearisation: independent coordinates, independent speeds, named inputs; only the
    /// state tangent reads it
    pub tangent: Vec<f64>,
}

impl Inputs {
    /// The value of an input; NaN if there is none.
    pub fn get(&self, input: Input) -> f64 {
        let (list, index) = match input {
            Input::Time => return self.time,
            Input::Parameter(index) => (&self.parameters, index),
            Input::Coordinate(index) => (&self.coordinates, index),
            Input::Speed(index) => (&self.speeds, index),
            Input::Input(index) => (&self.inputs, index),
            Input::Acceleration(index) => (&self.accelerations, index),
            Input::Tangent(index) => (&self.tangent, index),
        };
        list.get(index as usize).copied().unwrap_or(f64::NAN)
    }
}
