//! Names in C, and the code that converts values between C and Rust.

use super::enums;
use super::module::{Form, Module, Record, Routine};

/// Keywords of C99, C11 and C++20, and words with a meaning of their own in some places of C++.
const KEYWORDS: &str = "alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case catch char char8_t char16_t char32_t \
     class compl concept const consteval constexpr constinit const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast \
     else enum explicit export extern false final float for fortran friend goto if import inline int long module mutable namespace new noexcept not not_eq \
     nullptr operator or or_eq override private protected public reflexpr register reinterpret_cast requires restrict return short signed sizeof static \
     static_assert static_cast struct switch synchronized template this thread_local throw true try typedef typeid typename typeof typeof_unqual union \
     unsigned using virtual void volatile wchar_t while xor xor_eq";

/// Macros that would replace a name.
const MACROS: &str = include_str!("macros.txt");

/// Names that the headers of the standard library declare.
const LIBRARY: &str = include_str!("library_names.txt");

/// Whether a list of words, which may contain comments, contains this one.
fn lists(list: &str, name: &str) -> bool {
    let lines = list.lines().filter(|line| !line.starts_with('#'));
    lines.flat_map(str::split_whitespace).any(|word| word == name)
}

/// A name in the letters that every compiler and linker takes: of others it has the number, `grösse` is
/// `gru00f6sse`.
pub fn ascii(name: &str) -> String {
    let letter = |c: char| if c.is_ascii() { c.to_string() } else { format!("u{:04x}", u32::from(c)) };
    name.chars().map(letter).collect()
}

/// The name of an item in C and C++: keywords and macros get an underscore after them, and names that are
/// reserved for compilers (`_Bool`, `__x`) an x before them.
pub fn of(name: &str) -> String {
    let name = &ascii(name.strip_prefix("r#").unwrap_or(name));
    let mut rest = name.chars().skip_while(|c| *c == '_');
    let lines = name.len() - name.trim_start_matches('_').len();
    let kept = lines > 1 || lines == 1 && rest.next().is_some_and(char::is_uppercase);
    let name = if kept { format!("x{name}") } else { name.to_owned() };
    if lists(KEYWORDS, &name) || lists(MACROS, &name) { format!("{name}_") } else { name }
}

/// The name of a library, which is also the name of a type, so that it must not be a name of the standard
/// library either.
pub fn of_library(name: &str) -> String {
    let name = of(name);
    if lists(LIBRARY, &name) { format!("{name}_") } else { name }
}

/// The names of the fields of a record, all different.
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

/// The name of a routine after that of the module, with or without a budget.
pub fn routine(routine: &Routine, budgeted: bool) -> String {
    format!("{}{}", routine.symbol, if budgeted { "_with_budget" } else { "" })
}

/// All names that the header declares, in order: constants, types and functions.
pub fn declared_names(module: &Module) -> Vec<String> {
    let (name, upper) = (&module.name, module.name.to_uppercase());
    let mut all = Vec::new();
    for (what, _, constants) in enums() {
        all.push(format!("{name}_{what}"));
        all.extend(constants.iter().map(|(constant, _)| format!("{upper}_{constant}")));
    }
    let parts = ["surface", "impact", "margins", "new"].map(|part| format!("{name}_{part}"));
    all.extend([format!("{upper}_H"), name.clone()].into_iter().chain(parts));
    for record in module.records.iter().filter(|record| !record.fields.is_empty()) {
        let of = self::record(module, &record.name);
        if record.stated {
            all.push(format!("{name}_default_{}", &of[name.len() + 1..]));
        }
        all.push(of);
    }
    for routine in &module.routines {
        all.push(format!("{name}_{}", self::routine(routine, false)));
        all.extend(routine.budgeted.then(|| format!("{name}_{}", self::routine(routine, true))));
    }
    all
}

/// Gives every routine a name that is unique in the header even if case is ignored: besides a contact `tip`
/// there may be a contact `tip_with_budget`, while the collision of `tip` with a budget is
/// `collide_tip_with_budget`. `others` are names of other headers of the library.
pub fn make_unique(module: &mut Module, others: &[String]) {
    module.routines.iter_mut().for_each(|routine| routine.symbol = ascii(&routine.symbol));
    let bare = Module { routines: Vec::new(), ..module.clone() };
    let own = declared_names(&bare);
    let mut taken: Vec<String> = own.iter().chain(others).map(|name| name.to_lowercase()).collect();
    // Names of the model stay; names with a suffix added here change.
    let plain: Vec<String> = module.routines.iter().map(|routine| routine.symbol.to_lowercase()).collect();
    for place in 0..module.routines.len() {
        let mut routine = module.routines[place].clone();
        let full = |name: &str| format!("{}_{name}", module.name).to_lowercase();
        loop {
            let budgeted = routine.budgeted.then(|| self::routine(&routine, true));
            let is_of_another = budgeted.as_ref().is_some_and(|name| plain.contains(&name.to_lowercase()));
            let own: Vec<String> =
                std::iter::once(&routine.symbol).chain(&budgeted).map(|name| full(name)).collect();
            if !is_of_another && own.iter().all(|name| !taken.contains(name)) {
                taken.extend(own);
                break;
            }
            routine.symbol.push('_');
        }
        module.routines[place] = routine;
    }
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

/// The declaration in C of a value of this type.
pub fn declared(module: &Module, scalar: &str, form: &Form, name: &str) -> String {
    match form {
        Form::Number => format!("{scalar} {name}"),
        Form::Vector(rows) => format!("{scalar} {name}[{rows}]"),
        Form::Matrix(rows, columns) => format!("{scalar} {name}[{rows}][{columns}]"),
        Form::Reduced => format!("{scalar} {name}[3][3]"),
        Form::Direction => format!("{scalar} {name}[3]"),
        Form::Record(record) => format!("{} {name}", self::record(module, record)),
        Form::Surface => format!("{}_surface {name}", module.name),
        Form::Impact => format!("{}_impact {name}", module.name),
        Form::Margins => format!("{}_margins {name}", module.name),
        Form::Path | Form::Mode | Form::Selection => format!("int32_t {name}"),
    }
}

/// The Rust type with the same memory layout.
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
        Form::Impact => "CImpact".to_owned(),
        Form::Margins => "CMargins".to_owned(),
        Form::Path | Form::Mode | Form::Selection => "i32".to_owned(),
    }
}

/// The Rust expression that converts a value to that type.
pub fn stored(module: &Module, form: &Form, value: &str) -> String {
    match form {
        Form::Number => value.to_owned(),
        Form::Vector(_) => format!("{value}.into()"),
        // C has rows one after the other, the matrices of the module have columns.
        Form::Matrix(..) => format!("{value}.transpose().into()"),
        Form::Reduced => format!("hodograph::nalgebra::Matrix3::from({value}).transpose().into()"),
        Form::Direction => format!("{value}.map_or([0.0; 3], Into::into)"),
        Form::Record(name) => match module.records.iter().find(|record| record.name == *name) {
            Some(record) if record.is_plain() => format!("{value}.into()"),
            _ => format!("C{name}::from({value})"),
        },
        Form::Surface => value.to_owned(),
        Form::Impact => format!("CImpact::from({value})"),
        Form::Margins => format!("CMargins::from({value})"),
        Form::Selection => format!("selection({value})"),
        Form::Path | Form::Mode => format!("{value}.number().into()"),
    }
}
