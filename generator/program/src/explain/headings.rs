//! Titles, symbols and units of the quantities of a mechanism, and the left sides of their equations.

use super::Left;
use crate::program::{ContactQuantity, Output, PointQuantity, Quantity};
use hodograph_model::model::mechanism::{Mechanism, Variable};

/// What stands over the equations of a quantity.
pub struct Heading {
    /// what it belongs to, such as a contact; may be empty
    pub group: String,
    /// what it is
    pub title: &'static str,
    /// its symbol
    pub symbol: &'static str,
    /// its unit, or in which units its entries are; may be empty
    pub unit: &'static str,
}

/// The heading of a quantity.
pub fn heading(mechanism: &Mechanism, quantity: Quantity) -> Heading {
    let plain = |title, symbol, unit| Heading { group: String::new(), title, symbol, unit };
    match quantity {
        Quantity::CoordinateRates => plain("Rates of the coordinates", "q", ""),
        Quantity::DependentSpeeds => plain("Dependent speeds", "u", ""),
        Quantity::MassMatrix => plain(
            "Mass matrix",
            "M",
            "kg for two speeds in m/s, kg*m^2 for two in rad/s, kg*m for one of each",
        ),
        Quantity::Forcing => plain("Forcing: M du/dt = F", "F", "N for a speed in m/s, N*m for one in rad/s"),
        Quantity::Accelerations => plain("Accelerations", "a", ""),
        Quantity::DependentAccelerations => plain("Rates of the dependent speeds", "a", ""),
        Quantity::InverseDynamics => {
            plain("Inverse dynamics", "Q", "N for a speed in m/s, N*m for one in rad/s")
        }
        Quantity::StateTangent => plain("Linearised rates", "l", ""),
        Quantity::AccelerationsDerivatives => plain("Accelerations, and their derivatives", "A", ""),
        Quantity::InverseDynamicsDerivatives => plain("Inverse dynamics, and its derivatives", "Q", ""),
        Quantity::RatesDerivatives => plain("Derivatives of the rates of the coordinates", "L", ""),
        Quantity::KineticEnergy => plain("Kinetic energy", "K", "J"),
        Quantity::PotentialEnergy => plain("Potential energy", "W", "J"),
        Quantity::ConfigurationResidual => plain("Configuration equations", "c", ""),
        Quantity::ConfigurationJacobian => plain("Their derivatives by the dependent coordinates", "J", ""),
        Quantity::ConstraintResidual => plain("Velocity constraints", "r", ""),
        Quantity::Contact(index, quantity) => {
            let name = mechanism.contacts.get(index as usize).map_or("?", |contact| &contact.name);
            Heading { group: format!("Contact {name}"), ..contact(quantity) }
        }
        Quantity::Point(index, quantity) => {
            let name = mechanism.points.get(index as usize).map_or("?", |point| &point.name);
            let (title, symbol, unit) = match quantity {
                PointQuantity::Position => ("position along N.x, N.y, N.z", "p", "m"),
                PointQuantity::Velocity => ("velocity along N.x, N.y, N.z", "v", "m/s"),
                PointQuantity::Acceleration => ("acceleration along N.x, N.y, N.z", "a", "m/s^2"),
                PointQuantity::Jacobian => ("partial velocities along N.x, N.y, N.z", "V", ""),
            };
            Heading { group: format!("Point {name}"), title, symbol, unit }
        }
        Quantity::Orientation(index) => {
            let name = mechanism.frames.get(index as usize).map_or("?", |frame| &frame.name);
            Heading { group: format!("Frame {name}"), title: "its axes in N", symbol: "R", unit: "" }
        }
    }
}

