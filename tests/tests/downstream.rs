//! The packages of `tests/fixtures`, outside of the workspace, built by a child cargo as a user would: features are not unified with
//! the workspace's.
//!
//! * `downstream`: a crate with its own models, `no_std`, the dependency renamed, every warning an error,
//!   without the algebra engine;
//! * `cart`, `puck` and `robot`: three crates with models, which cargo builds at the same time;
//! * `freestanding`: a program without operating system, libc and allocator. It links only if nothing in a
//!   generated collision can panic.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The crates with models that are built at the same time.
const AT_ONCE: [&str; 6] = ["-p", "cart", "-p", "puck", "-p", "robot"];

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// Where the fixtures are built: what several of them need is built once.
fn target() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("fixtures")
}

fn cargo(arguments: &[&str]) -> Output {
    command(arguments).output().expect("cargo runs")
}

fn command(arguments: &[&str]) -> Command {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args(arguments)
        .args(["--offline", "--locked", "--target-dir"])
        .arg(target())
        .current_dir(fixtures());
    // What belongs to the outer build must not leak into the inner one.
    for (key, _) in std::env::vars_os() {
        let key = key.to_string_lossy().into_owned();
        if key.starts_with("CARGO_") && key != "CARGO_HOME" || key == "RUSTFLAGS" {
            command.env_remove(key);
        }
    }
    command
}

fn succeeds(arguments: &[&str]) -> String {
    let output = cargo(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {arguments:?} in tests/fixtures:\n{errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_users_crate_builds_and_collides() {
    succeeds(&["test", "-p", "downstream", "--lib"]);
    // Nothing is printed on stdout by the macro, so a build's messages stay JSON.
    let messages = succeeds(&["check", "-p", "downstream", "--message-format=json"]);
    for line in messages.lines() {
        assert!(serde_json::from_str::<serde_json::Value>(line).is_ok(), "not JSON: {line}");
    }
    one_ready_made_model_is_built();
}

/// The user's crate names one of the ready-made models: the compiler has read that one.
fn one_ready_made_model_is_built() {
    let built = target().join("debug/deps");
    let mut lists = 0;
    for entry in std::fs::read_dir(built).expect("it was built there").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with("hodograph_models-") && name.ends_with(".d") {
            let files = std::fs::read_to_string(entry.path()).expect("text");
            let models: BTreeSet<&str> =
                files.split(['/', ' ', ':', '\n']).filter(|file| file.ends_with(".mech")).collect();
            assert_eq!(models, BTreeSet::from(["two_sleds.mech"]), "{name}");
            lists += 1;
        }
    }
    assert!(lists > 0, "no list of what hodograph-models was built of");
}

/// `cargo build` of three crates with models, and beside it `cargo check`, as an editor runs it: nothing
/// waits for ever, nothing aborts, and standard output stays JSON.
#[test]
fn three_crates_with_models_build_at_once() {
    build_at_once(&[]);
}

/// The same with a model that the compiler derives.
#[test]
#[ignore = "builds the algebra engine for the compiler: some minutes"]
fn three_crates_derive_at_once() {
    build_at_once(&["--features", "robot/absent,robot/derive"]);
}

fn build_at_once(features: &[&str]) {
    let commands = [&["build"][..], &["check"], &["check", "--tests"]];
    let run = |arguments: &[&str]| {
        let mut command = command(arguments);
        let output = command.args(AT_ONCE).arg("--message-format=json").args(features).output();
        let output = output.expect("cargo runs");
        assert!(output.status.success(), "cargo {arguments:?}:\n{}", String::from_utf8_lossy(&output.stderr));
        for line in String::from_utf8_lossy(&output.stdout).lines() {
            assert!(serde_json::from_str::<serde_json::Value>(line).is_ok(), "not JSON: {line}");
        }
    };
    // each is read by a thread: one that waits to be read holds the lock that the others wait for
    std::thread::scope(|scope| {
        for arguments in commands {
            scope.spawn(move || run(arguments));
        }
    });
}

/// Comments of a model become documentation, whatever is drawn in them: none of it is taken for an example,
/// and rustdoc has nothing to say of it.
#[test]
fn comments_of_a_model_are_no_examples() {
    succeeds(&["test", "-p", "puck", "--doc"]);
    let mut documented = command(&["doc", "-p", "puck", "--no-deps"]);
    let output = documented.env("RUSTDOCFLAGS", "-D warnings").output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The command that repairs it names the file in which the user wrote the model, and the place is the user's
/// own.
#[test]
fn an_inline_model_without_derivation_names_its_own_file() {
    let output = cargo(&["check", "-p", "robot", "--features", "absent"]);
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr).replace('\\', "/");
    assert!(said.contains("the model has no derivation `derived/arm.derivation`"), "{said}");
    assert!(said.contains("hodograph derive src/parts/arm.rs"), "{said}");
    assert!(said.contains("robot/src/parts/arm.rs:5:15"), "{said}");
    let errors = said.lines().filter(|line| line.starts_with("error")).count();
    assert_eq!(errors, 2, "one mistake, and that cargo stops:\n{said}");
}

#[test]
fn a_users_crate_needs_no_algebra_engine() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let tree = Command::new(cargo)
        .args(["tree", "-p", "downstream", "--offline", "--locked"])
        .current_dir(fixtures())
        .output()
        .unwrap();
    let tree = String::from_utf8_lossy(&tree.stdout).into_owned();
    assert!(tree.contains("hodograph-generator") && !tree.contains("symbolica"), "{tree}");
}

#[test]
fn a_generated_collision_needs_no_system_and_cannot_panic() {
    // As the profile `freestanding` says, in the folder of the optimised builds, where the generator has been built for others.
    let profile = ["--config", "profile.release.panic='abort'", "--config", "profile.release.lto='fat'"];
    succeeds(&[&["build", "-p", "freestanding", "--release"][..], &profile].concat());
}

/// The inner builds are offline: what they need must be what the workspace needs.
#[test]
fn locked_versions_are_those_of_the_workspace() {
    let versions = |path: &Path| -> BTreeSet<(String, String)> {
        let text = std::fs::read_to_string(path).unwrap();
        let value = |line: &str, key: &str| Some(line.strip_prefix(key)?.trim_matches('"').to_string());
        let lines: Vec<&str> = text.lines().collect();
        let pairs = lines.windows(3).filter_map(|window| {
            let registry = window[2].starts_with("source = ");
            Some((value(window[0], "name = ")?, value(window[1], "version = ")?)).filter(|_| registry)
        });
        pairs.collect()
    };
    let workspace = versions(&fixtures().join("../../Cargo.lock"));
    let fixtures = versions(&fixtures().join("Cargo.lock"));
    let missing: Vec<_> = fixtures.difference(&workspace).collect();
    assert!(
        missing.is_empty(),
        "tests/fixtures/Cargo.lock: {missing:?}; copy the workspace's Cargo.lock there and build once"
    );
}
