//! The articulated body algorithm (ABA) on the graph of velocities: factorises the mass matrix without
//! forming it, in time linear in the number of bodies.
//!
//! By Gauss's principle the accelerations minimise `1/2 sum m |a|^2 + .. - forces . accelerations`. The
//! relations of the graph are inserted into that form from the leaves to the ground, as into the kinetic
//! energy for the mass matrix, but each `u'` is eliminated (minimised over) as soon as no relation further in
//! contains it; what remains of its subtree is an articulated inertia ([`Articulated::new`]). Forces passed
//! inwards in the same way leave at each `u'` a load ([`Articulated::inwards`]). The loads are the half-solve
//! with the factorised mass matrix: `f' M^-1 g` is the sum of load times load over articulated inertia. An
//! outward pass gives the `u'` one after the other ([`Articulated::outwards`]).
//!
//! For long chains this takes fewer operations than factorising the mass matrix. For short chains it takes
//! more, but keeps more digits: each pivot is computed as a sum of inertias and not as a small difference of
//! composite inertias.
//!
//! Theory: docs/theory.md, section 16.2.

mod acting;
mod eliminated;
mod form;
mod relation;

use std::collections::BTreeMap;

use super::accelerations::Accelerations;
use super::base_parameters::{Attachment, LumpedInertia};
use super::elimination_order::{self, Node};
use super::forces::Wrenches;
use crate::algebra::Expr;
use crate::kinematics::linear_forms::{self, Triple};
use crate::kinematics::{Kinematics, vectors};
use acting::Acting;
use eliminated::Eliminated;
use form::{Form, OfFrame, OfPoint};
use hodograph_model::model::mechanism::{FrameId, PointId};

/// A factorised mechanism (the articulated-body algorithm, ABA): what is done to velocities and derivatives
/// of speeds, from the leaves to the ground.
pub struct Articulated {
    steps: Vec<Step>,
}

/// The `u'` of a relation taken out of it, one eliminated, or what is left of the relation inserted.
enum Step {
    Split(Node),
    Frame(FrameId, Box<OfFrame>),
    Point(PointId, Box<OfPoint>),
    Eliminated(Box<Eliminated>),
}

impl Articulated {
    /// Eliminates every `u'`, with room for forces on further points and torques on further frames. `None`
    /// where the graph is no tree, or constraints couple the speeds.
    pub fn new(
        k: &mut Kinematics<'_>,
        inertias: &BTreeMap<Attachment, LumpedInertia>,
        mut points: Vec<PointId>,
        mut frames: Vec<FrameId>,
    ) -> Option<Self> {
        if !k.dependent.is_empty() {
            return None;
        }
        let mut form = Form::new(k, inertias);
        points.extend(inertias.keys().filter_map(|attachment| attachment.1));
        frames.extend(inertias.keys().map(|attachment| attachment.0).filter(|&frame| frame != FrameId::N));
        let order = elimination_order::elimination_order(k, &points, &frames);
        let mut last: BTreeMap<usize, usize> = BTreeMap::new();
        for (at, node) in order.iter().enumerate() {
            last.extend(slots(k, node).into_iter().map(|slot| (slot, at)));
        }
        let mut steps = Vec::new();
        let mut waiting = Vec::new();
        for (at, node) in order.iter().enumerate() {
            match *node {
                Node::Frame(frame) => form.split_frame(k, frame),
                Node::Point(point) => form.split_point(k, point)?,
            }
            steps.push(Step::Split(*node));
            // Before the rest is inserted: nothing resists a turn about the axis of a hinge any more, and
            // zeros need not be turned.
            for slot in slots(k, node).into_iter().filter(|slot| last.get(slot) == Some(&at)) {
                match next_point(k, &form, slot, node, &order[at + 1..]) {
                    Some(point) => waiting.push((point, slot)),
                    None => steps.push(Step::Eliminated(Box::new(form.eliminate(k, slot, *node)?))),
                }
            }
            match *node {
                Node::Frame(frame) => steps.push(Step::Frame(frame, Box::new(form.frame(k, frame)))),
                Node::Point(point) => {
                    steps.push(Step::Point(point, Box::new(form.point(k, point)?)));
                    for (_, slot) in waiting.extract_if(.., |(until, _)| *until == point) {
                        steps.push(Step::Eliminated(Box::new(form.eliminate(k, slot, *node)?)));
                    }
                }
            }
        }
        let articulated = Articulated { steps };
        (articulated.eliminated().count() == k.speeds.len()).then_some(articulated)
    }

    fn eliminated(&self) -> impl DoubleEndedIterator<Item = &Eliminated> {
        self.steps.iter().filter_map(|step| match step {
            Step::Eliminated(eliminated) => Some(eliminated.as_ref()),
            _ => None,
        })
    }

