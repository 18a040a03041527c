//! Reports constraints that repeat others, and vector constraints with dependent components for which no frame separates them: the derivation
//! needs axes along which the redundant components are identically 0.

use super::states::Seen;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::{EquationSides, Mechanism};
use crate::numeric;
use crate::span::Span;

/// What is nothing beside the other entries of a matrix.
const NOISE: f64 = 1e-9;

/// A constraint at some states.
struct Stated {
    span: Span,
    /// along the axes that take it apart; of a scalar equation, one row
    rows: Vec<Vec<Vec<f64>>>,
    /// how many rows say something, at least, along the axes of any frame
    components: usize,
    /// how many of them are independent
    rank: usize,
}

/// All constraints, by what they are at some states.
fn stated(m: &Mechanism, seen: &[Seen<'_>]) -> Option<Vec<Stated>> {
    let at: Vec<Vec<Vec<f64>>> = seen
        .iter()
        .map(|seen| numeric::constraint_coefficients(m, seen.state).ok())
        .collect::<Option<_>>()?;
    let mut first = 0;
    let mut out = Vec::new();
    for equation in &m.constraints {
        let count = if matches!(equation.sides, EquationSides::Vector(..)) { 3 } else { 1 };
        let rows: Vec<Vec<Vec<f64>>> =
            at.iter().map(|rows| rows.iter().skip(first).take(count).cloned().collect()).collect();
        first += count;
        let rank = rows.iter().map(|rows| numeric::rank(rows.clone())).max().unwrap_or(count);
        let along = |frame: usize| -> Option<usize> {
            let turn = |(rows, seen): (&Vec<Vec<f64>>, &Seen<'_>)| {
                let axes = seen.at.orientations.get(frame).copied().flatten()?;
                Some(turned(rows, &axes))
            };
            Some(components(&rows.iter().zip(seen).map(turn).collect::<Option<Vec<_>>>()?))
        };
        let along_n = components(&rows);
        let least = if count == 3 && along_n > rank {
            (0..m.frames.len()).filter_map(along).fold(along_n, usize::min)
        } else {
            along_n
        };
        out.push(Stated { span: equation.span, rows, components: least, rank });
    }
    Some(out)
}

/// The vector constraints that no frame takes apart, by what they are at some states.
pub fn inseparable(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    if m.determining_constraints.is_some() {
        return Vec::new();
    }
    let stated = stated(m, seen).unwrap_or_default();
    let inseparable = stated.iter().filter(|stated| stated.rank < 3 && stated.components > stated.rank);
    inseparable.map(|stated| dependent_components(stated.span)).collect()
}

/// The first constraint that repeats what others say: it needs no dependent speed, and has none.
pub fn repeated(m: &Mechanism, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    if m.determining_constraints.is_some() {
        return None;
    }
    let stated = stated(m, seen)?;
    let dependent = m.speeds.iter().filter(|u| u.dependent).count();
    if stated.iter().map(|stated| stated.components).sum::<usize>() <= dependent {
        return None;
    }
    let rank_of = |list: &[Stated]| {
        let at = |i: usize| numeric::rank(list.iter().flat_map(|stated| stated.rows[i].clone()).collect());
        (0..seen.len()).map(at).max().unwrap_or(0)
    };
    let repeats = |&i: &usize| rank_of(&stated[..=i]) < rank_of(&stated[..i]) + stated[i].components;
    let last = (0..stated.len()).find(repeats)?;
    let message = "this repeats in part or as a whole what the constraints before it say";
    let error = Diagnostic::new(codes::CONSTRAINT_COUNT, stated[last].span, message);
    Some(error.help("leave out what is said already; each constraint needs a speed under `dependent`"))
}

/// A vector equation whose components depend on each other along the axes of all frames.
pub fn dependent_components(span: Span) -> Diagnostic {
    let message = "the components of this equation depend on each other, and along the axes of no frame is one of them identically 0";
    let help = "orient a frame along the direction in which the equation says nothing, or state the others one by one, along vectors of your own: `dot(velocity(C), v) = 0;`";
    Diagnostic::new(codes::CONSTRAINT_COUNT, span, message).help(help)
}

fn size(rows: &[Vec<f64>]) -> f64 {
    rows.iter().flatten().fold(0.0, |size, c| size.max(c.abs()))
}

/// Three rows along the axes of a frame, which are the columns of `axes`.
pub fn turned(rows: &[Vec<f64>], axes: &[[f64; 3]; 3]) -> Vec<Vec<f64>> {
    let width = rows.first().map_or(0, Vec::len);
    let entry = |axis: usize, column: usize| {
        rows.iter().enumerate().map(|(i, row)| axes[i][axis] * row[column]).sum::<f64>()
    };
    (0..3).map(|axis| (0..width).map(|column| entry(axis, column)).collect()).collect()
}

/// How many of the rows are not 0 at all states.
pub fn components(at: &[Vec<Vec<f64>>]) -> usize {
    let count = at.first().map_or(0, Vec::len);
    // At a state that satisfies an equation its residual is rounding, along all axes.
    let noise = NOISE * at.iter().map(|rows| size(rows)).fold(0.0, f64::max);
    let there = |i: usize| at.iter().any(|rows| rows[i].iter().any(|c| c.abs() > noise));
    (0..count).filter(|&i| there(i)).count()
}
