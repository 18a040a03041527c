//! Accelerations of points and frames: differentiates the relations of the graph of velocities, from the
//! ground outwards.
//!
//! Theory: docs/theory.md, section 16.1.

use std::collections::BTreeMap;

use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::AxesId;
use crate::kinematics::linear_forms::{self, LinearVector, Triple};
use crate::kinematics::{Arm, Mixed};
use hodograph_model::model::mechanism::{FrameId, PointId};

/// Accelerations for given derivatives of the speeds.
pub struct Accelerations {
    /// derivative of each speed, dependent ones included
    speeds: Vec<Expr>,
    /// acceleration of the ground: minus gravity, which then acts on every mass
    ground: Mixed,
    /// whether the accelerations of points and frames are left out, which are added elsewhere.
    apart: bool,
    angular: BTreeMap<FrameId, Triple>,
    linear: BTreeMap<PointId, Triple>,
    turning: BTreeMap<FrameId, [Triple; 3]>,
}

impl Accelerations {
    /// Accelerations for these derivatives of all speeds, with everything accelerated by `ground` on top.
    pub fn new(speeds: Vec<Expr>, ground: Mixed) -> Self {
        Accelerations {
            speeds,
            ground,
            apart: false,
            angular: BTreeMap::new(),
            linear: BTreeMap::new(),
            turning: BTreeMap::new(),
        }
    }

    /// What speeds alone add at each relation of the graph: no speed changes, every base is at rest but for
    /// the ground.
    pub fn apart(speeds: usize, ground: Mixed) -> Self {
        Accelerations { apart: true, ..Self::new(vec![Expr::zero(); speeds], ground) }
    }

    /// Acceleration of everything at rest.
    pub fn ground(&self) -> Mixed {
        self.ground.clone()
    }

    /// Derivative in N of the value of a form along `axes`.
    fn derivative(&self, k: &mut Kinematics<'_>, form: &LinearVector, axes: AxesId) -> Triple {
        let mut sum = k.change_of(&form.rest);
        for (&slot, partial) in &form.terms {
            let change = k.change_of(partial);
            sum = linear_forms::add(&sum, &linear_forms::scale(&k.speed(slot), &change));
            sum = linear_forms::add(&sum, &linear_forms::scale(&self.speeds[slot], partial));
        }
        let value = k.vector_value(form);
        let value = linear_forms::name(&mut k.z, value);
        let turning = owner_velocity(k, axes);
        linear_forms::add(&sum, &linear_forms::cross(&turning, &value))
    }

    /// Angular acceleration of a frame in N, in its home axes.
    pub fn angular(&mut self, k: &mut Kinematics<'_>, frame: FrameId) -> Triple {
        let frame = k.turning(frame);
        if frame == FrameId::N || self.apart {
            return linear_forms::zero();
        }
        if let Some(known) = self.angular.get(&frame) {
            return known.clone();
        }
        let motion = k.frames[frame.0].clone();
        let base = k.turning(motion.base);
        let of_base = self.angular(k, base);
        let of_base = k.tree.convert(&mut k.z, &of_base, k.frames[base.0].home, motion.home);
        let own = self.own_angular(k, frame);
        let value = linear_forms::name(&mut k.z, linear_forms::add(&of_base, &own));
        self.angular.insert(frame, value.clone());
        value
    }

    /// What a frame's relation adds to the angular acceleration of its base, in its home axes.
    pub fn own_angular(&self, k: &mut Kinematics<'_>, frame: FrameId) -> Triple {
        let motion = k.frames[frame.0].clone();
        let own = self.derivative(k, &motion.relative, motion.home);
        linear_forms::name(&mut k.z, own)
    }

    /// Acceleration of a point in N (and of the ground), in its home axes.
    pub fn point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Triple {
        if self.apart {
            return linear_forms::zero();
        }
        if let Some(known) = self.linear.get(&point) {
            return known.clone();
        }
        let motion = k.points[point.0].clone();
        let of_base = motion.base.map_or_else(linear_forms::zero, |base| {
            let value = self.point(k, base);
            k.tree.convert(&mut k.z, &value, k.points[base.0].home, motion.home)
        });
        let sum = linear_forms::add(&of_base, &self.own_point(k, point));
        let value = linear_forms::name(&mut k.z, sum);
        self.linear.insert(point, value.clone());
        value
    }