fn contact(quantity: ContactQuantity) -> Heading {
    use ContactQuantity::*;
    let (title, symbol, unit) = match quantity {
        Normal => ("normal along N.x, N.y, N.z", "n", ""),
        First => ("first tangential axis along N.x, N.y, N.z", "t", ""),
        Second => ("second tangential axis along N.x, N.y, N.z", "s", ""),
        Velocity => ("relative velocity along n, t, s", "v", "m/s"),
        FreeAcceleration => {
            ("rates of the relative velocity without contact forces, along n, t, s", "b", "m/s^2")
        }
        PartialVelocities => ("partial velocities: rows n, t, s", "V", ""),
        Remainder => ("velocity that depends on no speed, along n, t, s", "r", "m/s"),
        Reduced => ("reduced matrix along n, t, s", "m", "1/kg"),
        Response => ("change of the speeds per unit impulse", "R", ""),
        DependentResponse => ("change of the dependent speeds per unit impulse", "D", ""),
        Gap => ("gap", "d", "m"),
        PrescribedWork => ("work of prescribed motion per unit impulse", "w", "m/s"),
        Tangent => ("derivatives of velocity, reduced matrix, response and gap", "l", ""),
        Derivatives => ("velocity, reduced matrix, response and gap (rows) with their derivatives", "l", ""),
    };
    Heading { group: String::new(), title, symbol, unit }
}

/// The left sides of the equations of a quantity, with its symbol.
pub fn lefts(mechanism: &Mechanism, output: &Output, symbol: &str) -> Vec<Left> {
    let own = |list: &mut dyn Iterator<Item = &Variable>, rate: bool| -> Vec<Left> {
        list.map(|name| Left::Of(name.name.clone(), rate)).collect()
    };
    let speeds = |dependent: bool| mechanism.speeds.iter().filter(move |speed| speed.dependent == dependent);
    match output.quantity {
        Quantity::CoordinateRates => return own(&mut mechanism.coordinates.iter(), true),
        Quantity::DependentSpeeds => return own(&mut speeds(true), false),
        Quantity::Accelerations => return own(&mut speeds(false), true),
        Quantity::DependentAccelerations => return own(&mut speeds(true), true),
        _ => {}
    }
    let entry = |indices: Vec<String>| Left::Entry(symbol.to_owned(), indices);
    if let Quantity::Contact(_, ContactQuantity::Reduced) = output.quantity {
        return ["nn", "nt", "ns", "tt", "ts", "ss"].map(|pair| entry(vec![pair.to_owned()])).into();
    }
    let [rows, columns] = axes(output.quantity);
    let index = |axes: Option<[char; 3]>, number: usize| match axes.and_then(|axes| axes.get(number).copied())
    {
        Some(axis) => axis.to_string(),
        None => (number + 1).to_string(),
    };
    let mut lefts = Vec::new();
    for row in 0..output.rows {
        for column in 0..output.columns {
            let mut indices = Vec::new();
            if output.rows > 1 {
                indices.push(index(rows, row));
            }
            if output.columns > 1 {
                indices.push(index(columns, column));
            }
            lefts.push(entry(indices));
        }
    }
    lefts
}

/// The axes that the rows and the columns of a quantity belong to, where they do.
fn axes(quantity: Quantity) -> [Option<[char; 3]>; 2] {
    use ContactQuantity::*;
    let (space, contact) = (Some(['x', 'y', 'z']), Some(['n', 't', 's']));
    match quantity {
        Quantity::Contact(_, Normal | First | Second) => [space, None],
        Quantity::Contact(
            _,
            Velocity | FreeAcceleration | PartialVelocities | Remainder | PrescribedWork,
        ) => [contact, None],
        Quantity::Contact(_, Response | DependentResponse) => [None, contact],
        Quantity::Point(..) => [space, None],
        Quantity::Orientation(_) => [space, space],
        _ => [None, None],
    }
}

/// Which equations stand in which row of a matrix; nothing for what is no matrix.
pub fn matrix(output: &Output) -> Vec<Vec<usize>> {
    match output.quantity {
        Quantity::Contact(_, ContactQuantity::Reduced) => vec![vec![0, 1, 2], vec![1, 3, 4], vec![2, 4, 5]],
        Quantity::CoordinateRates
        | Quantity::DependentSpeeds
        | Quantity::Accelerations
        | Quantity::DependentAccelerations
        | Quantity::Contact(_, ContactQuantity::Tangent) => Vec::new(),
        _ if output.rows * output.columns < 2 => Vec::new(),
        _ => (0..output.rows)
            .map(|row| (0..output.columns).map(|column| row * output.columns + column).collect())
            .collect(),
    }
}
