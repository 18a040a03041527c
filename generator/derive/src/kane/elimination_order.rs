//! The order in which the velocities of frames and points are eliminated from a quadratic form.

use std::collections::BTreeSet;

use crate::kinematics::Kinematics;
use hodograph_model::model::mechanism::{FrameId, PointId};

/// A velocity to eliminate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Node {
    /// the angular velocity of a frame
    Frame(FrameId),
    /// the velocity of a point
    Point(PointId),
}

/// Everything that the velocities of these points and frames depend on, each velocity after those that are
/// stated in terms of it; angular velocities as early as they can go, so that what a frame carries is one
/// rigid whole before its hinge is passed.
pub fn elimination_order(k: &Kinematics<'_>, on: &[PointId], of: &[FrameId]) -> Vec<Node> {
    let (mut points, mut frames) = relevant(k, on, of);
    let mut order = Vec::new();
    while !(points.is_empty() && frames.is_empty()) {
        let frame = frames.iter().rev().copied().find(|&frame| frame_is_free(k, frame, &points, &frames));
        if let Some(frame) = frame {
            frames.remove(&frame);
            order.push(Node::Frame(frame));
            continue;
        }
        let deepest = points
            .iter()
            .copied()
            .filter(|&point| !points.iter().any(|other| k.points[other.0].base == Some(point)))
            .max_by_key(|&point| (depth(k, point), point));
        match deepest {
            Some(point) => {
                points.remove(&point);
                order.push(Node::Point(point));
            }
            None => break,
        }
    }
    order
}

fn frame_is_free(
    k: &Kinematics<'_>,
    frame: FrameId,
    points: &BTreeSet<PointId>,
    frames: &BTreeSet<FrameId>,
) -> bool {
    let carries_point = points.iter().any(|p| k.points[p.0].arms.iter().any(|arm| arm.frame == frame));
    let carries_frame = frames.iter().any(|f| *f != frame && k.turning(k.frames[f.0].base) == frame);
    !carries_point && !carries_frame
}

fn depth(k: &Kinematics<'_>, point: PointId) -> usize {
    let mut depth = 0;
    let mut at = point;
    while let Some(base) = k.points[at.0].base {
        depth += 1;
        at = base;
    }
    depth
}

/// The points and frames whose velocities those of `on` and `of` are made of.
fn relevant(k: &Kinematics<'_>, on: &[PointId], of: &[FrameId]) -> (BTreeSet<PointId>, BTreeSet<FrameId>) {
    let (mut points, mut frames) = (BTreeSet::new(), BTreeSet::new());
    for &point in on {
        let mut at = Some(point);
        while let Some(point) = at {
            if !points.insert(point) {
                break;
            }
            frames.extend(k.points[point.0].arms.iter().map(|arm| arm.frame));
            at = k.points[point.0].base;
        }
    }
    frames.extend(of.iter().map(|&frame| k.turning(frame)));
    for frame in frames.clone() {
        let mut at = frame;
        while at != FrameId::N {
            frames.insert(at);
            at = k.turning(k.frames[at.0].base);
        }
    }
    frames.remove(&FrameId::N);
    (points, frames)
}
