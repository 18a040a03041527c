//! `simulate --mcap`: the recording is read back and held against the lines of the same run.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{Run, hodograph, number, root};
use serde_json::{Value, json};

/// A message: nanoseconds and content.
type Message = (u64, Value);

fn simulate(model: &str, arguments: &[&str], recording: &Path) -> Run {
    let model = root().join(model).display().to_string();
    let file = recording.display().to_string();
    hodograph(&[&["simulate", &model, "--mcap", &file], arguments].concat(), "")
}

/// The messages by topic; each has what the schema of its topic requires.
fn messages(path: &Path) -> BTreeMap<String, Vec<Message>> {
    let bytes = fs::read(path).unwrap();
    let mut topics: BTreeMap<String, Vec<Message>> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.clone().unwrap();
        assert_eq!(
            (message.channel.message_encoding.as_str(), schema.encoding.as_str()),
            ("json", "jsonschema")
        );
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        fits(&value, &serde_json::from_slice(&schema.data).unwrap(), &message.channel.topic);
        topics.entry(message.channel.topic.clone()).or_default().push((message.log_time, value));
    }
    topics
}

/// Holds a value against the parts of JSON schemas that are used.
fn fits(value: &Value, schema: &Value, place: &str) {
    match schema["type"].as_str().unwrap() {
        "object" => {
            let object = value.as_object().unwrap_or_else(|| panic!("{place}: {value}"));
            for name in schema["required"].as_array().unwrap() {
                assert!(object.contains_key(name.as_str().unwrap()), "{place} has no {name}");
            }
            for (name, part) in object {
                let of = schema["properties"]
                    .get(name)
                    .unwrap_or_else(|| panic!("{place}: {name} is not in the schema"));
                fits(part, of, &format!("{place}.{name}"));
            }
        }
        "array" => value.as_array().unwrap().iter().for_each(|item| fits(item, &schema["items"], place)),
        "number" => assert!(value.is_number(), "{place}: {value}"),
        "integer" => assert!(value.is_u64(), "{place}: {value}"),
        "string" => assert!(value.is_string(), "{place}: {value}"),
        "boolean" => assert!(value.is_boolean(), "{place}: {value}"),
        other => panic!("{place}: type {other}"),
    }
}

fn nanoseconds(line: &Value) -> u64 {
    (number(&line["t"]) * 1e9).round() as u64
}

fn xyz(value: &Value) -> [f64; 3] {
    ["x", "y", "z"].map(|name| number(&value[name]))
}

/// A vector turned by a quaternion, from its definition v + 2 a x (a x v + w v), a = (x, y, z).
fn turned(rotation: &Value, v: [f64; 3]) -> [f64; 3] {
    let (a, w) = (xyz(rotation), number(&rotation["w"]));
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let inner = cross(a, v);
    let outer = cross(a, [0, 1, 2].map(|i| inner[i] + w * v[i]));
    [0, 1, 2].map(|i| v[i] + 2.0 * outer[i])
}

fn near(a: [f64; 3], b: [f64; 3], error: f64) {
    assert!((0..3).all(|i| (a[i] - b[i]).abs() <= error), "{a:?} {b:?}");
}

