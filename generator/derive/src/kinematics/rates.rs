//! Solves the kinematical equations for the rates of the coordinates.

use super::linear_forms::LinearScalar;
use super::solve::{SolveError, Solver};
use super::vectors::{add_linear, scale_linear};
use super::{DeriveError, Kinematics, MixedLinear};
use crate::algebra::{Direction, Expr, size};
use hodograph_model::diagnostics::codes;
use hodograph_model::model::mechanism::{FrameId, Orientation, Place, PointId};
use hodograph_model::number::Number;
use hodograph_model::span::Span;
use hodograph_program::program::graph::Input;

/// Coefficients of kinematical equations up to this size are written out, for what their sines and cosines
/// cancel.
const OPEN: usize = 24;

impl Kinematics<'_> {
    /// Solves the kinematical equations for the rates of the coordinates.
    pub(super) fn find_rates(&mut self) -> Result<(), DeriveError> {
        let mechanism = self.mechanism;
        let slots = mechanism.speeds.len();
        let quaternions = self.quaternion_rates()?;
        let mut equations = self.stated_equations();
        self.push_defaults(&quaternions, &mut equations)?;

        let quaternion = |slot: usize| quaternions.get(slot.wrapping_sub(slots)).and_then(Option::as_ref);
        let forms: Vec<LinearScalar> = equations
            .iter()
            .map(|(form, _)| form.substitute(|slot| quaternion(slot).cloned()))
            .map(|form| {
                form.map(|c| {
                    let open = self.z.opened(c, OPEN);
                    self.z.simplify(&open)
                })
            })
            .filter(|form| form.terms.keys().any(|&slot| slot >= slots))
            .collect();
        let unknowns: Vec<usize> =
            (0..self.coordinates.len()).filter(|&i| quaternions[i].is_none()).map(|i| slots + i).collect();
        let forms =
            if forms.len() > unknowns.len() { self.without_repetitions(forms, &unknowns) } else { forms };
        let solver = Solver::new(&mut self.z, &mut self.samples, &forms, &unknowns)
            .map_err(|error| self.rates_error(error, slots))?;
        let z = &mut self.z;
        let solved = solver.solve(&forms, |c| {
            let short = z.simplify(&c);
            if size(&short) > 12 { z.name(short) } else { short }
        });
        for (slot, form) in solved {
            self.rates[slot - slots] = form;
        }
        let of_quaternions: Vec<usize> =
            (0..quaternions.len()).filter(|&i| quaternions[i].is_some()).collect();
        for (i, quaternion) in quaternions.into_iter().enumerate() {
            if let Some(form) = quaternion {
                self.rates[i] = form;
            }
        }
        // A quaternion relative to a frame that turns by a coordinate changes with the rate of that, too.
        for &i in of_quaternions.iter().cycle().take(of_quaternions.len().pow(2)) {
            let rates = &self.rates;
            if rates[i].terms.keys().any(|&slot| slot >= slots) {
                let known = |slot: usize| slot.checked_sub(slots).map(|rate| rates[rate].clone());
                self.rates[i] = rates[i].substitute(known);
            }
        }
        self.set_time_derivative();
        let rates: Vec<(String, LinearScalar)> = unknowns
            .iter()
            .map(|slot| (mechanism.coordinates[slot - slots].name.clone(), self.rates[slot - slots].clone()))
            .collect();
        for determinant in &solver.determinants {
            self.guard_determinant(determinant, &rates, |names| {
                format!("the kinematical equations cannot be solved for the rate of {names}")
            });
        }
        self.partials.clear();
        self.solved = true;
        self.definitions.clear();
        Ok(())
    }

    /// What the model states: kinematical equations, and motions of frames and points that have an
    /// orientation or a position too, whose derivative must agree. Each form is zero, and has its place
    /// in the model.
    fn stated_equations(&mut self) -> Vec<(LinearScalar, Span)> {
        let mechanism = self.mechanism;
        let mut equations = Vec::new();
        for equation in &mechanism.kinematics {
            let forms = self.equation_forms(&equation.sides);
            equations.extend(forms.into_iter().map(|form| (form, equation.span)));
        }
        for (id, frame) in mechanism.frames.iter().enumerate() {
            let Some((base, declared)) = &frame.angular_velocity else { continue };
            if matches!(frame.orientation, Orientation::Quaternion(_)) {
                continue;
            }
            let declared = self.linear_vector(declared);
            let own = self.derived_angular_velocity(FrameId(id));
            let of_base = self.derived_angular_velocity(*base);
            let home = self.home_axes(FrameId(id));
            let difference =
                add_linear(&own, &scale_linear(&Expr::integer(-1), &add_linear(&of_base, &declared)));
            self.push_components(&difference, home, frame.span, &mut equations);
        }
        for (id, point) in mechanism.points.iter().enumerate() {
            let (Some(declared), Place::Offset { .. } | Place::Material { .. }) =
                (&point.velocity, &point.place)
            else {
                continue;
            };
            let own = self.derived_velocity(PointId(id));
            let declared = self.linear_vector(declared);
            let axes = own.keys().next().copied().unwrap_or(0);
            let difference = add_linear(&own, &scale_linear(&Expr::integer(-1), &declared));
            self.push_components(&difference, axes, point.span, &mut equations);
        }
        equations
    }

    /// The forms that are independent, in the unknowns, of those before them. `check` has seen that the others
    /// follow from these.
    fn without_repetitions(&mut self, forms: Vec<LinearScalar>, unknowns: &[usize]) -> Vec<LinearScalar> {
        let in_unknowns = |form: &LinearScalar| {
            let mut form = form.clone();
            form.terms.retain(|slot, _| unknowns.contains(slot));
            LinearScalar { rest: Expr::zero(), ..form }
        };
        let (mut kept, mut left): (Vec<LinearScalar>, Vec<LinearScalar>) = (Vec::new(), Vec::new());
        for form in forms {
            left.push(in_unknowns(&form));
            if self.rank(&left) < left.len() {
                left.pop();
            } else {
                kept.push(form);
            }
        }
        kept
    }

    /// The direction of the time derivative: time by 1, each coordinate by its rate.
    fn set_time_derivative(&mut self) {
        let mut directions = vec![(self.z.input_symbol(Input::Time), Expr::one())];
        for i in 0..self.coordinates.len() {
            let value = self.value(&self.rates[i].clone());
            let value = self.z.name(value);
            directions.push((self.coordinates[i], value));
        }
        self.time = Direction::new(directions);
    }

    fn push_components(
        &mut self,
        difference: &MixedLinear,
        axes: usize,
        span: Span,
        equations: &mut Vec<(LinearScalar, Span)>,
    ) {
        let form = self.express_linear(difference, axes);
        equations.extend(self.components(&form).into_iter().map(|component| (component, span)));
    }

    /// Rates of quaternion coordinates: e' = 1/2 E(e) w, with the stated angular velocity w in the parent.
    fn quaternion_rates(&mut self) -> Result<Vec<Option<LinearScalar>>, DeriveError> {
        let mechanism = self.mechanism;
        let mut rates = vec![None; self.coordinates.len()];
        for (id, frame) in mechanism.frames.iter().enumerate() {
            let Orientation::Quaternion(parts) = &frame.orientation else { continue };
            let Some((base, declared)) = &frame.angular_velocity else {
                self.derived_relative(FrameId(id))?;
                continue;
            };
            let declared = self.linear_vector(declared);
            let of_base = self.derived_angular_velocity(*base);
            let parent = self.derived_angular_velocity(frame.parent.unwrap_or(FrameId::N));
            let relative =
                add_linear(&add_linear(&declared, &of_base), &scale_linear(&Expr::integer(-1), &parent));
            let axes = self.frame_axes[id].unwrap_or(0);
            let w = self.express_linear(&relative, axes);
            let w: [LinearScalar; 3] = std::array::from_fn(|i| w.component(i));
            let e = parts.map(|part| Expr::symbol(self.coordinates[part.0]));
            let half = Expr::number(&Number::ratio(1, 2));
            // rows of E: w' = -(x, y, z).w, vector part' = (w 1 + [v]x) w
            let rows: [[Expr; 3]; 4] = [
                [e[1].neg(), e[2].neg(), e[3].neg()],
                [e[0].clone(), e[3].neg(), e[2].clone()],
                [e[3].clone(), e[0].clone(), e[1].neg()],
                [e[2].neg(), e[1].clone(), e[0].clone()],
            ];
            for (part, row) in parts.iter().zip(rows) {
                let sum = row
                    .iter()
                    .zip(&w)
                    .fold(LinearScalar::constant(Expr::zero()), |sum, (k, w)| sum.add(&w.scale(k)));
                rates[part.0] = Some(sum.scale(&half));
            }
        }
        Ok(rates)
    }

    /// `d(q..)/dt = u..` for coordinates of which nothing else is said.
    fn push_defaults(
        &mut self,
        quaternions: &[Option<LinearScalar>],
        equations: &mut Vec<(LinearScalar, Span)>,
    ) -> Result<(), DeriveError> {
        let mechanism = self.mechanism;
        let slots = mechanism.speeds.len();
        for (i, coordinate) in mechanism.coordinates.iter().enumerate() {
            let said = equations.iter().any(|(form, _)| form.terms.contains_key(&(slots + i)));
            if said || quaternions[i].is_some() {
                continue;
            }
            let speed = coordinate.name.strip_prefix('q').map(|rest| format!("u{rest}"));
            let speed = mechanism.speeds.iter().position(|s| Some(&s.name) == speed.as_ref());
            let Some(speed) = speed else {
                return Err(DeriveError {
                    code: codes::NO_RATE,
                    span: coordinate.span,
                    message: format!("nothing says how coordinate `{}` changes", coordinate.name),
                    help: format!("add `d({})/dt = ..;` to `kinematics`", coordinate.name),
                });
            };
            let form = LinearScalar::unknown(slots + i).sub(&LinearScalar::unknown(speed));
            equations.push((form, coordinate.span));
        }
        Ok(())
    }

    fn rates_error(&self, error: SolveError, slots: usize) -> DeriveError {
        let coordinate = |slot: usize| &self.mechanism.coordinates[slot - slots];
        let (slot, message, help) = match &error {
            SolveError::Undetermined(slot) => {
                (*slot, "the kinematical equations do not determine the rate of", "add an equation for it")
            }
            SolveError::Dependent(block) => (
                block[0],
                "the kinematical equations contradict or repeat each other; they cannot be solved for the rate of",
                "state each rate once",
            ),
            SolveError::TooLarge(block) => (
                block[0],
                "too many kinematical equations hang together, among them that of",
                "separate them",
            ),
        };
        let code = match error {
            SolveError::TooLarge(_) => codes::TOO_LARGE,
            _ => codes::KINEMATICS_SINGULAR,
        };
        DeriveError {
            code,
            span: coordinate(slot).span,
            message: format!("{message} `{}`", coordinate(slot).name),
            help: help.into(),
        }
    }
}
