//! Treats small slip as a signed number through its end, along settled directions.
//!
//! Near the end or the beginning of slip its direction phi obeys s phi' = h(phi), where h is the acceleration
//! perpendicular to the slip. While s is small, the direction settles within the time s / |dh/dphi|, and an
//! explicit integration would need steps of that length. A settled direction follows from the state: h(phi) =
//! s phi', where phi' is the rate at which the settled direction turns (docs/theory.md, section 17.5). With s
//! as the signed component of slip along this direction, the motion is smooth through the end of slip.
//! Directions of several contacts depend on each other, and are computed together.

use std::sync::Arc;

use hodograph::{ComponentKind, State};
use nalgebra::{DMatrix, DVector, Schur, Vector2};

use crate::closed::closed_contacts::{ClosedContacts, least_squares};
use crate::closed::forces::{Forces, Hold, Lacking, forces};
use crate::closed::phase::{Closed, Turned};
use crate::closed::settled_direction::{Solve, across, slopes, turn_until};
use crate::contact_problem::Wanted;
use crate::integration::motion::{Evaluation, Motion};
use crate::integration::stepper::Tolerances;

/// The steps of an explicit integration are at most this many times the time constant with which the
/// direction settles.
pub(crate) const EXPLICIT: f64 = 6.0;
/// A direction that settles this much faster than slip ends is followed to that end.
const FASTER: f64 = 4.0;
/// Time difference for derivatives of accelerations, relative to the time ahead.
const AHEAD: f64 = 1e-3;
/// Slip has settled if it differs from its settled direction by at most this many times the allowed error of
/// a step.
const SETTLED: f64 = 10.0;
/// Least cosine of the angle between slip and its settled direction.
const NEAR: f64 = 0.9;
/// Number of alternating computations of directions and rates of turning.
const ROUNDS: usize = 2;
/// Turns of several directions that change accelerations by less than this part of others are not possible
/// motions of the bodies.
const BODIES: f64 = 1e-7;
/// Largest number of iterations for eigenvalues and singular values.
const ITERATIONS: usize = 200;

/// Contacts whose directions of slip follow from the state.
#[derive(Clone, Debug)]
pub(crate) struct Settled {
    pub slips: Vec<SettledSlip>,
    /// an approximate inverse of the derivative of the perpendicular accelerations with respect to the angles
    pub inverse: Arc<DMatrix<f64>>,
    /// time constant with which the directions settle, s
    pub relaxation: f64,
    /// the time ahead for which they were computed, s: the time constants of other directions are not short
    /// compared with it
    pub reach: f64,
    /// whether slip perpendicular to them is within the tolerances
    pub has_settled: bool,
}

/// The settled direction of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SettledSlip {
    /// index among the closed contacts
    pub place: usize,
    pub direction: Vector2<f64>,
    /// its turning: see [`crate::closed::phase::Turning`]
    pub rates: [f64; 3],
    /// slip perpendicular to the direction, m/s
    pub across: f64,
}

/// The input of the search for settled directions.
pub(crate) struct Search<'a> {
    /// the indices of the contacts among the closed ones
    pub asked: &'a [usize],
    /// times to the end of each slip at its present rate, s
    pub left: &'a [Option<f64>],
    /// previous rates at which each direction turned
    pub before: &'a [Turned],
    /// a time ahead, s: directions with longer time constants are integrated
    pub reach: f64,
    /// the allowed error of a step
    pub tolerances: Tolerances,
}

/// Closed contacts and the modes that follow from their velocities.
type Beside = (ClosedContacts, Vec<Hold>);

/// The contacts whose directions of slip settle fast, and whether they have settled. Of those that have not,
/// the fastest determines the length of steps, and those as slow are integrated. `None` if there is no such
/// contact.
pub(crate) fn settled(
    motion: &Motion<'_>,
    start: (f64, &[f64]),
    here: &Evaluation,
    search: &Search<'_>,
) -> Option<Settled> {
    let solve = |holds: &[Hold]| solved(motion, &here.support, holds);
    let settles = |&place: &usize| {
        let slope = slopes(&here.holds, &[place], &solve)?[(0, 0)];
        let time = here.support.slip(place).norm() / -slope;
        let ends = |reach: f64| search.left[place].is_some_and(|left| left < reach && FASTER * time < left);
        (slope < 0.0 && (EXPLICIT * time < search.reach || ends(search.reach))).then_some((place, time))
    };
    let mut fast: Vec<(usize, f64)> = search.asked.iter().filter_map(settles).collect();
    let mut reach = search.reach;
    loop {
        let places: Vec<usize> = fast.iter().map(|(place, _)| *place).collect();
        let (found, off) = together(motion, start, here, search, (&places, reach))?;
        let slowest = fast.iter().zip(&off).filter(|(_, off)| **off).map(|((_, time), _)| *time);
        let slowest = slowest.fold(f64::INFINITY, f64::min);
        fast.retain(|(_, time)| *time < slowest);
        reach = reach.min(EXPLICIT * slowest);
        if found.has_settled || fast.is_empty() {
            return Some(found);
        }
    }
}

