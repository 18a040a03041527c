//! Reads SDF, the format of Gazebo: one model, whose links and joints state their poses relative to axes of
//! their choice.

mod frames;
mod joints;
mod known;
mod links;
mod placed;

use std::collections::HashMap;

use nalgebra::Vector3;
use roxmltree::Node;

use self::frames::Frames;
use super::chains::Chains;
use super::description::{Gravity, Robot};
use super::lines::Lines;
use super::poses::Pose;
use super::xml::{Ignored, unread};

/// The last version of the format that is known, 1.12.
const LATEST: u32 = 12;

/// Reads a file.
///
/// # Errors
///
/// The mistakes of the file, and the parts that have no counterpart in a model, by name.
pub fn read(
    root: Node,
    file: &str,
    lines: &Lines<'_>,
    notes: &mut Vec<String>,
) -> Result<Robot, Vec<String>> {
    let mut reader = Reader {
        file,
        lines,
        version: LATEST,
        frames: Frames::default(),
        ignored: Ignored::default(),
        problems: Vec::new(),
    };
    reader.read_version(root, notes);
    let is_world = |node: &Node| node.tag_name().name() == "world";
    if let Some(second) = root.children().filter(is_world).nth(1) {
        reader.problems.push(format!("{}: a second <world>: keep one", reader.at(second)));
    }
    let world = root.children().find(is_world);
    let beside = root.children().filter(|node| !is_world(node));
    let mut models = Vec::new();
    let mut gravity = None;
    for node in world.iter().flat_map(Node::children).chain(beside).filter(Node::is_element) {
        match node.tag_name().name() {
            "model" => models.push(node),
            "gravity" => gravity = Some(node),
            "physics" => {
                // until 1.5 gravity is a part of <physics>
                gravity = gravity.or_else(|| child(node, "gravity").filter(|_| reader.version < 6));
                reader.other(node);
            }
            _ => reader.other(node),
        }
    }
    let gravity = match gravity.map(|node| reader.numbers(node)) {
        None => Vector3::new(0.0, 0.0, GRAVITY),
        Some(Ok(numbers)) => Vector3::from(numbers),
        Some(Err(problem)) => {
            reader.problems.push(problem);
            Vector3::zeros()
        }
    };
    let at = reader.at(root);
    let [model] = models[..] else {
        reader.problems.push(format!("{at}: there are {} models: one is imported", models.len()));
        return Err(reader.problems);
    };
    let chains = reader.model(model);
    if !reader.problems.is_empty() {
        return Err(reader.problems);
    }
    notes.extend(reader.ignored.notes());
    let name = model.attribute("name").unwrap_or("robot").to_owned();
    let Chains { links, joints, .. } = chains;
    let gravity = Gravity::Stated(gravity);
    Ok(Robot { file: file.to_owned(), format: "SDF", name, gravity, on_ground: true, links, joints })
}

struct Reader<'a> {
    file: &'a str,
    lines: &'a Lines<'a>,
    /// the version of the format is 1 and this number
    version: u32,
    frames: Frames,
    ignored: Ignored,
    problems: Vec<String>,
}

/// The gravity of a world that states none along z, m/s^2: the default of the format.
const GRAVITY: f64 = -9.8;

/// The name of the axes that do not move.
const WORLD: &str = "world";

