//! Writes the text of the model, section by section.

use nalgebra::Vector3;

use super::Options;
use super::collision::{Collision, Solid};
use super::document::Robot;
use super::fixed_links::{Groups, across};
use super::names::{Names, mechanism};
use super::tree::{Joint, Motion, Tree};

/// The sections as they grow.
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

/// What a link is called in the model.
#[derive(Clone)]
struct Called {
    /// its frame
    axes: String,
    /// the point at its origin
    origin: String,
}

struct Writer<'a> {
    tree: &'a Tree,
    groups: &'a Groups,
    names: Names,
    fixed: &'static str,
    out: Sections,
    called: Vec<Called>,
    bodies: Vec<Option<String>>,
}

/// Writes the model.
///
/// # Errors
///
/// Contacts at links that do not exist or do not move.
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
    let name = writer.names.give(&mechanism(&document.name));
    let gravity = writer.parameter("g", "m/s^2", 9.80665, "standard gravity, towards -N.z");
    writer.out.loads.push(format!("gravity: -{gravity}*N.z;"));
    // Coordinates, speeds and inputs first: their names are promised, others give way.
    let motions: Vec<Moves> = tree.links.iter().map(|link| writer.declare(&link.joint)).collect();
    for (link, moves) in motions.iter().enumerate() {
        writer.place(link, moves);
        writer.body(link);
        document.links[link].collisions.iter().for_each(|collision| writer.shape(link, collision));
    }
    let mut problems = Vec::new();
    for contact in &options.contacts {
        writer.contact(contact, &mut problems);
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    notes.append(&mut writer.names.renamed);
    Ok(writer.finish(&name, document))
}

/// The names of what moves at a joint.
#[derive(Default)]
struct Moves {
    coordinates: Vec<String>,
    speeds: Vec<String>,
    inputs: Vec<String>,
}

/// Suffix, unit of the coordinate, unit of the speed, unit of the input.
const TURN: [&str; 3] = ["rad", "rad/s", "N*m"];
const SLIDE: [&str; 3] = ["m", "m/s", "N"];

