//! Generalised active and inertia forces, passed along the graph of velocities from the leaves back to the
//! ground.
//!
//! The generalised force F_r is the sum of partial velocities times forces. Instead of forming all partial
//! velocities, each force is passed from its point to the base of that point; its moment acts on the frames
//! of the arms, and its product with the partial velocities of the relation is added to the generalised
//! forces of the speeds in the relation.
//!
//! Theory: docs/theory.md, section 16.1.

use std::collections::BTreeMap;

use super::accelerations::Accelerations;
use super::base_parameters::{Attachment, LumpedInertia, gathered};
use super::elimination_order::{self, Node};
use crate::algebra::{Expr, Intermediates};
use crate::kinematics::axes::{Symmetric, entry};
use crate::kinematics::linear_forms::{self, Triple};
use crate::kinematics::vectors;
use crate::kinematics::{Kinematics, Mixed};
use hodograph_model::model::mechanism::{FrameId, LoadKind, PointId};

/// Forces and torques, gathered on points and frames.
#[derive(Clone, Default)]
pub struct Wrenches {
    /// forces on points, along their home axes
    pub forces: BTreeMap<PointId, Triple>,
    /// torques on frames that turn, along their home axes
    pub torques: BTreeMap<FrameId, Triple>,
    /// what acts on a speed directly
    pub generalised: BTreeMap<usize, Expr>,
}

impl Wrenches {
    /// Adds a force on a point.
    pub fn force(&mut self, k: &mut Kinematics<'_>, on: PointId, force: &Mixed) {
        let home = k.points[on.0].home;
        let force = k.express(force, home);
        let sum = self.forces.get(&on).map_or_else(|| force.clone(), |have| linear_forms::add(have, &force));
        self.forces.insert(on, sum);
    }

    /// Adds a torque on a frame.
    pub fn torque(&mut self, k: &mut Kinematics<'_>, on: FrameId, torque: &Mixed) {
        let on = k.turning(on);
        if on == FrameId::N {
            return;
        }
        let home = k.frames[on.0].home;
        let torque = k.express(torque, home);
        let sum =
            self.torques.get(&on).map_or_else(|| torque.clone(), |have| linear_forms::add(have, &torque));
        self.torques.insert(on, sum);
    }
}

impl Wrenches {
    /// A torque on a frame and its opposite on another: it meets the speeds of the frames between them, and
    /// no others.
    fn torque_between(&mut self, k: &mut Kinematics<'_>, on: FrameId, from: FrameId, torque: &Mixed) {
        let (ahead, behind) = (k.ancestry(on), k.ancestry(from));
        let between = |chain: &[FrameId], other: &[FrameId]| -> Vec<FrameId> {
            chain.iter().copied().filter(|frame| !other.contains(frame)).collect()
        };
        for (frames, sign) in [(between(&ahead, &behind), 1), (between(&behind, &ahead), -1)] {
            for frame in frames {
                let motion = k.frames[frame.0].clone();
                if motion.relative.terms.is_empty() {
                    continue;
                }
                let along = k.express(torque, motion.home);
                for (&slot, a) in &motion.relative.terms {
                    let work = linear_forms::dot(a, &along).mul(&Expr::integer(sign));
                    let sum =
                        self.generalised.get(&slot).map_or_else(|| work.clone(), |have| have.add(&work));
                    self.generalised.insert(slot, sum);
                }
            }
        }
    }
}

/// The acceleration of gravity.
pub fn gravity(k: &mut Kinematics<'_>) -> Mixed {
    let mut sum = Mixed::new();
    for load in &k.mechanism.loads {
        if let LoadKind::Gravity(g) = &load.kind {
            let g = k.vector(g);
            sum = vectors::add(&sum, &g);
        }
    }
    sum.into_iter().map(|(axes, v)| (axes, linear_forms::name(&mut k.z, v))).collect()
}

/// The acceleration of the ground that acts as gravity does.
pub fn ground(k: &mut Kinematics<'_>) -> Mixed {
    let gravity = gravity(k);
    vectors::scale(&Expr::integer(-1), &gravity)
}

