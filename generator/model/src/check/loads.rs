//! Checks loads by numbers: the points on which forces act, the axes and angles of torsion springs, and which
//! loads have a potential energy.

use super::contacts::Places;
use super::states::Seen;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::constancy::is_zero;
use crate::model::mechanism::*;
use crate::numeric::hyper_dual::{HyperDual, Triple, sub};
use crate::numeric::views::{Vector3, cross3, dot3, norm3, values};
use crate::numeric::{Evaluator, Failure, Level, Views};
use crate::span::Span;

/// Rates may differ by this much, relative to the larger.
const SAME: f64 = 1e-6;

/// Mistakes in loads, at the states that were seen.
pub fn loads(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let places = Places { m, views: seen.iter().map(|seen| &seen.views).collect() };
    let mut out = Vec::new();
    for load in &m.loads {
        match &load.kind {
            LoadKind::Gravity(_) => {}
            LoadKind::Force { on, from: None, .. }
                if never_moves(&places, |v| v.vector_parts(|w| w.velocity(*on))) =>
            {
                let message = format!("this force does nothing: `{}` never moves", m.points[on.0].name);
                let help = "a force acts on a point of what moves; its opposite on something else is stated with `from`";
                out.push(Diagnostic::new(codes::NO_EFFECT, end(load, 0), message).help(help));
            }
            LoadKind::Torque { on, from: None, .. }
                if never_moves(&places, |v| v.vector_parts(|w| w.angular_velocity(*on))) =>
            {
                let message = format!("this torque does nothing: `{}` never turns", m.frames[on.0].name);
                let help =
                    "a torque acts on a body that turns; its opposite on another is stated with `from`";
                out.push(Diagnostic::new(codes::NO_EFFECT, end(load, 0), message).help(help));
            }
            LoadKind::Force { on, from, .. } => {
                out.extend(on_a_place(&places, *on, end(load, 0)));
                out.extend(from.and_then(|from| on_a_place(&places, from, end(load, 1))));
            }
            LoadKind::Spring { a, b, .. } => {
                out.extend(on_a_place(&places, *a, end(load, 0)));
                out.extend(on_a_place(&places, *b, end(load, 1)));
            }
            LoadKind::Torque { .. } => {}
            LoadKind::Torsion { on, from, .. } if *from == Some(*on) => {}
            LoadKind::Torsion { on, from, axis, angle, angle_span, .. } => {
                let turns = Turns { on: *on, from: from.unwrap_or(FrameId::N), axis, angle };
                out.extend(turns.unlike_its_angle(&places, *angle_span));
            }
        }
    }
    out
}

/// Gravity and springs that move other things than those by which their energy is known: a point of a body
/// whose place moves on the body, or a frame that does not turn about the axis as the angle grows.
pub fn without_potential(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<usize> {
    let elsewhere = |load: &Load| {
        let at = |views: &Views<'_>| match &load.kind {
            LoadKind::Gravity(g) => m.bodies.iter().any(|body| falls_elsewhere(views, body, g)),
            LoadKind::Spring { a, b, .. } => pulls_elsewhere(views, *a, *b),
            LoadKind::Torsion { on, from, axis, angle, .. } => {
                let turns = Turns { on: *on, from: from.unwrap_or(FrameId::N), axis, angle };
                turns.fit(views).is_some_and(|fit| fit != Fit::Same)
            }
            LoadKind::Force { .. } | LoadKind::Torque { .. } => false,
        };
        load.potential && !is_slack(&load.kind) && seen.iter().any(|seen| at(&seen.views))
    };
    (0..m.loads.len()).filter(|&i| elsewhere(&m.loads[i])).collect()
}

/// Whether it is a spring without stiffness.
fn is_slack(load: &LoadKind) -> bool {
    match load {
        LoadKind::Spring { stiffness, .. } | LoadKind::Torsion { stiffness, .. } => is_zero(stiffness),
        _ => false,
    }
}

/// Whether two rates with these parts differ.
fn apart(a: &[f64], b: &[f64]) -> bool {
    let size = a.iter().chain(b).fold(0.0_f64, |size, x| size.max(x.abs()));
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > SAME * size)
}

/// Whether the height of the mass centre does not change as its velocity says. Where it has no height there is
/// no energy anyway.
fn falls_elsewhere(views: &Views<'_>, body: &Body, g: &Vector) -> bool {
    let Ok(g) = views.now.vector(g, Level::Motion).map(values) else { return false };
    let along = |v: Result<Triple, Failure>| v.map(|v| dot3(values(v), g));
    let height = views.parts(|of| along(of.rate_of_position(body.centre)));
    let motion = views.parts(|of| along(of.velocity(body.centre)));
    matches!((height, motion), (Ok(height), Ok(motion)) if apart(&height, &motion))
}

/// Whether the length between two points does not change as their velocities say.
fn pulls_elsewhere(views: &Views<'_>, a: PointId, b: PointId) -> bool {
    let line = |of: &Evaluator<'_>| Ok(sub(of.position(b)?, of.position(a)?));
    let Ok(along) = line(&views.now).map(values) else { return false };
    let length = views.parts(|of| Ok(dot3(values(line(of)?.map(HyperDual::rate)), along)));
    let motion = views.parts(|of| Ok(dot3(values(sub(of.velocity(b)?, of.velocity(a)?)), along)));
    matches!((length, motion), (Ok(length), Ok(motion)) if apart(&length, &motion))
}

