//! Checks gaps: the rate of a gap must be the normal velocity of its contact, it must change its sign
//! where the contact closes, and no gap may be negative at the initial values.

use super::exact::constants;
use super::states::{Seen, at_rest, stated};
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::views::dot3;
use crate::numeric::{self, Level, State, Views, hyper_dual::HyperDual};

/// Rates may differ by this much, relative to the larger.
const SAME: f64 = 1e-6;
/// A gap may begin negative by this much, relative to the size of the coordinates above 1: rounding of
/// initial values.
const TOUCHING: f64 = 1e-6;
/// How far behind a surface a gap is looked at, in distances to where the way to the surface began.
const BEYOND: [f64; 4] = [1e-4, 1e-3, 0.01, 0.1];
/// A gap is closed if it is this part of what it was where the way to the surface began.
const CLOSED: f64 = 1e-6;
/// A gap falls towards a surface if near it its rate is this part of the mean rate on the way.
const FALLS: f64 = 0.2;

/// Gaps that do not belong to their contacts, and those that begin negative. `found` is what is said already
/// of the contacts.
pub fn gaps(m: &Mechanism, seen: &[Seen<'_>], found: &[Diagnostic]) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    // of the contacts of one pair, the deepest
    let mut deepest: Vec<(f64, Diagnostic)> = Vec::new();
    for contact in &m.contacts {
        let Some(gap) = &contact.gap else { continue };
        let places = [contact.span, contact.point_span, contact.against_span, contact.normal_span];
        if found.iter().any(|d| places.contains(&d.primary.span)) {
            continue;
        }
        // the gap of shapes follows from them; beside a face that ends it has another rate
        let strange = if contact.shapes.is_some() {
            None
        } else {
            strange(m, contact, gap, seen).or_else(|| one_sided(m, contact, gap, seen))
        };
        match strange {
            Some(diagnostic) => out.push(diagnostic),
            None => {
                let Some(found) = begins_inside(m, contact, gap) else { continue };
                match deepest.iter_mut().find(|(_, known)| known.primary.span == found.1.primary.span) {
                    Some(known) if known.0 <= found.0 => {}
                    Some(known) => *known = found,
                    None => deepest.push(found),
                }
            }
        }
    }
    out.extend(deepest.into_iter().map(|(_, found)| found));
    out
}

/// How a gap changes beside the normal velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fit {
    /// as it should
    Same,
    /// with the opposite sign
    Opposite,
    /// not at all
    Constant,
    /// in another way
    Other,
}

fn strange(m: &Mechanism, contact: &Contact, gap: &Scalar, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    let fits: Vec<Fit> =
        seen.iter().filter_map(|seen| fit(m, seen.state, &seen.views, contact, gap)).collect();
    if fits.is_empty() || fits.contains(&Fit::Same) {
        return None;
    }
    // away from the surface a gap may be any function that vanishes on it: there it counts
    let closed: Vec<Fit> = seen
        .iter()
        .filter_map(|seen| {
            let state = on_surface(m, gap, seen.state)?;
            fit(m, &state, &Views::at(m, &state).ok()?, contact, gap)
        })
        .collect();
    let last = if closed.is_empty() { &fits } else { &closed };
    if last.contains(&Fit::Same) {
        return None;
    }
    let name = &contact.name;
    if last.iter().all(|fit| *fit == Fit::Constant) && constants::never_changes(m, gap) {
        let message =
            format!("the gap of `{name}` is constant, although the bodies approach along its normal");
        let help = "it is the distance along the normal of the point that strikes, such as `dot(position(P), N.y)`; a contact without one \
                    has `gap: none`";
        let error = Diagnostic::new(codes::CONTACT, contact.gap_span, message);
        return Some(error.related(contact.normal_span, "this is the normal").help(help));
    }
    let (message, help) = match last[0] {
        Fit::Opposite => (
            format!("the gap of `{name}` grows while the bodies approach along its normal"),
            "the normal points from what is struck to the body that strikes, and the gap grows that way: turn the sign of one of them",
        ),
        Fit::Constant => (
            format!("the gap of `{name}` does not change while the bodies approach along its normal"),
            "it is the distance along the normal of the point that strikes, such as `dot(position(P), N.y)`",
        ),
        _ => (
            format!("the rate of the gap of `{name}` is not the velocity of its point along its normal"),
            "the gap is the distance, along the normal, of the point that strikes, such as `dot(position(P), N.y)`; check the point and the normal",
        ),
    };
    let related = (contact.normal_span, "this is the normal");
    Some(Diagnostic::new(codes::GAP_RATE, contact.gap_span, message).related(related.0, related.1).help(help))
}

