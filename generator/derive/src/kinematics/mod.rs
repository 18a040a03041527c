//! Kinematics: axes, angular velocities and velocities as forms linear in the generalised speeds.
//!
//! The forms are kept as a graph of small relations, one per frame (`angular velocity = that of another frame + sum
//! of a_r u_r`) and one per point (`velocity = that of another point + angular velocity x arm + sum of
//! b_r u_r`). Partial velocities, mass matrix and generalised forces are computed by passing along that
//! graph, so that their cost is nearly linear in the number of bodies.
//!
//! Theory: docs/theory.md, section 16.1.

pub mod axes;
pub mod constraints;
pub mod equations;
pub mod evaluate;
pub mod frames;
pub mod linear_forms;
pub mod motion;
pub mod partial_velocities;
pub mod points;
pub mod rates;
pub mod solve;
pub mod vectors;

use std::collections::BTreeMap;

use crate::algebra::{Direction, Expr, Intermediates, Sample, SymbolId, View};
use hodograph_model::diagnostics::{Code, Diagnostic};
use hodograph_model::model::mechanism::{FrameId, Mechanism, PointId};
use hodograph_model::span::Span;
use hodograph_program::program::graph::Input;

use axes::{AxesId, AxesTree};
use linear_forms::{LinearScalar, LinearVector, Triple};

/// Why a model cannot be derived: a mistake that only the derivation can find.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeriveError {
    /// its kind
    pub code: Code,
    /// the place in the model
    pub span: Span,
    /// the mistake
    pub message: String,
    /// the remedy
    pub help: String,
}

impl DeriveError {
    /// The mistake in the form of other mistakes of a model.
    pub fn diagnostic(&self) -> Diagnostic {
        Diagnostic::new(self.code, self.span, self.message.clone()).help(self.help.clone())
    }
}

impl std::fmt::Display for DeriveError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}: {} ({})", self.message, self.help, self.code)
    }
}

impl std::error::Error for DeriveError {}

/// A value that must not vanish.
#[derive(Clone, Debug)]
pub struct GuardedValue {
    /// the value
    pub value: Expr,
    /// the scale for comparison
    pub scale: Expr,
    /// the error if it vanishes
    pub message: String,
}

/// Angular velocity of a frame: that of `base`, plus `relative` in the axes `home`.
#[derive(Clone, Debug)]
pub struct FrameMotion {
    /// the frame it is relative to
    pub base: FrameId,
    /// axes of `relative` and of every quantity that belongs to this angular velocity
    pub home: AxesId,
    /// partial angular velocities
    pub relative: LinearVector,
}

/// A lever arm: `angular velocity of frame x arm` is part of a velocity.
#[derive(Clone, Debug)]
pub struct Arm {
    /// the frame whose angular velocity is multiplied
    pub frame: FrameId,
    /// axes of `arm`
    pub axes: AxesId,
    /// the arm, m
    pub arm: Triple,
}

/// Velocity of a point: that of `base`, plus the arms' part, plus `relative`.
#[derive(Clone, Debug)]
pub struct PointMotion {
    /// the reference point; `None`: none
    pub base: Option<PointId>,
    /// lever arms
    pub arms: Vec<Arm>,
    /// further partial velocities, by axes
    pub relative: Vec<(AxesId, LinearVector)>,
    /// axes along which the value of the velocity is stored
    pub home: AxesId,
}

/// A vector as a sum of components along several sets of axes.
pub type Mixed = BTreeMap<AxesId, Triple>;

/// A linear form as a sum of components along several sets of axes.
pub type MixedLinear = BTreeMap<AxesId, LinearVector>;

