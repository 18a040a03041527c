//! Converts expressions of the model to algebraic expressions: values, and forms linear in the speeds.

use super::linear_forms::{self, LinearScalar, LinearVector};
use super::vectors::{add, add_linear, constant, mixed, scale, scale_linear};
use super::{DeriveError, Kinematics, Mixed, MixedLinear};
use crate::algebra::{Expr, View};
use hodograph_model::arithmetic::Function;
use hodograph_model::diagnostics::codes;
use hodograph_model::model::mechanism::{DefinitionId, DefinitionValue, Mechanism, Scalar, Vector};
use hodograph_program::program::graph::Input;

/// Exponents grow no larger than this: powers of powers get names.
const GREATEST_EXPONENT: u32 = 10_000;

/// Definitions evaluated so far.
pub struct Definitions {
    scalars: Vec<Option<Expr>>,
    vectors: Vec<Option<Mixed>>,
}

impl Definitions {
    /// None yet.
    pub fn new(mechanism: &Mechanism) -> Self {
        let n = mechanism.definitions.len();
        Definitions { scalars: vec![None; n], vectors: vec![None; n] }
    }

    /// Forgets all: what speeds mean has changed.
    pub fn clear(&mut self) {
        self.scalars.iter_mut().for_each(|v| *v = None);
        self.vectors.iter_mut().for_each(|v| *v = None);
    }
}