/// A gap that is negative nowhere behind the surface, although it falls at a rate towards it: a motion sees that a contact
/// closes where its gap changes its sign. (One that only just closes, as at the end of a swing, falls at no rate there.)
fn one_sided(m: &Mechanism, contact: &Contact, gap: &Scalar, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    let at = |state: &State| Some(at_rest(m, state).scalar(gap, Level::Geometry).ok()?.re);
    let mut found = false;
    for seen in seen {
        let Some(closed) = on_surface(m, gap, seen.state) else { continue };
        // from the state (-1) through the surface (0)
        let along = |part: f64| {
            let mut state = closed.clone();
            for (q, from) in state.coordinates.iter_mut().zip(&seen.state.coordinates) {
                *q += part * (*q - from);
            }
            numeric::assemble(m, &mut state).ok()?;
            at(&state)
        };
        let Some(start) = at(seen.state).filter(|start| *start > 0.0) else { continue };
        if at(&closed).is_none_or(|closed| closed > CLOSED * start) {
            continue;
        }
        for part in BEYOND {
            match along(part) {
                Some(behind) if behind < 0.0 => return None,
                Some(behind) if behind.is_nan() => {}
                Some(_) => found |= along(-part).is_some_and(|before| before > FALLS * part * start),
                None => {}
            }
        }
    }
    found.then(|| {
        let message = format!("the gap of `{}` is negative nowhere behind the surface", contact.name);
        let help = "a collision is seen where the gap changes its sign: write it without norm, abs and max, as `dot(position(P), N.y)` or `norm(position(P)) - r`";
        Diagnostic::new(codes::GAP_RATE, contact.gap_span, message).help(help)
    })
}

fn fit(m: &Mechanism, state: &State, views: &Views<'_>, contact: &Contact, gap: &Scalar) -> Option<Fit> {
    let mut rate = views.rate_parts(gap).ok()?;
    let normal = views.now.vector(&contact.normal, Level::Motion).ok()?.map(|c| c.re);
    let velocity = views.vector_parts(|values| values.contact_velocity(contact)).ok()?;
    let mut along: Vec<f64> = velocity.into_iter().map(|v| dot3(v, normal)).collect();
    // the rate at which an input moves the surface is not known
    if follows_input(m, state, gap) {
        rate.pop();
        along.pop();
    }
    let size = |list: &[f64]| list.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    let (of_gap, of_velocity) = (size(&rate), size(&along));
    // per m/s or rad/s of each independent speed, and what is left without them
    let units = m.speeds.iter().filter(|speed| !speed.dependent).map(|speed| speed.factor).chain([1.0]);
    let moves = along.iter().zip(units).any(|(v, unit)| v.abs() >= 1e-9 * unit);
    if !of_gap.is_finite() || !of_velocity.is_finite() || !moves {
        return None;
    }
    if of_gap < 1e-9 * of_velocity {
        return Some(Fit::Constant);
    }
    let off = |sign: f64| rate.iter().zip(&along).fold(0.0_f64, |off, (g, v)| off.max((sign * g - v).abs()));
    Some(if off(1.0) <= SAME * of_velocity {
        Fit::Same
    } else if off(-1.0) <= SAME * of_velocity {
        Fit::Opposite
    } else {
        Fit::Other
    })
}

/// Whether the gap is another with other inputs.
fn follows_input(m: &Mechanism, state: &State, gap: &Scalar) -> bool {
    let at = |state: &State| at_rest(m, state).scalar(gap, Level::Geometry).map(|gap| gap.re).ok();
    let mut other = state.clone();
    other.inputs.iter_mut().for_each(|input| *input = 0.1 + 1.7 * *input);
    !m.inputs.is_empty() && at(state) != at(&other)
}

