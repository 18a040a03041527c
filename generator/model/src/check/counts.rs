//! Checks that there are as many equations as unknowns, as far as counting shows.

use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;

/// Mistakes in the numbers of equations.
pub fn counts(m: &Mechanism) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let speeds: Vec<&Variable> = m.speeds.iter().filter(|u| u.dependent).collect();
    let coordinates: Vec<&Variable> = m.coordinates.iter().filter(|q| q.dependent).collect();
    let constraint = Case {
        equations: &m.constraints,
        unknowns: &speeds,
        code: codes::CONSTRAINT_COUNT,
        equation: "constraint",
        unknown: "dependent speed",
        section: "constraints",
        declare: "declare a speed under `dependent` for each constraint",
    };
    let configuration = Case {
        equations: &m.configuration,
        unknowns: &coordinates,
        code: codes::CONFIGURATION_COUNT,
        equation: "configuration equation",
        unknown: "dependent coordinate",
        section: "configuration",
        declare: "put `dependent` before a coordinate for each equation",
    };
    if m.determining_constraints.is_none() {
        out.extend(constraint.check());
    }
    out.extend(configuration.check());
    out
}

struct Case<'a> {
    equations: &'a [Equation],
    unknowns: &'a [&'a Variable],
    code: crate::diagnostics::Code,
    equation: &'a str,
    unknown: &'a str,
    section: &'a str,
    declare: &'a str,
}

impl Case<'_> {
    /// A vector equation counts from one to three.
    fn check(&self) -> Option<Diagnostic> {
        let vectors = self.equations.iter().filter(|e| matches!(e.sides, EquationSides::Vector(..))).count();
        let (least, most) = (self.equations.len(), self.equations.len() + 2 * vectors);
        let unknowns = self.unknowns.len();
        let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
        if least > unknowns {
            let last = self.equations.last()?;
            let message = format!("{} for {}", plural(least, self.equation), plural(unknowns, self.unknown));
            return Some(Diagnostic::new(self.code, last.span, message).help(self.declare));
        }
        if most < unknowns {
            let last = self.unknowns.last()?;
            let message = format!("{} for {}", plural(most, self.equation), plural(unknowns, self.unknown));
            let help =
                format!("add {}s under `{}`, or declare fewer dependent ones", self.equation, self.section);
            return Some(Diagnostic::new(self.code, last.span, message).help(help));
        }
        None
    }
}
