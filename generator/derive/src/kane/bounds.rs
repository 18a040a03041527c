//! Upper bounds of the diagonal entries of the mass matrix for all configurations, which serve as scale for
//! its pivots.
//!
//! The kinetic energy of one speed alone is at most what it would be if all vectors that add up were
//! parallel. So magnitudes take the place of vectors in the relations of the graph of velocities; inserting
//! these one after the other, as for the mass matrix, gives one bound per speed. Magnitudes do not change
//! when axes turn, while bounds of components would double at every joint. Without sliding joints the bounds
//! depend on parameters only and cost nothing at run time.

use std::collections::BTreeMap;

use super::base_parameters::{Attachment, LumpedInertia};
use super::elimination_order::{self, Node};
use super::sums::sum_scalar;
use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::linear_forms::{LinearVector, Triple};
use hodograph_model::model::mechanism::FrameId;

/// A magnitude: of a velocity, or of a speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Magnitude {
    Of(Node),
    Speed(usize),
}

use Magnitude::{Of, Speed};

/// A bound of each diagonal entry of the mass matrix of all speeds.
pub fn diagonal(k: &mut Kinematics<'_>, inertias: &BTreeMap<Attachment, LumpedInertia>) -> Vec<Expr> {
    // Twice the kinetic energy: coefficients of products of magnitudes, each pair once.
    let mut form: BTreeMap<(Magnitude, Magnitude), Expr> = BTreeMap::new();
    let two = Expr::integer(2);
    for (&(frame, point), lumped) in inertias {
        let point = point.map(|point| Of(Node::Point(point)));
        let frame = Some(frame).filter(|&frame| frame != FrameId::N).map(|frame| Of(Node::Frame(frame)));
        if let Some(point) = point {
            let mass = k.z.bound(&lumped.mass);
            sum_scalar(&mut form, (point, point), &mass);
        }
        if let Some(frame) = frame {
            let trace = Expr::sum(&lumped.second[..3].iter().map(|c| k.z.bound(c)).collect::<Vec<_>>());
            sum_scalar(&mut form, (frame, frame), &trace.mul(&two));
            if let Some(point) = point {
                let moment = magnitude(k, &lumped.moment).mul(&two);
                sum_scalar(&mut form, pair(frame, point), &moment);
            }
        }
    }
    let points: Vec<_> = inertias.keys().filter_map(|attachment| attachment.1).collect();
    let frames: Vec<_> =
        inertias.keys().map(|attachment| attachment.0).filter(|&frame| frame != FrameId::N).collect();
    let order = elimination_order::elimination_order(k, &points, &frames);
    let relations: Vec<_> = order.iter().map(|&node| relation(k, node)).collect();
    for (at, &node) in order.iter().enumerate() {
        let later = |slot| relations[at + 1..].iter().any(|relation| relation.contains_key(&Speed(slot)));
        insert(k, &mut form, Of(node), &relations[at], later);
    }
    (0..k.speeds.len())
        .map(|slot| form.remove(&(Speed(slot), Speed(slot))).unwrap_or_else(Expr::zero))
        .collect()
}

/// What a magnitude is at most: a sum of others.
fn relation(k: &mut Kinematics<'_>, node: Node) -> BTreeMap<Magnitude, Expr> {
    let mut sum = BTreeMap::new();
    let speeds = |k: &mut Kinematics<'_>, sum: &mut BTreeMap<_, _>, form: &LinearVector| {
        for (&slot, partial) in &form.terms {
            let partial = magnitude(k, partial);
            sum_scalar(sum, Speed(slot), &partial);
        }
    };
    match node {
        Node::Frame(frame) => {
            let motion = k.frames[frame.0].clone();
            let base = k.turning(motion.base);
            if base != FrameId::N {
                sum.insert(Of(Node::Frame(base)), Expr::one());
            }
            speeds(k, &mut sum, &motion.relative);
        }
        Node::Point(point) => {
            let motion = k.points[point.0].clone();
            sum.extend(motion.base.map(|base| (Of(Node::Point(base)), Expr::one())));
            for arm in &motion.arms {
                let length = magnitude(k, &arm.arm);
                sum_scalar(&mut sum, Of(Node::Frame(arm.frame)), &length);
            }
            for (_, relative) in &motion.relative {
                speeds(k, &mut sum, relative);
            }
        }
    }
    sum
}

/// Puts a relation in the place of a magnitude. Products of speeds with others are kept only as long as the
/// speed comes `later`.
fn insert(
    k: &mut Kinematics<'_>,
    form: &mut BTreeMap<(Magnitude, Magnitude), Expr>,
    known: Magnitude,
    relation: &BTreeMap<Magnitude, Expr>,
    later: impl Fn(usize) -> bool,
) {
    let wanted = |a: Magnitude, b: Magnitude| match (a, b) {
        (Speed(a), Speed(b)) => a == b,
        (Speed(slot), _) | (_, Speed(slot)) => later(slot),
        _ => true,
    };
    let entries: Vec<_> = form.keys().filter(|key| key.0 == known || key.1 == known).copied().collect();
    for key in entries {
        let Some(value) = form.remove(&key) else { continue };
        let value = k.z.name(value);
        let parts: Vec<_> = relation.iter().map(|(&part, c)| (part, k.z.name(value.mul(c)))).collect();
        if key.0 == key.1 {
            for (i, (a, first)) in parts.iter().enumerate() {
                for ((b, _), c) in parts[..=i].iter().zip(relation.values()) {
                    let twice = if a == b { Expr::one() } else { Expr::integer(2) };
                    if wanted(*a, *b) {
                        sum_scalar(form, pair(*a, *b), &first.mul(c).mul(&twice));
                    }
                }
            }
        } else {
            let other = if key.0 == known { key.1 } else { key.0 };
            for (part, product) in parts.into_iter().filter(|&(part, _)| wanted(part, other)) {
                sum_scalar(form, pair(part, other), &product);
            }
        }
    }
}

fn pair(a: Magnitude, b: Magnitude) -> (Magnitude, Magnitude) {
    (a.min(b), a.max(b))
}

/// A bound of the magnitude of a vector: the sum of those of its components.
fn magnitude(k: &mut Kinematics<'_>, v: &Triple) -> Expr {
    let components: Vec<Expr> = v.iter().map(|c| k.z.bound(c)).collect();
    k.z.name(Expr::sum(&components))
}
