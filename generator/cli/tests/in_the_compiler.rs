//! `mechanism!` with the feature `derive`, in compilers that run at the same time.
//!
//! A child cargo would build the algebra engine a second time, for the host. But what this package was built
//! from is there: the macro is linked from it here, and then rustc itself expands models without derivations,
//! as cargo would have it do.

#![cfg(feature = "derive")]

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::SystemTime;

const ARM: &str = "mechanism! {
    //! A rod on a pivot, and a wall.
    mechanism Arm;
    parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }
    coordinates { q1: rad = 0.3 }
    speeds { u1: rad/s }
    frames { B = N.rotate(z, q1); }
    points { G = O - l/2*B.y; P = O - l*B.y; }
    bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
    loads { gravity: -g*N.y; }
    contacts { tip { point: P of Rod, normal: -N.x } }
}";

/// The macro and the runtime, and where what they are made of lies.
struct Built {
    folder: PathBuf,
    dependencies: PathBuf,
    macros: PathBuf,
    runtime: PathBuf,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Libraries of this name, the newest first.
fn libraries(folder: &Path, name: &str) -> Vec<PathBuf> {
    let prefix = format!("lib{name}-");
    let mut found: Vec<(SystemTime, PathBuf)> = fs::read_dir(folder)
        .expect("the folder of this program")
        .filter_map(|entry| {
            let entry = entry.ok()?;
            let file = entry.file_name().into_string().ok()?;
            let fits = file.starts_with(&prefix) && file.ends_with(".rlib");
            fits.then(|| Some((entry.metadata().ok()?.modified().ok()?, entry.path()))).flatten()
        })
        .collect();
    found.sort();
    found.into_iter().rev().map(|(_, path)| path).collect()
}

fn rustc() -> Command {
    let mut command = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    command.args(["--edition", "2024"]).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A package of one source file in a new folder, and what compiles it.
fn package(built: &Built, name: &str, source: &str, emit: &str) -> Command {
    let folder = built.folder.join(name);
    fs::create_dir_all(folder.join("models")).expect("a folder for the test");
    for model in ["two_sleds.mech", "rolling_disc.mech", "slider_crank.mech"] {
        fs::copy(root().join("models").join(model), folder.join("models").join(model)).expect("a model");
    }
    fs::write(folder.join("lib.rs"), format!("#![no_std]\nuse hodograph_macros::mechanism;\n{source}"))
        .expect("a source file");
    let mut command = rustc();
    command
        .args(["--crate-type", "lib", "--crate-name", name, "--emit", emit, "lib.rs"])
        .arg(format!("--extern=hodograph_macros={}", built.macros.display()))
        .arg(format!("--extern=hodograph={}", built.runtime.display()))
        .arg(format!("-Ldependency={}", built.dependencies.display()))
        .env("CARGO_MANIFEST_DIR", &folder)
        .current_dir(&folder);
    command
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Links the macro with the generator that was built for this test's package. Older and other builds may lie
/// beside it.
fn built(test: &str) -> Built {
    let dependencies = std::env::current_exe().expect("this program").parent().expect("a folder").to_owned();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    let macros = folder.join(format!("{DLL_PREFIX}hodograph_macros{DLL_SUFFIX}"));
    let mut last = String::new();
    for generator in libraries(&dependencies, "hodograph_generator") {
        let output = rustc()
            .args([
                "--crate-type",
                "proc-macro",
                "--crate-name",
                "hodograph_macros",
                "--extern",
                "proc_macro",
            ])
            .arg(format!("--extern=hodograph_generator={}", generator.display()))
            .arg(format!("-Ldependency={}", dependencies.display()))
            .arg(root().join("macros/src/lib.rs"))
            .arg("-o")
            .arg(&macros)
            .output()
            .expect("rustc runs");
        if !output.status.success() {
            last = said(&output);
            continue;
        }
        for runtime in libraries(&dependencies, "hodograph") {
            let (folder, dependencies, macros) = (folder.clone(), dependencies.clone(), macros.clone());
            let built = Built { folder, dependencies, macros, runtime };
            let output = package(&built, "trial", ARM, "metadata").output().expect("rustc runs");
            if output.status.success() {
                return built;
            }
            last = said(&output);
            if last.contains("the model has no derivation") {
                break;
            }
        }
    }
    panic!("no generator with the feature `derive` in {}:\n{last}", dependencies.display());
}

/// Four crates are built and two of them checked as an editor would, all at once, while the tool derives too:
/// each waits for its turn.
#[test]
fn compilers_derive_at_once() {
    let built = built("compilers at once");
    let files = "mechanism!(\"models/two_sleds.mech\");\nmechanism!(\"models/rolling_disc.mech\");\n";
    let both = format!("{files}mechanism!(\"models/slider_crank.mech\");\n{ARM}");
    let crates = [
        ("inline", ARM, "metadata,link"),
        ("inline_checked", ARM, "metadata"),
        ("files", files, "metadata,link"),
        ("files_checked", files, "metadata"),
        ("both", &both, "metadata,link"),
        ("both_optimised", &both, "link"),
    ];
    let derived = built.folder.join("derived");
    fs::create_dir_all(&derived).expect("a folder for the test");
    fs::copy(root().join("models/two_sleds.mech"), derived.join("two_sleds.mech")).expect("a model");
    let mut commands: Vec<(&str, Command)> =
        crates.iter().map(|(name, source, emit)| (*name, package(&built, name, source, emit))).collect();
    if let Some((_, command)) = commands.last_mut() {
        command.arg("-O");
    }
    let mut tool = Command::new(crate::common::tool());
    tool.arg("derive").arg(&derived).stdin(Stdio::null());
    commands.push(("the tool", tool));
    std::thread::scope(|scope| {
        for (name, mut command) in commands {
            scope.spawn(move || {
                let output = command.output().expect("it runs");
                assert!(output.status.success(), "{name}: {}\n{}", output.status, said(&output));
                // what stands there belongs to the compiler
                assert!(output.stdout.is_empty(), "{name}: {}", String::from_utf8_lossy(&output.stdout));
            });
        }
    });
}

/// Names that mean something in Rust, in the prelude, in the runtime or in generated code.
const MEANT: &str = "Some None Ok Err Option Result Vec String Box Default Clone Copy Debug Send Drop T Iterator usize f64 str core std alloc hodograph \
     State Scalar Mechanism Contacts Surface Law ComponentKind Parameters Coordinates Speeds Inputs Collision Derivatives MODEL NAMES UNITS DESCRIPTION q u v0 v1c \
     inputs parameters coordinates speeds hoisted new get iter from into state first second normal binormal mass_matrix forcing surface array number \
     Output index what rates of_part_1 given_1 lanes_1 krate union auto raw dyn_ macro_rules safe";

/// Models in which these names stand for things of every kind.
fn named(names: &[&str]) -> Vec<String> {
    let each = |of: &dyn Fn(usize, &str) -> String, between: &str| {
        names.iter().enumerate().map(|(i, name)| of(i, name)).collect::<Vec<_>>().join(between)
    };
    let moving = |coordinates: &str, speeds: &str, positions: &str, rates: &str| {
        format!(
            "mechanism Moving; parameters {{ mm0: kg = 1 }} coordinates {{ {coordinates} }} speeds {{ {speeds} }} points {{ {positions} }}
             particles {{ {} }} kinematics {{ {rates} }}",
            each(&|i, _| format!("A{i} {{ point: P{i}, mass: mm0 }}"), ", ")
        )
    };
    let turning = |parameters: &str,
                   inputs: &str,
                   frames: &str,
                   points: &str,
                   body: &str,
                   loads: &str,
                   contacts: &str| {
        format!(
            "mechanism Turning; parameters {{ mm0: kg = 1, l0: m = 1, {parameters} }} inputs {{ {inputs} }} coordinates {{ qq: rad = 0.3 }}
             speeds {{ uu: rad/s = 1 }} frames {{ B0 = N.rotate(z, qq); {frames} }} points {{ P0 = O + l0*B0.x; {points} }}
             particles {{ {body} {{ point: P0, mass: mm0 }} }} loads {{ {loads} }} kinematics {{ d(qq)/dt = uu; }} contacts {{ {contacts} }}"
        )
    };
    let sum = each(&|_, name| name.to_owned(), " + ");
    vec![
        turning(
            &each(&|_, name| format!("{name}: m = 1"), ", "),
            "",
            "",
            &format!("S0 = P0 + ({sum})*B0.y;"),
            "A0",
            "",
            "",
        ),
        turning(
            "",
            &each(&|_, name| format!("{name}: N"), ", "),
            "",
            "",
            "A0",
            &format!("force on P0: ({sum})*N.x;"),
            "",
        ),
        turning(
            "",
            "",
            &each(&|_, name| format!("{name} = B0.rotate(x, qq);"), " "),
            &each(&|i, name| format!("S{i} = P0 + l0*{name}.y;"), " "),
            "A0",
            "",
            "",
        ),
        turning("", "", "", &each(&|_, name| format!("{name} = P0 + l0*B0.y;"), " "), "A0", "", ""),
        turning(
            "",
            "",
            "",
            "",
            "A0",
            "",
            &each(
                &|_, name| {
                    format!(
                        "{name} {{ point: P0, normal: N.y, gap: 2*l0 + dot(position(P0), N.y), surface: {{ mu: 0.3 }} }}"
                    )
                },
                ", ",
            ),
        ),
        turning("", "", "", "", names[0], "", &format!("c0 {{ point: P0 of {}, normal: N.y }}", names[0])),
        moving(
            &each(&|_, name| format!("{name}: m"), ", "),
            &each(&|i, _| format!("ss{i}: m/s"), ", "),
            &each(&|i, name| format!("P{i} = O + {name}*N.x;"), " "),
            &each(&|i, name| format!("d({name})/dt = ss{i};"), " "),
        ),
        moving(
            &each(&|i, _| format!("cc{i}: m"), ", "),
            &each(&|_, name| format!("{name}: m/s"), ", "),
            &each(&|i, _| format!("P{i} = O + cc{i}*N.x;"), " "),
            &each(&|i, name| format!("d(cc{i})/dt = {name};"), " "),
        ),
    ]
}

/// What `check` accepts becomes a module that compiles, whatever the names are; what would not compile is
/// refused.
#[test]
fn what_check_accepts_compiles() {
    let accepted = |text: &str| {
        let source = hodograph_generator::source::Source::file("names.mech", text);
        hodograph_generator::check::check(&source).mechanism.is_some()
    };
    // those that are refused are so where they are bound to a value alone
    let (mut names, mut refused): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for name in MEANT.split_whitespace() {
        let models = named(&[name]);
        if models.iter().all(|text| accepted(text)) {
            names.push(name);
        } else {
            assert_eq!(models.iter().filter(|text| accepted(text)).count(), 4, "{name}");
            refused.push(name);
        }
    }
    assert_eq!(refused, ["Some", "None", "Ok", "Err", "DESCRIPTION"]);
    let unlike = |list: &[&str]| -> Vec<String> { list.iter().map(|name| name.to_lowercase()).collect() };
    let mut seen: Vec<&str> = Vec::new();
    names.retain(|name| {
        let new = !unlike(&seen).contains(&name.to_lowercase());
        seen.push(name);
        new
    });
    names.truncate(60);
    let mut models = named(&names);
    // frames, points, contacts and bodies may have these names too
    models.extend(named(&refused).drain(2..6));
    for (i, name) in
        MEANT.split_whitespace().enumerate().filter(|(_, name)| name.starts_with(char::is_uppercase))
    {
        models.push(format!(
            "mechanism {name}; parameters {{ m{i}: kg = 1 }} coordinates {{ qq: m }} speeds {{ uu: m/s }} points {{ P0 = O + qq*N.x; }}
             particles {{ A0 {{ point: P0, mass: m{i} }} }} kinematics {{ d(qq)/dt = uu; }}"
        ));
    }
    models.extend([REPEATED_RATES, SMALL_UNITS, START].map(str::to_owned));
    let refused: Vec<&String> = models.iter().filter(|text| !accepted(text)).collect();
    assert!(refused.is_empty(), "{refused:#?}");
    let source: String = models
        .iter()
        .enumerate()
        .map(|(i, text)| format!("pub mod m{i} {{ hodograph_macros::mechanism! {{ {text} }} }}\n"))
        .collect();
    let built = built("accepted models");
    let output = package(&built, "accepted", &source, "metadata").output().expect("rustc runs");
    assert!(output.status.success(), "{}", said(&output));
}

/// Kinematical equations of which one repeats another.
const REPEATED_RATES: &str =
    "mechanism Repeated; parameters { m: kg = 1 } coordinates { x: m, y: m } speeds { a: m/s, b: m/s }
    points { P = O + x*N.x + y*N.y; } particles { A { point: P, mass: m } }
    kinematics { d(x)/dt + d(y)/dt = a; 2*d(x)/dt + 2*d(y)/dt = 2*a; d(x)/dt - d(y)/dt = b; }";

/// Lengths in units of all sizes, in one vector equation too.
const SMALL_UNITS: &str = "mechanism Small; parameters { m: kg = 1 } coordinates { z: m = 1, x: Tm, y: pm } speeds { w: m/s, u: pm/s }
    dependent { v: Tm/s } points { P = O + x*N.x + y*N.y + z*N.z; } particles { A { point: P, mass: m } }
    kinematics { d(z)/dt = w; d(x)/dt = v; d(y)/dt = u; } constraints { v = 2*w; }";

/// Initial values that follow from others.
const START: &str = "mechanism Start; parameters { m: kg = 1, l: m = 2 } coordinates { x: m = l*sin(pi/6), y: mm = touching(floor, 60) }
    speeds { u: m/s, v: m/s = 2*u } points { P = O + x*N.x + y*N.y; } particles { A { point: P, mass: m } }
    kinematics { d(x)/dt = u; d(y)/dt = v; } contacts { floor { point: P, normal: N.y, gap: y - l/40 } }";

/// What cannot be derived is an error of the compiler at the user's tokens, and the next model is derived all
/// the same.
#[test]
fn mistakes_are_errors_of_the_compiler() {
    let built = built("compiler with mistakes");
    let wrong = ARM.replace("l: m", "l: s").replace("mechanism Arm;", "mechanism Wrong;");
    let output =
        package(&built, "wrong", &format!("{wrong}\n{ARM}"), "metadata").output().expect("rustc runs");
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("[E031] `l` is declared in s, but its uses need m"), "{said}");
    assert!(said.contains("lib.rs:6:32"), "{said}");
    assert_eq!(said.matches("\nerror").count() + usize::from(said.starts_with("error")), 2, "{said}");
    assert!(output.stdout.is_empty());
}
