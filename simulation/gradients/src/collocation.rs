//! Steps by collocation at Radau's points, with derivatives: for stiff parts of a motion.
//!
//! Small slip settles in its direction within the time s / |dh/dphi|, which is much shorter than the steps of the
//! motion, and tends to zero where slip begins. An explicit method needs steps of that time. Collocation needs
//! steps as long as those of the motion: it follows the one solution that changes slowly, to which all others tend.
//!
//! Theory: docs/theory.md, section 19.1.

use std::sync::LazyLock;

use hodograph::generated::hypot;
use hodograph::{ComponentKind, Mechanism, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::SmoothPart;
use hodograph_simulation::stepper::Tolerances;
use nalgebra::{DMatrix, DVector, Dyn, LU, SMatrix};

use crate::Reason;
use crate::field::{At, Field, Sampling};
use crate::modes::{Mode, ModeKind};
use crate::transposed::{Place, TransposedField};

/// Number of stages; the order is 2 `STAGES` - 1.
pub(crate) const STAGES: usize = 5;
/// Radau's points: the zeros of P_5(2 c - 1) - P_4(2 c - 1), with the Legendre polynomials P_i. The last one is the end of
/// the step.
const POINTS: [f64; STAGES] = [
    0.057_104_196_114_517_68,
    0.276_843_013_638_123_8,
    0.583_590_432_368_916_8,
    0.860_240_135_656_219_4,
    1.0,
];
/// Largest number of iterations of Newton's method in a step.
const ITERATIONS: usize = 12;
/// Newton's method ends one iteration after a change below this many times the allowed error of a step.
const CONVERGED: f64 = 1e-2;

/// The coefficients a_ij: integrals from 0 to c_i of the polynomials that are 1 at c_j and 0 at the other points.
static INTEGRALS: LazyLock<SMatrix<f64, STAGES, STAGES>> = LazyLock::new(|| {
    let powers = SMatrix::<f64, STAGES, STAGES>::from_fn(|i, k| POINTS[i].powi(k as i32));
    let integrals =
        SMatrix::<f64, STAGES, STAGES>::from_fn(|i, k| POINTS[i].powi(k as i32 + 1) / (k as f64 + 1.0));
    // The points are different, so their powers are independent.
    powers.try_inverse().map_or(integrals, |inverse| integrals * inverse)
});

/// Steps of the equations of a mechanism with their Jacobians.
pub(crate) struct Collocation<'m> {
    /// differentiates by the whole state
    field: Field<'m>,
    /// the derivatives of the state by itself
    identity: Vec<f64>,
}

/// What is integrated: a part of a motion with its modes.
#[derive(Clone, Debug)]
pub(crate) struct Stretch<'a> {
    pub part: &'a SmoothPart,
    /// in which slip that begins has its own direction however slow it is: no stage is where it begins
    pub modes: Vec<Mode>,
    pub tolerances: &'a Tolerances,
    /// the rates at both ends of the part
    first: Vec<f64>,
    last: Vec<f64>,
}

impl<'a> Stretch<'a> {
    pub fn new(
        field: &Field<'_>,
        part: &'a SmoothPart,
        modes: &[Mode],
        tolerances: &'a Tolerances,
    ) -> Result<Self, Reason> {
        let none = vec![0.0; part.first.len() * field.k];
        let first = field.mode_rates(modes, &field.at_start(part, &none))?.rates;
        let last = field.mode_rates(modes, &field.at_end(part, &part.last, &none, &[]))?;
        let mut modes = modes.to_vec();
        for (place, mode) in modes.iter_mut().enumerate() {
            if let ModeKind::Slide { slow, .. } = &mut mode.kind {
                let slip =
                    [1, 2].map(|axis| last.contact_terms.value(last.contact_terms.velocity(place, axis)));
                if hypot(slip[0], slip[1]) > *slow {
                    *slow = 0.0;
                }
            }
        }
        Ok(Stretch { part, modes, tolerances, first, last: last.rates })
    }

