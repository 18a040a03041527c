//! The quadratic form of Gauss's principle, while relations are inserted and derivatives of speeds are
//! eliminated.
//!
//! Theory: docs/theory.md, section 16.2.

use std::collections::BTreeMap;

use super::super::base_parameters::{Attachment, LumpedInertia};
use super::super::elimination_order::Node;
use super::super::matrix::{
    Matrix, arm_matrix, both_halves, column, full, name_matrix, times, transposed, turn_rows,
};
use super::super::products::Products;
use super::super::sums::{sum_matrix, sum_scalar, sum_symmetric, sum_triple, take_by_first, take_by_second};
use super::acting::Acting;
use super::eliminated::Eliminated;
use super::relation::PointRelation;
use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::{AxesId, ENTRIES, Smaller, Symmetric, is_isotropic};
use crate::kinematics::equations::ENOUGH;
use crate::kinematics::linear_forms::{self, Triple};
use hodograph_model::model::mechanism::{FrameId, PointId};

/// Coefficients of the quadratic form
/// `1/2 sum da.m.da + sum da.X.dalpha + 1/2 sum dalpha.I.dalpha + sum u' da.p + sum u' dalpha.h + 1/2 sum M
/// u' u'`.
#[derive(Default)]
pub struct Form {
    mass: BTreeMap<PointId, Symmetric>,
    moment: BTreeMap<(PointId, FrameId), Matrix>,
    inertia: BTreeMap<FrameId, Symmetric>,
    momentum: BTreeMap<(PointId, usize), Triple>,
    angular: BTreeMap<(FrameId, usize), Triple>,
    matrix: Products,
}

/// A component is much smaller than another if their ratio exceeds this at common sizes of parameters.
/// Forward dynamics of the seven-joint arm rounds the least from 1 to 4, and takes fewer operations the
/// larger this is.
const MUCH: f64 = 3.0;

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
        let against = linear_forms::scale(&Expr::integer(-1), alpha);
        if let Some(inertia) = &self.inertia {
            sum_triple(&mut acting.torque, frame, &times(&full(inertia), &against));
        }
        for (point, moment) in &self.moments {
            sum_triple(&mut acting.force, *point, &times(moment, &against));
        }
        for (slot, h) in &self.angular {
            sum_scalar(&mut acting.loads, *slot, &linear_forms::dot(h, &against));
        }
    }
}

impl OfPoint {
    /// The forces that an acceleration of the point by itself takes.
    pub fn resist(&self, acting: &mut Acting, point: PointId, a: &Triple) {
        let against = linear_forms::scale(&Expr::integer(-1), a);
        if let Some(mass) = &self.mass {
            sum_triple(&mut acting.force, point, &times(&full(mass), &against));
        }
        for (frame, moment) in &self.moments {
            sum_triple(&mut acting.torque, *frame, &times(&transposed(moment), &against));
        }
        for (slot, p) in &self.momenta {
            sum_scalar(&mut acting.loads, *slot, &linear_forms::dot(p, &against));
        }
    }
}

/// `a b' f` from both scaled by f. Where one of those is a number what it is a factor of cancels exactly.
fn scaled_product(a: &Expr, b: &Expr, scaled_a: &Expr, scaled_b: &Expr) -> Expr {
    if scaled_b.is_number() { a.mul(scaled_b) } else { scaled_a.mul(b) }
}

/// `v v' f`, its upper half.
fn square(v: &Triple, scaled: &Triple) -> Symmetric {
    ENTRIES.map(|(i, j)| scaled_product(&v[i], &v[j], &scaled[i], &scaled[j]))
}

/// The same dyadic along other axes. What hinges leave of an inertia can be small in one direction and large
/// in another, and the small part is what matters further in: it keeps its digits.
fn graded(k: &mut Kinematics<'_>, m: &Symmetric, from: AxesId, to: AxesId) -> Symmetric {
    let Kinematics { tree, z, samples, .. } = k;
    tree.convert_graded(z, m, from, to, |z, a, b| {
        let mut size = |c: &Expr| {
            samples.iter_mut().filter_map(|s| s.value(z, c)).take(ENOUGH).map(f64::abs).sum::<f64>()
        };
        let (a, b) = (size(a), size(b));
        if MUCH * a < b {
            Smaller::First
        } else if MUCH * b < a {
            Smaller::Second
        } else {
            Smaller::Neither
        }
    })
}

/// Takes the `u'` with these partial velocities out of a velocity: what it has by itself, its inertia and
/// what it shares with other `u'`, is named and stays; the products go to the matrix.
fn split<K: Ord + Copy>(
    k: &mut Kinematics<'_>,
    matrix: &mut Products,
    (key, partials): (K, &[(usize, Triple)]),
    inertia: &mut BTreeMap<K, Symmetric>,
    momenta: &mut BTreeMap<(K, usize), Triple>,
) {
    for (slot, momentum) in take_by_first(momenta, key) {
        let momentum = linear_forms::name(&mut k.z, momentum);
        matrix.add_products(slot, &momentum, partials);
        momenta.insert((key, slot), momentum);
    }
    let Some(inertia) = inertia.get_mut(&key) else { return };
    *inertia = inertia.clone().map(|c| k.z.name(c));
    for (i, (slot, partial)) in partials.iter().enumerate() {
        let momentum = linear_forms::name(&mut k.z, times(&full(inertia), partial));
        matrix.add_square(&partials[..=i], &momentum);
        sum_triple(momenta, (key, *slot), &momentum);
    }
}

