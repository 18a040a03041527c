//! Directional derivatives of the variables of a unit, in constant modes of the contacts.
//!
//! Central differences over a step and half of it, extrapolated (Richardson): the error is of fourth order in
//! the step, which is a thousandth of the size of the variable.

use crate::layout::VariableKind;
use crate::running::Running;
use crate::settings::Now;
use crate::values::Values;

/// The step, relative to the size of the variable or 1.
const STEP: f64 = 1e-3;

/// The derivatives of `unknowns` along a direction that changes each of `knowns` by its seed.
///
/// # Errors
///
/// A sentence: a variable cannot be an unknown or a known, or the mechanism cannot be evaluated near the
/// state.
pub fn directional(
    running: &Running,
    now: &Now,
    unknowns: &[VariableKind],
    knowns: &[(VariableKind, f64)],
) -> Result<Vec<f64>, String> {
    // The direction in units of the sizes of the variables.
    let mut longest = 0.0_f64;
    for &(known, seed) in knowns {
        let size = known_of(&mut now.clone(), known)?.abs().max(1.0);
        longest = longest.max(seed.abs() / size);
    }
    if longest == 0.0 {
        return Ok(vec![0.0; unknowns.len()]);
    }
    let at = |step: f64| -> Result<Vec<f64>, String> {
        let mut there = now.clone();
        for &(known, seed) in knowns {
            *known_of(&mut there, known)? += step * seed;
        }
        let mut values = Values::new(running, &there);
        unknowns.iter().map(|&unknown| values.number(unknown)).collect()
    };
    let difference = |step: f64| -> Result<Vec<f64>, String> {
        let (plus, minus) = (at(step)?, at(-step)?);
        Ok(plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * step)).collect())
    };
    let step = STEP / longest;
    let (whole, half) = (difference(step)?, difference(0.5 * step)?);
    Ok(whole.iter().zip(&half).map(|(whole, half)| half + (half - whole) / 3.0).collect())
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
