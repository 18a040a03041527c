//! Reads MJCF, the format of MuJoCo: bodies with their joints, geoms and inertias, and actuators of joints.

mod actuators;
mod elements;
mod geoms;
mod option;

use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use self::elements::{Angles, Defaults, Element};
use self::option::Forces;
use super::chains::Chains;
use super::description::{Gravity, Inertial, Joint, Link, Robot};
use super::lines::Lines;
use super::masses;
use super::poses::Pose;
use super::xml::Ignored;

/// Largest depth of nested bodies.
const MAX_DEPTH: usize = 200;

/// Elements without influence on the motion; they are counted as ignored.
const WITHOUT_EFFECT: [&str; 12] = [
    "visual",
    "asset",
    "statistic",
    "size",
    "keyframe",
    "sensor",
    "custom",
    "contact",
    "site",
    "camera",
    "light",
    "plugin",
];

/// Whether the inertia of a body is computed from its geoms.
#[derive(Clone, Copy, PartialEq)]
enum FromGeoms {
    Always,
    Never,
    WhereNoneIsStated,
}

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
        defaults: Defaults::default(),
        angles: Angles { degrees: true, sequence: "xyz".to_owned() },
        from_geoms: FromGeoms::WhereNoneIsStated,
        forces: Forces::all(),
        chains: Chains::default(),
        unnamed: 0,
        ignored: Ignored::default(),
        problems: Vec::new(),
    };
    let sections = |name: &'static str| root.children().filter(move |node| node.tag_name().name() == name);
    for node in sections("default") {
        reader.defaults.read(node, &|node| place(file, lines, node)).map_err(|problem| vec![problem])?;
    }
    sections("compiler").for_each(|node| reader.attempt(node, Reader::compiler));
    sections("option").for_each(|node| reader.options(node));
    reader.names(root);
    let world = reader.at(root);
    let mut link = Link::massless(world, "world".to_owned());
    for node in sections("worldbody") {
        reader.world(node, &mut link);
    }
    reader.chains.links.push(link);
    sections("actuator").for_each(|node| reader.actuators(node));
    for node in root.children().filter(Node::is_element) {
        let name = node.tag_name().name();
        match name {
            "default" | "compiler" | "option" | "worldbody" | "actuator" => {}
            "equality" if !reader.forces.equality() => {
                let at = reader.at(node);
                reader.ignored.count("<equality>, which is switched off".to_owned(), || at);
            }
            "equality" | "tendon" => reader.refuse_parts(node),
            _ => reader.other(node),
        }
    }
    if !reader.problems.is_empty() {
        return Err(reader.problems);
    }
    notes.extend(reader.ignored.notes());
    Ok(Robot {
        file: file.to_owned(),
        format: "MJCF",
        name: root.attribute("model").unwrap_or("robot").to_owned(),
        gravity: Gravity::Stated(reader.forces.gravity()),
        on_ground: true,
        links: reader.chains.links,
        joints: reader.chains.joints,
    })
}

struct Reader<'a> {
    file: &'a str,
    lines: &'a Lines<'a>,
    defaults: Defaults,
    angles: Angles,
    from_geoms: FromGeoms,
    forces: Forces,
    chains: Chains,
    /// number of bodies without a name so far
    unnamed: usize,
    ignored: Ignored,
    problems: Vec<String>,
}

/// The place of an element in its file.
fn place(file: &str, lines: &Lines<'_>, node: Node) -> String {
    format!("{file}:{}", lines.place(node.range().start))
}

/// A body with the parts that are read so far.
struct Body {
    name: String,
    parent: String,
    pose: Pose,
    /// its `childclass`, or that of the body around it
    class: String,
    joints: Vec<Element>,
    geoms: Vec<geoms::Geom>,
    inertial: Option<Inertial>,
}

