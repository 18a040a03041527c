//! The traits of all mechanisms, with slices in place of named fields: one integrator, controller or plot
//! written for them serves every mechanism.
//!
//! Every generated module implements [`Mechanism`] and [`Contacts`], and so does the interpreter of
//! derivations. Both traits can be used as trait objects (`&dyn Contacts`). Nothing here allocates: the
//! caller brings the slices.

mod closed;
mod contacts;
mod description;
mod error;
pub(crate) mod slices;

pub use closed::ContactOutcome;
pub use contacts::{ClosedContacts, CollisionOutcome, ContactState, Contacts, Distance, RelativeRotation};
pub use description::{Component, ComponentKind};
pub use error::{ClosedContactError, CollisionError, ParameterError, StateError};

use nalgebra::{Matrix3, Vector3};

use crate::Scalar;

/// A state, borrowed. Numbers stand in the order of the model, in the units that it declares.
///
/// ```
/// let state = hodograph::State { time: 0.0, coordinates: &[0.3], speeds: &[2.0], inputs: &[] };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<'a, T = f64> {
    /// time, s; models without explicit time do not read it
    pub time: T,
    /// generalised coordinates, independent and dependent ones
    pub coordinates: &'a [T],
    /// independent generalised speeds
    pub speeds: &'a [T],
    /// named inputs
    pub inputs: &'a [T],
}

/// The equations of motion of a mechanism, with slices in place of the named fields that the methods of its
/// own type have.
///
/// In the shapes below `n` is the number of coordinates, `p` that of independent and `d` that of dependent
/// speeds, `c` that of dependent coordinates; [`Mechanism::count`] tells them. Matrices are written by rows.
///
/// The type of a generated module has methods of the same names with named fields; Rust prefers these. To
/// call the methods of the trait, use the mechanism as `&dyn Mechanism` or in a generic function:
///
/// ```
/// use hodograph::{ComponentKind, Mechanism, State, StateError};
///
/// /// One step of Euler's method, whatever the mechanism.
/// fn step(mechanism: &dyn Mechanism, t: f64, dt: f64, q: &mut [f64], u: &mut [f64]) -> Result<(), StateError> {
///     let (mut q_rates, mut u_rates) = (vec![0.0; q.len()], vec![0.0; u.len()]);
///     let inputs = vec![0.0; mechanism.count(ComponentKind::Input)];
///     let state = State { time: t, coordinates: q, speeds: u, inputs: &inputs };
///     mechanism.coordinate_rates(&state, &mut q_rates)?;
///     mechanism.accelerations(&state, &mut u_rates)?;
///     q.iter_mut().zip(q_rates).for_each(|(q, rate)| *q += dt * rate);
///     u.iter_mut().zip(u_rates).for_each(|(u, rate)| *u += dt * rate);
///     mechanism.normalise(q)
/// }
/// ```
///
/// # Errors
///
/// Every routine answers [`StateError`] where a slice has not the length asked for, the state is singular, or
/// a result is not finite. What it wrote into the slices then has no meaning.
pub trait Mechanism<T: Scalar = f64> {
    /// The name of the mechanism in the model.
    fn name(&self) -> &str;
    /// How many of a kind it has.
    fn count(&self, kind: ComponentKind) -> usize;
    /// Name and unit of one of a kind; `None` past the last.
    fn component(&self, kind: ComponentKind, index: usize) -> Option<Component<'_>>;
    /// The number of the one with this name, as the model spells it; `None` if there is none.
    fn index(&self, kind: ComponentKind, name: &str) -> Option<usize> {
        (0..self.count(kind))
            .find(|&index| self.component(kind, index).is_some_and(|found| found.name == name))
    }
    /// The number among the coordinates of the dependent coordinate with this number; `None` past the last.
    /// The configuration equations of closed loops determine dependent coordinates.
    fn dependent_coordinate(&self, index: usize) -> Option<usize>;

    /// The parameters in use, in the order of [`ComponentKind::Parameter`].
    fn parameter_values(&self, parameters: &mut [T]) -> Result<(), StateError>;
    /// Changes the parameters. Where they are refused, the mechanism stays as it is.
    fn set_parameter_values(&mut self, parameters: &[T]) -> Result<(), ParameterError>;
    /// The coordinates (`n`), speeds (`p`) and inputs that the model states; 0 where it states none, and the
    /// identity for a quaternion. Dependent coordinates are the model's guess.
    fn initial_state(
        &self,
        coordinates: &mut [T],
        speeds: &mut [T],
        inputs: &mut [T],
    ) -> Result<(), StateError>;
    /// Divides every quaternion among the coordinates (`n`) by its length: integration lets it drift from 1.
    /// A quaternion of length 0 stays as it is.
    fn normalise(&self, coordinates: &mut [T]) -> Result<(), StateError>;

