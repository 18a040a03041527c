//! Files that are written whole or not at all, and never over what is read; energies that are not defined;
//! tolerances that no step can meet.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::{Run, hodograph, model, root, tool};

const BALL: [&str; 10] = ["--until", "2", "--step", "0.001", "--mu", "0", "--e", "0.5", "--law", "newton"];

fn ball(folder: &Path) -> String {
    let path = folder.join("ball.mech");
    fs::copy(root().join("tests/data/motion/bouncing_ball.mech"), &path).unwrap();
    // With its derivation: deriving is not what is tried here.
    let kept = root().join("tests/data/motion/bouncing_ball.derivation");
    if kept.exists() {
        fs::copy(kept, folder.join("ball.derivation")).unwrap();
    }
    path.display().to_string()
}

fn simulate(model: &str, more: &[&str]) -> Run {
    hodograph(&[&["simulate", model], &BALL[..], more].concat(), "")
}

/// Whoever reads three lines and leaves gets the whole recording, page and figure: the same as one who reads
/// all.
#[test]
fn a_reader_who_leaves_does_not_cut_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let model = ball(folder.path());
    let files = |name: &str| {
        ["mcap", "html", "svg"]
            .map(|ending| folder.path().join(format!("{name}.{ending}")).display().to_string())
    };
    let (all, cut) = (files("all"), files("cut"));
    let options = |[mcap, html, svg]: &[String; 3]| -> Vec<String> {
        ["--mcap", mcap, "--html", html, "--plot", svg].map(str::to_owned).to_vec()
    };
    let run = simulate(&model, &options(&all).iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let mut child = Command::new(tool())
        .args(["simulate", &model])
        .args(BALL)
        .args(options(&cut))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut begin = [0; 60];
    child.stdout.take().unwrap().read_exact(&mut begin).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for (all, cut) in all.iter().zip(&cut) {
        assert!(fs::read(all).unwrap() == fs::read(cut).unwrap(), "{cut}");
    }
}

/// A file that is read is not written, by whatever name.
#[test]
fn what_is_read_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let model = ball(folder.path());
    let text = fs::read(&model).unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    fs::write(place("table.svg"), "t,F\n0,1\n").unwrap();
    fs::write(place("state.json"), "{}").unwrap();
    fs::create_dir(place("sub")).unwrap();
    let around = place("sub/../ball.mech");
    let (table, state) = (place("table.svg"), place("state.json"));
    for more in [
        &["--html", model.as_str()][..],
        &["--mcap", &around][..],
        &["--html", &place("ball.derivation")][..],
        &["--inputs", &table, "--plot", &table][..],
        &["--state", &state, "--html", &state][..],
    ] {
        let run = simulate(&model, more);
        assert!(run.told().0 == 2 && run.stderr.contains("would overwrite"), "{more:?} {}", run.stderr);
    }
    let (page, again) = (place("new.html"), place("sub/../new.html"));
    let twice = simulate(&model, &["--html", &page, "--mcap", &again]);
    assert!(twice.told().0 == 2 && twice.stderr.contains("is given for two files"), "{}", twice.stderr);
    let drawn =
        hodograph(&["plot", &model, "--mu", "0.1", "--e", "0.5", "--format", "svg", "--output", &model], "");
    assert!(drawn.told().0 == 2 && drawn.stderr.contains("would overwrite"), "{}", drawn.stderr);
    assert_eq!(fs::read(&model).unwrap(), text);
    assert_eq!(fs::read(&table).unwrap(), b"t,F\n0,1\n");
    assert!(!Path::new(&page).exists());
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&model, place("link.html")).unwrap();
        let run = simulate(&model, &["--html", &place("link.html")]);
        assert!(run.told().0 == 2 && run.stderr.contains("would overwrite"), "{}", run.stderr);
    }
}

