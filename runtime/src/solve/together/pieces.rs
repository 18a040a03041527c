//! The pieces of several collisions, over numbers of which each holds those of all.

use nalgebra::{Vector2, Vector3};

use super::super::{
    collision::slips,
    contact::Contact,
    event::{Correction, Event},
    event_location::SHORT_STEPS,
    gauss16::Panel,
    input::plainly_right,
    sensitivity::starts,
    sliding::NEARLY,
    sliding_arc::{ArcPoint, SlidingArc},
    target::Watched,
};
use super::{
    slot::{Chart, Piece, Slot, Stretch, Trial},
    work::{Group, SLOTS, Work},
};
use crate::{
    ReducedMatrix,
    scalar::{Arithmetic, Mask, Together, constant, decide, larger, length},
};

/// The slots of a group.
type Members<'a> = [&'a Slot; 8];

/// A number of each member.
#[inline(always)]
fn each<L: Together>(members: &Members, number: impl Fn(&Slot) -> f64) -> L {
    L::each(|lane| number(members[lane]))
}

#[inline(always)]
fn arcs<L: Together>(members: &Members) -> SlidingArc<L> {
    SlidingArc::of(&L::load(|lane| &members[lane].arc), L::zero().below(L::zero()))
}

#[inline(always)]
fn points<L: Together>(members: &Members, point: impl Fn(&Slot) -> &[f64; 8]) -> ArcPoint<L> {
    ArcPoint::of(L::load(|lane| point(members[lane])))
}

#[inline(always)]
fn events<L: Together>(members: &Members, watched: Watched) -> Event<L> {
    let target = each(members, |slot| slot.target);
    match watched {
        Watched::Velocity => Event::Velocity(target),
        Watched::Impulse => Event::Impulse(target),
        Watched::Work => Event::Work(target),
    }
}

#[inline(always)]
fn members<'a>(work: &'a Work, group: &Group) -> Members<'a> {
    group.places.map(|place| &work.slots[usize::from(place) % SLOTS])
}

/// Tells each slot of the group, by its lane, that its piece is done, and puts it where it waits for the next.
#[inline(always)]
fn done<L: Together>(work: &mut Work, group: &Group, next: impl Fn(&mut Slot, usize) -> Piece) {
    for lane in 0..L::COUNT {
        if lane < group.count {
            let place = group.places[lane];
            let piece = next(work.slot(place), lane);
            work.push::<L>(piece, place);
        }
    }
}

/// Computes a piece for a group.
#[inline(always)]
pub(super) fn compute<L: Together>(piece: Piece, work: &mut Work, group: &Group, panel: &mut Panel<L>) {
    use Watched::{Impulse, Velocity, Work};
    match piece {
        Piece::Chart => chart::<L>(work, group),
        Piece::Stop => stop::<L>(work, group),
        Piece::StretchVelocity => survey::<L>(work, group, Velocity),
        Piece::StretchImpulse => survey::<L>(work, group, Impulse),
        Piece::StretchWork => survey::<L>(work, group, Work),
        Piece::TrialVelocity => attempt::<L, false>(work, group, Velocity, panel),
        Piece::TrialImpulse => attempt::<L, false>(work, group, Impulse, panel),
        Piece::TrialWork => attempt::<L, false>(work, group, Work, panel),
        Piece::DirectVelocity => attempt::<L, true>(work, group, Velocity, panel),
        Piece::DirectImpulse => attempt::<L, true>(work, group, Impulse, panel),
        Piece::DirectWork => attempt::<L, true>(work, group, Work, panel),
        Piece::ShortVelocity => polish::<L>(work, group, Velocity),
        Piece::ShortImpulse => polish::<L>(work, group, Impulse),
        Piece::ShortWork => polish::<L>(work, group, Work),
        Piece::Conclusion | Piece::Alone => {}
    }
}

#[inline(never)]
fn attempt<L: Together, const DIRECT: bool>(
    work: &mut Work,
    group: &Group,
    watched: Watched,
    panel: &mut Panel<L>,
) {
    let members = members(work, group);
    let arc = arcs::<L>(&members);
    let from = points(&members, |slot| &slot.at);
    let x = each::<L>(&members, |slot| slot.bracket.x);
    let reach = each::<L>(&members, |slot| slot.reach);
    let event = events::<L>(&members, watched);
    let mut to = from;
    arc.step::<true>(&from, x, DIRECT, panel, &mut to);
    let residual = event.at(&to);
    let rates = arc.rates(&to);
    let correction = Correction::new(&event, &to, &rates);
    let near = L::bits(correction.is_near(&event, &arc, &to, &rates, larger(reach, x)));
    L::store(&to.numbers(), |lane, point| work.slot(group.places[lane]).to = point);
    done::<L>(work, group, |slot, lane| {
        let (residual, step) = (residual.of(lane), correction.step.of(lane));
        slot.tried(&Trial { residual, step, near: near >> lane & 1 != 0 })
    });
}

