//! A generated module as a library for other programs: for C, a crate with functions of C's calling convention and their
//! header; for tools of simulation, a functional mock-up unit (`fmu`).
//!
//! * `module` selects the structs and methods of the generated module that have a form in C, by their types;
//! * `names` gives names, declarations and conversions of values;
//! * `header` and `library` write the two sides;
//! * this file puts the crate together.

pub mod fmu;
mod header;
mod library;
mod module;
mod names;

use hodograph::{Cause, ContactMode, Law, Path};
use hodograph_generator::emit::interface::Interface;

/// What calls say before the causes of errors: name and documentation, numbered from zero. The number of a
/// [`Cause`] is counted from there.
const STATUSES: [(&str, &str); 3] = [
    ("OK", "the answer is there"),
    ("NULL", "a pointer is null"),
    ("UNKNOWN_LAW", "the surface names no hypothesis of restitution"),
];

/// A constant of the header: its name after the prefix, and its documentation.
type Constant = (String, &'static str);

/// The enums of the header with their constants, numbered from zero: what they are called, what they are, and the
/// tables of the runtime.
fn enums() -> [(&'static str, &'static str, Vec<Constant>); 4] {
    let upper = |name: &str| name.to_uppercase();
    let statuses = STATUSES.map(|(name, docs)| (name.to_owned(), docs)).into_iter();
    let causes = Cause::ALL.iter().map(|cause| (upper(cause.name()), cause.about()));
    let laws = Law::ALL.iter().map(|law| (upper(law.name()), law.about()));
    let paths = Path::ALL.iter().map(|path| (upper(path.name()), path.about()));
    let modes = ContactMode::ALL.iter().map(|mode| (upper(mode.name()), mode.about()));
    [
        ("status", "What a call says.", statuses.chain(causes).collect()),
        ("law", "Hypotheses of restitution.", laws.collect()),
        ("path", "Phases of a collision.", paths.collect()),
        ("mode", "Modes of a closed contact.", modes.collect()),
    ]
}

/// The type of all numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `double` and `f64`
    Double,
    /// `float` and `f32`
    Single,
}

/// A file of the crate: its path in the crate's folder, and its text.
pub type File = (String, String);

/// The files of the crate. `expanded` is the Rust text of the generated module, `interface` what it offers,
/// `dependency` what stands after `hodograph =` in the manifest, in braces.
pub fn files(expanded: &str, interface: &Interface, scalar: Scalar, dependency: &str) -> Vec<File> {
    let mut module = module::of(interface);
    module.name = names::of_library(&module.path);
    names::tell_apart(&mut module);
    let (c, rust) = match scalar {
        Scalar::Double => ("double", "f64"),
        Scalar::Single => ("float", "f32"),
    };
    let name = &module.name;
    vec![
        ("Cargo.toml".to_owned(), manifest(&module, dependency)),
        ("README.md".to_owned(), readme(&module, c)),
        (format!("include/{name}.h"), header::header(&module, c)),
        ("src/lib.rs".to_owned(), library::library(&module, rust)),
        ("src/mechanism.rs".to_owned(), expanded.to_owned()),
    ]
}

fn manifest(module: &module::Module, dependency: &str) -> String {
    format!(
        "[package]\nname = \"{}\"\nversion = \"0.1.0\"\nedition = \"2024\"\npublish = false\n\n[lib]\ncrate-type = [\"staticlib\", \"cdylib\"]\n\n\
         [features]\ndefault = [\"std\"]\n# Off for microcontrollers: `--no-default-features`.\nstd = [\"hodograph/std\"]\n\n\
         [dependencies]\nhodograph = {dependency}\n\n[profile.release]\npanic = \"abort\"\nlto = \"fat\"\ncodegen-units = 1\n\n[workspace]\n",
        module.name
    )
}