/// The settled directions of these contacts, and which of them have not settled.
fn together(
    motion: &Motion<'_>,
    (t, y): (f64, &[f64]),
    here: &Evaluation,
    search: &Search<'_>,
    (places, reach): (&[usize], f64),
) -> Option<(Settled, Vec<bool>)> {
    if places.is_empty() {
        return None;
    }
    let solve = |holds: &[Hold]| solved(motion, &here.support, holds);
    let ends = places.iter().filter_map(|&place| search.left[place]);
    let ahead_by = AHEAD * ends.fold(reach, f64::min) + 64.0 * f64::EPSILON * t.abs();
    // The time derivative of the perpendicular accelerations. For other contacts they are perpendicular to
    // their own slip.
    let change = |holds: &[Hold]| -> Option<DVector<f64>> {
        let rates = rates_with(here, motion, y.len(), &solve(holds).ok()?);
        let at = |by: f64| -> Option<DVector<f64>> {
            let (support, mut there) = at_time(motion, (t, y), &rates, by, here)?;
            for &place in places {
                there[place] = holds[place];
            }
            let across = across(&there, places, &|holds| solved(motion, &support, holds))?;
            Some(DVector::from_column_slice(&across))
        };
        Some((at(ahead_by)? - at(-ahead_by)?) / (2.0 * ahead_by))
    };
    let turns = turning(here, places, search.before, &change, &solve, t)?;
    let (_, speeds) = motion.split(y);
    let mut slips = Vec::with_capacity(places.len());
    let mut off = Vec::with_capacity(places.len());
    let mut sizes = Vec::with_capacity(places.len());
    for (k, &place) in places.iter().enumerate() {
        let (direction, now) = (turns.holds[place].direction()?, here.holds[place].direction()?);
        let slip = here.support.slip(place);
        let across = direction.perp(&slip);
        let most = SETTLED * allowed(&here.support, place, speeds, &search.tolerances);
        off.push(direction.dot(&now) <= NEAR || across.abs() > most);
        slips.push(SettledSlip { place, direction, rates: turns.rates[k], across });
        sizes.push(slip.norm());
    }
    // If nothing moves, other directions may have no perpendicular acceleration either.
    let relaxation = relaxation(&turns.slopes, &turns.along, &sizes, ahead_by);
    let has_settled = relaxation.is_some() && !off.contains(&true);
    if relaxation.is_none() {
        off.fill(true);
    }
    let inverse = Arc::new(turns.inverse);
    Some((
        Settled { slips, inverse, relaxation: relaxation.unwrap_or(f64::INFINITY), reach, has_settled },
        off,
    ))
}

/// The least time constant of deviations of directions that an explicit integration has to resolve; `None` if
/// a deviation grows. With phi_i' = h_i / s_i they obey phi' = S^-1 H phi, restricted to possible motions of
/// the bodies: all slip caused by turns of friction lies in the range of the derivatives of accelerations at
/// fixed directions.
fn relaxation(slopes: &DMatrix<f64>, along: &DVector<f64>, slips: &[f64], soon: f64) -> Option<f64> {
    if let [slip] = slips {
        return (slopes[(0, 0)] < 0.0).then(|| slip / -slopes[(0, 0)]);
    }
    let mut rates = slopes.clone();
    for (i, slip) in slips.iter().enumerate() {
        // Beginning slip takes the size that it will have shortly.
        let size = if *slip > 0.0 { *slip } else { (along[i] * soon).max(f64::MIN_POSITIVE) };
        rates.column_mut(i).unscale_mut(size);
    }
    let turned = slopes + DMatrix::from_diagonal(along);
    if !rates.iter().chain(&turned).all(|value| value.is_finite()) {
        return None;
    }
    let svd = turned.try_svd(true, false, f64::EPSILON, ITERATIONS)?;
    let least = BODIES * svd.singular_values.max().max(along.amax());
    let kept: Vec<usize> = (0..slips.len()).filter(|&i| svd.singular_values[i] > least).collect();
    if kept.is_empty() {
        return None;
    }
    let basis = svd.u?.select_columns(&kept);
    let eigenvalues =
        Schur::try_new(basis.tr_mul(&(rates * &basis)), f64::EPSILON, ITERATIONS)?.complex_eigenvalues();
    let fastest = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
    eigenvalues.iter().all(|value| value.re < 0.0).then(|| fastest.recip())
}

