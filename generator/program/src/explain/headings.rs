//! Titles, symbols and units of the quantities of a mechanism, and the left sides of their equations.

use super::Left;
use crate::program::quantity::{Axes, Description, Entries};
use crate::program::{Output, Quantity};
use hodograph_model::model::mechanism::{Mechanism, Variable};

/// The heading of the equations of a quantity.
pub struct Heading {
    /// the contact, point or frame that the quantity belongs to; empty for a quantity of the whole mechanism
    pub group: String,
    /// its title
    pub title: &'static str,
    /// its symbol
    pub symbol: &'static str,
    /// its unit, or the units of its entries; may be empty
    pub unit: &'static str,
}

/// The heading of a quantity.
pub fn heading(mechanism: &Mechanism, quantity: Quantity) -> Heading {
    let of = |kind: &str, name: Option<&String>| format!("{kind} {}", name.map_or("?", String::as_str));
    let group = match quantity {
        Quantity::Contact(index, _) => {
            of("Contact", mechanism.contacts.get(index as usize).map(|contact| &contact.name))
        }
        Quantity::Point(index, _) => {
            of("Point", mechanism.points.get(index as usize).map(|point| &point.name))
        }
        Quantity::Orientation(index) => {
            of("Frame", mechanism.frames.get(index as usize).map(|frame| &frame.name))
        }
        _ => String::new(),
    };
    let Description { title, symbol, unit, .. } = *quantity.description();
    Heading { group, title, symbol, unit }
}

/// The left sides of the equations of a quantity, with its symbol.
pub fn lefts(mechanism: &Mechanism, output: &Output, symbol: &str) -> Vec<Left> {
    let own = |list: &mut dyn Iterator<Item = &Variable>, rate: bool| -> Vec<Left> {
        list.map(|name| Left::Of(name.name.clone(), rate)).collect()
    };
    let speeds = |dependent: bool| mechanism.speeds.iter().filter(move |speed| speed.dependent == dependent);
    let entry = |indices: Vec<String>| Left::Entry(symbol.to_owned(), indices);
    let description = output.quantity.description();
    match description.entries {
        Entries::RatesOfCoordinates => return own(&mut mechanism.coordinates.iter(), true),
        Entries::DependentSpeeds => return own(&mut speeds(true), false),
        Entries::RatesOfSpeeds => return own(&mut speeds(false), true),
        Entries::RatesOfDependentSpeeds => return own(&mut speeds(true), true),
        Entries::Symmetric => {
            return ["nn", "nt", "ns", "tt", "ts", "ss"].map(|pair| entry(vec![pair.to_owned()])).into();
        }
        Entries::Scalar | Entries::Numbers | Entries::ValueAndDerivatives | Entries::Lists => {}
    }
    let [rows, columns] = description.axes.map(axis_names);
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

/// The names of the axes.
fn axis_names(axes: Axes) -> Option<[char; 3]> {
    match axes {
        Axes::None => None,
        Axes::Space => Some(['x', 'y', 'z']),
        Axes::Contact => Some(['n', 't', 's']),
    }
}

/// For each row of a matrix the indices of its equations; empty if the output is not a matrix.
pub fn matrix(output: &Output) -> Vec<Vec<usize>> {
    match output.quantity.description().entries {
        Entries::Symmetric => vec![vec![0, 1, 2], vec![1, 3, 4], vec![2, 4, 5]],
        Entries::Numbers | Entries::ValueAndDerivatives if output.rows * output.columns >= 2 => (0..output
            .rows)
            .map(|row| (0..output.columns).map(|column| row * output.columns + column).collect())
            .collect(),
        _ => Vec::new(),
    }
}
