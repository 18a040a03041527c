//! Integrates stiff parts of a motion with their derivatives: steps of collocation whose lengths their errors
//! determine.
//!
//! Theory: docs/theory.md, section 19.1.

use hodograph_simulation::stepper::Tolerances;

use crate::Reason;
use crate::collocation::{STAGES, Stages, Stretch, carry};
use crate::field::At;
use crate::modes::ROUNDINGS;
use crate::motion::{Piece, Propagation};

/// Largest number of steps that are tried within one step of the motion.
const TRIALS: usize = 500;
/// Shortest step, relative to what is left of the step of the motion.
const SHORTEST: f64 = 1e-9;
/// Steps aim at this part of the length that the error allows, and change at most by these factors.
const SAFETY: f64 = 0.9;
const LEAST_FACTOR: f64 = 0.1;
const GREATEST_FACTOR: f64 = 4.0;

/// Two steps, one after the other.
struct Made {
    halves: [Stages; 2],
    /// the state with its derivatives at the end
    end: Vec<f64>,
    /// relative to the tolerances
    error: f64,
}

impl Propagation<'_> {
    /// Carries state and derivatives through a stiff stretch of the part with the index `of`, from one time to another.
    pub(crate) fn collocate(
        &self,
        (of, stretch): (usize, &Stretch<'_>),
        (from, to): (f64, f64),
        y: &mut [f64],
        mut pieces: Option<&mut Vec<Piece>>,
    ) -> Result<(), Reason> {
        let (mut now, mut h) = (from, to - from);
        let mut why = Reason::Inaccurate(f64::INFINITY);
        for _ in 0..TRIALS {
            if now >= to {
                return Ok(());
            }
            let made = self.halves(stretch, (now, y), h);
            let factor = made.as_ref().map_or(LEAST_FACTOR, |made| {
                (SAFETY * made.error.powf(-1.0 / (STAGES as f64 + 1.0))).clamp(LEAST_FACTOR, GREATEST_FACTOR)
            });
            match made {
                Ok(made) if made.error <= 1.0 => {
                    // The sum of steps may miss the end by rounding.
                    let end = if h >= to - now { to } else { now + h };
                    self.no_jump(stretch, (now, y), (end, &made.end))?;
                    now = end;
                    y.copy_from_slice(&made.end);
                    h = (h * factor).min(to - now);
                    if let Some(pieces) = &mut pieces {
                        pieces.extend(made.halves.map(|stages| Piece::Collocation { part: of, stages }));
                    }
                    continue;
                }
                Ok(made) => why = Reason::Inaccurate(made.error),
                Err(cause) => why = cause,
            }
            h *= factor.min(SAFETY);
            if h < SHORTEST * (to - now) {
                break;
            }
        }
        Err(why)
    }

    /// Refuses a step within which the rates of the state jump.
    fn no_jump(
        &self,
        stretch: &Stretch<'_>,
        before: (f64, &[f64]),
        after: (f64, &[f64]),
    ) -> Result<(), Reason> {
        let rates = |(time, y): (f64, &[f64])| {
            let state = &y[..stretch.part.first.len()];
            let none = vec![0.0; state.len() * self.field.k];
            let at = At { time, state, ..self.field.at_start(stretch.part, &none) };
            self.field.mode_rates(&stretch.modes, &at).map(|found| found.rates)
        };
        let (first, last) = (rates(before)?, rates(after)?);
        let ends = ((before.0, before.1, &first[..]), (after.0, after.1, &last[..]));
        match self.jumps((stretch.part, &stretch.modes), ends.0, ends.1) {
            Some(time) => Err(Reason::ForceJump { time }),
            None => Ok(()),
        }
    }

    /// Two steps over half the time each, compared with one step.
    fn halves(&self, stretch: &Stretch<'_>, (t, y): (f64, &[f64]), h: f64) -> Result<Made, Reason> {
        let over = |t: f64, y: &[f64], h: f64| -> Result<(Stages, Vec<f64>), Reason> {
            let (state, by) = y.split_at(stretch.part.first.len());
            let made = self.collocation().step(stretch, (t, state), h)?;
            let mut end = made.0.end().to_vec();
            end.extend(carry(&self.field, stretch, &made, by)?);
            Ok((made.0, end))
        };
        let (_, whole) = over(t, y, h)?;
        let (first, middle) = over(t, y, 0.5 * h)?;
        let (second, end) = over(t + 0.5 * h, &middle, 0.5 * h)?;
        let Tolerances { relative, absolute } = *stretch.tolerances;
        let (count, k) = (stretch.part.first.len(), self.field.k);
        let none = vec![0.0; count * k];
        let at = At { time: t + h, state: &end[..count], ..self.field.at_start(stretch.part, &none) };
        let rounding = ROUNDINGS * f64::EPSILON + self.field.rounding_of_directions(&stretch.modes, &at)?;
        let mut greatest = vec![0.0_f64; k];
        for (place, by) in end[count..].iter().enumerate() {
            greatest[place % k] = greatest[place % k].max(by.abs());
        }
        let off = |(index, (whole, end)): (usize, (&f64, &f64))| {
            let rounding = if index < count { 0.0 } else { rounding * greatest[(index - count) % k] };
            let allowed = absolute + relative * end.abs().max(y[index].abs()) + rounding;
            ((whole - end) / allowed).powi(2)
        };
        let squares: f64 = whole.iter().zip(&end).enumerate().map(off).sum();
        let error = (squares / end.len() as f64).sqrt() / 2.0_f64.powi(STAGES as i32);
        if !error.is_finite() {
            return Err(Reason::Inaccurate(error));
        }
        Ok(Made { halves: [first, second], end, error })
    }
}