/// Forces and torques, active and inertia together, for given accelerations.
pub fn wrenches(
    k: &mut Kinematics<'_>,
    inertias: &BTreeMap<Attachment, LumpedInertia>,
    accelerations: &mut Accelerations,
) -> Wrenches {
    let mut wrenches = Wrenches::default();
    for (&(frame, point), lumped) in inertias {
        let home = k.frames[frame.0].home;
        // acceleration of the reference point, along the home axes of the frame
        let at_rest = accelerations.ground();
        let a = match point {
            Some(point) => vectors::mixed(k.points[point.0].home, accelerations.point(k, point)),
            None => at_rest,
        };
        if frame == FrameId::N {
            if let Some(point) = point {
                wrenches.force(k, point, &vectors::scale(&lumped.mass.neg(), &a));
            }
            continue;
        }
        let rows = accelerations.turning_matrix(k, frame);
        if let Some(point) = point {
            let turning: Triple = std::array::from_fn(|i| linear_forms::dot(&rows[i], &lumped.moment));
            let turning = linear_forms::name(&mut k.z, linear_forms::scale(&Expr::integer(-1), &turning));
            wrenches.force(k, point, &vectors::mixed(home, turning));
            wrenches.force(k, point, &vectors::scale(&lumped.mass.neg(), &a));
        }
        let a =
            if linear_forms::is_zero(&lumped.moment) { linear_forms::zero() } else { k.express(&a, home) };
        let alpha = accelerations.angular(k, frame);
        let w = k.angular_velocity(frame);
        let moment = inertia_moment(&mut k.z, &rows, &alpha, &w, &lumped.second);
        let moment = linear_forms::add(&moment, &linear_forms::cross(&lumped.moment, &a));
        let moment = linear_forms::name(&mut k.z, linear_forms::scale(&Expr::integer(-1), &moment));
        wrenches.torque(k, frame, &vectors::mixed(home, moment));
    }
    k.within("a load".to_string(), |k| apply_loads(k, &mut wrenches));
    wrenches
}

/// Generalised forces of all speeds (dependent ones included), active and inertia forces together, for given
/// derivatives of all speeds.
pub fn generalised_forces(
    k: &mut Kinematics<'_>,
    inertias: &BTreeMap<Attachment, LumpedInertia>,
    derivatives: Vec<Expr>,
) -> Vec<Expr> {
    let ground = ground(k);
    let wrenches = wrenches(k, inertias, &mut Accelerations::new(derivatives, ground));
    pass_back(k, wrenches)
}

/// Moment of inertia forces about the reference point: integral of `r x U r` for second moments Sigma of r,
/// with `U = [alpha]x + w w' - w.w 1`.
fn inertia_moment(
    z: &mut Intermediates,
    u: &[Triple; 3],
    alpha: &Triple,
    w: &Triple,
    second: &Symmetric,
) -> Triple {
    std::array::from_fn(|i| {
        let (j, l) = ((i + 1) % 3, (i + 2) % 3);
        let (jj, ll) = (&second[j], &second[l]);
        // U_lj S_jj - U_jl S_ll, with U_lj = w_j w_l + alpha_i and U_jl = w_j w_l - alpha_i
        let diagonal = if jj.is_zero() || ll.is_zero() {
            u[l][j].mul(jj).sub(&u[j][l].mul(ll))
        } else {
            let (difference, sum) = (gathered(z, &jj.sub(ll)), gathered(z, &jj.add(ll)));
            let product = z.name(w[j].mul(&w[l]));
            product.mul(&difference).add(&alpha[i].mul(&sum))
        };
        let mixed = u[l][l].sub(&u[j][j]).mul(&second[entry(j, l)]);
        diagonal.add(&mixed).add(&u[l][i].mul(&second[entry(i, j)])).sub(&u[j][i].mul(&second[entry(i, l)]))
    })
}

