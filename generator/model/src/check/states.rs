//! The states at which the checks evaluate a mechanism: arbitrary ones near the initial values, and some all
//! over the ranges of the coordinates.

use crate::arbitrary::Arbitrary;
use crate::model::mechanism::{Mechanism, Orientation};
use crate::numeric::{Evaluation, Evaluator, State, Views, hyper_dual::HyperDual};

/// How far the states lie from the initial values, m or rad.
const DISTANCES: [f64; 5] = [0.7, 0.4, 0.2, 0.05, 0.0];

/// The number of the first of them that is near.
pub const NEAR: usize = 2;

/// How far, and how many, those are that go all round.
const FARTHEST: f64 = 3.2;
const FAR: u64 = 16;

/// Times just after the start, s, for the arbitrary states.
const EARLY: [f64; 5] = [0.1, 0.01, 1e-4, 1e-6, 0.0];

/// What is seen at a state.
pub struct Seen<'m> {
    /// its number among the arbitrary states: the last is the nearest to the initial values
    pub number: usize,
    /// the state
    pub state: &'m State,
    /// what holds there
    pub at: Evaluation,
    /// where that comes from
    pub views: Views<'m>,
}

/// States away from the initial one, the most general first. The numbers are arbitrary but always the same.
pub fn arbitrary(m: &Mechanism) -> Vec<State> {
    DISTANCES.iter().enumerate().map(|(i, distance)| state(m, *distance, i as u64)).collect()
}

/// States all over the ranges of the coordinates.
pub fn far(m: &Mechanism) -> Vec<State> {
    (0..FAR).map(|i| state(m, FARTHEST, DISTANCES.len() as u64 + i)).collect()
}

/// States as the arbitrary ones, but soon after the start, the last at the start: something may end early.
pub fn early(m: &Mechanism) -> Vec<State> {
    let at = |(state, time): (State, f64)| State { time, ..state };
    arbitrary(m).into_iter().zip(EARLY).map(at).collect()
}

fn state(m: &Mechanism, distance: f64, seed: u64) -> State {
    let mut state = State::of(m);
    let mut arbitrary = Arbitrary::after(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed + 1));
    let mut next = || arbitrary.number();
    for (value, parameter) in state.parameters.iter_mut().zip(&m.parameters) {
        if parameter.value.is_none() {
            *value = 1.0 + 0.5 * next();
        }
    }
    state.time = 0.5 * (1.0 + next());
    for (q, quantity) in state.coordinates.iter_mut().zip(&m.coordinates) {
        *q += distance * next() / quantity.factor;
    }
    for (u, quantity) in state.speeds.iter_mut().zip(&m.speeds) {
        *u += (0.5 + 0.4 * next()) / quantity.factor;
    }
    for input in &mut state.inputs {
        *input += next();
    }
    for frame in &m.frames {
        if let Orientation::Quaternion(ids) = &frame.orientation {
            let length = ids.iter().map(|id| state.coordinates[id.0].powi(2)).sum::<f64>().sqrt();
            if length > 0.0 {
                ids.iter().for_each(|id| state.coordinates[id.0] /= length);
            }
        }
    }
    state
}

/// The state with only what the model itself says: parameters without a value, and where `dependent` is false
/// what the configuration equations determine, are not numbers, and neither is what depends on them.
pub fn stated(m: &Mechanism, state: &State, dependent: bool) -> State {
    let mut state = state.clone();
    let missing = |value: &mut f64| *value = f64::NAN;
    let valueless = m.parameters.iter().map(|parameter| parameter.value.is_none());
    state
        .parameters
        .iter_mut()
        .zip(valueless)
        .filter(|(_, none)| *none)
        .for_each(|(value, _)| missing(value));
    let unknown = m.coordinates.iter().map(|coordinate| coordinate.dependent && !dependent);
    state.coordinates.iter_mut().zip(unknown).filter(|(_, none)| *none).for_each(|(value, _)| missing(value));
    state
}

/// Values of expressions at a state at rest.
pub fn at_rest<'m>(m: &'m Mechanism, state: &'m State) -> Evaluator<'m> {
    let coordinates = state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect();
    let speeds = vec![HyperDual::ZERO; m.speeds.len()];
    Evaluator::new(m, &state.parameters, &state.inputs, HyperDual::constant(state.time), coordinates, speeds)
}
