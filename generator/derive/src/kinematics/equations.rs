//! Converts equations to forms linear in the speeds (left side minus right side) without components that are
//! identically 0.
//!
//! A vector equation may be trivial in some direction: the contact point of a ball that rolls on a plane has
//! no velocity along the normal, for all speeds. Its component along that direction is identically 0, but
//! along other axes the algebra does not recognise the dependence. So the module seeks axes along which the
//! equation has as few components as are independent.

use std::collections::HashMap;

use super::Kinematics;
use super::axes::{AxesId, AxesTree};
use super::linear_forms::{LinearScalar, LinearVector};
use super::partial_velocities::Along;
use crate::algebra::{Expr, Intermediates, Sample};
use hodograph_model::arbitrary::Arbitrary;
use hodograph_model::model::mechanism::{
    DefinitionValue, EquationSides, Mechanism, Orientation, PointId, Vector,
};
use hodograph_model::numeric;
use hodograph_program::program::graph::Input;

/// Number of states at which it is decided whether something is identically 0.
const SAMPLES: u64 = 12;
/// This number of samples with a value is sufficient.
pub(crate) const ENOUGH: usize = 4;

impl Kinematics<'_> {
    /// Left side minus right side as forms: one, or the components that are not identically 0.
    pub fn equation_forms(&mut self, sides: &EquationSides) -> Vec<LinearScalar> {
        match sides {
            EquationSides::Scalar(a, b) => {
                let form = self.linear_scalar(a).sub(&self.linear_scalar(b));
                vec![self.tidy_scalar(&form)]
            }
            EquationSides::Vector(a, b) => {
                let difference = Vector::Add(vec![a.clone(), Vector::Neg(Box::new(b.clone()))]);
                self.vector_equation(&difference)
            }
        }
    }

    /// The components of a vanishing vector along the first axes on which they are independent.
    fn vector_equation(&mut self, vector: &Vector) -> Vec<LinearScalar> {
        let form = self.linear_vector(vector);
        let first = self.meeting(form.keys().copied(), std::iter::empty());
        let form = self.express_linear(&form, first);
        let mut best = self.components(&form);
        let rank = self.rank(&best);
        for axes in self.axes_of(vector).into_iter().filter(|&axes| axes != first) {
            if best.len() <= rank {
                break;
            }
            let form = self.vector_along(vector, axes);
            let forms = self.components(&form);
            if forms.len() < best.len() {
                best = forms;
            }
        }
        best
    }

    /// The components of a form that are not identically 0.
    pub(super) fn components(&mut self, form: &LinearVector) -> Vec<LinearScalar> {
        (0..3)
            .map(|i| self.tidy_scalar(&form.component(i)))
            .filter(|component| !component.is_zero())
            .collect()
    }

    /// The form with short coefficients, without those that are identically 0.
    fn tidy_scalar(&mut self, form: &LinearScalar) -> LinearScalar {
        form.map(|c| {
            let c = self.z.simplify(c);
            if self.vanishes(&c) { Expr::zero() } else { c }
        })
    }

    /// Whether the expression is identically 0, as far as random states show.
    pub fn vanishes(&mut self, expr: &Expr) -> bool {
        expr.is_zero() || vanishes(&self.z, &mut self.samples, expr)
    }

    /// The number of forms that are independent at random states; all of them if this cannot be decided.
    pub(super) fn rank(&mut self, forms: &[LinearScalar]) -> usize {
        let slots: Vec<usize> = forms.iter().flat_map(|form| form.terms.keys().copied()).collect();
        // in SI units, so that the units of the model do not matter
        let quantities = self.mechanism.speeds.iter().chain(&self.mechanism.coordinates);
        let sizes: Vec<f64> = quantities.map(|quantity| quantity.factor).collect();
        let size = |slot: usize| sizes.get(slot).copied().unwrap_or(1.0);
        let z = &self.z;
        let ranks = self.samples.iter_mut().filter_map(|sample| {
            let rows: Option<Vec<Vec<f64>>> = forms
                .iter()
                .map(|form| {
                    let of = |&slot: &usize| (form.coefficient(slot), size(slot));
                    let terms = slots.iter().map(of).chain([(form.rest.clone(), 1.0)]);
                    terms.map(|(term, size)| Some(sample.value(z, &term)? / size)).collect()
                })
                .collect();
            rows.map(numeric::rank)
        });
        ranks.take(ENOUGH).max().unwrap_or(forms.len())
    }

    /// A vector as a form along given axes, by the shortest way: velocities are not converted to axes of
    /// bodies on which they do not depend.
    fn vector_along(&mut self, vector: &Vector, axes: AxesId) -> LinearVector {
        match vector {
            Vector::Add(terms) => {
                terms.iter().fold(LinearVector::zero(), |sum, term| sum.add(&self.vector_along(term, axes)))
            }
            Vector::Neg(inner) => self.vector_along(inner, axes).scale(&Expr::integer(-1)),
            Vector::Velocity(point) if self.solved => self.partial_velocities(*point, axes, Along::Result),
            Vector::Definition(id) => {
                let mechanism = self.mechanism;
                match &mechanism.definitions[id.0].value {
                    DefinitionValue::Vector(value) => self.vector_along(value, axes),
                    DefinitionValue::Scalar(_) => LinearVector::zero(),
                }
            }
            other => {
                let form = self.linear_vector(other);
                self.express_linear(&form, axes)
            }
        }
    }

    /// All axes that occur in a vector, and those relative to which they are rotated; N's first.
    fn axes_of(&mut self, vector: &Vector) -> Vec<AxesId> {
        let form = self.linear_vector(vector);
        let mut found: Vec<AxesId> = form.keys().copied().collect();
        let mut points = Vec::new();
        self.points_of(vector, &mut points);
        for point in points {
            for on_the_way in self.way(point) {
                found.extend(self.step(on_the_way).into_keys());
            }
        }
        let mut all = vec![AxesTree::N];
        for axes in found {
            let mut at = Some(axes);
            while let Some(axes) = at {
                all.push(axes);
                at = self.tree.parent(axes);
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    fn points_of(&self, vector: &Vector, points: &mut Vec<PointId>) {
        match vector {
            Vector::Velocity(point) => points.push(*point),
            Vector::Position { of, from } => points.extend([*of, *from]),
            Vector::Add(terms) => terms.iter().for_each(|term| self.points_of(term, points)),
            Vector::Neg(inner) | Vector::Unit(inner, _) | Vector::Scale(_, inner) => {
                self.points_of(inner, points);
            }
            Vector::Cross(a, b) => [a, b].into_iter().for_each(|v| self.points_of(v, points)),
            Vector::Definition(id) => {
                if let DefinitionValue::Vector(value) = &self.mechanism.definitions[id.0].value {
                    self.points_of(value, points);
                }
            }
            Vector::Zero | Vector::Components(..) | Vector::AngularVelocity { .. } => {}
        }
    }
}

impl LinearVector {
    /// Product with an expression free of the unknowns.
    fn scale(&self, k: &Expr) -> Self {
        self.map(|p| super::linear_forms::scale(k, p))
    }
}

/// Whether the expression is 0 at all samples at which it has a value.
pub(super) fn vanishes(z: &Intermediates, samples: &mut [Sample], expr: &Expr) -> bool {
    let seen: Vec<bool> =
        samples.iter_mut().filter_map(|sample| sample.vanishes(z, expr)).take(ENOUGH).collect();
    seen.len() > 1 && seen.iter().all(|&zero| zero)
}

/// Random states and parameters of common sizes, always the same. Default values are not used: an expression
/// that is 0 only with them is not identically 0, and the equations do not depend on them. Some expressions
/// have values only in some of the states.
pub(super) fn samples(mechanism: &Mechanism) -> Vec<Sample> {
    (0..SAMPLES).map(|seed| sample(mechanism, seed)).collect()
}

fn sample(mechanism: &Mechanism, seed: u64) -> Sample {
    let mut arbitrary = Arbitrary::after(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(2 * seed + 1));
    let mut next = || arbitrary.unit();
    let mut inputs = HashMap::from([(Input::Time, next())]);
    for (i, parameter) in mechanism.parameters.iter().enumerate() {
        inputs.insert(Input::Parameter(i as u32), parameter.typical * (0.5 + next()));
    }
    for i in 0..mechanism.inputs.len() {
        inputs.insert(Input::Input(i as u32), next());
    }
    let mut coordinates: Vec<f64> =
        mechanism.coordinates.iter().map(|coordinate| coordinate.typical * (0.2 + 1.6 * next())).collect();
    for frame in &mechanism.frames {
        if let Orientation::Quaternion(parts) = &frame.orientation {
            let length = parts.iter().map(|part| coordinates[part.0].powi(2)).sum::<f64>().sqrt();
            parts.iter().for_each(|part| coordinates[part.0] /= length);
        }
    }
    inputs.extend(coordinates.into_iter().enumerate().map(|(i, q)| (Input::Coordinate(i as u32), q)));
    Sample::new(inputs)
}