impl Reader<'_> {
    fn at(&self, node: Node) -> String {
        place(self.file, self.lines, node)
    }

    /// Reads an element; reports its mistakes, and counts attributes that were not read.
    fn attempt(&mut self, node: Node, read: impl FnOnce(&mut Self, &Element) -> Result<(), String>) {
        self.attempt_in(node, "main", read);
    }

    fn attempt_in(
        &mut self,
        node: Node,
        class: &str,
        read: impl FnOnce(&mut Self, &Element) -> Result<(), String>,
    ) {
        let element = self.defaults.element(node, class, self.at(node));
        let done = element.and_then(|element| read(self, &element).map(|()| element));
        match done {
            Ok(element) => {
                for name in element.unknown() {
                    let what = format!("attribute `{name}` of <{}>", element.kind);
                    self.ignored.count(what, || element.at.clone());
                }
            }
            Err(problem) => self.problems.push(problem),
        }
    }

    /// Counts an element without effect, and refuses one that would change the motion.
    fn other(&mut self, node: Node) {
        let name = node.tag_name().name();
        let at = self.at(node);
        match WITHOUT_EFFECT.contains(&name) {
            true => self.ignored.count(format!("<{name}>"), || at),
            false if name == "include" => {
                let file = node.attribute("file").unwrap_or_default();
                self.problems
                    .push(format!("{at}: <include file=\"{file}\"> is not followed: put it in its place"));
            }
            false => self
                .problems
                .push(format!("{at}: <{name}> cannot be imported: remove it, or write out what it makes")),
        }
    }

    /// Refuses all elements of a section, each by name.
    fn refuse_parts(&mut self, section: Node) {
        for node in section.children().filter(Node::is_element) {
            let (at, kind) = (self.at(node), node.tag_name().name());
            let name = node.attribute("name").map_or(String::new(), |name| format!(" `{name}`"));
            let of = section.tag_name().name();
            let advice = match of {
                "equality" => "remove it, and state it as a constraint in the model",
                _ => "remove it, and state its force in the model",
            };
            self.problems.push(format!("{at}: <{of}> <{kind}>{name} cannot be imported: {advice}"));
        }
    }

    fn compiler(&mut self, element: &Element) -> Result<(), String> {
        match element.text("angle") {
            None => {}
            Some("degree") => self.angles.degrees = true,
            Some("radian") => self.angles.degrees = false,
            Some(_) => return Err(element.wrong("`angle` is `degree` or `radian`")),
        }
        if let Some(sequence) = element.text("eulerseq") {
            if sequence.len() != 3 || !sequence.chars().all(|letter| "xyzXYZ".contains(letter)) {
                return Err(element.wrong("`eulerseq` has three letters out of xyz and XYZ"));
            }
            self.angles.sequence = sequence.to_owned();
        }
        match element.text("inertiafromgeom") {
            None => {}
            Some("true") => self.from_geoms = FromGeoms::Always,
            Some("false") => self.from_geoms = FromGeoms::Never,
            Some("auto") => self.from_geoms = FromGeoms::WhereNoneIsStated,
            Some(_) => return Err(element.wrong("`inertiafromgeom` is `true`, `false` or `auto`")),
        }
        for (name, usual) in [
            ("coordinate", "local"),
            ("balanceinertia", "false"),
            ("settotalmass", "-1"),
            ("boundmass", "0"),
            ("boundinertia", "0"),
            ("fitaabb", "false"),
        ] {
            if !element.is_or_lacks(name, usual) {
                return Err(
                    element.wrong(&format!("`{name}` changes masses or places: only `{usual}` is imported"))
                );
            }
        }
        for name in
            ["autolimits", "meshdir", "texturedir", "assetdir", "discardvisual", "strippath", "usethread"]
        {
            let _ = element.text(name);
        }
        Ok(())
    }

    /// The names of bodies and joints, of which those of others keep clear.
    fn names(&mut self, root: Node) {
        self.chains.names_of_links.add("world");
        let parts = root.children().filter(|node| node.tag_name().name() == "worldbody");
        for node in parts.flat_map(|node| node.descendants()) {
            match (node.tag_name().name(), node.attribute("name")) {
                ("body", Some(name)) => self.chains.names_of_links.add(name),
                ("joint" | "freejoint", Some(name)) => self.chains.names_of_joints.add(name),
                _ => {}
            }
        }
    }

    /// Reads an `<option>`.
    fn options(&mut self, node: Node) {
        self.attempt(node, |reader, element| {
            if let Some(gravity) = element.numbers::<3>("gravity")? {
                reader.forces.gravity = Vector3::from(gravity);
            }
            Ok(())
        });
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "flag" => self.attempt(part, |reader, element| reader.forces.read_flags(element)),
                _ => self.other(part),
            }
        }
    }

    fn world(&mut self, node: Node, link: &mut Link) {
        let class = node.attribute("childclass").unwrap_or("main").to_owned();
        let mut body = Body {
            name: "world".to_owned(),
            parent: String::new(),
            pose: Pose::identity(),
            class,
            joints: Vec::new(),
            geoms: Vec::new(),
            inertial: None,
        };
        for part in node.children().filter(Node::is_element) {
            self.part(part, &mut body);
        }
        link.collisions.extend(body.geoms.into_iter().filter_map(|geom| geom.collision));
        for part in node.children().filter(|part| part.tag_name().name() == "body") {
            self.body(part, "world", "main", 1);
        }
    }

    /// Reads an element of a body.
    fn part(&mut self, node: Node, body: &mut Body) {
        let class = body.class.clone();
        match node.tag_name().name() {
            "body" => {}
            "geom" => self.attempt_in(node, &class, |reader, element| {
                body.geoms.push(reader.geom(element, &body.name)?);
                Ok(())
            }),
            "inertial" => self.attempt_in(node, &class, |reader, element| {
                let inertial = reader.inertial(element)?;
                match body.inertial.replace(inertial) {
                    None => Ok(()),
                    Some(_) => {
                        Err(element.wrong(&format!("a second <inertial> of body `{}`: keep one", body.name)))
                    }
                }
            }),
            "joint" | "freejoint" => match self.defaults.element(node, &class, self.at(node)) {
                Ok(element) => body.joints.push(element),
                Err(problem) => self.problems.push(problem),
            },
            _ => self.other(node),
        }
    }

    fn body(&mut self, node: Node, parent: &str, class: &str, depth: usize) {
        let at = self.at(node);
        if depth > MAX_DEPTH {
            return self.problems.push(format!("{at}: bodies are nested more than {MAX_DEPTH} deep"));
        }
        let class = node.attribute("childclass").unwrap_or(class).to_owned();
        let name = match node.attribute("name") {
            Some(name) => name.to_owned(),
            None => {
                self.unnamed += 1;
                self.chains.names_of_links.make_up(&format!("body_{}", self.unnamed))
            }
        };
        let mut read = None;
        self.attempt(node, |reader, element| {
            let _ = element.text("childclass");
            if !element.is_or_lacks("mocap", "false") {
                return Err(element.wrong("a body whose motion is prescribed (`mocap`) cannot be imported"));
            }
            read = Some(reader.angles.pose(element)?);
            Ok(())
        });
        let Some(pose) = read else { return };
        let (joints, geoms) = (Vec::new(), Vec::new());
        let mut body = Body { name, parent: parent.to_owned(), pose, class, joints, geoms, inertial: None };
        for part in node.children().filter(Node::is_element) {
            self.part(part, &mut body);
        }
        let class = body.class.clone();
        let Some(carries) = self.assemble(body, &at) else { return };
        for part in node.children().filter(|part| part.tag_name().name() == "body") {
            self.body(part, &carries, &class, depth + 1);
        }
    }

    /// Forms the links and joints of a body. Returns the name of the link that has its axes.
    fn assemble(&mut self, body: Body, at: &str) -> Option<String> {
        let mut parts = Vec::new();
        let stated = body.inertial.is_some() && self.from_geoms != FromGeoms::Always;
        if !stated && self.from_geoms != FromGeoms::Never {
            for geom in &body.geoms {
                match geom.mass.clone() {
                    Ok(part) => parts.extend(part),
                    Err(problem) => self.problems.push(problem),
                }
            }
        }
        let inertial = if stated { body.inertial.clone() } else { masses::combined(&parts) };
        let collisions = body.geoms.iter().filter_map(|geom| geom.collision).collect();
        let link = Link { inertial, collisions, ..Link::massless(at.to_owned(), body.name.clone()) };
        let mut parent = body.parent.clone();
        // the axes of the body at the next joint, relative to those of the previous joint or of the parent
        let mut pose = body.pose;
        let (count, mut within) = (body.joints.len(), Pose::identity());
        for (number, element) in body.joints.iter().enumerate() {
            let last = number + 1 == count;
            let name = match (element.text("name"), count) {
                (Some(name), _) => name.to_owned(),
                (None, 1) => self.chains.names_of_joints.make_up(&body.name),
                (None, _) => self.chains.names_of_joints.make_up(&format!("{}_{}", body.name, number + 1)),
            };
            let child = match last {
                true => body.name.clone(),
                false => self.chains.names_of_links.make_up(&format!("{}_{name}", body.name)),
            };
            let ends = [parent.clone(), child.clone()];
            let read = self.joint(element, &body, count, Joint::fixed(element.at.clone(), name, ends));
            let (joint, anchor) = match read {
                Ok(read) => read,
                Err(problem) => {
                    self.problems.push(problem);
                    return None;
                }
            };
            for name in element.unknown() {
                self.ignored
                    .count(format!("attribute `{name}` of <{}>", element.kind), || element.at.clone());
            }
            let free = joint.kind == "floating";
            let place = if free { Pose::identity() } else { pose.then(&Pose::place(anchor)) };
            self.chains.joint(joint, &place);
            if !last {
                self.chains.massless(&element.at, &child);
            }
            parent = child;
            within = Pose::place(-anchor);
            pose = within;
        }
        if count == 0 {
            let name = self.chains.names_of_joints.make_up(&format!("{}_weld", body.name));
            self.chains.joint(Joint::fixed(at.to_owned(), name, [parent, body.name.clone()]), &pose);
        }
        Some(self.chains.link(link, &within))
    }

    /// A joint, and its place in the axes of its body.
    fn joint(
        &self,
        element: &Element,
        body: &Body,
        count: usize,
        joint: Joint,
    ) -> Result<(Joint, Vector3<f64>), String> {
        let kind = if element.kind == "freejoint" { "free" } else { element.text("type").unwrap_or("hinge") };
        let anchor = element.numbers::<3>("pos")?.map_or(Vector3::zeros(), Vector3::from);
        let axis = element.numbers::<3>("axis")?.map_or(Vector3::z(), Vector3::from);
        let axis = axis.try_normalize(0.0).ok_or_else(|| element.wrong("its axis has length 0"))?;
        if element.number("ref", 0.0)? != 0.0 {
            return Err(
                element.wrong("`ref` is not 0: let its coordinate be 0 in the configuration of the file")
            );
        }
        let rests_at = element.number("springref", 0.0)?;
        let amount = |name: &str| Ok::<f64, String>(self.forces.of_joint(name, element.amount(name, 0.0)?));
        let about_one = |kind: &str, rests_at: f64| -> Result<Joint, String> {
            Ok(Joint {
                kind: kind.to_owned(),
                axis,
                damping: amount("damping")?,
                friction: amount("frictionloss")?,
                stiffness: amount("stiffness")?,
                spring_rests_at: rests_at,
                actuators: Some(Vec::new()),
                ..joint.clone()
            })
        };
        let joint = match kind {
            "hinge" => about_one("revolute", self.angles.radians(rests_at))?,
            "slide" => about_one("prismatic", rests_at)?,
            "ball" => about_one("ball", 0.0)?,
            "free" if body.parent != "world" || count != 1 => {
                return Err(
                    element.wrong("only a child of the world without other joints can have a free joint")
                );
            }
            "free" => {
                let [w, x, y, z] = body.pose.quaternion();
                let start = body.pose.at.iter().copied().chain([w, x, y, z]).collect();
                return Ok((Joint { start, ..about_one("floating", 0.0)? }, Vector3::zeros()));
            }
            _ => return Err(element.wrong("`type` is `hinge`, `slide`, `ball` or `free`")),
        };
        Ok((joint, anchor))
    }

    fn inertial(&self, element: &Element) -> Result<Inertial, String> {
        let pose = self.angles.pose(element)?;
        let mass = element.numbers::<1>("mass")?.ok_or_else(|| element.wrong("it has no `mass`"))?[0];
        let diagonal =
            element.numbers::<3>("diaginertia")?.map(|d| Matrix3::from_diagonal(&Vector3::from(d)));
        let full = element.numbers::<6>("fullinertia")?;
        if full.is_some() && self.angles.turns(element) {
            return Err(element.wrong(
                "`fullinertia` is along the axes of the body, but an orientation is stated: remove that, or state \
                 `diaginertia`",
            ));
        }
        let full = full.map(|[xx, yy, zz, xy, xz, yz]| Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
        let inertia = match (diagonal, full) {
            (Some(inertia), None) | (None, Some(inertia)) => inertia,
            _ => return Err(element.wrong("state one of `diaginertia` and `fullinertia`")),
        };
        let inertia = pose.turn * inertia * pose.turn.transpose();
        Ok(Inertial { mass, centre: pose.at, rpy: Vector3::zeros(), inertia })
    }
}