/// The difference of the slip perpendicular to a settled direction from its expected value at a time,
/// relative to the allowed error of a step: the error of a rate of turning that is approximated by a
/// polynomial.
pub(crate) fn inconsistent(
    closed: &[Closed],
    (t, there): (f64, &Evaluation),
    speeds: &[f64],
    tolerances: &Tolerances,
) -> f64 {
    let mut most = 0.0_f64;
    for (place, contact) in closed.iter().enumerate() {
        if let (Some(turning), Hold::Slide(d)) = (&contact.turning, there.holds[place]) {
            let off = (d.perp(&there.support.slip(place)) - turning.across(t)).abs();
            most = most.max(off / allowed(&there.support, place, speeds, tolerances));
        }
    }
    most
}

/// Forces in these modes, with the coefficients of friction at these velocities.
fn solved(motion: &Motion<'_>, support: &ClosedContacts, holds: &[Hold]) -> Result<Forces, Lacking> {
    let mut mu = Vec::with_capacity(holds.len());
    motion.rub(support, holds, &mut mu).map_err(|_| Lacking::Common)?;
    forces(support, holds, &mu, None, Wanted::Acceleration)
}

/// The rates of coordinates and speeds in this state under other forces.
fn rates_with(here: &Evaluation, motion: &Motion<'_>, count: usize, forces: &Forces) -> Vec<f64> {
    let mut rates = here.rates[..count].to_vec();
    let n = motion.mechanism.count(ComponentKind::Coordinate);
    if let Some(known) = &here.forces {
        let change = &here.support.response * (&forces.lambda - &known.lambda);
        rates[n..].iter_mut().zip(change.iter()).for_each(|(rate, change)| *rate += change);
    }
    rates
}

/// The closed contacts a short time later, by these rates.
fn at_time(
    motion: &Motion<'_>,
    (t, y): (f64, &[f64]),
    rates: &[f64],
    by: f64,
    here: &Evaluation,
) -> Option<Beside> {
    let there: Vec<f64> = y.iter().zip(rates).map(|(value, rate)| value + by * rate).collect();
    let (q, u) = motion.split(&there);
    let inputs = motion.inputs(t + by, &there).ok()?;
    let state = State { time: t + by, coordinates: q, speeds: u, inputs: &inputs };
    let support = ClosedContacts::new(motion.mechanism, &state, &here.support.contacts, true).ok()?;
    let holds = motion.holds(&support, u);
    Some((support, holds))
}

/// The polynomial of the rate from now on, from its present and previous values.
fn extrapolated(t: f64, rate: f64, before: &Turned) -> [f64; 3] {
    let slope = |(t0, rate0): (f64, f64), (t1, rate1): (f64, f64)| (rate1 - rate0) / (t1 - t0);
    match before {
        [Some((since, _)), _] if *since >= t => [rate, 0.0, 0.0],
        [Some(first), Some(second)] => {
            let (last, earlier) = (slope(*first, (t, rate)), slope(*second, *first));
            let bend = (last - earlier) / (t - second.0);
            // Newton's form at the present and previous times.
            [rate, last + bend * (t - first.0), bend]
        }
        [Some(first), None] => [rate, slope(*first, (t, rate)), 0.0],
        _ => [rate, 0.0, 0.0],
    }
}

/// The derivative of the slope of that polynomial with respect to the present rate.
fn growth(t: f64, before: &Turned) -> f64 {
    match before {
        [Some((since, _)), _] if *since >= t => 0.0,
        [Some(first), second] => (t - first.0).recip() + second.map_or(0.0, |second| (t - second.0).recip()),
        _ => 0.0,
    }
}

