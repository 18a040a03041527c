//! Accelerations in time linear in the number of bodies, by Gauss's principle.
//!
//! The accelerations beyond those with `u' = 0` make `1/2 sum m |da|^2 + .. - forces . accelerations` least. That form is
//! passed along the graph of velocities from the leaves to the ground as the kinetic energy is for the mass matrix, but
//! each `u'` is eliminated as soon as nothing further in mentions it: what is left of its subtree is an articulated
//! inertia. Going outwards again gives the `u'` one after the other. For long chains this beats factorising the mass matrix, for
//! short ones it does not: the derivation keeps what costs less.

use std::collections::BTreeMap;

use super::forces::Wrenches;
use super::lumps::{Lump, Seat};
use super::order::{self, Node};
use crate::algebra::Expr;
use crate::kinematics::axes::{Symmetric, entry};
use crate::kinematics::linear::{self, Triple};
use crate::kinematics::{Kinematics, vectors};
use crate::model::mechanism::{FrameId, PointId};

/// Rows along the first's home axes, columns along the second's.
type Matrix = [Triple; 3];

/// What is found.
pub struct Solved {
    /// u' of all speeds
    pub accelerations: Vec<Expr>,
    /// articulated inertias that must not vanish, with the speeds they resist
    pub pivots: Vec<(Expr, usize)>,
}

/// An eliminated derivative: `u' = (load - sum p . da - sum h . dalpha - sum m u') / d`.
struct Eliminated {
    slot: usize,
    reciprocal: Expr,
    load: Expr,
    momentum: Vec<(PointId, Triple)>,
    angular: Vec<(FrameId, Triple)>,
    others: Vec<(usize, Expr)>,
}

#[derive(Default)]
struct Form {
    mass: BTreeMap<PointId, Symmetric>,
    moment: BTreeMap<(PointId, FrameId), Matrix>,
    inertia: BTreeMap<FrameId, Symmetric>,
    momentum: BTreeMap<(PointId, usize), Triple>,
    angular: BTreeMap<(FrameId, usize), Triple>,
    matrix: BTreeMap<(usize, usize), Expr>,
    loads: BTreeMap<usize, Expr>,
    force: BTreeMap<PointId, Triple>,
    torque: BTreeMap<FrameId, Triple>,
}

/// The accelerations of all speeds for forces that act while `u' = 0`.
/// `None` where the graph is no tree, or constraints couple the speeds.
pub fn accelerations(
    k: &mut Kinematics<'_>,
    lumps: &BTreeMap<Seat, Lump>,
    wrenches: Wrenches,
) -> Option<Solved> {
    if !k.dependent.is_empty() {
        return None;
    }
    let mut form = Form { force: wrenches.forces, torque: wrenches.torques, ..Form::default() };
    form.loads = wrenches.generalized.into_iter().collect();
    let (mut points, mut frames): (Vec<_>, Vec<_>) =
        (form.force.keys().copied().collect(), form.torque.keys().copied().collect());
    for (&(frame, point), lump) in lumps {
        if let Some(point) = point {
            points.push(point);
            let mass = std::array::from_fn(|i| if i < 3 { lump.mass.clone() } else { Expr::zero() });
            sum_symmetric(&mut form.mass, point, &mass);
        }
        if frame != FrameId::N {
            frames.push(frame);
            let inertia = lump.inertia(k);
            sum_symmetric(&mut form.inertia, frame, &inertia);
            if let Some(point) = point {
                // da . (dalpha x S), rows turned to the point's axes
                let (from, to) = (k.frames[frame.0].home, k.points[point.0].home);
                let skew = turn_rows(k, &arm_matrix(&lump.moment), from, to);
                sum_matrix(&mut form.moment, (point, frame), &skew);
            }
        }
    }
    let order = order::elimination_order(k, &points, &frames);
    let mut eliminated = Vec::new();
    for (at, node) in order.iter().enumerate() {
        match *node {
            Node::Frame(frame) => form.frame(k, frame),
            Node::Point(point) => form.point(k, point)?,
        }
        for slot in slots(k, node) {
            if !order[at + 1..].iter().any(|later| slots(k, later).contains(&slot)) {
                eliminated.push(form.eliminate(k, slot)?);
            }
        }
    }
    if eliminated.len() != k.speeds.len() {
        return None;
    }
    Some(back(k, eliminated))
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

fn sum_symmetric<K: Ord>(map: &mut BTreeMap<K, Symmetric>, key: K, value: &Symmetric) {
    let sum = match map.get(&key) {
        Some(have) => std::array::from_fn(|i| have[i].add(&value[i])),
        None => value.clone(),
    };
    map.insert(key, sum);
}

fn sum_matrix<K: Ord>(map: &mut BTreeMap<K, Matrix>, key: K, value: &Matrix) {
    if value.iter().all(linear::is_zero) {
        return;
    }
    let sum = match map.get(&key) {
        Some(have) => std::array::from_fn(|i| linear::add(&have[i], &value[i])),
        None => value.clone(),
    };
    map.insert(key, sum);
}

fn sum_triple<K: Ord>(map: &mut BTreeMap<K, Triple>, key: K, value: &Triple) {
    if linear::is_zero(value) {
        return;
    }
    let sum = map.get(&key).map_or_else(|| value.clone(), |have| linear::add(have, value));
    map.insert(key, sum);
}

fn sum_scalar<K: Ord>(map: &mut BTreeMap<K, Expr>, key: K, value: &Expr) {
    let sum = map.get(&key).map_or_else(|| value.clone(), |have| have.add(value));
    map.insert(key, sum);
}

fn column(m: &Matrix, j: usize) -> Triple {
    std::array::from_fn(|i| m[i][j].clone())
}

fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| column(m, i))
}

