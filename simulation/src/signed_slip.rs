//! Follows small slip through its end, along the direction that its contact has settled in.
//!
//! Near the end or the beginning of slip its direction phi obeys s phi' = h(phi), where h is the acceleration
//! across the slip. While s is small the direction settles within the time s / |dh/dphi|, and an explicit
//! integration would need steps of that length. A settled direction follows from the state: h(phi) = s phi', where
//! phi' is the rate at which the settled direction turns (docs/theory.md, section 17.5). With s as the signed
//! component of the slip along this direction, the motion is smooth through the end of slip.

use hodograph::{ComponentKind, State};
use nalgebra::Vector2;

use crate::closed_contacts::ClosedContacts;
use crate::contact_problem::Wanted;
use crate::forces::{Forces, Hold, Lacking, forces};
use crate::motion::{Evaluation, Motion};
use crate::phase::{Closed, Turned};
use crate::settled_direction::{Solve, across, slope, turn_until};
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
/// Rounds in which direction and rate of turning are found, each from the other.
const ROUNDS: usize = 2;
/// A contact whose direction of slip follows from the state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settled {
    /// place among the closed contacts
    pub place: usize,
    pub direction: Vector2<f64>,
    /// how fast it turns: see [`crate::phase::Turning`]
    pub rates: [f64; 3],
    /// change of the acceleration across the direction by its angle, m/s^2
    pub slope: f64,
    /// time in which it settles, s
    pub relaxation: f64,
    /// slip across the direction, m/s
    pub across: f64,
    /// whether that is as little as the tolerances allow
    pub has_settled: bool,
}

/// What a settled direction is looked for with.
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

/// The contact whose direction of slip settles fast, and whether it has settled. `None` where there is none, and where
/// there are several, each of which settles as the others turn.
pub(crate) fn settled(
    motion: &Motion<'_>,
    (t, y): (f64, &[f64]),
    here: &Evaluation,
    search: &Search<'_>,
) -> Option<Settled> {
    let solve = |holds: &[Hold]| solved(motion, &here.support, holds);
    let settles = |place: usize| {
        slope(&here.holds, place, &solve).filter(|slope| *slope < 0.0).is_some_and(|slope| {
            let time = here.support.slip(place).norm() / -slope;
            EXPLICIT * time < search.reach
                || search.left[place].is_some_and(|left| left < search.reach && FASTER * time < left)
        })
    };
    let mut fast = search.asked.iter().copied().filter(|&place| settles(place));
    let (place, None) = (fast.next()?, fast.next()) else { return None };
    let ahead_by = AHEAD * search.left[place].map_or(search.reach, |left| left.min(search.reach))
        + 64.0 * f64::EPSILON * t.abs();
    // The change of the acceleration across a direction by time. Those of other contacts are those of their own slip.
    let change = |holds: &[Hold]| -> Option<f64> {
        let rates = rates_with(here, motion, y.len(), &solve(holds).ok()?);
        let at = |by: f64| -> Option<f64> {
            let (support, mut there) = at_time(motion, (t, y), &rates, by, here)?;
            there[place] = holds[place];
            across(&there, place, &|holds| solved(motion, &support, holds))
        };
        Some((at(ahead_by)? - at(-ahead_by)?) / (2.0 * ahead_by))
    };
    let (holds, slope, rates) = turning(here, place, &search.before[place], &change, &solve, t)?;
    let (direction, now) = (holds[place].direction()?, here.holds[place].direction()?);
    let (_, speeds) = motion.split(y);
    let slip = here.support.slip(place);
    let across = direction.perp(&slip);
    // Where nothing moves other directions may have no acceleration across them either.
    let has_settled = slope < 0.0
        && direction.dot(&now) > NEAR
        && across.abs() <= SETTLED * allowed(&here.support, place, speeds, &search.tolerances);
    Some(Settled { place, direction, rates, slope, relaxation: slip.norm() / -slope, across, has_settled })
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
        if let (Some(turning), Hold::Slide(d)) = (contact.turning, there.holds[place]) {
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

/// The modes with the settled direction here, the change of the acceleration across it by its angle, and how it turns.
/// h(phi) = s omega holds all the time, so that with h' the change of h at a fixed direction
/// (dh/dphi) omega + h' = s' omega + s omega'.
fn turning(
    here: &Evaluation,
    place: usize,
    before: &Turned,
    change: &dyn Fn(&[Hold]) -> Option<f64>,
    solve: &Solve<'_>,
    t: f64,
) -> Option<(Vec<Hold>, f64, [f64; 3])> {
    let mut holds = here.holds.clone();
    let slip = here.support.slip(place);
    // At first the rate is the last one known, for slip without a settled direction has its own rates.
    let mut rates = [before[0].map_or(0.0, |(_, rate)| rate), 0.0, 0.0];
    let mut found = None;
    for round in 0..=ROUNDS {
        let slope = slope(&holds, place, solve)?;
        if round > 0 {
            let (d, a) = (holds[place].direction()?, solve(&holds).ok()?.acceleration);
            let along = d.x * a[3 * place + 1] + d.y * a[3 * place + 2];
            let omega = (slip.dot(&d) * rates[1] - change(&holds)?) / (slope - along);
            rates = extrapolated(t, omega, before);
        }
        turn_until(&mut holds, place, slope, &|d| rates[0] * slip.dot(d), solve)?;
        found = Some(slope);
    }
    Some((holds, found?, rates))
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
            slope: -1.0,
            least: 0.0,
        };
        for t in [0.9, 1.0, 1.7] {
            assert!((turning.rate(t) - rate(t)).abs() < 1e-12);
            let integral = |t: f64| (2.0 + (-1.5 + 5.0 / 3.0 * t) * t) * t;
            assert!((turning.angle(t) - (integral(t) - integral(0.9))).abs() < 1e-12);
        }
    }
}
