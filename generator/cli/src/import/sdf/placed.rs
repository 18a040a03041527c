//! Reads the poses of links, joints and frames, each relative to axes of its choice.

use nalgebra::Vector3;
use roxmltree::Node;

use super::frames::{Frame, MODEL};
use super::{Reader, WORLD, child, text};
use crate::import::poses::{Pose, of_quaternion, rotation_of};

impl Reader<'_> {
    /// The `<pose>` of an element, and the name of what it is relative to.
    pub(super) fn pose(&self, of: Node) -> Result<(Pose, Option<String>), String> {
        let Some(node) = child(of, "pose") else { return Ok((Pose::identity(), None)) };
        let stated = |name: &str| node.attribute(name).filter(|value| !value.is_empty());
        // `frame` is its name before 1.7
        let within = stated("relative_to").or_else(|| stated("frame").filter(|_| self.version < 7));
        let degrees = match stated("degrees") {
            None | Some("false" | "0") => false,
            Some("true" | "1") => true,
            Some(_) => return Err(self.wrong(node, "`degrees` is `true` or `false`")),
        };
        let empty = node.text().is_none_or(|text| text.trim().is_empty());
        let pose = match stated("rotation_format") {
            _ if empty => Pose::identity(),
            None | Some("euler_rpy") => {
                let [x, y, z, roll, pitch, yaw] = self.numbers(node)?;
                let angles = Vector3::new(roll, pitch, yaw);
                let angles = if degrees { angles.map(f64::to_radians) } else { angles };
                Pose { turn: rotation_of(&angles), at: Vector3::new(x, y, z) }
            }
            Some("quat_xyzw") if degrees => {
                return Err(self.wrong(node, "a quaternion has no `degrees`: remove this attribute"));
            }
            Some("quat_xyzw") => {
                let [x, y, z, i, j, k, w] = self.numbers(node)?;
                let zero = || self.wrong(node, "its quaternion is zero, which is no rotation");
                Pose { turn: of_quaternion([w, i, j, k]).ok_or_else(zero)?, at: Vector3::new(x, y, z) }
            }
            Some(_) => return Err(self.wrong(node, "`rotation_format` is `euler_rpy` or `quat_xyzw`")),
        };
        Ok((pose, within.map(str::to_owned)))
    }

    /// The pose of an element of a link, which is relative to the link.
    pub(super) fn pose_in_link(&self, node: Node) -> Result<Pose, String> {
        match self.pose(node)? {
            (pose, None) => Ok(pose),
            (_, Some(_)) => {
                Err(self
                    .wrong(node, "`relative_to` is not imported here: state the pose relative to the link"))
            }
        }
    }

    /// Records a link, joint or frame with its pose.
    pub(super) fn frame(&mut self, node: Node) {
        let at = self.at(node);
        let Some(name) = node.attribute("name").filter(|name| !name.is_empty()) else {
            let problem = format!("{at}: this <{}> has no name: give it one", node.tag_name().name());
            return self.problems.push(problem);
        };
        let attached = match node.tag_name().name() {
            // what is wrong with the ends of a joint is told with them
            "joint" => {
                child(node, "child").map(text).map(|name| if name == WORLD { String::new() } else { name })
            }
            "frame" => Some(node.attribute("attached_to").unwrap_or_default().to_owned()),
            _ => None,
        };
        let attached = attached.map(|name| if name.is_empty() { MODEL.to_owned() } else { name });
        let (pose, within) = self.pose(node).unwrap_or_else(|problem| {
            self.problems.push(problem);
            (Pose::identity(), None)
        });
        let within = within.or_else(|| attached.clone()).unwrap_or_else(|| MODEL.to_owned());
        if let Err(problem) = self.frames.add(name, Frame { at, within, pose, attached }) {
            self.problems.push(problem);
        }
    }
}