fn readme(module: &module::Module, scalar: &str) -> String {
    let name = &module.name;
    let has = |name: &str| {
        module.records.iter().any(|record| record.name == name && record.stated && !record.fields.is_empty())
    };
    let upper = name.to_uppercase();
    // A program that prints numbers: only of what this mechanism has.
    let (mut declared, mut filled) = (format!("    {name} mechanism;\n"), String::new());
    let default =
        |what: &str| format!("    if ({name}_default_{what}(&{what}) != {upper}_OK)\n        return 1;\n");
    for (record, what) in [("Parameters", "parameters"), ("Coordinates", "coordinates"), ("Speeds", "speeds")]
    {
        if has(record) {
            declared += &format!("    {name}_{what} {what};\n");
            filled += &default(what);
        }
    }
    let made = if has("Parameters") { "&parameters, " } else { "" };
    let energy = module.routines.iter().find(|routine| routine.name == "kinetic_energy");
    let arguments: Vec<&str> = energy.map_or(Vec::new(), |routine| {
        let of = |form: &module::Form| match form {
            module::Form::Record(record) if record == "Coordinates" => "&coordinates, ",
            module::Form::Record(record) if record == "Speeds" => "&speeds, ",
            _ => "",
        };
        routine.arguments.iter().map(|(_, form)| of(form)).collect()
    });
    let program = match energy {
        Some(_) if arguments.iter().all(|argument| !argument.is_empty()) => format!(
            "    if ({name}_kinetic_energy(&mechanism, {}&energy) != {upper}_OK)\n        return 3;\n    printf(\"kinetic energy %g J\\n\", (double)energy);\n",
            arguments.concat()
        ),
        _ => String::new(),
    };
    format!(
        "# {0} for C\n\n{1}\n\n```sh\ncargo build --release                                    # target/release/lib{name}.a and lib{name}.so\n\
         cargo build --release --no-default-features --target thumbv7em-none-eabihf    # for a Cortex-M4F or M7\n\
         cc -I include main.c target/release/lib{name}.a -lm -o main\n```\n\n\
         The library and `include/{name}.h` are all that a team without cargo needs: whoever has cargo builds the library once per target, and both files are\n\
         handed on. They need nothing at run time but, on a desktop, the C library. A `main.c` that prints a number:\n\n\
         ```c\n#include <stdio.h>\n#include \"{name}.h\"\n\nint main(void)\n{{\n{declared}    {2} energy = 0;\n\n{filled}    if ({name}_new({made}&mechanism) != {upper}_OK)\n        return 2;\n{program}    return 0;\n}}\n```\n\n\
         Every call answers a status; the answer is written only where the status is `{upper}_OK`. Nothing is allocated, and there is no hidden state.\n\n\
         ## Several mechanisms in one program\n\n\
         Each static library holds the Rust runtime, so a program links one of them. Shared libraries keep theirs to themselves: link as many as you like,\n\n\
         ```sh\ncc -I include main.c -L target/release -l{name} -Wl,-rpath,$PWD/target/release -lm -o main\n```\n\n\
         or, where there are no shared libraries, make one object of each static library, of which only the functions of the header can be seen from outside:\n\n\
         ```sh\nld -r -o {name}.o --whole-archive lib{name}.a\nobjcopy --wildcard --keep-global-symbol '{name}_*' {name}.o\n```\n",
        module.mechanism, module.docs, scalar,
    )
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn routine(name: &str, budgeted: bool) -> module::Routine {
        module::Routine {
            name: name.to_owned(),
            symbol: name.to_owned(),
            docs: String::new(),
            arguments: Vec::new(),
            answer: module::Form::Number,
            budgeted,
        }
    }

    /// Every name that the header declares is there once, whatever contacts and points are called.
    #[test]
    fn names_are_told_apart() {
        let contacts = [
            "tip",
            "tip_with_budget",
            "tip_with_budget_",
            "Tip",
            "TIP_WITH_BUDGET",
            "tip_",
            "tip__with_budget",
            "with_budget",
        ];
        let collisions = contacts.iter().map(|contact| routine(&format!("collide_{contact}"), true));
        let others = [
            "new",
            "surface",
            "path",
            "status",
            "speeds",
            "coordinates",
            "H",
            "Newton",
            "gap_tip",
            "gap_Tip",
        ];
        let mut module = module::Module {
            path: "arm".to_owned(),
            name: "arm".to_owned(),
            mechanism: "Arm".to_owned(),
            docs: String::new(),
            numbers: 1,
            records: Vec::new(),
            routines: collisions.chain(others.iter().map(|name| routine(name, false))).collect(),
        };
        names::tell_apart(&mut module);
        let all = names::declared_names(&module);
        let told: HashSet<String> = all.iter().map(|name| name.to_lowercase()).collect();
        assert_eq!(told.len(), all.len(), "{all:?}");
        // the names that are declared are those of the header, and the routines of Rust are called as before
        let header = header::header(&module, "double");
        for name in &all {
            let there = header.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name);
            assert!(there, "{name}");
        }
        assert!(
            module
                .routines
                .iter()
                .all(|routine| routine.symbol.trim_end_matches('_') == routine.name.trim_end_matches('_'))
        );
        // the plain name stays with the contact that has it
        let symbol = |name: &str| {
            module.routines.iter().find(|routine| routine.name == name).map(|routine| routine.symbol.clone())
        };
        assert_eq!(symbol("collide_tip_with_budget").as_deref(), Some("collide_tip_with_budget"));
        assert_eq!(symbol("collide_tip").as_deref(), Some("collide_tip__"));
        assert!(library::library(&module, "f64").contains("mechanism.collide_tip("));
    }
}