    /// Rates q' of the coordinates (`n`), per second.
    fn coordinate_rates(&self, state: &State<'_, T>, rates: &mut [T]) -> Result<(), StateError>;
    #[doc(alias = "ABA")]
    /// Rates u' of the independent speeds (`p`), per second, without contact forces.
    fn accelerations(&self, state: &State<'_, T>, accelerations: &mut [T]) -> Result<(), StateError>;
    /// Dependent speeds (`d`).
    fn dependent_speeds(&self, state: &State<'_, T>, speeds: &mut [T]) -> Result<(), StateError>;
    /// Rates of the dependent speeds (`d`), per second, without contact forces.
    fn dependent_accelerations(
        &self,
        state: &State<'_, T>,
        accelerations: &mut [T],
    ) -> Result<(), StateError>;
    #[doc(alias = "CRBA")]
    /// Mass matrix M of the independent speeds (`p` x `p`).
    fn mass_matrix(&self, state: &State<'_, T>, matrix: &mut [T]) -> Result<(), StateError>;
    /// Forcing (`p`): M u' = forcing.
    fn forcing(&self, state: &State<'_, T>, forcing: &mut [T]) -> Result<(), StateError>;
    #[doc(alias = "RNEA")]
    /// Generalised forces (`p`) that must be added to the loads for the independent speeds to have the rates
    /// `accelerations` (`p`).
    fn inverse_dynamics(
        &self,
        state: &State<'_, T>,
        accelerations: &[T],
        forces: &mut [T],
    ) -> Result<(), StateError>;
    /// Kinetic energy in N, J.
    fn kinetic_energy(&self, state: &State<'_, T>) -> Result<T, StateError>;
    /// Potential energy of gravity and springs, J; `None` where the model has neither.
    fn potential_energy(&self, state: &State<'_, T>) -> Result<Option<T>, StateError>;
    /// The configuration equations of closed loops: their residual (`c`), zero where the loops are closed,
    /// and its derivatives (`c` x `c`) with respect to the dependent coordinates.
    fn configuration(
        &self,
        state: &State<'_, T>,
        residual: &mut [T],
        jacobian: &mut [T],
    ) -> Result<(), StateError>;

    /// Rows and columns of a quantity of [`ComponentKind::Quantity`]; `None` past the last.
    fn quantity_shape(&self, quantity: usize) -> Option<(usize, usize)> {
        let _ = quantity;
        None
    }
    /// Computes a quantity of [`ComponentKind::Quantity`], by rows; [`Mechanism::component`] has its name and unit. Where
    /// all positions are known these are `momentum`, `angular_momentum` (about O), `central_angular_momentum`
    /// (about the mass centre), `mass_centre_position` and `mass_centre_velocity`, along N.x, N.y, N.z. A
    /// mechanism lacks those that its model does not determine.
    fn quantity(&self, quantity: usize, state: &State<'_, T>, values: &mut [T]) -> Result<(), StateError> {
        let _ = (state, values);
        Err(StateError::Missing { kind: ComponentKind::Quantity, index: quantity })
    }
    /// Angular momentum of all bodies about a point of the model, along N.x, N.y, N.z, kg m^2/s: that about O
    /// less r x P, with the position r of the point and the momentum P. Point 0 is O. The velocity of the point
    /// does not enter.
    ///
    /// # Errors
    ///
    /// [`StateError::Undefined`] where the model does not determine the place of the bodies or of the point.
    fn angular_momentum_about(&self, point: usize, state: &State<'_, T>) -> Result<Vector3<T>, StateError> {
        let named = |name: &str| {
            let undefined = StateError::Undefined { what: "angular momentum about this point" };
            let index = self.index(ComponentKind::Quantity, name).ok_or(undefined)?;
            let mut values = [T::zero(); 3];
            self.quantity(index, state, &mut values)?;
            Ok(Vector3::from(values))
        };
        let position = self.position(point, state)?;
        Ok(named("angular_momentum")? - position.cross(&named("momentum")?))
    }

    /// Position of a point from O along N.x, N.y, N.z, m. [`StateError::Undefined`] for a point of which the
    /// model knows the velocity only.
    fn position(&self, point: usize, state: &State<'_, T>) -> Result<Vector3<T>, StateError>;
    /// Velocity of a point in N along N.x, N.y, N.z, m/s.
    fn velocity(&self, point: usize, state: &State<'_, T>) -> Result<Vector3<T>, StateError>;
    /// Acceleration of a point in N along N.x, N.y, N.z, m/s^2, while the independent speeds have the rates
    /// `accelerations` (`p`): those of [`Mechanism::accelerations`], or with contact forces.
    fn acceleration(
        &self,
        point: usize,
        state: &State<'_, T>,
        accelerations: &[T],
    ) -> Result<Vector3<T>, StateError>;
    /// Partial velocities of a point (3 x `p`) along N.x, N.y, N.z (rows) for the independent speeds
    /// (columns).
    fn jacobian(&self, point: usize, state: &State<'_, T>, jacobian: &mut [T]) -> Result<(), StateError>;
    /// Axes of a frame: the columns are its x, y, z along N.x, N.y, N.z. [`StateError::Undefined`] for a
    /// frame of which the model knows the angular velocity only.
    fn orientation(&self, frame: usize, state: &State<'_, T>) -> Result<Matrix3<T>, StateError>;
}
