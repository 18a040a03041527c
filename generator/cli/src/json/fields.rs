//! Reads the fields of a JSON object by name.

use super::{Failure, Json, Kind};
use crate::spelling::nearest;

/// An object with distinct names.
#[derive(Clone, Debug)]
pub struct Fields {
    what: String,
    fields: Vec<(String, Json)>,
}

impl Fields {
    /// The fields of an object; `what` is its name in messages.
    ///
    /// # Errors
    ///
    /// `bad_json` if the value is not an object, or a name occurs twice.
    pub fn new(json: Json, what: &str) -> Result<Self, Failure> {
        let fields = match json {
            Json::Object(fields) => fields,
            other => {
                return Err(Failure::bad_json(format!("{what} must be an object, not {}", other.sort())));
            }
        };
        let mut names: Vec<&str> = fields.iter().map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Failure::bad_json(format!("`{}` occurs twice in {what}: give it once", pair[0])));
        }
        Ok(Fields { what: what.to_owned(), fields })
    }

    /// The fields in their order.
    pub fn into_inner(self) -> Vec<(String, Json)> {
        self.fields
    }

    /// The names in their order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.fields.iter().map(|(name, _)| name.as_str())
    }

    /// A field, if it is there.
    pub fn get(&self, name: &str) -> Option<&Json> {
        self.fields.iter().find(|(field, _)| field == name).map(|(_, value)| value)
    }

    /// A required field; `form` describes its value.
    ///
    /// # Errors
    ///
    /// `missing_field`.
    pub fn need(&self, name: &str, form: &str) -> Result<&Json, Failure> {
        self.get(name).ok_or_else(|| {
            let hint = match nearest(name, self.names()) {
                Some(other) => format!(" (there is a field `{other}`)"),
                None => String::new(),
            };
            Failure::new(
                Kind::MissingField,
                format!("{} has no field `{name}`{hint}: give {form}", self.what),
            )
        })
    }

    /// A required number.
    ///
    /// # Errors
    ///
    /// `missing_field`, `bad_json`.
    pub fn number(&self, name: &str, form: &str) -> Result<f64, Failure> {
        number(self.need(name, form)?, name)
    }

    /// A required array of numbers.
    ///
    /// # Errors
    ///
    /// `missing_field`, `bad_json`.
    pub fn numbers<const N: usize>(&self, name: &str, form: &str) -> Result<[f64; N], Failure> {
        let items = match self.need(name, form)? {
            Json::Array(items) => items,
            other => {
                return Err(Failure::bad_json(format!("`{name}` must be {form}, not {}", other.sort())));
            }
        };
        let mut numbers = [0.0; N];
        if items.len() != N {
            return Err(Failure::bad_json(format!("`{name}` must be {form}, not {} of them", items.len())));
        }
        for (index, (slot, item)) in numbers.iter_mut().zip(items).enumerate() {
            *slot = number(item, &format!("{name}[{index}]"))?;
        }
        Ok(numbers)
    }
}

/// The number in a value.
///
/// # Errors
///
/// `bad_json`.
pub fn number(value: &Json, name: &str) -> Result<f64, Failure> {
    match value {
        Json::Number(number) => Ok(*number),
        other => Err(Failure::bad_json(format!("`{name}` must be a number, not {}", other.sort()))),
    }
}