/// A rod in a plane that falls on its end: times, coordinates, the place of its centre, its frame, and forces
/// are those of the lines.
#[test]
fn recordings_say_what_the_lines_say() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rod.mcap");
    let surface = ["--until", "0.6", "--step", "0.05", "--mu", "0.5", "--e", "0.3", "--law", "poisson"];
    let run = simulate("models/slender_rod_5dof.mech", &surface, &path);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (lines, topics) = (run.lines(), messages(&path));
    let expected: Vec<u64> = lines.iter().map(nanoseconds).collect();
    for topic in [
        "/tf",
        "/mechanism",
        "/names",
        "/coordinates",
        "/speeds",
        "/energy",
        "/contact_force",
        "/contact_force_arrows",
    ] {
        let times: Vec<u64> = topics[topic].iter().map(|message| message.0).collect();
        assert_eq!(times, expected, "{topic}");
    }
    for (index, line) in lines.iter().enumerate() {
        let at = |topic: &str| &topics[topic][index].1;
        assert_eq!(at("/coordinates"), &line["q"]);
        // The line of an impact has the speeds before it, the recording those after it.
        let speeds = if line["u_after"].is_null() { &line["u"] } else { &line["u_after"] };
        assert_eq!(at("/speeds"), speeds, "{line}");
        // A second road: what `eval` says of the same state.
        let state = json!({"q": line["q"], "u": speeds}).to_string();
        let here =
            hodograph(&["eval", &crate::common::model("slender_rod_5dof"), "--state", "-"], &state).line();
        let transforms = at("/tf")["transforms"].as_array().unwrap();
        assert_eq!(
            (&transforms[0]["parent_frame_id"], &transforms[0]["child_frame_id"]),
            (&json!("world"), &json!("N"))
        );
        assert_eq!(number(&transforms[0]["rotation"]["w"]), 1.0, "gravity is along -N.z");
        let frame = &transforms[1];
        assert_eq!(frame["parent_frame_id"], "N");
        let centre = xyz(&frame["translation"]);
        near(centre, ["x", "y", "z"].map(|name| number(&line["q"][name])), 1e-12);
        let kinetic = number(&at("/energy")["kinetic"]);
        assert!((kinetic - number(&here["kinetic_energy"])).abs() < 1e-9 * (1.0 + kinetic), "{here}");
        // The end that strikes stands at 0.5 m along the rod, in the frame as in the scene.
        let tip = topics["/mechanism"][index].1["entities"][0]["spheres"].as_array().unwrap().last().unwrap();
        let along = turned(&frame["rotation"], [0.5, 0.0, 0.0]);
        near(xyz(&tip["pose"]["position"]), [0, 1, 2].map(|i| centre[i] + along[i]), 1e-12);
    }
    let told: Vec<(u64, String)> = lines
        .iter()
        .filter(|line| !line["event"].is_null())
        .map(|line| (nanoseconds(line), line["event"].as_str().unwrap().replace('_', " ")))
        .collect();
    assert!(!told.is_empty());
    let logged: Vec<(u64, String)> = topics["/events"]
        .iter()
        .map(|(time, log)| {
            (*time, log["message"].as_str().unwrap().split([',', ':']).next().unwrap().to_owned())
        })
        .collect();
    assert_eq!(logged, told);
}

/// A ball that bounces and rests: its impulses and its weight are arrows upwards, in a world whose z is up.
#[test]
fn arrows_point_along_forces_and_impulses() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.mcap");
    let call = ["--until", "3", "--step", "0.5", "--mu", "0", "--e", "0.5", "--law", "newton"];
    let run = simulate("tests/data/motion/bouncing_ball.mech", &call, &path);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (lines, topics) = (run.lines(), messages(&path));
    let hits: Vec<&Value> = lines.iter().filter(|line| line["event"] == "collision").collect();
    let arrows = &topics["/impulse_arrows"];
    assert_eq!(arrows.len(), hits.len());
    let size = |arrow: &Value| number(&arrow["shaft_length"]) + number(&arrow["head_length"]);
    let arrow = |message: &Message| message.1["entities"][0]["arrows"][0].clone();
    for (message, hit) in arrows.iter().zip(&hits).take(5) {
        assert_eq!(message.0, nanoseconds(hit));
        let arrow = arrow(message);
        near(turned(&arrow["pose"]["orientation"], [1.0, 0.0, 0.0]), [0.0, 0.0, 1.0], 1e-15);
        let ratio = number(&hit["impulse"][0]) / number(&hits[0]["impulse"][0]);
        assert!((size(&arrow) / size(&self::arrow(&arrows[0])) - ratio).abs() < 1e-9, "{arrow} {ratio}");
    }
    // It falls 1 m: the longest arrow is a quarter of that.
    assert!((size(&arrow(&arrows[0])) - 0.25).abs() < 1e-9);
    let (first, last) =
        (&topics["/contact_force_arrows"][0], topics["/contact_force_arrows"].last().unwrap());
    assert_eq!(first.1["entities"][0]["arrows"], json!([]), "nothing presses in the air");
    near(turned(&arrow(last)["pose"]["orientation"], [1.0, 0.0, 0.0]), [0.0, 0.0, 1.0], 1e-15);
    let pressed = xyz(&topics["/contact_force"].last().unwrap().1["floor"]);
    assert!(pressed[2] > 1.0 && pressed[..2] == [0.0, 0.0], "{pressed:?}");
    assert_eq!(number(&topics["/normal_force"].last().unwrap().1["floor"]), pressed[2]);
}

