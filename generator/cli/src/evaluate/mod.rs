//! Evaluates a model in a state and returns the numbers that `eval` writes.

pub mod assembly;
pub mod collision;
pub mod contact;
pub mod report;
pub mod tables;

use hodograph::Cause;
use hodograph_generator::check::{ROUNDED_QUATERNION, UNIT_QUATERNION, impossible_bodies, impossible_sizes};
use hodograph_generator::diagnostics::codes;
use hodograph_generator::interpret::{self, Evaluator};
use hodograph_generator::model::mechanism::{Mechanism, Orientation, Variable};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::Program;
use hodograph_generator::program::{ContactQuantity, Quantity};
use hodograph_interpreter::{Error, InterpretedMechanism};

use crate::json::state::State;
use crate::json::{Failure, Kind};

/// A model and its program, without fixed parameters: each state has its own. Every quantity can be
/// evaluated; [`Machine::interpreted`] fixes the parameters and implements the traits that a simulation
/// needs.
#[derive(Clone, Debug)]
pub struct Machine {
    /// the model
    pub mechanism: Mechanism,
    /// its equations
    pub program: Program,
}

/// The values of some quantities.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    arrays: Vec<interpret::Array>,
}

impl Numbers {
    /// A quantity by rows; empty if the mechanism does not have it (no dependent speeds, say).
    pub fn get(&self, quantity: Quantity) -> &[f64] {
        self.arrays.iter().find(|array| array.quantity == quantity).map_or(&[], |array| &array.values)
    }

    /// The rows of a quantity.
    pub fn rows(&self, quantity: Quantity) -> Vec<&[f64]> {
        self.arrays
            .iter()
            .find(|array| array.quantity == quantity)
            .map_or(Vec::new(), |array| array.rows().collect())
    }

    /// A quantity of a contact.
    pub fn of_contact(&self, contact: usize, quantity: ContactQuantity) -> &[f64] {
        self.get(Quantity::Contact(contact as u32, quantity))
    }

    /// A quantity of a contact that has three components.
    pub fn three(&self, contact: usize, quantity: ContactQuantity) -> [f64; 3] {
        let mut three = [0.0; 3];
        for (slot, &number) in three.iter_mut().zip(self.of_contact(contact, quantity)) {
            *slot = number;
        }
        three
    }
}

impl Machine {
    /// Values of those of the quantities that the mechanism has.
    ///
    /// # Errors
    ///
    /// `singular_state`; `inconsistent_state` if the mass matrix is requested and not positive definite.
    pub fn evaluate(&self, state: &State, quantities: &[Quantity]) -> Result<Numbers, Failure> {
        let inputs = Inputs {
            parameters: state.parameters.clone(),
            time: state.time,
            coordinates: state.coordinates.clone(),
            speeds: state.speeds.clone(),
            inputs: state.inputs.clone(),
            accelerations: Vec::new(),
            tangent: Vec::new(),
        };
        let there: Vec<Quantity> = quantities
            .iter()
            .copied()
            .filter(|&quantity| self.program.output(quantity).is_some_and(|output| !output.values.is_empty()))
            .collect();
        let arrays =
            Evaluator::new(&self.program).evaluate(&inputs, &there).map_err(|failure| match failure {
                interpret::Failure::Singular { message, value, coordinates } => {
                    let place = coordinates.iter().map(|&index| index as usize).map(|index| {
                        format!("{} = {}, ", self.mechanism.coordinates[index].name, state.coordinates[index])
                    });
                    let place: String = place.collect();
                    let cure = self.cure(state);
                    Failure::new(
                        Kind::Of(Cause::SingularState),
                        format!("the state is singular: {message} ({place}a divisor is {value:e}): {cure}"),
                    )
                }
                other => Failure::new(Kind::Of(Cause::SingularState), other.to_string()),
            })?;
        for array in arrays.iter().filter(|array| array.quantity == Quantity::MassMatrix) {
            if !positive_definite(array) {
                return Err(Failure::new(
                    Kind::InconsistentState,
                    "the mass matrix is not positive definite, which no mechanism's is: check the masses and inertias \
                     among the parameters",
                ));
            }
        }
        Ok(Numbers { arrays: arrays.into_iter().map(positive_zeros).collect() })
    }

    /// What to do if the equations cannot be evaluated in a state: parameters that were set to zero are the
    /// first suspects.
    fn cure(&self, state: &State) -> String {
        let parameters = self.mechanism.parameters.iter().zip(&state.parameters);
        let made_zero = |parameter: &Variable| parameter.value.is_some_and(|value| value != 0.0);
        let suspects: Vec<String> = parameters
            .filter(|(parameter, value)| **value == 0.0 && made_zero(parameter))
            .map(|(parameter, _)| {
                format!("{} is 0 ({} in the model)", parameter.name, parameter.value.unwrap_or(0.0))
            })
            .collect();
        match suspects.is_empty() {
            true => "choose another state, or other parameters".to_owned(),
            false => format!("change the parameters: {}", suspects.join(", ")),
        }
    }

    /// The mechanism with the parameters of a state.
    ///
    /// # Errors
    ///
    /// The cause for which these parameters are impossible, such as `singular_parameters`.
    pub fn interpreted(&self, state: &State) -> Result<InterpretedMechanism, Failure> {
        let all = self.mechanism.parameters.iter().zip(&state.parameters);
        let free: Vec<f64> = all.filter(|(parameter, _)| !parameter.fixed).map(|(_, value)| *value).collect();
        InterpretedMechanism::with_parameters(self.mechanism.clone(), self.program.clone(), &free).map_err(
            |error| match error {
                Error::Parameters(error) => Failure::new(Kind::Of(error.cause()), error.to_string()),
                error => Failure::new(Kind::InconsistentState, error.to_string()),
            },
        )
    }

