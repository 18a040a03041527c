//! Follows small slip through its end, along the directions that contacts have settled in.
//!
//! Near the end or the beginning of slip its direction phi obeys s phi' = h(phi), where h is the acceleration
//! across the slip. While s is small the direction settles within the time s / |dh/dphi|, and an explicit
//! integration would need steps of that length. A settled direction follows from the state: h(phi) = s phi', where
//! phi' is the rate at which the settled direction turns (docs/theory.md, section 17.5). With s as the signed
//! component of the slip along this direction, the motion is smooth through the end of slip. Directions of several
//! contacts depend on each other, and are found together.

use std::sync::Arc;

use hodograph::{ComponentKind, State};
use nalgebra::{DMatrix, DVector, Schur, Vector2};

use crate::closed_contacts::{ClosedContacts, least_squares};
use crate::contact_problem::Wanted;
use crate::forces::{Forces, Hold, Lacking, forces};
use crate::motion::{Evaluation, Motion};
use crate::phase::{Closed, Turned};
use crate::settled_direction::{Solve, across, slopes, turn_until};
use crate::stepper::Tolerances;

/// An explicit integration takes steps of no more than so many times the time in which the direction settles.
pub(crate) const EXPLICIT: f64 = 6.0;
/// A direction that settles this much faster than its slip ends is followed to that end.
const FASTER: f64 = 4.0;
/// Difference of times by which accelerations are differentiated, beside the time ahead.
const AHEAD: f64 = 1e-3;
/// Slip that differs from its settled direction by so many times what a step may err has settled.
const SETTLED: f64 = 10.0;
/// The cosine of the angle between slip and its settled direction, at least.
const NEAR: f64 = 0.9;
/// Rounds in which directions and rates of turning are found, each from the other.
const ROUNDS: usize = 2;
/// Turns of several directions that change accelerations by less than this part of what others do are none that
/// slip of the bodies can make.
const BODIES: f64 = 1e-7;
/// Iterations of eigenvalues and singular values at most.
const ITERATIONS: usize = 200;

/// Contacts whose directions of slip follow from the state.
#[derive(Clone, Debug)]
pub(crate) struct Settled {
    pub slips: Vec<SettledSlip>,
    /// nearly the inverse of the derivative of the accelerations across the directions by their angles
    pub inverse: Arc<DMatrix<f64>>,
    /// time in which the directions settle, s
    pub relaxation: f64,
    /// the time ahead for which they were looked for, s: other directions settle in a time that is not short beside it
    pub reach: f64,
    /// whether slip across them is as little as the tolerances allow
    pub has_settled: bool,
}

/// The settled direction of one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SettledSlip {
    /// place among the closed contacts
    pub place: usize,
    pub direction: Vector2<f64>,
    /// how fast it turns: see [`crate::phase::Turning`]
    pub rates: [f64; 3],
    /// slip across the direction, m/s
    pub across: f64,
}

/// What settled directions are looked for with.
pub(crate) struct Search<'a> {
    /// the places of the contacts among the closed ones
    pub asked: &'a [usize],
    /// times to the end of each slip if its rate stayed, s
    pub left: &'a [Option<f64>],
    /// rates at which each direction turned so far
    pub before: &'a [Turned],
    /// a time ahead, s: directions that settle in a longer time are integrated
    pub reach: f64,
    /// what a step may err
    pub tolerances: Tolerances,
}

/// Closed contacts and the modes that follow from their velocities.
type Beside = (ClosedContacts, Vec<Hold>);

