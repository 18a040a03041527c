//! Implements the trait `Mechanism` by the numeric evaluation.

use hodograph::generated::{check_length, normalise_quaternions, write};
use hodograph::nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use hodograph::{Component, ComponentKind, Mechanism, ParameterError, State, StateError};
use hodograph_model::model::mechanism::{FrameId, PointId};
use hodograph_model::numeric::{self, Views, configuration_slopes, views::values};

use super::failure::state_error;
use super::{NumericMechanism, finite, place, snapshot};
use crate::{description, parameters};

impl NumericMechanism {
    /// Partial velocities of a point, along N.
    fn partials(&self, point: usize, state: &State<'_>) -> Result<Vec<[f64; 3]>, StateError> {
        self.exists(ComponentKind::Point, point)?;
        let numbers = self.numbers(state)?;
        let views = Views::at(&self.model, &numbers).map_err(state_error)?;
        views.partials(|values| values.velocity(PointId(point))).map_err(state_error)
    }
}

impl Mechanism for NumericMechanism {
    fn name(&self) -> &str {
        &self.model.name
    }

    fn count(&self, kind: ComponentKind) -> usize {
        description::count(&self.model, kind)
    }

    fn component(&self, kind: ComponentKind, index: usize) -> Option<Component<'_>> {
        description::component(&self.model, kind, index)
    }

    fn dependent_coordinate(&self, index: usize) -> Option<usize> {
        self.dependent_coordinates.get(index).copied()
    }

    fn parameter_values(&self, values: &mut [f64]) -> Result<(), StateError> {
        write(values, &parameters::run_time(&self.model, self.all_parameters()), "parameters")
    }

    fn set_parameter_values(&mut self, values: &[f64]) -> Result<(), ParameterError> {
        let all = parameters::all(&self.model, values)?;
        parameters::check(&self.model, &all)?;
        self.bases = snapshot::bases(&self.model, &all);
        self.parameters = all;
        Ok(())
    }

    fn initial_state(
        &self,
        coordinates: &mut [f64],
        speeds: &mut [f64],
        inputs: &mut [f64],
    ) -> Result<(), StateError> {
        description::initial_state(&self.model, [coordinates, speeds, inputs])
    }

    fn normalise(&self, coordinates: &mut [f64]) -> Result<(), StateError> {
        check_length(coordinates, self.model.coordinates.len(), "coordinates")?;
        normalise_quaternions(coordinates, &self.quaternions);
        Ok(())
    }

    fn coordinate_rates(&self, state: &State<'_>, rates: &mut [f64]) -> Result<(), StateError> {
        write(rates, &self.snapshot(state)?.values.rates, "the rates of the coordinates")
    }

    fn accelerations(&self, state: &State<'_>, accelerations: &mut [f64]) -> Result<(), StateError> {
        write(accelerations, self.snapshot(state)?.accelerations.as_slice(), "the accelerations")
    }

    fn dependent_speeds(&self, state: &State<'_>, speeds: &mut [f64]) -> Result<(), StateError> {
        let known = self.snapshot(state)?;
        write(speeds, &known.values.speeds[self.freedom()..], "the dependent speeds")
    }

    fn dependent_accelerations(
        &self,
        state: &State<'_>,
        accelerations: &mut [f64],
    ) -> Result<(), StateError> {
        let known = self.snapshot(state)?;
        let mut all = known.values.dependent_accelerations.clone();
        for (partials, rate) in known.values.dependent_partials.iter().zip(&known.accelerations) {
            all.iter_mut().zip(partials).for_each(|(sum, partial)| *sum += partial * rate);
        }
        write(accelerations, &all, "the dependent accelerations")
    }

    fn mass_matrix(&self, state: &State<'_>, matrix: &mut [f64]) -> Result<(), StateError> {
        write(matrix, &self.snapshot(state)?.values.mass_matrix.concat(), "the mass matrix")
    }

    fn forcing(&self, state: &State<'_>, forcing: &mut [f64]) -> Result<(), StateError> {
        write(forcing, &self.snapshot(state)?.values.forcing, "the forcing")
    }

    fn inverse_dynamics(
        &self,
        state: &State<'_>,
        accelerations: &[f64],
        forces: &mut [f64],
    ) -> Result<(), StateError> {
        let p = self.freedom();
        check_length(accelerations, p, "the accelerations")?;
        let known = self.snapshot(state)?;
        let matrix = DMatrix::from_fn(p, p, |i, j| known.values.mass_matrix[i][j]);
        let all = matrix * DVector::from_column_slice(accelerations)
            - DVector::from_column_slice(&known.values.forcing);
        write(forces, all.as_slice(), "the generalised forces")
    }

    fn kinetic_energy(&self, state: &State<'_>) -> Result<f64, StateError> {
        finite([self.snapshot(state)?.values.kinetic_energy]).map(|[energy]| energy)
    }

    fn potential_energy(&self, state: &State<'_>) -> Result<Option<f64>, StateError> {
        Ok(self.snapshot(state)?.values.potential_energy)
    }

    fn configuration(
        &self,
        state: &State<'_>,
        residual: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), StateError> {
        let c = self.dependent_coordinates.len();
        check_length(residual, c, "the residual of the configuration equations")?;
        check_length(jacobian, c * c, "the derivatives of the configuration equations")?;
        if c == 0 {
            return Ok(());
        }
        let numbers = self.numbers(state)?;
        let mut slopes = Vec::new();
        for equation in &self.model.configuration {
            slopes.extend(configuration_slopes(&self.model, &numbers, equation).map_err(state_error)?);
        }
        let known = self.still(state, |values| {
            let mut all = Vec::new();
            for equation in &self.model.configuration {
                all.extend(values.residual(equation, numeric::Level::Geometry)?.into_iter().map(|r| r.re));
            }
            Ok(all)
        })?;
        // A vector equation of a plane loop has a row that is zero whatever the coordinates.
        let rows = independent(&slopes, &self.dependent_coordinates, c)
            .ok_or(StateError::Singular { what: "the configuration equations" })?;
        for (place, row) in rows.into_iter().enumerate() {
            residual[place] = known[row];
            let dependent = self.dependent_coordinates.iter();
            jacobian[c * place..][..c]
                .iter_mut()
                .zip(dependent)
                .for_each(|(entry, &q)| *entry = slopes[row][q]);
        }
        Ok(())
    }

    fn position(&self, point: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        self.exists(ComponentKind::Point, point)?;
        finite(self.still(state, |values| place(values, point))?).map(Vector3::from)
    }

    fn velocity(&self, point: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        self.exists(ComponentKind::Point, point)?;
        finite(self.snapshot(state)?.values.velocities[point]).map(Vector3::from)
    }

    fn acceleration(
        &self,
        point: usize,
        state: &State<'_>,
        accelerations: &[f64],
    ) -> Result<Vector3<f64>, StateError> {
        check_length(accelerations, self.freedom(), "the accelerations")?;
        let partials = self.partials(point, state)?;
        let mut sum = Vector3::from(self.snapshot(state)?.values.accelerations[point]);
        for (partial, rate) in partials.into_iter().zip(accelerations) {
            sum += Vector3::from(partial) * *rate;
        }
        finite(sum.into()).map(Vector3::from)
    }

    fn jacobian(&self, point: usize, state: &State<'_>, jacobian: &mut [f64]) -> Result<(), StateError> {
        check_length(jacobian, 3 * self.freedom(), "the partial velocities")?;
        let partials = self.partials(point, state)?;
        let p = partials.len();
        for (column, partial) in partials.into_iter().enumerate() {
            (0..3).for_each(|row| jacobian[p * row + column] = partial[row]);
        }
        Ok(())
    }

    fn orientation(&self, frame: usize, state: &State<'_>) -> Result<Matrix3<f64>, StateError> {
        self.exists(ComponentKind::Frame, frame)?;
        let rows = self.still(state, |found| Ok(found.orientation(FrameId(frame))?.map(values)))?;
        finite(rows.concat().try_into().unwrap_or([f64::NAN; 9])).map(|all| Matrix3::from_row_slice(&all))
    }
}

/// As many rows as there are unknowns, by elimination with pivots: those that determine the unknowns best.
fn independent(slopes: &[Vec<f64>], unknowns: &[usize], count: usize) -> Option<Vec<usize>> {
    let mut left: Vec<(usize, Vec<f64>)> = slopes
        .iter()
        .enumerate()
        .map(|(row, slopes)| (row, unknowns.iter().map(|&q| slopes[q]).collect()))
        .collect();
    let mut chosen = Vec::new();
    let mut free: Vec<usize> = (0..count).collect();
    while chosen.len() < count {
        let size = |(row, column): &(usize, usize)| left[*row].1[*column].abs();
        let places = (0..left.len()).flat_map(|row| free.iter().map(move |&column| (row, column)));
        let best = places.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        if size(&best).is_nan() || size(&best) <= 0.0 {
            return None;
        }
        let (row, pivot) = left.remove(best.0);
        free.retain(|&column| column != best.1);
        for (_, other) in &mut left {
            let factor = other[best.1] / pivot[best.1];
            other.iter_mut().zip(&pivot).for_each(|(entry, above)| *entry -= factor * above);
        }
        chosen.push(row);
    }
    chosen.sort_unstable();
    Some(chosen)
}
