//! Names in C, and the texts of the values that cross the border.

use super::module::{Form, Module, Record};

/// Words that are no names in C or C++.
const RESERVED: &str = "alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl concept const consteval constexpr constinit \
     const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast else enum explicit export extern false float for friend \
     goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires \
     restrict return short signed sizeof static static_assert static_cast struct switch template this thread_local throw true try typedef typeid typename \
     typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq";

/// A name of the module as C may have it: reserved words get a line after them.
pub fn of(name: &str) -> String {
    let name = name.strip_prefix("r#").unwrap_or(name);
    if RESERVED.split_whitespace().any(|word| word == name) { format!("{name}_") } else { name.to_owned() }
}

/// The names of the fields of a record, each once.
pub fn fields(record: &Record) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for field in &record.fields {
        let mut name = of(&field.name);
        while names.contains(&name)
            || record.fields.iter().any(|other| other.name == name && other.name != field.name)
        {
            name.push('_');
        }
        names.push(name);
    }
    names
}

/// The name of a record's type.
pub fn record(module: &Module, name: &str) -> String {
    let mut text = String::new();
    for (place, letter) in name.chars().enumerate() {
        if letter.is_uppercase() && place > 0 {
            text.push('_');
        }
        text.extend(letter.to_lowercase());
    }
    format!("{}_{text}", module.name)
}

/// How C declares a value of a form under a name.
pub fn declared(module: &Module, scalar: &str, form: &Form, name: &str) -> String {
    match form {
        Form::Number => format!("{scalar} {name}"),
        Form::Vector(rows) => format!("{scalar} {name}[{rows}]"),
        Form::Matrix(rows, columns) => format!("{scalar} {name}[{rows}][{columns}]"),
        Form::Reduced => format!("{scalar} {name}[3][3]"),
        Form::Direction => format!("{scalar} {name}[3]"),
        Form::Record(record) => format!("{} {name}", self::record(module, record)),
        Form::Surface => format!("{}_surface {name}", module.name),
        Form::Path | Form::Mode => format!("int32_t {name}"),
    }
}

/// The Rust type with the memory of that declaration.
pub fn memory(module: &Module, scalar: &str, form: &Form) -> String {
    match form {
        Form::Number => scalar.to_owned(),
        Form::Vector(rows) => format!("[{scalar}; {rows}]"),
        Form::Matrix(rows, columns) => format!("[[{scalar}; {columns}]; {rows}]"),
        Form::Reduced => format!("[[{scalar}; 3]; 3]"),
        Form::Direction => format!("[{scalar}; 3]"),
        Form::Record(name) => match module.records.iter().find(|record| record.name == *name) {
            Some(record) if record.is_plain() => format!("[{scalar}; {}]", record.fields.len()),
            _ => format!("C{name}"),
        },
        Form::Surface => "CSurface".to_owned(),
        Form::Path | Form::Mode => "i32".to_owned(),
    }
}

/// The Rust expression that brings a value into that memory.
pub fn stored(module: &Module, form: &Form, value: &str) -> String {
    match form {
        Form::Number => value.to_owned(),
        Form::Vector(_) => format!("{value}.into()"),
        // Rows after each other; the matrices of the module have columns after each other.
        Form::Matrix(..) => format!("{value}.transpose().into()"),
        Form::Reduced => format!("Matrix3::from({value}).transpose().into()"),
        Form::Direction => format!("{value}.map_or([0.0; 3], Into::into)"),
        Form::Record(name) => match module.records.iter().find(|record| record.name == *name) {
            Some(record) if record.is_plain() => format!("{value}.into()"),
            _ => format!("C{name}::from({value})"),
        },
        Form::Surface => value.to_owned(),
        Form::Path => format!("path({value})"),
        Form::Mode => format!("mode({value})"),
    }
}