/// The kinematics of a mechanism.
pub struct Kinematics<'m> {
    /// the mechanism
    pub mechanism: &'m Mechanism,
    /// all symbols
    pub z: Intermediates,
    /// all axes
    pub tree: AxesTree,
    /// the axes of each frame; `None`: made by `spin`
    pub frame_axes: Vec<Option<AxesId>>,
    /// symbols of the coordinates
    pub coordinates: Vec<SymbolId>,
    /// symbols of the speeds, independent and dependent
    pub speeds: Vec<SymbolId>,
    /// rates of the coordinates as forms: while kinematical equations are set up each rate is an unknown of
    /// its own (slots after those of the speeds), afterwards they are forms in the speeds
    pub rates: Vec<LinearScalar>,
    /// whether the rates have been determined
    pub solved: bool,
    /// the time derivatives of all symbols at constant speeds; valid once the rates are determined
    pub time: Direction,
    /// per frame, once the rates are determined
    pub frames: Vec<FrameMotion>,
    /// per point, once the rates are determined
    pub points: Vec<PointMotion>,
    /// a mistake that was met where a value was computed
    pub mistake: Option<DeriveError>,
    /// dependent speeds as forms in independent ones: slot -> form
    pub dependent: BTreeMap<usize, LinearScalar>,
    /// derivatives of the dependent speeds while those of the independent ones are 0
    pub dependent_bias: BTreeMap<usize, Expr>,
    /// values that must not vanish
    pub guards: Vec<GuardedValue>,
    /// random states for deciding what is identically 0
    pub samples: Vec<Sample>,
    partials: BTreeMap<SymbolId, Vec<(usize, Expr)>>,
    definitions: evaluate::Definitions,
    /// the part of the model that is being evaluated, for messages about divisors
    place: String,
    used_axes: Vec<bool>,
    angular_values: BTreeMap<FrameId, Triple>,
    velocity_values: BTreeMap<PointId, (AxesId, Triple)>,
}

impl<'m> Kinematics<'m> {
    /// Sets up the kinematics: solves the kinematical equations for the rates and the constraints for the
    /// dependent speeds.
    pub fn new(mechanism: &'m Mechanism) -> Result<Self, DeriveError> {
        let mut z = Intermediates::default();
        z.pi();
        let time = z.input_symbol(Input::Time);
        for i in 0..mechanism.parameters.len() {
            z.input(Input::Parameter(i as u32));
        }
        for i in 0..mechanism.inputs.len() {
            z.input(Input::Input(i as u32));
        }
        let coordinates: Vec<_> =
            (0..mechanism.coordinates.len()).map(|i| z.input_symbol(Input::Coordinate(i as u32))).collect();
        let mut independent = 0;
        let speeds: Vec<_> = mechanism
            .speeds
            .iter()
            .map(|speed| {
                if speed.dependent {
                    return z.unknown();
                }
                independent += 1;
                z.input_symbol(Input::Speed(independent - 1))
            })
            .collect();
        let slots = mechanism.speeds.len();
        let rates = (0..coordinates.len()).map(|i| LinearScalar::unknown(slots + i)).collect();
        let mut kinematics = Kinematics {
            mechanism,
            z,
            tree: AxesTree::new(),
            frame_axes: Vec::new(),
            coordinates,
            speeds,
            rates,
            solved: false,
            time: Direction::new([(time, Expr::one())]),
            frames: Vec::new(),
            points: Vec::new(),
            mistake: None,
            dependent: BTreeMap::new(),
            dependent_bias: BTreeMap::new(),
            guards: Vec::new(),
            samples: equations::samples(mechanism),
            partials: BTreeMap::new(),
            definitions: evaluate::Definitions::new(mechanism),
            place: "an equation".to_string(),
            used_axes: frames::used_axes(mechanism),
            angular_values: BTreeMap::new(),
            velocity_values: BTreeMap::new(),
        };
        kinematics.orient()?;
        kinematics.find_rates()?;
        kinematics.find_motion()?;
        kinematics.find_dependent_speeds()?;
        Ok(kinematics)
    }

    /// A speed as an expression.
    pub fn speed(&self, slot: usize) -> Expr {
        Expr::symbol(self.speeds[slot])
    }

    /// The value of a form in the speeds.
    pub fn value(&self, form: &LinearScalar) -> Expr {
        form.terms.iter().fold(form.rest.clone(), |sum, (&slot, c)| sum.add(&c.mul(&self.speed(slot))))
    }

    /// The value of a vector form in the speeds.
    pub fn vector_value(&self, form: &LinearVector) -> Triple {
        form.terms.iter().fold(form.rest.clone(), |sum, (&slot, p)| {
            linear_forms::add(&sum, &linear_forms::scale(&self.speed(slot), p))
        })
    }

    /// The rate of an expression that is free of speeds, as a form.
    pub fn rate_of(&mut self, expr: &Expr) -> LinearScalar {
        let mut result = LinearScalar::constant(Expr::zero());
        for (what, partial) in self.partial_derivatives(expr) {
            let rate = match what.checked_sub(1) {
                None => LinearScalar::constant(Expr::one()),
                Some(i) => self.rates[i].clone(),
            };
            result = result.add(&rate.scale(&partial));
        }
        result
    }