/// The rows along other axes.
fn turn_rows(k: &mut Kinematics<'_>, m: &Matrix, from: usize, to: usize) -> Matrix {
    if from == to {
        return m.clone();
    }
    let columns: Matrix = std::array::from_fn(|j| k.tree.convert(&mut k.z, &column(m, j), from, to));
    transposed(&columns)
}

/// `m v`.
fn times(m: &Matrix, v: &Triple) -> Triple {
    std::array::from_fn(|i| linear::dot(&m[i], v))
}

fn full(m: &Symmetric) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[entry(i, j)].clone()))
}

/// `v v' k`, its upper half.
fn square(v: &Triple, factor: &Triple) -> Symmetric {
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)].map(|(i, j)| v[i].mul(&factor[j]))
}

fn name_matrix(k: &mut Kinematics<'_>, m: Matrix) -> Matrix {
    m.map(|row| linear::name(&mut k.z, row))
}

/// `-[r]x`: the matrix that takes w to w x r.
fn arm_matrix(r: &Triple) -> Matrix {
    let [x, y, z] = r;
    [
        [Expr::zero(), z.clone(), y.neg()],
        [z.neg(), Expr::zero(), x.clone()],
        [y.clone(), x.neg(), Expr::zero()],
    ]
}

impl Form {
    fn add_product(&mut self, r: usize, s: usize, value: &Expr) {
        if !value.is_zero() {
            let value = if r == s { value.mul(&Expr::integer(2)) } else { value.clone() };
            sum_scalar(&mut self.matrix, (r.min(s), r.max(s)), &value);
        }
    }

