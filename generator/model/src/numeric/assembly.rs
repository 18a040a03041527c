//! Solves the configuration equations for the dependent coordinates.

use super::evaluator::{Evaluator, Level};
use super::hyper_dual::HyperDual;
use super::linear_system::solve;
use super::state::{Failure, State};
use crate::model::mechanism::{Equation, Mechanism};

/// Changes the dependent coordinates so that the configuration equations hold, starting from what they are:
/// Newton's method, with steps halved where they make things worse.
pub fn assemble(m: &Mechanism, state: &mut State) -> Result<(), Failure> {
    let unknown: Vec<usize> = (0..m.coordinates.len()).filter(|i| m.coordinates[*i].dependent).collect();
    if unknown.is_empty() {
        return Ok(());
    }
    let sizes: Vec<f64> = unknown.iter().map(|i| m.coordinates[*i].factor).collect();
    let mut size = residual_size(m, state)?;
    for _ in 0..60 {
        if size < 1e-13 {
            break;
        }
        let mut rows: Vec<Vec<HyperDual>> = Vec::new();
        for &q in &unknown {
            let column = residuals(m, state, Some(q))?;
            rows.resize(column.len(), Vec::new());
            rows.iter_mut().zip(column).for_each(|(row, r)| row.push(HyperDual::constant(r.e1)));
        }
        let now = residuals(m, state, None)?;
        rows.iter_mut().zip(now).for_each(|(row, r)| row.push(HyperDual::constant(-r.re)));
        let Ok(step) = solve(rows, unknown.len(), &sizes) else { return Err(Failure::NotClosed(size)) };
        let before = state.coordinates.clone();
        let mut scale = 1.0;
        let mut better = false;
        for _ in 0..30 {
            for (&q, dx) in unknown.iter().zip(&step.unknowns) {
                state.coordinates[q] = before[q] + scale * dx.first().map_or(0.0, |d| d.re);
            }
            if let Ok(new) = residual_size(m, state)
                && new < size
            {
                (size, better) = (new, true);
                break;
            }
            scale *= 0.5;
        }
        if !better {
            state.coordinates = before;
            break;
        }
    }
    if size < 1e-9 { Ok(()) } else { Err(Failure::NotClosed(size)) }
}

/// The derivatives of what must vanish in a configuration equation, with respect to each coordinate, then to
/// time: one row, or three along N.x, N.y, N.z.
pub fn configuration_slopes(
    m: &Mechanism,
    state: &State,
    equation: &Equation,
) -> Result<Vec<Vec<f64>>, Failure> {
    let n = m.coordinates.len();
    let mut slopes: Vec<Vec<f64>> = Vec::new();
    for moving in 0..=n {
        let e1 = |i: usize| f64::from(u8::from(moving == i));
        let coordinates = state.coordinates.iter().enumerate();
        let coordinates =
            coordinates.map(|(i, q)| HyperDual { e1: e1(i), ..HyperDual::constant(*q) }).collect();
        let time = HyperDual { e1: e1(n), ..HyperDual::constant(state.time) };
        let still = vec![HyperDual::ZERO; m.speeds.len()];
        let values = Evaluator::new(m, &state.parameters, &state.inputs, time, coordinates, still);
        let column = values.residual(equation, Level::Geometry)?;
        slopes.resize(column.len(), Vec::new());
        slopes.iter_mut().zip(column).for_each(|(row, r)| row.push(r.e1));
    }
    Ok(slopes)
}

fn residuals(m: &Mechanism, state: &State, moving: Option<usize>) -> Result<Vec<HyperDual>, Failure> {
    let coordinates = state
        .coordinates
        .iter()
        .enumerate()
        .map(|(i, q)| HyperDual { re: *q, e1: f64::from(u8::from(moving == Some(i))), ..HyperDual::ZERO })
        .collect();
    let speeds = vec![HyperDual::ZERO; m.speeds.len()];
    let time = HyperDual::constant(state.time);
    let values = Evaluator::new(m, &state.parameters, &state.inputs, time, coordinates, speeds);
    let mut out = Vec::new();
    for equation in &m.configuration {
        out.extend(values.residual(equation, Level::Geometry)?);
    }
    Ok(out)
}

fn residual_size(m: &Mechanism, state: &State) -> Result<f64, Failure> {
    let size = residuals(m, state, None)?.iter().fold(0.0_f64, |s, r| s.max(r.re.abs()));
    if size.is_finite() { Ok(size) } else { Err(Failure::NotClosed(size)) }
}
