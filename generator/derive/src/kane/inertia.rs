//! The mass matrix, by passing the kinetic energy along the graph of velocities.
//!
//! The kinetic energy is a quadratic form in the velocities of mass centres and the angular velocities of
//! bodies. Each relation of the graph (velocity = that of the base + ..) is inserted in turn, leaves first,
//! until only the speeds are left: their coefficients are the mass matrix. On the way the form gathers
//! masses, first moments and inertias of what moves together, which is the composite-rigid-body algorithm
//! (CRBA), found here for any graph and not only for trees of joints.

use std::collections::BTreeMap;

use super::base_parameters::{Attachment, LumpedInertia};
use super::matrix::{Matrix, both_halves, full, name_matrix, times, transposed, turn_rows};
use super::products::Products;
use super::sums::{
    sum_matrix, sum_scalar, sum_symmetric, sum_triple, take_by_first, take_by_second, take_where,
};
use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::{ENTRIES, Symmetric};
use crate::kinematics::linear_forms::{self, LinearVector, Triple};
use hodograph_model::model::mechanism::{FrameId, PointId};

/// Coefficients of the quadratic form
/// `1/2 sum m v.v + sum v.(w x S) + 1/2 sum w.I.w + sum w.X.w' + sum u v.p + sum u w.h + 1/2 sum M u u`.
#[derive(Default)]
struct Form {
    mass: BTreeMap<PointId, Expr>,
    moment: BTreeMap<(PointId, FrameId), Triple>,
    inertia: BTreeMap<FrameId, Symmetric>,
    coupling: BTreeMap<(FrameId, FrameId), Matrix>,
    momentum: BTreeMap<(PointId, usize), Triple>,
    angular: BTreeMap<(FrameId, usize), Triple>,
    matrix: Products,
}

/// The mass matrix of all speeds, dependent ones included, by slots `(r, s)` with `r <= s`. The slot after
/// the last speed stands for prescribed motion (the remainders, with speed 1).
pub fn full_mass_matrix(
    k: &mut Kinematics<'_>,
    inertias: &BTreeMap<Attachment, LumpedInertia>,
) -> BTreeMap<(usize, usize), Expr> {
    let mut form = Form::default();
    let (mut points, mut frames) = (Vec::new(), Vec::new());
    for (&(frame, point), lumped) in inertias {
        if let Some(point) = point {
            points.push(point);
            if !lumped.mass.is_zero() {
                sum_scalar(&mut form.mass, point, &lumped.mass);
            }
        }
        if frame != FrameId::N {
            frames.push(frame);
            let inertia = lumped.inertia(k);
            sum_symmetric(&mut form.inertia, frame, &inertia);
            if let Some(point) = point {
                sum_triple(&mut form.moment, (point, frame), &lumped.moment);
            }
        }
    }
    let order = super::elimination_order::elimination_order(k, &points, &frames);
    for node in order {
        match node {
            super::elimination_order::Node::Frame(frame) => form.eliminate_frame(k, frame),
            super::elimination_order::Node::Point(point) => form.eliminate_point(k, point),
        }
    }
    let mut tidy = |value: Expr| {
        let value = k.z.simplify(&value);
        k.z.name(value)
    };
    form.matrix.entries().into_iter().map(|(at, value)| (at, tidy(value))).collect()
}

/// Partial velocities of a relation, the remainder under the slot after the last speed.
fn slots(k: &Kinematics<'_>, form: &LinearVector) -> Vec<(usize, Triple)> {
    let mut all: Vec<_> = form.terms.iter().map(|(&slot, p)| (slot, p.clone())).collect();
    if !linear_forms::is_zero(&form.rest) {
        all.push((k.speeds.len(), form.rest.clone()));
    }
    all
}

/// `r.s 1 - r s'`, symmetrised.
fn spread(r: &Triple, s: &Triple) -> Symmetric {
    let d = linear_forms::dot(r, s);
    let half = Expr::number(&hodograph_model::number::Number::ratio(1, 2));
    ENTRIES.map(|(i, j)| {
        let product = r[i].mul(&s[j]).add(&r[j].mul(&s[i])).mul(&half);
        if i == j { d.sub(&product) } else { product.neg() }
    })
}

