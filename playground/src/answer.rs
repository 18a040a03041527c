//! Objects of answers.

use serde_json::{Map, Value};

/// An object. `json!` writes each entry out where it stands, which makes a third of a module of answers.
macro_rules! object {
    ({ $($key:literal : $value:expr),* $(,)? }) => {
        $crate::answer::of(vec![$(($key, serde_json::Value::from($value))),*])
    };
}
pub(crate) use object;

/// The object with these entries.
#[inline(never)]
pub fn of(entries: Vec<(&str, Value)>) -> Value {
    let mut object = Map::new();
    for (key, value) in entries {
        object.insert(key.to_owned(), value);
    }
    Value::Object(object)
}
