//! Implements the trait `Mechanism` by interpreting the program of a model.

use hodograph::generated::{check_length, normalise_quaternions, write};
use hodograph::nalgebra::{Matrix3, Vector3};
use hodograph::{Component, ComponentKind, Mechanism, ParameterError, State, StateError};
use hodograph_program::program::{PointQuantity, Quantity};

use crate::routines::Request;
use crate::{InterpretedMechanism, description, parameters};

impl InterpretedMechanism {
    /// The quantities that the program has and that are offered by name.
    fn named(&self) -> impl Iterator<Item = Quantity> + '_ {
        let has = |quantity: &Quantity| {
            self.program.output(*quantity).is_some_and(|output| !output.values.is_empty())
        };
        Quantity::named().filter(has)
    }

    /// Whether there is one of this number.
    pub(crate) fn exists(&self, kind: ComponentKind, index: usize) -> Result<(), StateError> {
        if index < Mechanism::count(self, kind) { Ok(()) } else { Err(StateError::Missing { kind, index }) }
    }

    fn vector_of_point(
        &self,
        point: usize,
        quantity: PointQuantity,
        state: &State<'_>,
        accelerations: &[f64],
        what: &'static str,
    ) -> Result<Vector3<f64>, StateError> {
        self.exists(ComponentKind::Point, point)?;
        let request = Request::Point(point, quantity);
        if point == 0 {
            self.check(state)?;
            Ok(Vector3::zeros())
        } else if self.has(request) {
            self.array::<3>(request, state, accelerations).map(Vector3::from)
        } else {
            Err(StateError::Undefined { what })
        }
    }
}

impl Mechanism for InterpretedMechanism {
    fn name(&self) -> &str {
        &self.model.name
    }

    fn count(&self, kind: ComponentKind) -> usize {
        match kind {
            ComponentKind::Quantity => self.named().count(),
            kind => description::count(&self.model, kind),
        }
    }