impl Kinematics<'_> {
    /// The value of a scalar.
    pub fn scalar(&mut self, scalar: &Scalar) -> Expr {
        match scalar {
            Scalar::Number(number) => Expr::number(number),
            Scalar::Pi => self.z.pi(),
            Scalar::Time => self.z.input(Input::Time),
            Scalar::Parameter(id) => self.z.input(Input::Parameter(id.0 as u32)),
            Scalar::Input(id) => self.z.input(Input::Input(id.0 as u32)),
            Scalar::Coordinate(id) => Expr::symbol(self.coordinates[id.0]),
            Scalar::Speed(id) => self.speed(id.0),
            Scalar::Definition(id) => self.scalar_definition(*id),
            Scalar::Rate(inner) => {
                let inner = self.scalar(inner);
                let inner = self.z.name(inner);
                let rate = self.change(&inner);
                self.z.name(rate)
            }
            Scalar::Neg(inner) => self.scalar(inner).neg(),
            Scalar::Add(terms) => terms.iter().fold(Expr::zero(), |sum, t| sum.add(&self.scalar(t))),
            Scalar::Mul(factors) => {
                factors.iter().fold(Expr::one(), |product, f| product.mul(&self.scalar(f)))
            }
            Scalar::Div(a, b, _) => {
                let (a, b) = (self.scalar(a), self.scalar(b));
                self.divide(&a, b)
            }
            Scalar::Pow(base, exponent) => {
                let (base, exponent) = (self.scalar(base), self.scalar(exponent));
                self.power(base, exponent)
            }
            Scalar::Call(function, arguments) => {
                let arguments = arguments.iter().map(|a| self.scalar(a)).collect();
                self.z.call(*function, arguments)
            }
            Scalar::Dot(a, b) => {
                let (a, b) = (self.vector(a), self.vector(b));
                self.dot(&a, &b)
            }
            Scalar::Norm(v) => {
                let v = self.vector(v);
                self.norm(&v)
            }
        }
    }

    fn scalar_definition(&mut self, id: DefinitionId) -> Expr {
        if let Some(known) = &self.definitions.scalars[id.0] {
            return known.clone();
        }
        let mechanism = self.mechanism;
        let value = match &mechanism.definitions[id.0].value {
            DefinitionValue::Scalar(value) => {
                let place = format!("definition `{}`", mechanism.definitions[id.0].name);
                self.within(place, |k| k.scalar(value))
            }
            DefinitionValue::Vector(_) => Expr::zero(),
        };
        let value = self.z.name(value);
        if mechanism.definitions[id.0].of_shapes {
            self.z.bound_by_itself(&value);
        }
        self.definitions.scalars[id.0] = Some(value.clone());
        value
    }

    fn divide(&mut self, a: &Expr, b: Expr) -> Expr {
        let Some(b) = self.divisor(b) else { return Expr::zero() };
        let b = self.z.name(b);
        self.guard(&b, format!("a divisor vanishes in {}", self.place));
        a.div(&b)
    }

    /// What is not 0 as it stands; nothing where it is, which is a mistake of the model.
    fn divisor(&mut self, b: Expr) -> Option<Expr> {
        if !b.is_zero() {
            return Some(b);
        }
        let message = format!("something is divided by 0 in {}", self.place);
        let help = "the terms of the divisor cancel: simplify it by hand".to_owned();
        let span = Default::default();
        self.mistake.get_or_insert(DeriveError { code: codes::ZERO_DIVISOR, span, message, help });
        None
    }

    /// The base of a power, with a name where the exponents that it has already would grow out of bounds.
    fn base(&mut self, base: Expr, n: i32) -> Expr {
        let greatest = |factors: &[Expr]| {
            let exponent = |factor: &Expr| match factor.view() {
                View::Power(_, n) => n.unsigned_abs(),
                _ => 1,
            };
            factors.iter().map(exponent).max().unwrap_or(1)
        };
        let exponent = match base.view() {
            View::Power(_, n) => n.unsigned_abs(),
            View::Product(factors) => greatest(&factors),
            _ => 1,
        };
        if exponent.saturating_mul(n.unsigned_abs()) > GREATEST_EXPONENT { self.z.name(base) } else { base }
    }

    /// `base^exponent`: by multiplication for integers, with a root for halves, else through exp and log.
    fn power(&mut self, base: Expr, exponent: Expr) -> Expr {
        if let View::Number(number) = exponent.view() {
            let whole =
                |n: &hodograph_model::number::Number| n.to_integer().and_then(|n| i32::try_from(n).ok());
            if let Some(n) = whole(&number) {
                let base = self.base(base, n);
                if n < 0 {
                    let Some(base) = self.divisor(base) else { return Expr::zero() };
                    let base = self.z.name(base);
                    self.guard(&base, format!("a divisor vanishes in {}", self.place));
                    return base.pow(n);
                }
                return base.pow(n);
            }
            let twice = hodograph_model::number::Number(&number.0 * num_bigint::BigInt::from(2));
            if let Some(n) = whole(&twice) {
                let root = self.z.call(Function::Sqrt, vec![base]);
                if n < 0 && self.divisor(root.clone()).is_none() {
                    return Expr::zero();
                }
                let root = self.base(root, n);
                if n < 0 {
                    self.guard(&root, format!("a divisor vanishes in {}", self.place));
                }
                return root.pow(n);
            }
        }
        let logarithm = self.z.call(Function::Log, vec![base]);
        self.z.call(Function::Exp, vec![logarithm.mul(&exponent)])
    }

    /// The value of a vector.
    pub fn vector(&mut self, vector: &Vector) -> Mixed {
        match vector {
            Vector::Zero => Mixed::new(),
            Vector::Components(frame, components) => match self.frame_axes[frame.0] {
                Some(axes) => mixed(axes, std::array::from_fn(|i| self.scalar(&components[i]))),
                None => Mixed::new(),
            },
            Vector::Definition(id) => {
                if let Some(known) = &self.definitions.vectors[id.0] {
                    return known.clone();
                }
                let mechanism = self.mechanism;
                let value = match &mechanism.definitions[id.0].value {
                    DefinitionValue::Vector(value) => {
                        let place = format!("definition `{}`", mechanism.definitions[id.0].name);
                        self.within(place, |k| k.vector(value))
                    }
                    DefinitionValue::Scalar(_) => Mixed::new(),
                };
                self.definitions.vectors[id.0] = Some(value.clone());
                value
            }
            Vector::Neg(inner) => scale(&Expr::integer(-1), &self.vector(inner)),
            Vector::Add(terms) => terms.iter().fold(Mixed::new(), |sum, t| add(&sum, &self.vector(t))),
            Vector::Scale(k, v) => {
                let k = self.scalar(k);
                scale(&k, &self.vector(v))
            }
            Vector::Cross(a, b) => {
                let (a, b) = (self.vector(a), self.vector(b));
                self.cross(&a, &b)
            }
            Vector::Unit(v, _) => {
                let v = self.vector(v);
                let norm = self.norm(&v);
                let k = self.divide(&Expr::one(), norm);
                scale(&k, &v)
            }
            Vector::Position { of, from } => self.position(*of, *from),
            Vector::Velocity(point) => {
                if self.solved {
                    let (axes, value) = self.velocity_value(*point);
                    mixed(axes, value)
                } else {
                    Mixed::new()
                }
            }
            Vector::AngularVelocity { of, in_frame } => {
                if self.solved {
                    let (axes, value) = self.angular_velocity_value(*of, *in_frame);
                    mixed(axes, value)
                } else {
                    Mixed::new()
                }
            }
        }
    }

    /// A scalar as a form linear in the speeds (and, while they are unknown, in the rates of coordinates).
    /// The front end has checked that it is one.
    pub fn linear_scalar(&mut self, scalar: &Scalar) -> LinearScalar {
        match scalar {
            Scalar::Speed(id) => LinearScalar::unknown(id.0),
            Scalar::Rate(inner) => {
                let inner = self.scalar(inner);
                self.rate_of(&inner)
            }
            Scalar::Definition(id) => {
                let mechanism = self.mechanism;
                match &mechanism.definitions[id.0].value {
                    DefinitionValue::Scalar(value) if mentions_motion(mechanism, value) => {
                        self.linear_scalar(value)
                    }
                    _ => LinearScalar::constant(self.scalar_definition(*id)),
                }
            }
            Scalar::Neg(inner) => self.linear_scalar(inner).scale(&Expr::integer(-1)),
            Scalar::Add(terms) => terms
                .iter()
                .fold(LinearScalar::constant(Expr::zero()), |sum, t| sum.add(&self.linear_scalar(t))),
            Scalar::Mul(factors) => {
                factors.iter().fold(LinearScalar::constant(Expr::one()), |product, factor| {
                    let factor = self.linear_scalar(factor);
                    if factor.terms.is_empty() {
                        product.scale(&factor.rest)
                    } else {
                        factor.scale(&product.rest)
                    }
                })
            }
            Scalar::Div(a, b, _) => {
                let a = self.linear_scalar(a);
                let b = self.scalar(b);
                let reciprocal = self.divide(&Expr::one(), b);
                a.scale(&reciprocal)
            }
            Scalar::Dot(a, b) => {
                let (a, b) = (self.linear_vector(a), self.linear_vector(b));
                match (free(&a), free(&b)) {
                    (_, Some(b)) => self.dot_linear(&a, &b),
                    (Some(a), None) => self.dot_linear(&b, &a),
                    (None, None) => LinearScalar::constant(Expr::zero()),
                }
            }
            other => LinearScalar::constant(self.scalar(other)),
        }
    }

    /// A vector as a form linear in the speeds (and rates).
    pub fn linear_vector(&mut self, vector: &Vector) -> MixedLinear {
        match vector {
            Vector::Components(frame, components) => {
                let Some(axes) = self.frame_axes[frame.0] else { return MixedLinear::new() };
                let mut sum = LinearVector::zero();
                for (i, component) in components.iter().enumerate() {
                    let form = self.linear_scalar(component);
                    sum = sum.add(&LinearVector::along(&form, &super::axes::unit(i)));
                }
                if sum.is_zero() { MixedLinear::new() } else { [(axes, sum)].into() }
            }
            Vector::Definition(id) => {
                let mechanism = self.mechanism;
                match &mechanism.definitions[id.0].value {
                    DefinitionValue::Vector(value) => self.linear_vector(value),
                    DefinitionValue::Scalar(_) => MixedLinear::new(),
                }
            }
            Vector::Neg(inner) => scale_linear(&Expr::integer(-1), &self.linear_vector(inner)),
            Vector::Add(terms) => {
                terms.iter().fold(MixedLinear::new(), |sum, t| add_linear(&sum, &self.linear_vector(t)))
            }
            Vector::Scale(k, v) => {
                let (k, v) = (self.linear_scalar(k), self.linear_vector(v));
                if k.terms.is_empty() {
                    return scale_linear(&k.rest, &v);
                }
                let along = v.into_iter().map(|(axes, v)| (axes, LinearVector::along(&k, &v.rest)));
                along.filter(|(_, v)| !v.is_zero()).collect()
            }
            Vector::Cross(a, b) => {
                let (a, b) = (self.linear_vector(a), self.linear_vector(b));
                if a.is_empty() || b.is_empty() {
                    return MixedLinear::new();
                }
                let axes = self.meeting(a.keys().copied(), b.keys().copied());
                let (a, b) = (self.express_linear(&a, axes), self.express_linear(&b, axes));
                let product = if b.terms.is_empty() {
                    a.map(|p| linear_forms::cross(p, &b.rest))
                } else {
                    b.map(|p| linear_forms::cross(&a.rest, p))
                };
                if product.is_zero() { MixedLinear::new() } else { [(axes, product)].into() }
            }
            Vector::Velocity(point) => self.linear_velocity(*point),
            Vector::AngularVelocity { of, in_frame } => self.linear_angular_velocity(*of, *in_frame),
            other => constant(&self.vector(other)),
        }
    }
}

