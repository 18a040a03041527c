//! Adverse conditions: full disks, closed pipes, signals, hostile names and files. The tool must not panic,
//! must return the right exit code, and must leave no files behind.
#![cfg(unix)]

use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{ALL_JOINTS, hodograph, model, tool};

fn silent() -> Command {
    let mut command = Command::new(tool());
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn full() -> File {
    File::options().write(true).open("/dev/full").unwrap()
}

/// A folder with a model that has a mistake, and a robot.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("broken.mech"), "mechanism Broken;\nparameters { m: kq = 1 }\n").unwrap();
    fs::write(folder.path().join("robot.urdf"), ALL_JOINTS).unwrap();
    fs::copy(model("two_sleds"), folder.path().join("two_sleds.mech")).unwrap();
    folder
}

const COLLISION: &str = r#"{"m":[0.25,-0.125,0,0.5,0,0.5],"v":[-1,0.5,0],"mu":0.5,"e":0.5,"law":"stronge"}"#;

/// Every command, how it ends when all is well.
fn commands(folder: &Path) -> Vec<(Vec<String>, i32)> {
    let path = |name: &str| folder.join(name).display().to_string();
    let sleds = model("two_sleds");
    let all: [(&[&str], i32); 16] = [
        (&["check", &path("broken.mech")], 1),
        (&["check", &sleds], 0),
        (&["check", "no/such.mech"], 2),
        (&["derive", "--check", &path("two_sleds.mech")], 1),
        (&["derive", "--check", &sleds], 0),
        (&["eval", &sleds], 0),
        (&["eval", &path("broken.mech")], 1),
        (&["collide", &sleds, "--mu", "-1", "--e", "0.8", "--law", "stronge"], 1),
        (&["collide", &sleds, "--mu", "0.6", "--e", "0.8", "--law", "stronge"], 0),
        (&["expand", &sleds], 0),
        (&["explain", &sleds], 0),
        (&["explain", "E062"], 0),
        (&["plot", &sleds, "--mu", "0.6", "--e", "0.8"], 0),
        (&["import", &path("robot.urdf")], 0),
        (&["--help"], 0),
        (&["no-such-command"], 2),
    ];
    all.into_iter().map(|(words, code)| (words.iter().map(|&word| word.to_owned()).collect(), code)).collect()
}

#[test]
fn standard_error_may_be_full() {
    let folder = folder();
    for (arguments, code) in commands(folder.path()) {
        let status = silent().args(&arguments).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn results_that_cannot_be_written_are_a_fault() {
    let folder = folder();
    for (arguments, code) in commands(folder.path()) {
        let output = silent().args(&arguments).stdout(full()).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!said.contains("panicked"), "{arguments:?}: {said}");
        // what says nothing on standard output is as always
        let silent =
            hodograph(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), "").stdout.is_empty();
        assert_eq!(output.status.code(), Some(if silent { code } else { 1 }), "{arguments:?}: {said}");
        assert!(silent || said.contains("cannot write to standard output"), "{arguments:?}: {said}");
    }
}

#[test]
fn a_reader_that_leaves_does_not_change_what_a_check_finds() {
    let folder = folder();
    for (arguments, code) in commands(folder.path()) {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = silent().args(&arguments).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!said.contains("panicked"), "{arguments:?}: {said}");
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    }
    // one wrong line before the reader leaves
    let script =
        "(echo nonsense; echo \"$CASE\"; echo \"$CASE\") | $TOOL solve | true; exit ${PIPESTATUS[1]}";
    let status =
        Command::new("bash").args(["-c", script]).env("TOOL", tool()).env("CASE", COLLISION).status();
    assert_eq!(status.unwrap().code(), Some(1));
}

#[test]
fn names_do_not_reach_the_terminal_as_they_are() {
    let folder = folder();
    let evil = folder.path().join("a\u{1b}[31mb\u{202e}\rc.mech");
    fs::write(&evil, "mechanism Broken; // \u{1b}[2J\nparameters { m: kq\u{1b}[1m = 1 }\n").unwrap();
    let unreadable = folder.path().join("gone\u{1b}[31m.mech");
    for words in
        [["check"].as_slice(), &["derive", "--check"], &["eval"], &["expand"], &["explain"], &["import"]]
    {
        for path in [&evil, &unreadable] {
            let output = silent()
                .args(words)
                .arg(path)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .output()
                .unwrap();
            assert!(matches!(output.status.code(), Some(1 | 2)), "{words:?}");
            for text in [output.stdout, output.stderr] {
                let text = String::from_utf8(text).unwrap();
                let bad = text.chars().find(|c| c.is_control() && !"\n\t".contains(*c) || *c == '\u{202e}');
                assert_eq!(bad, None, "{words:?}: {text:?}");
            }
        }
    }
}

#[test]
fn names_that_are_no_text_are_names() {
    let folder = folder();
    let name = std::ffi::OsStr::from_bytes(b"-\xff.mech");
    fs::copy(model("two_sleds"), folder.path().join(name)).unwrap();
    for words in
        [["check", "--"].as_slice(), &["derive", "--"], &["eval", "--"], &["derive", "--check", "--"]]
    {
        let output = silent()
            .args(words)
            .arg(name)
            .current_dir(folder.path())
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{words:?}: {said}");
    }
}