    fn component(&self, kind: ComponentKind, index: usize) -> Option<Component<'_>> {
        match kind {
            ComponentKind::Quantity => {
                let row = self.named().nth(index)?.description();
                Some(Component { name: row.word, unit: row.unit })
            }
            kind => description::component(&self.model, kind, index),
        }
    }

    fn dependent_coordinate(&self, index: usize) -> Option<usize> {
        self.dependent_coordinates().get(index).copied()
    }

    fn parameter_values(&self, values: &mut [f64]) -> Result<(), StateError> {
        let run_time = parameters::run_time(&self.model, self.all_parameters());
        write(values, &run_time, "parameters")
    }

    fn set_parameter_values(&mut self, parameters: &[f64]) -> Result<(), ParameterError> {
        self.change_parameters(parameters)
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
        normalise_quaternions(coordinates, self.quaternions());
        Ok(())
    }

    fn coordinate_rates(&self, state: &State<'_>, rates: &mut [f64]) -> Result<(), StateError> {
        let request = Request::Whole(Quantity::CoordinateRates);
        self.write(request, state, &[], rates, "the rates of the coordinates")
    }

    fn accelerations(&self, state: &State<'_>, accelerations: &mut [f64]) -> Result<(), StateError> {
        self.write(Request::Whole(Quantity::Accelerations), state, &[], accelerations, "the accelerations")
    }

    fn dependent_speeds(&self, state: &State<'_>, speeds: &mut [f64]) -> Result<(), StateError> {
        self.write(Request::Whole(Quantity::DependentSpeeds), state, &[], speeds, "the dependent speeds")
    }

    fn dependent_accelerations(
        &self,
        state: &State<'_>,
        accelerations: &mut [f64],
    ) -> Result<(), StateError> {
        let request = Request::Whole(Quantity::DependentAccelerations);
        self.write(request, state, &[], accelerations, "the dependent accelerations")
    }

    fn mass_matrix(&self, state: &State<'_>, matrix: &mut [f64]) -> Result<(), StateError> {
        self.write(Request::Whole(Quantity::MassMatrix), state, &[], matrix, "the mass matrix")
    }

    fn forcing(&self, state: &State<'_>, forcing: &mut [f64]) -> Result<(), StateError> {
        self.write(Request::Whole(Quantity::Forcing), state, &[], forcing, "the forcing")
    }

    fn inverse_dynamics(
        &self,
        state: &State<'_>,
        accelerations: &[f64],
        forces: &mut [f64],
    ) -> Result<(), StateError> {
        check_length(accelerations, self.freedom(), "the accelerations")?;
        let request = Request::Whole(Quantity::InverseDynamics);
        self.write(request, state, accelerations, forces, "the generalised forces")
    }

    fn kinetic_energy(&self, state: &State<'_>) -> Result<f64, StateError> {
        self.array::<1>(Request::Whole(Quantity::KineticEnergy), state, &[]).map(|[energy]| energy)
    }

    fn potential_energy(&self, state: &State<'_>) -> Result<Option<f64>, StateError> {
        let request = Request::Whole(Quantity::PotentialEnergy);
        let energy = self.array::<1>(request, state, &[]).map(|[energy]| energy)?;
        Ok(self.has(request).then_some(energy))
    }

    fn configuration(
        &self,
        state: &State<'_>,
        residual: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), StateError> {
        let what = "the residual of the configuration equations";
        self.write(Request::Whole(Quantity::ConfigurationResidual), state, &[], residual, what)?;
        let what = "the derivatives of the configuration equations";
        self.write(Request::Whole(Quantity::ConfigurationJacobian), state, &[], jacobian, what)
    }

    fn quantity_shape(&self, quantity: usize) -> Option<(usize, usize)> {
        let output = self.program.output(self.named().nth(quantity)?)?;
        Some((output.rows, output.columns))
    }

    fn quantity(&self, quantity: usize, state: &State<'_>, values: &mut [f64]) -> Result<(), StateError> {
        self.exists(ComponentKind::Quantity, quantity)?;
        let missing = StateError::Missing { kind: ComponentKind::Quantity, index: quantity };
        let quantity = self.named().nth(quantity).ok_or(missing)?;
        self.write(Request::Whole(quantity), state, &[], values, quantity.description().word)
    }

    fn position(&self, point: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        self.vector_of_point(point, PointQuantity::Position, state, &[], "position of this point")
    }

    fn velocity(&self, point: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        self.vector_of_point(point, PointQuantity::Velocity, state, &[], "velocity of this point")
    }

    fn acceleration(
        &self,
        point: usize,
        state: &State<'_>,
        accelerations: &[f64],
    ) -> Result<Vector3<f64>, StateError> {
        check_length(accelerations, self.freedom(), "the accelerations")?;
        let what = "acceleration of this point";
        self.vector_of_point(point, PointQuantity::Acceleration, state, accelerations, what)
    }

    fn jacobian(&self, point: usize, state: &State<'_>, jacobian: &mut [f64]) -> Result<(), StateError> {
        self.exists(ComponentKind::Point, point)?;
        if point == 0 {
            self.check(state)?;
            check_length(jacobian, 3 * self.freedom(), "the partial velocities")?;
            jacobian.fill(0.0);
            return Ok(());
        }
        let request = Request::Point(point, PointQuantity::Jacobian);
        self.write(request, state, &[], jacobian, "the partial velocities")
    }

    fn orientation(&self, frame: usize, state: &State<'_>) -> Result<Matrix3<f64>, StateError> {
        self.exists(ComponentKind::Frame, frame)?;
        let request = Request::Frame(frame);
        if frame == 0 {
            self.check(state)?;
            Ok(Matrix3::identity())
        } else if self.has(request) {
            let rows = self.array::<9>(request, state, &[])?;
            Ok(Matrix3::from_row_slice(&rows))
        } else {
            Err(StateError::Undefined { what: "orientation of this frame" })
        }
    }
}
