//! Random states of models, always the same ones.

use hodograph_generator::model::mechanism::Orientation;
use hodograph_generator::numeric::{self, Evaluation, State};
use hodograph_generator::program::Inputs;

use super::Model;

/// A small generator of random numbers (SplitMix64).
pub struct Random(u64);

impl Random {
    /// A generator that starts from a name.
    pub fn new(name: &str) -> Self {
        Random(name.bytes().fold(7, |seed, byte| seed.wrapping_mul(31) + u64::from(byte)))
    }

    /// A number between -1 and 1.
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A state at which both roads are defined, with what the numeric one says of it.
pub struct Sample {
    /// for derived programs
    pub inputs: Inputs,
    /// for the numeric evaluation
    pub state: State,
    /// what that says
    pub numeric: Evaluation,
}

/// States around the one that the model states: dependent coordinates completed, parameters off their
/// defaults.
pub fn samples(model: &Model, count: usize) -> Vec<Sample> {
    let m = &model.mechanism;
    let mut random = Random::new(&model.name);
    let mut samples = Vec::new();
    for _ in 0..20 * count {
        if samples.len() == count {
            break;
        }
        let mut state = State::of(m);
        // Moments of inertia keep their proportions, so that a body remains one that can be.
        let inertia = 1.0 + 0.01 * random.number();
        for (value, parameter) in state.parameters.iter_mut().zip(&m.parameters) {
            let alone = 1.0 + 0.01 * random.number();
            *value *= if parameter.unit == "kg*m^2" { inertia } else { alone };
        }
        state.inputs.iter_mut().for_each(|value| *value = 3.0 * random.number());
        state.time = random.number();
        state.coordinates.iter_mut().for_each(|value| *value += 0.4 * random.number());
        for frame in &m.frames {
            if let Orientation::Quaternion(parts) = frame.orientation {
                let norm = parts.iter().map(|part| state.coordinates[part.0].powi(2)).sum::<f64>().sqrt();
                parts.iter().for_each(|part| state.coordinates[part.0] /= norm);
            }
        }
        state.speeds.iter_mut().for_each(|value| *value = 2.0 * random.number());
        // A linkage does not close everywhere, and some descriptions have poles: such states are not sampled.
        let numeric = numeric::assemble(m, &mut state).and_then(|()| numeric::evaluate(m, &state));
        let Ok(numeric) = numeric else { continue };
        let inputs = Inputs {
            parameters: state.parameters.clone(),
            time: state.time,
            coordinates: state.coordinates.clone(),
            speeds: state.speeds.clone(),
            inputs: state.inputs.clone(),
            accelerations: (0..model.freedom()).map(|_| 5.0 * random.number()).collect(),
            tangent: Vec::new(),
        };
        samples.push(Sample { inputs, state, numeric });
    }
    assert_eq!(samples.len(), count, "{}: too few states are regular", model.name);
    samples
}