fn apply_loads(k: &mut Kinematics<'_>, wrenches: &mut Wrenches) {
    let minus = Expr::integer(-1);
    for load in &k.mechanism.loads {
        match &load.kind {
            LoadKind::Gravity(_) => {}
            LoadKind::Force { on, from, force } => {
                let force = k.vector(force);
                wrenches.force(k, *on, &force);
                if let Some(from) = from {
                    wrenches.force(k, *from, &vectors::scale(&minus, &force));
                }
            }
            LoadKind::Torque { on, from, torque } => {
                let torque = k.vector(torque);
                match from {
                    Some(from) => wrenches.torque_between(k, *on, *from, &torque),
                    None => wrenches.torque(k, *on, &torque),
                }
            }
            LoadKind::Spring { a, b, stiffness, length, damping } => {
                let r = k.position(*a, *b);
                let distance = k.norm(&r);
                k.guard(&distance, "the ends of a spring coincide");
                let along = vectors::scale(&distance.pow(-1), &r);
                let along: Mixed =
                    along.into_iter().map(|(axes, v)| (axes, linear_forms::name(&mut k.z, v))).collect();
                let (stiffness, length, damping) = (k.scalar(stiffness), k.scalar(length), k.scalar(damping));
                let mut tension = stiffness.mul(&distance.sub(&length));
                if !damping.is_zero() {
                    let (axes_a, v_a) = k.velocity_value(*a);
                    let (axes_b, v_b) = k.velocity_value(*b);
                    let v_b = vectors::scale(&minus, &vectors::mixed(axes_b, v_b));
                    let v = vectors::add(&vectors::mixed(axes_a, v_a), &v_b);
                    let rate = k.dot(&v, &along);
                    tension = tension.add(&damping.mul(&rate));
                }
                let tension = k.z.name(tension);
                wrenches.force(k, *a, &vectors::scale(&tension.neg(), &along));
                wrenches.force(k, *b, &vectors::scale(&tension, &along));
            }
            LoadKind::Torsion { on, from, axis, angle, rest, stiffness, damping, .. } => {
                let axis = k.vector(axis);
                let (angle, rest) = (k.scalar(angle), k.scalar(rest));
                let (stiffness, damping) = (k.scalar(stiffness), k.scalar(damping));
                let mut moment = stiffness.mul(&angle.sub(&rest));
                if !damping.is_zero() {
                    let rate = k.change(&angle);
                    moment = moment.add(&damping.mul(&rate));
                }
                let moment = k.z.name(moment);
                let torque = vectors::scale(&moment.neg(), &axis);
                match from {
                    Some(from) => wrenches.torque_between(k, *on, *from, &torque),
                    None => wrenches.torque(k, *on, &torque),
                }
            }
        }
    }
}

/// Passes forces and torques back to the ground; what each speed meets on the way is its generalised force.
fn pass_back(k: &mut Kinematics<'_>, mut wrenches: Wrenches) -> Vec<Expr> {
    let mut result = vec![Expr::zero(); k.speeds.len()];
    for (&slot, force) in &wrenches.generalised {
        result[slot] = force.clone();
    }
    let points: Vec<_> = wrenches.forces.keys().copied().collect();
    let frames: Vec<_> = wrenches.torques.keys().copied().collect();
    for node in elimination_order::elimination_order(k, &points, &frames) {
        match node {
            Node::Frame(frame) => {
                let Some(torque) = wrenches.torques.remove(&frame) else { continue };
                let motion = k.frames[frame.0].clone();
                let torque = linear_forms::name(&mut k.z, torque);
                for (&slot, a) in &motion.relative.terms {
                    result[slot] = result[slot].add(&linear_forms::dot(a, &torque));
                }
                wrenches.torque(k, motion.base, &vectors::mixed(motion.home, torque));
            }
            Node::Point(point) => {
                let Some(force) = wrenches.forces.remove(&point) else { continue };
                let motion = k.points[point.0].clone();
                let force = linear_forms::name(&mut k.z, force);
                let along = vectors::mixed(motion.home, force.clone());
                for arm in &motion.arms {
                    let home = k.frames[arm.frame.0].home;
                    let r = k.tree.convert(&mut k.z, &arm.arm, arm.axes, home);
                    let force = k.express(&along, home);
                    let moment = linear_forms::cross(&r, &force);
                    wrenches.torque(k, arm.frame, &vectors::mixed(home, moment));
                }
                for (axes, relative) in &motion.relative {
                    for (&slot, b) in &relative.terms {
                        let b = k.tree.convert(&mut k.z, b, *axes, motion.home);
                        result[slot] = result[slot].add(&linear_forms::dot(&b, &force));
                    }
                }
                if let Some(base) = motion.base {
                    wrenches.force(k, base, &along);
                }
            }
        }
    }
    result.into_iter().map(|force| k.z.name(force)).collect()
}
