//! Finds jumps of the rates within a step: of forces that change at once, as `sign` does, or the direction of a spring whose
//! length passes through zero. What such a jump adds to the derivatives depends on how the surface of the jump moves.
//!
//! Theory: docs/theory.md, section 19.3.

use hodograph_simulation::stepper::Tolerances;

/// Changes of the rates below this part of them are left out.
const LEAST: f64 = 1e-6;
/// The error of a step is a part of its length times a jump within it. Where the length times the change of the rates is more
/// than so many times the allowed error, the change was smooth.
const ALLOWED: f64 = 1e4;
/// Number of times that a step is halved: a smooth change shrinks with it.
const HALVINGS: usize = 20;
/// The part of a change that is left of a jump at the end.
const LEFT: f64 = 0.5;

/// A time and the state and its rates there.
pub(crate) struct Place<'a> {
    pub time: f64,
    pub state: &'a [f64],
    pub rates: &'a [f64],
}

/// The time within a step at which the rates jump; `rates` writes those of a time and a state.
pub(crate) fn jump(
    before: &Place<'_>,
    after: &Place<'_>,
    tolerances: &Tolerances,
    mut rates: impl FnMut(f64, &[f64], &mut [f64]),
) -> Option<f64> {
    let count = before.state.len();
    let allowed = |i: usize| {
        tolerances.absolute + tolerances.relative * before.state[i].abs().max(after.state[i].abs())
    };
    let greatest =
        |of: &dyn Fn(usize) -> f64| (0..count).map(|i| of(i).abs() / allowed(i)).fold(0.0, f64::max);
    let change = |a: &[f64], b: &[f64]| greatest(&|i| b[i] - a[i]);
    let whole = change(before.rates, after.rates);
    let size = greatest(&|i| before.rates[i].abs().max(after.rates[i].abs()));
    let over = after.time - before.time;
    if whole <= LEAST * size || over * whole > ALLOWED {
        return None;
    }
    let (mut from, mut to) = (0.0, 1.0);
    let (mut first, mut last) = (before.rates.to_vec(), after.rates.to_vec());
    let (mut state, mut between) = (vec![0.0; count], vec![0.0; count]);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        for (i, value) in state.iter_mut().enumerate() {
            *value = before.state[i] + middle * (after.state[i] - before.state[i]);
        }
        rates(before.time + middle * over, &state, &mut between);
        let (left, right) = (change(&first, &between), change(&between, &last));
        // NaN is no change.
        if !left.max(right).is_finite() || left.max(right) <= LEFT * whole {
            return None;
        }
        if left >= right {
            (to, last) = (middle, between.clone());
        } else {
            (from, first) = (middle, between.clone());
        }
    }
    Some(before.time + from * over)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn within(step: f64, rate: impl Fn(f64) -> f64) -> Option<f64> {
        let tolerances = Tolerances { relative: 1e-12, absolute: 1e-12 };
        let rates = |_: f64, y: &[f64], rates: &mut [f64]| rates[0] = rate(y[0]);
        let ends = [1.0 - 0.3 * step, 1.0 + 0.7 * step];
        let of = ends.map(&rate);
        let place = |i: usize| Place { time: ends[i], state: &ends[i..=i], rates: &of[i..=i] };
        jump(&place(0), &place(1), &tolerances, rates)
    }

    #[test]
    fn jumps_are_told_from_steep_and_bent_rates() {
        let found = within(1e-11, |x| 1.0 - 0.01 * (x - 1.0).signum()).unwrap();
        assert!((found - 1.0).abs() < 1e-15, "{found}");
        assert_eq!(within(1e-11, |x| 1.0 + 1e8 * (x - 1.0)), None);
        assert_eq!(within(1e-11, |x| 1.0 + 1e8 * (x - 1.0).max(0.0)), None);
        assert_eq!(within(0.1, |x| x.sin()), None);
    }
}