    /// Inserts `dalpha = dalpha_base + sum a u'`.
    fn frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) {
        let motion = k.frames[frame.0].clone();
        let base = k.turning(motion.base);
        let (home, base_home) = (motion.home, k.frames[base.0].home);
        let partials: Vec<(usize, Triple)> = motion.relative.terms.into_iter().collect();
        for point in self.moment.keys().filter(|key| key.1 == frame).map(|key| key.0).collect::<Vec<_>>() {
            let Some(moment) = self.moment.remove(&(point, frame)) else { continue };
            let moment = name_matrix(k, moment);
            for (slot, a) in &partials {
                sum_triple(&mut self.momentum, (point, *slot), &times(&moment, a));
            }
            if base != FrameId::N {
                // columns along the base's axes
                let turned = transposed(&turn_rows(k, &transposed(&moment), home, base_home));
                sum_matrix(&mut self.moment, (point, base), &turned);
            }
        }
        if let Some(inertia) = self.inertia.remove(&frame) {
            let inertia = inertia.map(|c| k.z.name(c));
            for (i, (slot, a)) in partials.iter().enumerate() {
                let h = linear::name(&mut k.z, times(&full(&inertia), a));
                if base != FrameId::N {
                    let turned = k.tree.convert(&mut k.z, &h, home, base_home);
                    sum_triple(&mut self.angular, (base, *slot), &turned);
                }
                for (other, b) in &partials[..=i] {
                    let value = linear::dot(b, &h);
                    if other == slot {
                        sum_scalar(&mut self.matrix, (*slot, *slot), &value);
                    } else {
                        self.add_product(*other, *slot, &value);
                    }
                }
            }
            if base != FrameId::N {
                let turned = k.tree.convert_symmetric(&mut k.z, &inertia, home, base_home);
                sum_symmetric(&mut self.inertia, base, &turned);
            }
        }
        for slot in self.angular.keys().filter(|key| key.0 == frame).map(|key| key.1).collect::<Vec<_>>() {
            let Some(h) = self.angular.remove(&(frame, slot)) else { continue };
            let h = linear::name(&mut k.z, h);
            for (other, a) in &partials {
                self.add_product(*other, slot, &linear::dot(a, &h));
            }
            if base != FrameId::N {
                let turned = k.tree.convert(&mut k.z, &h, home, base_home);
                sum_triple(&mut self.angular, (base, slot), &turned);
            }
        }
        if let Some(torque) = self.torque.remove(&frame) {
            let torque = linear::name(&mut k.z, torque);
            for (slot, a) in &partials {
                sum_scalar(&mut self.loads, *slot, &linear::dot(a, &torque));
            }
            if base != FrameId::N {
                let turned = k.tree.convert(&mut k.z, &torque, home, base_home);
                sum_triple(&mut self.torque, base, &turned);
            }
        }
    }

    /// Inserts `da = da_base + sum dalpha x r + sum b u'`; `None` if more than one frame carries the point.
    fn point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Option<()> {
        let motion = k.points[point.0].clone();
        let (home, base) = (motion.home, motion.base);
        if motion.arms.iter().any(|arm| arm.frame != motion.arms[0].frame) {
            return None;
        }
        let arm = motion.arms.first().map(|first| first.frame);
        let arm = arm.map(|frame| {
            let to = k.frames[frame.0].home;
            let total = motion.arms.iter().fold(linear::zero(), |sum, arm| {
                let turned = k.tree.convert(&mut k.z, &arm.arm, arm.axes, to);
                linear::add(&sum, &turned)
            });
            (frame, linear::name(&mut k.z, total))
        });
        // dalpha -> da, rows along the point's axes, columns along the frame's
        let arm = arm.map(|(frame, r)| {
            let from = k.frames[frame.0].home;
            (frame, turn_rows(k, &arm_matrix(&r), from, home))
        });
        let mut partials: BTreeMap<usize, Triple> = BTreeMap::new();
        for (axes, relative) in &motion.relative {
            for (&slot, b) in &relative.terms {
                let turned = k.tree.convert(&mut k.z, b, *axes, home);
                sum_triple(&mut partials, slot, &turned);
            }
        }
        let base_home = base.map(|base| k.points[base.0].home);
        if let Some(mass) = self.mass.remove(&point) {
            let mass = mass.map(|c| k.z.name(c));
            let rows = full(&mass);
            if let (Some(base), Some(to)) = (base, base_home) {
                let turned =
                    if mass[0] == mass[1] && mass[1] == mass[2] && mass[3..].iter().all(Expr::is_zero) {
                        mass.clone()
                    } else {
                        k.tree.convert_symmetric(&mut k.z, &mass, home, to)
                    };
                sum_symmetric(&mut self.mass, base, &turned);
            }
            if let Some((frame, arm)) = &arm {
                let product: Matrix = std::array::from_fn(|j| times(&rows, &column(arm, j)));
                let product = name_matrix(k, transposed(&product)); // mass * arm
                let own = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
                    .map(|(i, j)| linear::dot(&column(arm, i), &column(&product, j)));
                sum_symmetric(&mut self.inertia, *frame, &own);
                if let (Some(base), Some(to)) = (base, base_home) {
                    let turned = turn_rows(k, &product, home, to);
                    sum_matrix(&mut self.moment, (base, *frame), &turned);
                }
                for (slot, b) in &partials {
                    sum_triple(&mut self.angular, (*frame, *slot), &times(&transposed(&product), b));
                }
            }
            for (slot, b) in &partials {
                let p = linear::name(&mut k.z, times(&rows, b));
                if let (Some(base), Some(to)) = (base, base_home) {
                    let turned = k.tree.convert(&mut k.z, &p, home, to);
                    sum_triple(&mut self.momentum, (base, *slot), &turned);
                }
                for (other, c) in partials.range(..=slot) {
                    let value = linear::dot(c, &p);
                    if other == slot {
                        sum_scalar(&mut self.matrix, (*slot, *slot), &value);
                    } else {
                        self.add_product(*other, *slot, &value);
                    }
                }
            }
        }
        for frame in self.moment.keys().filter(|key| key.0 == point).map(|key| key.1).collect::<Vec<_>>() {
            let Some(moment) = self.moment.remove(&(point, frame)) else { continue };
            let moment = name_matrix(k, moment);
            if let Some((carrier, arm)) = &arm {
                if *carrier != frame {
                    return None;
                }
                // dalpha' (arm' X) dalpha: both halves
                let product: Matrix = std::array::from_fn(|i| times(&transposed(&moment), &column(arm, i)));
                let own = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
                    .map(|(i, j)| product[i][j].add(&product[j][i]));
                sum_symmetric(&mut self.inertia, frame, &own);
            }
            for (slot, b) in &partials {
                sum_triple(&mut self.angular, (frame, *slot), &times(&transposed(&moment), b));
            }
            if let (Some(base), Some(to)) = (base, base_home) {
                let turned = turn_rows(k, &moment, home, to);
                sum_matrix(&mut self.moment, (base, frame), &turned);
            }
        }
        for slot in self.momentum.keys().filter(|key| key.0 == point).map(|key| key.1).collect::<Vec<_>>() {
            let Some(p) = self.momentum.remove(&(point, slot)) else { continue };
            let p = linear::name(&mut k.z, p);
            if let Some((frame, arm)) = &arm {
                sum_triple(&mut self.angular, (*frame, slot), &times(&transposed(arm), &p));
            }
            for (other, b) in &partials {
                self.add_product(*other, slot, &linear::dot(b, &p));
            }
            if let (Some(base), Some(to)) = (base, base_home) {
                let turned = k.tree.convert(&mut k.z, &p, home, to);
                sum_triple(&mut self.momentum, (base, slot), &turned);
            }
        }
        if let Some(force) = self.force.remove(&point) {
            let force = linear::name(&mut k.z, force);
            if let Some((frame, arm)) = &arm {
                sum_triple(&mut self.torque, *frame, &times(&transposed(arm), &force));
            }
            for (slot, b) in &partials {
                sum_scalar(&mut self.loads, *slot, &linear::dot(b, &force));
            }
            if let (Some(base), Some(to)) = (base, base_home) {
                let turned = k.tree.convert(&mut k.z, &force, home, to);
                sum_triple(&mut self.force, base, &turned);
            }
        }
        Some(())
    }

    /// Makes the form least over one `u'`.
    fn eliminate(&mut self, k: &mut Kinematics<'_>, slot: usize) -> Option<Eliminated> {
        let pivot = self.matrix.remove(&(slot, slot)).filter(|pivot| !pivot.is_zero())?;
        let pivot = k.z.simplify(&pivot);
        let pivot = k.z.name(pivot);
        let reciprocal = k.z.name(pivot.pow(-1));
        let load = self.loads.remove(&slot).unwrap_or_else(Expr::zero);
        let load = k.z.name(load);
        let momentum: Vec<(PointId, Triple)> = taken(&mut self.momentum, slot, k);
        let angular: Vec<(FrameId, Triple)> = taken(&mut self.angular, slot, k);
        if momentum.len() > 1 || angular.len() > 1 {
            return None;
        }
        let keys: Vec<(usize, usize)> =
            self.matrix.keys().filter(|key| key.0 == slot || key.1 == slot).copied().collect();
        let mut others = Vec::new();
        for key in keys {
            let value = self.matrix.remove(&key).unwrap_or_else(Expr::zero);
            others.push((if key.0 == slot { key.1 } else { key.0 }, k.z.name(value)));
        }
        let minus = reciprocal.neg();
        let share = k.z.name(load.mul(&minus));
        for (point, p) in &momentum {
            let scaled = linear::name(&mut k.z, linear::scale(&minus, p));
            sum_symmetric(&mut self.mass, *point, &square(p, &scaled));
            sum_triple(&mut self.force, *point, &linear::scale(&share, p));
            for (frame, h) in &angular {
                let product: Matrix = std::array::from_fn(|i| linear::scale(&scaled[i], h));
                sum_matrix(&mut self.moment, (*point, *frame), &product);
            }
            for (other, m) in &others {
                sum_triple(&mut self.momentum, (*point, *other), &linear::scale(m, &scaled));
            }
        }
        for (frame, h) in &angular {
            let scaled = linear::name(&mut k.z, linear::scale(&minus, h));
            sum_symmetric(&mut self.inertia, *frame, &square(h, &scaled));
            sum_triple(&mut self.torque, *frame, &linear::scale(&share, h));
            for (other, m) in &others {
                sum_triple(&mut self.angular, (*frame, *other), &linear::scale(m, &scaled));
            }
        }
        for (i, (r, m)) in others.iter().enumerate() {
            let scaled = k.z.name(m.mul(&minus));
            sum_scalar(&mut self.loads, *r, &share.mul(m));
            for (s, n) in &others[..=i] {
                let value = scaled.mul(n);
                sum_scalar(&mut self.matrix, (*r.min(s), *r.max(s)), &value);
            }
        }
        Some(Eliminated { slot, reciprocal, load, momentum, angular, others })
    }
}

