//! Finds the two frames whose relative rotation friction resists at a contact: surfaces that state `rolling` or
//! `spinning`.
//!
//! Theory: docs/theory.md, section 17.17.

use super::super::mechanism::{Against, BodyId, FrameId, ShapeId, Vector};
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::syntax::tree::Record;

impl Lowering<'_> {
    /// The frames of what strikes and of what is struck.
    pub(super) fn turning(
        &mut self,
        record: &Record,
        body: Option<BodyId>,
        against: &Against,
    ) -> Option<[FrameId; 2]> {
        let span = record.name.span;
        let striking = match body {
            Some(body) => self.turning_of(body, span),
            None => self.cannot_turn(span, "the point that strikes belongs to no body", "`point: P of Body`"),
        }?;
        let struck = match against {
            Against::Fixed => Some(FrameId::N),
            Against::Body(body) | Against::Point(_, Some(body)) => self.turning_of(*body, span),
            Against::Point(_, None) => self.cannot_turn(
                span,
                "the point that is struck belongs to no body",
                "`against: Q of Body`, or leave `against` out where what is struck is fixed in N",
            ),
            Against::Velocity(velocity) => match turns_with(velocity) {
                Some(frame) => Some(frame),
                None => self.cannot_turn(
                    span,
                    "a surface of given velocity does not tell how it turns",
                    "`against: B`, a frame that moves with the surface",
                ),
            },
        }?;
        Some([striking, struck])
    }

    /// The frames of two shapes.
    pub(super) fn turning_of_shapes(&mut self, record: &Record, ids: [ShapeId; 2]) -> Option<[FrameId; 2]> {
        let mut frames = [FrameId::N; 2];
        for (frame, id) in frames.iter_mut().zip(ids) {
            let shape = &self.out.shapes[id.0];
            *frame = match shape.body {
                Some(body) => self.turning_of(body, record.name.span)?,
                None => shape.frame,
            };
        }
        Some(frames)
    }

    fn turning_of(&mut self, body: BodyId, span: Span) -> Option<FrameId> {
        let body = self.out.bodies.get(body.0)?;
        if body.frame.is_none() {
            let message = format!("`{}` is a particle, which does not turn", body.name);
            return self.cannot_turn(
                span,
                &message,
                "a body with a frame, or a surface without these fields",
            );
        }
        body.frame
    }

    fn cannot_turn(&mut self, span: Span, why: &str, cure: &str) -> Option<FrameId> {
        let message = format!("friction of rolling or spinning needs two bodies that turn: {why}");
        self.report(Diagnostic::new(codes::CONTACT, span, message).help(format!("state {cure}")));
        None
    }
}

/// The frame whose points have this velocity, where it is that of a frame about a point.
fn turns_with(velocity: &Vector) -> Option<FrameId> {
    match velocity {
        Vector::Cross(turning, arm) => match (&**turning, &**arm) {
            (Vector::AngularVelocity { of, in_frame: FrameId::N }, Vector::Position { .. }) => Some(*of),
            _ => None,
        },
        Vector::Add(parts) => match &parts[..] {
            [Vector::Velocity(_), turned] => turns_with(turned),
            _ => None,
        },
        _ => None,
    }
}
