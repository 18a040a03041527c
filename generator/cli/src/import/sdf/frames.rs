//! The poses of links, joints and frames, each relative to axes of its choice.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use nalgebra::Vector3;
use roxmltree::Node;

use super::{Reader, WORLD, child, text};
use crate::import::fixed_links::rotation_of;
use crate::import::poses::{Pose, of_quaternion};

/// The axes of the model itself.
pub(super) const MODEL: &str = "__model__";

/// A link, joint or frame.
struct Frame {
    /// its place in the file
    at: String,
    /// what its pose is relative to
    within: String,
    pose: Pose,
    /// what it moves with; `None` for a link
    attached: Option<String>,
}

/// The links, joints and frames of a model.
#[derive(Default)]
pub(super) struct Frames {
    known: HashMap<String, Frame>,
    /// their names in the order of the file
    order: Vec<String>,
    /// the link that the axes of the model move with
    pub(super) canonical: String,
}

impl Frames {
    /// The mistakes in what the poses are relative to and what frames move with, each once; such a pose is taken
    /// relative to the model from then on.
    pub(super) fn settle(&mut self) -> Vec<String> {
        let mut problems = Vec::new();
        let mut settled: HashMap<&str, usize> = HashMap::new();
        let mut wrong = Vec::new();
        for (number, name) in self.order.iter().enumerate() {
            let mut here = name.as_str();
            // the walk ends at the model, at what another walk has settled, or where it has been itself
            while here != MODEL {
                match settled.get(here) {
                    Some(&walk) if walk == number => {
                        let at = &self.known[here].at;
                        problems.push(format!(
                            "{at}: the pose of `{here}` is defined by itself: state one of these poses relative to the model"
                        ));
                        wrong.push(here.to_owned());
                        break;
                    }
                    Some(_) => break,
                    None => settled.insert(here, number),
                };
                let frame = &self.known[here];
                if frame.within != MODEL && !self.known.contains_key(&frame.within) {
                    problems.push(self.unknown(&frame.within, &frame.at));
                    wrong.push(here.to_owned());
                    break;
                }
                here = &frame.within;
            }
        }
        for name in wrong {
            if let Some(frame) = self.known.get_mut(&name) {
                MODEL.clone_into(&mut frame.within);
            }
        }
        for problem in self.order.iter().filter_map(|name| self.lost(name)) {
            if !problems.contains(&problem) {
                problems.push(problem);
            }
        }
        problems
    }

    /// The mistake of a frame or joint that moves with something that does not exist.
    fn lost(&self, name: &str) -> Option<String> {
        let frame = &self.known[name];
        let unknown = |to: &&String| *to != MODEL && !self.known.contains_key(*to);
        frame.attached.as_ref().filter(unknown).map(|to| self.unknown(to, &frame.at))
    }

    fn unknown(&self, name: &str, at: &str) -> String {
        let hint = crate::spelling::hint(name, self.order.iter().map(String::as_str));
        format!("{at}: there is no frame, link or joint `{name}`: {hint}")
    }

    /// The pose of a link, joint or frame relative to the model.
    pub(super) fn absolute(&self, name: &str, at: &str) -> Result<Pose, String> {
        let (mut pose, mut name) = (Pose::identity(), name);
        while name != MODEL {
            let frame = self.known.get(name).ok_or_else(|| self.unknown(name, at))?;
            pose = frame.pose.then(&pose);
            name = &frame.within;
        }
        Ok(pose)
    }

    /// The link that a link, joint or frame moves with; an unknown name, and the world, stay.
    pub(super) fn link_of(&self, name: &str) -> String {
        let attached = |name: &str| self.known.get(name).and_then(|frame| frame.attached.as_deref());
        let of_model = |name| if name == MODEL { self.canonical.as_str() } else { name };
        let mut here = of_model(name);
        for _ in 0..=self.order.len() {
            match attached(here) {
                // an unknown name is told where it stands
                Some(next) if next == MODEL || self.known.contains_key(next) => here = of_model(next),
                _ => break,
            }
        }
        here.to_owned()
    }
}

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
        match self.frames.known.entry(name.to_owned()) {
            Entry::Occupied(_) => self.problems.push(format!("{at}: a second `{name}`: rename one")),
            Entry::Vacant(free) => {
                free.insert(Frame { at, within, pose, attached });
                self.frames.order.push(name.to_owned());
            }
        }
    }
}
