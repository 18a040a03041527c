//! Reads SDF, the format of Gazebo: one model, whose links and joints state their poses relative to axes of
//! their choice.

use std::collections::HashMap;

use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use super::chains::Chains;
use super::collision::{Collision, Solid};
use super::description::{Gravity, Inertial, Joint, Link, Robot};
use super::fixed_links::rotation_of;
use super::lines::Lines;
use super::poses::Pose;
use super::xml::Ignored;

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
    let mut reader =
        Reader { file, lines, frames: HashMap::new(), ignored: Ignored::default(), problems: Vec::new() };
    let world = root.children().find(|node| node.tag_name().name() == "world");
    let mut models = Vec::new();
    let mut gravity = Gravity::Stated(Vector3::new(0.0, 0.0, GRAVITY));
    for node in world.unwrap_or(root).children().filter(Node::is_element) {
        match node.tag_name().name() {
            "model" => models.push(node),
            "gravity" => match reader.numbers(node) {
                Ok(numbers) => gravity = Gravity::Stated(Vector3::from(numbers)),
                Err(problem) => reader.problems.push(problem),
            },
            _ => reader.other(node, ""),
        }
    }
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
    Ok(Robot { file: file.to_owned(), format: "SDF", name, gravity, on_ground: true, links, joints })
}

/// A link, joint or frame: its pose, and the name of what the pose is relative to.
struct Frame {
    within: String,
    pose: Pose,
}

struct Reader<'a> {
    file: &'a str,
    lines: &'a Lines<'a>,
    frames: HashMap<String, Frame>,
    ignored: Ignored,
    problems: Vec<String>,
}

/// The gravity of a world that states none along z, m/s^2: the default of the format.
const GRAVITY: f64 = -9.8;

/// The axes of the model itself.
const MODEL: &str = "__model__";

