//! Reads and checks the attributes of a robot description; each mistake is reported at its place.

use nalgebra::Vector3;
use roxmltree::{Attribute, Node};

use super::lines::Lines;
use super::poses::{Pose, of_quaternion};

/// Types of joints that URDF knows.
const TYPES: [&str; 6] = ["fixed", "revolute", "continuous", "prismatic", "planar", "floating"];

/// The moments of an `<inertia>`.
const MOMENTS: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/// Collects faults with their places.
pub struct Checker<'a> {
    file: &'a str,
    lines: &'a Lines<'a>,
    /// one sentence each
    pub problems: Vec<String>,
}

impl<'a> Checker<'a> {
    /// A checker without faults so far.
    pub fn new(file: &'a str, lines: &'a Lines<'a>) -> Self {
        Checker { file, lines, problems: Vec::new() }
    }

    fn problem(&mut self, offset: usize, message: &str) {
        self.problems.push(format!("{}:{}: {message}", self.file, self.lines.place(offset)));
    }

    fn at_start(&mut self, node: Node, message: &str) {
        self.problem(node.range().start, message);
    }

    fn at_value(&mut self, node: Node, attribute: Attribute, message: &str) {
        let shown = format!("`{}=\"{}\"` of {}", attribute.name(), attribute.value(), titled(node));
        self.problem(attribute.range().start, &format!("{shown}: {message}"));
    }

    /// Checks a `<link>`: its name and its `<inertial>`.
    pub fn link(&mut self, link: Node) {
        self.named(link);
        for inertial in self.at_most_one(link, "inertial") {
            for part in ["mass", "inertia"] {
                // A missing number must not count as zero.
                if !inertial.children().any(|child| is(&child, part)) {
                    let name = link.attribute("name").unwrap_or_default();
                    self.at_start(inertial, &format!("<inertial> of link `{name}` has no <{part}>: add it"));
                }
            }
            self.pose(inertial);
            for mass in self.at_most_one(inertial, "mass") {
                self.number(mass, "value", true);
            }
            for inertia in self.at_most_one(inertial, "inertia") {
                MOMENTS.iter().for_each(|moment| self.number(inertia, moment, true));
            }
        }
        for collision in link.children().filter(|part| is(part, "collision")) {
            ["origin", "geometry"].iter().for_each(|part| drop(self.at_most_one(collision, part)));
        }
    }

    /// Checks a `<joint>`: its name and type, its origin, the links that it connects, its axis and its
    /// damping.
    pub fn joint(&mut self, joint: Node) {
        self.named(joint);
        match joint.attribute_node("type") {
            None => self.at_start(joint, &format!("{} has no attribute `type`", titled(joint))),
            Some(kind) if !TYPES.contains(&kind.value()) => {
                let message = format!("there is no such type of joint; URDF has {}", TYPES.join(", "));
                self.at_value(joint, kind, &message);
            }
            Some(_) => {}
        }
        for (part, attribute) in [("parent", "link"), ("child", "link")] {
            let found = self.at_most_one(joint, part);
            if found.is_empty() {
                self.at_start(joint, &format!("{} has no <{part}>: name its {part} link", titled(joint)));
            }
            for node in found.into_iter().filter(|node| !node.has_attribute(attribute)) {
                self.at_start(node, &format!("<{part}> of {} has no attribute `{attribute}`", titled(joint)));
            }
        }
        self.pose(joint);
        for axis in self.at_most_one(joint, "axis") {
            self.three(axis, "xyz", true);
        }
        for dynamics in self.at_most_one(joint, "dynamics") {
            ["damping", "friction"].iter().for_each(|name| self.number(dynamics, name, false));
        }
        for mimic in self.at_most_one(joint, "mimic") {
            if !mimic.has_attribute("joint") {
                self.at_start(mimic, &format!("<mimic> of {} has no attribute `joint`", titled(joint)));
            }
            ["multiplier", "offset"].iter().for_each(|name| self.number(mimic, name, false));
        }
    }

    fn named(&mut self, node: Node) {
        if node.attribute("name").is_none_or(str::is_empty) {
            self.at_start(node, &format!("this <{}> has no name: give it one", node.tag_name().name()));
        }
    }

    fn pose(&mut self, node: Node) {
        for origin in self.at_most_one(node, "origin") {
            ["xyz", "rpy"].iter().for_each(|name| self.three(origin, name, false));
            if let Some(attribute) = origin.attribute_node("quat_xyzw") {
                if origin.has_attribute("rpy") {
                    self.at_value(origin, attribute, "there is an `rpy` too: keep one");
                } else if quaternion(origin).is_err() {
                    self.at_value(
                        origin,
                        attribute,
                        "write four finite numbers, not all zero, the scalar part last",
                    );
                }
            }
        }
    }

