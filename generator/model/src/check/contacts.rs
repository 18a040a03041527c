//! Checks contacts by numbers: whether the point can move along the normal, and whether it belongs to the
//! bodies that are named.

use super::states::Seen;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::views::{alike, dot3, norm3, sub3};
use crate::numeric::{Failure, Level, Views};

/// A point that leaves its body along the normal by this share of its velocity is no point of it.
const SLIP: f64 = 1e-6;
/// What rounding can leave of a velocity that is 0, beside the fastest.
const ROUNDING: f64 = 1e-12;

/// Mistakes in contacts, at the states that were seen. `found` is what is said already, of points for
/// instance.
pub fn contacts(m: &Mechanism, seen: &[Seen<'_>], found: &[Diagnostic]) -> Vec<Diagnostic> {
    let places = Places { m, views: seen.iter().map(|seen| &seen.views).collect() };
    let mut out = Vec::new();
    for (i, contact) in m.contacts.iter().enumerate() {
        if let Some(error) = places.one_body(contact) {
            out.push(error);
            continue;
        }
        if found.iter().any(|d| d.primary.span == contact.normal_span) {
            continue;
        }
        // of two boxes many edges never meet
        if contact.validity.is_none()
            && let Some(still) = approach(m, contact, i, seen)
        {
            out.push(still);
            continue;
        }
        let mut ends = vec![(contact.point, contact.body, contact.point_span)];
        if let Against::Point(point, body) = contact.against {
            ends.push((point, body, contact.against_span));
        }
        for (point, body, span) in ends {
            if !found.iter().any(|d| d.primary.span == m.points[point.0].span) {
                out.extend(places.of_another_body(contact, point, body, span));
            }
        }
    }
    out
}

/// A contact in which nothing moves, or never along the normal: beside what moves at all with each speed.
fn approach(m: &Mechanism, contact: &Contact, index: usize, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    let (mut moves, mut approaches) = (false, false);
    for seen in seen {
        let at = &seen.at.contacts[index];
        let scale = fastest(m, &seen.views).ok()?;
        let parts = at.partial_velocities.iter().chain([&at.remainder]);
        for (v, scale) in parts.zip(scale) {
            moves |= norm3(*v) > ROUNDING * scale;
            approaches |= norm3(*v) > ROUNDING * scale && dot3(*v, at.normal).abs() > ROUNDING * norm3(*v);
        }
    }
    if !moves {
        let message =
            format!("the relative velocity of `{}` is always zero: there can be no impact", contact.name);
        let help = "check `point`, `against` and the bodies they belong to";
        return Some(Diagnostic::new(codes::CONTACT_STILL, contact.span, message).help(help));
    }
    if !approaches {
        let message = format!("`{}` never moves along its normal: there can be no impact", contact.name);
        let help = "check `normal`; it points from what is struck to the body that strikes";
        return Some(Diagnostic::new(codes::NEVER_APPROACHES, contact.span, message).help(help));
    }
    None
}

/// The velocity of the fastest point, for each speed and for prescribed motion.
pub fn fastest(m: &Mechanism, views: &Views<'_>) -> Result<Vec<f64>, Failure> {
    let mut out = vec![0.0_f64; views.units.len() + 1];
    for i in 0..m.points.len() {
        let parts = views.vector_parts(|values| values.velocity(PointId(i)))?;
        out.iter_mut().zip(parts).for_each(|(out, v)| *out = out.max(norm3(v)));
    }
    for body in (0..m.bodies.len()).map(BodyId) {
        let points = m.contacts.iter().map(|contact| contact.point);
        for point in points {
            let parts = views.vector_parts(|values| values.velocity_on_body(point, body))?;
            out.iter_mut().zip(parts).for_each(|(out, v)| *out = out.max(norm3(v)));
        }
    }
    Ok(out)
}

/// With what points move, at the states that were seen.
pub struct Places<'m> {
    /// the mechanism
    pub m: &'m Mechanism,
    /// the states
    pub views: Vec<&'m Views<'m>>,
}

