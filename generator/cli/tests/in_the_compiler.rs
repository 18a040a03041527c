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
    let mut tool = Command::new(env!("CARGO_BIN_EXE_hodograph"));
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
     State Scalar Mechanism Contacts Surface Law Kind Parameters Coordinates Speeds Inputs Collision Derivatives MODEL NAMES UNITS DESCRIPTION q u v0 v1c \
     inputs parameters coordinates speeds hoisted new get iter from into state first second normal binormal mass_matrix forcing surface array number \
     Output index what rates of_part_1 given_1 lanes_1 krate union auto raw dyn_ macro_rules safe";

/// What `check` accepts becomes a module that compiles, whatever the names are; what would not compile is
/// refused.
#[test]
fn what_check_accepts_compiles() {
    let (mut models, mut refused) = (Vec::new(), Vec::new());
    let mut add = |text: String| {
        let source = hodograph_generator::source::Source::file("names.mech", text.clone());
        match hodograph_generator::check::check(&source).mechanism {
            Some(_) => models.push(text),
            None => refused.push(text),
        }
    };
    for (i, name) in MEANT.split_whitespace().enumerate() {
        // as a parameter, an input, a coordinate and a speed
        add(format!(
            "mechanism Named{i}; parameters {{ mm0: kg = 1, {name}: m = 1 }} coordinates {{ qq: rad = 0.3 }} speeds {{ uu: rad/s = 1 }}
             frames {{ B0 = N.rotate(z, qq); }} points {{ P0 = O + {name}*B0.x; }} particles {{ A0 {{ point: P0, mass: mm0 }} }}
             kinematics {{ d(qq)/dt = uu; }}"
        ));
        add(format!(
            "mechanism Moved{i}; parameters {{ mm0: kg = 1 }} inputs {{ F0: N }} coordinates {{ {name}: m = 1 }} speeds {{ uu: m/s }}
             points {{ P0 = O + {name}*N.x; }} particles {{ A0 {{ point: P0, mass: mm0 }} }} loads {{ force on P0: F0*N.x; }}
             kinematics {{ d({name})/dt = uu; }}"
        ));
        add(format!(
            "mechanism {name}; parameters {{ mm0: kg = 1 }} inputs {{ {name}_: N }} coordinates {{ qq: m = 1 }} speeds {{ {name}__: m/s }}
             frames {{ F{name} = N; }} points {{ P0 = O + qq*N.x; }} particles {{ A0 {{ point: P0, mass: mm0 }} }}
             loads {{ force on P0: {name}_*N.x; }} kinematics {{ d(qq)/dt = {name}__; }}"
        ));
        // as a frame, a point, a body and a contact: one of them at a time
        for place in 0..4 {
            let of = |own: usize, other: &str| if own == place { name.to_owned() } else { other.to_owned() };
            let (frame, point, body, contact) = (of(0, "B0"), of(1, "P0"), of(2, "A0"), of(3, "c0"));
            add(format!(
                "mechanism Placed{i}x{place}; parameters {{ mm0: kg = 1, l0: m = 1 }} coordinates {{ qq: rad = 0.3 }} speeds {{ uu: rad/s = 1 }}
                 frames {{ {frame} = N.rotate(z, qq); }} points {{ {point} = O + l0*{frame}.x; }}
                 particles {{ {body} {{ point: {point}, mass: mm0 }} }} kinematics {{ d(qq)/dt = uu; }}
                 contacts {{ {contact} {{ point: {point}, normal: N.y, gap: dot(position({point}), N.y) + 2*l0, surface: {{ mu: 0.3 }} }} }}"
            ));
        }
    }
    // names that cannot be bound are refused, and no others than these
    assert!(refused.len() <= 12, "{refused:#?}");
    for text in [REPEATED_RATES, SMALL_UNITS, START] {
        models.push(text.to_owned());
    }
    assert!(models.len() > 300);
    let source: String = models
        .iter()
        .enumerate()
        .map(|(i, text)| format!("pub mod m{i} {{ hodograph_macros::mechanism! {{ {text} }} }}\n"))
        .collect();
    let built = built("accepted models");
    let output =
        package(&built, "accepted", &source.replace("use hodograph_macros::mechanism;", ""), "metadata")
            .output()
            .expect("rustc runs");
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
