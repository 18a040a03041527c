//! Lowers kinematical equations, velocity constraints and configuration constraints.

use super::super::mechanism::{Equation, EquationSides, Scalar, Vector};
use super::super::names::Symbol;
use super::super::typed::{Typed, TypedValue};
use super::Lowering;
use super::dimensions::quantity;
use crate::diagnostics::{Diagnostic, codes};
use crate::syntax::tree::{self, ExprKind};

impl Lowering<'_> {
    pub(super) fn equations(&mut self) {
        let tree = self.tree;
        let before = self.mistakes();
        let kinematics = self.section(&tree.kinematics, "a kinematical equation", true);
        self.out.kinematics = kinematics;
        let motion = self.balances.incomplete;
        let constraints = self.section(&tree.constraints, "a constraint", true);
        self.out.constraints = constraints;
        let configuration = self.section(&tree.configuration, "a configuration equation", false);
        self.out.configuration = configuration;
        self.balances.incomplete = motion;
        let stated = tree.kinematics.len() + tree.constraints.len() + tree.configuration.len();
        let read = self.out.kinematics.len() + self.out.constraints.len() + self.out.configuration.len();
        self.readable.motion &= read == stated && self.mistakes() == before;
        self.default_rates();
        self.readable.motion &= self.mistakes() == before;
    }

    fn section(&mut self, equations: &[tree::Equation], what: &str, linear: bool) -> Vec<Equation> {
        let mut out = Vec::new();
        for equation in equations {
            if self.points_equated(equation, linear) {
                continue;
            }
            let left = self.expression(&equation.left);
            let right = self.expression(&equation.right);
            let Some((sides, fit)) = self.sides(&left, &right, what) else { continue };
            self.rate_forgotten(&left, &right, linear);
            // one mistake at a time
            for side in [&left, &right].into_iter().filter(|_| fit) {
                if linear {
                    self.need_linear(side, what);
                } else {
                    self.need_free_of_speeds(side, what);
                    self.need_rate(side, what);
                }
            }
            let empty = if linear {
                left.traits.degree == 0 && right.traits.degree == 0
            } else {
                !left.traits.moves && !right.traits.moves
            };
            if empty {
                let message =
                    format!("{what} without {}", if linear { "speeds or rates" } else { "coordinates" });
                let error = Diagnostic::new(codes::EMPTY_EQUATION, equation.span(), message);
                let error = match linear {
                    true => error.help("an equation between coordinates belongs to `configuration`"),
                    false => error.help("a configuration equation determines a dependent coordinate"),
                };
                self.report(error);
            }
            out.push(Equation { sides, span: equation.span() });
        }
        out
    }

    /// `P = Q` where their positions or velocities are meant.
    fn points_equated(&mut self, equation: &tree::Equation, linear: bool) -> bool {
        let (ExprKind::Name(p), ExprKind::Name(q)) = (&equation.left.kind, &equation.right.kind) else {
            return false;
        };
        let point = |name: &String| matches!(self.names.get(name), Some(Symbol::Point(_)));
        if !point(p) || !point(q) {
            return false;
        }
        let function = if linear { "velocity" } else { "position" };
        let error = Diagnostic::new(codes::WRONG_KIND, equation.span(), "points cannot be equated")
            .did_you_mean(&format!("{function}({p}) = {function}({q})"));
        self.report(error);
        true
    }

    /// `q1 = u1` where `d(q1)/dt = u1` is meant.
    fn rate_forgotten(&mut self, left: &Typed, right: &Typed, linear: bool) {
        let (TypedValue::Scalar(Scalar::Coordinate(q)), TypedValue::Scalar(Scalar::Speed(u))) =
            (&left.value, &right.value)
        else {
            return;
        };
        let (q, u) = (&self.out.coordinates[q.0].name, &self.out.speeds[u.0].name);
        let help = format!("did you mean `d({q})/dt = {u}`?");
        if let Some(error) = self
            .diagnostics
            .last_mut()
            .filter(|error| linear && error.code == codes::DIMENSION && error.primary.span == right.span)
        {
            error.help = Some(help);
        }
    }

    /// The two sides, and whether they are of one dimension.
    fn sides(&mut self, left: &Typed, right: &Typed, what: &str) -> Option<(EquationSides, bool)> {
        if left.is_poison() || right.is_poison() {
            return None;
        }
        let zero = |typed: &Typed| typed.is_zero();
        let sides = match (&left.value, &right.value) {
            (TypedValue::Scalar(l), TypedValue::Scalar(r)) => EquationSides::Scalar(l.clone(), r.clone()),
            (TypedValue::Vector(l), TypedValue::Vector(r)) => EquationSides::Vector(l.clone(), r.clone()),
            (TypedValue::Vector(l), _) if zero(right) => EquationSides::Vector(l.clone(), Vector::Zero),
            (_, TypedValue::Vector(r)) if zero(left) => EquationSides::Vector(Vector::Zero, r.clone()),
            _ => {
                let kind = |typed: &Typed| if typed.is_vector() { "a vector" } else { "a scalar" };
                let message = format!("{what} between {} and {}", kind(left), kind(right));
                let error = Diagnostic::new(codes::SCALAR_VECTOR, right.span, message)
                    .label(format!("this is {}", kind(right)))
                    .related(left.span, format!("this is {}", kind(left)))
                    .help("take a component with `dot(v, A.x)`");
                self.report(error);
                return None;
            }
        };
        let fit =
            self.same(left, right, |l, r| format!("{what} between {} and {}", quantity(l), quantity(r)));
        Some((sides, fit))
    }
}
