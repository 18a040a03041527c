//! Packages outside of the workspace, built by a child cargo as a user would: features are not unified with the workspace's.
//!
//! * `downstream`: a crate with its own models, `no_std`, the dependency renamed, every warning an error, without the algebra engine;
//! * `freestanding`: a program without operating system, libc and allocator. It links only if nothing in a generated collision
//!   can panic.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn package(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn cargo(name: &str, arguments: &[&str]) -> Output {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let mut command = Command::new(cargo);
    command
        .args(arguments)
        .args(["--offline", "--locked", "--target-dir"])
        .arg(target)
        .current_dir(package(name));
    // What belongs to the outer build must not leak into the inner one.
    for (key, _) in std::env::vars_os() {
        let key = key.to_string_lossy().into_owned();
        if key.starts_with("CARGO_") && key != "CARGO_HOME" || key == "RUSTFLAGS" {
            command.env_remove(key);
        }
    }
    command.output().expect("cargo runs")
}

fn succeeds(name: &str, arguments: &[&str]) -> String {
    let output = cargo(name, arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {arguments:?} in tests/{name}:\n{errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_users_crate_builds_and_collides() {
    succeeds("downstream", &["test", "--lib"]);
    // Nothing is printed on stdout by the macro, so a build's messages stay JSON.
    let messages = succeeds("downstream", &["check", "--message-format=json"]);
    for line in messages.lines() {
        assert!(serde_json::from_str::<serde_json::Value>(line).is_ok(), "not JSON: {line}");
    }
}

#[test]
fn a_users_crate_needs_no_algebra_engine() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let tree = Command::new(cargo)
        .args(["tree", "--offline", "--locked"])
        .current_dir(package("downstream"))
        .output()
        .unwrap();
    let tree = String::from_utf8_lossy(&tree.stdout).into_owned();
    assert!(tree.contains("hodograph-generator") && !tree.contains("symbolica"), "{tree}");
}

#[test]
fn a_generated_collision_needs_no_system_and_cannot_panic() {
    succeeds("freestanding", &["build", "--release"]);
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
    let workspace = versions(&package("../Cargo.lock"));
    for name in ["downstream", "freestanding"] {
        let other = versions(&package(name).join("Cargo.lock"));
        let missing: Vec<_> = other.difference(&workspace).collect();
        assert!(
            missing.is_empty(),
            "tests/{name}/Cargo.lock: {missing:?}; copy the workspace's Cargo.lock there and build once"
        );
    }
}
