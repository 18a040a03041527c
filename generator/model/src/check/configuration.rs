//! Checks that the motion keeps the configuration equations: the rate of each must follow from the velocity
//! constraints and the kinematical equations, at every state at which the loops are closed. Loops are stated
//! twice, by velocities and by positions; where the two disagree, one of them is wrong, and the motion leaves
//! the configuration.

use super::independent_constraints::with_parameters_moved;
use super::states::{self, Seen};
use super::vector_constraints::{components as nonzero, turned};
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::{Equation, EquationSides, FrameId, Mechanism, Scalar};
use crate::numeric::{self, Evaluator, Level, State, Views};

/// A rate is 0 if it is less than this share of its terms.
const KEPT: f64 = 1e-7;
/// Constraints that a message points to.
const SHOWN: usize = 3;

/// Says so where the configuration equations, as they are at arbitrary states, are more or fewer than the
/// dependent coordinates, or do not determine them.
pub fn undetermined(m: &Mechanism, states: &[State]) -> Option<Diagnostic> {
    let dependent: Vec<usize> = (0..m.coordinates.len()).filter(|&i| m.coordinates[i].dependent).collect();
    let last = m.configuration.last()?;
    let counts: Option<Vec<usize>> = m.configuration.iter().map(|e| components(m, states, e)).collect();
    let count: usize = counts?.iter().sum();
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    if count != dependent.len() {
        let message = format!(
            "the configuration amounts to {} for {}",
            plural(count, "equation"),
            plural(dependent.len(), "dependent coordinate")
        );
        let help = if count > dependent.len() {
            "put `dependent` before a coordinate for each equation"
        } else {
            "components that hold whatever the coordinates are do not count: add equations, or declare fewer coordinates dependent"
        };
        return Some(Diagnostic::new(codes::CONFIGURATION_COUNT, last.span, message).help(help));
    }
    // the coordinate that no equation determines, at all states at which there are numbers
    let free: Vec<Option<usize>> =
        states.iter().filter_map(|state| free_coordinate(m, state, &dependent)).collect();
    let first = free.first().copied().flatten().filter(|_| free.iter().all(Option::is_some))?;
    let q = &m.coordinates[first];
    let message =
        format!("the configuration equations do not determine the dependent coordinate `{}`", q.name);
    let error = Diagnostic::new(codes::CONFIGURATION_COUNT, q.span, message);
    Some(error.help("declare another coordinate dependent, one that the equations speak of"))
}

