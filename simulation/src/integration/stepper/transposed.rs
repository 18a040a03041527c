//! The transpose of the derivative of a step: how a function of the state at its end depends on the state at its start.
//!
//! With stages Y_i = y + h sum_j a_ij k_j, k_i = f(t + c_i h, Y_i) and the end y + h sum_i b_i k_i, weights w of the end
//! give the weights of k_i, h (b_i w + sum_j a_ji v_j), and of Y_i, v_i, from the last stage to the first; those of
//! the start are w + sum_i v_i.

use super::{METHOD, STAGES, add};

/// A system y' = f(t, y) whose derivative can be transposed.
pub trait TransposedSystem {
    /// Why there are no rates.
    type Error;

    /// Writes the rates of a stage, and keeps what [`TransposedSystem::transpose`] needs.
    ///
    /// # Errors
    ///
    /// If there are none.
    fn rates(&mut self, stage: usize, t: f64, y: &[f64], rates: &mut [f64]) -> Result<(), Self::Error>;

    /// Writes the derivatives, by the state of a stage, of the sum of its rates with these weights.
    ///
    /// # Errors
    ///
    /// If there are none.
    fn transpose(&mut self, stage: usize, weights: &[f64], by_state: &mut [f64]) -> Result<(), Self::Error>;
}

/// Replaces the weights of the end of a step from (t, y) over h by those of its start.
///
/// # Errors
///
/// Those of the system.
pub fn transpose<S: TransposedSystem>(
    system: &mut S,
    (t, y): (f64, &[f64]),
    h: f64,
    weights: &mut [f64],
) -> Result<(), S::Error> {
    let n = y.len();
    let mut k = vec![0.0; STAGES * n];
    let mut state = vec![0.0; n];
    for stage in 0..STAGES {
        let (before, rest) = k.split_at_mut(stage * n);
        state.copy_from_slice(y);
        add(&mut state, before, &METHOD.a[stage], h);
        system.rates(stage, t + METHOD.c[stage] * h, &state, &mut rest[..n])?;
    }
    // v_i, in place of k_i.
    let mut of_rates = vec![0.0; n];
    for stage in (0..STAGES).rev() {
        for (of, weight) in of_rates.iter_mut().zip(weights.iter()) {
            *of = h * METHOD.b[stage] * weight;
        }
        for later in stage + 1..STAGES {
            let factor = h * METHOD.a[later][stage];
            if factor != 0.0 {
                let v = &k[later * n..][..n];
                of_rates.iter_mut().zip(v).for_each(|(of, v)| *of += factor * v);
            }
        }
        system.transpose(stage, &of_rates, &mut k[stage * n..][..n])?;
    }
    for v in k.chunks_exact(n.max(1)) {
        weights.iter_mut().zip(v).for_each(|(weight, v)| *weight += v);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integration::stepper::part;

    /// y0' = y1, y1' = -sin(y0) + t.
    #[derive(Default)]
    struct Pendulum(Vec<f64>);

    impl TransposedSystem for Pendulum {
        type Error = ();

        fn rates(&mut self, _: usize, t: f64, y: &[f64], rates: &mut [f64]) -> Result<(), ()> {
            (rates[0], rates[1]) = (y[1], t - y[0].sin());
            self.0.push(y[0]);
            Ok(())
        }

        fn transpose(&mut self, stage: usize, weights: &[f64], by_state: &mut [f64]) -> Result<(), ()> {
            (by_state[0], by_state[1]) = (-self.0[stage].cos() * weights[1], weights[0]);
            Ok(())
        }
    }

    /// Weights of the end times its derivative are the weights of the start.
    #[test]
    fn a_step_is_transposed() {
        let (start, h, along, end) = ([0.7, -0.3], 0.8, [0.6, -1.1], [1.3, 0.4]);
        // The equations together with their derivative along a direction.
        let mut both = |t: f64, y: &[f64], rates: &mut [f64]| {
            rates.copy_from_slice(&[y[1], t - y[0].sin(), y[3], -y[0].cos() * y[2]]);
        };
        let made = part(&mut both, (0.2, &[start[0], start[1], along[0], along[1]], None), h).unwrap();
        let mut weights = end;
        transpose(&mut Pendulum::default(), (0.2, &start), h, &mut weights).unwrap();
        let forward = end[0] * made.end[2] + end[1] * made.end[3];
        let backward = weights[0] * along[0] + weights[1] * along[1];
        assert!((forward - backward).abs() < 1e-14, "{forward} {backward}");
    }
}
