//! Reports mass centres that do not move as their positions change. In `G of B = O + ..` the velocity of G is that
//! of a material point of B; where G is none, the inertia would be that of another motion.

use super::contacts::fastest;
use super::states::Seen;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::{Body, Mechanism, PointId};
use crate::numeric::views::{norm3, sub3};

/// Velocities may differ by this much, relative to the larger.
const SAME: f64 = 1e-6;
/// What rounding can leave of a velocity that is 0, beside the fastest.
const ROUNDING: f64 = 1e-12;

/// Mass centres whose velocity is the rate of their position at none of these states. `found` is what is said
/// already of their points.
pub(super) fn centres(m: &Mechanism, seen: &[Seen<'_>], found: &[Diagnostic]) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    for body in &m.bodies {
        let point = &m.points[body.centre.0];
        let said = |list: &[Diagnostic]| list.iter().any(|d| d.primary.span == point.span);
        if said(found) || said(&out) || seen.is_empty() {
            continue;
        }
        if seen.iter().all(|seen| contradicts(m, seen, body) == Some(true)) {
            let (name, body) = (&point.name, &body.name);
            let message =
                format!("`{name}`, the mass centre of `{body}`, does not move as its position changes");
            let help = format!(
                "`{name} of ..` gives `{name}` the velocity of matter: leave out `of ..` here, or place `{name}` where \
                 it stays in what it belongs to"
            );
            out.push(Diagnostic::new(codes::POINT, point.span, message).help(help));
        }
    }
    out
}

/// Whether the velocity of a mass centre is not the rate of its position; `None` where that is not known.
fn contradicts(m: &Mechanism, seen: &Seen<'_>, body: &Body) -> Option<bool> {
    let views = &seen.views;
    // a point that is known by its velocity may be any point that has this velocity now
    if views.now.root(body.centre) != PointId::O {
        return None;
    }
    let velocity = views.vector_parts(|values| values.velocity(body.centre)).ok()?;
    let rate = views.vector_parts(|values| values.rate_of_position(body.centre)).ok()?;
    let apart = velocity.iter().zip(&rate).zip(fastest(m, views).ok()?).any(|((v, rate), fastest)| {
        let apart = norm3(sub3(*v, *rate));
        apart > SAME * (norm3(*v) + norm3(*rate)) && apart > ROUNDING * fastest
    });
    Some(apart)
}
