//! Recursive summation (56): Euler's method with a constant step of normal impulse.

use nalgebra::Vector3;

use super::{
    MethodError, Solution,
    equations::{I_N, I_S, I_T, NORMAL_WORK, PHI, Problem, S, State, V_N, WORK, between},
    integrate::Slid,
    law::{Ending, Event},
};
use crate::{Path, ReducedMatrix, Surface};

/// Steps after which a summation gives up.
const STEPS: u32 = 1_000_000;

/// How fine the summation is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summation {
    /// The paper's refinement factor k >= 1: steps to a unit of impulse.
    pub k: u32,
    /// The unit of impulse in N s. The paper's is 1 N s, whatever the system. `None` takes -v_n1 / (4 m_nn),
    /// which is 1.05 N s for its two sleds and does not depend on the units.
    pub unit: Option<f64>,
}

impl Summation {
    /// With k steps to the unit -v_n1 / (4 m_nn).
    pub fn new(k: u32) -> Self {
        Self { k, unit: None }
    }

    /// The step D in the scaled units.
    pub(super) fn step(&self, problem: &Problem) -> Result<f64, MethodError> {
        if self.k == 0 {
            return Err(MethodError::BadOption { name: "k", value: 0.0 });
        }
        let unit = match self.unit {
            None => 0.25,
            Some(unit) if unit > 0.0 && unit.is_finite() => problem.impulse(unit),
            Some(value) => return Err(MethodError::BadOption { name: "unit", value }),
        };
        Ok(unit / f64::from(self.k))
    }
}

/// Sums (56) with the step D = unit / k until the law ends the collision; where slip stops the step is cut
/// short, and lambda goes to -1 (sticking) or 1 (renewal). Corrected in (56f) and (56h); within the last
/// step, and where compression ends, all quantities are interpolated linearly.
///
/// The error falls like 1 / k. Near the end of slip steps larger than [`super::stability`] allows make it
/// large.
///
/// # Errors
/// As [`crate::solve`], else [`MethodError::Unfinished`] or [`MethodError::BadOption`].
pub fn sum(
    matrix: &ReducedMatrix<f64>,
    approach: &Vector3<f64>,
    surface: &Surface<f64>,
    options: &Summation,
) -> Result<Solution, MethodError> {
    let problem = Problem::new(matrix, approach, surface)?;
    let d = options.step(&problem)?;
    let mut ending = Ending::new(surface);
    let mut made = 0;
    let mut at = match slide(&problem, d, &mut ending, &mut made)? {
        Slid::Ended(end) => return Ok(problem.outcome(approach, (&end, Path::Sliding), &ending, made)),
        Slid::Stopped(at) => ending.slip_stopped(&problem, at),
    };
    let arc = problem.terminal();
    let path = arc.path(problem.start()[S] > 0.0);
    at = arc.entered(at);
    if arc.v_n <= 0.0 {
        let end = ending.close(&problem, &arc, at, d * problem.pace())?;
        return Ok(problem.outcome(approach, (&end, path), &ending, made));
    }
    loop {
        count(&mut made, &problem, &at)?;
        let s = at[S] + arc.s * d;
        let v_n = at[V_N] + arc.v_n * d;
        let to = [
            arc.phi,
            s,
            v_n,
            at[I_T] + arc.impulse.x * d,
            at[I_S] + arc.impulse.y * d,
            at[WORK] + (v_n - problem.mu * s) * d,
            at[NORMAL_WORK] + v_n * d,
            at[I_N] + d,
        ];
        if let Some(end) = events(&mut ending, &at, &to) {
            return Ok(problem.outcome(approach, (&end, path), &ending, made));
        }
        at = to;
    }
}

/// Sums the sliding part, lambda = 0.
pub(super) fn slide(
    problem: &Problem,
    d: f64,
    ending: &mut Ending,
    made: &mut u32,
) -> Result<Slid, MethodError> {
    let mut at = problem.start();
    if at[S] <= 0.0 {
        return Ok(Slid::Stopped(at));
    }
    let mu = problem.mu;
    let (mut sin, mut cos) = at[PHI].sin_cos();
    let [_, mut g, mut h] = problem.fgh(cos, sin);
    loop {
        count(made, problem, &at)?;
        let stops = at[S] + g * d <= 0.0;
        let d = if stops { -at[S] / g } else { d };
        let turn = h / at[S] * d;
        let phi = at[PHI] + turn;
        let s = if stops { 0.0 } else { at[S] + g * d };
        let small = turn.abs() <= SMALL && !made.is_multiple_of(TURNS);
        (sin, cos) = if small { turned(sin, cos, turn) } else { phi.sin_cos() };
        let f;
        [f, g, h] = problem.fgh(cos, sin);
        let v_n = at[V_N] + f * d;
        let to = [
            phi,
            s,
            v_n,
            at[I_T] - mu * cos * d,
            at[I_S] - mu * sin * d,
            at[WORK] + (v_n - mu * s) * d,
            at[NORMAL_WORK] + v_n * d,
            at[I_N] + d,
        ];
        if let Some(end) = events(ending, &at, &to) {
            return Ok(Slid::Ended(end));
        }
        at = to;
        if stops {
            return Ok(Slid::Stopped(at));
        }
    }
}

/// The greatest angle that [`turned`] takes, in radians.
const SMALL: f64 = 0.25;

/// After so many turns sine and cosine are computed from the angle again, so that roundings of turns do not
/// add up.
const TURNS: u32 = 256;

/// Sine and cosine of an angle, given as such, plus a small one, whose series end where their rests are below
/// rounding.
#[inline]
fn turned(sin: f64, cos: f64, by: f64) -> (f64, f64) {
    let z = by * by;
    let (zz, zzz) = (z * z, z * z * z);
    let odd = (1.0 / 120.0 - z * (1.0 / 5040.0)) + zz * (1.0 / 362_880.0 - z * (1.0 / 39_916_800.0));
    let even = (-1.0 / 720.0 + z * (1.0 / 40_320.0)) + zz * (-1.0 / 3_628_800.0 + z * (1.0 / 479_001_600.0));
    let small = by * ((1.0 - z * (1.0 / 6.0)) + zz * odd);
    let less = z * (-0.5 + z * (1.0 / 24.0)) + zzz * even;
    (sin + (sin * less + cos * small), cos + (cos * less - sin * small))
}

fn count(made: &mut u32, problem: &Problem, at: &State) -> Result<(), MethodError> {
    if *made >= STEPS {
        return Err(MethodError::Unfinished { steps: *made, normal_velocity: problem.velocity(at[V_N]) });
    }
    *made += 1;
    Ok(())
}

/// Records the events within a step; returns the state in which the collision ended, if it did.
#[inline(always)]
fn events(ending: &mut Ending, from: &State, to: &State) -> Option<State> {
    // Most steps have none.
    if ending.is_quiet(to) { None } else { record(ending, from, to) }
}

#[inline(never)]
fn record(ending: &mut Ending, from: &State, to: &State) -> Option<State> {
    let mut from = *from;
    while let Some(mut event) = ending.between(to) {
        let cut = |event, from: &State, to: &State| {
            let (low, high) = (ending.height(event, from), ending.height(event, to));
            let part = if high > low { (-low / (high - low)).clamp(0.0, 1.0) } else { 1.0 };
            between(from, to, part)
        };
        let mut at = cut(event, &from, to);
        if event == Event::Approach && ending.is_over(&at) {
            event = Event::End;
            at = cut(event, &from, &at);
        }
        if ending.note(event, &mut at) {
            return Some(at);
        }
        from = at;
    }
    None
}