impl Reader<'_> {
    fn at(&self, node: Node) -> String {
        format!("{}:{}", self.file, self.lines.place(node.range().start))
    }

    fn other(&mut self, node: Node, of: &str) {
        let (name, at) = (node.tag_name().name(), self.at(node));
        match name {
            "include" | "model" => self.problems.push(format!(
                "{at}: <{name}> within the model is not followed: put its links and joints in its place"
            )),
            _ => self.ignored.count(format!("<{name}>{of}"), || at),
        }
    }

    fn wrong(&self, node: Node, message: &str) -> String {
        let owner = |node: &Node| matches!(node.tag_name().name(), "link" | "joint" | "frame" | "collision");
        let of = node.ancestors().find(owner).filter(|owner| *owner != node).map_or(String::new(), |owner| {
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

    /// The `<pose>` of an element, and the name of what it is relative to.
    fn pose(&self, of: Node) -> Result<(Pose, Option<String>), String> {
        let Some(node) = child(of, "pose") else { return Ok((Pose::identity(), None)) };
        let within = node.attribute("relative_to").filter(|name| !name.is_empty()).map(str::to_owned);
        if node.attribute("rotation_format").is_some_and(|format| format != "euler_rpy") {
            return Err(self.wrong(node, "only `rotation_format` euler_rpy is imported"));
        }
        let [x, y, z, roll, pitch, yaw] = match node.text().is_none_or(|text| text.trim().is_empty()) {
            true => [0.0; 6],
            false => self.numbers(node)?,
        };
        let mut angles = Vector3::new(roll, pitch, yaw);
        if node.attribute("degrees") == Some("true") {
            angles = angles.map(f64::to_radians);
        }
        Ok((Pose { turn: rotation_of(&angles), at: Vector3::new(x, y, z) }, within))
    }

    /// The pose of a link, joint or frame relative to the model.
    fn absolute(&self, name: &str, at: &str) -> Result<Pose, String> {
        let (mut pose, mut name) = (Pose::identity(), name);
        for _ in 0..=self.frames.len() {
            if name == MODEL {
                return Ok(pose);
            }
            let Some(frame) = self.frames.get(name) else {
                let hint = crate::spelling::hint(name, self.frames.keys().map(String::as_str));
                return Err(format!("{at}: there is no frame, link or joint `{name}`: {hint}"));
            };
            pose = frame.pose.then(&pose);
            name = &frame.within;
        }
        Err(format!("{at}: the pose of `{name}` is defined by itself"))
    }

    fn model(&mut self, model: Node) -> Chains {
        let mut chains = Chains::default();
        let world = "world".to_owned();
        let place = match self.pose(model) {
            Ok((pose, _)) => pose,
            Err(problem) => {
                self.problems.push(problem);
                Pose::identity()
            }
        };
        let fixed = |node: &Node| matches!(node.text().map(str::trim), Some("true" | "1"));
        if let Some(node) = child(model, "static").filter(fixed) {
            let problem = "nothing moves: all of a static model is fixed: remove <static> if its joints move";
            self.problems.push(format!("{}: {problem}", self.at(node)));
        }
        let named = |name: &'static str| model.children().filter(move |node| node.tag_name().name() == name);
        let names = |kind: &'static str| named(kind).filter_map(|node| node.attribute("name"));
        chains.names_of_links.add(&world);
        names("link").for_each(|name| chains.names_of_links.add(name));
        names("joint").for_each(|name| chains.names_of_joints.add(name));
        for node in model.children().filter(Node::is_element) {
            let kind = node.tag_name().name();
            match kind {
                "link" | "joint" | "frame" => self.frame(node),
                "pose" | "static" => {}
                _ => self.other(node, ""),
            }
        }
        let ends = |joint: Node| ["parent", "child"].map(|end| child(joint, end).map_or(String::new(), text));
        // A link that moves with a joint has the axes of the joint; a link without one gets a joint with the
        // world.
        chains.massless(&self.at(model), &world);
        let mut axes_of: HashMap<String, String> = HashMap::from([(world.clone(), world.clone())]);
        for link in named("link") {
            let name = link.attribute("name").unwrap_or_default().to_owned();
            let carried = named("joint").find(|joint| ends(*joint)[1] == name);
            let axes = self.link(link, carried, place, &mut chains);
            axes_of.extend(axes.map(|axes| (name, axes)));
        }
        for joint in named("joint") {
            match self.joint(joint, ends(joint), place) {
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

    /// Records the pose of a link, joint or frame.
    fn frame(&mut self, node: Node) {
        let Some(name) = node.attribute("name") else {
            let problem = format!("{}: this <{}> has no name", self.at(node), node.tag_name().name());
            return self.problems.push(problem);
        };
        let usual = match node.tag_name().name() {
            "joint" => child(node, "child").map(text),
            "frame" => node.attribute("attached_to").map(str::to_owned),
            _ => None,
        };
        match self.pose(node) {
            Ok((pose, within)) => {
                let usual = usual.filter(|name| !name.is_empty());
                let within = within.or(usual).unwrap_or_else(|| MODEL.to_owned());
                if self.frames.insert(name.to_owned(), Frame { within, pose }).is_some() {
                    self.problems.push(format!("{}: a second `{name}`: rename one", self.at(node)));
                }
            }
            Err(problem) => self.problems.push(problem),
        }
    }

    /// Adds a link, and if nothing carries it a joint with the world. Returns the name of the link that has
    /// its axes.
    fn link(
        &mut self,
        node: Node,
        carried: Option<Node>,
        model: Pose,
        chains: &mut Chains,
    ) -> Option<String> {
        let (at, name) = (self.at(node), node.attribute("name")?.to_owned());
        for part in node.children().filter(Node::is_element) {
            if !["pose", "inertial", "collision"].contains(&part.tag_name().name()) {
                self.other(part, " of a link");
            }
        }
        let mut read = || -> Result<(Pose, Option<Inertial>, Option<Pose>), String> {
            let pose = self.absolute(&name, &at)?;
            let joint = carried.and_then(|joint| joint.attribute("name"));
            let joint = joint.map(|joint| self.absolute(joint, &at)).transpose()?;
            Ok((pose, self.inertial(node)?, joint))
        };
        let (pose, inertial, joint) = match read() {
            Ok(read) => read,
            Err(problem) => {
                self.problems.push(problem);
                return None;
            }
        };
        let mut collisions = Vec::new();
        for part in node.children().filter(|part| part.tag_name().name() == "collision") {
            match self.collision(part) {
                Ok(collision) => collisions.extend(collision),
                Err(problem) => self.problems.push(problem),
            }
        }
        let link = Link { inertial, collisions, ..Link::massless(at.clone(), name.clone()) };
        let within = match joint {
            Some(joint) => joint.inverse().then(&pose),
            None => {
                let place = model.then(&pose);
                let start = place.at.iter().copied().chain(place.quaternion()).collect();
                let joint =
                    Joint::fixed(at, chains.names_of_joints.make_up(&name), ["world".to_owned(), name]);
                chains.joint(Joint { kind: "floating".to_owned(), start, ..joint }, &Pose::identity());
                Pose::identity()
            }
        };
        Some(chains.link(link, &within))
    }

    fn inertial(&mut self, link: Node) -> Result<Option<Inertial>, String> {
        let Some(node) = child(link, "inertial") else {
            let what = "the default of SDF for a link without <inertial>, 1 kg and 1 kg m^2".to_owned();
            let at = self.at(link);
            self.ignored.count(what, || at);
            return Ok(None);
        };
        let (pose, within) = self.pose(node)?;
        if within.is_some() {
            return Err(self.wrong(node, "`relative_to` is not imported here"));
        }
        let mass = self.number(Some(node), "mass", 1.0)?;
        let moments = child(node, "inertia");
        let moment = |name: &str, default: f64| self.number(moments, name, default);
        let [xx, yy, zz] = [moment("ixx", 1.0)?, moment("iyy", 1.0)?, moment("izz", 1.0)?];
        let [xy, xz, yz] = [moment("ixy", 0.0)?, moment("ixz", 0.0)?, moment("iyz", 0.0)?];
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let inertia = pose.turn * inertia * pose.turn.transpose();
        Ok(Some(Inertial { mass, centre: pose.at, rpy: Vector3::zeros(), inertia }))
    }

    fn collision(&mut self, node: Node) -> Result<Option<Collision>, String> {
        let (mut pose, within) = self.pose(node)?;
        if within.is_some() {
            return Err(self.wrong(node, "`relative_to` is not imported here"));
        }
        for part in node.children().filter(Node::is_element) {
            if !["pose", "geometry"].contains(&part.tag_name().name()) {
                self.other(part, " of a collision");
            }
        }
        let geometry = child(node, "geometry").and_then(|node| node.children().find(Node::is_element));
        let Some(shape) = geometry else { return Err(self.wrong(node, "it has no <geometry>")) };
        let positive = |name: &str| -> Result<f64, String> {
            let length = self.number(Some(shape), name, f64::NAN)?;
            if length > 0.0 {
                Ok(length)
            } else {
                Err(self.wrong(shape, &format!("give a positive <{name}>")))
            }
        };
        let three = |name: &str| -> Result<[f64; 3], String> {
            let node = child(shape, name).ok_or_else(|| self.wrong(shape, &format!("it has no <{name}>")))?;
            let lengths: [f64; 3] = self.numbers(node)?;
            let fine = lengths.iter().all(|length| *length > 0.0);
            if fine { Ok(lengths) } else { Err(self.wrong(node, "its lengths must be positive")) }
        };
        let solid = match shape.tag_name().name() {
            "box" => Solid::Box(three("size")?),
            "sphere" => Solid::Sphere(positive("radius")?),
            "cylinder" => Solid::Cylinder([positive("radius")?, positive("length")?]),
            "capsule" => Solid::Capsule([positive("radius")?, positive("length")?]),
            "ellipsoid" => Solid::Ellipsoid(three("radii")?),
            "plane" => {
                let normal = child(shape, "normal").map_or(Ok([0.0, 0.0, 1.0]), |node| self.numbers(node))?;
                let turn = super::poses::along_z(Vector3::from(normal));
                let turn = turn.ok_or_else(|| self.wrong(shape, "its normal has length 0"))?;
                pose = pose.then(&Pose { turn, at: Vector3::zeros() });
                Solid::Plane
            }
            other => {
                let what = format!("<collision> of a {other}, which cannot be a shape of a model");
                let at = self.at(shape);
                self.ignored.count(what, || at);
                return Ok(None);
            }
        };
        Ok(Some(Collision { solid, offset: pose.at, rpy: pose.rpy() }))
    }

    /// A joint, and its pose relative to its parent.
    fn joint(&mut self, node: Node, ends: [String; 2], model: Pose) -> Result<(Joint, Pose), String> {
        let at = self.at(node);
        let name = node.attribute("name").unwrap_or_default().to_owned();
        for part in node.children().filter(Node::is_element) {
            if !["pose", "parent", "child", "axis"].contains(&part.tag_name().name()) {
                self.other(part, " of a joint");
            }
        }
        let kind = match node.attribute("type").unwrap_or_default() {
            "revolute" | "continuous" => "revolute",
            kind @ ("prismatic" | "ball" | "fixed") => kind,
            kind => {
                return Err(self.wrong(
                    node,
                    &format!("`{name}` has the type `{kind}`: revolute, continuous, prismatic, ball and fixed are imported"),
                ));
            }
        };
        let here = self.absolute(&name, &at)?;
        let parent = match ends[0].as_str() {
            "world" => model.inverse(),
            parent => self.absolute(parent, &at)?,
        };
        // SDF's axis is z, where none is stated
        let joint = Joint::fixed(at.clone(), name, ends);
        let mut joint = Joint { kind: kind.to_owned(), axis: Vector3::z(), ..joint };
        if let Some(axis) = child(node, "axis") {
            for part in axis.children().filter(Node::is_element) {
                if !["xyz", "dynamics"].contains(&part.tag_name().name()) {
                    self.other(part, " of an axis");
                }
            }
            let direction = child(axis, "xyz");
            let stated = direction.map_or(Ok([0.0, 0.0, 1.0]), |node| self.numbers(node))?;
            let mut along = Vector3::from(stated);
            if let Some(within) = direction.and_then(|node| node.attribute("expressed_in")) {
                along = here.turn.transpose() * (self.absolute(within, &at)?.turn * along);
            }
            let axis_of_zero = || self.wrong(axis, "its direction has length 0");
            joint.axis = along.try_normalize(0.0).ok_or_else(axis_of_zero)?;
            let dynamics = child(axis, "dynamics");
            joint.damping = self.number(dynamics, "damping", 0.0)?;
            joint.friction = self.number(dynamics, "friction", 0.0)?;
            joint.stiffness = self.number(dynamics, "spring_stiffness", 0.0)?;
            joint.spring_rests_at = self.number(dynamics, "spring_reference", 0.0)?;
        }
        Ok((joint, parent.inverse().then(&here)))
    }
}

fn child<'n>(node: Node<'n, 'n>, kind: &str) -> Option<Node<'n, 'n>> {
    node.children().find(|part| part.is_element() && part.tag_name().name() == kind)
}

fn text(node: Node) -> String {
    node.text().unwrap_or_default().trim().to_owned()
}
