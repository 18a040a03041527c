//! Initial values that follow from others: expressions of parameters and initial values, and coordinates for
//! which contacts are closed.
//!
//! Expressions are evaluated with the same bits on every machine. A closed contact is found by Newton's
//! method on its gap, with the loops closed at each step; its coordinate is rounded to 15 digits, so that
//! the last bit of a function decides nothing.

use super::assembly::assemble;
use super::evaluator::{Evaluator, Level};
use super::hyper_dual::HyperDual;
use super::state::State;
use crate::arithmetic::{Function, reproducible};
use crate::model::mechanism::{Initial, Mechanism, Scalar, Variable};

/// Steps of Newton's method.
const STEPS: usize = 100;
/// A gap is closed below this share of the size of the coordinates above 1 m.
const CLOSED: f64 = 1e-12;

/// Which of the coordinates and independent speeds of a state are given: these stay.
#[derive(Clone, Debug, Default)]
pub struct Given {
    /// per coordinate
    pub coordinates: Vec<bool>,
    /// per independent speed
    pub speeds: Vec<bool>,
}

impl Given {
    fn coordinate(&self, i: usize) -> bool {
        self.coordinates.get(i).copied().unwrap_or(false)
    }

    fn speed(&self, i: usize) -> bool {
        self.speeds.get(i).copied().unwrap_or(false)
    }
}

/// Sets the values of all expressions, with the values of the model. Answers the quantities that have none,
/// and whether that is because they are stated through themselves.
pub fn evaluate(m: &mut Mechanism) -> Vec<(Variable, bool)> {
    let mut state = State::of(m);
    let open = expressions(m, &mut state, &Given::default());
    store(m, &state, |initial| matches!(initial, Initial::Expression { .. }));
    let (speeds, coordinates): (Vec<usize>, Vec<usize>) =
        open.iter().partition(|slot| **slot >= m.coordinates.len());
    let n = m.coordinates.len();
    let variables = coordinates.iter().map(|&i| (i, &m.coordinates[i]));
    let variables = variables.chain(speeds.iter().map(|&i| (i, &m.speeds[i - n])));
    variables.map(|(slot, variable)| (variable.clone(), reaches_itself(m, slot))).collect()
}

/// Sets the coordinates with which contacts are closed, with the values of the model. Answers those for which
/// there is no value near the guess.
pub fn close(m: &mut Mechanism) -> Vec<usize> {
    let touching = |q: &Variable| matches!(q.initial, Some(Initial::Touching { .. }));
    if !m.coordinates.iter().any(touching) {
        return Vec::new();
    }
    let mut state = State::of(m);
    let open = complete(m, &mut state, &Given::default());
    if open.is_empty() {
        store(m, &state, |_| true);
    }
    open
}

/// Completes a state: what is not given and follows from other quantities. Answers the coordinates that cannot
/// be found (past the coordinates: the speeds); they are left as they were.
pub fn complete(m: &Mechanism, state: &mut State, given: &Given) -> Vec<usize> {
    let unknown: Vec<(usize, usize)> = m
        .coordinates
        .iter()
        .enumerate()
        .filter(|(i, _)| !given.coordinate(*i))
        .filter_map(|(i, q)| match &q.initial {
            Some(Initial::Touching { contact, guess, .. }) => {
                state.coordinates[i] = *guess;
                Some((i, *contact))
            }
            _ => None,
        })
        .collect();
    if !unknown.is_empty() && touch(m, state, given, &unknown).is_none() {
        return unknown.iter().map(|(i, _)| *i).collect();
    }
    expressions(m, state, given)
}

fn store(m: &mut Mechanism, state: &State, which: impl Fn(&Initial) -> bool) {
    let coordinates = m.coordinates.iter_mut().zip(&state.coordinates);
    let speeds = m.speeds.iter_mut().filter(|u| !u.dependent).zip(&state.speeds);
    for (variable, &value) in coordinates.chain(speeds) {
        if variable.initial.as_ref().is_some_and(&which) {
            variable.value = Some(value).filter(|value| value.is_finite());
        }
    }
}

