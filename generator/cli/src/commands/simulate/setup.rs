//! What a motion is the motion of, for its page.

use std::path::Path;

use hodograph::Surface;
use hodograph_animation::{Setup, Value};
use hodograph_generator::files;
use hodograph_generator::format::plain;
use hodograph_generator::model::mechanism::{Mechanism, Variable};

use crate::json::state::State;

/// The setup of a motion from a state.
pub fn setup(path: &Path, model: &Mechanism, state: &State, surfaces: &[(usize, Surface<f64>)]) -> Setup {
    let value = |(quantity, &value): (&Variable, &f64)| Value {
        name: quantity.name.clone(),
        value,
        unit: if quantity.unit == "1" { String::new() } else { quantity.unit.clone() },
        docs: quantity.docs.trim().to_owned(),
    };
    let of_contact = |(contact, surface): &(usize, Surface<f64>)| {
        let name = model.contacts.get(*contact).map_or(String::new(), |contact| contact.name.clone());
        (name, surface.mu, surface.e, surface.law.name().to_owned())
    };
    let coordinates = model.coordinates.iter().zip(&state.coordinates);
    Setup {
        surfaces: surfaces.iter().map(of_contact).collect(),
        parameters: model.parameters.iter().zip(&state.parameters).map(value).collect(),
        start: coordinates.chain(model.speeds.iter().zip(&state.speeds)).map(value).collect(),
        model: plain(&files::model(path)),
    }
}
