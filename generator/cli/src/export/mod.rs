//! Exports a generated module for other programs: for C, as a crate with functions of the C calling
//! convention and their header; for simulation tools, as a functional mock-up unit (`fmu`).
//!
//! * `module` selects the structs and methods of the generated module that have a form in C, by their types;
//! * `names` gives names, declarations and conversions of values;
//! * `header` and `library` write the two sides;
//! * `motion` writes both sides of motion, which is a feature of the crate;
//! * this file assembles the crate.

pub mod fmu;
mod header;
mod library;
mod module;
pub mod motion;
mod names;

use hodograph::{Cause, ContactMode, Law, Path};
use hodograph_generator::emit::interface::Interface;

/// The status codes before those of causes: name and documentation, numbered from zero. The codes of
/// [`Cause`]s follow.
const STATUSES: [(&str, &str); 2] = [("OK", "the answer is there"), ("NULL", "a pointer is null")];

/// Whether another mode than that of a closed contact fits: name and documentation, in the order of
/// `selection` in the library.
const SELECTIONS: [(&str, &str); 4] = [
    ("UNIQUE", "no other mode fits, or the mode was given"),
    ("SEVERAL_MODES", "several modes fit; this is the one whose force is nearest to the one before"),
    (
        "INDETERMINATE",
        "the contact slides and may lift off or suffer an impact without collision; lift-off is taken",
    ),
    ("UNKNOWN", "there are too many contacts to look for other modes"),
];

/// A constant of the header: its name without the prefix, and its documentation.
type Constant = (String, &'static str);

/// The enums of the header: name, documentation, and constants numbered from zero, from the tables of the
/// runtime.
fn enums() -> [(&'static str, &'static str, Vec<Constant>); 5] {
    let upper = |name: &str| name.to_uppercase();
    let statuses = STATUSES.map(|(name, docs)| (name.to_owned(), docs)).into_iter();
    let causes = Cause::ALL.iter().map(|cause| (upper(cause.name()), cause.about()));
    let laws = Law::ALL.iter().map(|law| (upper(law.name()), law.about()));
    let paths = Path::ALL.iter().map(|path| (upper(path.name()), path.about()));
    let modes = ContactMode::ALL.iter().map(|mode| (upper(mode.name()), mode.about()));
    let selections = SELECTIONS.iter().map(|(name, docs)| ((*name).to_owned(), *docs));
    [
        ("status", "What a call says.", statuses.chain(causes).collect()),
        ("law", "Hypotheses of restitution.", laws.collect()),
        ("path", "Phases of a collision.", paths.collect()),
        ("mode", "Modes of a closed contact.", modes.collect()),
        ("selection", "Whether another mode of a closed contact fits.", selections.collect()),
    ]
}

/// The type of all floating-point numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `double` and `f64`
    Double,
    /// `float` and `f32`
    Single,
}

/// A file of the crate: its path in the crate's folder, and its text.
pub type File = (String, String);

/// The files of the crate. `expanded` is the Rust text of the generated module, `interface` its public
/// interface, `dependency` the value of the dependency `hodograph` in the manifest, in braces, `motion` the
/// data of the functions of motion, where the crate has them.
pub fn files(
    expanded: &str,
    interface: &Interface,
    scalar: Scalar,
    dependency: &str,
    motion: Option<&motion::Motion>,
) -> Vec<File> {
    let mut module = module::of(interface);
    module.name = names::of_library(&module.path);
    // Motion is computed in double precision, and needs a state.
    let has = |of: &str| module.records.iter().any(|record| record.name == of && !record.fields.is_empty());
    let motion = motion.filter(|_| scalar == Scalar::Double && has("Coordinates") && has("Speeds"));
    let motion = motion.filter(|motion| motion::size(&module, "Inputs") == motion.inputs);
    let others = motion.map_or_else(Vec::new, |motion| motion::declared_names(&module.name, motion));
    names::make_unique(&mut module, &others);
    let (c, rust) = match scalar {
        Scalar::Double => ("double", "f64"),
        Scalar::Single => ("float", "f32"),
    };
    let name = &module.name;
    let mut files = vec![
        ("Cargo.toml".to_owned(), manifest(&module, dependency, motion)),
        ("README.md".to_owned(), readme(&module, c, motion)),
        (format!("include/{name}.h"), header::header(&module, c)),
        ("src/lib.rs".to_owned(), library::library(&module, rust, motion.is_some())),
        ("src/mechanism.rs".to_owned(), expanded.to_owned()),
    ];
    if let Some(motion) = motion {
        files.push((format!("include/{name}_simulation.h"), motion::header(&module, motion)));
        files.push(("src/simulation.rs".to_owned(), motion::library(&module, motion)));
    }
    files
}

