//! Solves kinematical equations and constraints numerically: rates of coordinates and dependent speeds as
//! affine functions of the independent speeds.

use super::balance::solve_in_any_units;
use super::evaluator::{Evaluator, Level};
use super::hyper_dual::*;
use super::linear_system::rank;
use super::state::{Failure, State};
use crate::model::mechanism::*;
use crate::span::Span;

/// How many independent equations the constraints of a mechanism amount to at a state.
pub fn constraint_rank(m: &Mechanism, state: &State) -> Result<usize, Failure> {
    let mut rows = constraint_coefficients(m, state)?;
    rows.iter_mut().for_each(|row| row.truncate(m.speeds.len()));
    Ok(rank(rows))
}

/// The constraints at a state by their coefficients: speeds (as if these were counted in SI units), then the
/// constant; a vector equation has three rows, along N.x, N.y, N.z.
pub fn constraint_coefficients(m: &Mechanism, state: &State) -> Result<Vec<Vec<f64>>, Failure> {
    let coordinates = state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect();
    let time = HyperDual::constant(state.time);
    Instant { m, state, time, coordinates }.constraint_coefficients()
}

/// The constraints that determine the dependent speeds, in the same form.
pub fn determining_coefficients(m: &Mechanism, state: &State) -> Result<Vec<Vec<f64>>, Failure> {
    let Some(constraints) = &m.determining_constraints else { return constraint_coefficients(m, state) };
    let determining = Mechanism { constraints: constraints.clone(), ..m.clone() };
    constraint_coefficients(&determining, state)
}

/// Declared motions may contradict the positions by this much, relative to their terms.
const CONSISTENT: f64 = 1e-7;

/// The state as the second infinitesimal sees it: coordinates and time may move with it.
pub struct Instant<'m> {
    /// the mechanism
    pub m: &'m Mechanism,
    /// the state
    pub state: &'m State,
    /// time, with its e2
    pub time: HyperDual,
    /// coordinates, with their e2
    pub coordinates: Vec<HyperDual>,
}

/// Affine maps: the last entry of each row is the constant.
pub struct Maps {
    /// rates of coordinates from all speeds
    rates: Vec<Vec<HyperDual>>,
    /// all speeds from the independent ones
    speeds: Vec<Vec<HyperDual>>,
}

fn affine(row: &[HyperDual], arguments: &[HyperDual]) -> HyperDual {
    let Some((constant, coefficients)) = row.split_last() else { return HyperDual::ZERO };
    coefficients.iter().zip(arguments).fold(*constant, |sum, (c, a)| sum + *c * *a)
}

impl Maps {
    /// All speeds, given the independent ones.
    pub fn speeds(&self, independent: &[HyperDual]) -> Vec<HyperDual> {
        self.speeds.iter().map(|row| affine(row, independent)).collect()
    }

    /// Rates of the coordinates, given all speeds.
    pub fn rates(&self, speeds: &[HyperDual]) -> Vec<HyperDual> {
        self.rates.iter().map(|row| affine(row, speeds)).collect()
    }
}

/// A basis of affine maps in `n` arguments: 0, then each unit.
fn probes(n: usize) -> Vec<Vec<HyperDual>> {
    let mut list = vec![vec![HyperDual::ZERO; n]];
    for i in 0..n {
        let mut probe = vec![HyperDual::ZERO; n];
        probe[i] = HyperDual::ONE;
        list.push(probe);
    }
    list
}

