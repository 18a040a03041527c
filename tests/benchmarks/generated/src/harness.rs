//! The programs that are measured: a generated module and a loop over its routines.

use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

use crate::derive::Derivation;
use crate::states::{Named, State};
use crate::tools::{Failure, Folders, effort};

/// What the code is compiled for.
pub const TARGET: &str = "x86-64-v3";

/// A compiled program.
pub struct Built {
    /// the file
    pub program: PathBuf,
    /// name of its package
    pub package: String,
    /// seconds of the processor for compiling and linking it, dependencies apart
    pub seconds: f64,
}

/// The measured routines: short name, and its function in the program.
pub const ROUTINES: [(&str, &str); 4] =
    [("FD", "measured_fd"), ("ID", "measured_id"), ("CM", "measured_cm"), ("M", "measured_m")];

/// The measured routines that differentiate, likewise; a derivation that is too long for them has none.
pub const DERIVATIVES: [(&str, &str); 3] =
    [("dFD", "measured_dfd"), ("dID", "measured_did"), ("A, B", "measured_linear")];

const MANIFEST: &str = "\
[package]
name = \"{name}\"
version = \"0.1.0\"
edition = \"2024\"

[dependencies]
hodograph = { path = \"{runtime}\", features = [\"fused\"] }
";

/// Writes a workspace with a package per derivation and compiles what they have in common.
pub fn prepare(folders: &Folders, derivations: &[Derivation<'_>]) -> Result<(), Failure> {
    let workspace = folders.work.join("crates");
    // What an earlier run left is no member of this one.
    let _ = std::fs::remove_dir_all(&workspace);
    write(folders, "nothing", "main.rs", "fn main() {}\n")?;
    for derivation in derivations {
        let package = derivation.package();
        write(folders, &package, "main.rs", &main(derivation))?;
        write(folders, &package, "module.rs", &derivation.module)?;
    }
    std::fs::write(workspace.join("Cargo.toml"), "[workspace]\nresolver = \"3\"\nmembers = [\"*\"]\n")?;
    std::fs::copy(folders.root.join("Cargo.lock"), workspace.join("Cargo.lock"))?;
    cargo(folders, "nothing").map(|_| ())
}

/// Writes a source file of a package, and its manifest.
pub fn write(folders: &Folders, package: &str, file: &str, text: &str) -> Result<(), Failure> {
    let folder = folders.work.join("crates").join(package);
    std::fs::create_dir_all(folder.join("src"))?;
    let runtime = folders.root.join("runtime").display().to_string();
    let manifest = MANIFEST.replace("{name}", package).replace("{runtime}", &runtime);
    std::fs::write(folder.join("Cargo.toml"), manifest)?;
    Ok(std::fs::write(folder.join("src").join(file), text)?)
}

/// Writes a package that is a library, with the module of a derivation beside it.
pub fn write_library(folders: &Folders, package: &str, text: &str, module: &str) -> Result<(), Failure> {
    write(folders, package, "module.rs", module)?;
    write(folders, package, "lib.rs", text)
}

/// Compiles a package.
pub fn cargo(folders: &Folders, package: &str) -> Result<Built, Failure> {
    compiled(folders, package, "")
}

/// Compiles a package without dividing it into units, which gives somewhat other code.
pub fn as_one_unit(folders: &Folders, package: &str) -> Result<Built, Failure> {
    compiled(folders, package, " -C codegen-units=1")
}

/// Compiles a package with more flags.
fn compiled(folders: &Folders, package: &str, flags: &str) -> Result<Built, Failure> {
    let target = folders.work.join("target");
    let mut command = Command::new("cargo");
    command
        .args(["build", "--release", "-p", package, "--target-dir"])
        .arg(&target)
        .current_dir(folders.work.join("crates"))
        // A cache of compiled crates would hide what compiling takes.
        .env_remove("RUSTC_WRAPPER")
        .env("RUSTFLAGS", format!("-C target-cpu={TARGET}{flags}"));
    let taken = effort(&mut command, &folders.work.join("effort"))?;
    let program = target.join("release").join(package);
    Ok(Built { program, package: package.to_owned(), seconds: taken.seconds })
}

/// Compiles the program of a derivation.
pub fn build(folders: &Folders, derivation: &Derivation<'_>) -> Result<Built, Failure> {
    let package = derivation.package();
    // Even an unchanged program is compiled again.
    let main = folders.work.join("crates").join(&package).join("src/main.rs");
    std::fs::write(&main, self::main(derivation))?;
    cargo(folders, &package)
}

/// The program: `numbers` prints what the routines answer at its states, `answer` at states that it reads, a
/// number repeats all routines that often at its states.
fn main(derivation: &Derivation<'_>) -> String {
    let case = derivation.case;
    let (module, contact) = (module_name(derivation), case.contact);
    let mechanism = type_name(derivation);
    let inputs = if case.inputs { ", i" } else { "" };
    let numbers = "Result<impl Numbers, StateError>";
    let (record, empty) = if case.inputs { ("Inputs", "Inputs::default()") } else { ("()", "()") };
    let arguments = format!("m: &Machine, q: &Coordinates, u: &Speeds, a: &Speeds, i: &{record}");
    let differentiated = differentiated(derivation);
    let derivatives = if differentiated { derivatives(&arguments, inputs) } else { String::new() };
    let mut text = format!(
        "#![allow(unused)]
use std::hint::black_box;
use hodograph::{{ReducedMatrix, StateError, nalgebra::SMatrix}};
include!(\"module.rs\");
use {module}::*;
type Machine = {mechanism}<f64>;
type State = (Coordinates, Speeds, Speeds, {record});

#[inline(never)]
fn measured_fd({arguments}) -> {numbers} {{ m.accelerations(q, u{inputs}) }}
#[inline(never)]
fn measured_id({arguments}) -> {numbers} {{ m.inverse_dynamics(q, u, a{inputs}) }}
#[inline(never)]
fn measured_cm({arguments}) -> {numbers} {{ m.contact_matrices_{contact}(q) }}
#[inline(never)]
fn measured_m({arguments}) -> {numbers} {{ m.mass_matrix(q) }}

/// What a routine answers, as a line.
trait Numbers {{
    fn numbers(&self) -> Vec<f64>;
}}
{derivatives}impl Numbers for Speeds {{
    fn numbers(&self) -> Vec<f64> {{ <[f64; {speeds}]>::from(*self).to_vec() }}
}}
impl<const R: usize, const C: usize> Numbers for SMatrix<f64, R, C> {{
    fn numbers(&self) -> Vec<f64> {{ self.transpose().iter().copied().collect() }}
}}
impl<A: Numbers> Numbers for (A, ReducedMatrix<f64>) {{
    fn numbers(&self) -> Vec<f64> {{
        let mut all = self.0.numbers();
        all.extend(<[f64; 6]>::from(self.1));
        all
    }}
}}
fn line(numbers: Result<impl Numbers, StateError>) {{
    let words: Vec<String> = match numbers {{
        Ok(numbers) => numbers.numbers().iter().map(|number| format!(\"{{number:?}}\")).collect(),
        Err(error) => vec![error.to_string()],
    }};
    println!(\"{{}}\", words.join(\" \"));
}}

fn line_of_all({arguments}, none: &{record}) {{
    line(measured_fd(m, q, u, a, i));
    line(measured_id(m, q, u, a, none));
    line(measured_cm(m, q, u, a, i));
    line(measured_m(m, q, u, a, i));
}}
fn line_of_derivatives({arguments}, none: &{record}) {{
    {lines}
}}

fn main() {{
    let m = black_box(Machine::default());
    let none = black_box({empty});
    let states: Vec<State> = black_box(vec![\n",
        speeds = derivation.speeds.len(),
        lines = if differentiated {
            "line(measured_dfd(m, q, u, a, i)); line(measured_did(m, q, u, a, none));"
        } else {
            ""
        },
    );
    for state in &derivation.states {
        let _ = writeln!(text, "        ({}),", self::state(state, case.inputs));
    }
    text += "    ]);
    let argument = std::env::args().nth(1).unwrap_or_default();
";
    if let (true, Some(state)) = (case.inputs, derivation.states.first()) {
        let lengths = [&state.q, &state.u, &state.a, &state.inputs].map(|list| list.len());
        text += &answer(lengths);
    }
    text += "\
    for (q, u, a, i) in &states {
        if argument == \"numbers\" {
            line_of_all(&m, q, u, a, i, &none);
        }
        if argument == \"derivatives\" {
            line_of_derivatives(&m, q, u, a, i, &none);
        }
    }
    for _ in 0..argument.parse().unwrap_or(0) {
        for (q, u, a, i) in &states {
            let _ = black_box(measured_fd(black_box(&m), black_box(q), black_box(u), black_box(a), black_box(i)));
            let _ = black_box(measured_id(black_box(&m), black_box(q), black_box(u), black_box(a), black_box(&none)));
            let _ = black_box(measured_cm(black_box(&m), black_box(q), black_box(u), black_box(a), black_box(i)));
            let _ = black_box(measured_m(black_box(&m), black_box(q), black_box(u), black_box(a), black_box(i)));
";
    if differentiated {
        text += "\
            let _ = black_box(measured_dfd(black_box(&m), black_box(q), black_box(u), black_box(a), black_box(i)));
            let _ = black_box(measured_did(black_box(&m), black_box(q), black_box(u), black_box(a), black_box(&none)));
            let _ = black_box(measured_linear(black_box(&m), black_box(q), black_box(u), black_box(a), black_box(i)));
";
    }
    text += "\
        }
    }
}
";
    text
}

/// Whether the module has all routines that differentiate.
pub fn differentiated(derivation: &Derivation<'_>) -> bool {
    derivation.module.contains("fn accelerations_derivatives(")
}

/// The functions that are measured of the routines that differentiate, and how their answers are written:
/// value, then derivatives.
fn derivatives(arguments: &str, inputs: &str) -> String {
    format!(
        "impl<T: Numbers> Numbers for Result<T, StateError> {{
    fn numbers(&self) -> Vec<f64> {{ self.as_ref().map(T::numbers).unwrap_or_default() }}
}}
impl Numbers for Derivatives<f64> {{
    fn numbers(&self) -> Vec<f64> {{
        [self.value.numbers(), self.by_coordinates.numbers(), self.by_speeds.numbers(), self.by_inputs.numbers()].concat()
    }}
}}
impl Numbers for Linearisation<f64> {{
    fn numbers(&self) -> Vec<f64> {{ [self.a.numbers(), self.b.numbers()].concat() }}
}}
#[inline(never)]
fn measured_dfd({arguments}) -> Result<Derivatives<f64>, StateError> {{ m.accelerations_derivatives(q, u{inputs}) }}
#[inline(never)]
fn measured_did({arguments}) -> Result<Derivatives<f64>, StateError> {{ m.inverse_dynamics_derivatives(q, u, a{inputs}) }}
#[inline(never)]
fn measured_linear({arguments}) -> Result<Linearisation<f64>, StateError> {{ m.linearise(q, u{inputs}) }}
"
    )
}

/// `answer` reads states, one per line, and prints what the routines answer.
fn answer([q, u, a, i]: [usize; 4]) -> String {
    format!(
        "    if argument == \"answer\" {{
        for line in std::io::stdin().lines() {{
            let mut numbers = line.unwrap_or_default().split(' ').map_while(|word| word.parse().ok()).collect::<Vec<f64>>().into_iter();
            let mut next = || numbers.next().unwrap_or(f64::NAN);
            let q = Coordinates::from(std::array::from_fn::<f64, {q}, _>(|_| next()));
            let u = Speeds::from(std::array::from_fn::<f64, {u}, _>(|_| next()));
            let a = Speeds::from(std::array::from_fn::<f64, {a}, _>(|_| next()));
            let i = Inputs::from(std::array::from_fn::<f64, {i}, _>(|_| next()));
            line_of_all(&m, &q, &u, &a, &i, &none);
        }}
    }}
"
    )
}

/// A state as Rust expressions: coordinates, speeds, their rates, inputs.
pub fn state(state: &State, inputs: bool) -> String {
    let record = |name: &str, values: &Named| {
        let fields: Vec<String> = values.iter().map(|(name, value)| format!("{name}: {value:?}")).collect();
        format!("{name} {{ {} }}", fields.join(", "))
    };
    let inputs = if inputs { record("Inputs", &state.inputs) } else { "()".to_owned() };
    [record("Coordinates", &state.q), record("Speeds", &state.u), record("Speeds", &state.a), inputs]
        .join(", ")
}

/// The first word after `start` in the module.
fn word<'a>(derivation: &'a Derivation<'_>, start: &str) -> &'a str {
    let rest = derivation.module.split_once(start).map_or("", |(_, rest)| rest);
    rest.split(|letter: char| !letter.is_alphanumeric() && letter != '_').next().unwrap_or("")
}

/// Name of the module.
pub fn module_name<'a>(derivation: &'a Derivation<'_>) -> &'a str {
    word(derivation, "pub mod ")
}

/// The mechanism's type is the one with a field of hoisted values.
pub fn type_name<'a>(derivation: &'a Derivation<'_>) -> &'a str {
    let end = derivation.module.find("hoisted: [").unwrap_or(derivation.module.len());
    let start = derivation.module[..end].rfind("pub struct ").unwrap_or(0);
    let rest = &derivation.module[start + "pub struct ".len()..];
    rest.split(|letter: char| !letter.is_alphanumeric() && letter != '_').next().unwrap_or("")
}
