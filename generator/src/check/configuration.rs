//! Checks that the motion keeps the configuration equations: the rate of each must follow from the velocity
//! constraints and the kinematical equations, at every state at which the loops are closed. Loops are stated
//! twice, by velocities and by positions; where the two disagree, one of them is wrong, and the motion leaves
//! the configuration.

use super::independent_constraints::with_parameters_moved;
use super::states::{self, Seen};
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::{Equation, Mechanism};
use crate::numeric::{self, State, Views};

/// A rate is 0 if it is less than this share of its terms.
const KEPT: f64 = 1e-7;
/// Constraints that a message points to.
const SHOWN: usize = 3;

/// Configuration equations that the motion does not keep.
pub fn not_kept(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for equation in &m.configuration {
        let at: Vec<(usize, bool)> =
            seen.iter().filter_map(|seen| Some((seen.number, keeps(&seen.views, m, equation)?))).collect();
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
    m.constraints
        .iter()
        .take(SHOWN)
        .fold(error, |error, constraint| error.related(constraint.span, "this says how it moves"))
}

fn by_chance(m: &Mechanism, equation: &Equation) -> Diagnostic {
    let message = "the motion keeps this equation only with these values of the parameters";
    let help =
        "name the same parameters in the constraints and here, or make those whose values matter `fixed`";
    let warning = Diagnostic::new(codes::KEPT_BY_VALUES, equation.span, message).help(help);
    m.constraints
        .iter()
        .take(SHOWN)
        .fold(warning, |warning, constraint| warning.related(constraint.span, "this says how it moves"))
}

/// Whether the rate of an equation vanishes in the motion of the state, whose speeds are arbitrary. `None`
/// where there are no numbers.
fn keeps(views: &Views<'_>, m: &Mechanism, equation: &Equation) -> Option<bool> {
    let slopes = views.slopes(m, equation).ok()?;
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
        keeps(&views, m, equation)
    };
    let near = seen.iter().filter(|seen| seen.number >= states::NEAR);
    let kept: Vec<bool> = near.filter_map(|seen| moved(seen.state)).collect();
    kept.is_empty() || kept.contains(&true)
}
