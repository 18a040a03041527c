//! The quantities of a model, for sliders.

use hodograph_model::model::mechanism::{Mechanism, Variable};
use hodograph_model::numeric::State;
use serde_json::Value;

use crate::answer::object;

/// Parameters, coordinates, speeds and inputs with the values that the model gives, and its contacts.
pub fn describe(model: &Mechanism) -> Value {
    let state = State::of(model);
    let list = |kind: &str, variables: &[Variable], values: &[f64]| -> Vec<Value> {
        let pairs = variables.iter().zip(values).filter(|(one, _)| !one.fixed && !one.dependent);
        pairs
            .map(|(one, value)| {
                object!({
                    "kind": kind, "name": one.name.as_str(), "unit": one.unit.as_str(), "docs": one.docs.trim(), "value": *value,
                    "stated": one.value.is_some(), "typical": one.typical,
                    "follows": one.initial.is_some(),
                })
            })
            .collect()
    };
    let quantities = [
        list("parameter", &model.parameters, &state.parameters),
        list("input", &model.inputs, &state.inputs),
        list("coordinate", &model.coordinates, &state.coordinates),
        list("speed", &model.speeds, &state.speeds),
    ];
    let contacts: Value = model
        .contacts
        .iter()
        .map(|contact| {
            let surface =
                contact.surface.map(|stated| object!({ "mu": stated.mu, "e": stated.e, "law": stated.law }));
            object!({ "name": contact.name.as_str(), "gap": contact.gap.is_some(), "surface": surface })
        })
        .collect();
    object!({
        "name": model.name.as_str(), "docs": model.docs.trim(), "quantities": quantities.concat(), "contacts": contacts,
    })
}
