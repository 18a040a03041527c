//! Reports vector constraints with dependent components for which no frame separates them: the derivation
//! needs axes along which the redundant components are identically 0.

use super::states::Seen;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::{EquationSides, Mechanism};
use crate::numeric;
use crate::span::Span;

/// What is nothing beside the other entries of a matrix.
const NOISE: f64 = 1e-9;

/// Three rows, along three axes: coefficients of the speeds, and what is free of them.
type Rows = [Vec<f64>; 3];

/// The vector constraints that no frame takes apart, by what they are at some states.
pub fn inseparable(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    if m.determining_constraints.is_some() {
        return out;
    }
    let at: Option<Vec<Vec<Vec<f64>>>> =
        seen.iter().map(|seen| numeric::constraint_coefficients(m, seen.state).ok()).collect();
    let Some(at) = at else { return out };
    let mut first = 0;
    for equation in &m.constraints {
        let EquationSides::Vector(..) = equation.sides else {
            first += 1;
            continue;
        };
        let along_n: Vec<Rows> = at
            .iter()
            .map(|rows| std::array::from_fn(|i| rows.get(first + i).cloned().unwrap_or_default()))
            .collect();
        first += 3;
        let rank = along_n.iter().map(|rows| numeric::rank(rows.to_vec())).max().unwrap_or(3);
        let fits = |frame: usize| {
            let turned: Option<Vec<Rows>> = along_n
                .iter()
                .zip(seen)
                .map(|(rows, seen)| {
                    seen.at.orientations.get(frame).copied().flatten().map(|axes| turned(rows, &axes))
                })
                .collect();
            turned.is_some_and(|turned| components(&turned) <= rank)
        };
        if rank < 3 && components(&along_n) > rank && !(0..m.frames.len()).any(fits) {
            out.push(dependent_components(equation.span));
        }
    }
    out
}

/// A vector equation whose components depend on each other along the axes of all frames.
pub fn dependent_components(span: Span) -> Diagnostic {
    let message = "the components of this equation depend on each other, and along the axes of no frame is one of them identically 0";
    let help = "orient a frame along the direction in which the equation says nothing, or state the others one by one, along vectors of your own: `dot(velocity(C), v) = 0;`";
    Diagnostic::new(codes::CONSTRAINT_COUNT, span, message).help(help)
}

fn size(rows: &Rows) -> f64 {
    rows.iter().flatten().fold(0.0, |size, c| size.max(c.abs()))
}

/// The rows along the axes of a frame, which are the columns of `axes`.
fn turned(rows: &Rows, axes: &[[f64; 3]; 3]) -> Rows {
    std::array::from_fn(|axis| {
        (0..rows[0].len()).map(|column| (0..3).map(|i| axes[i][axis] * rows[i][column]).sum()).collect()
    })
}

/// How many of the three are not 0 at all states.
fn components(at: &[Rows]) -> usize {
    let there = |i: usize| at.iter().any(|rows| rows[i].iter().any(|c| c.abs() > NOISE * size(rows)));
    (0..3).filter(|&i| there(i)).count()
}
