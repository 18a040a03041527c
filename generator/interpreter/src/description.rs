//! What a model declares, as the trait `Mechanism` describes it.

use hodograph::generated::write;
use hodograph::{Component, ComponentKind, StateError};
use hodograph_model::model::mechanism::{Mechanism, Orientation, Variable};
use hodograph_model::numeric;

/// The quantities of a kind that a model declares with units.
pub fn declared(model: &Mechanism, kind: ComponentKind) -> Box<dyn Iterator<Item = &Variable> + '_> {
    match kind {
        ComponentKind::Parameter => Box::new(model.parameters.iter().filter(|parameter| !parameter.fixed)),
        ComponentKind::Coordinate => Box::new(model.coordinates.iter()),
        ComponentKind::DependentCoordinate => Box::new(model.coordinates.iter().filter(|q| q.dependent)),
        ComponentKind::Speed => Box::new(model.speeds.iter().filter(|speed| !speed.dependent)),
        ComponentKind::DependentSpeed => Box::new(model.speeds.iter().filter(|speed| speed.dependent)),
        ComponentKind::Input => Box::new(model.inputs.iter()),
        _ => Box::new(std::iter::empty()),
    }
}

/// How many of a kind a model has; of named quantities it knows nothing.
pub fn count(model: &Mechanism, kind: ComponentKind) -> usize {
    match kind {
        ComponentKind::Point => model.points.len(),
        ComponentKind::Frame => model.frames.len(),
        ComponentKind::Contact => model.contacts.len(),
        kind => declared(model, kind).count(),
    }
}

/// Name and unit of one of a kind.
pub fn component(model: &Mechanism, kind: ComponentKind, index: usize) -> Option<Component<'_>> {
    let named = |name| Component { name, unit: "" };
    match kind {
        ComponentKind::Point => model.points.get(index).map(|point| named(point.name.as_str())),
        ComponentKind::Frame => model.frames.get(index).map(|frame| named(frame.name.as_str())),
        ComponentKind::Contact => model.contacts.get(index).map(|contact| named(contact.name.as_str())),
        kind => declared(model, kind).nth(index).map(|quantity| Component {
            name: &quantity.name,
            unit: if quantity.unit.is_empty() { "1" } else { &quantity.unit },
        }),
    }
}

/// Writes the values that the model states: of coordinates, independent speeds and inputs.
///
/// # Errors
///
/// A slice has another length.
pub fn initial_state(model: &Mechanism, slices: [&mut [f64]; 3]) -> Result<(), StateError> {
    let state = numeric::State::of(model);
    let [coordinates, speeds, inputs] = slices;
    write(coordinates, &state.coordinates, "coordinates")?;
    write(speeds, &state.speeds, "speeds")?;
    write(inputs, &state.inputs, "inputs")
}

/// The numbers of the coordinates of each quaternion.
pub fn quaternions(model: &Mechanism) -> Vec<[usize; 4]> {
    let of_frame = |orientation: &Orientation| match orientation {
        Orientation::Quaternion(ids) => Some(ids.map(|id| id.0)),
        _ => None,
    };
    model.frames.iter().filter_map(|frame| of_frame(&frame.orientation)).collect()
}

/// The numbers of the dependent coordinates.
pub fn dependent_coordinates(model: &Mechanism) -> Vec<usize> {
    let all = model.coordinates.iter().enumerate();
    all.filter(|(_, coordinate)| coordinate.dependent).map(|(index, _)| index).collect()
}

/// Number of independent speeds.
pub fn freedom(model: &Mechanism) -> usize {
    model.speeds.iter().filter(|speed| !speed.dependent).count()
}
