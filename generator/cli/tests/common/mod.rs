//! Runs the tool in tests.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::Value;

/// What a run of the tool left.
pub struct Run {
    /// exit code
    pub code: i32,
    /// standard output
    pub stdout: String,
    /// standard error
    pub stderr: String,
}

impl Run {
    /// The lines of standard output as JSON.
    pub fn lines(&self) -> Vec<Value> {
        let parse = |line: &str| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        self.stdout.lines().map(parse).collect()
    }

    /// The only line of standard output as JSON.
    pub fn line(&self) -> Value {
        let mut lines = self.lines();
        assert_eq!(lines.len(), 1, "one line, not\n{}\n{}", self.stdout, self.stderr);
        lines.remove(0)
    }

    /// The exit code and what was told on standard error; nothing stands on standard output.
    pub fn told(&self) -> (i32, &str) {
        assert_eq!(self.stdout, "", "{}", self.stderr);
        (self.code, self.stderr.trim_end())
    }

    /// The kind of the error object that is all of standard output.
    pub fn error_kind(&self) -> String {
        assert_eq!(self.code, 1, "{}{}", self.stdout, self.stderr);
        kind(&self.line())
    }
}

/// The kind of an error object, which must have a message too.
pub fn kind(line: &Value) -> String {
    assert!(line["error"]["message"].as_str().is_some_and(|message| message.len() > 10), "{line}");
    line["error"]["kind"].as_str().unwrap().to_owned()
}

/// The tool that the tests run: the one that `HODOGRAPH_TOOL` names, else the one that cargo has built for them.
pub fn tool() -> PathBuf {
    std::env::var_os("HODOGRAPH_TOOL")
        .map_or_else(|| PathBuf::from(env!("CARGO_BIN_EXE_hodograph")), PathBuf::from)
}

/// Runs the tool.
pub fn hodograph(arguments: &[&str], stdin: &str) -> Run {
    let mut child = Command::new(tool())
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let text = stdin.to_owned();
    let writer = std::thread::spawn(move || {
        let _ = pipe.write_all(text.as_bytes());
    });
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    Run {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// The root of the repository.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file of `tests/data`.
pub fn data(name: &str) -> String {
    let path = root().join("tests/data").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A model file.
pub fn model(name: &str) -> String {
    root().join("models").join(format!("{name}.mech")).display().to_string()
}

/// A number, which may be written as a string of many digits.
pub fn number(value: &Value) -> f64 {
    match value {
        Value::String(text) => text.parse().unwrap(),
        _ => value.as_f64().unwrap_or_else(|| panic!("no number: {value}")),
    }
}

/// All numbers of nested arrays.
pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        _ => vec![number(value)],
    }
}

/// The largest difference over the largest entry of `expected` (at least `floor`).
pub fn difference(found: &[f64], expected: &[f64], floor: f64) -> f64 {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    let largest = expected.iter().fold(floor, |largest, number| largest.max(number.abs()));
    let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if worst == 0.0 { 0.0 } else { worst / largest }
}

/// Every kind of joint, on parents that move and are turned.
pub const ALL_JOINTS: &str = r#"<robot name="all joints">
<link name="world"/>
<link name="trunk"><inertial><origin xyz="0.1 -0.2 0.3" rpy="0.3 0.2 -0.4"/><mass value="3"/>
 <inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0.02" iyz="-0.03" ixz="0.04"/></inertial></link>
<link name="arm"><inertial><origin xyz="0.2 0.1 0"/><mass value="1"/><inertia ixx="0.2" iyy="0.2" izz="0.3" ixy="0" iyz="0" ixz="0"/></inertial></link>
<link name="tray"><inertial><origin xyz="0 0.05 0.1"/><mass value="0.5"/><inertia ixx="0.1" iyy="0.2" izz="0.15" ixy="0" iyz="0" ixz="0"/></inertial></link>
<link name="bird"><inertial><origin xyz="0.05 0 0.1"/><mass value="0.4"/><inertia ixx="0.1" iyy="0.12" izz="0.15" ixy="0.01" iyz="0" ixz="0"/></inertial></link>
<link name="hook"><inertial><origin xyz="0.1 0 0" rpy="1 0 0"/><mass value="0.2"/><inertia ixx="0.01" iyy="0.012" izz="0.015" ixy="0.001" iyz="0" ixz="0"/></inertial></link>
<link name="rod"><inertial><origin xyz="0 0 0.2"/><mass value="0.3"/><inertia ixx="0.01" iyy="0.01" izz="0.001" ixy="0" iyz="0" ixz="0"/></inertial></link>
<joint name="base" type="floating"><parent link="world"/><child link="trunk"/><origin xyz="1 0 0" rpy="0.1 0.2 0.3"/></joint>
<joint name="a" type="continuous"><parent link="trunk"/><child link="arm"/><origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/><axis xyz="0.6 0 -0.8"/></joint>
<joint name="p" type="planar"><parent link="arm"/><child link="tray"/><origin xyz="0.3 0 0" rpy="0 0.5 0"/><axis xyz="0.6 0.8 0"/></joint>
<joint name="f" type="floating"><parent link="tray"/><child link="bird"/><origin xyz="0 0 0.2" rpy="0 0 0.7"/></joint>
<joint name="w" type="fixed"><parent link="arm"/><child link="hook"/><origin xyz="0.1 0.2 0" rpy="0 1.5707963267948966 0.3"/></joint>
<joint name="s" type="prismatic"><parent link="hook"/><child link="rod"/><origin xyz="0 0.1 0" rpy="0 0 0.2"/><axis xyz="0 -1 0"/></joint>
</robot>"#;