    /// The children of a kind, of which there must be at most one.
    fn at_most_one<'n>(&mut self, node: Node<'n, 'n>, kind: &str) -> Vec<Node<'n, 'n>> {
        let found: Vec<_> = node.children().filter(|child| is(child, kind)).collect();
        if let [_, second, ..] = found[..] {
            self.at_start(second, &format!("a second <{kind}> of {}: keep one", titled(node)));
        }
        found
    }

    fn number(&mut self, node: Node, name: &str, needed: bool) {
        match node.attribute_node(name) {
            None if needed => self.at_start(node, &format!("{} has no attribute `{name}`", titled(node))),
            None => {}
            Some(attribute) => match attribute.value().trim().parse::<f64>() {
                Err(_) => self.at_value(node, attribute, "this is not a number"),
                Ok(number) if !number.is_finite() => {
                    self.at_value(node, attribute, "this number is not finite");
                }
                Ok(_) => {}
            },
        }
    }

    fn three(&mut self, node: Node, name: &str, needed: bool) {
        match node.attribute_node(name) {
            None if needed => self.at_start(node, &format!("{} has no attribute `{name}`", titled(node))),
            None => {}
            Some(attribute) => {
                let words = attribute.value().split_whitespace().map(str::parse::<f64>);
                let numbers: Vec<_> = words.flatten().filter(|number| number.is_finite()).collect();
                if numbers.len() != 3 || attribute.value().split_whitespace().count() != 3 {
                    self.at_value(node, attribute, "write three finite numbers with spaces between them");
                }
            }
        }
    }
}

/// The name of an element in messages: with its own name, or with that of the link or joint it belongs to.
fn titled(node: Node) -> String {
    let kind = node.tag_name().name();
    let owner = |node: &Node| matches!(node.tag_name().name(), "link" | "joint");
    match node.ancestors().find(owner) {
        Some(owner) => {
            let name = owner.attribute("name").unwrap_or_default();
            let owned = format!("{} `{name}`", owner.tag_name().name());
            if owner == node { owned } else { format!("<{kind}> of {owned}") }
        }
        None => format!("<{kind}>"),
    }
}

/// Whether it is an element of this kind.
pub fn is(node: &Node, kind: &str) -> bool {
    node.is_element() && node.tag_name().name() == kind
}

/// The finite numbers of an attribute.
///
/// # Errors
///
/// The mistake, as the end of a sentence about the element.
pub fn numbers<const N: usize>(element: Option<Node>, name: &str) -> Result<[f64; N], String> {
    let text = element.and_then(|element| element.attribute(name));
    let text = text.ok_or_else(|| format!("it has no attribute `{name}`"))?;
    let read: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let read = read.filter(|list| list.iter().all(|number| number.is_finite()));
    let read: Option<[f64; N]> = read.and_then(|list| list.try_into().ok());
    let wanted = match N {
        1 => "a finite number".to_owned(),
        3 => "three finite numbers".to_owned(),
        _ => format!("{N} finite numbers"),
    };
    read.ok_or_else(|| format!("`{name}=\"{text}\"` is not {wanted}"))
}

/// Roll, pitch and yaw of the attribute `quat_xyzw`, which URDF has since its version 1.2.
fn quaternion(origin: Node) -> Result<Vector3<f64>, String> {
    let [x, y, z, w] = numbers(Some(origin), "quat_xyzw")?;
    let turn = of_quaternion([w, x, y, z]).ok_or("`quat_xyzw` is zero: it is no rotation")?;
    Ok(Pose { turn, ..Pose::identity() }.rpy())
}

/// The `<origin>` of an element: its place, and roll, pitch and yaw of its axes; zero by default.
///
/// # Errors
///
/// Those of [`numbers`].
pub fn pose(element: Node) -> Result<(Vector3<f64>, Vector3<f64>), String> {
    let origin = element.children().find(|part| is(part, "origin"));
    let three = |name: &str| match origin.and_then(|origin| origin.attribute(name)) {
        None => Ok(Vector3::zeros()),
        Some(_) => numbers(origin, name).map(Vector3::from),
    };
    let rpy = match origin.filter(|origin| origin.has_attribute("quat_xyzw")) {
        Some(origin) => quaternion(origin)?,
        None => three("rpy")?,
    };
    Ok((three("xyz")?, rpy))
}
