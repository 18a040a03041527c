//! The XML document of a robot description: its links and joints, and a report of the elements that are not used.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use super::attributes::{Checker, is};
use super::collision;
use super::description::{Joint, Link};
use super::lines::Lines;

/// A robot description.
pub struct Robot {
    /// the file's name, for messages
    pub file: String,
    /// its own name
    pub name: String,
    /// its links, in the order of the file
    pub links: Vec<Link>,
    /// its joints, in the order of the file
    pub joints: Vec<Joint>,
}

/// Reads the file.
///
/// # Errors
///
/// What is wrong with the XML, or with it as a robot description.
pub fn read(source: &str, file: &str, notes: &mut Vec<String>) -> Result<Robot, Vec<String>> {
    let lines = Lines::of(source);
    few_attributes(source, file, &lines)?;
    let xml = Document::parse(source).map_err(|error| {
        let at = error.pos();
        vec![format!("{file}:{}:{}: this is no XML: {error}", at.row, at.col)]
    })?;
    let at = |node: Node| format!("{file}:{}", lines.place(node.range().start));
    let root = xml.root_element();
    if root.tag_name().name() != "robot" {
        let found = root.tag_name().name();
        return Err(vec![format!("{}: this is no URDF: its root is <{found}>, not <robot>", at(root))]);
    }
    let xacro = |node: &Node| node.tag_name().namespace().is_some_and(|name| name.contains("xacro"));
    if let Some(node) = xml.descendants().find(xacro) {
        return Err(vec![format!(
            "{}: this is xacro, not yet URDF: expand it first (`xacro {file} > robot.urdf`)",
            at(node)
        )]);
    }
    let mut checker = Checker::new(file, &lines);
    let (mut links, mut joints) = (Vec::new(), Vec::new());
    let mut geometry = Vec::new();
    let mut ignored: BTreeMap<String, (usize, String)> = BTreeMap::new();
    let mut ignore = |of: &str, node: Node| {
        let article = if of.is_empty() { "" } else { " of a " };
        let what = format!("<{}>{article}{of}", node.tag_name().name());
        ignored.entry(what).or_insert_with(|| (0, at(node))).0 += 1;
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
    for (what, (count, first)) in ignored {
        notes.push(match count {
            1 => format!("{first}: ignored {what}"),
            _ => format!("{first}: ignored {what}, {count} times"),
        });
    }
    notes.append(&mut geometry);
    if !checker.problems.is_empty() {
        return Err(checker.problems);
    }
    let name = root.attribute("name").unwrap_or_default().to_owned();
    Ok(Robot { file: file.to_owned(), name, links, joints })
}

/// An element has at most so many attributes: the robot description has none with ten, and to compare each
/// with each takes time.
const MOST_ATTRIBUTES: usize = 1000;

/// Refuses elements with very many attributes, before an XML reader compares each with each. The tag of an
/// element ends before the next `<`; that each of its attributes has `=` and a quotation mark counts them.
fn few_attributes(source: &str, file: &str, lines: &Lines<'_>) -> Result<(), Vec<String>> {
    let mut end = 0;
    for tag in source.split_inclusive('<') {
        let begin = end;
        end += tag.len();
        let values = tag.split('=').skip(1).filter(|rest| rest.trim_start().starts_with(['"', '\'']));
        if values.take(MOST_ATTRIBUTES + 1).count() > MOST_ATTRIBUTES {
            let place = lines.place(begin.saturating_sub(1));
            return Err(vec![format!(
                "{file}:{place}: this element has more than {MOST_ATTRIBUTES} attributes: this is no URDF"
            )]);
        }
    }
    Ok(())
}