#[test]
fn what_is_no_file_is_refused_at_once() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let pipe = at("pipe.mech");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    fs::create_dir(at("folder.mech")).unwrap();
    std::os::unix::fs::symlink(at("loop.mech"), at("loop.mech")).unwrap();
    std::os::unix::fs::symlink(folder.path(), at("round")).unwrap();
    fs::write(at("huge.mech"), vec![b' '; 5 << 20]).unwrap();
    let start = Instant::now();
    for name in ["pipe.mech", "folder.mech", "loop.mech", "huge.mech"] {
        for command in ["check", "eval", "expand", "explain", "import", "derive"] {
            let status = silent().arg(command).arg(at(name)).status().unwrap();
            assert!(matches!(status.code(), Some(1 | 2)), "{command} {name}: {status}");
        }
    }
    // a folder that holds a link to itself, and a model
    fs::remove_file(at("broken.mech")).unwrap();
    for name in ["pipe.mech", "loop.mech", "huge.mech"] {
        fs::remove_file(at(name)).unwrap();
    }
    assert_eq!(silent().arg("check").arg(folder.path()).status().unwrap().code(), Some(0));
    assert!(start.elapsed() < Duration::from_secs(600), "{:?}", start.elapsed());
}

#[test]
#[cfg(feature = "derive")]
fn an_interrupted_derivation_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let [models, temporary] = ["models", "tmp"].map(|name| folder.path().join(name));
    [&models, &temporary].into_iter().for_each(|path| fs::create_dir(path).unwrap());
    fs::copy(model("arm_7dof"), models.join("arm_7dof.mech")).unwrap();
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let mut child = silent().arg("derive").arg(&models).env("TMPDIR", &temporary).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(700));
        let id = child.id().to_string();
        assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success());
        let status = child.wait().unwrap();
        assert_eq!(std::os::unix::process::ExitStatusExt::signal(&status), Some(number), "{status}");
        assert_eq!(fs::read_dir(&temporary).unwrap().count(), 0);
        assert_eq!(fs::read_dir(&models).unwrap().count(), 1);
    }
}

#[test]
#[cfg(feature = "derive")]
fn what_lies_in_the_way_is_not_written_through() {
    let folder = folder();
    let victim = folder.path().join("victim");
    fs::write(&victim, "mine").unwrap();
    // the names that a temporary file of the first processes would have had
    let child = std::process::id();
    for id in child..child + 200 {
        let name = format!(".two_sleds.derivation.{id}.tmp");
        std::os::unix::fs::symlink(&victim, folder.path().join(name)).unwrap();
    }
    let status = silent().arg("derive").arg(folder.path().join("two_sleds.mech")).status().unwrap();
    assert!(status.success());
    assert_eq!(fs::read_to_string(&victim).unwrap(), "mine");
    assert!(folder.path().join("two_sleds.derivation").is_file());
}

#[test]
fn very_many_attributes_and_elements_take_no_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("robot.urdf");
    let start = Instant::now();
    let attributes: String = (0..80_000).map(|i| format!(" a{i}=\"0\"")).collect();
    fs::write(&path, format!("<robot name=\"r\">\n<link name=\"l\"{attributes}/></robot>")).unwrap();
    let imported = hodograph(&["import", &path.display().to_string()], "");
    assert_eq!(imported.code, 1);
    assert!(
        imported.stderr.contains("robot.urdf:2:1: this element has more than 1000 attributes"),
        "{}",
        imported.stderr
    );
    // as many mistakes, each with its place
    let links: String = (0..40_000).map(|_| "<link/>\n").collect();
    fs::write(&path, format!("<robot name=\"r\">\n{links}</robot>")).unwrap();
    let imported = hodograph(&["import", &path.display().to_string()], "");
    assert_eq!(imported.code, 1);
    assert!(imported.stderr.contains("robot.urdf:40001:1:"), "no place of the last");
    assert!(start.elapsed() < Duration::from_secs(600), "{:?}", start.elapsed());
}

#[test]
fn equations_are_written_within_the_limit() {
    let start = Instant::now();
    let explained = hodograph(&["explain", "--time-limit", "0", &model("arm_7dof")], "");
    assert_eq!(explained.code, 1);
    assert!(
        explained.stderr.contains("took more than 0 seconds: give more with --time-limit"),
        "{}",
        explained.stderr
    );
    assert!(start.elapsed() < Duration::from_secs(600), "{:?}", start.elapsed());
}

#[test]
fn codes_have_pages() {
    let page = hodograph(&["explain", "e062"], "");
    assert_eq!(page.code, 0, "{}", page.stderr);
    for part in [
        "E062: an inertia that no body can have",
        "wrong:\n\n    ",
        "right:\n\n    ",
        "mechanism RodAndWall;",
    ] {
        assert!(page.stdout.contains(part), "{part}: {}", page.stdout);
    }
    let absent = hodograph(&["explain", "E999"], "");
    assert_eq!(absent.code, 2);
    assert!(absent.stderr.contains("there is no code E999"), "{}", absent.stderr);
}

/// A file whose folder is missing is refused by the folder's name.
#[test]
fn missing_folders_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("none").join("sleds.svg").display().to_string();
    let model = crate::common::model("two_sleds");
    let run = hodograph(&["plot", &model, "--mu", "0.6", "--e", "0.8", "--output", &place], "");
    assert!(run.code == 1 && run.stderr.contains("its folder"), "{}", run.stderr);
}
