//! What is left of the mechanism while velocities are inserted and derivatives of speeds eliminated.

use std::collections::BTreeMap;

use super::super::lumps::{Lump, Seat};
use super::super::sums::{sum_matrix, sum_scalar, sum_symmetric, sum_triple};
use super::Eliminated;
use super::acting::Acting;
use super::relation::{Matrix, PointRelation, arm_matrix, column, times, transposed, turn_rows};
use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::{Symmetric, entry};
use crate::kinematics::linear::{self, Triple};
use crate::model::mechanism::{FrameId, PointId};

/// Coefficients of the quadratic form
/// `1/2 sum da.m.da + sum da.X.dalpha + 1/2 sum dalpha.I.dalpha + sum u' da.p + sum u' dalpha.h + 1/2 sum M u' u'`.
#[derive(Default)]
pub struct Form {
    mass: BTreeMap<PointId, Symmetric>,
    moment: BTreeMap<(PointId, FrameId), Matrix>,
    inertia: BTreeMap<FrameId, Symmetric>,
    momentum: BTreeMap<(PointId, usize), Triple>,
    angular: BTreeMap<(FrameId, usize), Triple>,
    matrix: BTreeMap<(usize, usize), Expr>,
}

/// What stood beside the angular acceleration of a frame when it was inserted.
pub struct OfFrame {
    inertia: Option<Symmetric>,
    moments: Vec<(PointId, Matrix)>,
    angular: Vec<(usize, Triple)>,
}

/// What stood beside the acceleration of a point when it was inserted.
pub struct OfPoint {
    mass: Option<Symmetric>,
    moments: Vec<(FrameId, Matrix)>,
    momenta: Vec<(usize, Triple)>,
}

impl OfFrame {
    /// The forces that an angular acceleration of the frame by itself takes.
    pub fn resist(&self, acting: &mut Acting, frame: FrameId, alpha: &Triple) {
        let against = linear::scale(&Expr::integer(-1), alpha);
        if let Some(inertia) = &self.inertia {
            sum_triple(&mut acting.torque, frame, &times(&full(inertia), &against));
        }
        for (point, moment) in &self.moments {
            sum_triple(&mut acting.force, *point, &times(moment, &against));
        }
        for (slot, h) in &self.angular {
            sum_scalar(&mut acting.loads, *slot, &linear::dot(h, &against));
        }
    }
}

impl OfPoint {
    /// The forces that an acceleration of the point by itself takes.
    pub fn resist(&self, acting: &mut Acting, point: PointId, a: &Triple) {
        let against = linear::scale(&Expr::integer(-1), a);
        if let Some(mass) = &self.mass {
            sum_triple(&mut acting.force, point, &times(&full(mass), &against));
        }
        for (frame, moment) in &self.moments {
            sum_triple(&mut acting.torque, *frame, &times(&transposed(moment), &against));
        }
        for (slot, p) in &self.momenta {
            sum_scalar(&mut acting.loads, *slot, &linear::dot(p, &against));
        }
    }
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

impl Form {
    /// The inertia of all lumps.
    pub fn new(k: &mut Kinematics<'_>, lumps: &BTreeMap<Seat, Lump>) -> Self {
        let mut form = Form::default();
        for (&(frame, point), lump) in lumps {
            if let Some(point) = point {
                let mass = std::array::from_fn(|i| if i < 3 { lump.mass.clone() } else { Expr::zero() });
                sum_symmetric(&mut form.mass, point, &mass);
            }
            if frame != FrameId::N {
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
        form
    }

    fn add_product(&mut self, r: usize, s: usize, value: &Expr) {
        if !value.is_zero() {
            let value = if r == s { value.mul(&Expr::integer(2)) } else { value.clone() };
            sum_scalar(&mut self.matrix, (r.min(s), r.max(s)), &value);
        }
    }

    /// Inserts `dalpha = dalpha_base + sum a u'`.
    pub fn frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) -> OfFrame {
        let mut stood = OfFrame { inertia: None, moments: Vec::new(), angular: Vec::new() };
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
            stood.moments.push((point, moment));
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
            stood.inertia = Some(inertia);
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
            stood.angular.push((slot, h));
        }
        stood
    }

