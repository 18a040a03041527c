//! Links with their inertias and solids.

use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use super::{Reader, WORLD, child};
use crate::import::chains::Chains;
use crate::import::collision::{Collision, Solid, only_shape};
use crate::import::description::{Inertial, Joint, Link};
use crate::import::masses;
use crate::import::poses::{Pose, along_z, rotation_of};

/// A `<collision>`.
struct Stated<'n> {
    /// its element
    node: Node<'n, 'n>,
    /// its solid; `None` for a shape that models do not have
    collision: Option<Collision>,
    /// kg/m^3, if it states one
    density: Option<f64>,
}

/// The density of a link whose file states none, kg/m^3: the default of the format.
const DENSITY: f64 = 1000.0;

impl Reader<'_> {
    /// Adds a link, and if nothing carries it a joint with the world. Returns the name of the link that has
    /// its axes.
    pub(super) fn link(
        &mut self,
        node: Node,
        carried: Option<Node>,
        model: Pose,
        chains: &mut Chains,
    ) -> Option<String> {
        let (at, name) = (self.at(node), node.attribute("name")?.to_owned());
        let before = self.problems.len();
        let mut solids = Vec::new();
        for part in node.children().filter(|part| part.tag_name().name() == "collision") {
            match self.collision(part) {
                Ok(solid) => solids.push(solid),
                Err(problem) => self.problems.push(problem),
            }
        }
        if self.problems.len() > before {
            return None;
        }
        let mut read = || -> Result<(Pose, Option<Inertial>, Option<Pose>), String> {
            let pose = self.frames.absolute(&name, &at)?;
            let joint = carried.and_then(|joint| joint.attribute("name"));
            let joint = joint.map(|joint| self.frames.absolute(joint, &at)).transpose()?;
            Ok((pose, self.inertial(node, &solids)?, joint))
        };
        let (pose, inertial, joint) = match read() {
            Ok(read) => read,
            Err(problem) => {
                self.problems.push(problem);
                return None;
            }
        };
        let collisions = solids.iter().filter_map(|solid| solid.collision).collect();
        let link = Link { inertial, collisions, ..Link::massless(at.clone(), name.clone()) };
        let within = match joint {
            Some(joint) => joint.inverse().then(&pose),
            None => {
                let place = model.then(&pose);
                let start = place.at.iter().copied().chain(place.quaternion()).collect();
                let joint = Joint::fixed(at, chains.names_of_joints.make_up(&name), [WORLD.to_owned(), name]);
                chains.joint(Joint { kind: "floating".to_owned(), start, ..joint }, &Pose::identity());
                Pose::identity()
            }
        };
        Some(chains.link(link, &within))
    }

    /// The inertia of a link with these collisions.
    fn inertial(&mut self, link: Node, solids: &[Stated]) -> Result<Option<Inertial>, String> {
        let Some(node) = child(link, "inertial") else {
            let what = "the default of SDF for a link without <inertial>, 1 kg and 1 kg m^2".to_owned();
            let at = self.at(link);
            self.ignored.count(what, || at);
            return Ok(None);
        };
        match node.attribute("auto") {
            None | Some("false" | "0") => {}
            Some("true" | "1") => return self.of_solids(node, solids).map(Some),
            Some(_) => return Err(self.wrong(node, "`auto` is `true` or `false`")),
        }
        let pose = self.pose_in_link(node)?;
        let mass = self.number(Some(node), "mass", 1.0)?;
        let moments = child(node, "inertia");
        let moment = |name: &str, default: f64| self.number(moments, name, default);
        let [xx, yy, zz] = [moment("ixx", 1.0)?, moment("iyy", 1.0)?, moment("izz", 1.0)?];
        let [xy, xz, yz] = [moment("ixy", 0.0)?, moment("ixz", 0.0)?, moment("iyz", 0.0)?];
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let inertia = pose.turn * inertia * pose.turn.transpose();
        Ok(Some(Inertial { mass, centre: pose.at, rpy: Vector3::zeros(), inertia }))
    }

    /// The inertia of the collisions of a link with their densities.
    fn of_solids(&self, node: Node, solids: &[Stated]) -> Result<Inertial, String> {
        if let Some(part) = ["pose", "mass", "inertia"].iter().find_map(|part| child(node, part)) {
            return Err(
                self.wrong(part, "`auto` computes this from the collisions: remove this element or `auto`")
            );
        }
        let usual = self.density(node)?.unwrap_or(DENSITY);
        let mut parts = Vec::new();
        for Stated { node: stated, collision, density } in solids {
            let Some(Collision { solid, offset, rpy }) = collision else {
                let advice = "the inertia of its shape cannot be computed: state <mass> and <inertia> in place of `auto`";
                return Err(self.wrong(*stated, advice));
            };
            if let Some((volume, moments)) = masses::of_solid(*solid) {
                let pose = Pose { turn: rotation_of(rpy), at: *offset };
                parts.push((density.unwrap_or(usual) * volume, moments, pose));
            }
        }
        let advice = "`auto` computes it from the collisions, but none has a volume: add one, or state <mass> and <inertia>";
        masses::combined(&parts).ok_or_else(|| self.wrong(node, advice))
    }

    /// The `<density>` of an element, kg/m^3.
    fn density(&self, of: Node) -> Result<Option<f64>, String> {
        let Some(node) = child(of, "density") else { return Ok(None) };
        match self.numbers(node)? {
            [density] if density > 0.0 => Ok(Some(density)),
            _ => Err(self.wrong(node, "a density is positive")),
        }
    }

    fn collision<'n>(&mut self, node: Node<'n, 'n>) -> Result<Stated<'n>, String> {
        let mut pose = self.pose_in_link(node)?;
        let density = self.density(node)?;
        let geometry = child(node, "geometry").ok_or_else(|| self.wrong(node, "it has no <geometry>"))?;
        let shape = only_shape(geometry).map_err(|why| self.wrong(node, &why))?;
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
                let turn = along_z(Vector3::from(normal));
                let turn = turn.ok_or_else(|| self.wrong(shape, "its normal has length 0"))?;
                pose = pose.then(&Pose { turn, at: Vector3::zeros() });
                Solid::Plane
            }
            other => {
                let what = format!("<collision> of a {other}, which cannot be a shape of a model");
                let at = self.at(shape);
                self.ignored.count(what, || at);
                return Ok(Stated { node, collision: None, density });
            }
        };
        let collision = Some(Collision { solid, offset: pose.at, rpy: pose.rpy() });
        Ok(Stated { node, collision, density })
    }
}
