//! Links whose origins differ from those of their joints.

use super::description::{Joint, Link};
use super::names::Stated;
use super::poses::Pose;

/// Collects the links and joints of a description.
#[derive(Default)]
pub struct Chains {
    /// the links
    pub links: Vec<Link>,
    /// the joints
    pub joints: Vec<Joint>,
    /// the names of links in the file
    pub names_of_links: Stated,
    /// the names of joints in the file
    pub names_of_joints: Stated,
}

impl Chains {
    /// Adds a joint with this pose in its parent. The link `joint.child` has the axes and origin of the
    /// joint.
    pub fn joint(&mut self, joint: Joint, pose: &Pose) {
        self.joints.push(Joint { offset: pose.at, rpy: pose.rpy(), ..joint });
    }

    /// Adds a massless link at a joint, to which another link is fixed.
    pub fn massless(&mut self, at: &str, name: &str) {
        self.links.push(Link::massless(at.to_owned(), name.to_owned()));
    }

    /// Adds a link with this pose in the axes of the joint that carries `link.name`. Returns the name of the
    /// link that has its axes: if the pose is not the identity, an additional link that is fixed to the
    /// joint.
    pub fn link(&mut self, link: Link, within: &Pose) -> String {
        if within.is_identity() {
            let name = link.name.clone();
            self.links.push(link);
            return name;
        }
        let wish = format!("{}_frame", link.name);
        let (name, joint) = (self.names_of_links.make_up(&wish), self.names_of_joints.make_up(&wish));
        let frame = Some(name.clone());
        self.links.push(Link { frame, ..Link::massless(link.at.clone(), link.name.clone()) });
        let ends = [link.name.clone(), name.clone()];
        self.joint(Joint::fixed(link.at.clone(), joint, ends), within);
        self.links.push(Link { name: name.clone(), ..link });
        name
    }
}