impl Places<'_> {
    /// Whether something holds at every state, and there is a state. Where there are no numbers it does not.
    fn always(&self, holds: impl Fn(&Views<'_>) -> Option<bool>) -> bool {
        !self.views.is_empty() && self.views.iter().all(|views| holds(views) == Some(true))
    }

    /// Whether the place is fixed in the body.
    pub fn is_fixed_in(&self, point: PointId, body: BodyId) -> bool {
        self.always(|views| {
            let place = views.vector_parts(|values| values.rate_of_position(point)).ok()?;
            let matter = views.vector_parts(|values| values.velocity_on_body(point, body)).ok()?;
            Some(self.same_root(views, point, body) && alike(&place, &matter))
        })
    }

    /// Whether the point, by its velocity, moves with the matter of the body that is there.
    pub fn moves_with(&self, point: PointId, body: BodyId) -> bool {
        self.always(|views| {
            let velocity = views.vector_parts(|values| values.velocity(point)).ok()?;
            let matter = views.vector_parts(|values| values.velocity_on_body(point, body)).ok()?;
            Some(alike(&velocity, &matter))
        })
    }

    fn same_root(&self, views: &Views<'_>, point: PointId, body: BodyId) -> bool {
        views.now.same_root(point, self.m.bodies[body.0].centre)
    }

    /// The bodies with frames in which the place is a fixed one.
    fn carriers(&self, point: PointId) -> Vec<BodyId> {
        let bodies = (0..self.m.bodies.len()).map(BodyId);
        bodies.filter(|b| self.m.bodies[b.0].frame.is_some() && self.is_fixed_in(point, *b)).collect()
    }

    /// Two points of one body stay apart as they are.
    fn one_body(&self, contact: &Contact) -> Option<Diagnostic> {
        let Against::Point(struck, struck_body) = contact.against else { return None };
        let point = contact.point;
        let distance = |views: &Views<'_>| {
            let apart = [point, struck].map(|point| views.now.position(point).ok());
            let [Some(a), Some(b)] = apart else { return None };
            views.now.same_root(point, struck).then(|| norm3(sub3(a.map(|c| c.re), b.map(|c| c.re))))
        };
        let home = match (contact.body, struck_body) {
            (Some(a), Some(b)) if a == b && self.m.bodies[a.0].frame.is_some() => a,
            (Some(_), Some(_)) => return None,
            _ => {
                let carriers = self.carriers(point);
                *carriers.iter().find(|home| self.is_fixed_in(struck, **home))?
            }
        };
        if point == struck || self.views.iter().all(|views| distance(views).is_none_or(|d| d < 1e-12)) {
            return None;
        }
        let [p, q] = [point, struck].map(|point| &self.m.points[point.0].name);
        let body = &self.m.bodies[home.0].name;
        let message = format!("`{p}` and `{q}` are points of one body, `{body}`: they never meet");
        let help = "a contact is between two bodies: name a point of another one under `against`, or leave it out for a point fixed in N";
        Some(Diagnostic::new(codes::CONTACT, contact.against_span, message).help(help))
    }

    /// A point that is said to be of a body, or of none, and moves with another.
    fn of_another_body(
        &self,
        contact: &Contact,
        point: PointId,
        body: Option<BodyId>,
        span: crate::span::Span,
    ) -> Option<Diagnostic> {
        let name = &self.m.points[point.0].name;
        let field = if span == contact.point_span { "point" } else { "against" };
        let Some(body) = body else {
            let body = self.forgotten_body(point)?;
            let message = format!(
                "`{name}` is a geometric point here, not a point of a body: its velocity does not contain the rotation of `{body}`"
            );
            let help = format!("say of which body the point is that strikes: `{field}: {name} of {body}`");
            return Some(Diagnostic::new(codes::CONTACT_POINT, span, message).help(help));
        };
        let frame = self.m.bodies[body.0].frame?;
        if matches!(self.m.points[point.0].place, Place::Material { frame: of, .. } if of == frame) {
            return None;
        }
        // a place may wander over the surface of a body, but not through it
        let through = |views: &Views<'_>| {
            if !self.same_root(views, point, body) {
                return None;
            }
            let place = views.vector_parts(|values| values.rate_of_position(point)).ok()?;
            let matter = views.vector_parts(|values| values.velocity_on_body(point, body)).ok()?;
            let normal = views.now.vector(&contact.normal, Level::Motion).ok()?.map(|c| c.re);
            let size = place.iter().chain(&matter).fold(0.0_f64, |size, v| size.max(norm3(*v)));
            let slip = place.iter().zip(&matter).map(|(a, b)| dot3(sub3(*a, *b), normal).abs());
            Some(slip.fold(0.0, f64::max) > SLIP * size)
        };
        if !self.always(through) {
            return None;
        }
        // without another body to which it belongs it may be meant so: a rim against a wall that it does not
        // touch first there
        let home = self.carriers(point).first().map(|home| &self.m.bodies[home.0].name)?;
        let stated = &self.m.bodies[body.0].name;
        let message = format!(
            "`{name}` is not a point of `{stated}`, but of `{home}`: it moves through `{stated}` along the normal"
        );
        let help =
            format!("write `{field}: {name} of {home}`, or place `{name}` on the surface of `{stated}`");
        Some(Diagnostic::new(codes::CONTACT_POINT, span, message).help(help))
    }

    /// The body whose point is meant where `of` is forgotten: the place moves with no body, and is carried at
    /// a constant distance by the mass centre of one that turns.
    fn forgotten_body(&self, point: PointId) -> Option<&str> {
        if matches!(self.m.points[point.0].place, Place::Material { .. } | Place::Origin | Place::Velocity(_))
        {
            return None;
        }
        if (0..self.m.bodies.len()).any(|b| self.moves_with(point, BodyId(b))) {
            return None;
        }
        let still = |views: &Views<'_>| {
            let rate = views.vector_parts(|values| values.rate_of_position(point)).ok()?;
            Some(rate.iter().all(|v| norm3(*v) < 1e-12))
        };
        if self.always(still) {
            return None;
        }
        let mut at = point;
        while let Place::Offset { from, .. } | Place::Material { from, .. } = &self.m.points[at.0].place {
            at = *from;
            let carries = |body: &&Body| body.frame.is_some() && body.centre == at;
            let Some(body) = self.m.bodies.iter().find(carries) else { continue };
            let constant = |views: &Views<'_>| {
                let [a, b] = [point, at].map(|p| views.now.position(p).ok().map(|v| v.map(|c| c.re)));
                let arm = sub3(a?, b?);
                let rates = [point, at].map(|p| views.vector_parts(|values| values.rate_of_position(p)).ok());
                let [Some(a), Some(b)] = rates else { return None };
                let size = a.iter().chain(&b).fold(0.0_f64, |size, v| size.max(norm3(*v)));
                let grows = a.iter().zip(&b).map(|(a, b)| dot3(sub3(*a, *b), arm).abs());
                Some(norm3(arm) > 1e-12 && grows.fold(0.0, f64::max) <= SLIP * size * norm3(arm))
            };
            return self.always(constant).then_some(body.name.as_str());
        }
        None
    }
}
