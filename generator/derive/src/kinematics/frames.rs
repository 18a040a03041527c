//! Sets up the axes of all frames, and their angular velocities relative to their parents.

use super::axes::{self, AxesId, AxesTree, Turn};
use super::linear_forms::{self, LinearScalar, LinearVector, Triple};
use super::{DeriveError, Kinematics, MixedLinear};
use crate::algebra::Expr;
use hodograph_model::diagnostics::codes;
use hodograph_model::model::mechanism::{
    Against, Axis, DefinitionValue, EquationSides, FrameId, LoadKind, Mechanism, Orientation, Place, Scalar,
    Vector,
};

/// Which frames' own axes the model's expressions use for anything but their orientation. The angular
/// velocity of frames that nothing uses is kept along the axes of their parents, which spares the rotation.
pub fn used_axes(mechanism: &Mechanism) -> Vec<bool> {
    let mut used = vec![false; mechanism.frames.len()];
    used[0] = true;
    let mut scan = Scan { used: &mut used };
    for definition in &mechanism.definitions {
        match &definition.value {
            DefinitionValue::Scalar(s) => scan.scalar(s),
            DefinitionValue::Vector(v) => scan.vector(v),
        }
    }
    for frame in &mechanism.frames {
        if let Some((_, v)) = &frame.angular_velocity {
            scan.vector(v);
        }
        if let Orientation::Spin(v) = &frame.orientation {
            scan.vector(v);
        }
    }
    for point in &mechanism.points {
        match &point.place {
            Place::Offset { by, .. } | Place::Material { by, .. } | Place::Velocity(by) => scan.vector(by),
            Place::Origin => {}
        }
        point.velocity.iter().for_each(|v| scan.vector(v));
    }
    for load in &mechanism.loads {
        match &load.kind {
            LoadKind::Gravity(v) => scan.vector(v),
            LoadKind::Force { force, .. } => scan.vector(force),
            LoadKind::Torque { torque, .. } => scan.vector(torque),
            LoadKind::Torsion { axis, .. } => scan.vector(axis),
            LoadKind::Spring { .. } => {}
        }
    }
    for equation in mechanism.kinematics.iter().chain(&mechanism.constraints).chain(&mechanism.configuration)
    {
        match &equation.sides {
            EquationSides::Scalar(a, b) => [a, b].into_iter().for_each(|s| scan.scalar(s)),
            EquationSides::Vector(a, b) => [a, b].into_iter().for_each(|v| scan.vector(v)),
        }
    }
    for contact in &mechanism.contacts {
        scan.vector(&contact.normal);
        contact.tangent.iter().for_each(|tangent| scan.vector(tangent));
        if let Against::Velocity(v) = &contact.against {
            scan.vector(v);
        }
        contact
            .gap
            .iter()
            .chain(&contact.validity)
            .chain(&contact.clearance)
            .for_each(|length| scan.scalar(length));
    }
    used
}

struct Scan<'a> {
    used: &'a mut [bool],
}

impl Scan<'_> {
    fn scalar(&mut self, scalar: &Scalar) {
        match scalar {
            Scalar::Rate(a) | Scalar::Neg(a) => self.scalar(a),
            Scalar::Add(parts) | Scalar::Mul(parts) | Scalar::Call(_, parts) => {
                parts.iter().for_each(|p| self.scalar(p));
            }
            Scalar::Div(a, b, _) | Scalar::Pow(a, b) => {
                self.scalar(a);
                self.scalar(b);
            }
            Scalar::Dot(a, b) => {
                self.vector(a);
                self.vector(b);
            }
            Scalar::Norm(a) => self.vector(a),
            _ => {}
        }
    }

    fn vector(&mut self, vector: &Vector) {
        match vector {
            Vector::Components(frame, parts) => {
                self.used[frame.0] = true;
                parts.iter().for_each(|p| self.scalar(p));
            }
            Vector::Neg(a) | Vector::Unit(a, _) => self.vector(a),
            Vector::Add(parts) => parts.iter().for_each(|p| self.vector(p)),
            Vector::Scale(k, v) => {
                self.scalar(k);
                self.vector(v);
            }
            Vector::Cross(a, b) => {
                self.vector(a);
                self.vector(b);
            }
            _ => {}
        }
    }
}