impl<'m> Instant<'m> {
    /// All values, for these rates and speeds.
    pub fn evaluator(&self, rates: &[HyperDual], speeds: Vec<HyperDual>) -> Evaluator<'m> {
        let coordinates =
            self.coordinates.iter().zip(rates).map(|(q, rate)| HyperDual::moving(*q, *rate)).collect();
        let time = HyperDual::moving(self.time, HyperDual::ONE);
        Evaluator::new(self.m, &self.state.parameters, &self.state.inputs, time, coordinates, speeds)
    }

    /// Solves the kinematical equations and the constraints.
    pub fn maps(&self) -> Result<Maps, Failure> {
        let rates = self.solve_rates()?;
        let count = self.m.speeds.len();
        let mut maps = Maps { rates, speeds: units(count) };
        maps.speeds = self.solve_speeds(&maps)?;
        Ok(maps)
    }

    /// Coefficients of affine residuals: one row per residual, one entry per argument, the constant last.
    fn coefficients(
        &self,
        arguments: usize,
        residuals: impl Fn(&[HyperDual]) -> Result<Vec<(HyperDual, Span)>, Failure>,
    ) -> Result<(Vec<Vec<HyperDual>>, Vec<Span>), Failure> {
        let mut probes = probes(arguments).into_iter();
        let zero = residuals(&probes.next().unwrap_or_default())?;
        let mut rows: Vec<Vec<HyperDual>> = vec![Vec::new(); zero.len()];
        for probe in probes {
            for ((row, (value, _)), (constant, _)) in rows.iter_mut().zip(residuals(&probe)?).zip(&zero) {
                row.push(value - *constant);
            }
        }
        for (row, (constant, _)) in rows.iter_mut().zip(&zero) {
            row.push(*constant);
        }
        if let Some((_, (_, span))) =
            rows.iter().zip(&zero).find(|(row, _)| !row.iter().all(|c| c.is_finite()))
        {
            return Err(Failure::NotFinite(*span));
        }
        Ok((rows, zero.into_iter().map(|(_, span)| span).collect()))
    }

    fn solve_rates(&self) -> Result<Vec<Vec<HyperDual>>, Failure> {
        if let Some(rates) = stated_rates(self.m) {
            return Ok(rates);
        }
        let (q, u) = (self.m.coordinates.len(), self.m.speeds.len());
        let (rows, spans) = self.coefficients(q + u, |arguments| {
            let (rates, speeds) = arguments.split_at(q);
            self.kinematical_residuals(&self.evaluator(rates, speeds.to_vec()))
        })?;
        let rows = rows.into_iter().map(|row| negate_from(row, q)).collect();
        let quantities = self.m.coordinates.iter().chain(&self.m.speeds);
        let sizes: Vec<f64> = quantities.map(|quantity| quantity.factor).collect();
        let solved = solve_in_any_units(rows, q, &sizes)
            .map_err(|e| Failure::RatesUndetermined(CoordinateId(e.unknown)))?;
        if solved.contradiction.1 > CONSISTENT {
            return Err(Failure::MotionInconsistent(spans[solved.contradiction.0], solved.contradiction.1));
        }
        Ok(solved.unknowns)
    }

    /// What must vanish: the stated equations, declared motions less those that follow from positions, and
    /// for each quaternion that its length stays.
    fn kinematical_residuals(&self, values: &Evaluator<'_>) -> Result<Vec<(HyperDual, Span)>, Failure> {
        let mut out = Vec::new();
        for equation in &self.m.kinematics {
            out.extend(values.residual(equation, Level::Motion)?.into_iter().map(|r| (r, equation.span)));
        }
        for (i, frame) in self.m.frames.iter().enumerate() {
            if let Some((within, value)) = &frame.angular_velocity {
                let declared = values.vector(value, Level::Motion)?;
                let found = values.turning_by_geometry(FrameId(i), *within)?;
                out.extend(sub(declared, found).map(|r| (r, frame.motion_span)));
            }
            if let Orientation::Quaternion(ids) = &frame.orientation {
                let at = |id: CoordinateId| Scalar::Coordinate(id);
                let mut sum = HyperDual::ZERO;
                for id in ids {
                    let value = values.scalar(&at(*id), Level::Geometry)?;
                    sum = sum + value.still() * value.rate();
                }
                out.push((sum, frame.span));
            }
        }
        for (i, point) in self.m.points.iter().enumerate() {
            if let (Some(value), Place::Offset { .. } | Place::Material { .. }) =
                (&point.velocity, &point.place)
            {
                let declared = values.vector(value, Level::Motion)?;
                let found = values.velocity_by_position(PointId(i))?;
                out.extend(sub(declared, found).map(|r| (r, point.motion_span)));
            }
        }
        Ok(out)
    }

    fn solve_speeds(&self, maps: &Maps) -> Result<Vec<Vec<HyperDual>>, Failure> {
        let count = self.m.speeds.len();
        let independent = self.m.speeds.iter().filter(|u| !u.dependent).count();
        let dependent = count - independent;
        if dependent == 0 && self.m.constraints.is_empty() {
            return Ok(units(independent));
        }
        let (rows, spans) = self.constraint_rows(maps, dependent)?;
        let rows: Vec<Vec<HyperDual>> = rows.into_iter().map(|row| negate_from(row, dependent)).collect();
        let (own, others) = self.m.speeds.split_at(independent);
        let sizes: Vec<f64> = others.iter().chain(own).map(|speed| speed.factor).collect();
        let solved = solve_in_any_units(rows, dependent, &sizes)
            .map_err(|e| Failure::SpeedsUndetermined(SpeedId(independent + e.unknown)))?;
        if solved.contradiction.1 > CONSISTENT {
            return Err(Failure::ConstraintsInconsistent(spans[solved.contradiction.0]));
        }
        Ok(units(independent).into_iter().chain(solved.unknowns).collect())
    }

    /// The constraints by their coefficients: dependent speeds, independent speeds, the constant.
    fn constraint_rows(
        &self,
        maps: &Maps,
        dependent: usize,
    ) -> Result<(Vec<Vec<HyperDual>>, Vec<Span>), Failure> {
        self.coefficients(self.m.speeds.len(), |arguments| {
            let (unknown, given) = arguments.split_at(dependent);
            let speeds: Vec<HyperDual> = given.iter().chain(unknown).copied().collect();
            let values = self.evaluator(&maps.rates(&speeds), speeds);
            let mut out = Vec::new();
            for equation in &self.m.constraints {
                out.extend(values.residual(equation, Level::Motion)?.into_iter().map(|r| (r, equation.span)));
            }
            Ok(out)
        })
    }

    /// The constraints by their coefficients: speeds, then the constant; three rows for a vector equation,
    /// along N.x, N.y, N.z.
    pub fn constraint_coefficients(&self) -> Result<Vec<Vec<f64>>, Failure> {
        let rates = self.solve_rates()?;
        let maps = Maps { rates, speeds: Vec::new() };
        let (rows, _) = self.constraint_rows(&maps, 0)?;
        let sizes = || self.m.speeds.iter().map(|speed| speed.factor).chain([1.0]);
        let in_si = |row: &Vec<HyperDual>| row.iter().zip(sizes()).map(|(c, size)| c.re / size).collect();
        Ok(rows.iter().map(in_si).collect())
    }
}