fn arrow(message: &Message) -> Value {
    message.1["entities"][0]["arrows"][0].clone()
}

/// Where gravity is along -N.y, N is turned so that N.y points upwards in the world; two runs give the same
/// bytes.
#[test]
fn the_world_stands_upright_and_bytes_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["a.mcap", "b.mcap"].map(|name| folder.path().join(name));
    let call = ["--until", "0.1", "--step", "0.02", "--mu", "0", "--e", "1", "--law", "newton"];
    for path in &paths {
        let run = simulate("models/planar_double_pendulum.mech", &call, path);
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    assert_eq!(fs::read(&paths[0]).unwrap(), fs::read(&paths[1]).unwrap());
    let topics = messages(&paths[0]);
    let model = fs::read_to_string(crate::common::model("planar_double_pendulum")).unwrap();
    let up = if model.contains("-g*N.y") { [0.0, 1.0, 0.0] } else { [-1.0, 0.0, 0.0] };
    let rotation = &topics["/tf"][0].1["transforms"][0]["rotation"];
    near(turned(rotation, up), [0.0, 0.0, 1.0], 1e-15);
}

/// What cannot be written is refused before the simulation, and what stood there stays.
#[test]
fn what_cannot_be_written_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let ball = "tests/data/motion/bouncing_ball.mech";
    let call = ["--until", "1", "--step", "0.5", "--mu", "0", "--e", "0.5", "--law", "newton"];
    for (path, what) in [
        (folder.path().join("missing/ball.mcap"), "its folder"),
        (folder.path().to_path_buf(), "is a directory"),
        (root().join("Cargo.toml/ball.mcap"), "cannot write"),
    ] {
        let run = simulate(ball, &call, &path);
        assert_eq!((run.code, run.stdout.as_str()), (1, ""), "{}", run.stderr);
        assert!(run.stderr.contains("cannot write") && run.stderr.contains(what), "{}", run.stderr);
    }
    let path = folder.path().join("ball.mcap");
    let text = path.display().to_string();
    let twice = simulate(ball, &[&call[..], &["--html", &text]].concat(), &path);
    assert_eq!((twice.code, twice.stdout.as_str()), (2, ""));
    assert!(twice.stderr.contains("is given for two files"), "{}", twice.stderr);
    let early = simulate(ball, &[&call[..], &["--state", r#"{"t":-1}"#]].concat(), &path);
    assert_eq!(early.code, 2);
    assert!(early.stderr.contains("between 0 and 4294967295 s"), "{}", early.stderr);
    let figure = folder.path().join("ball.gif").display().to_string();
    let gif = simulate(ball, &[&call[..], &["--plot", &figure]].concat(), &path);
    assert_eq!((gif.code, gif.stdout.as_str()), (2, ""), "{}", gif.stderr);
    // A motion that never begins leaves the file of the one before.
    fs::write(&path, "before").unwrap();
    let inside = simulate(ball, &[&call[..], &["--state", r#"{"q":{"z":-0.1}}"#]].concat(), &path);
    assert_eq!(inside.code, 1);
    assert_eq!(fs::read(&path).unwrap(), b"before");
    // One that ends with an error is recorded up to it.
    let ended = simulate(
        "tests/data/motion/incline.mech",
        &[
            "--until",
            "1",
            "--step",
            "0.1",
            "--input",
            "F=sqrt(0.35-t)",
            "--mu",
            "0.5",
            "--e",
            "0",
            "--law",
            "poisson",
        ],
        &path,
    );
    assert_eq!(ended.code, 1);
    assert_eq!(messages(&path)["/tf"].last().unwrap().0, 300_000_000);
    let left: Vec<PathBuf> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(left, [path], "no temporary file is left");
}

/// Read by the reader of the format's own Python package: `HODOGRAPH_PYTHON` names a Python that has `mcap`.
const READER: &str = "
import json, sys
from mcap.reader import make_reader
with open(sys.argv[1], 'rb') as stream:
    reader = make_reader(stream, validate_crcs=True)
    summary = reader.get_summary()
    names = {channel.topic: summary.schemas[channel.schema_id].name for channel in summary.channels.values()}
    messages = [[channel.topic, message.log_time, json.loads(message.data)] for _, channel, message in reader.iter_messages()]
print(json.dumps([names, messages]))
";

#[test]
#[ignore = "needs Python with the package mcap"]
fn recordings_are_read_in_python() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.mcap");
    let call = ["--until", "1", "--step", "0.05", "--mu", "0.5", "--e", "0.3", "--law", "poisson"];
    let run = simulate("simulation/models/tumbling_box.mech", &call, &path);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let python = std::env::var("HODOGRAPH_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let read =
        std::process::Command::new(python).args(["-c", READER]).arg(&path).output().expect("no Python here");
    assert!(read.status.success(), "pip install mcap\n{}", String::from_utf8_lossy(&read.stderr));
    let read: Value = serde_json::from_slice(&read.stdout).unwrap();
    assert_eq!(read[0]["/tf"], "foxglove.FrameTransforms");
    assert_eq!(read[0]["/mechanism"], "foxglove.SceneUpdate");
    assert_eq!(read[0]["/events"], "foxglove.Log");
    let mut topics: BTreeMap<String, Vec<Message>> = BTreeMap::new();
    for message in read[1].as_array().unwrap() {
        let topic = topics.entry(message[0].as_str().unwrap().to_owned()).or_default();
        topic.push((message[1].as_u64().unwrap(), message[2].clone()));
    }
    assert_eq!(topics, messages(&path));
}

/// Shapes are in the scene: the ball goes with its centre, the bowl stays about O; the lines of the ball are great
/// circles about where it is.
#[test]
fn shapes_move_with_their_bodies() {
    let path = std::env::temp_dir().join(format!("hodograph-shapes-{}.mcap", std::process::id()));
    let run = simulate("models/shapes/ball_in_bowl.mech", &["--until", "0.3"], &path);
    let lines = run.lines();
    let topics = messages(&path);
    fs::remove_file(&path).unwrap();
    let scenes = &topics["/mechanism"];
    assert!(scenes.len() > 10);
    for (_, scene) in scenes {
        let shapes =
            scene["entities"].as_array().unwrap().iter().find(|entity| entity["id"] == "shapes").unwrap();
        let [ball, bowl] = &shapes["spheres"].as_array().unwrap()[..] else { panic!("{shapes}") };
        near(xyz(&bowl["pose"]["position"]), [0.0; 3], 1e-12);
        assert!(
            (number(&bowl["size"]["x"]) - 1.6).abs() < 1e-12
                && (number(&ball["size"]["x"]) - 0.2).abs() < 1e-12
        );
        let centre = xyz(&ball["pose"]["position"]);
        let seconds = number(&shapes["timestamp"]["sec"]) + 1e-9 * number(&shapes["timestamp"]["nsec"]);
        let close = |line: &&Value| (number(&line["t"]) - seconds).abs() < 1e-9;
        let line = lines.iter().find(close).unwrap_or_else(|| panic!("no line at {seconds}"));
        near(centre, ["x", "y", "z"].map(|name| number(&line["q"][name])), 1e-9);
        for line in shapes["lines"].as_array().unwrap().iter().take(2) {
            for point in line["points"].as_array().unwrap() {
                let p = xyz(point);
                let away = (0..3).map(|i| (p[i] - centre[i]).powi(2)).sum::<f64>().sqrt();
                assert!((away - 0.1).abs() < 1e-9, "{away}");
            }
        }
    }
}
