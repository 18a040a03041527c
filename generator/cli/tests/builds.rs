//! The same model gives the same bytes: in any process, folder, order and locale, and with several
//! derivations at once.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Models that are quick to derive and between them use most of the language.
const MODELS: [&str; 5] =
    ["two_sleds", "rolling_disc", "shaken_pendulum_moving_plate", "slider_crank", "free_box_quaternion"];

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models")
}

/// A new folder with copies of the models, without derivations.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    for model in MODELS {
        let file = format!("{model}.mech");
        fs::copy(models().join(&file), folder.join(&file)).expect("a shipped model");
    }
    folder
}

fn tool() -> Command {
    let mut command = Command::new(crate::common::tool());
    command.stdin(Stdio::null());
    command
}

fn succeeded(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // The algebra engine's banner stays in the process that holds the engine.
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
}

fn derivation(folder: &Path, model: &str) -> String {
    fs::read_to_string(folder.join(format!("{model}.derivation"))).expect("a derivation")
}

#[test]
fn derivations_are_the_same_bytes_everywhere() {
    let (one, other) = (folder("same bytes"), folder("andere-ordnung"));
    succeeded(&tool().arg("derive").arg(&one).env("LC_ALL", "C").output().expect("the tool runs"));
    // one at a time, in the opposite order, from within the folder, in another locale and time zone
    for model in MODELS.iter().rev() {
        let output = tool()
            .args(["derive", &format!("{model}.mech")])
            .current_dir(&other)
            .env("LC_ALL", "tr_TR.UTF-8")
            .env("TZ", "Asia/Kathmandu")
            .output();
        succeeded(&output.expect("the tool runs"));
    }
    for model in MODELS {
        let (a, b) = (derivation(&one, model), derivation(&other, model));
        assert!(a == b, "{model}: two derivations differ");
        // and the same as the one that is checked in
        assert!(
            a == derivation(&models(), model),
            "{model}: derive it anew: `hodograph derive --force models`"
        );
    }
}

#[test]
fn code_is_the_same_bytes_every_time() {
    let expand = || {
        let output =
            tool().arg("expand").arg(models().join("rolling_disc.mech")).output().expect("the tool runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    assert!(expand() == expand());
}

#[test]
fn derivations_at_once_wait_for_each_other() {
    let folders: Vec<PathBuf> = (0..4).map(|i| folder(&format!("at once {i}"))).collect();
    let running: Vec<_> = folders
        .iter()
        .map(|folder| {
            let mut command = tool();
            command.arg("derive").arg(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
            command.spawn().expect("the tool starts")
        })
        .collect();
    for child in running {
        succeeded(&child.wait_with_output().expect("the tool ends"));
    }
    for folder in &folders[1..] {
        for model in MODELS {
            assert!(derivation(folder, model) == derivation(&folders[0], model), "{model}");
        }
    }
}

/// The lock belongs to the user, not to the environment: different homes and temporary directories are no way
/// around it.
#[test]
fn derivations_with_different_homes_wait_for_each_other() {
    let folders: Vec<PathBuf> = (0..4).map(|i| folder(&format!("home {i}"))).collect();
    let running: Vec<_> = folders
        .iter()
        .map(|folder| {
            let (home, temporary) = (folder.join("home"), folder.join("tmp"));
            fs::create_dir_all(&home)
                .and_then(|()| fs::create_dir_all(&temporary))
                .expect("folders for the test");
            let mut command = tool();
            command.arg("derive").args(MODELS.map(|model| folder.join(format!("{model}.mech"))));
            command.env("HOME", home).env("TMPDIR", temporary).env_remove("XDG_CACHE_HOME");
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the tool starts")
        })
        .collect();
    for child in running {
        succeeded(&child.wait_with_output().expect("the tool ends"));
    }
}

/// What the engine would end the process for is said before, with what to do about it.
#[test]
#[cfg(unix)]
fn a_home_that_cannot_be_written_is_named() {
    let folder = folder("no home");
    let (model, file) = (folder.join("two_sleds.mech"), folder.join("a file"));
    fs::write(&file, "").expect("a file");
    let with = |variable: &str| {
        let output = tool().arg("derive").arg(&model).env(variable, &file).output().expect("the tool runs");
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = with("HOME");
    assert!(said.contains("home directory") && said.contains("set HOME to one"), "{said}");
    assert!(!said.contains("SIGABRT") && !said.contains("report"), "{said}");
    // no temporary directory is needed
    succeeded(&tool().arg("derive").arg(&model).env("TMPDIR", &file).output().expect("the tool runs"));
}