fn manifest(module: &module::Module, dependency: &str, motion: Option<&motion::Motion>) -> String {
    let (feature, optional) = motion.map_or_else(Default::default, |motion| {
        let of = motion.dependency.trim_end_matches('}').trim_end();
        (
            "# Motion with impacts and contact that lasts: `--features simulation`.\n\
             simulation = [\"std\", \"dep:hodograph-fmu\"]\n",
            format!("hodograph-fmu = {of}, optional = true }}\n"),
        )
    });
    format!(
        "[package]\nname = \"{}\"\nversion = \"0.1.0\"\nedition = \"2024\"\npublish = false\n\n[lib]\ncrate-type = [\"staticlib\", \"cdylib\"]\n\n\
         [features]\ndefault = [\"std\"]\n# Off for microcontrollers: `--no-default-features`.\nstd = [\"hodograph/std\"]\n{feature}\n\
         [dependencies]\nhodograph = {dependency}\n{optional}\n[profile.release]\npanic = \"abort\"\nlto = \"fat\"\ncodegen-units = 1\n\n[workspace]\n",
        module.name
    )
}

fn readme(module: &module::Module, scalar: &str, motion: Option<&motion::Motion>) -> String {
    let name = &module.name;
    let has = |name: &str| {
        module.records.iter().any(|record| record.name == name && record.stated && !record.fields.is_empty())
    };
    let upper = name.to_uppercase();
    // An example program that prints numbers, restricted to what this mechanism has.
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
        let of = |(name, form): &(String, module::Form)| match form {
            module::Form::Record(record) if record == "Coordinates" => "&coordinates, ",
            module::Form::Record(record) if record == "Speeds" => "&speeds, ",
            module::Form::Number if name == "time" => "0, ",
            _ => "",
        };
        routine.arguments.iter().map(of).collect()
    });
    let program = match energy {
        Some(_) if arguments.iter().all(|argument| !argument.is_empty()) => format!(
            "    if ({name}_kinetic_energy(&mechanism, {}&energy) != {upper}_OK)\n        return 3;\n    printf(\"kinetic energy %g J\\n\", (double)energy);\n",
            arguments.concat()
        ),
        _ => String::new(),
    };
    if !program.is_empty() {
        declared += &format!("    {scalar} energy = 0;\n");
    }
    let motions = motion.map_or_else(String::new, |motion| motion::readme(module, motion));
    format!(
        "# {0} for C\n\n{1}\n\n```sh\ncargo build --release                                    # target/release/lib{name}.a and lib{name}.so\n\
         cargo build --release --no-default-features --target thumbv7em-none-eabihf    # for a Cortex-M4F or M7\n\
         cc -I include main.c target/release/lib{name}.a -lm -o main\n```\n\n\
         The library and `include/{name}.h` are all that a team without cargo needs: whoever has cargo builds the library once per target, and both files are\n\
         handed on. They need nothing at run time but, on a desktop, the C library. A `main.c` that prints a number:\n\n\
         ```c\n#include <stdio.h>\n#include \"{name}.h\"\n\nint main(void)\n{{\n{declared}\n{filled}    if ({name}_new({made}&mechanism) != {upper}_OK)\n        return 2;\n{program}    return 0;\n}}\n```\n\n\
         Every call answers a status; the answer is written only where the status is `{upper}_OK`. Nothing is allocated, and there is no hidden state.\n\n\
         ## Several mechanisms in one program\n\n\
         Each static library holds the Rust runtime, so a program links one of them. Shared libraries keep theirs to themselves: link as many as you like,\n\n\
         ```sh\ncc -I include main.c -L target/release -l{name} -Wl,-rpath,$PWD/target/release -lm -o main\n```\n\n\
         or, where there are no shared libraries, make one object of each static library, of which only the functions of the header can be seen from outside:\n\n\
         ```sh\nld -r -o {name}.o --whole-archive lib{name}.a\nobjcopy --wildcard --keep-global-symbol '{name}_*' {name}.o\n```\n{motions}",
        module.mechanism, module.docs,
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

    /// Every name that the headers declare occurs once, whatever the names of contacts and points are.
    #[test]
    fn names_are_unique() {
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
            "event",
            "Simulation_state",
            "contact_tip",
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
        let motion = motion::Motion {
            contacts: contacts.map(str::to_owned).to_vec(),
            inputs: 2,
            max_step: f64::INFINITY,
            dependency: "\"0.1\"".to_owned(),
        };
        let of_motion = motion::declared_names(&module.name, &motion);
        names::make_unique(&mut module, &of_motion);
        let all = [names::declared_names(&module), of_motion].concat();
        let told: HashSet<String> = all.iter().map(|name| name.to_lowercase()).collect();
        assert_eq!(told.len(), all.len(), "{all:?}");
        // The declared names are those of the header, and the Rust routines keep their names.
        let header = [header::header(&module, "double"), motion::header(&module, &motion)].concat();
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
        // The contact with the plain name keeps it.
        let symbol = |name: &str| {
            module.routines.iter().find(|routine| routine.name == name).map(|routine| routine.symbol.clone())
        };
        assert_eq!(symbol("collide_tip_with_budget").as_deref(), Some("collide_tip_with_budget"));
        assert_eq!(symbol("collide_tip").as_deref(), Some("collide_tip__"));
        assert!(library::library(&module, "f64", false).contains("mechanism.collide_tip("));
    }
}
