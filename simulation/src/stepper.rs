//! Makes one step of the integration, with dense output.
//!
//! Dormand and Prince's method of order 8 of the crate `differential-equations`. Only its steps, its step
//! size control and its dense output are used; time is local to the step, so that short steps late in a
//! motion lose no digits.

use differential_equations::error::Error;
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;

type Method = ExplicitRungeKutta<Ordinary, DormandPrince, f64, Vec<f64>, 8, 12, 16>;

/// Most halvings (or so) of a step that is refused.
const REFUSALS: usize = 60;

/// A step that was made: from `t` over `h`.
#[derive(Clone)]
pub(crate) struct Step {
    pub t: f64,
    pub h: f64,
    /// The step size that the error allows next.
    pub next: f64,
    pub end: Vec<f64>,
    start: Vec<f64>,
    method: Option<Method>,
}

impl Step {
    /// Nothing moves over this time.
    pub fn still(t: f64, h: f64, state: &[f64]) -> Self {
        Self { t, h, next: h, end: state.to_vec(), start: state.to_vec(), method: None }
    }

    /// The state at the beginning.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The state at a fraction of the step.
    pub fn at(&mut self, fraction: f64) -> Vec<f64> {
        if fraction >= 1.0 {
            return self.end.clone();
        }
        if fraction <= 0.0 {
            return self.start.clone();
        }
        match self.method.as_mut().map(|method| method.interpolate(fraction * self.h)) {
            Some(Ok(state)) => state,
            _ => self.end.clone(),
        }
    }

    /// Takes another end, which differs from the integrated one by the correction of drift.
    pub fn corrected(&mut self, end: &[f64]) {
        self.end = end.to_vec();
    }
}

impl std::fmt::Debug for Step {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "Step from {} over {}", self.t, self.h)
    }
}

/// The rates y' = f(t, y) of a system.
struct System<'a, F> {
    rates: &'a F,
    t: f64,
}

impl<F: Fn(f64, &[f64], &mut [f64])> ODE<f64, Vec<f64>> for System<'_, F> {
    fn diff(&self, t: f64, y: &Vec<f64>, dydt: &mut Vec<f64>) {
        (self.rates)(self.t + t, y, dydt);
    }
}

/// Relative and absolute tolerance of a step; absolute per component.
#[derive(Clone, Debug)]
pub(crate) struct Tolerances {
    pub relative: f64,
    pub absolute: f64,
}

/// A step from (t, y) of at most `h`, whose error is within the tolerances. `None` if there is none: the
/// rates are not finite, or the step became too small. Rates that are not finite make a step be refused.
pub(crate) fn step(
    rates: &impl Fn(f64, &[f64], &mut [f64]),
    t: f64,
    y: &[f64],
    h: f64,
    tolerances: &Tolerances,
) -> Option<Step> {
    let least = 16.0 * f64::EPSILON * t.abs().max(1e-9 * h);
    let system = System { rates, t };
    let start = y.to_vec();
    let mut method = Method::dop853();
    method.h0 = h;
    method.max_steps = REFUSALS + 2;
    method.rtol = tolerances.relative.into();
    method.atol = tolerances.absolute.into();
    method.init(&system, 0.0, f64::INFINITY, &start).ok()?;
    for _ in 0..REFUSALS {
        let tried = method.h();
        if tried < least && tried < h {
            return None;
        }
        match method.step(&system) {
            Ok(_) if matches!(method.status(), Status::RejectedStep) => {}
            Ok(_) => {
                if method.y().iter().all(|value| value.is_finite()) {
                    let (next, h) = (method.h(), method.t());
                    let mut end = method.y().clone();
                    unrounded(&system, h, &start, &mut end);
                    return Some(Step { t, h, next, end, start, method: Some(method) });
                }
                return None;
            }
            Err(Error::Stiffness { .. }) => {}
            Err(_) => return None,
        }
    }
    None
}

/// Takes the trapezoidal rule where it agrees with the step but for rounding (constant acceleration), for it
/// has fewer roundings and no bias: over 1e4 bounces that of the method's twelve weights would be seen in the
/// energy.
fn unrounded<F: Fn(f64, &[f64], &mut [f64])>(system: &System<'_, F>, h: f64, start: &[f64], end: &mut [f64]) {
    let (mut first, mut last) = (vec![0.0; start.len()], vec![0.0; start.len()]);
    (system.rates)(system.t, start, &mut first);
    // Speeds first, then the coordinates that follow from them.
    for _ in 0..2 {
        (system.rates)(system.t + h, end, &mut last);
        let mut changed = false;
        for (i, end) in end.iter_mut().enumerate() {
            let rule = start[i] + 0.5 * h * (first[i] + last[i]);
            let size = start[i].abs() + h * (first[i].abs() + last[i].abs());
            if rule != *end && (rule - *end).abs() <= 32.0 * f64::EPSILON * size {
                *end = rule;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}

/// A step from (t, y) over exactly `h`, whatever its error: part of a step that was accepted.
pub(crate) fn part(rates: &impl Fn(f64, &[f64], &mut [f64]), t: f64, y: &[f64], h: f64) -> Option<Step> {
    if h <= 0.0 {
        return Some(Step::still(t, 0.0, y));
    }
    let loose = Tolerances { relative: 1e200, absolute: 1e200 };
    step(rates, t, y, h, &loose).filter(|made| (made.h - h).abs() <= 1e-12 * h)
}
