//! Follows the README's instructions for a crate of one's own literally: its manifest, its source, the model
//! of CONTRIBUTING.md, and the command that derives it.

use std::path::Path;
use std::process::Command;

use crate::common::{root, tool};

/// The block of a page after `heading` that begins with this fence, and its text.
fn block(page: &str, heading: &str, fence: &str) -> String {
    let text = std::fs::read_to_string(root().join(page)).unwrap();
    let section = text.split_once(heading).unwrap_or_else(|| panic!("{page} has no {heading}")).1;
    let (_, block) = section.split_once(&format!("{fence}\n")).unwrap_or_else(|| panic!("{page}: {fence}"));
    let lines: Vec<&str> = block.lines().take_while(|line| line.trim() != "```").collect();
    let indent = lines[0].len() - lines[0].trim_start().len();
    lines.iter().map(|line| format!("{}\n", line.get(indent..).unwrap_or_default())).collect()
}

/// Runs a command in the crate, and answers what it prints.
pub fn succeeds(command: &mut Command, folder: &Path) -> String {
    for (key, _) in std::env::vars_os() {
        let key = key.to_string_lossy().into_owned();
        if key.starts_with("CARGO_") && key != "CARGO_HOME" || key == "RUSTFLAGS" {
            command.env_remove(key);
        }
    }
    let output = command.current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{command:?}\n{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Cargo's command `what` in a crate of one's own, with what is built for the other crates of tests.
pub fn commanded(what: &str, folder: &Path) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fixtures");
    cargo.args([what, "--offline", "--target-dir"]).arg(target).current_dir(folder);
    cargo
}

#[test]
fn the_readme_is_true() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let heading = "## In my crate";
    let runtime = root().join("runtime").canonicalize().unwrap();
    let dependencies = block("README.md", heading, "```toml");
    assert!(dependencies.contains("\"../hodograph/runtime\""), "{dependencies}");
    let dependencies = dependencies.replace("../hodograph/runtime", runtime.to_str().unwrap());
    let manifest = format!("[package]\nname = \"own\"\nedition = \"2024\"\n\n{dependencies}\n[workspace]\n");
    let tests = "
#[test]
fn half_of_it() {
    // The tip moves along the normal, so there is no friction: the law gives back e of the speed.
    let after = bounce(0.0, 2.0).unwrap();
    assert!((after + 1.0).abs() < 1e-12, \"{after}\");
}
";
    let source = block("README.md", heading, "```rust,ignore");
    for (name, text) in [
        ("Cargo.toml", manifest),
        ("models/pendulum.mech", block("CONTRIBUTING.md", "five steps", "```text")),
        ("src/lib.rs", source + tests),
    ] {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    // the versions that the workspace uses are there without a network
    std::fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    succeeds(Command::new(tool()).args(["derive", "models/"]), folder);
    assert!(folder.join("models/pendulum.derivation").is_file());
    succeeds(&mut commanded("test", folder), folder);
}
