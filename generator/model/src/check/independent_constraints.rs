//! Overconstrained loops: chooses the velocity constraints that determine the dependent speeds.
//!
//! An overconstrained loop (Bennett's linkage, a plate on three parallel cranks) satisfies more velocity
//! constraints than it has dependent speeds. They are consistent where the loop is closed and contradict each
//! other where it is open, so that algebra with arbitrary coordinates cannot show that some follow
//! from the others. Numbers show it: at closed states the rank of all constraints is the number of dependent
//! speeds, for all parameters. As many constraints are then chosen as there are dependent speeds: those that
//! are most independent at the worst of many states.
//!
//! Theory: docs/theory.md, section 16.5.

use super::states;
use crate::model::mechanism::{Equation, EquationSides, FrameId, Mechanism, Scalar, Vector};
use crate::number::Number;
use crate::numeric::{self, State};

/// Of the states at which checks look so many, the nearest to the start, are looked at with the stated
/// parameters and with others.
const NEAR: usize = 3;
/// Closed states that must agree, at least.
const FEWEST: usize = 4;
/// How far parameters are moved, relative to their values: what holds for these values alone does not hold at
/// run time.
const PARAMETERS_MOVED: f64 = 0.03;
/// What a chosen constraint says that those chosen before it do not, at least, beside its largest
/// coefficient.
const INDEPENDENT: f64 = 1e-6;
/// Constraints that are independent by the same but for this factor are taken in the order of the file.
const ALIKE: f64 = 0.99;

/// Constraints at a state: rows of coefficients of the speeds, the constant last.
type Rows = Vec<Vec<f64>>;

/// As many of the velocity constraints as there are dependent speeds, from which the others follow wherever
/// the loops are closed. `None` where the constraints are not too many at arbitrary states either, or are too
/// many at closed states too.
pub fn determining(m: &Mechanism) -> Option<Vec<Equation>> {
    let dependent = m.speeds.iter().filter(|u| u.dependent).count();
    let all: Vec<Equation> = m.constraints.iter().flat_map(components).collect();
    if m.configuration.is_empty() || dependent == 0 || all.len() <= dependent {
        return None;
    }
    let open = states::arbitrary(m);
    let at = |mut state: State| {
        numeric::assemble(m, &mut state).ok()?;
        numeric::constraint_coefficients(m, &state).ok()
    };
    let rank_at = |state: &State| numeric::constraint_coefficients(m, state).ok().map(numeric::rank);
    if open.iter().filter_map(rank_at).max()? <= dependent {
        return None;
    }
    let near: Vec<State> = open.iter().skip(open.len().saturating_sub(NEAR)).cloned().collect();
    let moved = near.iter().map(|state| with_parameters_moved(m, state));
    let mut closed: Vec<Rows> = Vec::new();
    for rows in near.iter().cloned().chain(moved).filter_map(at) {
        match numeric::rank(rows.clone()).cmp(&dependent) {
            std::cmp::Ordering::Less => {}
            std::cmp::Ordering::Equal => closed.push(rows),
            std::cmp::Ordering::Greater => return None,
        }
    }
    if closed.len() < FEWEST {
        return None;
    }
    // away from the start the loops may close another way, which the constraints need not fit
    let fits = |rows: &Rows| numeric::rank(rows.clone()) == dependent;
    closed.extend(open.into_iter().chain(states::far(m)).filter_map(at).filter(fits));
    let chosen = choose(&closed, m.speeds.len() - dependent, dependent)?;
    Some(chosen.into_iter().filter_map(|row| all.get(row).cloned()).collect())
}

/// The state with other values of the parameters.
pub fn with_parameters_moved(m: &Mechanism, state: &State) -> State {
    let mut state = state.clone();
    for (i, (value, parameter)) in state.parameters.iter_mut().zip(&m.parameters).enumerate() {
        if !parameter.fixed {
            let size = if *value == 0.0 { parameter.typical } else { *value };
            *value += PARAMETERS_MOVED * size * (1.0 + i as f64).sin();
        }
    }
    state
}

/// The scalar equations of which an equation consists; a vector equation has three, along N.x, N.y, N.z.
fn components(equation: &Equation) -> Vec<Equation> {
    let EquationSides::Vector(left, right) = &equation.sides else { return vec![equation.clone()] };
    let difference = Vector::Add(vec![left.clone(), Vector::Neg(Box::new(right.clone()))]);
    let along = |axis: usize| {
        let unit = std::array::from_fn(|i| Scalar::Number(Number::integer(i64::from(i == axis))));
        let unit = Vector::Components(FrameId::N, Box::new(unit));
        let component = Scalar::Dot(Box::new(difference.clone()), Box::new(unit));
        Equation {
            sides: EquationSides::Scalar(component, Scalar::Number(Number::integer(0))),
            span: equation.span,
        }
    };
    (0..3).map(along).collect()
}

/// The rows that determine the last `count` speeds, after the first `independent` ones: one after another the
/// row that at its worst state has the longest part orthogonal to the rows chosen before, each row measured
/// by its largest coefficient at any state.
fn choose(closed: &[Rows], independent: usize, count: usize) -> Option<Vec<usize>> {
    let mut rest = scaled(closed, independent, count);
    let mut chosen = Vec::new();
    for _ in 0..count {
        let at_worst = |row: usize| rest.iter().map(|rows| length(&rows[row])).fold(f64::INFINITY, f64::min);
        let left = (0..rest.first()?.len()).filter(|row| !chosen.contains(row));
        let lengths: Vec<(usize, f64)> = left.map(|row| (row, at_worst(row))).collect();
        let most = lengths.iter().fold(0.0_f64, |most, (_, length)| most.max(*length));
        let (row, longest) = *lengths.iter().find(|(_, length)| *length >= ALIKE * most)?;
        if longest < INDEPENDENT {
            return None;
        }
        chosen.push(row);
        rest.iter_mut().for_each(|rows| make_orthogonal(rows, row));
    }
    chosen.sort_unstable();
    Some(chosen)
}

/// The coefficients of the dependent speeds at all states, each row divided by its largest coefficient at any
/// of them; a row of rounding errors is 0.
fn scaled(closed: &[Rows], independent: usize, count: usize) -> Vec<Rows> {
    let largest = |row: usize| {
        let entries = closed.iter().filter_map(|rows| rows.get(row)).flatten();
        entries.fold(0.0_f64, |size, c| size.max(c.abs()))
    };
    let sizes: Vec<f64> = (0..closed.first().map_or(0, Vec::len)).map(largest).collect();
    let noise = 1e-12 * sizes.iter().fold(0.0_f64, |most, size| most.max(*size));
    let scale = |row: usize| if sizes[row] > noise { 1.0 / sizes[row] } else { 0.0 };
    let of_row = |(i, row): (usize, &Vec<f64>)| -> Vec<f64> {
        row.iter().skip(independent).take(count).map(|c| scale(i) * c).collect()
    };
    closed.iter().map(|rows| rows.iter().enumerate().map(of_row).collect()).collect()
}

/// Takes from all rows what lies along one of them.
fn make_orthogonal(rows: &mut Rows, along: usize) {
    let direction = rows[along].clone();
    let square: f64 = direction.iter().map(|c| c * c).sum();
    for row in rows {
        let product: f64 = row.iter().zip(&direction).map(|(a, b)| a * b).sum();
        row.iter_mut().zip(&direction).for_each(|(a, b)| *a -= product / square * b);
    }
}

fn length(row: &[f64]) -> f64 {
    row.iter().map(|c| c * c).sum::<f64>().sqrt()
}
