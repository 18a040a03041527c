//! One step of Dormand and Prince's method of order 5 with an error estimate of order 4.

use super::equations::State;

const A: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// The fifth-order weights less the fourth-order ones.
const E: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// The end of a step.
pub(super) struct Step {
    pub state: State,
    /// The rates at the end.
    pub rates: State,
    /// Estimate of the error of each component.
    pub error: State,
}

/// Steps by `h` from a state whose rates are known; the equations are autonomous.
#[inline]
pub(super) fn step(rates: impl Fn(&State) -> State, from: &State, first: &State, h: f64) -> Step {
    let mut k = [*first; 7];
    let mut state = *from;
    for (i, row) in A.iter().enumerate() {
        state = core::array::from_fn(|j| {
            let sum: f64 = row.iter().zip(&k).take(i + 1).map(|(a, k)| a * k[j]).sum();
            from[j] + h * sum
        });
        k[i + 1] = rates(&state);
    }
    let error = core::array::from_fn(|j| h * E.iter().zip(&k).map(|(e, k)| e * k[j]).sum::<f64>());
    Step { state, rates: k[6], error }
}
