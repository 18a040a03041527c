//! The XML document of a robot description: places of its elements, and a report of the elements that are not
//! used.

use std::collections::{BTreeMap, HashMap};

use quick_xml::events::Event;
use roxmltree::{Document, Node};

use super::attributes::{Checker, is};
use super::collision::{self, Collision};
use super::lines::Lines;

/// A robot description with the places of its elements.
pub struct Robot {
    /// the file's name, for messages
    pub file: String,
    /// what it describes
    pub robot: urdf_rs::Robot,
    places: HashMap<(&'static str, usize), Place>,
    collisions: Vec<Vec<Collision>>,
}

struct Place {
    at: String,
    has_inertial: bool,
}

impl Robot {
    /// Where the link stands: `robot.urdf:3:1`.
    pub fn link(&self, index: usize) -> &str {
        self.places.get(&("link", index)).map_or(&self.file, |place| &place.at)
    }

    /// The solids of a link that strike.
    pub fn collisions(&self, link: usize) -> &[Collision] {
        self.collisions.get(link).map_or(&[], Vec::as_slice)
    }

    /// Where the joint stands.
    pub fn joint(&self, index: usize) -> &str {
        self.places.get(&("joint", index)).map_or(&self.file, |place| &place.at)
    }

    /// Whether the link has an `<inertial>`.
    pub fn has_inertial(&self, index: usize) -> bool {
        self.places.get(&("link", index)).is_some_and(|place| place.has_inertial)
    }
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
    let mut places = HashMap::new();
    let mut collisions = Vec::new();
    let mut geometry = Vec::new();
    let (mut links, mut joints) = (0, 0);
    let mut ignored: BTreeMap<String, (usize, String)> = BTreeMap::new();
    // What is not used is not read either: many files have faults there.
    let mut used = source.as_bytes().to_vec();
    let mut ignore = |of: Option<&str>, node: Node| {
        if let Some(of) = of {
            let article = if of.is_empty() { "" } else { " of a " };
            let what = format!("<{}>{article}{of}", node.tag_name().name());
            ignored.entry(what).or_insert_with(|| (0, at(node))).0 += 1;
        }
        used[node.range()].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    };
    for node in root.children().filter(Node::is_element) {
        match node.tag_name().name() {
            "link" => {
                checker.link(node);
                let has_inertial = node.children().any(|part| is(&part, "inertial"));
                for part in node.children().filter(|part| part.is_element() && !is(part, "inertial")) {
                    let read_here = is(&part, "collision");
                    ignore(if read_here { None } else { Some("link") }, part);
                }
                collisions.push(collision::read(node, at, &mut geometry));
                places.insert(("link", links), Place { at: at(node), has_inertial });
                links += 1;
            }
            "joint" => {
                checker.joint(node);
                let wanted = ["origin", "parent", "child", "axis", "dynamics", "mimic"];
                for part in node.children().filter(Node::is_element) {
                    if !wanted.contains(&part.tag_name().name()) {
                        ignore(Some("joint"), part);
                    }
                }
                places.insert(("joint", joints), Place { at: at(node), has_inertial: false });
                joints += 1;
            }
            _ => ignore(Some(""), node),
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
    let robot = urdf_rs::read_from_string(&String::from_utf8_lossy(&used))
        .map_err(|error| vec![format!("{file}: this is no valid URDF: {}", one_line(&error.to_string()))])?;
    if robot.links.len() != links || robot.joints.len() != joints {
        return Err(vec![format!("{file}: some links or joints could not be read")]);
    }
    Ok(Robot { file: file.to_owned(), robot, places, collisions })
}

/// An element has at most so many attributes: the robot description has none with ten, and to compare each
/// with each takes time.
const MOST_ATTRIBUTES: usize = 1000;

/// Refuses elements with very many attributes. What is no XML is left to who reads it.
fn few_attributes(source: &str, file: &str, lines: &Lines<'_>) -> Result<(), Vec<String>> {
    let mut reader = quick_xml::Reader::from_str(source);
    loop {
        let at = reader.buffer_position();
        match reader.read_event() {
            Ok(Event::Start(element) | Event::Empty(element)) => {
                let attributes = element.attributes().with_checks(false).take(MOST_ATTRIBUTES + 1).count();
                if attributes > MOST_ATTRIBUTES {
                    let place = lines.place(usize::try_from(at).unwrap_or(0));
                    return Err(vec![format!(
                        "{file}:{place}: this element has more than {MOST_ATTRIBUTES} attributes: this is no URDF"
                    )]);
                }
            }
            Ok(Event::Eof) | Err(_) => return Ok(()),
            Ok(_) => {}
        }
    }
}

/// A message of another library on one line.
fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
