//! The functions that CasADi calls, in safe code: numbers of all inputs in, numbers of all outputs out.

use std::marker::PhantomData;

use hodograph::{ComponentKind, Mechanism, State, StateError};

use crate::layout::Layout;

/// A function of CasADi.
pub trait Function {
    /// What it takes and gives.
    fn layout() -> Layout;
    /// Computes all outputs, one block after the other and each by columns, from all inputs, likewise.
    ///
    /// # Errors
    ///
    /// Those of the mechanism; what was written then has no meaning.
    fn evaluate(inputs: &[f64], outputs: &mut [f64]) -> Result<(), StateError>;
}

/// A generated module: its mechanism, and those derivatives that the trait [`Mechanism`] does not have.
/// [`external!`](crate::external) implements it.
///
/// Matrices are written by columns. Each routine answers the errors of the module.
pub trait Dynamics {
    /// The mechanism at the parameters of the model.
    fn mechanism() -> &'static dyn Mechanism<f64>;
    /// Derivatives of q' (n x (n + p + m)) by coordinates, speeds and inputs.
    fn coordinate_rates_derivatives(state: &State<'_>, matrix: &mut [f64]) -> Result<(), StateError>;
    /// Derivatives of u' (p x (n + p + m)) by coordinates, speeds and inputs.
    fn accelerations_derivatives(state: &State<'_>, matrix: &mut [f64]) -> Result<(), StateError>;
    /// Derivatives of the inverse dynamics (p x (n + p + m)) by coordinates, speeds and inputs.
    fn inverse_dynamics_derivatives(
        state: &State<'_>,
        acceleration: &[f64],
        matrix: &mut [f64],
    ) -> Result<(), StateError>;
}

/// n, p, m.
fn sizes<D: Dynamics>() -> [usize; 3] {
    [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
        .map(|kind| D::mechanism().count(kind))
}

/// Inputs and outputs without those that have no numbers, and the reason why a mechanism has no such
/// function.
fn layout<D: Dynamics>(inputs: &[(&str, usize)], outputs: &[(&str, usize)]) -> Layout {
    let some: Vec<_> = inputs.iter().copied().filter(|(name, size)| *name != "inputs" || *size > 0).collect();
    let mut layout = Layout::of_vectors(&some, outputs);
    let loops = D::mechanism().count(ComponentKind::DependentCoordinate);
    if loops > 0 {
        let name = D::mechanism().name();
        layout.refused = Some(format!(
            "{name} has closed loops, which determine {loops} of its coordinates: its rates are no function of freely chosen coordinates"
        ));
    }
    layout
}

/// Splits off the first `size` numbers; what is not there is left out.
fn part<'a>(numbers: &mut &'a [f64], size: usize) -> &'a [f64] {
    let (first, rest) = numbers.split_at(size.min(numbers.len()));
    *numbers = rest;
    first
}

/// As [`part`], of what is written.
fn part_mut<'a>(numbers: &mut &'a mut [f64], size: usize) -> &'a mut [f64] {
    let all = std::mem::take(numbers);
    let (first, rest) = all.split_at_mut(size.min(all.len()));
    *numbers = rest;
    first
}

/// q' and u' at q, u and inputs.
pub struct Rates<D>(PhantomData<D>);

impl<D: Dynamics> Function for Rates<D> {
    fn layout() -> Layout {
        let [n, p, m] = sizes::<D>();
        layout::<D>(&[("q", n), ("u", p), ("inputs", m)], &[("q_rates", n), ("u_rates", p)])
    }

    fn evaluate(mut inputs: &[f64], mut outputs: &mut [f64]) -> Result<(), StateError> {
        let state = state::<D>(&mut inputs);
        D::mechanism().coordinate_rates(&state, part_mut(&mut outputs, state.coordinates.len()))?;
        D::mechanism().accelerations(&state, outputs)
    }
}

fn state<'a, D: Dynamics>(inputs: &mut &'a [f64]) -> State<'a> {
    let [n, p, m] = sizes::<D>();
    let [coordinates, speeds, inputs] = [n, p, m].map(|size| part(inputs, size));
    State { time: 0.0, coordinates, speeds, inputs }
}

/// The derivatives of [`Rates`].
pub struct RatesJacobian<D>(PhantomData<D>);

impl<D: Dynamics> Function for RatesJacobian<D> {
    fn layout() -> Layout {
        Rates::<D>::layout().jacobian()
    }

    fn evaluate(mut inputs: &[f64], mut outputs: &mut [f64]) -> Result<(), StateError> {
        let state = state::<D>(&mut inputs);
        // the blocks of an output by all inputs are the columns of one matrix
        let columns: usize = sizes::<D>().iter().sum();
        let of_rates = part_mut(&mut outputs, state.coordinates.len() * columns);
        D::coordinate_rates_derivatives(&state, of_rates)?;
        D::accelerations_derivatives(&state, outputs)
    }
}

/// Generalised forces at q, u, u' and inputs.
pub struct InverseDynamics<D>(PhantomData<D>);

/// q, u, u' and inputs, in this order.
fn with_acceleration<'a, D: Dynamics>(mut numbers: &'a [f64]) -> (State<'a>, &'a [f64]) {
    let [n, p, m] = sizes::<D>();
    let [coordinates, speeds, acceleration, inputs] = [n, p, p, m].map(|size| part(&mut numbers, size));
    (State { time: 0.0, coordinates, speeds, inputs }, acceleration)
}

impl<D: Dynamics> Function for InverseDynamics<D> {
    fn layout() -> Layout {
        let [n, p, m] = sizes::<D>();
        layout::<D>(&[("q", n), ("u", p), ("acceleration", p), ("inputs", m)], &[("forces", p)])
    }

    fn evaluate(inputs: &[f64], outputs: &mut [f64]) -> Result<(), StateError> {
        let (state, acceleration) = with_acceleration::<D>(inputs);
        D::mechanism().inverse_dynamics(&state, acceleration, outputs)
    }
}

/// The derivatives of [`InverseDynamics`].
pub struct InverseDynamicsJacobian<D>(PhantomData<D>);

impl<D: Dynamics> Function for InverseDynamicsJacobian<D> {
    fn layout() -> Layout {
        InverseDynamics::<D>::layout().jacobian()
    }

    fn evaluate(inputs: &[f64], mut outputs: &mut [f64]) -> Result<(), StateError> {
        let (state, acceleration) = with_acceleration::<D>(inputs);
        let [n, p, m] = sizes::<D>();
        let mut by_state = vec![0.0; p * (n + p + m)];
        D::inverse_dynamics_derivatives(&state, acceleration, &mut by_state)?;
        let (by_state, by_inputs) = by_state.split_at(p * (n + p));
        part_mut(&mut outputs, p * (n + p)).copy_from_slice(by_state);
        // symmetric: by rows as by columns
        D::mechanism().mass_matrix(&state, part_mut(&mut outputs, p * p))?;
        outputs.copy_from_slice(by_inputs);
        Ok(())
    }
}
