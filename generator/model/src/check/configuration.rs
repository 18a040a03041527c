//! Checks that the motion keeps the configuration equations: the rate of each must follow from the velocity
//! constraints and the kinematical equations, at every state at which the loops are closed. Loops are stated
//! twice, by velocities and by positions; where the two disagree, one of them is wrong, and the motion leaves
//! the configuration. Exact arithmetic decides where it can ([`super::exact`]), numbers at closed states
//! else.

use super::exact::{self, Parameters};
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

/// Which of the two computations decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Decided {
    Exactly,
    ByNumbers,
}

/// Whether the motion keeps a configuration equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    Always,
    WithTheseValues(Decided),
    /// not by symbols; with the values of the model numbers show no difference
    NotBySymbols,
    No(Decided),
}

/// Configuration equations that the motion does not keep.
pub fn not_kept(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let exactly = |parameters: Parameters| -> Vec<Option<bool>> {
        let nearest =
            seen.iter().rfind(|seen| seen.number >= states::NEAR).filter(|_| !m.configuration.is_empty());
        let states =
            nearest.and_then(|seen| Some((seen.state, states::arbitrary(m).into_iter().nth(seen.number)?)));
        states.map_or(vec![None; m.configuration.len()], |(closed, open)| {
            exact::kept(m, parameters, closed, &open)
        })
    };
    let free = exactly(Parameters::Free);
    // with values much more is known, so that it is asked where it matters alone
    let with_values = match free.iter().all(|kept| *kept == Some(true)) {
        true => free.clone(),
        false => exactly(Parameters::Values),
    };
    let of_equation = |((equation, free), with_values): ((&Equation, &Option<bool>), &Option<bool>)| {
        let by_numbers = || of_numbers(m, seen, equation);
        match (free, with_values) {
            (Some(true), _) => Kept::Always,
            (_, Some(false)) => Kept::No(Decided::Exactly),
            (Some(false), Some(true)) => Kept::WithTheseValues(Decided::Exactly),
            (Some(false), None) if !matches!(by_numbers(), Kept::No(_)) => Kept::NotBySymbols,
            _ => by_numbers(),
        }
    };
    let all: Vec<Kept> = m.configuration.iter().zip(&free).zip(&with_values).map(of_equation).collect();
    let mut out = Vec::new();
    for (equation, kept) in m.configuration.iter().zip(&all) {
        if let Kept::No(decided) = kept {
            out.push(broken(m, equation, *decided));
        }
    }
    if out.is_empty() {
        for (equation, kept) in m.configuration.iter().zip(&all) {
            match kept {
                Kept::WithTheseValues(decided) => out.push(by_chance(m, equation, Some(*decided))),
                Kept::NotBySymbols => out.push(by_chance(m, equation, None)),
                Kept::Always | Kept::No(_) => {}
            }
        }
    }
    out
}

/// What numbers at closed states say of a configuration equation.
fn of_numbers(m: &Mechanism, seen: &[Seen<'_>], equation: &Equation) -> Kept {
    let at: Vec<(usize, bool)> = seen
        .iter()
        .filter_map(|seen| Some((seen.number, keeps(m, seen.state, &seen.views, equation)?)))
        .collect();
    // far from the start the loops may close in another way, which the constraints need not fit
    let near = at.iter().any(|(number, keeps)| !keeps && *number >= states::NEAR);
    if near || !at.is_empty() && at.iter().all(|(_, keeps)| !keeps) {
        Kept::No(Decided::ByNumbers)
    } else if kept_by_others(m, seen, equation) {
        Kept::Always
    } else {
        Kept::WithTheseValues(Decided::ByNumbers)
    }
}

impl Decided {
    fn words(self) -> &'static str {
        match self {
            Decided::Exactly => "by exact arithmetic",
            Decided::ByNumbers => "by numbers at closed states",
        }
    }
}

fn broken(m: &Mechanism, equation: &Equation, decided: Decided) -> Diagnostic {
    let dependent: Vec<String> =
        m.speeds.iter().filter(|u| u.dependent).map(|u| format!("`{}`", u.name)).collect();
    let message = format!(
        "the motion does not keep this equation: its rate does not follow from the constraints ({})",
        decided.words()
    );
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

/// A warning; of what symbols do not keep nothing has decided whether it holds for these values.
fn by_chance(m: &Mechanism, equation: &Equation, decided: Option<Decided>) -> Diagnostic {
    let message = match decided {
        Some(decided) => format!(
            "the motion keeps this equation only with these values of the parameters ({})",
            decided.words()
        ),
        None => {
            "the motion does not keep this equation with all values of the parameters (by exact arithmetic); \
                 with these values numbers at closed states show no difference above 1e-7"
                .to_owned()
        }
    };
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