impl Reader<'_> {
    fn at(&self, node: Node) -> String {
        format!("{}:{}", self.file, self.lines.place(node.range().start))
    }

    /// Reads the version of the format; one that is missing or unknown is told.
    fn read_version(&mut self, root: Node, notes: &mut Vec<String>) {
        let stated = root.attribute("version");
        let minor = stated.and_then(|version| version.trim().strip_prefix("1.")?.parse().ok());
        match (minor, stated) {
            (Some(minor), _) if minor <= LATEST => self.version = minor,
            (_, stated) => {
                let found = match stated {
                    None => "<sdf> has no `version`".to_owned(),
                    Some(version) => format!("the version `{version}` of SDF is unknown"),
                };
                notes.push(format!("{}: {found}: it is read as 1.{LATEST}", self.at(root)));
            }
        }
    }

    /// Tells of an element that is not read.
    fn other(&mut self, node: Node) {
        let (name, at) = (node.tag_name().name(), self.at(node));
        match name {
            "include" | "model" => self.problems.push(format!(
                "{at}: <{name}> within the model is not followed: put its links and joints in its place"
            )),
            _ => self.ignored.count(format!("<{name}>"), || at),
        }
    }

    fn wrong(&self, node: Node, message: &str) -> String {
        let owner = |node: &Node| matches!(node.tag_name().name(), "link" | "joint" | "frame" | "collision");
        let of = node.ancestors().skip(1).find(owner).map_or(String::new(), |owner| {
            format!(" of {} `{}`", owner.tag_name().name(), owner.attribute("name").unwrap_or_default())
        });
        format!("{}: <{}>{of}: {message}", self.at(node), node.tag_name().name())
    }

    /// The numbers in the text of an element.
    fn numbers<const N: usize>(&self, node: Node) -> Result<[f64; N], String> {
        let text = node.text().unwrap_or_default();
        let read: Option<Vec<f64>> = text
            .split_whitespace()
            .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        let wrong = || self.wrong(node, &format!("`{}` is not {N} finite numbers", text.trim()));
        read.and_then(|list| list.try_into().ok()).ok_or_else(wrong)
    }

    fn number(&self, of: Option<Node>, name: &str, default: f64) -> Result<f64, String> {
        match of.and_then(|of| child(of, name)) {
            Some(node) => self.numbers(node).map(|[number]| number),
            None => Ok(default),
        }
    }

    /// Counts what is not read of the model, and tells what stands twice.
    fn account(&mut self, model: Node) {
        let place = |offset: usize| format!("{}:{}", self.file, self.lines.place(offset));
        let second = unread(model, &known::known(self.version), &mut self.ignored, &place);
        for node in second {
            self.problems.push(self.wrong(node, "a second one: keep one"));
        }
        let within = |node: &Node| matches!(node.tag_name().name(), "include" | "model");
        model.children().filter(within).for_each(|node| self.other(node));
    }

    /// The pose of the model in the world.
    fn place(&self, model: Node) -> Result<Pose, String> {
        let (pose, within) = self.pose(model)?;
        if within.is_some_and(|name| name != WORLD) {
            let advice = "the pose of a model is imported relative to the world only: remove `relative_to`";
            return Err(self.wrong(child(model, "pose").unwrap_or(model), advice));
        }
        // the pose is that of the placement frame, if there is one
        match model.attribute("placement_frame").filter(|name| !name.is_empty()) {
            Some(name) => Ok(pose.then(&self.frames.absolute(name, &self.at(model))?.inverse())),
            None => Ok(pose),
        }
    }

    fn model(&mut self, model: Node) -> Chains {
        let mut chains = Chains::default();
        self.account(model);
        let fixed = |node: &Node| matches!(node.text().map(str::trim), Some("true" | "1"));
        if let Some(node) = child(model, "static").filter(fixed) {
            let problem = "nothing moves: all of a static model is fixed: remove <static> if its joints move";
            self.problems.push(format!("{}: {problem}", self.at(node)));
        }
        let named = |name: &'static str| model.children().filter(move |node| node.tag_name().name() == name);
        let names = |kind: &'static str| named(kind).filter_map(|node| node.attribute("name"));
        chains.names_of_links.add(WORLD);
        names("link").for_each(|name| chains.names_of_links.add(name));
        names("joint").for_each(|name| chains.names_of_joints.add(name));
        let first = names("link").next().unwrap_or_default();
        self.frames.canonical = model.attribute("canonical_link").unwrap_or(first).to_owned();
        let framed = |node: &Node| matches!(node.tag_name().name(), "link" | "joint" | "frame");
        model.children().filter(framed).for_each(|node| self.frame(node));
        let unsettled = self.frames.settle();
        self.problems.extend(unsettled);
        let place = self.place(model).unwrap_or_else(|problem| {
            self.problems.push(problem);
            Pose::identity()
        });
        let ends: Vec<[String; 2]> =
            named("joint").map(|joint| ["parent", "child"].map(|end| self.end(joint, end))).collect();
        // A link that moves with a joint has the axes of the joint; a link without one gets a joint with the
        // world.
        chains.massless(&self.at(model), WORLD);
        let mut axes_of: HashMap<String, String> = HashMap::from([(WORLD.to_owned(), WORLD.to_owned())]);
        for link in named("link") {
            let Some(name) = link.attribute("name").filter(|name| !name.is_empty()) else { continue };
            let name = name.to_owned();
            let carried = named("joint").zip(&ends).find(|(_, ends)| ends[1] == name).map(|(joint, _)| joint);
            let axes = self.link(link, carried, place, &mut chains);
            axes_of.extend(axes.map(|axes| (name, axes)));
        }
        // an end without a name is told already
        let whole = named("joint").zip(ends).filter(|(_, ends)| ends.iter().all(|end| !end.is_empty()));
        for (joint, ends) in whole {
            match self.joint(joint, ends, place) {
                Ok((mut joint, pose)) => {
                    // an unknown name stays; it is reported with the links
                    joint.parent = axes_of.get(&joint.parent).cloned().unwrap_or(joint.parent);
                    chains.joint(joint, &pose);
                }
                Err(problem) => self.problems.push(problem),
            }
        }
        chains
    }

    /// The link that an end of a joint moves with; empty if none is stated, which is told.
    fn end(&mut self, joint: Node, end: &str) -> String {
        let Some(node) = child(joint, end) else {
            let problem = self.wrong_joint(joint, &format!("it has no <{end}>: name its {end} link"));
            self.problems.push(problem);
            return String::new();
        };
        let name = text(node);
        if name.is_empty() {
            let link = node.attribute("link").unwrap_or("..");
            let advice = format!("it names no link: write its name as text, <{end}>{link}</{end}>");
            self.problems.push(self.wrong(node, &advice));
        }
        if (end, name.as_str()) == ("child", WORLD) {
            self.problems
                .push(self.wrong(node, "the world cannot be carried: exchange <parent> and <child>"));
            return String::new();
        }
        self.frames.link_of(&name)
    }

    /// A sentence about a joint.
    fn wrong_joint(&self, joint: Node, message: &str) -> String {
        let name = joint.attribute("name").unwrap_or_default();
        format!("{}: joint `{name}`: {message}", self.at(joint))
    }
}

fn child<'n>(node: Node<'n, 'n>, kind: &str) -> Option<Node<'n, 'n>> {
    node.children().find(|part| part.is_element() && part.tag_name().name() == kind)
}

fn text(node: Node) -> String {
    node.text().unwrap_or_default().trim().to_owned()
}