    /// The articulated inertias, which must not vanish, with the speeds they resist.
    pub fn pivots(&self) -> impl Iterator<Item = (Expr, usize)> {
        self.eliminated().map(|step| (step.reciprocal.pow(-1), step.slot))
    }

    /// What is left of forces when they reach each `u'`, in the order of elimination, on top of what the
    /// accelerations that each relation has `apart` take; `None` if forces meet the graph where
    /// [`Articulated::new`] was not told of.
    pub fn inwards(
        &self,
        k: &mut Kinematics<'_>,
        wrenches: Wrenches,
        mut apart: Option<&mut Accelerations>,
    ) -> Option<Vec<Expr>> {
        let mut acting = Acting {
            force: wrenches.forces,
            torque: wrenches.torques,
            loads: wrenches.generalised.into_iter().collect(),
        };
        let mut loads = Vec::new();
        for step in &self.steps {
            match step {
                Step::Split(Node::Frame(frame)) => acting.split_frame(k, *frame),
                Step::Split(Node::Point(point)) => acting.split_point(k, *point)?,
                Step::Frame(frame, stood) => {
                    if let Some(apart) = &mut apart {
                        let own = apart.own_angular(k, *frame);
                        stood.resist(&mut acting, *frame, &own);
                    }
                    acting.frame(k, *frame);
                }
                Step::Point(point, stood) => {
                    if let Some(apart) = &mut apart {
                        let own = apart.own_point(k, *point);
                        stood.resist(&mut acting, *point, &own);
                    }
                    acting.point(k, *point)?;
                }
                Step::Eliminated(step) => {
                    let load = acting.loads.remove(&step.slot).unwrap_or_else(Expr::zero);
                    acting.eliminate(k, step, &load);
                    loads.push(k.z.name(load));
                }
            }
        }
        (acting.force.is_empty() && acting.torque.is_empty() && acting.loads.is_empty()).then_some(loads)
    }

    /// `f' M^-1 g` from what [`Articulated::inwards`] leaves of both.
    pub fn product(&self, k: &mut Kinematics<'_>, f: &[Expr], g: &[Expr]) -> Expr {
        let terms: Vec<Expr> = self
            .eliminated()
            .zip(f.iter().zip(g))
            .map(|(step, (f, g))| k.z.name(g.mul(&step.reciprocal)).mul(f))
            .collect();
        k.z.name(Expr::sum(&terms))
    }

    /// `u'` of all speeds from the loads that [`Articulated::inwards`] leaves, each from those before it,
    /// with what each relation has `apart`.
    pub fn outwards(
        &self,
        k: &mut Kinematics<'_>,
        loads: &[Expr],
        apart: Option<&mut Accelerations>,
    ) -> Vec<Expr> {
        let mut outward = Outward { apart, ..Outward::default() };
        for (step, load) in self.eliminated().rev().zip(loads.iter().rev()) {
            let mut sum = load.clone();
            if let Some((point, p)) = &step.momentum {
                let carried = step.split == Node::Point(*point);
                let da = if carried { outward.carried_point(k, *point) } else { outward.point(k, *point) };
                sum = sum.sub(&linear_forms::dot(p, &da));
            }
            // What is about the hinge's axis is divided by the pivot that it is multiplied by: it stays
            // aside.
            let mut aside: Vec<(FrameId, usize, Expr)> = Vec::new();
            if let Some((frame, h)) = &step.angular {
                let carried = step.split == Node::Frame(*frame);
                let dalpha =
                    if carried { outward.carried_frame(k, *frame) } else { outward.frame(k, *frame) };
                for (axis, (h, dalpha)) in h.iter().zip(&dalpha).enumerate() {
                    let ratio = h.mul(&step.reciprocal);
                    if ratio.is_number() && !ratio.is_zero() {
                        aside.push((*frame, axis, ratio.mul(dalpha)));
                    } else {
                        sum = sum.sub(&h.mul(dalpha));
                    }
                }
            }
            for (other, m) in &step.others {
                sum = sum.sub(&m.mul(&outward.known(*other)));
            }
            let sum = k.z.name(sum);
            let value = k.z.name(sum.mul(&step.reciprocal));
            let rest = aside.iter().fold(value.clone(), |rest, (.., part)| rest.sub(part));
            let rest = k.z.name(rest);
            outward.speeds.insert(step.slot, rest);
            if let [(frame, axis, _)] = aside[..]
                && step.split == Node::Frame(frame)
            {
                outward.totals.insert((frame, axis), (step.slot, value));
            }
        }
        (0..k.speeds.len()).map(|slot| outward.known(slot)).collect()
    }
}

/// The point to which a `u'` is carried on before it is eliminated: where all that it moves is one rigid body
/// in space and that point is the next to be inserted, its frame's base left to turn.
fn next_point(k: &Kinematics<'_>, form: &Form, slot: usize, node: &Node, later: &[Node]) -> Option<PointId> {
    let Node::Frame(frame) = *node else { return None };
    let base = k.turning(k.frames[frame.0].base);
    let point = form.rigid_about(slot)?;
    let next = later.iter().find(|&&next| next == Node::Point(point) || next == Node::Frame(base))?;
    (*next == Node::Point(point) && slots(k, next).is_empty()).then_some(point)
}

