//! Joints with their axes.

use nalgebra::Vector3;
use roxmltree::Node;

use super::frames::MODEL;
use super::{Reader, WORLD, child};
use crate::import::description::Joint;
use crate::import::poses::Pose;

impl Reader<'_> {
    /// A joint, and its pose relative to its parent.
    pub(super) fn joint(&self, node: Node, ends: [String; 2], model: Pose) -> Result<(Joint, Pose), String> {
        let at = self.at(node);
        let name = node.attribute("name").unwrap_or_default().to_owned();
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
        let here = self.frames.absolute(&name, &at)?;
        let parent = match ends[0].as_str() {
            WORLD => model.inverse(),
            parent => self.frames.absolute(parent, &at)?,
        };
        // SDF's axis is z, where none is stated
        let joint = Joint::fixed(at.clone(), name, ends);
        let mut joint = Joint { kind: kind.to_owned(), axis: Vector3::z(), ..joint };
        if let Some(axis) = child(node, "axis") {
            let direction = child(axis, "xyz");
            let stated = direction.map_or(Ok([0.0, 0.0, 1.0]), |node| self.numbers(node))?;
            let mut along = Vector3::from(stated);
            if let Some(within) = self.axes_of_axis(axis)? {
                along = here.turn.transpose() * (self.frames.absolute(within, &at)?.turn * along);
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

    /// The name of what the direction of an `<axis>` is along; `None`: the axes of the joint.
    fn axes_of_axis<'n>(&self, axis: Node<'n, 'n>) -> Result<Option<&'n str>, String> {
        let within = child(axis, "xyz").and_then(|node| node.attribute("expressed_in"));
        let of_model = match child(axis, "use_parent_model_frame").filter(|_| (5..7).contains(&self.version))
        {
            None => self.version < 5,
            Some(node) => match node.text().unwrap_or_default().trim() {
                "true" | "1" => true,
                "false" | "0" => false,
                _ => return Err(self.wrong(node, "it is `true` or `false`")),
            },
        };
        Ok(within.filter(|name| !name.is_empty()).or(of_model.then_some(MODEL)))
    }
}
