//! Writes the text of the model, section by section.

mod solids;

use nalgebra::Vector3;

use super::Options;
use super::description::{Gravity, Robot, long_spring};
use super::fixed_links::{Groups, perpendicular};
use super::formulas::{axis_word, combination, decimal, rotation, times, weighted};
use super::names::{Names, mechanism};
use super::tree::{Joint, Motion, Tree};

/// The sections of the model while they are written.
#[derive(Default)]
struct Sections {
    parameters: Vec<String>,
    inputs: Vec<String>,
    coordinates: Vec<String>,
    speeds: Vec<String>,
    frames: Vec<String>,
    angular_velocities: Vec<String>,
    points: Vec<String>,
    velocities: Vec<String>,
    bodies: Vec<String>,
    particles: Vec<String>,
    shapes: Vec<String>,
    loads: Vec<String>,
    contacts: Vec<String>,
}

/// The frame and the origin of a link in the model.
#[derive(Clone)]
struct LinkFrame {
    /// its frame
    axes: String,
    /// the point at its origin
    origin: String,
}

/// Writes the sections of a model.
pub struct Writer<'a> {
    tree: &'a Tree,
    groups: &'a Groups,
    names: Names,
    fixed: &'static str,
    out: Sections,
    called: Vec<LinkFrame>,
    bodies: Vec<Option<String>>,
}

