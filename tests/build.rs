//! Generates calls of all routines of the modules of `hodograph-models`: one `impl Emitted` per file in
//! `models/`, from what the generator emits for it. So the tests call every routine of every model, and a new
//! model needs no entry anywhere.

use std::fmt::Write;
use std::path::Path;

use hodograph_generator::emit::{
    self,
    interface::{Interface, Signature, Type},
};
use hodograph_generator::files;
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::rust_names::snake_case;
use hodograph_generator::{artifact, check::check};

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut paths: Vec<_> = std::fs::read_dir(&folder)
        .expect("the folder models")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "mech"))
        .collect();
    paths.sort();
    let mut text = String::new();
    let mut modules = Vec::new();
    for path in paths {
        let derivation = path.with_extension("derivation");
        println!("cargo::rerun-if-changed={}", path.display());
        println!("cargo::rerun-if-changed={}", derivation.display());
        // A model that is not accepted or not derived is a matter for the tests, which say so.
        let Some(mechanism) = check(&files::model(&path)).mechanism else { continue };
        let Ok(derived) = std::fs::read_to_string(derivation) else { continue };
        let Ok(artifact) = artifact::decode(&derived) else { continue };
        let module = path.file_stem().expect("a stem").to_string_lossy().into_owned();
        let Ok(offered) = emit::interface(&mechanism, &artifact.program, &module) else { continue };
        write_module(&mut text, &offered, &mechanism);
        modules.push(module);
    }
    writeln!(text, "/// All of them.\npub fn emitted() -> Vec<Box<dyn Emitted>> {{\n    vec![").unwrap();
    modules.iter().for_each(|module| writeln!(text, "        Box::new({module}),").unwrap());
    writeln!(text, "    ]\n}}").unwrap();
    let output = Path::new(&std::env::var_os("OUT_DIR").expect("a folder for output")).join("emitted.rs");
    std::fs::write(output, text).expect("written");
}

/// The routines that tests call with numbers that carry derivatives.
const DIFFERENTIATED: [&str; 4] =
    ["accelerations", "inverse_dynamics", "coordinate_rates", "configuration_residual"];

/// The beginnings of the names of routines that tests call for four states at once: those of every kind of answer,
/// with and without divisors.
const IN_LANES: [&str; 10] = [
    "accelerations",
    "inverse_dynamics",
    "mass_matrix",
    "coordinate_rates",
    "kinetic_energy",
    "position_",
    "gap_",
    "contact_velocity_",
    "free_acceleration_",
    "reduced_matrix_",
];

/// What such a routine gets for an argument.
fn dual(argument: &str) -> &'static str {
    match argument {
        "time" => "Dual64::from_re(at.time)",
        "q" => "&duals(&at.coordinates, &along.coordinates).into()",
        "u" => "&duals(&at.speeds, &along.speeds).into()",
        "acceleration" => "&duals(&at.accelerations, &[]).into()",
        _ => "&duals(&at.inputs, &along.inputs).into()",
    }
}

/// Whether other tests call a method: `mechanisms_by_slices.rs`, `closed_contacts.rs` and `saltation.rs`.
fn is_called_elsewhere(method: &Signature) -> bool {
    ["contact_mode_", "contact_force_", "impact_without_collision_", "saltation_"]
        .iter()
        .any(|prefix| method.name.starts_with(prefix))
}

/// The arguments of a method, plain numbers.
fn passed(method: &Signature) -> String {
    let passed = method.arguments.iter().map(|argument| match argument.name {
        "time" => "at.time",
        "q" => "&array(&at.coordinates).into()",
        "u" => "&array(&at.speeds).into()",
        "acceleration" => "&array(&at.accelerations).into()",
        "inputs" => "&array(&at.inputs).into()",
        "tangent" => "&array(&at.tangent)",
        "surface" => "surface",
        other => panic!("{} has an argument {other} that tests do not know", method.name),
    });
    passed.collect::<Vec<_>>().join(", ")
}

/// The call of a method with plain numbers.
fn call(method: &Signature) -> String {
    format!("Self::machine(at).{}({})", method.name, passed(method))
}

/// The call with numbers that carry derivatives.
fn dual_call(method: &Signature) -> String {
    let passed: Vec<&str> = method.arguments.iter().map(|argument| dual(argument.name)).collect();
    format!("Self::dual_machine(at).{}({})", method.name, passed.join(", "))
}

/// The call for several states `at`, and the machines of them.
fn call_in_lanes(method: &Signature, path: &str, name: &str) -> String {
    let of = |record: &str, list: &str| {
        format!("&{path}::{record}::<F64x4>::from_lanes(|lane| array(&at[lane].{list}).into())")
    };
    let passed = method.arguments.iter().map(|argument| match argument.name {
        "time" => "F64x4::from_lanes(|lane| at[lane].time)".to_owned(),
        "q" => of("Coordinates", "coordinates"),
        "u" => of("Speeds", "speeds"),
        "acceleration" => of("Speeds", "accelerations"),
        "inputs" => of("Inputs", "inputs"),
        other => panic!("{} has an argument {other} that is not known in lanes", method.name),
    });
    let passed = passed.collect::<Vec<_>>().join(", ");
    format!("{path}::{name}::<F64x4>::from_lanes(|lane| Self::machine(&at[lane])).{}({passed})", method.name)
}

