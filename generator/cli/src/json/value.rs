//! JSON values with fields in the order of the text (including repeated ones) and numbers as the nearest
//! doubles.

use hodograph::Cause;
use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use super::{Failure, Kind};

/// A JSON value.
#[derive(Clone, Debug, PartialEq)]
pub enum Json {
    /// `null`
    Null,
    /// `true` or `false`
    Bool(bool),
    /// a number; always finite
    Number(f64),
    /// a string
    String(String),
    /// an array
    Array(Vec<Json>),
    /// the fields of an object in their order; a name may occur twice
    Object(Vec<(String, Json)>),
}

impl Json {
    /// Reads one value.
    ///
    /// # Errors
    ///
    /// `bad_json` with the place; `not_finite` if a number out of range (`1e999`) or a word for one (`NaN`,
    /// `Infinity`) is all that prevents the text from being JSON.
    pub fn parse(text: &str) -> Result<Json, Failure> {
        serde_json::from_str(text).map_err(|error| match without_infinities(text) {
            Some((rest, word)) if serde_json::from_str::<Json>(&rest).is_ok() => Failure::new(
                Kind::Of(Cause::NotFinite),
                format!("{word} is not a finite number: give a number below 1.8e308 in magnitude"),
            ),
            _ => Failure::bad_json(format!("this is not JSON: {error}")),
        })
    }

    /// The kind of the value, for messages: `a string`, `null` ..
    pub fn sort(&self) -> &'static str {
        match self {
            Json::Null => "null",
            Json::Bool(_) => "a truth value",
            Json::Number(_) => "a number",
            Json::String(_) => "a string",
            Json::Array(_) => "an array",
            Json::Object(_) => "an object",
        }
    }
}

/// The text with numbers that no double can represent replaced by 0, and the first such number.
fn without_infinities(text: &str) -> Option<(String, &str)> {
    let (mut rest, mut first) = (String::with_capacity(text.len()), None);
    let (mut at, mut in_string) = (0, false);
    while let Some(letter) = text[at..].chars().next() {
        let mut length = letter.len_utf8();
        let mut piece = &text[at..at + length];
        if in_string {
            match letter {
                '"' => in_string = false,
                '\\' => {
                    length += text[at + length..].chars().next().map_or(0, char::len_utf8);
                    piece = &text[at..at + length];
                }
                _ => {}
            }
        } else if letter == '"' {
            in_string = true;
        } else if letter.is_ascii_alphanumeric() || matches!(letter, '-' | '+') {
            length = text[at..]
                .find(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '-' | '+' | '.')))
                .unwrap_or(text.len() - at);
            piece = &text[at..at + length];
            if piece.parse::<f64>().is_ok_and(|number| !number.is_finite()) {
                first = first.or(Some(piece));
                piece = "0";
            }
        }
        rest.push_str(piece);
        at += length;
    }
    first.map(|word| (rest, word))
}

struct JsonVisitor;

impl<'de> Visitor<'de> for JsonVisitor {
    type Value = Json;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Json, E> {
        Ok(Json::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Json, E> {
        Ok(Json::Number(value as f64))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Json, E> {
        Ok(Json::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Json, E> {
        Ok(Json::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Json, E> {
        Ok(Json::String(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut access: A) -> Result<Json, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = access.next_element()? {
            items.push(item);
        }
        Ok(Json::Array(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut access: A) -> Result<Json, A::Error> {
        let mut fields = Vec::new();
        while let Some(field) = access.next_entry()? {
            fields.push(field);
        }
        Ok(Json::Object(fields))
    }
}

impl<'de> Deserialize<'de> for Json {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Json, D::Error> {
        deserializer.deserialize_any(JsonVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinities_are_distinguished_from_bad_json() {
        for text in ["1e999", "[1, -1e400]", "{\"a\": NaN}", "[-Infinity]", "[Infinity, \"NaN\"]"] {
            assert_eq!(Json::parse(text).unwrap_err().kind, Kind::Of(Cause::NotFinite), "{text}");
        }
        for text in ["", "[", "{\"a\": nan?}", "[1e999", "[1,]", "nil", "\"\\"] {
            assert_eq!(Json::parse(text).unwrap_err().kind, Kind::BadJson, "{text}");
        }
    }

    #[test]
    fn fields_stay_as_written() {
        let object = Json::parse(r#"{"b": 1, "a": [2.5, null], "b": "NaN"}"#).unwrap();
        let Json::Object(fields) = object else { panic!("an object") };
        assert_eq!(fields.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["b", "a", "b"]);
        assert_eq!(fields[1].1, Json::Array(vec![Json::Number(2.5), Json::Null]));
    }
}