#[inline(never)]
fn chart<L: Together>(work: &mut Work, group: &Group) {
    let members = members(work, group);
    let [nn, nt, ns, tt, ts, ss, n, t, s, mu, e, _] = L::load(|lane| &members[lane].input);
    let matrix = ReducedMatrix { nn, nt, ns, tt, ts, ss };
    let right = plainly_right(&matrix, &Vector3::new(n, t, s), mu, e);
    let contact = Contact::new(&matrix, mu);
    let speed = -n;
    let tangential = Vector2::new(t, s) / speed;
    let slip = length(&tangential);
    let ordinary = right.and(|| Contact::is_moderate(mu)).and(|| slip.has_end()).and(|| slips(slip));
    let direction = tangential / slip;
    let noise = L::default_epsilon() * contact.slip_size();
    let [.., h] = contact.rates(&direction);
    let turns = Arithmetic::abs(h).at_most(noise * constant(NEARLY)).not();
    let usual = L::bits(ordinary.and(|| contact.is_ordinary()).and(|| turns));
    let (no_slip, unstable_direction) = starts(&contact, &direction, slip);
    let (no_slip, unstable_direction) = (L::bits(no_slip), L::bits(unstable_direction));
    let (arc, w) = SlidingArc::through(&contact, &direction);
    let may_turn = L::bits(arc.may_turn);
    let Contact { b, tt, ts, ss, .. } = contact;
    let start = [b.x, b.y, tt, ts, ss, mu, tangential.x, tangential.y, slip, noise, noise, noise];
    L::store(&start, |lane, start| work.slot(group.places[lane]).start = start);
    L::store(&arc.numbers(), |lane, arc| work.slot(group.places[lane]).arc = arc);
    done::<L>(work, group, |slot, lane| {
        let holds = |bits: u32| bits >> lane & 1 != 0;
        let chart = Chart {
            usual: holds(usual),
            no_slip: holds(no_slip),
            unstable_direction: holds(unstable_direction),
            may_turn: holds(may_turn),
        };
        slot.charted(w.of(lane), &chart)
    });
}

#[inline(never)]
fn survey<L: Together>(work: &mut Work, group: &Group, watched: Watched) {
    let members = members(work, group);
    let arc = arcs::<L>(&members);
    let at = points::<L>(&members, |slot| &slot.at);
    let speed = each::<L>(&members, |slot| slot.start[8]);
    let noise = each::<L>(&members, |slot| slot.start[9]);
    let event = events::<L>(&members, watched);
    let slip = at.sigma * arc.e(at.w);
    let over = slip.at_most(L::default_epsilon() * speed * constant(4.0)).and(|| arc.slows(&at));
    let settled = arc.outer.below(at.w).and(|| arc.turns_slower(&at, noise * constant(8.0)));
    let settles = L::bits(arc.settles(&at, slip / speed));
    let rates = arc.rates(&at);
    let rising = L::bits(L::zero().below(rates.slope));
    let reach = arc.reach(&at, &rates);
    let guess = event.guess(&arc, &at, &rates);
    let (over, settled) = (L::bits(over), L::bits(settled));
    done::<L>(work, group, |slot, lane| {
        let holds = |bits: u32| bits >> lane & 1 != 0;
        slot.surveyed(&Stretch {
            over: holds(over),
            settled: holds(settled),
            settles: holds(settles),
            rising: holds(rising),
            reach: reach.of(lane),
            guess: guess.of(lane),
        })
    });
}

#[inline(never)]
fn polish<L: Together>(work: &mut Work, group: &Group, watched: Watched) {
    let members = members(work, group);
    let arc = arcs::<L>(&members);
    let mut to = points::<L>(&members, |slot| &slot.to);
    let event = events::<L>(&members, watched);
    let mut rates = arc.rates(&to);
    let mut correction = Correction::new(&event, &to, &rates);
    let close = constant::<L>(32.0) * L::default_epsilon();
    let (mut rough, mut error) = correction.errors(&event, &to, &rates);
    let mut going = L::Mask::all();
    for _ in 0..SHORT_STEPS {
        going = going.and(|| error.at_most(close).not());
        if !going.any() {
            break;
        }
        let mut moved = to;
        arc.short_step_here::<true>(&mut moved, &rates, correction.step);
        to = to.or(going, &moved);
        rates = arc.rates(&to);
        correction = Correction::new(&event, &to, &rates);
        (rough, error) = correction.errors(&event, &to, &rates);
    }
    let close = rough.at_most(close);
    let point = ArcPoint::of(decide!(
        L: close,
        {
            let mut to = to;
            to.second_order_step(&arc, &rates, correction.step);
            to.numbers()
        },
        {
            let mut to = to;
            let rate_changes = arc.rate_changes(&to, &rates);
            let step = correction.refined(&event, &to, &rates, &rate_changes);
            to.third_order_step_here(&arc, &rates, &rate_changes, step);
            to.numbers()
        },
    ));
    L::store(&point.numbers(), |lane, point| work.slot(group.places[lane]).to = point);
    done::<L>(work, group, |slot, _| slot.reached(true));
}

#[inline(never)]
fn stop<L: Together>(work: &mut Work, group: &Group) {
    let members = members(work, group);
    let arc = arcs::<L>(&members);
    let at = points::<L>(&members, |slot| &slot.at);
    let (state, since) = arc.stop_here::<true>(&at);
    let point = ArcPoint { state, since, ..at };
    L::store(&point.numbers(), |lane, point| work.slot(group.places[lane]).to = point);
    done::<L>(work, group, |slot, _| slot.stopped());
}
