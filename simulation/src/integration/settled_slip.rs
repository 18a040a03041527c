//! Finds the sliding contacts whose small slip has settled in a direction that follows from the state
//! ([`crate::closed::slip_direction`]).

use hodograph::State;
use nalgebra::Vector2;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Forces, Hold, Lacking, forces};
use crate::closed::scales::Scales;
use crate::closed::slip_direction::settle_directions;
use crate::contact_problem::Wanted;
use crate::integration::motion::{Evaluation, Motion};

/// The direction follows from the state if it settles within this part of the time of the problem.
const SETTLES: f64 = 2.5e-5;
/// The allowed difference between slip and settled slip, relative to the speed of the problem (its length
/// over its time).
const SETTLED: f64 = 1e-12;
/// Time difference for the rate of the settled direction, relative to the time of the problem.
const AHEAD: f64 = 5e-5;
/// Difference of angles, rad.
const TURN: f64 = 1e-5;

/// The contacts whose direction of slip has settled, with the rate at which it turns, rad/s.
pub(crate) fn settled(
    motion: &Motion<'_>,
    t: f64,
    y: &[f64],
    here: &Evaluation,
    scales: &Scales,
) -> Vec<Option<f64>> {
    let ahead_by = AHEAD * scales.time;
    let closed = motion.closed;
    let mut omegas = vec![None; closed.len()];
    if closed.iter().all(|contact| contact.slides.is_none()) {
        return omegas;
    }
    let mu: Vec<f64> = closed.iter().map(|closed| closed.mu).collect();
    let solve =
        |support: &ClosedContacts, holds: &[Hold]| forces(support, holds, &mu, None, Wanted::Acceleration);
    let candidates: Vec<usize> = (0..closed.len())
        .filter(|&i| relaxation(here, i, &solve).is_some_and(|time| time < SETTLES * scales.time))
        .collect();
    if candidates.is_empty() {
        return omegas;
    }
    // The settled directions here and a little later.
    let at = |support: &ClosedContacts, holds: &[Hold], rates: Option<&[f64]>| -> Option<Vec<Hold>> {
        let mut trial = closed.to_vec();
        for (place, &i) in candidates.iter().enumerate() {
            trial[i].omega = Some(rates.map_or(0.0, |rates| rates[place]));
        }
        let mut holds = holds.to_vec();
        settle_directions(support, &trial, &mut holds, &|holds| solve(support, holds))?;
        Some(holds)
    };
    let Some(first) = at(&here.support, &here.holds, None) else { return omegas };
    let ahead: Vec<f64> = y.iter().zip(&here.rates).map(|(value, rate)| value + ahead_by * rate).collect();
    let (q, u) = motion.split(&ahead);
    let Ok(inputs) = motion.inputs(t + ahead_by, &ahead) else { return omegas };
    let state = State { time: t + ahead_by, coordinates: q, speeds: u, inputs: &inputs };
    let contacts: Vec<usize> = closed.iter().map(|closed| closed.contact).collect();
    let Ok(support) = ClosedContacts::new(motion.mechanism, &state, &contacts, true) else { return omegas };
    let Some(second) = at(&support, &first, None) else { return omegas };
    let turn = |a: &Hold, b: &Hold| match (a, b) {
        (Hold::Slide(a), Hold::Slide(b)) => (a.x * b.y - a.y * b.x).atan2(a.dot(b)),
        _ => 0.0,
    };
    let rates: Vec<f64> = candidates.iter().map(|&i| turn(&first[i], &second[i]) / ahead_by).collect();
    let Some(exact) = at(&here.support, &here.holds, Some(&rates)) else { return omegas };
    for (&i, &rate) in candidates.iter().zip(&rates) {
        let off = turn(&exact[i], &here.holds[i]).abs() * here.support.slip(i).norm();
        if off < SETTLED * scales.length / scales.time {
            omegas[i] = Some(rate);
        }
    }
    omegas
}

/// A function that returns the forces for modes.
type Solve<'a> = dyn Fn(&ClosedContacts, &[Hold]) -> Result<Forces, Lacking> + 'a;

/// The time constant with which the direction of slip of a contact settles; `None` if it does not.
fn relaxation(here: &Evaluation, i: usize, solve: &Solve<'_>) -> Option<f64> {
    let Hold::Slide(d) = here.holds[i] else { return None };
    let across = |angle: f64| -> Option<f64> {
        let (sin, cos) = angle.sin_cos();
        let d = Vector2::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y);
        let mut holds = here.holds.clone();
        holds[i] = Hold::Slide(d);
        let a = solve(&here.support, &holds).ok()?.acceleration;
        Some(d.x * a[3 * i + 2] - d.y * a[3 * i + 1])
    };
    let slope = (across(TURN)? - across(-TURN)?) / (2.0 * TURN);
    (slope < 0.0).then(|| here.support.slip(i).norm() / -slope)
}
