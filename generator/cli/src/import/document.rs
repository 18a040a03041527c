//! Reads URDF: links and joints, and a report of unused elements.

use roxmltree::Node;

use super::attributes::{Checker, is};
use super::collision;
use super::description::{Gravity, Joint, Link, Robot};
use super::lines::Lines;
use super::xml::Ignored;

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
    let mut ignore = |of: &str, node: Node| {
        let article = if of.is_empty() { "" } else { " of a " };
        let what = format!("<{}>{article}{of}", node.tag_name().name());
        ignored.count(what, || at(node));
    };
    for node in root.children().filter(Node::is_element) {
        match node.tag_name().name() {
            "link" => {
                checker.link(node);
                let used = |part: &Node| is(part, "inertial") || is(part, "collision");
                node.children()
                    .filter(|part| part.is_element() && !used(part))
                    .for_each(|part| ignore("link", part));
                links.push(Link::read(node, at(node), collision::read(node, at, &mut geometry)));
            }
            "joint" => {
                checker.joint(node);
                let wanted = ["origin", "parent", "child", "axis", "dynamics", "mimic"];
                for part in node.children().filter(Node::is_element) {
                    if !wanted.contains(&part.tag_name().name()) {
                        ignore("joint", part);
                    }
                }
                joints.push(Joint::read(node, at(node)));
            }
            _ => ignore("", node),
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