    /// Partial derivatives with respect to time (0) and coordinates (1 + number), those that are not 0.
    fn partial_derivatives(&mut self, expr: &Expr) -> Vec<(usize, Expr)> {
        let key = expr.as_symbol();
        if let Some(known) = key.and_then(|symbol| self.partials.get(&symbol)) {
            return known.clone();
        }
        let time = self.z.input_symbol(Input::Time);
        let all: Vec<SymbolId> = std::iter::once(time).chain(self.coordinates.iter().copied()).collect();
        let mut result = Vec::new();
        for (what, &symbol) in all.iter().enumerate() {
            if self.z.depends(expr, &mut |s| s == symbol) {
                let partial = self.z.differentiate(expr, &mut Direction::along(symbol));
                if !partial.is_zero() {
                    result.push((what, partial));
                }
            }
        }
        if let Some(symbol) = key {
            self.partials.insert(symbol, result.clone());
        }
        result
    }

    /// The time derivative of an expression free of speeds (the value of its rate).
    pub fn change(&mut self, expr: &Expr) -> Expr {
        let mut time = std::mem::take(&mut self.time);
        let rate = self.z.differentiate(expr, &mut time);
        self.time = time;
        rate
    }

    /// The time derivatives of components free of speeds, with constant axes.
    pub fn change_of(&mut self, v: &Triple) -> Triple {
        let rates = std::array::from_fn(|i| self.change(&v[i]));
        linear_forms::name(&mut self.z, rates)
    }

    /// Runs `work` for a named part of the model; messages about divisors then name that part.
    pub fn within<R>(&mut self, place: String, work: impl FnOnce(&mut Self) -> R) -> R {
        let outer = std::mem::replace(&mut self.place, place);
        let result = work(self);
        self.place = outer;
        result
    }

    /// Adds a guard: the value must not vanish.
    pub fn guard(&mut self, value: &Expr, message: impl Into<String>) {
        let message = message.into();
        for factor in factors(value) {
            self.guard_factor(&factor, message.clone());
        }
    }

    /// Adds guards for the factors of a determinant. `message` describes what cannot be computed if one of
    /// them vanishes, from the names of the unknowns whose forms it divides.
    pub fn guard_determinant(
        &mut self,
        determinant: &Expr,
        unknowns: &[(String, LinearScalar)],
        message: impl Fn(&str) -> String,
    ) {
        for factor in factors(determinant) {
            let divided = |form: &LinearScalar| {
                form.terms.values().chain([&form.rest]).any(|c| self.z.is_divided_by(c, &factor))
            };
            let found: Vec<_> =
                unknowns.iter().filter(|(_, form)| divided(form)).map(|(name, _)| name.as_str()).collect();
            // If a factor is hidden in a name, any unknown may be concerned.
            let all = || unknowns.iter().map(|(name, _)| name.as_str()).collect();
            let names: Vec<&str> = if found.is_empty() { all() } else { found };
            self.guard_factor(&factor, message(&names.join(", ")));
        }
    }

    fn guard_factor(&mut self, value: &Expr, message: String) {
        if self.guards.iter().any(|guard| &guard.value == value) {
            return;
        }
        let place = self.coordinates_of(value);
        let message = match &place[..] {
            [] => message,
            [one] => format!("{message} at this {one}"),
            several => format!("{message} at these {}", several.join(", ")),
        };
        let scale = self.z.bound(value);
        self.guards.push(GuardedValue { value: value.clone(), scale, message });
    }

    /// The names of the coordinates on which an expression depends.
    fn coordinates_of(&self, expr: &Expr) -> Vec<&str> {
        let names = self.mechanism.coordinates.iter().map(|coordinate| coordinate.name.as_str());
        let depends = |symbol: SymbolId| self.z.depends(expr, &mut |s| s == symbol);
        names.zip(&self.coordinates).filter(|&(_, &symbol)| depends(symbol)).map(|(name, _)| name).collect()
    }
}

/// The factors of a value that is a divisor.
fn factors(value: &Expr) -> Vec<Expr> {
    match value.view() {
        View::Number(_) => Vec::new(),
        View::Product(parts) => parts.iter().flat_map(factors).collect(),
        View::Power(base, _) => factors(&base),
        View::Symbol(_) | View::Sum(_) => vec![value.clone()],
    }
}