/// Evaluates the expressions that are not given, each after what it needs. Answers those without a finite
/// value, by their place among coordinates and speeds.
fn expressions(m: &Mechanism, state: &mut State, given: &Given) -> Vec<usize> {
    let n = m.coordinates.len();
    let mut open: Vec<usize> = Vec::new();
    let of_expression = |v: &Variable| matches!(v.initial, Some(Initial::Expression { .. }));
    open.extend((0..n).filter(|&i| of_expression(&m.coordinates[i]) && !given.coordinate(i)));
    open.extend(
        (0..state.speeds.len()).filter(|&i| of_expression(&m.speeds[i]) && !given.speed(i)).map(|i| n + i),
    );
    let set = |state: &mut State, slot: usize, value: f64| match slot.checked_sub(n) {
        None => state.coordinates[slot] = value,
        Some(speed) => state.speeds[speed] = value,
    };
    // what is not known yet is no number, and neither is what depends on it
    open.iter().for_each(|&slot| set(state, slot, f64::NAN));
    loop {
        let before = open.len();
        open.retain(|&slot| {
            let variable = if slot < n { &m.coordinates[slot] } else { &m.speeds[slot - n] };
            let Some(Initial::Expression { value, .. }) = &variable.initial else { return false };
            let value = number(state, value) / variable.factor;
            if value.is_finite() {
                set(state, slot, value);
            }
            !value.is_finite()
        });
        if open.is_empty() || open.len() == before {
            return open;
        }
    }
}

/// The value of an expression of parameters, coordinates and speeds; what it has else is no number.
fn number(state: &State, scalar: &Scalar) -> f64 {
    let of = |scalar: &Scalar| number(state, scalar);
    let at = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(f64::NAN);
    match scalar {
        Scalar::Number(number) => number.to_f64(),
        Scalar::Pi => std::f64::consts::PI,
        Scalar::Parameter(id) => at(&state.parameters, id.0),
        Scalar::Coordinate(id) => at(&state.coordinates, id.0),
        Scalar::Speed(id) => at(&state.speeds, id.0),
        Scalar::Neg(inner) => -of(inner),
        Scalar::Add(parts) => parts.iter().map(of).sum(),
        Scalar::Mul(parts) => parts.iter().map(of).product(),
        Scalar::Div(a, b, _) => of(a) / of(b),
        Scalar::Pow(a, b) => {
            let (base, exponent) = (of(a), of(b));
            match exponent {
                0.5 => base.sqrt(),
                e if e.fract() == 0.0 && e.abs() <= 1000.0 => base.powi(e as i32),
                e => reproducible::call(Function::Exp, e * reproducible::call(Function::Log, base)),
            }
        }
        Scalar::Call(function, arguments) => match &arguments[..] {
            [a] => reproducible::call(*function, of(a)),
            [a, b] => {
                let (a, b) = (of(a), of(b));
                // a least and a greatest number hide what is none
                if a.is_nan() || b.is_nan() { f64::NAN } else { reproducible::call2(*function, a, b) }
            }
            _ => f64::NAN,
        },
        _ => f64::NAN,
    }
}

/// Whether an initial value depends on itself.
fn reaches_itself(m: &Mechanism, slot: usize) -> bool {
    let n = m.coordinates.len();
    let mut seen = vec![false; n + m.speeds.len()];
    let mut stack = vec![slot];
    while let Some(at) = stack.pop() {
        let variable = if at < n { m.coordinates.get(at) } else { m.speeds.get(at - n) };
        let Some(Initial::Expression { value, .. }) = variable.and_then(|v| v.initial.as_ref()) else {
            continue;
        };
        let mut used = Vec::new();
        uses(value, n, &mut used);
        for next in used {
            if next == slot {
                return true;
            }
            if !std::mem::replace(&mut seen[next], true) {
                stack.push(next);
            }
        }
    }
    false
}

