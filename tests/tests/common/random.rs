//! Random states of models, always the same ones.

use hodograph_generator::model::mechanism::Orientation;
use hodograph_generator::numeric::{self, Evaluation, State};
use hodograph_generator::program::Inputs;

pub use hodograph_random::Random;

use super::Model;

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
    let mut random = Random::named(&model.name);
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