/// The contacts whose directions of slip settle fast, and whether they have settled. Of those that have not the fastest
/// decides how long steps can be, and those that settle as slowly are integrated. `None` where there is none.
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
    // The change of the accelerations across directions by time. Those of other contacts are those of their own slip.
    let change = |holds: &[Hold]| -> Option<DVector<f64>> {
        let rates = rates_with(here, motion, y.len(), &solve(holds).ok()?);
        let at = |by: f64| -> Option<DVector<f64>> {
            let (support, mut there) = at_time(motion, (t, y), &rates, by, here)?;
            for &place in places {
                there[place] = holds[place];
            }
            across(&there, places, &|holds| solved(motion, &support, holds))
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
    // Where nothing moves other directions may have no acceleration across them either.
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

/// The time in which the last deviations of directions settle that an explicit integration has to follow: the least;
/// `None` where one grows. With phi_i' = h_i / s_i they obey phi' = S^-1 H phi, as far as the bodies can make them:
/// all slip that a turn of friction brings lies in the range of the change of accelerations in fixed directions.
fn relaxation(slopes: &DMatrix<f64>, along: &DVector<f64>, slips: &[f64], soon: f64) -> Option<f64> {
    if let [slip] = slips {
        return (slopes[(0, 0)] < 0.0).then(|| slip / -slopes[(0, 0)]);
    }
    let mut rates = slopes.clone();
    for (i, slip) in slips.iter().enumerate() {
        // Slip that begins has the sizes that it will have soon.
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

/// By how much the slip across a settled direction differs from what it should be at a time, beside what a step may err:
/// the error that is left by a rate of turning which was taken to be a polynomial.
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

/// Forces in these modes, with the coefficients of friction of these velocities.
fn solved(motion: &Motion<'_>, support: &ClosedContacts, holds: &[Hold]) -> Result<Forces, Lacking> {
    let mut mu = Vec::with_capacity(holds.len());
    motion.rub(support, holds, &mut mu).map_err(|_| Lacking::Common)?;
    forces(support, holds, &mu, None, Wanted::Motion)
}

/// The rates of coordinates and speeds here under other forces.
fn rates_with(here: &Evaluation, motion: &Motion<'_>, count: usize, forces: &Forces) -> Vec<f64> {
    let mut rates = here.rates[..count].to_vec();
    let n = motion.mechanism.count(ComponentKind::Coordinate);
    if let Some(known) = &here.forces {
        let change = &here.support.response * (&forces.lambda - &known.lambda);
        rates[n..].iter_mut().zip(change.iter()).for_each(|(rate, change)| *rate += change);
    }
    rates
}

/// The closed contacts a short time from here, by these rates.
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

/// The polynomial of the rate from now on, by what it is now and was before.
fn extrapolated(t: f64, rate: f64, before: &Turned) -> [f64; 3] {
    let slope = |(t0, rate0): (f64, f64), (t1, rate1): (f64, f64)| (rate1 - rate0) / (t1 - t0);
    match before {
        [Some((since, _)), _] if *since >= t => [rate, 0.0, 0.0],
        [Some(first), Some(second)] => {
            let (last, earlier) = (slope(*first, (t, rate)), slope(*second, *first));
            let bend = (last - earlier) / (t - second.0);
            // Newton's form about now and the time before.
            [rate, last + bend * (t - first.0), bend]
        }
        [Some(first), None] => [rate, slope(*first, (t, rate)), 0.0],
        _ => [rate, 0.0, 0.0],
    }
}

/// Settled directions here, and how they turn.
struct Turns {
    /// the modes with these directions
    holds: Vec<Hold>,
    /// the change of the accelerations across the directions by their angles, and nearly its inverse
    slopes: DMatrix<f64>,
    inverse: DMatrix<f64>,
    /// the accelerations along the directions
    along: DVector<f64>,
    rates: Vec<[f64; 3]>,
}

/// Finds settled directions here. h(phi) = s omega holds all the time, so that with h' the change of h at fixed directions
/// (dh/dphi) omega + h' = s' omega + s omega'.
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
    // At first the rate is the last one known, for slip without a settled direction has its own rates.
    let mut rates: Vec<[f64; 3]> =
        places.iter().map(|&place| [before[place][0].map_or(0.0, |(_, rate)| rate), 0.0, 0.0]).collect();
    let mut found = None;
    for round in 0..=ROUNDS {
        let slopes = slopes(&holds, places, solve)?;
        let (mut along, mut bends) = (DVector::zeros(m), DVector::zeros(m));
        let acceleration = solve(&holds).ok()?.acceleration;
        for (k, &place) in places.iter().enumerate() {
            let d = holds[place].direction()?;
            along[k] = d.x * acceleration[3 * place + 1] + d.y * acceleration[3 * place + 2];
            bends[k] = here.support.slip(place).dot(&d) * rates[k][1];
        }
        if round > 0 {
            let omegas =
                least_squares(&(&slopes - DMatrix::from_diagonal(&along)), &(bends - change(&holds)?));
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

/// The inverse of a matrix, without what turns of friction do that the bodies do not feel.
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

/// The error of the slip of a contact that a step may have, m/s.
fn allowed(support: &ClosedContacts, place: usize, speeds: &[f64], tolerances: &Tolerances) -> f64 {
    tolerances.absolute + tolerances.relative * support.velocity_size(place, speeds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::Turning;

    /// Rates that are a parabola of the time go on as that parabola.
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