    /// The state at a time by the cubic polynomial with the states and rates at a place and at the end of the part: of slip
    /// that begins from zero it has the direction up to the second order.
    fn guess(&self, (t, y): (f64, &[f64]), rates: &[f64], time: f64) -> Vec<f64> {
        let (left, x) = (self.part.end - t, (time - t) / (self.part.end - t));
        let (rest, last) = (1.0 - x, &self.part.last);
        (0..y.len())
            .map(|index| {
                let change = last[index] - y[index];
                let (bend, later) = (left * rates[index] - change, left * self.last[index] - change);
                y[index] + x * change + x * rest * (rest * bend - x * later)
            })
            .collect()
    }
}

/// A step that was made.
#[derive(Clone, Debug)]
pub(crate) struct Stages {
    /// its start and its length, s
    pub t: f64,
    pub h: f64,
    /// the states at Radau's points
    pub states: Vec<Vec<f64>>,
}

impl Stages {
    /// The state at the end.
    pub fn end(&self) -> &[f64] {
        self.states.last().map_or(&[], |state| state)
    }
}

/// The factors of the equations for the changes of all stages.
pub(crate) type Factors = LU<f64, Dyn, Dyn>;

impl<'m> Collocation<'m> {
    pub fn new(
        mechanism: &'m InterpretedMechanism,
        surfaces: Vec<(usize, Surface<f64>)>,
        sampling: Option<Sampling>,
    ) -> Self {
        let count = mechanism.count(ComponentKind::Coordinate) + mechanism.count(ComponentKind::Speed);
        let field = Field::new(mechanism, vec![Vec::new(); count], surfaces, sampling);
        let mut identity = vec![0.0; count * field.k];
        (0..count).for_each(|index| identity[index * field.k + index] = 1.0);
        Collocation { field, identity }
    }

    /// A step from (t, y) over h, and the factors of its equations.
    pub fn step(
        &self,
        stretch: &Stretch<'_>,
        (t, y): (f64, &[f64]),
        h: f64,
    ) -> Result<(Stages, Factors), Reason> {
        let rates =
            if t <= stretch.part.start { stretch.first.clone() } else { self.rates(stretch, (t, y))? };
        let guess = |point: f64| stretch.guess((t, y), &rates, t + point * h);
        let mut stages = Stages { t, h, states: POINTS.map(guess).to_vec() };
        let count = y.len();
        let mut converged = false;
        for _ in 0..ITERATIONS {
            let (rates, matrix) = self.linearised(stretch, &stages)?;
            let factors = matrix.lu();
            if converged {
                return Ok((stages, factors));
            }
            let off = DVector::from_fn(STAGES * count, |row, _| {
                let (i, index) = (row / count, row % count);
                let change: f64 = (0..STAGES).map(|j| INTEGRALS[(i, j)] * rates[j][index]).sum();
                y[index] + h * change - stages.states[i][index]
            });
            let change = factors.solve(&off).ok_or(Reason::Inaccurate(f64::INFINITY))?;
            let Tolerances { relative, absolute } = *stretch.tolerances;
            let mut most = 0.0_f64;
            for (row, change) in change.iter().enumerate() {
                let state = &mut stages.states[row / count][row % count];
                *state += change;
                most = most.max(change.abs() / (absolute + relative * state.abs()));
            }
            converged = most <= CONVERGED;
            // NaN is no state.
            if most.is_nan() {
                break;
            }
        }
        Err(Reason::Inaccurate(f64::INFINITY))
    }

    fn rates(&self, stretch: &Stretch<'_>, (time, state): (f64, &[f64])) -> Result<Vec<f64>, Reason> {
        let by = vec![0.0; state.len() * self.field.k];
        let at = At { time, state, by: &by, ..self.field.at_start(stretch.part, &by) };
        Ok(self.field.mode_rates(&stretch.modes, &at)?.rates)
    }

    /// The rates at the stages, and I - h a_ij J_j with the Jacobians J_j of the rates.
    fn linearised(
        &self,
        stretch: &Stretch<'_>,
        stages: &Stages,
    ) -> Result<(Vec<Vec<f64>>, DMatrix<f64>), Reason> {
        let (count, k) = (self.field.n + self.field.p, self.field.k);
        let mut rates = Vec::with_capacity(STAGES);
        let mut matrix = DMatrix::identity(STAGES * count, STAGES * count);
        for j in 0..STAGES {
            let at = at(&self.field, stretch.part, stages, j, &self.identity);
            let found = self.field.mode_rates(&stretch.modes, &at)?;
            for i in 0..STAGES {
                let factor = stages.h * INTEGRALS[(i, j)];
                for row in 0..count {
                    for column in 0..count {
                        matrix[(i * count + row, j * count + column)] -=
                            factor * found.rates_by[row * k + column];
                    }
                }
            }
            rates.push(found.rates);
        }
        Ok((rates, matrix))
    }
}