/// The gap and its derivatives with respect to the coordinates, one at a time.
fn gradient(m: &Mechanism, gap: &Scalar, state: &State) -> Option<(f64, Vec<f64>)> {
    let value = at_rest(m, state).scalar(gap, Level::Geometry).ok()?.re;
    let slope = |moving: usize| {
        let coordinate = |(i, q): (usize, &f64)| HyperDual {
            re: *q,
            e1: f64::from(u8::from(i == moving)),
            ..HyperDual::ZERO
        };
        let coordinates = state.coordinates.iter().enumerate().map(coordinate).collect();
        let speeds = vec![HyperDual::ZERO; m.speeds.len()];
        let time = HyperDual::constant(state.time);
        let values = numeric::Evaluator::new(m, &state.parameters, &state.inputs, time, coordinates, speeds);
        Some(values.scalar(gap, Level::Geometry).ok()?.e1)
    };
    let slopes = (0..state.coordinates.len()).map(slope).collect::<Option<Vec<f64>>>()?;
    Some((value, slopes))
}

/// A state nearby at which the gap is closed.
fn on_surface(m: &Mechanism, gap: &Scalar, state: &State) -> Option<State> {
    let mut state = state.clone();
    let in_quaternion = |i: usize| {
        m.frames.iter().any(|frame| {
            matches!(&frame.orientation, Orientation::Quaternion(ids) if ids.iter().any(|id| id.0 == i))
        })
    };
    for _ in 0..50 {
        let (value, mut slopes) = gradient(m, gap, &state)?;
        if value.abs() < 1e-10 {
            return Some(state);
        }
        slopes.iter_mut().enumerate().filter(|(i, _)| in_quaternion(*i)).for_each(|(_, slope)| *slope = 0.0);
        // per metre or radian of a coordinate, whatever its unit
        slopes.iter_mut().zip(&m.coordinates).for_each(|(slope, q)| *slope /= q.factor);
        let square: f64 = slopes.iter().map(|slope| slope * slope).sum();
        if square <= 0.0 || !square.is_finite() || !value.is_finite() {
            return None;
        }
        // a step of Newton's method along the steepest descent, no longer than 1 m or rad
        let share = (value / square).clamp(-1.0 / square.sqrt(), 1.0 / square.sqrt());
        for ((q, slope), quantity) in state.coordinates.iter_mut().zip(&slopes).zip(&m.coordinates) {
            *q -= share * slope / quantity.factor;
        }
        numeric::assemble(m, &mut state).ok()?;
    }
    None
}

/// A gap that is negative with the initial values, where the model states any that it depends on.
fn begins_inside(m: &Mechanism, contact: &Contact, gap: &Scalar) -> Option<(f64, Diagnostic)> {
    let mut state = State::of(m);
    numeric::assemble(m, &mut state).ok()?;
    let state = stated(m, &state, true);
    let (value, slopes) = gradient(m, gap, &state)?;
    let decides = |(coordinate, slope): (&Variable, &f64)| {
        *slope != 0.0 && (coordinate.value.is_some() || coordinate.dependent)
    };
    let size = state.coordinates.iter().fold(1.0_f64, |size, q| size.max(q.abs()));
    if value < -TOUCHING * size && m.coordinates.iter().zip(&slopes).any(decides) {
        let gap = super::bodies::number(value);
        if let Some(pair) = contact.shapes {
            let [a, b] = pair.map(|id| &m.shapes[id.0].name);
            let message = format!(
                "with the initial values `{a}` and `{b}` overlap by {} m",
                super::bodies::number(-value)
            );
            let help =
                format!("start where they are apart; `touching({})` starts with this gap 0", contact.name);
            let found = Diagnostic::new(codes::BEGINS_INSIDE, contact.gap_span, message);
            return Some((value, found.help(help)));
        }
        let message = format!(
            "with the initial values the gap of `{}` is {gap} m: it begins inside what it strikes",
            contact.name
        );
        let help = "start where the gap is positive or 0, or turn the signs of gap and normal";
        return Some((value, Diagnostic::new(codes::BEGINS_INSIDE, contact.gap_span, message).help(help)));
    }
    None
}