/// The affine maps that are their arguments.
fn units(count: usize) -> Vec<Vec<HyperDual>> {
    let entry = |i, j| if i == j { HyperDual::ONE } else { HyperDual::ZERO };
    (0..count).map(|i| (0..=count).map(|j| entry(i, j)).collect()).collect()
}

/// The rates of the coordinates where each is stated to be one speed, and nothing else is said of rates: the
/// usual case, in which nothing is to be solved.
fn stated_rates(m: &Mechanism) -> Option<Vec<Vec<HyperDual>>> {
    let of_frame =
        |f: &Frame| f.angular_velocity.is_some() || matches!(f.orientation, Orientation::Quaternion(_));
    let moves = |place: &Place| matches!(place, Place::Offset { .. } | Place::Material { .. });
    let of_point = |point: &Point| point.velocity.is_some() && moves(&point.place);
    let count = m.coordinates.len();
    if m.kinematics.len() != count || m.frames.iter().any(of_frame) || m.points.iter().any(of_point) {
        return None;
    }
    let mut rates = vec![Vec::new(); count];
    for equation in &m.kinematics {
        let EquationSides::Scalar(Scalar::Rate(rate), Scalar::Speed(speed)) = &equation.sides else {
            return None;
        };
        let Scalar::Coordinate(coordinate) = **rate else { return None };
        let mut row = vec![HyperDual::ZERO; m.speeds.len() + 1];
        row[speed.0] = HyperDual::ONE;
        rates[coordinate.0] = row;
    }
    rates.iter().all(|row| !row.is_empty()).then_some(rates)
}

/// Moves all but the unknowns to the right side.
fn negate_from(mut row: Vec<HyperDual>, unknowns: usize) -> Vec<HyperDual> {
    row.iter_mut().skip(unknowns).for_each(|c| *c = -*c);
    row
}