    /// Inserts `da = da_base + sum dalpha x r + sum b u'`; `None` if more than one frame carries the point.
    pub fn point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Option<OfPoint> {
        let mut stood = OfPoint { mass: None, moments: Vec::new(), momenta: Vec::new() };
        let PointRelation { home, base, arm, partials } = PointRelation::of(k, point)?;
        if let Some(mass) = self.mass.remove(&point) {
            let mass = mass.map(|c| k.z.name(c));
            let rows = full(&mass);
            if let Some((base, to)) = base {
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
                if let Some((base, to)) = base {
                    let turned = turn_rows(k, &product, home, to);
                    sum_matrix(&mut self.moment, (base, *frame), &turned);
                }
                for (slot, b) in &partials {
                    sum_triple(&mut self.angular, (*frame, *slot), &times(&transposed(&product), b));
                }
            }
            for (slot, b) in &partials {
                let p = linear::name(&mut k.z, times(&rows, b));
                if let Some((base, to)) = base {
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
            stood.mass = Some(mass);
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
            if let Some((base, to)) = base {
                let turned = turn_rows(k, &moment, home, to);
                sum_matrix(&mut self.moment, (base, frame), &turned);
            }
            stood.moments.push((frame, moment));
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
            if let Some((base, to)) = base {
                let turned = k.tree.convert(&mut k.z, &p, home, to);
                sum_triple(&mut self.momentum, (base, slot), &turned);
            }
            stood.momenta.push((slot, p));
        }
        Some(stood)
    }

    /// Makes the form least over one `u'`.
    pub fn eliminate(&mut self, k: &mut Kinematics<'_>, slot: usize) -> Option<Eliminated> {
        let pivot = self.matrix.remove(&(slot, slot)).filter(|pivot| !pivot.is_zero())?;
        let pivot = k.z.simplify(&pivot);
        let pivot = k.z.name(pivot);
        let reciprocal = k.z.name(pivot.pow(-1));
        let momentum = taken(&mut self.momentum, slot, k)?;
        let angular = taken(&mut self.angular, slot, k)?;
        let keys: Vec<(usize, usize)> =
            self.matrix.keys().filter(|key| key.0 == slot || key.1 == slot).copied().collect();
        let mut others = Vec::new();
        for key in keys {
            let value = self.matrix.remove(&key).unwrap_or_else(Expr::zero);
            others.push((if key.0 == slot { key.1 } else { key.0 }, k.z.name(value)));
        }
        let minus = reciprocal.neg();
        if let Some((point, p)) = &momentum {
            let scaled = linear::name(&mut k.z, linear::scale(&minus, p));
            sum_symmetric(&mut self.mass, *point, &square(p, &scaled));
            if let Some((frame, h)) = &angular {
                let product: Matrix = std::array::from_fn(|i| linear::scale(&scaled[i], h));
                sum_matrix(&mut self.moment, (*point, *frame), &product);
            }
            for (other, m) in &others {
                sum_triple(&mut self.momentum, (*point, *other), &linear::scale(m, &scaled));
            }
        }
        if let Some((frame, h)) = &angular {
            let scaled = linear::name(&mut k.z, linear::scale(&minus, h));
            sum_symmetric(&mut self.inertia, *frame, &square(h, &scaled));
            for (other, m) in &others {
                sum_triple(&mut self.angular, (*frame, *other), &linear::scale(m, &scaled));
            }
        }
        for (i, (r, m)) in others.iter().enumerate() {
            let scaled = k.z.name(m.mul(&minus));
            for (s, n) in &others[..=i] {
                let value = scaled.mul(n);
                sum_scalar(&mut self.matrix, (*r.min(s), *r.max(s)), &value);
            }
        }
        Some(Eliminated { slot, reciprocal, momentum, angular, others })
    }
}

/// What couples a `u'` with velocities: at most one, or nothing (`Some(None)`); `None` if there are more.
#[allow(clippy::type_complexity)]
fn taken<K: Ord + Copy>(
    map: &mut BTreeMap<(K, usize), Triple>,
    slot: usize,
    k: &mut Kinematics<'_>,
) -> Option<Option<(K, Triple)>> {
    let keys: Vec<(K, usize)> = map.keys().filter(|key| key.1 == slot).copied().collect();
    let mut found = None;
    for key in keys {
        if let Some(v) = map.remove(&key) {
            let v = linear::name(&mut k.z, v);
            if !linear::is_zero(&v) && found.replace((key.0, v)).is_some() {
                return None;
            }
        }
    }
    Some(found)
}
