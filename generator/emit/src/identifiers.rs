//! Converts names of a model to those of Rust: identifiers, names of types.

use proc_macro2::{Ident, Span};

use hodograph_model::rust_names::is_keyword;

/// The types of a generated module besides that of the mechanism.
pub const RECORDS: &[&str] = &[
    "Parameters",
    "Coordinates",
    "Speeds",
    "DependentSpeeds",
    "Inputs",
    "Collision",
    "CollisionDerivative",
    "ClosedContact",
    "ContactDerivatives",
    "Derivatives",
    "Linearisation",
];

/// Other names with a meaning in generated code.
const RESERVED: &[&str] = &["T", "Result", "Ok", "Err"];

/// The parameters of generated functions that stand for types.
const GENERIC: &[&str] = &["T", "R"];

/// Whether a name means something else where a type of a generated module is named.
pub fn means_another(of_type: &str) -> bool {
    [RESERVED, GENERIC].concat().contains(&of_type) || is_keyword(of_type)
}

/// `two_sleds` -> `TwoSleds`; capitals stay.
pub fn pascal_case(name: &str) -> String {
    let mut pascal = String::new();
    for word in name.split('_').filter(|word| !word.is_empty()) {
        let mut characters = word.chars();
        pascal.extend(characters.next().map(char::to_uppercase).into_iter().flatten());
        pascal.push_str(characters.as_str());
    }
    pascal
}

/// The name of the mechanism's type, which differs from those of the other types of its module.
pub fn type_name(mechanism: &str) -> String {
    let name = pascal_case(mechanism);
    let starts_well = name.starts_with(|c: char| c.is_alphabetic());
    let taken = [RECORDS, RESERVED].concat().contains(&name.as_str());
    if taken || is_keyword(&name) || !starts_well { format!("{name}Mechanism") } else { name }
}

/// An identifier, raw if it is a keyword. Any text is converted to a valid identifier.
pub fn ident(name: &str) -> Ident {
    let mut clean: String =
        name.chars().map(|c| if c == '_' || c.is_alphanumeric() { c } else { '_' }).collect();
    if clean.is_empty() || clean == "_" || clean.starts_with(|c: char| c.is_numeric()) {
        clean.insert(0, '_');
    }
    match clean.as_str() {
        "self" | "Self" | "super" | "crate" => Ident::new(&format!("{clean}_"), Span::call_site()),
        keyword if is_keyword(keyword) => Ident::new_raw(keyword, Span::call_site()),
        _ => Ident::new(&clean, Span::call_site()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases() {
        assert_eq!(pascal_case("two_sleds"), "TwoSleds");
        assert_eq!(type_name("speeds"), "SpeedsMechanism");
        assert_eq!(ident("loop").to_string(), "r#loop");
        assert!(["T", "R", "Self", "Result"].into_iter().all(means_another));
        assert!(!means_another("Tip") && !means_another("Forcing"));
    }
}