/// The state of a stage, with these derivatives.
fn at<'a>(
    field: &Field<'_>,
    part: &'a SmoothPart,
    stages: &'a Stages,
    stage: usize,
    by: &'a [f64],
) -> At<'a> {
    At {
        time: stages.t + POINTS[stage] * stages.h,
        state: &stages.states[stage],
        by,
        time_by: &[],
        inputs: &part.inputs,
        row: field.row(part.start),
    }
}

/// Takes the derivatives of the state at the start of a step along the directions of a field to those at its end.
pub(crate) fn carry(
    field: &Field<'_>,
    stretch: &Stretch<'_>,
    (stages, factors): &(Stages, Factors),
    by: &[f64],
) -> Result<Vec<f64>, Reason> {
    let (count, k) = (field.n + field.p, field.k);
    let mut right = DMatrix::from_fn(STAGES * count, k, |row, d| by[row % count * k + d]);
    let still = vec![0.0; count * k];
    for j in 0..STAGES {
        // What the rates take from all but the state.
        let found = field.mode_rates(&stretch.modes, &at(field, stretch.part, stages, j, &still))?;
        for i in 0..STAGES {
            let factor = stages.h * INTEGRALS[(i, j)];
            for (place, by) in found.rates_by.iter().enumerate() {
                right[(i * count + place / k, place % k)] += factor * by;
            }
        }
    }
    let found = factors.solve(&right).ok_or(Reason::Inaccurate(f64::INFINITY))?;
    let last = (STAGES - 1) * count;
    Ok((0..count * k).map(|place| found[(last + place / k, place % k)]).collect())
}

/// Replaces the weights of the state at the end of a step by those of its start.
pub(crate) fn transpose(
    collocation: &Collocation<'_>,
    field: &mut TransposedField<'_>,
    stretch: &Stretch<'_>,
    stages: &Stages,
    weights: &mut [f64],
) -> Result<(), Reason> {
    let count = weights.len();
    let (_, matrix) = collocation.linearised(stretch, stages)?;
    let mut of_stages = DVector::zeros(STAGES * count);
    of_stages.rows_mut((STAGES - 1) * count, count).copy_from_slice(weights);
    if !matrix.transpose().lu().solve_mut(&mut of_stages) {
        return Err(Reason::Inaccurate(f64::INFINITY));
    }
    for j in 0..STAGES {
        let of_rates: Vec<f64> = (0..count)
            .map(|index| {
                (0..STAGES).map(|i| stages.h * INTEGRALS[(i, j)] * of_stages[i * count + index]).sum()
            })
            .collect();
        let own = at(&collocation.field, stretch.part, stages, j, &[]);
        let place = Place { time: own.time, state: own.state, inputs: own.inputs, row: own.row };
        let tape = field.mode_rates(&stretch.modes, &place)?;
        field.of_mode_rates(&stretch.modes, &tape, &of_rates, &[])?;
    }
    for (index, weight) in weights.iter_mut().enumerate() {
        *weight = (0..STAGES).map(|i| of_stages[i * count + index]).sum();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The weights of the end integrate powers up to the eighth exactly, those of the other points up to the fourth.
    #[test]
    fn collocation_has_order_nine() {
        for power in 0..9 {
            for (i, point) in POINTS.iter().enumerate() {
                let sum: f64 = (0..STAGES).map(|j| INTEGRALS[(i, j)] * POINTS[j].powi(power)).sum();
                let exact = point.powi(power + 1) / f64::from(power + 1);
                if i == STAGES - 1 || power < STAGES as i32 {
                    assert!((sum - exact).abs() < 1e-14, "{i} {power}: {sum} {exact}");
                }
            }
        }
    }
}