fn uses(scalar: &Scalar, n: usize, out: &mut Vec<usize>) {
    match scalar {
        Scalar::Coordinate(id) => out.push(id.0),
        Scalar::Speed(id) => out.push(n + id.0),
        Scalar::Neg(inner) => uses(inner, n, out),
        Scalar::Add(parts) | Scalar::Mul(parts) | Scalar::Call(_, parts) => {
            parts.iter().for_each(|part| uses(part, n, out));
        }
        Scalar::Div(a, b, _) | Scalar::Pow(a, b) => [a, b].into_iter().for_each(|part| uses(part, n, out)),
        _ => {}
    }
}

/// Finds the unknown coordinates at which the gaps of contacts are 0: Newton's method with slopes by
/// differences, for loops are closed and expressions evaluated at each step.
fn touch(m: &Mechanism, state: &mut State, given: &Given, unknown: &[(usize, usize)]) -> Option<()> {
    let start = state.clone();
    let at = |x: &[f64]| -> Option<(State, Vec<f64>)> {
        let mut state = start.clone();
        unknown.iter().zip(x).for_each(|((i, _), x)| state.coordinates[*i] = *x);
        if !expressions(m, &mut state, given).is_empty() {
            return None;
        }
        assemble(m, &mut state).ok()?;
        let gaps =
            unknown.iter().map(|(_, contact)| gap(m, &state, *contact)).collect::<Option<Vec<f64>>>()?;
        Some((state, gaps))
    };
    let size = |gaps: &[f64]| gaps.iter().fold(0.0_f64, |size, gap| size.max(gap.abs()));
    let mut x: Vec<f64> = unknown.iter().map(|(i, _)| start.coordinates[*i]).collect();
    let (mut found, mut gaps) = at(&x)?;
    for _ in 0..STEPS {
        if gaps.iter().all(|gap| *gap == 0.0) {
            break;
        }
        let mut rows: Vec<Vec<HyperDual>> = vec![Vec::new(); gaps.len()];
        for (column, (i, _)) in unknown.iter().enumerate() {
            let step = 1e-6 * x[column].abs().max(1e-3 / m.coordinates[*i].factor);
            let moved = |by: f64| {
                let mut x = x.clone();
                x[column] += by;
                Some(at(&x)?.1)
            };
            let (after, before) = (moved(step)?, moved(-step)?);
            for (row, (after, before)) in rows.iter_mut().zip(after.iter().zip(&before)) {
                row.push(HyperDual::constant((after - before) / (2.0 * step)));
            }
        }
        rows.iter_mut().zip(&gaps).for_each(|(row, gap)| row.push(HyperDual::constant(-gap)));
        let sizes: Vec<f64> = unknown.iter().map(|(i, _)| m.coordinates[*i].factor).collect();
        let step = super::linear_system::solve(rows, unknown.len(), &sizes).ok()?;
        let mut scale = 1.0;
        let mut better = None;
        for _ in 0..30 {
            let tried: Vec<f64> = x
                .iter()
                .zip(&step.unknowns)
                .map(|(x, dx)| x + scale * dx.first().map_or(0.0, |dx| dx.re))
                .collect();
            better = at(&tried).filter(|(_, new)| size(new) < size(&gaps)).map(|found| (tried, found));
            if better.is_some() {
                break;
            }
            scale *= 0.5;
        }
        let Some((tried, (state, new))) = better else { break };
        (x, found, gaps) = (tried, state, new);
    }
    let scale = found
        .coordinates
        .iter()
        .zip(&m.coordinates)
        .fold(1.0_f64, |scale, (q, variable)| scale.max((q * variable.factor).abs()));
    if size(&gaps) > CLOSED * scale {
        return None;
    }
    let rounded: Vec<f64> = x.iter().map(|x| format!("{x:.14e}").parse().unwrap_or(*x)).collect();
    *state = at(&rounded)?.0;
    Some(())
}

fn gap(m: &Mechanism, state: &State, contact: usize) -> Option<f64> {
    let gap = m.contacts.get(contact)?.gap.as_ref()?;
    let coordinates = state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect();
    let speeds = vec![HyperDual::ZERO; m.speeds.len()];
    let time = HyperDual::constant(state.time);
    let values = Evaluator::new(m, &state.parameters, &state.inputs, time, coordinates, speeds);
    let gap = values.scalar(gap, Level::Motion).ok()?.re;
    gap.is_finite().then_some(gap)
}