/// Settled directions in a state, and their turning.
struct Turns {
    /// the modes with these directions
    holds: Vec<Hold>,
    /// the derivatives of the perpendicular accelerations with respect to the angles, and an approximate
    /// inverse
    slopes: DMatrix<f64>,
    inverse: DMatrix<f64>,
    /// the accelerations along the directions
    along: DVector<f64>,
    rates: Vec<[f64; 3]>,
}

/// Computes settled directions in a state. h(phi) = s omega holds at all times, so with the derivative h' of
/// h at fixed directions (dh/dphi) omega + h' = s' omega + s omega'.
fn turning(
    here: &Evaluation,
    places: &[usize],
    before: &[Turned],
    change: &dyn Fn(&[Hold]) -> Option<DVector<f64>>,
    solve: &Solve<'_>,
    t: f64,
) -> Option<Turns> {
    let m = places.len();
    let mut holds = here.holds.clone();
    // The first guess is the last known rate, since the rates of slip without a settled direction differ.
    let mut rates: Vec<[f64; 3]> =
        places.iter().map(|&place| [before[place][0].map_or(0.0, |(_, rate)| rate), 0.0, 0.0]).collect();
    let mut found = None;
    for round in 0..=ROUNDS {
        let slopes = slopes(&holds, places, solve)?;
        let (mut along, mut slips) = (DVector::zeros(m), DVector::zeros(m));
        let acceleration = solve(&holds).ok()?.acceleration;
        for (k, &place) in places.iter().enumerate() {
            let d = holds[place].direction()?;
            along[k] = d.x * acceleration[3 * place + 1] + d.y * acceleration[3 * place + 2];
            slips[k] = here.support.slip(place).dot(&d);
        }
        if round > 0 {
            // omega' is that of the extrapolation, a + b omega.
            let still = DVector::from_fn(m, |k, _| extrapolated(t, 0.0, &before[places[k]])[1]);
            let own = DVector::from_fn(m, |k, _| along[k] + slips[k] * growth(t, &before[places[k]]));
            let right = slips.component_mul(&still) - change(&holds)?;
            let omegas = least_squares(&(&slopes - DMatrix::from_diagonal(&own)), &right);
            for (k, &place) in places.iter().enumerate() {
                rates[k] = extrapolated(t, omegas[k], &before[place]);
            }
        }
        let mut inverse = inverse(&slopes)?;
        let wanted = |place: usize, d: &Vector2<f64>| {
            let k = places.iter().position(|of| *of == place).unwrap_or(0);
            rates[k][0] * here.support.slip(place).dot(d)
        };
        turn_until(&mut holds, places, &mut inverse, &wanted, solve)?;
        found = Some((slopes, inverse, along));
    }
    let (slopes, inverse, along) = found?;
    Some(Turns { holds, slopes, inverse, along, rates })
}

/// The inverse of a matrix, restricted to turns of friction that affect the bodies.
fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if !matrix.iter().all(|value| value.is_finite()) {
        return None;
    }
    if matrix.len() == 1 {
        return Some(matrix.map(f64::recip));
    }
    let svd = matrix.clone().try_svd(true, true, f64::EPSILON, ITERATIONS)?;
    let least = BODIES * svd.singular_values.max();
    svd.pseudo_inverse(least).ok()
}

/// The allowed error of the slip of a contact in a step, m/s.
fn allowed(support: &ClosedContacts, place: usize, speeds: &[f64], tolerances: &Tolerances) -> f64 {
    tolerances.absolute + tolerances.relative * support.velocity_size(place, speeds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed::phase::Turning;

    /// A rate that is a parabola in time is extrapolated exactly.
    #[test]
    fn rates_go_on_as_the_parabola_through_the_last_three() {
        let rate = |t: f64| 2.0 - 3.0 * t + 5.0 * t * t;
        let before = [Some((0.7, rate(0.7))), Some((0.4, rate(0.4)))];
        let turning = Turning {
            since: 0.9,
            rates: extrapolated(0.9, rate(0.9), &before),
            across: 0.0,
            within: 1.0,
            inverse: Arc::new(DMatrix::identity(1, 1)),
            least: 0.0,
        };
        for t in [0.9, 1.0, 1.7] {
            assert!((turning.rate(t) - rate(t)).abs() < 1e-12);
            let integral = |t: f64| (2.0 + (-1.5 + 5.0 / 3.0 * t) * t) * t;
            assert!((turning.angle(t) - (integral(t) - integral(0.9))).abs() < 1e-12);
        }
    }
}