impl Kinematics<'_> {
    /// Builds the axes of all frames.
    pub(super) fn orient(&mut self) -> Result<(), DeriveError> {
        self.frame_axes = vec![None; self.mechanism.frames.len()];
        self.frame_axes[0] = Some(AxesTree::N);
        for id in 0..self.mechanism.frames.len() {
            let place = format!("the orientation of frame `{}`", self.mechanism.frames[id].name);
            self.within(place, |k| k.orient_frame(FrameId(id)))?;
        }
        self.use_axes_of_inertias();
        Ok(())
    }

    /// The axes along which inertias are given are used too, and what a used frame is oriented in. The
    /// inertia of a ball is the same along any axes, so it uses none.
    fn use_axes_of_inertias(&mut self) {
        let mechanism = self.mechanism;
        for body in &mechanism.bodies {
            let Some(inertia) = &body.inertia else { continue };
            let place = format!("body `{}`", body.name);
            let components =
                self.within(place, |k| [0, 1, 2, 3, 4, 5].map(|i| k.scalar(&inertia.components[i])));
            if inertia.about.is_some() || !axes::is_isotropic(&components) {
                self.used_axes[inertia.frame.0] = true;
            }
        }
        for i in 1..mechanism.frames.len() {
            let mut at = FrameId(i);
            while self.used_axes[i]
                && let Some(parent) = mechanism.frames[at.0].parent
            {
                self.used_axes[parent.0] = true;
                at = parent;
            }
        }
    }

    fn orient_frame(&mut self, id: FrameId) -> Result<(), DeriveError> {
        let mechanism = self.mechanism;
        let frame = &mechanism.frames[id.0];
        let Some(parent) = frame.parent else { return Ok(()) };
        if self.frame_axes[id.0].is_some() || matches!(frame.orientation, Orientation::Spin(_)) {
            return Ok(());
        }
        if self.frame_axes[parent.0].is_none() {
            self.orient_frame(parent)?;
        }
        let Some(parent_axes) = self.frame_axes[parent.0] else {
            return Err(DeriveError {
                code: codes::NO_AXES,
                span: frame.span,
                message: format!("frame `{}` is oriented in a frame without axes", frame.name),
                help: "orient it in a frame that is not made by `spin`".into(),
            });
        };
        let axes = match &frame.orientation {
            Orientation::Aligned => parent_axes,
            Orientation::Simple { axis, negative, angle } => {
                let angle = self.scalar(angle);
                let (from, angle) = if self.goes_on(id, *axis) {
                    self.flatten(parent_axes, *axis, *negative, angle)
                } else {
                    (parent_axes, angle)
                };
                let turn = axes::simple(&mut self.z, *axis, *negative, &angle);
                self.turned(from, turn, id)
            }
            Orientation::About { axis, angle } => {
                let axis: Triple = std::array::from_fn(|i| self.scalar(&axis[i]));
                let angle = self.scalar(angle);
                let axis = linear_forms::name(&mut self.z, axis);
                let turn = axes::about(&mut self.z, &axis, &angle);
                self.turned(parent_axes, turn, id)
            }
            Orientation::Euler { axes: sequence, angles, body_fixed } => {
                let mut at = parent_axes;
                for (axis, angle) in in_order(sequence, angles, *body_fixed) {
                    let angle = self.scalar(angle);
                    let turn = axes::simple(&mut self.z, axis, false, &angle);
                    at = self.turned(at, turn, id);
                }
                at
            }
            Orientation::Quaternion(parts) => {
                let parts = parts.map(|part| Expr::symbol(self.coordinates[part.0]));
                let turn = axes::quaternion(&mut self.z, &parts);
                self.turned(parent_axes, turn, id)
            }
            Orientation::Spin(_) => return Ok(()),
        };
        self.frame_axes[id.0] = Some(axes);
        Ok(())
    }

    /// Whether a frame is one of three or more in a row that turn about the same axis. Two have nothing to
    /// save by absolute angles, and a mass matrix that needs the angle between them alone.
    fn goes_on(&self, id: FrameId, axis: Axis) -> bool {
        let frames = &self.mechanism.frames;
        let turns = |frame: FrameId| match &frames[frame.0].orientation {
            Orientation::Simple { axis: about, .. } => *about == axis,
            _ => false,
        };
        let parent = frames[id.0].parent.filter(|&parent| turns(parent));
        let before = parent.and_then(|parent| frames[parent.0].parent).is_some_and(turns);
        before || (0..frames.len()).any(|child| frames[child].parent == Some(id) && turns(FrameId(child)))
    }

    /// Rotations about one axis that keeps its direction in N add up: in a planar chain the axes of every
    /// link are turned against the ground by the sum of the angles, which spares the products of their
    /// sines and cosines. An angle that does not change is left alone: what is fixed in the parent stays
    /// so.
    fn flatten(&mut self, parent: AxesId, axis: Axis, negative: bool, angle: Expr) -> (AxesId, Expr) {
        if self.rate_of(&angle).is_zero() {
            return (parent, angle);
        }
        match (self.tree.turn(parent), self.tree.parent(parent)) {
            (Some(Turn::Simple { axis: before, angle: first, .. }), Some(AxesTree::N))
                if *before == axes::index(axis) && self.tree.owner(parent) != FrameId::N =>
            {
                let first = if negative { first.neg() } else { first.clone() };
                (AxesTree::N, first.add(&angle))
            }
            _ => (parent, angle),
        }
    }

    fn turned(&mut self, parent: AxesId, turn: Turn, owner: FrameId) -> AxesId {
        if is_nothing(&turn) { parent } else { self.tree.push(parent, turn, owner) }
    }

    /// Axes along which the angular velocity of a frame is kept.
    pub(super) fn home_axes(&self, id: FrameId) -> AxesId {
        let mut id = id;
        loop {
            match (self.frame_axes[id.0], self.mechanism.frames[id.0].parent) {
                (Some(axes), Some(_)) if self.used_axes[id.0] => return axes,
                (_, Some(parent)) => id = parent,
                (_, None) => return AxesTree::N,
            }
        }
    }

    /// The angular velocity of a frame in its parent, from its orientation, in the home axes.
    pub(super) fn derived_relative(&mut self, id: FrameId) -> Result<LinearVector, DeriveError> {
        let mechanism = self.mechanism;
        let frame = &mechanism.frames[id.0];
        let Some(parent) = frame.parent else { return Ok(LinearVector::zero()) };
        let Some(parent_axes) = self.frame_axes[parent.0] else { return Ok(LinearVector::zero()) };
        let home = self.home_axes(id);
        let mut sum = MixedLinear::new();
        match &frame.orientation {
            Orientation::Aligned => {}
            Orientation::Simple { axis, negative, angle } => {
                let angle = self.scalar(angle);
                let mut rate = self.rate_of(&angle);
                if *negative {
                    rate = rate.scale(&Expr::integer(-1));
                }
                // The axis is the same in the frame as in its parent.
                let axes = if self.used_axes[id.0] { home } else { parent_axes };
                put(&mut sum, axes, &rate, &axes::unit(axes::index(*axis)));
            }
            Orientation::About { axis, angle } => {
                let axis: Triple = std::array::from_fn(|i| self.scalar(&axis[i]));
                let axis = linear_forms::name(&mut self.z, axis);
                for component in &axis {
                    if !self.rate_of(component).is_zero() {
                        return Err(DeriveError {
                            code: codes::FRAME,
                            span: frame.span,
                            message: format!("the axis of rotation of frame `{}` moves", frame.name),
                            help: "make it of parameters only, or compose the rotation of simple ones".into(),
                        });
                    }
                }
                let angle = self.scalar(angle);
                let rate = self.rate_of(&angle);
                let axes = if self.used_axes[id.0] { home } else { parent_axes };
                put(&mut sum, axes, &rate, &axis);
            }
            Orientation::Euler { axes: sequence, angles, body_fixed } => {
                let Some(own) = self.frame_axes[id.0] else { return Ok(LinearVector::zero()) };
                // The axes on the way, from the frame's own back to the parent's.
                let steps = in_order(sequence, angles, *body_fixed);
                let mut at = own;
                for (axis, angle) in steps.into_iter().rev() {
                    let angle = self.scalar(angle);
                    let rate = self.rate_of(&angle);
                    put(&mut sum, at, &rate, &axes::unit(axes::index(axis)));
                    if !is_nothing(&axes::simple(&mut self.z, axis, false, &angle)) {
                        at = self.tree.parent(at).unwrap_or(AxesTree::N);
                    }
                }
            }
            Orientation::Quaternion(_) => {
                return Err(DeriveError {
                    code: codes::QUATERNION,
                    span: frame.span,
                    message: format!("the angular velocity of frame `{}` must be stated", frame.name),
                    help: format!("write `angular_velocities {{ {} = ..; }}` in terms of speeds", frame.name),
                });
            }
            Orientation::Spin(vector) => {
                let vector = self.linear_vector(vector);
                sum = super::vectors::add_linear(&sum, &vector);
            }
        }
        Ok(self.express_linear(&sum, home))
    }
}

/// A rotation by nothing makes no new axes.
fn is_nothing(turn: &Turn) -> bool {
    matches!(turn, Turn::Simple { sine, cosine, .. } if sine.is_zero() && cosine.is_one())
}

fn put(sum: &mut MixedLinear, axes: AxesId, rate: &LinearScalar, along: &Triple) {
    let part: MixedLinear = [(axes, LinearVector::along(rate, along))].into();
    *sum = super::vectors::add_linear(sum, &part);
}

/// Rotations about the parent's axes are rotations about the new axes in the opposite order.
fn in_order<'a>(axes: &[Axis; 3], angles: &'a [Scalar; 3], body_fixed: bool) -> Vec<(Axis, &'a Scalar)> {
    let mut steps: Vec<_> = axes.iter().copied().zip(angles).collect();
    if !body_fixed {
        steps.reverse();
    }
    steps
}