/// The vector, if the form is free of unknowns.
fn free(form: &MixedLinear) -> Option<Mixed> {
    form.iter().map(|(&axes, v)| v.terms.is_empty().then(|| (axes, v.rest.clone()))).collect()
}

fn mentions_motion(mechanism: &Mechanism, scalar: &Scalar) -> bool {
    match scalar {
        Scalar::Speed(_) | Scalar::Rate(_) => true,
        Scalar::Definition(id) => match &mechanism.definitions[id.0].value {
            DefinitionValue::Scalar(value) => mentions_motion(mechanism, value),
            DefinitionValue::Vector(value) => vector_mentions_motion(mechanism, value),
        },
        Scalar::Neg(a) => mentions_motion(mechanism, a),
        Scalar::Add(parts) | Scalar::Mul(parts) | Scalar::Call(_, parts) => {
            parts.iter().any(|part| mentions_motion(mechanism, part))
        }
        Scalar::Div(a, b, _) | Scalar::Pow(a, b) => {
            mentions_motion(mechanism, a) || mentions_motion(mechanism, b)
        }
        Scalar::Dot(a, b) => vector_mentions_motion(mechanism, a) || vector_mentions_motion(mechanism, b),
        Scalar::Norm(a) => vector_mentions_motion(mechanism, a),
        _ => false,
    }
}

fn vector_mentions_motion(mechanism: &Mechanism, vector: &Vector) -> bool {
    match vector {
        Vector::Velocity(_) | Vector::AngularVelocity { .. } => true,
        Vector::Definition(id) => match &mechanism.definitions[id.0].value {
            DefinitionValue::Scalar(value) => mentions_motion(mechanism, value),
            DefinitionValue::Vector(value) => vector_mentions_motion(mechanism, value),
        },
        Vector::Components(_, parts) => parts.iter().any(|part| mentions_motion(mechanism, part)),
        Vector::Neg(a) | Vector::Unit(a, _) => vector_mentions_motion(mechanism, a),
        Vector::Add(parts) => parts.iter().any(|part| vector_mentions_motion(mechanism, part)),
        Vector::Scale(k, v) => mentions_motion(mechanism, k) || vector_mentions_motion(mechanism, v),
        Vector::Cross(a, b) => vector_mentions_motion(mechanism, a) || vector_mentions_motion(mechanism, b),
        Vector::Zero | Vector::Position { .. } => false,
    }
}