fn taken<K: Ord + Copy>(
    map: &mut BTreeMap<(K, usize), Triple>,
    slot: usize,
    k: &mut Kinematics<'_>,
) -> Vec<(K, Triple)> {
    let keys: Vec<(K, usize)> = map.keys().filter(|key| key.1 == slot).copied().collect();
    let mut result = Vec::new();
    for key in keys {
        if let Some(v) = map.remove(&key) {
            let v = linear::name(&mut k.z, v);
            if !linear::is_zero(&v) {
                result.push((key.0, v));
            }
        }
    }
    result
}

/// Going outwards: each `u'` from those before it.
fn back(k: &mut Kinematics<'_>, eliminated: Vec<Eliminated>) -> Solved {
    let mut values = vec![Expr::zero(); k.speeds.len()];
    let mut pivots = Vec::new();
    let mut outward = Outward { speeds: BTreeMap::new() };
    for step in eliminated.into_iter().rev() {
        let mut sum = step.load.clone();
        for (point, p) in &step.momentum {
            let da = outward.point(k, *point);
            sum = sum.sub(&linear::dot(p, &da));
        }
        for (frame, h) in &step.angular {
            let dalpha = outward.frame(k, *frame);
            sum = sum.sub(&linear::dot(h, &dalpha));
        }
        for (other, m) in &step.others {
            sum = sum.sub(&m.mul(&values[*other]));
        }
        let sum = k.z.name(sum);
        let value = k.z.name(sum.mul(&step.reciprocal));
        pivots.push((step.reciprocal.pow(-1), step.slot));
        outward.speeds.insert(step.slot, value.clone());
        values[step.slot] = value;
    }
    Solved { accelerations: values, pivots }
}