/// The place at which an end of the load is named.
fn end(load: &Load, i: usize) -> Span {
    load.ends.get(i).copied().unwrap_or(load.span)
}

fn never_moves<E>(places: &Places<'_>, parts: impl Fn(&Views<'_>) -> Result<Vec<Vector3>, E>) -> bool {
    let still = |views: &Views<'_>| parts(views).is_ok_and(|parts| parts.iter().all(|v| norm3(*v) < 1e-12));
    !places.views.is_empty() && places.views.iter().copied().all(still)
}

/// A load on a place where a contact acts on the point of a body that is there: the two points move
/// differently.
fn on_a_place(places: &Places<'_>, point: PointId, span: Span) -> Option<Diagnostic> {
    let m = places.m;
    let of_body = m.contacts.iter().find_map(|contact| {
        let struck = match contact.against {
            Against::Point(struck, Some(body)) => Some((struck, body)),
            _ => None,
        };
        let striking = contact.body.map(|body| (contact.point, body));
        let (_, body) = [striking, struck].into_iter().flatten().find(|(p, _)| *p == point)?;
        Some((contact, body))
    });
    let (contact, body) = of_body.filter(|(_, body)| m.bodies[body.0].frame.is_some())?;
    if places.views.is_empty() || places.moves_with(point, body) {
        return None;
    }
    let (p, b) = (&m.points[point.0].name, &m.bodies[body.0].name);
    let message = format!(
        "`{p}` is a geometric point here, not a point of `{b}`: this load does not act on the rotation of `{b}`"
    );
    let help = format!("place the point of the body that is there under `points`, as in `{p} of {b} = ..;`");
    let related = format!("the contact `{}` acts on the point of `{b}`", contact.name);
    Some(Diagnostic::new(codes::LOAD_POINT, span, message).related(contact.point_span, related).help(help))
}

/// A torsion spring: what turns about what.
struct Turns<'a> {
    on: FrameId,
    from: FrameId,
    axis: &'a Vector,
    angle: &'a Scalar,
}

/// How the rate of an angle fits an angular velocity about an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fit {
    Same,
    Opposite,
    /// neither, about a hinge, or in a joint of several axes of which the angle knows nothing
    Other,
    /// in a joint of several axes, where there is no angle about an axis: it may be meant as it is
    Open,
}

impl Turns<'_> {
    /// The rate of the angle is the angular velocity about the axis, or the spring's energy is not what its
    /// torque does.
    fn unlike_its_angle(&self, places: &Places<'_>, span: Span) -> Option<Diagnostic> {
        let m = places.m;
        let fits: Option<Vec<Fit>> = places.views.iter().map(|views| self.fit(views)).collect();
        let fits = fits.filter(|fits| !fits.is_empty() && !fits.contains(&Fit::Same))?;
        let (b, a) = (&m.frames[self.on.0].name, &m.frames[self.from.0].name);
        let message = if fits.iter().all(|fit| *fit == Fit::Opposite) {
            format!(
                "this angle grows while `{b}` turns in `{a}` backwards about the axis: the spring drives instead of resisting"
            )
        } else if fits.contains(&Fit::Open) {
            return None;
        } else {
            format!("this is not the angle by which `{b}` turns in `{a}` about the axis")
        };
        let help = "the rate of the angle must be the angular velocity about the axis, so that the torque belongs to the energy of the spring; check signs, frames and axis";
        Some(Diagnostic::new(codes::TORSION_ANGLE, span, message).help(help))
    }

    /// `None` where there are no numbers.
    fn fit(&self, views: &Views<'_>) -> Option<Fit> {
        let rate = views.rate_parts(self.angle).ok()?;
        let axis = views.now.vector(self.axis, Level::Motion).ok()?.map(|c| c.re);
        let relative = |values: &Evaluator<'_>| {
            Ok(sub(values.angular_velocity(self.on)?, values.angular_velocity(self.from)?))
        };
        let parts = views.vector_parts(relative).ok()?;
        let turning: Vec<f64> = parts.iter().map(|w| dot3(*w, axis)).collect();
        let size = |list: &[f64]| list.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let largest = size(&rate).max(size(&turning));
        let off =
            |sign: f64| rate.iter().zip(&turning).fold(0.0_f64, |off, (a, b)| off.max((sign * a - b).abs()));
        if largest.is_nan() || off(1.0) <= SAME * largest {
            return Some(Fit::Same);
        }
        if off(-1.0) <= SAME * largest {
            return Some(Fit::Opposite);
        }
        let fastest = parts.iter().fold(0.0_f64, |size, w| size.max(norm3(*w)));
        let crossed = |a: &Vector3, b: &Vector3| norm3(cross3(*a, *b)) > SAME * fastest * fastest;
        let hinge = !parts.iter().any(|a| parts.iter().any(|b| crossed(a, b)));
        let shared: f64 = rate.iter().zip(&turning).map(|(a, b)| a * b).sum();
        let strange = shared.abs() <= SAME * size(&rate) * size(&turning);
        Some(if hinge || strange { Fit::Other } else { Fit::Open })
    }
}
