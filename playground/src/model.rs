//! Reads a model, and its derivation where there is one.

use hodograph_model::check::{self, UNIT_QUATERNION, impossible_bodies};
use hodograph_model::diagnostics::Severity;
use hodograph_model::model::mechanism::{Mechanism, Orientation, Variable};
use hodograph_model::numeric::start::{self, Given};
use hodograph_model::numeric::{self, State};
use hodograph_model::source::Source;
use hodograph_program::artifact::{self, Loaded};
use hodograph_program::explain::{self, Format};
use serde_json::{Map, Value};

use crate::answer::object;

/// The mechanism of a model.
///
/// # Errors
///
/// The first mistake, with its line.
pub fn read(source: &Source) -> Result<Mechanism, String> {
    let checked = check::check(source);
    let first = || {
        let error = checked.diagnostics.iter().find(|found| found.severity == Severity::Error)?;
        let (file, _) = source.locate(error.primary.span);
        let line = source.location(error.primary.span)?.line;
        Some(format!("{}, {} line {line}: {}", error.code.0, file.name(), error.message))
    };
    let first = first();
    checked.mechanism.ok_or_else(|| first.unwrap_or_else(|| "the model has mistakes".to_owned()))
}

/// What is kept as the derivation of a model.
pub fn derivation(source: &Source, kept: &str) -> Loaded {
    match kept {
        "" => Loaded::Absent,
        kept => artifact::load_text(kept, source),
    }
}

/// The equations, as a page.
///
/// # Errors
///
/// There is no derivation of this text.
pub fn equations(source: &Source, kept: &str) -> Result<Value, String> {
    let mechanism = read(source)?;
    let program = derivation(source, kept).program().map_err(|fault| {
        format!("the derivation {fault}: `hodograph derive` writes it beside the model, and `hodograph serve` brings both")
    })?;
    let page = explain::explain(&mechanism, &program, &explain::usual(&program), Format::Html);
    Ok(object!({ "page": page }))
}

/// Quantities by name, as a question gives them.
struct Named<'a>(Option<&'a Map<String, Value>>);

impl Named<'_> {
    fn number(&self, name: &str) -> Result<Option<f64>, String> {
        match self.0.and_then(|map| map.get(name)) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => match value.as_f64().filter(|value| value.is_finite()) {
                Some(value) => Ok(Some(value)),
                None => Err(format!("{name} = {value} is no number")),
            },
        }
    }

    fn fill(&self, list: &[Variable], values: &mut [f64]) -> Result<Vec<bool>, String> {
        let mut given = Vec::new();
        for (quantity, value) in list.iter().zip(values) {
            let number = self.number(&quantity.name)?;
            given.push(number.is_some());
            *value = number.unwrap_or(*value);
        }
        Ok(given)
    }
}

/// The state in which a motion begins: that of the model with the numbers that a question gives under
/// `values`; what follows from them is found, quaternions have length one, and loops are closed.
///
/// # Errors
///
/// A sentence.
pub fn start(model: &Mechanism, question: &Value) -> Result<State, String> {
    let mut state = State::of(model);
    let named = Named(question["values"].as_object());
    named.fill(&model.parameters, &mut state.parameters)?;
    named.fill(&model.inputs, &mut state.inputs)?;
    let given = Given {
        coordinates: named.fill(&model.coordinates, &mut state.coordinates)?,
        speeds: named.fill(&model.speeds, &mut state.speeds)?,
    };
    if let Some(&slot) = start::complete(model, &mut state, &given).first() {
        let quantity = model.coordinates.iter().chain(&model.speeds).nth(slot);
        let name = quantity.map_or("", |quantity| quantity.name.as_str());
        return Err(format!("the initial value of {name} cannot be found with these numbers: give it"));
    }
    if let Some(found) = impossible_bodies(model, &state).first() {
        let body = &model.bodies[found.body.0].name;
        return Err(format!("with these parameters {body} is no body: {}", found.what));
    }
    for frame in &model.frames {
        let Orientation::Quaternion(parts) = frame.orientation else { continue };
        let numbers = parts.map(|part| state.coordinates[part.0]);
        let norm = numbers.iter().map(|number| number * number).sum::<f64>().sqrt();
        if norm.is_nan() || norm <= 0.0 {
            return Err(format!("the quaternion of frame {} has length 0: it is no rotation", frame.name));
        }
        if (norm - 1.0).abs() > UNIT_QUATERNION {
            parts.iter().for_each(|part| state.coordinates[part.0] /= norm);
        }
    }
    numeric::assemble(model, &mut state).map_err(|failure| failure.to_string())?;
    Ok(state)
}