/// Neither is what a model imports, directly or through others, by any command that writes.
#[test]
fn what_a_model_imports_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let files = [
        (
            "rig.mech",
            "mechanism Rig;\nimport \"near.svg\";\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\n\
             points { P = O + q1*N.x; }\nparticles { A { point: P, mass: m } }\nuse Near as near(h: P);\n",
        ),
        ("near.svg", "import \"far.html\";\npart Near(h: point) { use Far as far(h: h); }\n"),
        ("far.html", "part Far(h: point) { points { T = h + 0; } }\n"),
    ];
    for (name, text) in files {
        fs::write(place(name), text).unwrap();
    }
    let (rig, near, far) = (place("rig.mech"), place("near.svg"), place("far.html"));
    let checked = hodograph(&["check", &rig], "");
    assert_eq!(checked.code, 0, "{}", checked.stderr);
    for call in [
        &["simulate", &rig, "--plot", &near][..],
        &["simulate", &rig, "--html", &far],
        &["plot", "--sketch", &rig, "-o", &near],
        &["export", "--fmu", &rig, "-o", &rig],
        &["export", "--fmu", &rig, "-o", &place("rig.derivation")],
        &["export", "--fmu", &rig, "-o", &far],
    ] {
        let run = hodograph(call, "");
        assert!(run.told().0 == 2 && run.stderr.contains("would overwrite"), "{call:?} {}", run.stderr);
    }
    for (name, text) in files {
        assert_eq!(fs::read_to_string(place(name)).unwrap(), text, "{name}");
    }
}

/// A quantity called as a column of the table would stand there twice.
#[test]
fn columns_of_a_table_have_different_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slow.mech");
    let text = "mechanism Slow;\nparameters { m: kg = 1 }\ncoordinates { t: m = 1 }\nspeeds { v: m/s = 1 }\n\
        points { P = O + t*N.x; }\nparticles { A { point: P, mass: m } }\nkinematics { d(t)/dt = v; }\n";
    fs::write(&path, text).unwrap();
    let path = path.display().to_string();
    let call = ["simulate", &path, "--until", "0.1", "--format"];
    let table = hodograph(&[&call[..], &["csv"]].concat(), "");
    assert!(
        table.told().0 == 2 && table.stderr.contains("the column `t` would stand there twice"),
        "{}",
        table.stderr
    );
    let lines = hodograph(&[&call[..], &["json", "--state", "t=3"]].concat(), "");
    assert_eq!(lines.code, 0, "{}", lines.stderr);
    assert!(lines.stderr.contains("sets the `t` of the model, not the time"), "{}", lines.stderr);
    assert_eq!((&lines.lines()[0]["t"], &lines.lines()[0]["q"]["t"]), (&0.0.into(), &3.0.into()));
    let data = folder.path().join("data.csv");
    fs::write(&data, "t,v\n0,1\n1,1\n").unwrap();
    let fit = hodograph(&["fit", data.to_str().unwrap(), &path, "--parameters", "m"], "");
    assert!(fit.told().0 == 2 && fit.stderr.contains("could be two things"), "{}", fit.stderr);
}

/// The potential energy of the bicycle is not a function of its coordinates: it is said, and neither it nor a
/// sum is drawn or recorded.
#[test]
fn energies_that_are_not_defined_are_not_shown() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let (mcap, html, svg) = (place("b.mcap"), place("b.html"), place("b.svg"));
    let call = ["simulate", &model("whipple_bicycle"), "--until", "0.1", "--step", "0.05"];
    let files = ["--mcap", &mcap, "--html", &html, "--plot", &svg];
    let run = hodograph(&[&call[..], &files].concat(), "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("the potential energy of WhippleBicycle is not defined"), "{}", run.stderr);
    let page = fs::read_to_string(&html).unwrap();
    let data = page.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let energies: Vec<&str> = data["series"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|series| series["panel"] == "energy")
        .map(|series| series["name"].as_str().unwrap())
        .collect();
    assert_eq!(energies, ["kinetic"]);
    assert!(data["notes"][0].as_str().unwrap().contains("not defined"), "{}", data["notes"]);
    // nor is a place that follows from velocities alone
    assert!(data["notes"][1].as_str().unwrap().contains("other points follows from"), "{}", data["notes"]);
    assert!(!fs::read_to_string(&svg).unwrap().contains(">potential<"));
    let bytes = fs::read(&mcap).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.topic == "/energy" {
            let numbers: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
            assert_eq!(numbers.as_object().unwrap().len(), 1, "{numbers}");
        }
    }
    let read = hodograph(&[&call[..], &["--format", "table"]].concat(), "");
    assert!(
        read.stdout.contains("is not defined") && !read.stdout.contains("potential  "),
        "{}",
        read.stdout
    );
}

