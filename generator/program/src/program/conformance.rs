//! Checks that a program fits a mechanism: that all inputs, contacts, points and frames exist and all
//! quantities have their shapes. Without it a derivation of another mechanism would become code that does not
//! compile.

use super::Program;
use super::graph::Input;
use super::operation::Operation;
use super::{ContactQuantity, PointQuantity, Quantity};
use hodograph_model::model::mechanism::Mechanism;

/// Checks that every input, contact, point and frame exists and that every quantity has its shape.
pub fn fits(mechanism: &Mechanism, program: &Program) -> Result<(), String> {
    let independent = mechanism.speeds.iter().filter(|speed| !speed.dependent).count();
    let overdetermined = mechanism.determining_constraints.is_some();
    for operation in &program.operations {
        let Operation::Input(input) = *operation else { continue };
        let exists = match input {
            Input::Time => true,
            Input::Parameter(index) => {
                mechanism.parameters.get(index as usize).is_some_and(|parameter| !parameter.fixed)
            }
            Input::Coordinate(index) => (index as usize) < mechanism.coordinates.len(),
            Input::Speed(index) | Input::Acceleration(index) => (index as usize) < independent,
            Input::Input(index) => (index as usize) < mechanism.inputs.len(),
            Input::Tangent(index) => {
                (index as usize) < mechanism.independent_states() + mechanism.inputs.len()
            }
        };
        if !exists {
            return Err(format!("the derivation uses {input:?}, which the model does not have"));
        }
    }
    if program.structures.len() > mechanism.contacts.len() {
        return Err("the derivation has more contacts than the model".to_string());
    }
    for output in &program.outputs {
        let shape = shape(mechanism, output.quantity);
        let right = match shape {
            // of a loop with more constraints than it needs all are looked at
            Some((least, 1)) if output.quantity == Quantity::ConstraintResidual && overdetermined => {
                output.columns == 1 && output.rows >= least && output.rows <= 3 * mechanism.constraints.len()
            }
            Some((rows, columns)) => output.rows * output.columns == rows * columns,
            None => false,
        };
        if !right {
            return Err(format!(
                "the derivation's {} is {} x {}, which does not fit the model",
                output.quantity, output.rows, output.columns
            ));
        }
    }
    Ok(())
}

/// The shape of a quantity, if the mechanism can have it.
pub fn shape(mechanism: &Mechanism, quantity: Quantity) -> Option<(usize, usize)> {
    let p = mechanism.speeds.iter().filter(|speed| !speed.dependent).count();
    let d = mechanism.speeds.len() - p;
    let c = mechanism.coordinates.iter().filter(|coordinate| coordinate.dependent).count();
    Some(match quantity {
        Quantity::CoordinateRates => (mechanism.coordinates.len(), 1),
        Quantity::DependentSpeeds | Quantity::DependentAccelerations | Quantity::ConstraintResidual => (d, 1),
        Quantity::MassMatrix => (p, p),
        Quantity::Forcing | Quantity::Accelerations | Quantity::InverseDynamics => (p, 1),
        Quantity::StateTangent => (mechanism.independent_states(), 1),
        Quantity::AccelerationsDerivatives | Quantity::InverseDynamicsDerivatives => {
            (p, 1 + mechanism.independent_states() + mechanism.inputs.len())
        }
        Quantity::RatesDerivatives => {
            (mechanism.coordinates.len() - c, mechanism.independent_states() + mechanism.inputs.len())
        }
        Quantity::KineticEnergy | Quantity::PotentialEnergy => (1, 1),
        Quantity::ConfigurationResidual => (c, 1),
        Quantity::ConfigurationJacobian => (c, c),
        Quantity::Contact(index, quantity) => {
            mechanism.contacts.get(index as usize)?;
            match quantity {
                ContactQuantity::PartialVelocities => (3, p),
                ContactQuantity::Reduced => (6, 1),
                ContactQuantity::Response => (p, 3),
                ContactQuantity::DependentResponse => (d, 3),
                ContactQuantity::Gap => (1, 1),
                ContactQuantity::Tangent => {
                    let gap = mechanism.contacts.get(index as usize)?.gap.is_some();
                    (9 + 3 * p + usize::from(gap), 1)
                }
                ContactQuantity::Derivatives => {
                    let gap = mechanism.contacts.get(index as usize)?.gap.is_some();
                    let columns = 1 + mechanism.independent_states() + mechanism.inputs.len();
                    (9 + 3 * p + usize::from(gap), columns)
                }
                _ => (3, 1),
            }
        }
        Quantity::Point(index, quantity) => {
            mechanism.points.get(index as usize)?;
            if quantity == PointQuantity::Jacobian { (3, p) } else { (3, 1) }
        }
        Quantity::Orientation(index) => {
            mechanism.frames.get(index as usize)?;
            (3, 3)
        }
    })
}
