//! Checks that a program fits a mechanism: all inputs, contacts, points and frames exist, and all quantities
//! have their shapes. Without this check a derivation of another mechanism would become code that does not
//! compile.

use super::Program;
use super::Quantity;
use super::graph::Input;
use super::operation::Operation;
use super::quantity::Extent;
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
            // an overdetermined loop has a residual for every one of its constraints
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

/// The shape of a quantity; `None` if the mechanism does not have it.
pub fn shape(mechanism: &Mechanism, quantity: Quantity) -> Option<(usize, usize)> {
    let gap = match quantity {
        Quantity::Contact(index, _) => mechanism.contacts.get(index as usize)?.gap.is_some(),
        Quantity::Point(index, _) => mechanism.points.get(index as usize).map(|_| false)?,
        Quantity::Orientation(index) => mechanism.frames.get(index as usize).map(|_| false)?,
        _ => false,
    };
    let p = mechanism.speeds.iter().filter(|speed| !speed.dependent).count();
    let c = mechanism.coordinates.iter().filter(|coordinate| coordinate.dependent).count();
    let directions = mechanism.independent_states() + mechanism.inputs.len();
    let [rows, columns] = quantity.description().shape.map(|extent| match extent {
        Extent::Count(count) => count,
        Extent::Coordinates => mechanism.coordinates.len(),
        Extent::IndependentCoordinates => mechanism.coordinates.len() - c,
        Extent::DependentCoordinates => c,
        Extent::Speeds => p,
        Extent::DependentSpeeds => mechanism.speeds.len() - p,
        Extent::States => mechanism.independent_states(),
        Extent::Directions => directions,
        Extent::ValueAndDirections => 1 + directions,
        Extent::Collision => 9 + 3 * p + usize::from(gap),
    });
    Some((rows, columns))
}