    /// What a point's relation adds to the acceleration of its base (or is, if it has none), in its home
    /// axes.
    pub fn own_point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Triple {
        let motion = k.points[point.0].clone();
        let mut sum = match motion.base {
            Some(_) => linear_forms::zero(),
            None => {
                let ground = self.ground.clone();
                k.express(&ground, motion.home)
            }
        };
        for arm in &motion.arms {
            let part = self.arm(k, arm);
            let part = linear_forms::name(&mut k.z, part);
            sum = linear_forms::add(&sum, &k.tree.convert(&mut k.z, &part, arm.axes, motion.home));
        }
        for (axes, relative) in &motion.relative {
            let part = self.derivative(k, relative, *axes);
            let part = linear_forms::name(&mut k.z, part);
            sum = linear_forms::add(&sum, &k.tree.convert(&mut k.z, &part, *axes, motion.home));
        }
        linear_forms::name(&mut k.z, sum)
    }

    /// Derivative in N of `w x r`, along the arm's axes.
    fn arm(&mut self, k: &mut Kinematics<'_>, arm: &Arm) -> Triple {
        let home = k.frames[arm.frame.0].home;
        let change = k.change_of(&arm.arm);
        let owner = k.turning(k.tree.owner(arm.axes));
        if arm.axes == home && owner == arm.frame && linear_forms::is_zero(&change) {
            let rows = self.turning_matrix(k, arm.frame);
            return std::array::from_fn(|i| linear_forms::dot(&rows[i], &arm.arm));
        }
        let w = k.angular_velocity(arm.frame);
        let w = k.tree.convert(&mut k.z, &w, home, arm.axes);
        let alpha = self.angular(k, arm.frame);
        let alpha = k.tree.convert(&mut k.z, &alpha, home, arm.axes);
        let turning = owner_velocity(k, arm.axes);
        let rate = linear_forms::add(&change, &linear_forms::cross(&turning, &arm.arm));
        let rate = linear_forms::name(&mut k.z, rate);
        linear_forms::add(&linear_forms::cross(&alpha, &arm.arm), &linear_forms::cross(&w, &rate))
    }

    /// Rows of `[alpha]x + w w' - w.w 1`, which turns an arm fixed in the frame into its part of an
    /// acceleration.
    pub fn turning_matrix(&mut self, k: &mut Kinematics<'_>, frame: FrameId) -> [Triple; 3] {
        if let Some(known) = self.turning.get(&frame) {
            return known.clone();
        }
        let w = k.angular_velocity(frame);
        let alpha = self.angular(k, frame);
        let squares: Triple = std::array::from_fn(|i| k.z.name(w[i].mul(&w[i])));
        let products: Triple = std::array::from_fn(|i| k.z.name(w[(i + 1) % 3].mul(&w[(i + 2) % 3])));
        let rows = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let entry = if i == j {
                    squares[(i + 1) % 3].add(&squares[(i + 2) % 3]).neg()
                } else {
                    let other = 3 - i - j;
                    // [alpha]x: entry (0, 1) is -alpha_z, and so on around
                    if (i + 1) % 3 == j {
                        products[other].sub(&alpha[other])
                    } else {
                        products[other].add(&alpha[other])
                    }
                };
                k.z.name(entry)
            })
        });
        self.turning.insert(frame, rows);
        self.turning[&frame].clone()
    }
}

/// Angular velocity of a set of axes, along themselves.
fn owner_velocity(k: &mut Kinematics<'_>, axes: AxesId) -> Triple {
    let owner = k.turning(k.tree.owner(axes));
    let w = k.angular_velocity(owner);
    let home = k.frames[owner.0].home;
    k.tree.convert(&mut k.z, &w, home, axes)
}
