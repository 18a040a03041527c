//! Positions of points, and their velocities while the kinematical equations are being set up.

use super::linear_forms::{self, LinearVector, Triple};
use super::vectors::{add, add_linear, scale};
use super::{Kinematics, Mixed, MixedLinear};
use crate::algebra::Expr;
use hodograph_model::model::mechanism::{FrameId, Place, PointId};

impl Kinematics<'_> {
    /// The chain from a point back to its starting point; the point itself first.
    pub(super) fn way(&self, point: PointId) -> Vec<PointId> {
        let mut way = vec![point];
        let mut at = point;
        while let Place::Offset { from, .. } | Place::Material { from, .. } =
            &self.mechanism.points[at.0].place
        {
            at = *from;
            way.push(at);
        }
        way
    }

    /// Whether the relative position of two points is known.
    pub fn connected(&self, a: PointId, b: PointId) -> bool {
        self.way(a).last() == self.way(b).last()
    }

    /// Position of one point from another.
    pub fn position(&mut self, of: PointId, from: PointId) -> Mixed {
        let mut sum = Mixed::new();
        for (point, sign) in self.steps(of, from) {
            let step = self.step(point);
            sum = add(&sum, &scale(&Expr::integer(sign), &step));
        }
        sum
    }

    /// The same without names for the steps: what two of them share drops out.
    pub fn separation(&mut self, of: PointId, from: PointId) -> Mixed {
        let mut sum = Mixed::new();
        for (point, sign) in self.steps(of, from) {
            let step = self.unnamed_step(point);
            sum = add(&sum, &scale(&Expr::integer(sign), &step));
        }
        let shortened = |k: &mut Self, v: Triple| v.map(|component| k.z.simplify(&component));
        let sum: Mixed = sum.into_iter().map(|(axes, v)| (axes, shortened(self, v))).collect();
        sum.into_iter().filter(|(_, v)| !linear_forms::is_zero(v)).collect()
    }

    /// The points to which the steps lead by which one point lies from another, and their signs.
    fn steps(&self, of: PointId, from: PointId) -> Vec<(PointId, i64)> {
        let (mut ahead, mut behind) = (self.way(of), self.way(from));
        while ahead.len() > 1 && behind.len() > 1 && ahead[ahead.len() - 2] == behind[behind.len() - 2] {
            ahead.pop();
            behind.pop();
        }
        // A common point of both chains need not be next to either end.
        if let Some(i) = ahead.iter().position(|p| behind.contains(p)) {
            let common = ahead[i];
            ahead.truncate(i + 1);
            let j = behind.iter().position(|&p| p == common).unwrap_or(0);
            behind.truncate(j + 1);
        }
        let signed = |way: Vec<PointId>, sign: i64| {
            let steps = way.len() - 1;
            way.into_iter().take(steps).map(move |point| (point, sign))
        };
        signed(ahead, 1).chain(signed(behind, -1)).collect()
    }

    /// The last step to a point.
    pub(super) fn step(&mut self, point: PointId) -> Mixed {
        let step = self.unnamed_step(point);
        step.into_iter().map(|(axes, v)| (axes, linear_forms::name(&mut self.z, v))).collect()
    }

    fn unnamed_step(&mut self, point: PointId) -> Mixed {
        let mechanism = self.mechanism;
        match &mechanism.points[point.0].place {
            Place::Offset { by, .. } | Place::Material { by, .. } => {
                let place = format!("the position of point `{}`", mechanism.points[point.0].name);
                self.within(place, |k| k.vector(by))
            }
            Place::Origin | Place::Velocity(_) => Mixed::new(),
        }
    }

    /// Rate of a vector free of speeds, as a form, by differentiation with angular velocities from
    /// orientations.
    pub(super) fn derived_rate(&mut self, v: &Mixed) -> MixedLinear {
        let mut sum = MixedLinear::new();
        for (&axes, components) in v {
            let mut rate = LinearVector::zero();
            for (i, component) in components.iter().enumerate() {
                let change = self.rate_of(component);
                rate = rate.add(&LinearVector::along(&change, &super::axes::unit(i)));
            }
            let owner = self.tree.owner(axes);
            let turning = self.derived_angular_velocity(owner);
            let turning = self.express_linear(&turning, axes);
            rate = rate.add(&turning.map(|w| linear_forms::cross(w, components)));
            if !rate.is_zero() {
                sum = add_linear(&sum, &[(axes, rate)].into());
            }
        }
        sum
    }

    /// Angular velocity in N from orientations (declared only where there is no other).
    pub(super) fn derived_angular_velocity(&mut self, frame: FrameId) -> MixedLinear {
        let mechanism = self.mechanism;
        let mut sum = MixedLinear::new();
        let mut at = frame;
        while let Some(parent) = mechanism.frames[at.0].parent {
            match self.derived_relative(at) {
                Ok(relative) => {
                    if !relative.is_zero() {
                        let home = self.home_axes(at);
                        sum = add_linear(&sum, &[(home, relative)].into());
                    }
                    at = parent;
                }
                Err(_) => match &mechanism.frames[at.0].angular_velocity {
                    Some((base, declared)) => {
                        let declared = self.linear_vector(declared);
                        sum = add_linear(&sum, &declared);
                        at = *base;
                    }
                    None => at = parent,
                },
            }
        }
        sum
    }

    /// Velocity by differentiation of positions (declared only where there is no position).
    pub(super) fn derived_velocity(&mut self, point: PointId) -> MixedLinear {
        let mechanism = self.mechanism;
        match &mechanism.points[point.0].place {
            Place::Origin => MixedLinear::new(),
            Place::Offset { from, .. } => {
                let step = self.step(point);
                let rate = self.derived_rate(&step);
                add_linear(&self.derived_velocity(*from), &rate)
            }
            Place::Material { frame, from, .. } => {
                let step = self.step(point);
                let turning = self.derived_angular_velocity(*frame);
                let mut sum = self.derived_velocity(*from);
                for (axes, arm) in step {
                    let turning = self.express_linear(&turning, axes);
                    let part = turning.map(|w| linear_forms::cross(w, &arm));
                    if !part.is_zero() {
                        sum = add_linear(&sum, &[(axes, part)].into());
                    }
                }
                sum
            }
            Place::Velocity(declared) => self.linear_vector(declared),
        }
    }
}
