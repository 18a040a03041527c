//! Links that hang on joints elsewhere than at their origins.

use super::description::{Joint, Link};
use super::poses::Pose;

/// The links and joints of a description as they grow.
#[derive(Default)]
pub struct Chains {
    /// the links
    pub links: Vec<Link>,
    /// the joints
    pub joints: Vec<Joint>,
}

impl Chains {
    /// A joint whose axes lie so in its parent and carry nothing of their own: the link that moves with it is
    /// `joint.child`.
    pub fn joint(&mut self, joint: Joint, pose: &Pose) {
        self.joints.push(Joint { offset: pose.at, rpy: pose.rpy(), ..joint });
    }

    /// A link without mass at a joint, which something else is part of.
    pub fn massless(&mut self, at: &str, name: &str) {
        let (at, name) = (at.to_owned(), name.to_owned());
        self.links.push(Link { at, name, inertial: None, collisions: Vec::new() });
    }

    /// A link whose origin lies so in the axes of the joint that carries `link.name`. Returns the name of the
    /// link that has its axes: where they are not those of the joint, a link of its own is fixed there.
    pub fn link(&mut self, link: Link, within: &Pose) -> String {
        if within.is_identity() {
            let name = link.name.clone();
            self.links.push(link);
            return name;
        }
        let name = format!("{}_frame", link.name);
        self.massless(&link.at, &link.name);
        let ends = [link.name.clone(), name.clone()];
        self.joint(Joint::fixed(link.at.clone(), name.clone(), ends), within);
        self.links.push(Link { name: name.clone(), ..link });
        name
    }
}