/// `[r]x' C [s]x` for C = 1: the matrix of `(w x r).(w' x s)`.
fn skew_product(r: &Triple, s: &Triple) -> Matrix {
    let d = linear_forms::dot(r, s);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let product = s[i].mul(&r[j]);
            if i == j { d.sub(&product) } else { product.neg() }
        })
    })
}

impl Form {
    /// Adds `w_f . X . w_g`, rows of X along f's home axes, columns along g's.
    fn add_coupling(&mut self, k: &mut Kinematics<'_>, f: FrameId, g: FrameId, x: Matrix) {
        if f == FrameId::N || g == FrameId::N || x.iter().all(linear_forms::is_zero) {
            return;
        }
        if f == g {
            sum_symmetric(&mut self.inertia, f, &both_halves(&x).map(|c| k.z.name(c)));
            return;
        }
        let (key, x) = if f < g { ((f, g), x) } else { ((g, f), transposed(&x)) };
        sum_matrix(&mut self.coupling, key, &x);
    }

    /// Inserts `w = w_base + sum a u`.
    fn eliminate_frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) {
        let motion = k.frames[frame.0].clone();
        let base = k.turning(motion.base);
        let home = motion.home;
        let base_home = k.frames[base.0].home;
        let partials = slots(k, &motion.relative);

        for (point, moment) in take_by_second(&mut self.moment, frame) {
            let moment = linear_forms::name(&mut k.z, moment);
            if base != FrameId::N {
                let turned = k.tree.convert(&mut k.z, &moment, home, base_home);
                sum_triple(&mut self.moment, (point, base), &turned);
            }
            let at = k.points[point.0].home;
            for (slot, a) in &partials {
                let product = linear_forms::name(&mut k.z, linear_forms::cross(a, &moment));
                let turned = k.tree.convert(&mut k.z, &product, home, at);
                sum_triple(&mut self.momentum, (point, *slot), &turned);
            }
        }
        if let Some(inertia) = self.inertia.remove(&frame) {
            let inertia = inertia.map(|c| k.z.name(c));
            for (i, (slot, a)) in partials.iter().enumerate() {
                let column = linear_forms::name(&mut k.z, times(&full(&inertia), a));
                if base != FrameId::N {
                    let turned = k.tree.convert(&mut k.z, &column, home, base_home);
                    sum_triple(&mut self.angular, (base, *slot), &turned);
                }
                self.matrix.add_square(&partials[..=i], &column);
            }
            if base != FrameId::N {
                let turned = k.tree.convert_symmetric(&mut k.z, &inertia, home, base_home);
                sum_symmetric(&mut self.inertia, base, &turned);
            }
        }
        for ((f, g), x) in take_where(&mut self.coupling, |key| key.0 == frame || key.1 == frame) {
            let (other, x) = if f == frame { (g, x) } else { (f, transposed(&x)) };
            let x = name_matrix(k, x);
            for (slot, a) in &partials {
                let row = linear_forms::name(&mut k.z, times(&transposed(&x), a));
                sum_triple(&mut self.angular, (other, *slot), &row);
            }
            if base != FrameId::N {
                let turned = turn_rows(k, &x, home, base_home);
                self.add_coupling(k, base, other, turned);
            }
        }
        for (slot, h) in take_by_first(&mut self.angular, frame) {
            let h = linear_forms::name(&mut k.z, h);
            if base != FrameId::N {
                let turned = k.tree.convert(&mut k.z, &h, home, base_home);
                sum_triple(&mut self.angular, (base, slot), &turned);
            }
            self.matrix.add_products(slot, &h, &partials);
        }
    }

    /// Inserts `v = v_base + sum w x r + sum b u`.
    fn eliminate_point(&mut self, k: &mut Kinematics<'_>, point: PointId) {
        let motion = k.points[point.0].clone();
        let home = motion.home;
        let base = motion.base;
        let base_home = base.map(|base| k.points[base.0].home);
        // arms along the home axes of their frames
        let arms: Vec<(FrameId, Triple)> = motion
            .arms
            .iter()
            .map(|arm| {
                let to = k.frames[arm.frame.0].home;
                (arm.frame, k.tree.convert(&mut k.z, &arm.arm, arm.axes, to))
            })
            .collect();
        let partials: Vec<(usize, Triple)> = {
            let mut all: BTreeMap<usize, Triple> = BTreeMap::new();
            for (axes, relative) in &motion.relative {
                for (slot, b) in slots(k, relative) {
                    let turned = k.tree.convert(&mut k.z, &b, *axes, home);
                    sum_triple(&mut all, slot, &turned);
                }
            }
            all.into_iter().map(|(slot, b)| (slot, linear_forms::name(&mut k.z, b))).collect()
        };

        if let Some(mass) = self.mass.remove(&point) {
            let mass = k.z.name(mass);
            if let Some(base) = base {
                sum_scalar(&mut self.mass, base, &mass);
            }
            for (i, (frame, arm)) in arms.iter().enumerate() {
                let moment = linear_forms::name(&mut k.z, linear_forms::scale(&mass, arm));
                if let Some(base) = base {
                    sum_triple(&mut self.moment, (base, *frame), &moment);
                }
                let own = spread(&moment, arm).map(|c| k.z.name(c));
                sum_symmetric(&mut self.inertia, *frame, &own);
                for (other, second) in &arms[..i] {
                    self.couple_arms(k, (*frame, &moment), (*other, second));
                }
                self.arm_times_partials(k, *frame, &moment, &partials, home);
            }
            for (i, (slot, b)) in partials.iter().enumerate() {
                let momentum = linear_forms::name(&mut k.z, linear_forms::scale(&mass, b));
                if let (Some(base), Some(to)) = (base, base_home) {
                    let turned = k.tree.convert(&mut k.z, &momentum, home, to);
                    sum_triple(&mut self.momentum, (base, *slot), &turned);
                }
                self.matrix.add_square(&partials[..=i], &momentum);
            }
        }
        for (frame, moment) in take_by_first(&mut self.moment, point) {
            let moment = linear_forms::name(&mut k.z, moment);
            if let Some(base) = base {
                sum_triple(&mut self.moment, (base, frame), &moment);
            }
            for (other, arm) in &arms {
                if *other == frame {
                    // v.(w x S) with v = w x r: w.(r.S 1 - r S').w, twice that of the halved form
                    let both = spread(&moment, arm).map(|c| k.z.name(c.mul(&Expr::integer(2))));
                    sum_symmetric(&mut self.inertia, frame, &both);
                } else {
                    self.couple_arms(k, (frame, &moment), (*other, arm));
                }
            }
            self.arm_times_partials(k, frame, &moment, &partials, home);
        }
        for (slot, p) in take_by_first(&mut self.momentum, point) {
            let p = linear_forms::name(&mut k.z, p);
            if let (Some(base), Some(to)) = (base, base_home) {
                let turned = k.tree.convert(&mut k.z, &p, home, to);
                sum_triple(&mut self.momentum, (base, slot), &turned);
            }
            for (frame, arm) in &arms {
                let to = k.frames[frame.0].home;
                let turned = k.tree.convert(&mut k.z, &p, home, to);
                sum_triple(&mut self.angular, (*frame, slot), &linear_forms::cross(arm, &turned));
            }
            self.matrix.add_products(slot, &p, &partials);
        }
    }

    /// `(w_f x S).(w_g x r)` for different frames.
    fn couple_arms(
        &mut self,
        k: &mut Kinematics<'_>,
        (f, moment): (FrameId, &Triple),
        (g, arm): (FrameId, &Triple),
    ) {
        let (f_home, g_home) = (k.frames[f.0].home, k.frames[g.0].home);
        // both along g's axes, then the rows back to f's
        let turned = k.tree.convert(&mut k.z, moment, f_home, g_home);
        let x = name_matrix(k, skew_product(&turned, arm));
        let x = turn_rows(k, &x, g_home, f_home);
        self.add_coupling(k, f, g, x);
    }

    /// `(w x S).(sum b u)`.
    fn arm_times_partials(
        &mut self,
        k: &mut Kinematics<'_>,
        frame: FrameId,
        moment: &Triple,
        partials: &[(usize, Triple)],
        axes: usize,
    ) {
        let home = k.frames[frame.0].home;
        for (slot, b) in partials {
            let turned = k.tree.convert(&mut k.z, b, axes, home);
            sum_triple(&mut self.angular, (frame, *slot), &linear_forms::cross(moment, &turned));
        }
    }
}