/// Writes the model.
///
/// # Errors
///
/// Contacts at links that do not exist or are fixed.
pub fn write(
    tree: &Tree,
    groups: &Groups,
    document: &Robot,
    options: &Options,
    notes: &mut Vec<String>,
) -> Result<String, Vec<String>> {
    let fixed = if options.fixed_parameters { "fixed " } else { "" };
    let mut writer = Writer {
        tree,
        groups,
        names: Names::new(),
        fixed,
        out: Sections::default(),
        called: Vec::new(),
        bodies: vec![None; groups.groups.len()],
    };
    writer.gravity(&document.gravity);
    // Coordinates, speeds and inputs first: their names are documented, so that others must give way.
    let mut motions: Vec<JointNames> = tree.links.iter().map(|link| writer.declare(&link.joint)).collect();
    for (here, link) in tree.links.iter().enumerate() {
        if let Some(follows) = &link.joint.mimics {
            let moves_so = |other: &super::tree::Link| other.joint.name.as_ref() == Some(&follows.joint);
            let other = tree.links.iter().position(moves_so).unwrap_or(here);
            motions[here] = writer.follow(&link.joint, &tree.links[other].joint, &motions[other]);
        }
    }
    for (here, moves) in motions.iter().enumerate() {
        writer.place(here, moves);
        writer.body(here);
        let collisions = &document.links[tree.links[here].index].collisions;
        collisions.iter().for_each(|collision| writer.shape(here, collision));
    }
    if writer.out.shapes.len() > 1 {
        notes.push(
            "solids become shapes, but no contacts: state those that may meet under `contacts`, as in \
             `foot_floor { foot_shape on floor_shape }`"
                .to_owned(),
        );
    }
    let mut problems = Vec::new();
    for contact in &options.contacts {
        writer.contact(contact, document, &mut problems);
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    // the name of the mechanism gives way to those of its parts, which are documented
    let name = writer.names.give(&mechanism(&document.name));
    notes.append(&mut writer.names.renamed);
    Ok(writer.finish(&name, document))
}

/// The names of the coordinates, speeds and inputs of a joint.
#[derive(Default)]
pub struct JointNames {
    /// its coordinates
    pub coordinates: Vec<String>,
    /// its speeds
    pub speeds: Vec<String>,
    /// its inputs
    pub inputs: Vec<String>,
}

/// What stands above an entry. Names of links and joints may have any characters, and a comment has one line.
fn comment(text: &str) -> String {
    format!("/// {}", one_line(text))
}

/// A text with blanks for control characters, as line breaks.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// Suffixes of rotations about three axes.
const TURNS: [&str; 3] = ["_rx", "_ry", "_rz"];

/// Suffix, unit of the coordinate, unit of the speed, unit of the input.
const TURN: [&str; 3] = ["rad", "rad/s", "N*m"];
const SLIDE: [&str; 3] = ["m", "m/s", "N"];

impl Writer<'_> {
    pub(super) fn parameter(&mut self, name: &str, unit: &str, value: f64, docs: &str) -> String {
        let name = self.names.give(name);
        let docs = if docs.is_empty() { String::new() } else { format!("{}\n    ", comment(docs)) };
        self.out.parameters.push(format!("{docs}{}{name}: {unit} = {},", self.fixed, decimal(value)));
        name
    }

    fn gravity(&mut self, gravity: &Gravity) {
        let along = |g: Vector3<f64>| (g.x == 0.0 && g.y == 0.0).then_some(-g.z);
        let (down, says) = match *gravity {
            Gravity::Standard => (9.80665, "standard gravity, towards -N.z"),
            Gravity::Stated(g) if g == Vector3::zeros() => return,
            Gravity::Stated(g) => match along(g) {
                Some(down) => (down, "acceleration of gravity, towards -N.z"),
                None => {
                    let parts = ["gx", "gy", "gz"].into_iter().zip(g.iter());
                    let names: Vec<String> = parts
                        .map(|(name, &part)| self.parameter(name, "m/s^2", part, "acceleration of gravity"))
                        .collect();
                    return self.out.loads.push(format!("gravity: N.vec({});", names.join(", ")));
                }
            },
        };
        let name = self.parameter("g", "m/s^2", down, says);
        self.out.loads.push(format!("gravity: -{name}*N.z;"));
    }

    /// The coordinate and speed of a joint that mimics another.
    fn follow(&mut self, joint: &Joint, other: &Joint, moves: &JointNames) -> JointNames {
        let (Some(mimic), Some(base)) = (&joint.mimics, &joint.name) else { return JointNames::default() };
        let unit = |joint: &Joint| if joint.motion == Motion::Turn { TURN } else { SLIDE };
        let [own, its] = [joint, other].map(|joint| unit(joint)[0]);
        let ratio = if own == its { "1".to_owned() } else { format!("{own}/{its}") };
        let docs = format!("joint `{base}` follows `{}` by this factor", mimic.joint);
        let factor = self.parameter(&format!("k_{base}"), &ratio, mimic.multiplier, &docs);
        let mut coordinate = format!("{factor}*{}", moves.coordinates[0]);
        if mimic.offset != 0.0 {
            let docs = format!("joint `{base}` where `{}` is zero", mimic.joint);
            let offset = self.parameter(&format!("q0_{base}"), own, mimic.offset, &docs);
            coordinate = format!("{coordinate} + {offset}");
        }
        let input = self.input(&format!("tau_{base}"), unit(joint)[2]);
        let speeds = vec![format!("{factor}*{}", moves.speeds[0])];
        JointNames { coordinates: vec![coordinate], speeds, inputs: vec![input] }
    }

    pub(super) fn input(&mut self, wish: &str, unit: &str) -> String {
        let name = self.names.give(wish);
        self.out.inputs.push(format!("{name}: {unit} = 0,"));
        name
    }

    /// Declares the coordinates, speeds and inputs of a joint.
    fn declare(&mut self, joint: &Joint) -> JointNames {
        let base = joint.name.as_deref().unwrap_or("base");
        let mut moves = JointNames::default();
        let list: Vec<(&str, [&str; 3])> = match joint.motion {
            _ if joint.mimics.is_some() => return moves,
            Motion::Fixed => return moves,
            Motion::Turn => vec![("", TURN)],
            Motion::Slide => vec![("", SLIDE)],
            Motion::Planar => vec![("_x", SLIDE), ("_y", SLIDE), ("_r", TURN)],
            Motion::Ball => TURNS.map(|suffix| (suffix, TURN)).into(),
            Motion::Free => {
                let turn = TURNS.map(|suffix| (suffix, TURN));
                ["_x", "_y", "_z"].map(|suffix| (suffix, SLIDE)).into_iter().chain(turn).collect()
            }
        };
        let turns_freely = matches!(joint.motion, Motion::Free | Motion::Ball);
        let mut start = joint.start.iter().copied();
        let mut value = |default: f64| match start.next().unwrap_or(default) {
            0.0 => String::new(),
            value => format!(" = {}", decimal(value)),
        };
        for (suffix, [position, speed, force]) in list {
            let own = format!("u_{base}{suffix}");
            let own = if !turns_freely || position == "m" {
                let [name, own] = self.names.give_together([&format!("q_{base}{suffix}"), &own]);
                self.out.coordinates.push(format!("{name}: {position}{},", value(0.0)));
                moves.coordinates.push(name);
                own
            } else {
                self.names.give(&own)
            };
            self.out.speeds.push(format!("{own}: {speed},"));
            moves.speeds.push(own);
            if joint.actuators.is_none() {
                moves.inputs.push(self.input(&format!("tau_{base}{suffix}"), force));
            }
        }
        if turns_freely {
            for (index, suffix) in ["_e0", "_e1", "_e2", "_e3"].into_iter().enumerate() {
                let name = self.names.give(&format!("q_{base}{suffix}"));
                self.out.coordinates.push(format!("{name}: 1{},", value(if index == 0 { 1.0 } else { 0.0 })));
                moves.coordinates.push(name);
            }
        }
        moves
    }

    /// Frames, points and loads of a link.
    fn place(&mut self, here: usize, moves: &JointNames) {
        let link = &self.tree.links[here];
        let joint = &link.joint;
        let parent = match link.parent {
            Some(parent) => self.called[parent].clone(),
            None => LinkFrame { axes: "N".to_owned(), origin: "O".to_owned() },
        };
        let carrier = link.parent.map(|parent| self.groups.of_link[parent]);
        let on_ground = carrier.is_none_or(|group| self.groups.groups[group].ground);
        let reaction = if on_ground { None } else { Some(parent.axes.as_str()) };
        let base = joint.name.as_deref().unwrap_or(&link.name);
        // The axes and the origin of the joint, fixed in the parent.
        let turn = rotation(&joint.rpy);
        let axes = match (&turn, joint.motion) {
            (None, _) => parent.axes.clone(),
            (Some(turn), Motion::Fixed) => self.frame(&format!("{}_axes", link.name), &parent.axes, turn),
            (Some(turn), _) => self.frame(&format!("{base}_base"), &parent.axes, turn),
        };
        let moved = joint.motion != Motion::Fixed && joint.motion != Motion::Turn;
        let here_wish = format!("{}_origin", link.name);
        let wish = if moved { format!("{base}_point") } else { here_wish.clone() };
        let origin = match self.offset(["ox", "oy", "oz"], base, &joint.offset, &parent.axes) {
            None => parent.origin.clone(),
            Some(offset) => self.point(&wish, &parent.origin, &offset),
        };
        let frame_wish = format!("{}_axes", link.name);
        let called = match joint.motion {
            Motion::Fixed => LinkFrame { axes, origin },
            Motion::Turn => {
                let turned = format!("rotate({}, {})", axis_word(&joint.axis), moves.coordinates[0]);
                let frame = self.frame(&frame_wish, &axes, &turned);
                let torque = self.effort(moves, joint, base, TURN);
                let called = LinkFrame { axes: frame, origin };
                if let Some(torque) = torque {
                    let torque = times(&torque, &combination(&joint.axis, &called.axes));
                    self.apply_torque(&called, reaction, &torque);
                }
                if let Some((stiffness, rests)) = self.spring(joint, base, TURN) {
                    let from = reaction.map_or(String::new(), |axes| format!(" from {axes}"));
                    let rest = rests.map_or(String::new(), |rest| format!("rest: {rest}, "));
                    self.out.loads.push(format!(
                        "torsion {}{from} about {}: {{ angle: {}, {rest}stiffness: {stiffness} }};",
                        called.axes,
                        combination(&joint.axis, &called.axes),
                        moves.coordinates[0]
                    ));
                }
                called
            }
            Motion::Slide => {
                let axis = combination(&joint.axis, &axes);
                let point = self.point(&here_wish, &origin, &times(&moves.coordinates[0], &axis));
                let force = self.effort(moves, joint, base, SLIDE);
                let reaction = if on_ground { String::new() } else { format!(" from {origin}") };
                if let Some(force) = force {
                    self.out.loads.push(format!("force on {point}{reaction}: {};", times(&force, &axis)));
                }
                // a long spring along the axis, whose ends do not meet
                if let Some((stiffness, rests)) = self.spring(joint, base, SLIDE) {
                    let docs = format!("length of the spring of joint `{base}` at the coordinate 0");
                    let long = self.parameter(&format!("l_{base}"), "m", long_spring(joint.spring[1]), &docs);
                    let by = times(&long, &axis);
                    let back = by.strip_prefix('-').map_or_else(|| format!("-{by}"), str::to_owned);
                    let end = self.point(&format!("{base}_anchor"), &origin, &back);
                    let length = rests.map_or(long.clone(), |rests| format!("{long} + {rests}"));
                    self.out.loads.push(format!(
                        "spring {point} to {end}: {{ stiffness: {stiffness}, length: {length} }};"
                    ));
                }
                LinkFrame { axes, origin: point }
            }
            Motion::Planar => self.place_planar(here, moves, &LinkFrame { axes, origin }, reaction),
            Motion::Ball => self.place_ball(here, moves, LinkFrame { axes, origin }, reaction),
            Motion::Free => self.place_free(here, moves, &LinkFrame { axes, origin }, reaction),
        };
        self.called.push(called);
    }

    fn place_planar(
        &mut self,
        here: usize,
        moves: &JointNames,
        joint_axes: &LinkFrame,
        carrier: Option<&str>,
    ) -> LinkFrame {
        let link = &self.tree.links[here];
        let joint = &link.joint;
        let directions = perpendicular(&joint.axis).map(|unit| combination(&unit, &joint_axes.axes));
        let turned = format!("rotate({}, {})", axis_word(&joint.axis), moves.coordinates[2]);
        let axes = self.frame(&format!("{}_axes", link.name), &joint_axes.axes, &turned);
        let by = weighted(&moves.coordinates, &directions);
        let origin = self.point(&format!("{}_origin", link.name), &joint_axes.origin, &by);
        let called = LinkFrame { axes, origin };
        self.apply_force(&called, joint_axes, carrier, &weighted(&moves.inputs, &directions));
        let torque = times(&moves.inputs[2], &combination(&joint.axis, &called.axes));
        self.apply_torque(&called, carrier, &torque);
        called
    }

    /// A ball joint: its speeds are the components of the relative angular velocity along the axes of the
    /// child.
    fn place_ball(
        &mut self,
        here: usize,
        moves: &JointNames,
        base: LinkFrame,
        carrier: Option<&str>,
    ) -> LinkFrame {
        let link = &self.tree.links[here];
        let quaternion = format!("quaternion({})", moves.coordinates.join(", "));
        let axes = self.frame(&format!("{}_axes", link.name), &base.axes, &quaternion);
        let own = ["x", "y", "z"].map(|axis| format!("{axes}.{axis}"));
        let within = if base.axes == "N" { String::new() } else { format!(" in {}", base.axes) };
        self.out.angular_velocities.push(format!("{axes}{within} = {};", weighted(&moves.speeds, &own)));
        let called = LinkFrame { axes, origin: base.origin };
        if !moves.inputs.is_empty() {
            self.apply_torque(&called, carrier, &weighted(&moves.inputs, &own));
        }
        called
    }

    fn place_free(
        &mut self,
        here: usize,
        moves: &JointNames,
        joint_axes: &LinkFrame,
        carrier: Option<&str>,
    ) -> LinkFrame {
        let link = &self.tree.links[here];
        let own = |axes: &str| ["x", "y", "z"].map(|axis| format!("{axes}.{axis}"));
        let quaternion = format!("quaternion({})", moves.coordinates[3..].join(", "));
        let axes = self.frame(&format!("{}_axes", link.name), &joint_axes.axes, &quaternion);
        let by = weighted(&moves.coordinates, &own(&joint_axes.axes));
        let origin = self.point(&format!("{}_origin", link.name), &joint_axes.origin, &by);
        let spin = weighted(&moves.speeds[3..], &own(&axes));
        let within = if joint_axes.axes == "N" { String::new() } else { format!(" in {}", joint_axes.axes) };
        self.out.angular_velocities.push(format!("{axes}{within} = {spin};"));
        // The speeds of a link that is free relative to the ground are along its own axes; those of one that
        // is free relative to a moving link are along the axes of that link.
        let directions = match carrier {
            None => {
                let speed = weighted(&moves.speeds, &own(&axes));
                self.out.velocities.push(format!("{origin} = {speed};"));
                own(&axes)
            }
            Some(_) => own(&joint_axes.axes),
        };
        let called = LinkFrame { axes, origin };
        if let [_, _, _, turns @ ..] = &moves.inputs[..] {
            self.apply_force(&called, joint_axes, carrier, &weighted(&moves.inputs[..3], &directions));
            self.apply_torque(&called, carrier, &weighted(turns, &own(&called.axes)));
        }
        called
    }

    /// A force at a point that moves on the carrier; the reaction acts at the same place.
    fn apply_force(
        &mut self,
        called: &LinkFrame,
        joint_axes: &LinkFrame,
        carrier: Option<&str>,
        force: &str,
    ) {
        let (point, from) = (&called.origin, &joint_axes.origin);
        match carrier {
            None => self.out.loads.push(format!("force on {point}: {force};")),
            Some(axes) => {
                self.out.loads.push(format!("force on {point} from {from}: {force};"));
                self.out.loads.push(format!("torque on {axes}: -cross(position({point}, {from}), {force});"));
            }
        }
    }

    fn apply_torque(&mut self, called: &LinkFrame, carrier: Option<&str>, torque: &str) {
        let reaction = carrier.map_or(String::new(), |axes| format!(" from {axes}"));
        self.out.loads.push(format!("torque on {}{reaction}: {torque};", called.axes));
    }

    /// Writes the body or particle of a group of links.
    fn body(&mut self, here: usize) {
        let index = self.groups.of_link[here];
        let group = &self.groups.groups[index];
        let Some(properties) = group.properties.as_ref().filter(|_| group.link == here) else { return };
        let link = &self.tree.links[here];
        let LinkFrame { axes, origin } = self.called[here].clone();
        let name = self.names.give(&link.name);
        let mut docs = format!("link `{}`", link.name);
        if !group.fixed.is_empty() {
            let fixed: Vec<_> =
                group.fixed.iter().map(|&other| format!("`{}`", self.tree.links[other].name)).collect();
            docs = format!("{docs} with {}", fixed.join(", "));
        }
        let above = comment(&docs);
        let mass =
            self.parameter(&format!("m_{}", link.name), "kg", properties.mass, &format!("mass of {docs}"));
        let centre = match self.offset(["cx", "cy", "cz"], &link.name, &properties.centre, &axes) {
            None => origin,
            Some(offset) => self.point(&format!("{}_centre", link.name), &origin, &offset),
        };
        self.bodies[index] = Some(name.clone());
        let i = &properties.inertia;
        if i.iter().all(|&number| number == 0.0) {
            self.out.particles.push(format!("{above}\n    {name} {{ point: {centre}, mass: {mass} }},"));
            return;
        }
        let entries =
            [("Ixx", i.m11), ("Iyy", i.m22), ("Izz", i.m33), ("Ixy", i.m12), ("Iyz", i.m23), ("Izx", i.m31)];
        let count = if entries[3..].iter().all(|&(_, number)| number == 0.0) { 3 } else { 6 };
        let entries: Vec<String> = entries[..count]
            .iter()
            .map(|&(component, number)| match number {
                0.0 => "0".to_owned(),
                _ => self.parameter(&format!("{component}_{}", link.name), "kg*m^2", number, ""),
            })
            .collect();
        self.out.bodies.push(format!(
            "{above}\n    {name} {{ frame: {axes}, centre: {centre}, mass: {mass}, inertia: [{}] }},",
            entries.join(", ")
        ));
    }

    fn frame(&mut self, wish: &str, parent: &str, turn: &str) -> String {
        let name = self.names.give(wish);
        self.out.frames.push(format!("{name} = {parent}.{turn};"));
        name
    }

    fn point(&mut self, wish: &str, from: &str, by: &str) -> String {
        let name = self.names.give(wish);
        let by = by.strip_prefix('-').map_or_else(|| format!("+ {by}"), |rest| format!("- {rest}"));
        self.out.points.push(format!("{name} = {from} {by};"));
        name
    }

    /// `x_a*A.x + z_a*A.z` with a parameter for each nonzero component; `None` if all are zero.
    fn offset(&mut self, letters: [&str; 3], of: &str, by: &Vector3<f64>, axes: &str) -> Option<String> {
        let mut terms = Vec::new();
        for ((letters, axis), &number) in letters.into_iter().zip(["x", "y", "z"]).zip(by.iter()) {
            if number != 0.0 {
                let name = self.parameter(&format!("{letters}_{of}"), "m", number, "");
                terms.push(format!("{name}*{axes}.{axis}"));
            }
        }
        (!terms.is_empty()).then(|| terms.join(" + "))
    }

    fn finish(self, name: &str, document: &Robot) -> String {
        let out = self.out;
        let mut text = format!(
            "//! {}, imported from {}.\n//!\n//! Axes, origins and inertias of links and joints are those of the {}.\n",
            one_line(&document.name),
            one_line(&document.file),
            document.format
        );
        text.push_str(&format!("mechanism {name};\n"));
        for (title, lines) in [
            ("parameters", out.parameters),
            ("inputs", out.inputs),
            ("coordinates", out.coordinates),
            ("speeds", out.speeds),
            ("frames", out.frames),
            ("angular_velocities", out.angular_velocities),
            ("points", out.points),
            ("velocities", out.velocities),
            ("bodies", out.bodies),
            ("particles", out.particles),
            ("shapes", out.shapes),
            ("loads", out.loads),
            ("contacts", out.contacts),
        ] {
            if !lines.is_empty() {
                text.push_str(&format!("\n{title} {{\n    {}\n}}\n", lines.join("\n    ")));
            }
        }
        text
    }
}