impl Writer<'_> {
    fn parameter(&mut self, name: &str, unit: &str, value: f64, docs: &str) -> String {
        let name = self.names.give(name);
        let docs = if docs.is_empty() { String::new() } else { format!("/// {docs}\n    ") };
        self.out.parameters.push(format!("{docs}{}{name}: {unit} = {},", self.fixed, decimal(value)));
        name
    }

    /// Declares the coordinates, speeds and inputs of a joint.
    fn declare(&mut self, joint: &Joint) -> Moves {
        let base = joint.name.as_deref().unwrap_or("base");
        let mut moves = Moves::default();
        let list: Vec<(&str, [&str; 3])> = match joint.motion {
            Motion::Fixed => return moves,
            Motion::Turn => vec![("", TURN)],
            Motion::Slide => vec![("", SLIDE)],
            Motion::Planar => vec![("_x", SLIDE), ("_y", SLIDE), ("_r", TURN)],
            Motion::Free => {
                let turn = ["_rx", "_ry", "_rz"].map(|suffix| (suffix, TURN));
                ["_x", "_y", "_z"].map(|suffix| (suffix, SLIDE)).into_iter().chain(turn).collect()
            }
        };
        for (suffix, [position, speed, force]) in list {
            if joint.motion != Motion::Free || position == "m" {
                let name = self.names.give(&format!("q_{base}{suffix}"));
                self.out.coordinates.push(format!("{name}: {position},"));
                moves.coordinates.push(name);
            }
            let name = self.names.give(&format!("u_{base}{suffix}"));
            self.out.speeds.push(format!("{name}: {speed},"));
            moves.speeds.push(name);
            let name = self.names.give(&format!("tau_{base}{suffix}"));
            self.out.inputs.push(format!("{name}: {force} = 0,"));
            moves.inputs.push(name);
        }
        if joint.motion == Motion::Free {
            for (index, suffix) in ["_e0", "_e1", "_e2", "_e3"].into_iter().enumerate() {
                let name = self.names.give(&format!("q_{base}{suffix}"));
                let value = if index == 0 { " = 1" } else { "" };
                self.out.coordinates.push(format!("{name}: 1{value},"));
                moves.coordinates.push(name);
            }
        }
        moves
    }

    /// Frames, points and loads of a link.
    fn place(&mut self, here: usize, moves: &Moves) {
        let link = &self.tree.links[here];
        let joint = &link.joint;
        let parent = match link.parent {
            Some(parent) => self.called[parent].clone(),
            None => Called { axes: "N".to_owned(), origin: "O".to_owned() },
        };
        let carrier = link.parent.map(|parent| self.groups.of_link[parent]);
        let on_ground = carrier.is_none_or(|group| self.groups.groups[group].ground);
        let reaction = if on_ground { None } else { Some(parent.axes.as_str()) };
        let base = joint.name.as_deref().unwrap_or(&link.name);
        // The joint's own axes and origin, fixed in the parent.
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
            Motion::Fixed => Called { axes, origin },
            Motion::Turn => {
                let turned = format!("rotate({}, {})", axis_word(&joint.axis), moves.coordinates[0]);
                let frame = self.frame(&frame_wish, &axes, &turned);
                let torque = self.effort(&moves.inputs[0], &moves.speeds[0], base, joint.damping, TURN);
                let torque = times(&torque, &combination(&joint.axis, &frame));
                let called = Called { axes: frame, origin };
                self.twist(&called, reaction, &torque);
                called
            }
            Motion::Slide => {
                let axis = combination(&joint.axis, &axes);
                let point = self.point(&here_wish, &origin, &times(&moves.coordinates[0], &axis));
                let force = self.effort(&moves.inputs[0], &moves.speeds[0], base, joint.damping, SLIDE);
                let reaction = if on_ground { String::new() } else { format!(" from {origin}") };
                self.out.loads.push(format!("force on {point}{reaction}: {};", times(&force, &axis)));
                Called { axes, origin: point }
            }
            Motion::Planar => self.place_planar(here, moves, &Called { axes, origin }, reaction),
            Motion::Free => self.place_free(here, moves, &Called { axes, origin }, reaction),
        };
        self.called.push(called);
    }

    fn place_planar(
        &mut self,
        here: usize,
        moves: &Moves,
        joint_axes: &Called,
        carrier: Option<&str>,
    ) -> Called {
        let link = &self.tree.links[here];
        let joint = &link.joint;
        let directions = across(&joint.axis).map(|unit| combination(&unit, &joint_axes.axes));
        let turned = format!("rotate({}, {})", axis_word(&joint.axis), moves.coordinates[2]);
        let axes = self.frame(&format!("{}_axes", link.name), &joint_axes.axes, &turned);
        let by = weighted(&moves.coordinates, &directions);
        let origin = self.point(&format!("{}_origin", link.name), &joint_axes.origin, &by);
        let called = Called { axes, origin };
        self.push(&called, joint_axes, carrier, &weighted(&moves.inputs, &directions));
        let torque = times(&moves.inputs[2], &combination(&joint.axis, &called.axes));
        self.twist(&called, carrier, &torque);
        called
    }

    fn place_free(
        &mut self,
        here: usize,
        moves: &Moves,
        joint_axes: &Called,
        carrier: Option<&str>,
    ) -> Called {
        let link = &self.tree.links[here];
        let own = |axes: &str| ["x", "y", "z"].map(|axis| format!("{axes}.{axis}"));
        let quaternion = format!("quaternion({})", moves.coordinates[3..].join(", "));
        let axes = self.frame(&format!("{}_axes", link.name), &joint_axes.axes, &quaternion);
        let by = weighted(&moves.coordinates, &own(&joint_axes.axes));
        let origin = self.point(&format!("{}_origin", link.name), &joint_axes.origin, &by);
        let spin = weighted(&moves.speeds[3..], &own(&axes));
        let within = if joint_axes.axes == "N" { String::new() } else { format!(" in {}", joint_axes.axes) };
        self.out.angular_velocities.push(format!("{axes}{within} = {spin};"));
        // Relative to the ground a free link has its speeds along its own axes; on a link that moves, along
        // that link's.
        let directions = match carrier {
            None => {
                let speed = weighted(&moves.speeds, &own(&axes));
                self.out.velocities.push(format!("{origin} = {speed};"));
                own(&axes)
            }
            Some(_) => own(&joint_axes.axes),
        };
        let called = Called { axes, origin };
        self.push(&called, joint_axes, carrier, &weighted(&moves.inputs, &directions));
        self.twist(&called, carrier, &weighted(&moves.inputs[3..], &own(&called.axes)));
        called
    }

    /// A force at a point that wanders on what carries it: the reaction acts where the point is.
    fn push(&mut self, called: &Called, joint_axes: &Called, carrier: Option<&str>, force: &str) {
        let (point, from) = (&called.origin, &joint_axes.origin);
        match carrier {
            None => self.out.loads.push(format!("force on {point}: {force};")),
            Some(axes) => {
                self.out.loads.push(format!("force on {point} from {from}: {force};"));
                self.out.loads.push(format!("torque on {axes}: -cross(position({point}, {from}), {force});"));
            }
        }
    }

    fn twist(&mut self, called: &Called, carrier: Option<&str>, torque: &str) {
        let reaction = carrier.map_or(String::new(), |axes| format!(" from {axes}"));
        self.out.loads.push(format!("torque on {}{reaction}: {torque};", called.axes));
    }

    /// The body or particle that a group of links is.
    fn body(&mut self, here: usize) {
        let index = self.groups.of_link[here];
        let group = &self.groups.groups[index];
        let Some(properties) = group.properties.as_ref().filter(|_| group.link == here) else { return };
        let link = &self.tree.links[here];
        let Called { axes, origin } = self.called[here].clone();
        let name = self.names.give(&link.name);
        let mut docs = format!("link `{}`", link.name);
        if !group.fixed.is_empty() {
            let fixed: Vec<_> =
                group.fixed.iter().map(|&other| format!("`{}`", self.tree.links[other].name)).collect();
            docs = format!("{docs} with {}", fixed.join(", "));
        }
        let mass =
            self.parameter(&format!("m_{}", link.name), "kg", properties.mass, &format!("mass of {docs}"));
        let centre = match self.offset(["cx", "cy", "cz"], &link.name, &properties.centre, &axes) {
            None => origin,
            Some(offset) => self.point(&format!("{}_centre", link.name), &origin, &offset),
        };
        self.bodies[index] = Some(name.clone());
        let i = &properties.inertia;
        if i.iter().all(|&number| number == 0.0) {
            self.out.particles.push(format!("/// {docs}\n    {name} {{ point: {centre}, mass: {mass} }},"));
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
            "/// {docs}\n    {name} {{ frame: {axes}, centre: {centre}, mass: {mass}, inertia: [{}] }},",
            entries.join(", ")
        ));
    }

    /// The shape that a solid of a link is.
    fn shape(&mut self, here: usize, collision: &Collision) {
        let link = &self.tree.links[here];
        let group = self.groups.of_link[here];
        let Called { axes, origin } = self.called[here].clone();
        let name = self.names.give(&format!("{}_shape", link.name));
        let at = match self.offset(["sx", "sy", "sz"], &name, &collision.offset, &axes) {
            None => origin,
            Some(offset) => format!("{origin} + {offset}"),
        };
        let own = match (collision.solid, rotation(&collision.rpy)) {
            (Solid::Sphere(_), _) | (_, None) => axes.clone(),
            (_, Some(turn)) => self.frame(&format!("{name}_axes"), &axes, &turn),
        };
        let mut length =
            |letter: &str, value: f64| self.parameter(&format!("{letter}_{name}"), "m", value, "");
        let solid = match collision.solid {
            Solid::Sphere(r) => format!("sphere: {}", length("r", r)),
            Solid::Cylinder([r, l]) => {
                format!("cylinder: [{}, {}], axis: {own}.z", length("r", r), length("l", l))
            }
            Solid::Box([a, b, c]) => {
                format!("box: [{}, {}, {}], axes: {own}", length("a", a), length("b", b), length("c", c))
            }
        };
        let group = &self.groups.groups[group];
        let rigid = group.properties.as_ref().is_some_and(|properties| {
            let i = &properties.inertia;
            i.iter().any(|&number| number != 0.0)
        });
        let of = match &self.bodies[self.groups.of_link[here]] {
            _ if group.ground => String::new(),
            Some(body) if rigid => format!("of: {body}, "),
            _ => format!("of: {axes}, "),
        };
        self.out.shapes.push(format!("{name} {{ {of}at: {at}, {solid} }},"));
    }

    fn contact(&mut self, wanted: &str, problems: &mut Vec<String>) {
        let links = &self.tree.links;
        let Some(here) = links.iter().position(|link| link.name == wanted) else {
            let hint = crate::spelling::hint(wanted, links.iter().map(|link| link.name.as_str()));
            problems.push(format!("--contact {wanted}: there is no such link: {hint}"));
            return;
        };
        let group = self.groups.of_link[here];
        if self.groups.groups[group].ground {
            problems
                .push(format!("--contact {wanted}: this link is fixed to the ground and strikes nothing"));
            return;
        }
        let origin = self.called[here].origin.clone();
        let of = match (&self.bodies[group], &self.groups.groups[group].properties) {
            (Some(body), Some(properties)) if properties.inertia.amax() > 0.0 => format!(" of {body}"),
            _ => String::new(),
        };
        let name = self.names.give(&format!("contact_{wanted}"));
        self.out.contacts.push(format!(
            "/// the origin of link `{wanted}` strikes the plane through O across N.z\n    {name} {{ point: {origin}{of}, \
             normal: N.z, gap: dot(position({origin}), N.z) }},"
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

    /// `x_a*A.x + z_a*A.z` with a parameter for each component that is not zero; `None` if all are.
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

    /// The input, less the damping.
    fn effort(&mut self, input: &str, speed: &str, base: &str, damping: f64, units: [&str; 3]) -> String {
        if damping == 0.0 {
            return input.to_owned();
        }
        let unit = if units[0] == "rad" { "N*m*s/rad" } else { "N*s/m" };
        let name = self.parameter(&format!("d_{base}"), unit, damping, &format!("damping of joint `{base}`"));
        format!("({input} - {name}*{speed})")
    }

    fn finish(self, name: &str, document: &Robot) -> String {
        let out = self.out;
        let mut text = format!(
            "//! {}, imported from {}.\n//!\n//! Axes, origins and inertias of links and joints are those of the URDF; gravity acts along -N.z.\n",
            document.name.replace(['\n', '\r'], " "),
            document.file.replace(['\n', '\r'], " ")
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

/// The shortest decimal that reads back exactly.
fn decimal(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// An angle, as a multiple of pi where it is one to 10 digits.
fn angle(number: f64) -> String {
    let twelfths = number / std::f64::consts::PI * 12.0;
    let count = twelfths.round();
    if count == 0.0 || (twelfths - count).abs() > 6e-10 || count.abs() > 24.0 {
        return decimal(number);
    }
    let (sign, count) = (if count < 0.0 { "-" } else { "" }, count.abs() as u32);
    let common = (1..=12).rev().find(|&d| 12 % d == 0 && count % d == 0).unwrap_or(1);
    let top = if count == common { "pi".to_owned() } else { format!("{}*pi", count / common) };
    if common == 12 { format!("{sign}{top}") } else { format!("{sign}{top}/{}", 12 / common) }
}

/// `rotate(..)` or `space(..)` for roll, pitch and yaw; `None` where nothing turns.
fn rotation(rpy: &Vector3<f64>) -> Option<String> {
    let turns: Vec<(&str, f64)> =
        ["x", "y", "z"].into_iter().zip(rpy.iter().copied()).filter(|&(_, angle)| angle != 0.0).collect();
    match turns[..] {
        [] => None,
        [(axis, about)] => Some(format!("rotate({axis}, {})", angle(about))),
        _ => Some(format!("space(xyz, {}, {}, {})", angle(rpy.x), angle(rpy.y), angle(rpy.z))),
    }
}

/// The axis of a rotation as the language writes it.
fn axis_word(axis: &Vector3<f64>) -> String {
    match aligned(axis) {
        Some((sign, letter)) => format!("{sign}{letter}"),
        None => format!("[{}, {}, {}]", decimal(axis.x), decimal(axis.y), decimal(axis.z)),
    }
}

/// A vector given by numbers along the axes of a frame.
fn combination(vector: &Vector3<f64>, axes: &str) -> String {
    match aligned(vector) {
        Some((sign, letter)) => format!("{sign}{axes}.{letter}"),
        None => format!("{axes}.vec({}, {}, {})", decimal(vector.x), decimal(vector.y), decimal(vector.z)),
    }
}

/// Which axis, and which way, if the vector is an axis.
fn aligned(vector: &Vector3<f64>) -> Option<(&'static str, &'static str)> {
    let (index, largest) = vector.iter().copied().enumerate().find(|(_, number)| *number != 0.0)?;
    let alone = vector.iter().filter(|&&number| number != 0.0).count() == 1;
    (alone && largest.abs() == 1.0).then(|| (if largest < 0.0 { "-" } else { "" }, ["x", "y", "z"][index]))
}

/// `factor*vector`, with a sign of the vector moved to the front.
fn times(factor: &str, vector: &str) -> String {
    match vector.strip_prefix('-') {
        Some(vector) => format!("-{factor}*{vector}"),
        None => format!("{factor}*{vector}"),
    }
}

/// `a*v + b*w + ..`
fn weighted(factors: &[String], vectors: &[String]) -> String {
    let terms: Vec<String> =
        factors.iter().zip(vectors).map(|(factor, vector)| times(factor, vector)).collect();
    terms.join(" + ").replace("+ -", "- ")
}