/// How many components of an equation are not identically 0, along the axes of the frame that leaves fewest.
fn components(m: &Mechanism, states: &[State], equation: &Equation) -> Option<usize> {
    let mut at: Vec<(Vec<Vec<f64>>, Evaluator<'_>)> = Vec::new();
    for state in states {
        let values = states::at_rest(m, state);
        let Ok(rows) = values.residual(equation, Level::Geometry) else { continue };
        let rows: Vec<Vec<f64>> = rows.iter().map(|r| vec![r.re]).collect();
        if rows.iter().flatten().all(|r| r.is_finite()) {
            at.push((rows, values));
        }
    }
    let along = |frame: usize| -> Option<usize> {
        let turn = |(rows, values): &(Vec<Vec<f64>>, Evaluator<'_>)| {
            let axes = values.orientation(FrameId(frame)).ok()?.map(|row| row.map(|c| c.re));
            Some(if rows.len() == 3 { turned(rows, &axes) } else { rows.clone() })
        };
        Some(nonzero(&at.iter().map(turn).collect::<Option<Vec<_>>>()?))
    };
    // two states may agree by chance
    (at.len() > 1).then(|| (0..m.frames.len()).filter_map(along).min())?
}

/// The dependent coordinate that the configuration equations leave free at a state, if they leave one; `None`
/// where there are no numbers.
fn free_coordinate(m: &Mechanism, state: &State, dependent: &[usize]) -> Option<Option<usize>> {
    let mut rows = Vec::new();
    for equation in &m.configuration {
        for slopes in numeric::configuration_slopes(m, state, equation).ok()? {
            rows.push(dependent.iter().map(|&i| slopes[i] / m.coordinates[i].factor).collect::<Vec<f64>>());
        }
    }
    if !rows.iter().flatten().all(|slope| slope.is_finite()) {
        return None;
    }
    if numeric::rank(rows.clone()) == dependent.len() {
        return Some(None);
    }
    let without = |column: &usize| {
        let left = |row: &Vec<f64>| {
            row.iter().enumerate().filter(|(i, _)| i != column).map(|(_, slope)| *slope).collect::<Vec<f64>>()
        };
        numeric::rank(rows.iter().map(left).collect()) == numeric::rank(rows.clone())
    };
    Some((0..dependent.len()).find(without).map(|column| dependent[column]))
}

/// Configuration equations that the motion does not keep.
pub fn not_kept(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for equation in &m.configuration {
        let at: Vec<(usize, bool)> = seen
            .iter()
            .filter_map(|seen| Some((seen.number, keeps(m, seen.state, &seen.views, equation)?)))
            .collect();
        // far from the start the loops may close in another way, which the constraints need not fit
        let near = at.iter().any(|(number, keeps)| !keeps && *number >= states::NEAR);
        if near || !at.is_empty() && at.iter().all(|(_, keeps)| !keeps) {
            out.push(broken(m, equation));
        }
    }
    if out.is_empty() {
        out.extend(m.configuration.iter().filter(|e| !kept_by_others(m, seen, e)).map(|e| by_chance(m, e)));
    }
    out
}

fn broken(m: &Mechanism, equation: &Equation) -> Diagnostic {
    let dependent: Vec<String> =
        m.speeds.iter().filter(|u| u.dependent).map(|u| format!("`{}`", u.name)).collect();
    let message = "the motion does not keep this equation: its rate does not follow from the constraints";
    let help = if m.constraints.is_empty() && dependent.is_empty() {
        "add the rate of this equation under `constraints`, with a speed under `dependent` for it".to_owned()
    } else {
        "state the same twice, by positions here and by their rates under `constraints`; compare signs, factors, points, and what depends on `time`".to_owned()
    };
    let error = Diagnostic::new(codes::NOT_KEPT, equation.span, message).help(help);
    with_causes(m, error)
}

/// Points to what determines the motion of dependent coordinates.
fn with_causes(m: &Mechanism, message: Diagnostic) -> Diagnostic {
    let of_dependent = |equation: &&Equation| match &equation.sides {
        EquationSides::Scalar(Scalar::Rate(rate), _) => {
            matches!(&**rate, Scalar::Coordinate(q) if m.coordinates[q.0].dependent && m.coordinates[q.0].span != equation.span)
        }
        _ => false,
    };
    let causes = m.constraints.iter().chain(m.kinematics.iter().filter(of_dependent));
    causes.take(SHOWN).fold(message, |message, cause| message.related(cause.span, "this says how it moves"))
}

fn by_chance(m: &Mechanism, equation: &Equation) -> Diagnostic {
    let message = "the motion keeps this equation only with these values of the parameters";
    let help =
        "name the same parameters in the constraints and here, or make those whose values matter `fixed`";
    let warning = Diagnostic::new(codes::KEPT_BY_VALUES, equation.span, message).help(help);
    with_causes(m, warning)
}

/// Whether the rate of an equation vanishes in the motion of the state, whose speeds are arbitrary. `None`
/// where there are no numbers.
fn keeps(m: &Mechanism, state: &State, views: &Views<'_>, equation: &Equation) -> Option<bool> {
    let slopes = numeric::configuration_slopes(m, state, equation).ok()?;
    // with all that moves: each coordinate by its rate, then time
    let keeps = |slopes: &Vec<f64>| {
        let terms = || slopes.iter().zip(views.rates.iter().chain([&1.0])).map(|(slope, rate)| slope * rate);
        let (rate, size) = (terms().sum::<f64>(), terms().map(f64::abs).sum::<f64>());
        rate.is_finite().then(|| rate.abs() <= KEPT * size)
    };
    slopes.iter().map(keeps).collect::<Option<Vec<bool>>>().map(|kept| kept.iter().all(|kept| *kept))
}

/// Whether the motion keeps the equation with other values of the parameters too, as far as the loops can be
/// closed with them.
fn kept_by_others(m: &Mechanism, seen: &[Seen<'_>], equation: &Equation) -> bool {
    let moved = |state: &State| {
        let mut state = with_parameters_moved(m, state);
        numeric::assemble(m, &mut state).ok()?;
        let views = Views::at(m, &state).ok()?;
        keeps(m, &state, &views, equation)
    };
    let near = seen.iter().filter(|seen| seen.number >= states::NEAR);
    let kept: Vec<bool> = near.filter_map(|seen| moved(seen.state)).collect();
    kept.is_empty() || kept.contains(&true)
}
