//! Directional derivatives of the variables of a unit, in constant modes of the contacts.
//!
//! Central differences over a step and half of it, extrapolated (Richardson): the error is of fourth order in
//! the step, which is a thousandth of the size of the variable. The same over an eighth of the step tells the error:
//! where both agree to 1e-9 the first is the answer, which has the smaller rounding. Where they do not, since the
//! state is near a border between the regions of two shapes for instance, shorter steps are tried, and those two in
//! sequence that agree best give the answer.

use crate::layout::VariableKind;
use crate::running::Running;
use crate::settings::Now;
use crate::values::Values;

/// The step, relative to the size of the variable or 1.
const STEP: f64 = 1e-3;
/// Each further step is this part of the one before; at most this many are tried.
const SHORTER: f64 = 0.125;
const STEPS: usize = 5;
/// Derivatives over two steps that agree to this part of their size, or of 1, are accepted at once; the call is refused
/// if none agree to [`DIFFER`].
const AGREE: f64 = 1e-9;
const DIFFER: f64 = 1e-6;

/// The derivatives of `unknowns` along a direction that changes each of `knowns` by its seed.
///
/// # Errors
///
/// A sentence: a variable cannot be an unknown or a known, the mechanism cannot be evaluated near the state, or
/// no derivative is found.
pub fn directional(
    running: &Running,
    now: &Now,
    unknowns: &[VariableKind],
    knowns: &[(VariableKind, f64)],
) -> Result<Vec<f64>, String> {
    // The direction in units of the sizes of the variables.
    let mut longest = 0.0_f64;
    for &(known, seed) in knowns {
        if !seed.is_finite() {
            return Err(format!("a seed is {seed}: it must be finite"));
        }
        let size = known_of(&mut now.clone(), known)?.abs().max(1.0);
        longest = longest.max(seed.abs() / size);
    }
    let at = |step: f64| -> Result<Vec<f64>, String> {
        let mut there = now.clone();
        for &(known, seed) in knowns {
            *known_of(&mut there, known)? += step * seed;
        }
        let mut values = Values::new(running, &there);
        unknowns.iter().map(|&unknown| values.number(unknown)).collect()
    };
    if longest == 0.0 {
        return Ok(vec![0.0; at(0.0)?.len()]);
    }
    let difference = |step: f64| -> Result<Vec<f64>, String> {
        let (plus, minus) = (at(step)?, at(-step)?);
        Ok(plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * step)).collect())
    };
    limit(unknowns.len(), STEP / longest, difference)
}

/// The limits of some differences for short steps, from this step on.
fn limit(
    count: usize,
    mut step: f64,
    difference: impl Fn(f64) -> Result<Vec<f64>, String>,
) -> Result<Vec<f64>, String> {
    let extrapolated = |step: f64| -> Result<Vec<f64>, String> {
        let (whole, half) = (difference(step)?, difference(0.5 * step)?);
        Ok(whole.iter().zip(&half).map(|(whole, half)| half + (half - whole) / 3.0).collect())
    };
    let mut last = extrapolated(step)?;
    let mut best = vec![(f64::INFINITY, 0.0); count];
    for _ in 1..STEPS {
        step *= SHORTER;
        let next = extrapolated(step)?;
        for ((best, last), next) in best.iter_mut().zip(&last).zip(&next) {
            let apart = (next - last).abs() / last.abs().max(1.0);
            if apart < best.0 {
                *best = (apart, *last);
            }
        }
        if best.iter().all(|(apart, _)| *apart <= AGREE) {
            break;
        }
        last = next;
    }
    if best.iter().any(|(apart, _)| *apart > DIFFER) {
        return Err("the variables are not differentiable at this state".to_owned());
    }
    Ok(best.into_iter().map(|(_, value)| value).collect())
}

/// The number of a known.
fn known_of(now: &mut Now, known: VariableKind) -> Result<&mut f64, String> {
    let found = match known {
        VariableKind::Time => Some(&mut now.time),
        VariableKind::Input(index) => now.inputs.get_mut(index),
        VariableKind::Coordinate(index) => now.coordinates.get_mut(index),
        VariableKind::Speed(index) => now.speeds.get_mut(index),
        _ => None,
    };
    found.ok_or_else(|| "a known must be the time, an input or a state".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(function: impl Fn(f64) -> f64, x: f64) -> Result<f64, String> {
        let difference = |step: f64| Ok(vec![(function(x + step) - function(x - step)) / (2.0 * step)]);
        limit(1, STEP, difference).map(|found| found[0])
    }

    #[test]
    fn smooth_functions_have_twelve_digits() {
        assert!((of(f64::sin, 0.7).unwrap() - 0.7_f64.cos()).abs() < 1e-12);
        assert!((of(f64::exp, 2.0).unwrap() / 2.0_f64.exp() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn borders_near_the_state_do_not_matter() {
        for x in [1e-5, 2e-4, -3e-5] {
            assert!(
                (of(|x: f64| x.abs() * x.exp(), x).unwrap() - (x.signum() + x.abs()) * x.exp()).abs() < 1e-8
            );
        }
    }

    #[test]
    fn jumps_have_no_derivative() {
        assert!(of(f64::signum, 0.0).is_err());
    }
}
