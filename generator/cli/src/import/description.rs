//! The links and joints of a robot description, independent of its format. Those of URDF are read here;
//! `attributes` has checked their attributes before and reported missing numbers.

use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use super::attributes::{is, numbers, pose};
use super::collision::Collision;
use super::names::Shortened;

/// A description.
pub struct Robot {
    /// the file's name, for messages
    pub file: String,
    /// the name of its format
    pub format: &'static str,
    /// its own name
    pub name: String,
    /// the acceleration of gravity, m/s^2
    pub gravity: Gravity,
    /// whether its root is the ground, so that it never moves
    pub on_ground: bool,
    /// its links, in the order of the file
    pub links: Vec<Link>,
    /// its joints, in the order of the file
    pub joints: Vec<Joint>,
}

impl Robot {
    /// Shortens long names: its own, those of links, joints and actuators, and of the links of `contacts`.
    pub fn shorten(&mut self, contacts: &mut [String], notes: &mut Vec<String>) {
        let links = self.links.iter().map(|link| link.name.as_str());
        let joints = self.joints.iter();
        let actuators = joints.clone().flat_map(|joint| joint.actuators.iter().flatten());
        let others = joints.map(|joint| joint.name.as_str()).chain(actuators.map(|one| one.name.as_str()));
        let mut short = Shortened::of(links.chain(others));
        let mut shorten = |name: &mut String| *name = short.name(name);
        for link in &mut self.links {
            shorten(&mut link.name);
            link.frame.iter_mut().for_each(&mut shorten);
        }
        for joint in &mut self.joints {
            [&mut joint.name, &mut joint.parent, &mut joint.child].into_iter().for_each(&mut shorten);
            joint.mimics.iter_mut().for_each(|mimic| shorten(&mut mimic.joint));
            joint.actuators.iter_mut().flatten().for_each(|actuator| shorten(&mut actuator.name));
        }
        contacts.iter_mut().for_each(&mut shorten);
        shorten(&mut self.name);
        notes.extend(short.notes());
    }
}

/// The acceleration of gravity.
pub enum Gravity {
    /// the standard acceleration along -N.z, since the description does not state one
    Standard,
    /// along N.x, N.y and N.z, m/s^2
    Stated(Vector3<f64>),
}

/// A link.
pub struct Link {
    /// its place in the file: `robot.urdf:3:1`
    pub at: String,
    /// its name as spelled
    pub name: String,
    /// its `<inertial>`, if it has one
    pub inertial: Option<Inertial>,
    /// its solids
    pub collisions: Vec<Collision>,
    /// the link at its own origin, if it has the origin of its joint instead
    pub frame: Option<String>,
}

/// The inertia of a link.
#[derive(Clone, Debug)]
pub struct Inertial {
    /// kg
    pub mass: f64,
    /// mass centre in the axes of the link, m
    pub centre: Vector3<f64>,
    /// roll, pitch and yaw of the axes of the matrix, rad
    pub rpy: Vector3<f64>,
    /// central inertia matrix, kg m^2
    pub inertia: Matrix3<f64>,
}

/// A joint.
#[derive(Clone, Debug)]
pub struct Joint {
    /// its place in the file
    pub at: String,
    /// its name as spelled
    pub name: String,
    /// one of the types that `attributes` knows
    pub kind: String,
    /// the link that carries it
    pub parent: String,
    /// the link that it carries
    pub child: String,
    /// its origin in the parent link, m
    pub offset: Vector3<f64>,
    /// roll, pitch and yaw of its axes in the parent link, rad
    pub rpy: Vector3<f64>,
    /// in the joint's axes
    pub axis: Vector3<f64>,
    /// N m s/rad or N s/m
    pub damping: f64,
    /// N m or N
    pub friction: f64,
    /// N m/rad or N/m
    pub stiffness: f64,
    /// the coordinate at which its spring exerts no force, rad or m
    pub spring_rests_at: f64,
    /// the initial coordinates; empty if all are zero
    pub start: Vec<f64>,
    /// the joint that it mimics
    pub mimics: Option<Mimic>,
    /// its actuators; `None`: the joint has an input of its own, as in formats without actuators
    pub actuators: Option<Vec<Actuator>>,
}

