//! Unusual paths: for directories, devices, pipes, and missing or too large files a command ends soon and
//! says why.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::common::{Run, hodograph, model};

fn run(arguments: &[&str]) -> Run {
    let begun = Instant::now();
    let run = hodograph(arguments, "");
    assert!(begun.elapsed() < Duration::from_secs(600), "{arguments:?} took {:?}", begun.elapsed());
    run
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// What reads a model from a path, and what says so where it is no file.
const COMMANDS: [&[&str]; 6] =
    [&["check"], &["derive"], &["derive", "--check"], &["eval"], &["explain"], &["expand"]];

fn with<'a>(command: &[&'a str], path: &'a str) -> Vec<&'a str> {
    command.iter().copied().chain([path]).collect()
}

#[test]
#[cfg(unix)]
fn devices_are_no_models() {
    for command in COMMANDS {
        for device in ["/dev/zero", "/dev/null"] {
            let run = run(&with(command, device));
            assert_eq!(run.code, 1, "{command:?} {device}: {}{}", run.stdout, run.stderr);
            let said = format!("{}{}", run.stdout, run.stderr);
            assert!(said.contains("error[E001]") && said.contains("it is a pipe or a device"), "{said}");
        }
    }
    let two_sleds = model("two_sleds");
    let state = run(&["eval", &two_sleds, "--state", "/dev/zero"]);
    assert_eq!(state.code, 2);
    assert!(state.stderr.contains("the state from /dev/zero: it is a pipe or a device"), "{}", state.stderr);
    let (arm, pendulum) = (model("puma_560"), model("spherical_pendulum"));
    for command in [
        &["simulate", &arm, "--inputs", "/dev/zero", "--mu", "0", "--e", "0", "--law", "newton"][..],
        &["fit", "/dev/zero", &pendulum, "--parameters", "e", "--mu", "0", "--e", "0", "--law", "newton"],
        &["validate", "/dev/zero", "/dev/zero"],
    ] {
        let run = run(command);
        let said = "cannot read /dev/zero: it is a pipe or a device";
        assert!(run.code == 2 && run.stderr.contains(said), "{command:?}: {} {}", run.code, run.stderr);
    }
    let urdf = run(&["import", "/dev/zero"]);
    assert_eq!(urdf.code, 2);
    assert!(urdf.stderr.contains("cannot read /dev/zero: it is a pipe or a device"), "{}", urdf.stderr);
}

/// A pipe that nobody writes to: opening it would wait for ever.
#[test]
#[cfg(unix)]
fn pipes_do_not_block() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.mech");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.expect("mkfifo is there").success());
    let said = run(&["check", &text(&path)]);
    assert!(said.code == 1 && said.stdout.contains("it is a pipe or a device"), "{}", said.stdout);
    // and in a directory it is no model at all
    assert_eq!(run(&["check", &text(folder.path())]).code, 2);
}

#[test]
fn directories_and_absent_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let absent: PathBuf = folder.path().join("absent.mech");
    for command in COMMANDS {
        let said = run(&with(command, &text(&absent)));
        assert_eq!(said.code, 2, "{command:?}");
        assert!(said.stderr.contains(&text(&absent)), "{command:?}: {}", said.stderr);
    }
    let two_sleds = model("two_sleds");
    let said = run(&["eval", &two_sleds, "--state", &text(folder.path())]);
    assert!(said.code == 2 && said.stderr.contains("it is a directory"), "{}", said.stderr);
    let said = run(&["import", &text(folder.path())]);
    assert!(said.code == 2 && said.stderr.contains("it is a directory"), "{}", said.stderr);
    let said = run(&["eval", &text(folder.path())]);
    assert!(said.code == 1 && said.stderr.contains("it is a directory"), "{}", said.stderr);
}

/// Files that are mostly holes: large on paper, and quick to make.
#[test]
fn large_files_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    for (name, command) in [("a.mech", "check"), ("a.rs", "check"), ("a.urdf", "import")] {
        let path = folder.path().join(name);
        fs::File::create(&path).unwrap().set_len(80 << 20).unwrap();
        let said = run(&[command, &text(&path)]);
        assert_ne!(said.code, 0);
        let all = format!("{}{}", said.stdout, said.stderr);
        assert!(all.contains("larger than"), "{name}: {all}");
    }
    let state = folder.path().join("state.json");
    fs::File::create(&state).unwrap().set_len(80 << 20).unwrap();
    let said = run(&["eval", &model("two_sleds"), "--state", &text(&state)]);
    assert!(said.code == 2 && said.stderr.contains("larger than 16 MiB"), "{}", said.stderr);
    let endless = hodograph(&["eval", &model("two_sleds"), "--state", "-"], &" ".repeat(17 << 20));
    assert!(endless.code == 2 && endless.stderr.contains("larger than 16 MiB"), "{}", endless.stderr);
}
