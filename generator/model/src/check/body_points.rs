//! Reports points that do not move with the body that they are said to belong to. In `P of B = Q + ..` the
//! velocity of P is that of Q plus the angular velocity of B times the arm, which is right only if Q moves
//! with B. The check evaluates velocities.

use super::states::Seen;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::Evaluation;
use crate::numeric::views::{cross3, norm3, sub3};

/// What rounding can leave of a length or a speed beside the greatest of the mechanism.
const ROUNDING: f64 = 1e-12;

/// Points that are placed on bodies to which they do not belong.
pub(super) fn strangers(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for (i, point) in m.points.iter().enumerate() {
        let Place::Material { frame, from, .. } = point.place else { continue };
        // of shapes it is said where they are stated
        if of_a_shape(m, PointId(i)) {
            continue;
        }
        let stays = seen.iter().any(|seen| stays_on(m, &seen.at, frame, from).unwrap_or(true));
        if stays {
            continue;
        }
        let (p, q, b) = (&m.points[i].name, &m.points[from.0].name, &m.frames[frame.0].name);
        let message = format!("`{q}` is not a point of `{b}`: it does not move with it");
        let help = format!(
            "in `{p} of {b} = {q} + ..` {q} must move with {b}, as a hinge or the mass centre does; place {p} from such a point, or leave out \
             `of {b}` if {p} moves in {b} too"
        );
        out.push(Diagnostic::new(codes::POINT, point.span, message).help(help));
    }
    for contact in &m.contacts {
        let body = contact.body.map(|body| &m.bodies[body.0]).filter(|body| body.frame.is_none());
        let Some(particle) = body else { continue };
        let apart = |at: &Evaluation| {
            let (a, b) = (at.positions[contact.point.0]?, at.positions[particle.centre.0]?);
            let farthest = at.positions.iter().flatten().map(|p| norm3(*p)).fold(0.0, f64::max);
            Some(norm3(sub3(a, b)) > (1e-9 * (norm3(a) + norm3(b))).max(ROUNDING * farthest))
        };
        if !seen.is_empty() && seen.iter().all(|seen| apart(&seen.at) == Some(true)) {
            let (p, centre) = (&m.points[contact.point.0].name, &m.points[particle.centre.0].name);
            let message = format!("`{p}` is not the point of the particle `{}`", particle.name);
            let help = format!("a particle is one point: `{centre}`");
            out.push(Diagnostic::new(codes::CONTACT, contact.span, message).help(help));
        }
    }
    out
}

/// Whether a pair of shapes gave this point.
fn of_a_shape(m: &Mechanism, point: PointId) -> bool {
    m.contacts.iter().filter(|contact| contact.shapes.is_some()).any(|contact| {
        let struck = matches!(contact.against, Against::Point(struck, _) if struck == point);
        contact.point == point || struck
    })
}

/// Whether the point moves as a point of something that has this frame does. `None` where nothing tells.
fn stays_on(m: &Mechanism, at: &Evaluation, frame: FrameId, point: PointId) -> Option<bool> {
    let turning = at.angular_velocities[frame.0];
    let mut references = m.bodies.iter().filter(|body| body.frame == Some(frame)).map(|body| body.centre);
    let with = |reference: PointId| {
        let arm = sub3(at.positions[point.0]?, at.positions[reference.0]?);
        let (of_point, of_reference) = (at.velocities[point.0], at.velocities[reference.0]);
        let turned = cross3(turning, arm);
        let slip = sub3(sub3(of_point, of_reference), turned);
        let scale = norm3(of_point) + norm3(of_reference) + norm3(turned);
        // what stands still by cancellation has a velocity of rounding
        let fastest = at.velocities.iter().map(|v| norm3(*v)).fold(0.0, f64::max);
        Some(norm3(slip) <= (1e-9 * scale).max(ROUNDING * fastest))
    };
    if frame == FrameId::N {
        return with(PointId::O);
    }
    let first = with(references.next()?)?;
    references.try_fold(first, |stays, reference| Some(stays || with(reference)?))
}