/// A coordinate that follows another: `multiplier` times that, and `offset`.
#[derive(Clone, Debug)]
pub struct Mimic {
    /// the joint that it follows
    pub joint: String,
    /// rad or m of this joint per rad or m of the other
    pub multiplier: f64,
    /// rad or m
    pub offset: f64,
}

/// An actuator of a joint: it exerts the force `gear (gain input + bias[0] + bias[1] gear q + bias[2] gear
/// u)`.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// its name as spelled
    pub name: String,
    /// the force for an input of 1
    pub gain: f64,
    /// a constant force, and the forces per unit of the coordinate and of the speed
    pub bias: [f64; 3],
    /// the factor of its force
    pub gear: f64,
}

impl Joint {
    /// A joint that is fixed; its reader sets the other properties.
    pub fn fixed(at: String, name: String, [parent, child]: [String; 2]) -> Self {
        Joint {
            at,
            name,
            kind: "fixed".to_owned(),
            parent,
            child,
            offset: Vector3::zeros(),
            rpy: Vector3::zeros(),
            axis: Vector3::x(),
            damping: 0.0,
            friction: 0.0,
            stiffness: 0.0,
            spring_rests_at: 0.0,
            start: Vec::new(),
            mimics: None,
            actuators: None,
        }
    }
}

impl Link {
    /// A link without inertia and solids; its reader sets the other properties.
    pub fn massless(at: String, name: String) -> Self {
        Link { at, name, inertial: None, collisions: Vec::new(), frame: None }
    }

    /// Reads a `<link>`.
    pub fn read(node: Node, at: String, collisions: Vec<Collision>) -> Self {
        let inertial = child(node, "inertial").map(|inertial| {
            let (centre, rpy) = pose(inertial).unwrap_or_default();
            let moment = |name| number(child(inertial, "inertia"), name);
            let [xx, xy, xz, yy, yz, zz] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(moment);
            let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            Inertial { mass: number(child(inertial, "mass"), "value"), centre, rpy, inertia }
        });
        Link { inertial, collisions, ..Link::massless(at, text(Some(node), "name")) }
    }
}

impl Joint {
    /// Reads a `<joint>`.
    pub fn read(node: Node, at: String) -> Self {
        let (offset, rpy) = pose(node).unwrap_or_default();
        let dynamics = child(node, "dynamics");
        let ends = ["parent", "child"].map(|end| text(child(node, end), "link"));
        let follow = |mimic: Node| Mimic {
            joint: text(Some(mimic), "joint"),
            multiplier: numbers(Some(mimic), "multiplier").map_or(1.0, |[number]| number),
            offset: number(Some(mimic), "offset"),
        };
        Joint {
            kind: text(Some(node), "type"),
            offset,
            rpy,
            axis: numbers(child(node, "axis"), "xyz").map_or(Vector3::x(), Vector3::from),
            damping: number(dynamics, "damping"),
            friction: number(dynamics, "friction"),
            mimics: child(node, "mimic").map(follow),
            ..Joint::fixed(at, text(Some(node), "name"), ends)
        }
    }
}

fn child<'n>(node: Node<'n, 'n>, kind: &str) -> Option<Node<'n, 'n>> {
    node.children().find(|part| is(part, kind))
}

fn text(node: Option<Node>, attribute: &str) -> String {
    node.and_then(|node| node.attribute(attribute)).unwrap_or_default().to_owned()
}

/// The number of an attribute, 0 by default.
fn number(node: Option<Node>, attribute: &str) -> f64 {
    numbers(node, attribute).map_or(0.0, |[number]| number)
}

/// The length of the spring of a joint that slides, m, which exerts no force at this coordinate: a spring whose
/// ends meet has no direction there, so that it is longer than any joint slides.
pub fn long_spring(rests_at: f64) -> f64 {
    f64::max(100.0, 10.0 * rests_at.abs())
}
