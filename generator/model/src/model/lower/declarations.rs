//! Numbers the declared definitions, frames and points, and assigns stated motions to them, each once.

use std::collections::HashMap;

use super::super::mechanism::{
    Definition, DefinitionValue, Frame, FrameId, Orientation, Place, Point, PointId, Vector,
};
use super::Lowering;
use super::resolve::{MAX_SUGGESTIONS, unknown_name};
use crate::diagnostics::{Code, Diagnostic, Label, codes};
use crate::span::Span;

impl Lowering<'_> {
    /// Places for everything, so that ids are in range whatever goes wrong later.
    pub(super) fn declarations(&mut self) {
        let nowhere = Span::default();
        for definition in &self.tree.definitions {
            self.out.definitions.push(Definition {
                name: definition.name.text.clone(),
                docs: definition.docs.clone(),
                value: DefinitionValue::Vector(Vector::Zero),
                of_shapes: false,
                span: definition.name.span,
            });
        }
        let frame = |name: &str, docs: &str, span, orientation_span, motion_span| Frame {
            name: name.to_owned(),
            docs: docs.to_owned(),
            parent: None,
            orientation: Orientation::Aligned,
            angular_velocity: None,
            span,
            orientation_span,
            motion_span,
        };
        self.out.frames.push(frame("N", "", nowhere, nowhere, nowhere));
        for f in &self.tree.frames {
            let stated = self.stated.angular_velocities.get(f.name.text.as_str());
            let motion = stated.map_or(f.name.span, |stated| stated.frame.span);
            self.out.frames.push(frame(&f.name.text, &f.docs, f.name.span, f.value.span, motion));
        }
        let point = |name: &str, docs: &str, span, motion_span| Point {
            name: name.to_owned(),
            docs: docs.to_owned(),
            place: Place::Origin,
            velocity: None,
            span,
            motion_span,
        };
        self.out.points.push(point("O", "", nowhere, nowhere));
        for p in &self.tree.points {
            let stated = self.stated.velocities.get(p.name.text.as_str());
            let motion = stated.map_or(p.name.span, |stated| stated.point.span);
            self.out.points.push(point(&p.name.text, &p.docs, p.name.span, motion));
        }
        self.stated_motions();
    }

    /// What is stated of the motion of frames and points must name some, and each once.
    fn stated_motions(&mut self) {
        let tree = self.tree;
        let mut seen: HashMap<&str, Span> = HashMap::new();
        for name in tree.angular_velocities.iter().map(|a| &a.frame) {
            if self.frame_named(name) == Some(FrameId::N) {
                let message = format!("the angular velocity of `{}` is stated: it does not turn", name.text);
                let help = "leave it out; a frame that turns is declared under `frames`";
                self.report(Diagnostic::new(codes::INCONSISTENT, name.span, message).help(help));
            }
            if let Some(first) = seen.insert(&name.text, name.span) {
                let message = format!("the angular velocity of `{}` is stated twice", name.text);
                self.report(
                    Diagnostic::new(codes::MOTION_TWICE, name.span, message).related(first, "first here"),
                );
            }
        }
        seen.clear();
        for name in tree.velocities.iter().map(|v| &v.point) {
            if self.point_named(name) == Some(PointId::O) {
                let message = format!("the velocity of `{}` is stated: it does not move", name.text);
                let help = "leave it out; a point that moves is placed under `points`";
                self.report(Diagnostic::new(codes::INCONSISTENT, name.span, message).help(help));
            }
            if let Some(first) = seen.insert(&name.text, name.span) {
                let message = format!("the velocity of `{}` is stated twice", name.text);
                self.report(
                    Diagnostic::new(codes::MOTION_TWICE, name.span, message).related(first, "first here"),
                );
            }
        }
    }

    /// `l1: m = 1, l1: m = 2` where `l2` is used: a declaration was copied, and its name not changed. That is
    /// one mistake.
    pub(super) fn copied(&mut self) {
        let mut names = self.names.ambiguous();
        let (Some(twice), None) = (names.next(), names.next()) else { return };
        if self.unknown.len() > MAX_SUGGESTIONS {
            return;
        }
        let mut unknown = self.unknown.iter().filter(|unknown| self.names.is_near(unknown, twice));
        let (Some(unknown), None) = (unknown.next(), unknown.next()) else { return };
        let message = unknown_name(unknown);
        let at = |code: Code| self.diagnostics.iter().position(|error| error.code == code);
        let used = self.diagnostics.iter().position(|error| error.message == message);
        if let (Some(declared), Some(used)) = (at(codes::DUPLICATE_NAME), used) {
            let help = format!("is `{unknown}` meant, which is used, but not declared?");
            let use_of_it =
                Label { span: self.diagnostics[used].primary.span, text: format!("`{unknown}` stands here") };
            let error = &mut self.diagnostics[declared];
            error.help = Some(help);
            error.related.push(use_of_it);
            self.diagnostics.remove(used);
        }
    }
}
