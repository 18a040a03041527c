//! What a robot description says of a link and of a joint. Their attributes are checked before
//! (`attributes`): what is missing or no number is reported there, and nothing here.

use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use super::attributes::{is, numbers, pose};
use super::collision::Collision;

/// A link.
pub struct Link {
    /// where it stands: `robot.urdf:3:1`
    pub at: String,
    /// its name as spelled
    pub name: String,
    /// its `<inertial>`, if it has one
    pub inertial: Option<Inertial>,
    /// its solids that strike
    pub collisions: Vec<Collision>,
}

/// The inertia of a link.
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
pub struct Joint {
    /// where it stands
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
    /// in the joint's axes; x where nothing is said
    pub axis: Vector3<f64>,
    /// N m s/rad or N s/m
    pub damping: f64,
    /// N m or N
    pub friction: f64,
    /// the joint that it mimics
    pub mimics: Option<String>,
}

impl Link {
    /// Reads a `<link>`.
    pub fn read(node: Node, at: String, collisions: Vec<Collision>) -> Self {
        let inertial = child(node, "inertial").map(|inertial| {
            let (centre, rpy) = pose(inertial).unwrap_or_default();
            let moment = |name| number(child(inertial, "inertia"), name);
            let [xx, xy, xz, yy, yz, zz] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(moment);
            let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            Inertial { mass: number(child(inertial, "mass"), "value"), centre, rpy, inertia }
        });
        Link { at, name: text(Some(node), "name"), inertial, collisions }
    }
}

impl Joint {
    /// Reads a `<joint>`.
    pub fn read(node: Node, at: String) -> Self {
        let (offset, rpy) = pose(node).unwrap_or_default();
        let dynamics = child(node, "dynamics");
        Joint {
            at,
            name: text(Some(node), "name"),
            kind: text(Some(node), "type"),
            parent: text(child(node, "parent"), "link"),
            child: text(child(node, "child"), "link"),
            offset,
            rpy,
            axis: numbers(child(node, "axis"), "xyz").map_or(Vector3::x(), Vector3::from),
            damping: number(dynamics, "damping"),
            friction: number(dynamics, "friction"),
            mimics: child(node, "mimic").map(|mimic| text(Some(mimic), "joint")),
        }
    }
}

fn child<'n>(node: Node<'n, 'n>, kind: &str) -> Option<Node<'n, 'n>> {
    node.children().find(|part| is(part, kind))
}

fn text(node: Option<Node>, attribute: &str) -> String {
    node.and_then(|node| node.attribute(attribute)).unwrap_or_default().to_owned()
}

/// The number of an attribute, 0 where there is none.
fn number(node: Option<Node>, attribute: &str) -> f64 {
    numbers(node, attribute).map_or(0.0, |[number]| number)
}