impl Form {
    /// The inertia of all bodies.
    pub fn new(k: &mut Kinematics<'_>, inertias: &BTreeMap<Attachment, LumpedInertia>) -> Self {
        let mut form = Form::default();
        for (&(frame, point), lumped) in inertias {
            if let Some(point) = point {
                let mass = std::array::from_fn(|i| if i < 3 { lumped.mass.clone() } else { Expr::zero() });
                sum_symmetric(&mut form.mass, point, &mass);
            }
            if frame != FrameId::N {
                let inertia = lumped.inertia(k);
                sum_symmetric(&mut form.inertia, frame, &inertia);
                if let Some(point) = point {
                    // da . (dalpha x S), rows turned to the point's axes
                    let (from, to) = (k.frames[frame.0].home, k.points[point.0].home);
                    let skew = turn_rows(k, &arm_matrix(&lumped.moment), from, to);
                    sum_matrix(&mut form.moment, (point, frame), &skew);
                }
            }
        }
        form
    }

    /// Takes the `u'` out of a frame's relation, `dalpha = carried + sum a u'`: from now on `carried` is what
    /// the frame stands for.
    pub fn split_frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) {
        let partials: Vec<_> = k.frames[frame.0].relative.terms.clone().into_iter().collect();
        split(k, &mut self.matrix, (frame, &partials), &mut self.inertia, &mut self.angular);
        for (point, moment) in take_by_second(&mut self.moment, frame) {
            let moment = name_matrix(k, moment);
            for (slot, a) in &partials {
                sum_triple(&mut self.momentum, (point, *slot), &times(&moment, a));
            }
            self.moment.insert((point, frame), moment);
        }
    }

    /// Inserts `carried = dalpha_base` for a frame that has been split.
    pub fn frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) -> OfFrame {
        let mut stood = OfFrame { inertia: None, moments: Vec::new(), angular: Vec::new() };
        let motion = k.frames[frame.0].clone();
        let base = k.turning(motion.base);
        let (home, base_home) = (motion.home, k.frames[base.0].home);
        for (point, moment) in take_by_second(&mut self.moment, frame) {
            let moment = name_matrix(k, moment);
            if base != FrameId::N {
                // columns along the base's axes
                let turned = transposed(&turn_rows(k, &transposed(&moment), home, base_home));
                sum_matrix(&mut self.moment, (point, base), &turned);
            }
            stood.moments.push((point, moment));
        }
        if let Some(inertia) = self.inertia.remove(&frame) {
            let inertia = inertia.map(|c| k.z.name(c));
            if base != FrameId::N {
                let turned = graded(k, &inertia, home, base_home);
                sum_symmetric(&mut self.inertia, base, &turned);
            }
            stood.inertia = Some(inertia);
        }
        for (slot, h) in take_by_first(&mut self.angular, frame) {
            let h = linear_forms::name(&mut k.z, h);
            if base != FrameId::N {
                let turned = k.tree.convert(&mut k.z, &h, home, base_home);
                sum_triple(&mut self.angular, (base, slot), &turned);
            }
            stood.angular.push((slot, h));
        }
        stood
    }

    /// Takes the `u'` out of a point's relation, `da = carried + sum b u'`: from now on `carried` is what the
    /// point stands for.
    pub fn split_point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Option<()> {
        let partials: Vec<_> = PointRelation::of(k, point)?.partials.into_iter().collect();
        split(k, &mut self.matrix, (point, &partials), &mut self.mass, &mut self.momentum);
        for (frame, moment) in take_by_first(&mut self.moment, point) {
            let moment = name_matrix(k, moment);
            for (slot, b) in &partials {
                sum_triple(&mut self.angular, (frame, *slot), &times(&transposed(&moment), b));
            }
            self.moment.insert((point, frame), moment);
        }
        Some(())
    }

    /// Inserts `carried = da_base + sum dalpha x r` for a point that has been split; `None` if more than one
    /// frame carries it.
    pub fn point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Option<OfPoint> {
        let mut stood = OfPoint { mass: None, moments: Vec::new(), momenta: Vec::new() };
        let PointRelation { home, base, arm, .. } = PointRelation::of(k, point)?;
        if let Some(mass) = self.mass.remove(&point) {
            let mass = mass.map(|c| k.z.name(c));
            let rows = full(&mass);
            if let Some((base, to)) = base {
                let turned = graded(k, &mass, home, to);
                sum_symmetric(&mut self.mass, base, &turned);
            }
            if let Some((frame, arm)) = &arm {
                let product: Matrix = std::array::from_fn(|j| times(&rows, &column(arm, j)));
                let product = name_matrix(k, transposed(&product)); // mass * arm
                let own = ENTRIES.map(|(i, j)| linear_forms::dot(&column(arm, i), &column(&product, j)));
                sum_symmetric(&mut self.inertia, *frame, &own);
                if let Some((base, to)) = base {
                    let turned = turn_rows(k, &product, home, to);
                    sum_matrix(&mut self.moment, (base, *frame), &turned);
                }
            }
            stood.mass = Some(mass);
        }
        for (frame, moment) in take_by_first(&mut self.moment, point) {
            let moment = name_matrix(k, moment);
            if let Some((carrier, arm)) = &arm {
                if *carrier != frame {
                    return None;
                }
                // dalpha' (arm' X) dalpha: both halves
                let product: Matrix = std::array::from_fn(|i| times(&transposed(&moment), &column(arm, i)));
                sum_symmetric(&mut self.inertia, frame, &both_halves(&product));
            }
            if let Some((base, to)) = base {
                let turned = turn_rows(k, &moment, home, to);
                sum_matrix(&mut self.moment, (base, frame), &turned);
            }
            stood.moments.push((frame, moment));
        }
        for (slot, p) in take_by_first(&mut self.momentum, point) {
            let p = linear_forms::name(&mut k.z, p);
            if let Some((frame, arm)) = &arm {
                sum_triple(&mut self.angular, (*frame, slot), &times(&transposed(arm), &p));
            }
            if let Some((base, to)) = base {
                let turned = k.tree.convert(&mut k.z, &p, home, to);
                sum_triple(&mut self.momentum, (base, slot), &turned);
            }
            stood.momenta.push((slot, p));
        }
        Some(stood)
    }

    /// The point about which everything that a `u'` moves is one rigid body in space, if it is: that is
    /// cheaper to carry on than what an elimination leaves of it. In a plane it is not.
    pub fn rigid_about(&self, slot: usize) -> Option<PointId> {
        let in_space = |h: &Triple| h.iter().filter(|c| !c.is_zero()).count() > 1;
        let in_space = self.angular.iter().any(|(key, h)| key.1 == slot && in_space(h));
        let point = self.momentum.keys().find(|key| key.1 == slot)?.0;
        (in_space && self.mass.get(&point).is_some_and(is_isotropic)).then_some(point)
    }

    /// Makes the form least over one `u'`.
    pub fn eliminate(&mut self, k: &mut Kinematics<'_>, slot: usize, split: Node) -> Option<Eliminated> {
        let pivot = self.matrix.take_square(slot).filter(|pivot| !pivot.is_zero())?;
        let pivot = k.z.simplify(&pivot);
        let pivot = k.z.name(pivot);
        // Without a name of its own: what the pivot is a factor of cancels.
        let reciprocal = pivot.pow(-1);
        let momentum = taken(&mut self.momentum, slot, k)?;
        let angular = taken(&mut self.angular, slot, k)?;
        let others: Vec<(usize, Expr)> =
            self.matrix.take(slot).into_iter().map(|(other, m)| (other, k.z.name(m))).collect();
        let minus = reciprocal.neg();
        let scale =
            |k: &mut Kinematics<'_>, v: &Triple| linear_forms::name(&mut k.z, linear_forms::scale(&minus, v));
        if let Some((point, p)) = &momentum {
            let scaled = scale(k, p);
            sum_symmetric(&mut self.mass, *point, &square(p, &scaled));
            if let Some((frame, h)) = &angular {
                let scaled_h = scale(k, h);
                let entry = |i: usize, j: usize| scaled_product(&p[i], &h[j], &scaled[i], &scaled_h[j]);
                let product: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
                sum_matrix(&mut self.moment, (*point, *frame), &product);
            }
            for (other, m) in &others {
                sum_triple(&mut self.momentum, (*point, *other), &linear_forms::scale(m, &scaled));
            }
        }
        if let Some((frame, h)) = &angular {
            let scaled = scale(k, h);
            sum_symmetric(&mut self.inertia, *frame, &square(h, &scaled));
            for (other, m) in &others {
                sum_triple(&mut self.angular, (*frame, *other), &linear_forms::scale(m, &scaled));
            }
        }
        for (i, (r, m)) in others.iter().enumerate() {
            let scaled = k.z.name(m.mul(&minus));
            for (s, n) in &others[..=i] {
                self.matrix.add(*r, *s, &scaled.mul(n));
            }
        }
        Some(Eliminated { slot, reciprocal, momentum, angular, others, split })
    }
}

/// What couples a `u'` with velocities: at most one, or nothing (`Some(None)`); `None` if there are more.
#[allow(clippy::type_complexity)]
fn taken<K: Ord + Copy>(
    map: &mut BTreeMap<(K, usize), Triple>,
    slot: usize,
    k: &mut Kinematics<'_>,
) -> Option<Option<(K, Triple)>> {
    let mut found = None;
    for (key, v) in take_by_second(map, slot) {
        let v = linear_forms::name(&mut k.z, v);
        if !linear_forms::is_zero(&v) && found.replace((key, v)).is_some() {
            return None;
        }
    }
    Some(found)
}
