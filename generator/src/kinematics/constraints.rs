//! Solves the velocity constraints for the dependent speeds, and their time derivatives for the rates of the dependent speeds.

use super::linear_forms::LinearScalar;
use super::solve::{SolveError, Solver};
use super::{DeriveError, Kinematics};
use crate::algebra::Expr;
use crate::check::dependent_components;
use crate::diagnostics::codes;

impl Kinematics<'_> {
    /// Solves the constraints for the dependent speeds, and their time derivatives for those of the dependent speeds.
    pub(super) fn find_dependent_speeds(&mut self) -> Result<(), DeriveError> {
        let mechanism = self.mechanism;
        let mut equations = Vec::new();
        let mut entangled = None;
        for equation in mechanism.constraints_of_dependent_speeds() {
            let forms = self.equation_forms(&equation.sides);
            if self.rank(&forms) < forms.len() {
                entangled = entangled.or(Some(equation));
            }
            equations.extend(forms.into_iter().map(|form| form.map(|c| self.z.name(c.clone()))));
        }
        let unknowns: Vec<usize> =
            (0..mechanism.speeds.len()).filter(|&slot| mechanism.speeds[slot].dependent).collect();
        if let Some(equation) = entangled {
            let found = dependent_components(equation.span);
            return Err(DeriveError {
                code: found.code,
                span: equation.span,
                message: found.message,
                help: found.help.unwrap_or_default(),
            });
        }
        if equations.len() != unknowns.len() {
            let span = mechanism.constraints.first().map_or_else(Default::default, |equation| equation.span);
            return Err(DeriveError {
                code: codes::CONSTRAINT_COUNT,
                span,
                message: format!(
                    "the constraints amount to {}, but there {}",
                    count(equations.len(), "equation"),
                    if unknowns.len() == 1 {
                        "is 1 dependent speed".to_owned()
                    } else {
                        format!("are {} dependent speeds", unknowns.len())
                    }
                ),
                help: "declare as many speeds in `dependent` as there are independent constraints".into(),
            });
        }
        let solver = Solver::new(&mut self.z, &mut self.samples, &equations, &unknowns).map_err(|error| {
            let (code, slot, what) = match &error {
                SolveError::Undetermined(slot) => {
                    (codes::CONSTRAINT_SINGULAR, *slot, "no constraint determines")
                }
                SolveError::Dependent(block) => (
                    codes::CONSTRAINT_SINGULAR,
                    block[0],
                    "the constraints repeat each other; they do not determine",
                ),
                SolveError::TooLarge(block) => {
                    (codes::TOO_LARGE, block[0], "too many constraints hang together, among them that of")
                }
            };
            DeriveError {
                code,
                span: mechanism.speeds[slot].span,
                message: format!("{what} the dependent speed `{}`", mechanism.speeds[slot].name),
                help: "make another speed dependent, or state the constraint that is missing".into(),
            }
        })?;
        let z = &mut self.z;
        self.dependent = solver.solve(&equations, |c| z.name(c));
        let forms: Vec<(String, LinearScalar)> = self
            .dependent
            .iter()
            .map(|(&slot, form)| (mechanism.speeds[slot].name.clone(), form.clone()))
            .collect();
        for determinant in &solver.determinants {
            self.guard_determinant(determinant, &forms, |names| {
                format!("the constraints cannot be solved for {names}")
            });
        }
        for (&slot, form) in &self.dependent.clone() {
            let value = self.value(form);
            self.z.define(self.speeds[slot], value);
        }
        // d/dt (sum J u + j) = sum J u' + (sum J' u + j') = 0, for u' of the independent speeds 0.
        let changes: Vec<LinearScalar> = equations
            .iter()
            .map(|form| {
                let mut change = self.change(&form.rest);
                for (&slot, coefficient) in &form.terms {
                    let rate = self.change(coefficient);
                    change = change.add(&rate.mul(&self.speed(slot)));
                }
                let mut bias = LinearScalar::constant(self.z.name(change));
                bias.terms = form.terms.iter().map(|(&slot, c)| (slot, c.clone())).collect();
                bias.terms.retain(|slot, _| unknowns.contains(slot));
                bias
            })
            .collect();
        let z = &mut self.z;
        let biases = solver.solve(&changes, |c| z.name(c));
        self.dependent_bias = biases.into_iter().map(|(slot, form)| (slot, form.rest)).collect();
        Ok(())
    }

    /// Coefficient of an independent speed in a dependent one.
    pub fn dependence(&self, dependent: usize, independent: usize) -> Expr {
        self.dependent.get(&dependent).map_or_else(Expr::zero, |form| form.coefficient(independent))
    }
}

fn count(n: usize, word: &str) -> String {
    format!("{n} {word}{}", if n == 1 { "" } else { "s" })
}