    /// The index of the contact with that name; without a name, of the only contact.
    ///
    /// # Errors
    ///
    /// `unknown_name`.
    pub fn contact(&self, name: Option<&str>) -> Result<usize, Failure> {
        let contacts = &self.mechanism.contacts;
        let names = || contacts.iter().map(|contact| contact.name.as_str());
        let unknown = |message: String| Failure::new(Kind::UnknownName, message);
        match name {
            Some(name) => names().position(|other| other == name).ok_or_else(|| {
                let hint = crate::spelling::hint(name, names().collect::<Vec<_>>());
                unknown(format!("there is no contact `{name}`: {hint}"))
            }),
            None if contacts.len() == 1 => Ok(0),
            None => {
                let hint = crate::spelling::hint("", names().collect::<Vec<_>>());
                let (name, count) = (&self.mechanism.name, contacts.len());
                Err(unknown(format!("{name} has {count} contacts: say which with --contact; {hint}")))
            }
        }
    }

    /// The state, after quaternions and loops have been checked, with completed dependent coordinates.
    ///
    /// # Errors
    ///
    /// `impossible_mass`, `impossible_inertia`, `impossible_size`, `inconsistent_state`, `singular_state`.
    pub fn complete(&self, mut state: State) -> Result<State, Failure> {
        self.check_bodies(&state)?;
        self.check_shapes(&state)?;
        self.normalise_quaternions(&mut state)?;
        assembly::assemble(self, &mut state)?;
        assembly::check_loops(self, &state)?;
        Ok(state)
    }

    /// Checks that every mass is positive and every inertia possible; the generated constructor refuses the
    /// same parameters.
    fn check_bodies(&self, state: &State) -> Result<(), Failure> {
        let impossible = impossible_bodies(&self.mechanism, &state.to_numeric());
        let Some(found) = impossible.first() else { return Ok(()) };
        let body = &self.mechanism.bodies[found.body.0].name;
        let what = &found.what;
        let (cause, message) = if found.code == codes::MASS {
            (
                Cause::ImpossibleMass,
                format!("the mass of `{body}` is not positive: with these parameters it {what}"),
            )
        } else {
            let message = format!("no body has the inertia of `{body}`: with these parameters {what}");
            (Cause::ImpossibleInertia, message)
        };
        Err(Failure::new(Kind::Of(cause), message))
    }

    /// Checks that every dimension of a shape is positive; the generated constructor refuses the same parameters.
    fn check_shapes(&self, state: &State) -> Result<(), Failure> {
        let impossible = impossible_sizes(&self.mechanism, &state.to_numeric());
        let Some(found) = impossible.first() else { return Ok(()) };
        let shape = &self.mechanism.shapes[found.shape.0];
        let message = format!(
            "the {} of `{}` is not positive: with these parameters it is {} m",
            found.name, shape.name, found.value
        );
        Err(Failure::new(Kind::Of(Cause::ImpossibleSize), message))
    }

    /// Normalises quaternions that are rounded, since the equations hold for unit quaternions only. Others
    /// are an error: it cannot be guessed what was meant.
    fn normalise_quaternions(&self, state: &mut State) -> Result<(), Failure> {
        for frame in &self.mechanism.frames {
            let Orientation::Quaternion(parts) = frame.orientation else { continue };
            let numbers = parts.map(|part| state.coordinates[part.0]);
            let norm = numbers.iter().map(|number| number * number).sum::<f64>().sqrt();
            let off = (norm - 1.0).abs();
            if off > UNIT_QUATERNION && off <= ROUNDED_QUATERNION {
                parts.iter().for_each(|part| state.coordinates[part.0] /= norm);
            } else if off.is_nan() || off > ROUNDED_QUATERNION {
                let names = parts.map(|part| self.mechanism.coordinates[part.0].name.as_str()).join(", ");
                let advice = match norm > 0.0 && norm.is_finite() {
                    true => format!("divided by it they are {:?}", numbers.map(|number| number / norm)),
                    false => "1, 0, 0, 0 is no rotation".to_owned(),
                };
                return Err(Failure::new(
                    Kind::InconsistentState,
                    format!(
                        "the quaternion {names} of frame {} has norm {norm}, not 1: {advice}",
                        frame.name
                    ),
                ));
            }
        }
        Ok(())
    }
}

/// Whether the symmetric matrix has positive pivots.
fn positive_definite(matrix: &interpret::Array) -> bool {
    let mut rows: Vec<Vec<f64>> = matrix.rows().map(<[f64]>::to_vec).collect();
    for step in 0..rows.len() {
        let row = rows[step].clone();
        if row[step].is_nan() || row[step] <= 0.0 {
            return false;
        }
        for below in &mut rows[step + 1..] {
            let factor = below[step] / row[step];
            below.iter_mut().zip(&row).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    true
}

/// Replaces negative zeros by positive ones for readers.
fn positive_zeros(mut array: interpret::Array) -> interpret::Array {
    array.values.iter_mut().for_each(|value| *value += 0.0);
    array
}

/// Some of the names, for messages.
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}