/// A tolerance below the rounding of a step is refused at once, and is no hang.
#[test]
fn tolerances_that_no_step_meets_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let model = ball(folder.path());
    for tolerance in ["1e-22", "1e-30", "1e-17", "0", "-1", "NaN"] {
        let run = simulate(&model, &["--tolerance", tolerance]);
        assert!(run.told().0 == 2 && run.stderr.contains("--tolerance"), "{tolerance} {}", run.stderr);
    }
    let fine = simulate(&model, &["--tolerance", "1e-15"]);
    assert_eq!(fine.code, 0, "{}", fine.stderr);
}

/// Whatever is wrong with a motion is told in one way: a sentence on standard error, nothing on standard
/// output.
#[test]
fn errors_of_simulate_have_one_form() {
    let folder = tempfile::tempdir().unwrap();
    let model = ball(folder.path());
    for format in ["json", "csv", "table"] {
        for more in [
            &["--until", "1", "--mu", "0", "--e", "1.2", "--law", "newton"][..],
            &["--until", "1", "--mu", "-1", "--e", "1", "--law", "newton"],
            &["--until", "1", "--mu", "0", "--e", "1", "--law", "newtn"],
            &["--until", "-1", "--mu", "0", "--e", "1", "--law", "newton"],
            &["--until", "1", "--mu", "0", "--e", "1", "--law", "newton", "--state", "{"],
            &["--until", "1", "--mu", "0", "--e", "1", "--law", "newton", "--state", "y=1"],
            &["--until", "1", "--mu", "0", "--e", "1", "--law", "newton", "--parameter", "m=-1"],
            &["--until", "1", "--mu", "0", "--e", "1", "--law", "newton", "--input", "F=1"],
            &["--until", "1"],
        ] {
            let run = hodograph(&[&["simulate", &model, "--format", format], more].concat(), "");
            let (code, told) = run.told();
            let last = told.lines().last().unwrap_or_default();
            assert!(code > 0 && last.starts_with("error: ") && !last.contains('{'), "{more:?} {told}");
        }
    }
}

/// Steps so short that their pictures could not be opened are refused at once, with their size; lines may be
/// as many as someone reads.
#[test]
fn pictures_of_too_many_steps_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let model = ball(folder.path());
    let place = |name: &str| folder.path().join(name).display().to_string();
    let surface = ["--mu", "0", "--e", "0.5", "--law", "newton", "--step", "1e-9"];
    for file in [["--html", "b.html"], ["--mcap", "b.mcap"], ["--plot", "b.svg"], ["--format", "table"]] {
        let file = [file[0].to_owned(), if file[0] == "--format" { file[1].into() } else { place(file[1]) }];
        let run = hodograph(&[&["simulate", &model, &file[0], &file[1]], &surface[..]].concat(), "");
        let (code, told) = run.told();
        assert!(code == 2 && told.contains("1.0e10 steps of") && told.contains("give --step"), "{told}");
        // What it says is enough.
        let step = told.split("give --step ").nth(1).unwrap().split(' ').next().unwrap();
        let short: f64 = step.parse().unwrap();
        assert!((1e-6..1e-4).contains(&short), "{told}");
    }
    let endless = hodograph(
        &["simulate", &model, "--step", "1e-300", "--mu", "0", "--e", "0.5", "--law", "newton"],
        "",
    );
    assert!(endless.told().0 == 2 && endless.stderr.contains("too short"), "{}", endless.stderr);
    // Without a picture the lines go on until the reader leaves.
    let mut child = Command::new(tool())
        .args(["simulate", &model])
        .args(surface)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut begin = [0; 300];
    child.stdout.take().unwrap().read_exact(&mut begin).unwrap();
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !told.contains("panicked"), "{}: {told}", output.status);
}