fn slots(k: &Kinematics<'_>, node: &Node) -> Vec<usize> {
    match node {
        Node::Frame(frame) => k.frames[frame.0].relative.terms.keys().copied().collect(),
        Node::Point(point) => {
            let relative = &k.points[point.0].relative;
            let mut all: Vec<usize> =
                relative.iter().flat_map(|(_, form)| form.terms.keys().copied()).collect();
            all.sort_unstable();
            all.dedup();
            all
        }
    }
}

/// Accelerations, as far as the `u'` are known.
#[derive(Default)]
struct Outward<'a> {
    speeds: BTreeMap<usize, Expr>,
    apart: Option<&'a mut Accelerations>,
    frames: BTreeMap<FrameId, Triple>,
    points: BTreeMap<PointId, Triple>,
    /// components of angular accelerations that the load of a hinge determines by itself, with the hinge's
    /// slot
    totals: BTreeMap<(FrameId, usize), (usize, Expr)>,
    carried_frames: BTreeMap<FrameId, Triple>,
    carried_points: BTreeMap<PointId, Triple>,
}

impl Outward<'_> {
    fn known(&self, slot: usize) -> Expr {
        self.speeds.get(&slot).cloned().unwrap_or_else(Expr::zero)
    }

    /// Angular acceleration without the `u'` of the frame's own relation.
    fn carried_frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) -> Triple {
        if let Some(known) = self.carried_frames.get(&frame) {
            return known.clone();
        }
        let motion = &k.frames[frame.0];
        let (home, base) = (motion.home, k.turning(motion.base));
        let of_base = self.frame(k, base);
        let mut sum = k.tree.convert(&mut k.z, &of_base, k.frames[base.0].home, home);
        if let Some(apart) = &self.apart {
            sum = linear_forms::add(&sum, &apart.own_angular(k, frame));
        }
        let value = linear_forms::name(&mut k.z, sum);
        self.carried_frames.insert(frame, value.clone());
        value
    }

    fn frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) -> Triple {
        if frame == FrameId::N {
            return linear_forms::zero();
        }
        if let Some(known) = self.frames.get(&frame) {
            return known.clone();
        }
        let mut sum = self.carried_frame(k, frame);
        for (&slot, a) in &k.frames[frame.0].relative.terms {
            sum = linear_forms::add(&sum, &linear_forms::scale(&self.known(slot), a));
        }
        let terms = &k.frames[frame.0].relative.terms;
        for (axis, component) in sum.iter_mut().enumerate() {
            // A hinge about this axis alone: what it adds makes the whole, which is known.
            if let Some((slot, total)) = self.totals.get(&(frame, axis))
                && terms.len() == 1
                && let Some(a) = terms.get(slot)
                && (a[axis].is_one() || a[axis].neg().is_one())
            {
                *component = a[axis].mul(total);
            }
        }
        let value = linear_forms::name(&mut k.z, sum);
        self.frames.insert(frame, value.clone());
        value
    }

    /// Acceleration without the `u'` of the point's own relation.
    fn carried_point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Triple {
        if let Some(known) = self.carried_points.get(&point) {
            return known.clone();
        }
        let motion = k.points[point.0].clone();
        let mut sum = match motion.base {
            Some(base) => {
                let value = self.point(k, base);
                k.tree.convert(&mut k.z, &value, k.points[base.0].home, motion.home)
            }
            None => linear_forms::zero(),
        };
        for arm in &motion.arms {
            let home = k.frames[arm.frame.0].home;
            let dalpha = self.frame(k, arm.frame);
            let r = k.tree.convert(&mut k.z, &arm.arm, arm.axes, home);
            let part = vectors::mixed(home, linear_forms::cross(&dalpha, &r));
            let part = k.express(&part, motion.home);
            sum = linear_forms::add(&sum, &part);
        }
        if let Some(apart) = &mut self.apart {
            sum = linear_forms::add(&sum, &apart.own_point(k, point));
        }
        let value = linear_forms::name(&mut k.z, sum);
        self.carried_points.insert(point, value.clone());
        value
    }

    fn point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Triple {
        if let Some(known) = self.points.get(&point) {
            return known.clone();
        }
        let mut sum = self.carried_point(k, point);
        let motion = k.points[point.0].clone();
        for (axes, relative) in &motion.relative {
            for (&slot, b) in &relative.terms {
                let turned = k.tree.convert(&mut k.z, b, *axes, motion.home);
                sum = linear_forms::add(&sum, &linear_forms::scale(&self.known(slot), &turned));
            }
        }
        let value = linear_forms::name(&mut k.z, sum);
        self.points.insert(point, value.clone());
        value
    }
}