/// What makes a list of numbers of the `value` that a method answers; nothing for one that collisions and
/// `mechanisms_by_slices.rs` call.
fn flat(method: &Signature) -> Option<&'static str> {
    Some(match &method.answer {
        Type::Pair(..) | Type::ContactState => return None,
        Type::Vector(_) | Type::Matrix(..) => "by_rows(value)",
        Type::Reduced => "<[f64; 6]>::from(value).to_vec()",
        Type::Array(..) => "value.to_vec()",
        Type::Number => "vec![value]",
        Type::Struct(name) => match name.as_str() {
            "Coordinates" | "Speeds" | "DependentSpeeds" => "<[_; _]>::from(value).to_vec()",
            "ContactDerivatives" => "contact_beside!(value)",
            "Derivatives" => "beside!(value)",
            "Linearisation" => "[by_rows(value.a), by_rows(value.b)].concat()",
            _ => panic!("{} answers {name}, which tests do not know", method.name),
        },
        other => panic!("{} answers {other:?}, which tests do not know", method.name),
    })
}

/// Writes the calls of a module's methods.
fn write_module(text: &mut String, offered: &Interface, mechanism: &Mechanism) {
    let (module, name) = (&offered.module, &offered.mechanism);
    let path = format!("hodograph_models::{module}");
    let contact_of = |method: &Signature| {
        let contact = method.name.strip_prefix("collide_")?;
        mechanism.contacts.iter().position(|of| snake_case(&of.name) == contact)
    };
    let mut routines = String::new();
    let mut collisions = String::new();
    let mut duals = String::new();
    let mut in_places = String::new();
    let (mut in_lanes, mut of_lanes) = (String::new(), String::new());
    for method in offered.methods.iter().filter(|method| !is_called_elsewhere(method)) {
        let (name, call) = (method.name.as_str(), call(method));
        if name.starts_with("collide_") {
            if let Some(contact) = contact_of(method) {
                writeln!(collisions, "            {contact} => hit!({call}),").unwrap();
            }
        } else if let Some(flat) = flat(method) {
            if DIFFERENTIATED.contains(&name) {
                let call = dual_call(method);
                // The closure as clippy wants it.
                let flatten =
                    if flat == "by_rows(value)" { "by_rows".into() } else { format!("|value| {flat}") };
                writeln!(duals, "            \"{name}\" => {call}.map({flatten}),").unwrap();
            }
            writeln!(
                routines,
                "            \"{name}\" => match {call} {{ Ok(value) => Ok({flat}), Err(error) => Err(error.to_string()) }},"
            )
            .unwrap();
            if IN_LANES.iter().any(|begin| name.starts_with(begin)) {
                let call = call_in_lanes(method, &path, &offered.mechanism);
                let flat = flat.replace("f64", "F64x4");
                writeln!(of_lanes, "            \"{name}\",").unwrap();
                writeln!(
                    in_lanes,
                    "            \"{name}\" => match {call} {{ Ok(value) => Ok({flat}), Err(error) => Err(error.to_string()) }},"
                )
                .unwrap();
            }
            if let Some(in_place) = &method.in_place {
                // What is overwritten is the answer at another state.
                let (into, passed) = (&in_place.into, passed(method));
                writeln!(
                    routines,
                    "            \"{into}\" => {{ let other = {{ let at = &elsewhere(at); {call} }}; match other {{ Ok(mut value) => match Self::machine(at).{into}({passed}, &mut value) \
                     {{ Ok(()) => Ok({flat}), Err(error) => Err(error.to_string()) }}, Err(error) => Err(error.to_string()) }} }},"
                )
                .unwrap();
                writeln!(in_places, "            \"{name}\",").unwrap();
            }
        }
    }
    write!(
        text,
        "
#[allow(non_camel_case_types)]
struct {module};

impl {module} {{
    fn machine(at: &Inputs) -> {path}::{name}<f64> {{
        {path}::{name}::new(array(&at.parameters).into()).expect(\"good parameters\")
    }}

    fn dual_machine(at: &Inputs) -> {path}::{name}<Dual64> {{
        {path}::{name}::new(duals(&at.parameters, &[]).into()).expect(\"good parameters\")
    }}
}}

impl Emitted for {module} {{
    fn name(&self) -> &'static str {{
        \"{module}\"
    }}
    fn call(&self, routine: &str, at: &Inputs) -> Option<Result<Vec<f64>, String>> {{
        Some(match routine {{
{routines}            _ => return None,
        }})
    }}
    fn in_place(&self) -> &'static [&'static str] {{
        &[
{in_places}        ]
    }}
    fn of_lanes(&self) -> &'static [&'static str] {{
        &[
{of_lanes}        ]
    }}
    fn in_lanes(&self, routine: &str, at: &[Inputs; 4]) -> Option<Result<Vec<F64x4>, String>> {{
        Some(match routine {{
{in_lanes}            _ => return None,
        }})
    }}
    fn along(&self, routine: &str, at: &Inputs, along: &Inputs) -> Option<Vec<f64>> {{
        let answer: Result<Vec<Dual64>, StateError> = match routine {{
{duals}            _ => return None,
        }};
        Some(answer.expect(\"a regular state\").into_iter().map(|number| number.eps).collect())
    }}
    fn collide(&self, contact: usize, at: &Inputs, surface: &Surface<f64>) -> Result<Hit, String> {{
        match contact {{
{collisions}            _ => panic!(\"no contact {{contact}}\"),
        }}
    }}
    fn by_slices(&self, at: &Inputs) -> Box<dyn Contacts> {{
        Box::new(Self::machine(at))
    }}
}}
"
    )
    .unwrap();
}
