//! Reads the `<collision>` elements of links: boxes, cylinders and spheres. Others are reported.

use nalgebra::Vector3;
use roxmltree::Node;

use super::attributes::{is, numbers, pose};

/// The solids of which a model can build shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// lengths along x, y and z, m
    Box([f64; 3]),
    /// radius and length along z, m
    Cylinder([f64; 2]),
    /// radius and length of its axis along z, m
    Capsule([f64; 2]),
    /// semi-axes along x, y and z, m
    Ellipsoid([f64; 3]),
    /// the plane across z
    Plane,
    /// radius, m
    Sphere(f64),
}

/// A solid with its pose in its link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// the solid
    pub solid: Solid,
    /// its centre, m
    pub offset: Vector3<f64>,
    /// roll, pitch and yaw of its axes, rad
    pub rpy: Vector3<f64>,
}

/// The `<collision>` elements of a link that become shapes. For each of the others a note gives the reason;
/// `at` returns the place of an element in the file.
pub fn read(link: Node, at: impl Fn(Node) -> String, notes: &mut Vec<String>) -> Vec<Collision> {
    let name = link.attribute("name").unwrap_or_default();
    let mut out = Vec::new();
    for element in link.children().filter(|part| is(part, "collision")) {
        match collision(element) {
            Ok(found) => out.push(found),
            Err(why) => notes.push(format!("{}: ignored <collision> of link `{name}`: {why}", at(element))),
        }
    }
    out
}

fn collision(element: Node) -> Result<Collision, String> {
    let geometry = element.children().find(|part| is(part, "geometry")).ok_or("it has no <geometry>")?;
    let shape = only_shape(geometry)?;
    let (offset, rpy) = pose(element)?;
    let length = |name: &str| numbers::<1>(Some(shape), name).and_then(|[length]| positive(name, length));
    let solid = match shape.tag_name().name() {
        "box" => {
            let size: [f64; 3] = numbers(Some(shape), "size")?;
            size.into_iter().try_for_each(|side| positive("size", side).map(|_| ()))?;
            Solid::Box(size)
        }
        "cylinder" => Solid::Cylinder([length("radius")?, length("length")?]),
        "sphere" => Solid::Sphere(length("radius")?),
        "mesh" => {
            return Err("a mesh cannot be a shape of a model; state a box, cylinder or sphere".to_owned());
        }
        other => return Err(format!("<{other}> cannot be a shape of a model")),
    };
    Ok(Collision { solid, offset, rpy })
}

/// The only shape of a `<geometry>`.
///
/// # Errors
///
/// There is none, or there are several.
pub fn only_shape<'n>(geometry: Node<'n, 'n>) -> Result<Node<'n, 'n>, String> {
    let shapes: Vec<_> = geometry.children().filter(Node::is_element).collect();
    match shapes[..] {
        [shape] => Ok(shape),
        [] => Err("its <geometry> is empty".to_owned()),
        _ => Err("its <geometry> has several shapes: keep one".to_owned()),
    }
}

fn positive(name: &str, length: f64) -> Result<f64, String> {
    if length > 0.0 { Ok(length) } else { Err(format!("`{name}` must be positive")) }
}
