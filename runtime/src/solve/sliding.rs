//! Follows the sliding arc (34), stretch by stretch, until the law ends the collision or slip stops. It
//! chooses between straight arcs, the perturbed arc, quadrature and the series to the end of slip.
//!
//! Theory: docs/theory.md, sections 5 to 8.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    event_location::EventLocation,
    gauss16::Panel,
    perturbation::perturbed,
    restitution::Restitution,
    sliding_arc::{ArcPoint, SlidingArc},
    straight::{Slide, straight},
};
use crate::scalar::{Real, constant};

/// The greatest number of stretches. The length of a stretch in lambda is proportional to its distance from
/// the zeros of q, so that few are needed.
pub(super) const STRETCHES: u32 = 512;

/// If |h| at the start is below this many times its rounding error, slip may turn by a small angle only, and
/// `perturbed` is tried first.
pub(super) const NEARLY: f64 = 131_072.0;

/// Where nothing moves the contact across the slip by more than so many roundings of the largest diagonal
/// entry, slip keeps its direction: a planar contact in axes that are turned.
const PLANAR: f64 = 16.0;

/// Follows the sliding arc from the tangential velocity `from` of length `speed`, for a contact whose rates
/// are neither very large nor very small.
#[inline(never)]
pub(super) fn arc<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    arc_here(c, from, speed, restitution)
}

/// [`arc`] as a part of the caller.
#[inline(always)]
pub(super) fn arc_here<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    let eps = T::default_epsilon();
    // The rounding error of h.
    let noise = eps * c.slip_size();
    let direction = from / speed;
    let [.., h] = c.rates(&direction);
    if h.abs() <= noise * constant(NEARLY) {
        if h.abs() <= noise * constant(4.0) || !c.moves_across(&direction, PLANAR) {
            return straight(c, direction, speed, restitution.start(), restitution);
        }
        if let Some(slide) = perturbed(c, &direction, speed, restitution) {
            return slide;
        }
    }
    let (arc, w) = SlidingArc::through(c, &direction);
    let mut at = ArcPoint { state: restitution.start(), since: T::zero(), w, sigma: speed / arc.e(w) };
    let stops = arc.last_rate() < T::zero();
    let mut panel = Panel::new(speed, restitution.quadratures);
    for _ in 0..STRETCHES {
        let slip = at.sigma * arc.e(at.w);
        let over = slip <= eps * speed * constant(4.0) && arc.slows(&at);
        let settled = at.w > arc.outer && arc.turns_slower(&at, noise * constant(8.0));
        if over || settled {
            restitution.since(&at.state, at.since);
            return straight(c, arc.slip(&at) / slip, slip, at.state, restitution);
        }
        let fast = restitution.fast(c, slip);
        // The series needs no rates, unless v_n may turn.
        if stops && !fast && arc.settles(&at, slip / speed) && !arc.turns_ahead(&at) {
            let (stop, since) = if T::INLINED { arc.stop_here::<true>(&at) } else { arc.stop(&at) };
            if restitution.passes(&at.state, &stop, c.together(stop.normal)) {
                restitution.since(&stop, since);
                return Slide::Stopped(stop);
            }
        }
        let rates = arc.rates(&at);
        let (rising, turning_point) = arc.turning_point(&at, &rates);
        let reach = arc.reach(&at, &rates);
        let panel = &mut panel;
        let mut location =
            EventLocation { arc: &arc, from: at, rates: &rates, rising, turning_point, fast, panel, reach };
        let ended = location.follow(restitution, &mut at);
        if location.panel.is_over_budget() {
            return Slide::OverBudget(location.from.state);
        }
        if ended {
            return Slide::Ended(at.state, arc.slip(&at));
        }
        restitution.grazing.moved(at.state.velocity);
    }
    Slide::Endless(at.state)
}
