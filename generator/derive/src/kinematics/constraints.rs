//! Solves the velocity constraints for the dependent speeds, and their time derivatives for the rates of the
//! dependent speeds.

use super::linear_forms::LinearScalar;
use super::solve::{SolveError, Solver};
use super::{DeriveError, Kinematics};
use crate::algebra::Expr;
use hodograph_model::check::dependent_components;
use hodograph_model::diagnostics::codes;
use hodograph_model::model::mechanism::Mechanism;

impl Kinematics<'_> {
    /// Solves the constraints for the dependent speeds, and their time derivatives for those of the dependent
    /// speeds.
    pub(super) fn find_dependent_speeds(&mut self) -> Result<(), DeriveError> {
        let mechanism = self.mechanism;
        let equations = self.constraint_forms()?;
        let unknowns: Vec<usize> =
            (0..mechanism.speeds.len()).filter(|&slot| mechanism.speeds[slot].dependent).collect();
        if equations.len() != unknowns.len() {
            return Err(wrong_count(mechanism, equations.len(), unknowns.len()));
        }
        let solver = Solver::new(&mut self.z, &mut self.samples, &equations, &unknowns)
            .map_err(|error| unsolved(mechanism, &error))?;
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
        let changes = self.constraint_changes(&equations, &unknowns);
        let z = &mut self.z;
        let biases = solver.solve(&changes, |c| z.name(c));
        self.dependent_bias = biases.into_iter().map(|(slot, form)| (slot, form.rest)).collect();
        Ok(())
    }

    /// The constraints that determine the dependent speeds, as forms in all speeds; an error if the
    /// components of one are dependent.
    fn constraint_forms(&mut self) -> Result<Vec<LinearScalar>, DeriveError> {
        let mut equations = Vec::new();
        let mut repeated = None;
        for equation in self.mechanism.constraints_of_dependent_speeds() {
            let forms = self.equation_forms(&equation.sides);
            if self.rank(&forms) < forms.len() {
                repeated = repeated.or(Some(equation.span));
            }
            equations.extend(forms.into_iter().map(|form| form.map(|c| self.z.name(c.clone()))));
        }
        match repeated {
            None => Ok(equations),
            Some(span) => {
                let found = dependent_components(span);
                let (code, message, help) = (found.code, found.message, found.help.unwrap_or_default());
                Err(DeriveError { code, span, message, help })
            }
        }
    }

    /// The time derivatives of the constraints `sum J u + j = 0`, that is `sum J u' + (sum J' u + j') = 0`
    /// with u' = 0 of the independent speeds: forms in the rates of the dependent ones.
    fn constraint_changes(&mut self, equations: &[LinearScalar], unknowns: &[usize]) -> Vec<LinearScalar> {
        let mut changes = Vec::new();
        for form in equations {
            let mut change = self.change(&form.rest);
            for (&slot, coefficient) in &form.terms {
                let rate = self.change(coefficient);
                change = change.add(&rate.mul(&self.speed(slot)));
            }
            let mut bias = LinearScalar::constant(self.z.name(change));
            bias.terms = form.terms.iter().map(|(&slot, c)| (slot, c.clone())).collect();
            bias.terms.retain(|slot, _| unknowns.contains(slot));
            changes.push(bias);
        }
        changes
    }

    /// Coefficient of an independent speed in a dependent one.
    pub fn dependence(&self, dependent: usize, independent: usize) -> Expr {
        self.dependent.get(&dependent).map_or_else(Expr::zero, |form| form.coefficient(independent))
    }
}

/// There are more or fewer constraints than dependent speeds.
fn wrong_count(mechanism: &Mechanism, equations: usize, unknowns: usize) -> DeriveError {
    let speeds = match unknowns {
        1 => "is 1 dependent speed".to_owned(),
        n => format!("are {n} dependent speeds"),
    };
    DeriveError {
        code: codes::CONSTRAINT_COUNT,
        span: mechanism.constraints.first().map_or_else(Default::default, |equation| equation.span),
        message: format!("the constraints amount to {}, but there {speeds}", count(equations, "equation")),
        help: "declare as many speeds in `dependent` as there are independent constraints".into(),
    }
}

/// The constraints cannot be solved for the dependent speeds in any state.
fn unsolved(mechanism: &Mechanism, error: &SolveError) -> DeriveError {
    let (code, slot, what) = match error {
        SolveError::Undetermined(slot) => (codes::CONSTRAINT_SINGULAR, *slot, "no constraint determines"),
        SolveError::Dependent(block) => {
            (codes::CONSTRAINT_SINGULAR, block[0], "the constraints repeat each other; they do not determine")
        }
        SolveError::TooLarge(block) => {
            (codes::TOO_LARGE, block[0], "too many constraints hang together, among them that of")
        }
    };
    let speed = &mechanism.speeds[slot];
    DeriveError {
        code,
        span: speed.span,
        message: format!("{what} the dependent speed `{}`", speed.name),
        help: "make another speed dependent, or state the constraint that is missing".into(),
    }
}

fn count(n: usize, word: &str) -> String {
    format!("{n} {word}{}", if n == 1 { "" } else { "s" })
}