/// Accelerations beyond those with `u' = 0`, as far as the `u'` are known.
struct Outward {
    speeds: BTreeMap<usize, Expr>,
}

impl Outward {
    fn known(&self, slot: usize) -> Expr {
        self.speeds.get(&slot).cloned().unwrap_or_else(Expr::zero)
    }

    fn frame(&self, k: &mut Kinematics<'_>, frame: FrameId) -> Triple {
        if frame == FrameId::N {
            return linear::zero();
        }
        let motion = k.frames[frame.0].clone();
        let base = k.turning(motion.base);
        let of_base = self.frame(k, base);
        let mut sum = k.tree.convert(&mut k.z, &of_base, k.frames[base.0].home, motion.home);
        for (&slot, a) in &motion.relative.terms {
            sum = linear::add(&sum, &linear::scale(&self.known(slot), a));
        }
        linear::name(&mut k.z, sum)
    }

    fn point(&self, k: &mut Kinematics<'_>, point: PointId) -> Triple {
        let motion = k.points[point.0].clone();
        let mut sum = linear::zero();
        if let Some(base) = motion.base {
            let value = self.point(k, base);
            sum = k.tree.convert(&mut k.z, &value, k.points[base.0].home, motion.home);
        }
        for arm in &motion.arms {
            let home = k.frames[arm.frame.0].home;
            let dalpha = self.frame(k, arm.frame);
            let r = k.tree.convert(&mut k.z, &arm.arm, arm.axes, home);
            let part = vectors::mixed(home, linear::cross(&dalpha, &r));
            let part = k.express(&part, motion.home);
            sum = linear::add(&sum, &part);
        }
        for (axes, relative) in &motion.relative {
            for (&slot, b) in &relative.terms {
                let turned = k.tree.convert(&mut k.z, b, *axes, motion.home);
                sum = linear::add(&sum, &linear::scale(&self.known(slot), &turned));
            }
        }
        linear::name(&mut k.z, sum)
    }
}
