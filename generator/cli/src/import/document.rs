//! Reads URDF: links and joints, and a report of unused elements.

use roxmltree::Node;

use super::attributes::Checker;
use super::collision;
use super::description::{Gravity, Joint, Link, Robot};
use super::lines::Lines;
use super::xml::{Ignored, Known, unread};

/// What is read of a robot.
const READ: [Known; 17] = [
    Known::new("robot", &["name", "version"], &[], &["link", "joint"]),
    Known::new("link", &["name"], &["inertial"], &["collision"]),
    Known::new("joint", &["name", "type"], &["origin", "parent", "child", "axis", "dynamics", "mimic"], &[]),
    Known::new("inertial", &[], &["origin", "mass", "inertia"], &[]),
    Known::new("origin", &["xyz", "rpy", "quat_xyzw"], &[], &[]),
    Known::new("mass", &["value"], &[], &[]),
    Known::new("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"], &[], &[]),
    Known::new("parent", &["link"], &[], &[]),
    Known::new("child", &["link"], &[], &[]),
    Known::new("axis", &["xyz"], &[], &[]),
    Known::new("dynamics", &["damping", "friction"], &[], &[]),
    Known::new("mimic", &["joint", "multiplier", "offset"], &[], &[]),
    Known::new("collision", &["name"], &["origin", "geometry"], &[]),
    // a shape that is not imported has a note of its own
    Known::new("geometry", &[], &[], &["box", "cylinder", "sphere", "mesh", "capsule"]),
    Known::new("box", &["size"], &[], &[]),
    Known::new("cylinder", &["radius", "length"], &[], &[]),
    Known::new("sphere", &["radius"], &[], &[]),
];

/// Reads the file.
///
/// # Errors
///
/// The mistakes of the file as a robot description.
pub fn read(
    root: Node,
    file: &str,
    lines: &Lines<'_>,
    notes: &mut Vec<String>,
) -> Result<Robot, Vec<String>> {
    let at = |node: Node| format!("{file}:{}", lines.place(node.range().start));
    let xacro = |node: &Node| node.tag_name().namespace().is_some_and(|name| name.contains("xacro"));
    if let Some(node) = root.descendants().find(xacro) {
        return Err(vec![format!(
            "{}: this is xacro, not yet URDF: expand it first (`xacro {file} > robot.urdf`)",
            at(node)
        )]);
    }
    let mut checker = Checker::new(file, lines);
    let (mut links, mut joints) = (Vec::new(), Vec::new());
    let mut geometry = Vec::new();
    let mut ignored = Ignored::default();
    // the checker tells elements that stand twice
    let _ = unread(root, &READ, &mut ignored, &|offset| format!("{file}:{}", lines.place(offset)));
    for node in root.children().filter(Node::is_element) {
        match node.tag_name().name() {
            "link" => {
                checker.link(node);
                links.push(Link::read(node, at(node), collision::read(node, at, &mut geometry)));
            }
            "joint" => {
                checker.joint(node);
                joints.push(Joint::read(node, at(node)));
            }
            _ => {}
        }
    }
    notes.extend(ignored.notes());
    notes.append(&mut geometry);
    if !checker.problems.is_empty() {
        return Err(checker.problems);
    }
    let name = root.attribute("name").unwrap_or_default().to_owned();
    let (file, gravity) = (file.to_owned(), Gravity::Standard);
    Ok(Robot { file, format: "URDF", name, gravity, on_ground: false, links, joints })
}
