//! Tests of `plot`, `explain` and the figures of `simulate`.

use crate::common::{hodograph, model, number};
use serde_json::{Value, json};

#[test]
fn plots_have_a_curve_and_marks_for_each_friction_and_say_what_they_are() {
    let call = ["plot", &model("two_sleds"), "--mu", "0.6,1.1,1.6", "--e", "0.8"];
    let run = hodograph(&call, "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let document = roxmltree::Document::parse(&run.stdout).expect("SVG is XML");
    let all = |name: &str| {
        document
            .descendants()
            .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", name)))
            .collect::<Vec<_>>()
    };
    let texts: Vec<String> = all("text")
        .iter()
        .map(|node| {
            node.descendants().filter_map(|part| part.is_text().then(|| part.text()).flatten()).collect()
        })
        .collect();
    for text in [
        "TwoSleds, BcAc, e = 0.8",
        "vt [m/s]",
        "vs [m/s]",
        "vn [m/s]",
        "In [N\u{b7}s]",
        "\u{3bc} = 0.6",
        "\u{3bc} = 1.6",
        "approach",
        "end by Newton's law",
        "end by Poisson's law",
        "end by Stronge's law",
    ] {
        assert!(texts.iter().any(|known| known == text), "{text} is not in {texts:?}");
    }
    // In three panels: three approaches and three ends by Newton's law. One of each stands in the legend.
    assert_eq!(all("circle").len(), 2 * 9 + 2);
    // Curves are not steps from pixel to pixel: the longest has corners between them.
    let longest =
        all("path").into_iter().filter_map(|node| node.attribute("d")).max_by_key(|path| path.len()).unwrap();
    let places: Vec<f64> = longest
        .split(['M', 'L', ' '])
        .filter(|number| !number.is_empty())
        .map(|number| number.parse().unwrap())
        .collect();
    assert!(
        places.len() > 200
            && places.iter().filter(|place| place.fract() != 0.0).count() > 9 * places.len() / 10,
        "{longest}"
    );
}

#[test]
fn the_name_or_the_option_decides_the_format_of_a_plot() {
    let folder = tempfile::tempdir().unwrap();
    let case = json!({"m": [0.25, -0.125, 0, 0.5, 0, 0.5], "v": [-1, 0.5, 0]}).to_string();
    let plot = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        let call = ["plot", "--mu", "0.5", "--e", "1", "--output", path.to_str().unwrap()];
        let run = hodograph(&[&call, more].concat(), &case);
        (run.code, run.stderr, std::fs::read(&path).unwrap_or_default())
    };
    let picture = plot("one.png", &[]);
    assert_eq!((picture.0, &picture.2[..8]), (0, &b"\x89PNG\r\n\x1a\n"[..]), "{}", picture.1);
    assert_eq!(plot("other.PNG", &[]).2, picture.2);
    assert_eq!(plot("one.svg", &["--format", "png"]).2, picture.2);
    assert!(plot("two.svg", &[]).2.starts_with(b"<svg"));
    assert!(plot("plain", &[]).2.starts_with(b"<svg"));
    let refused = plot("one.jpg", &[]);
    assert_eq!((refused.0, refused.2.len()), (2, 0));
    assert!(refused.1.contains("SVG or PNG, not as `jpg`"), "{}", refused.1);
    // Nothing is left beside what was written, and what stood there stays if nothing can be written.
    let mut names: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["one.png", "one.svg", "other.PNG", "plain", "two.svg"]);
    assert_eq!(plot("missing/one.svg", &[]).0, 1);
}

#[test]
fn plots_of_nothing_are_refused() {
    let broken = hodograph(&["plot", "--mu", "0.5", "--e", "1"], "{");
    assert_eq!((broken.code, broken.stdout.as_str()), (1, ""), "a picture is never an error in words");
    assert!(broken.stderr.contains("JSON"), "{}", broken.stderr);
    let parting = json!({"m": [1, 0, 0, 1, 0, 1], "v": [1, 0, 0]}).to_string();
    let run = hodograph(&["plot", "--mu", "0.5", "--e", "1"], &parting);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("nothing to draw"), "{}", run.stderr);
    assert_eq!(hodograph(&["plot", "--e", "1"], "").code, 2);
}

#[test]
fn equations_are_written_in_three_ways() {
    for (format, part) in [("text", "M[1,2] = "), ("latex", "\\begin{align*}"), ("html", "<math display")] {
        let run = hodograph(&["explain", &model("rolling_disc"), "--format", format], "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(run.stdout.contains(part), "{format}");
        assert!(!run.stdout.contains("NaN"));
    }
    let run = hodograph(&["explain", &model("rolling_disc"), "--quantity", "mass_matrx"], "");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("did you mean `mass_matrix`?"), "{}", run.stderr);
}

/// Kinetic and potential energy of the falling rod.
fn energy(q: &Value, u: &Value) -> f64 {
    let answer = hodograph(
        &["eval", &model("slender_rod_5dof"), "--state", "-"],
        &json!({"q": q, "u": u, "parameters": {"m": 2, "l": 0.5, "g": 10}}).to_string(),
    );
    number(&answer.line()["kinetic_energy"]) + 2.0 * 10.0 * number(&q["z"])
}

#[test]
fn a_rod_that_bounces_without_loss_keeps_its_energy() {
    let state = json!({"q": {"z": 1, "q4": 0.2, "q5": 0.4}, "u": {"u1": 0.3, "u2": 0, "u3": 0, "u4": 0.5, "u5": 0.7},
        "parameters": {"m": 2, "l": 0.5, "g": 10}});
    let call = [
        "simulate",
        &model("slender_rod_5dof"),
        "--until",
        "0.8",
        "--step",
        "0.2",
        "--mu",
        "0",
        "--e",
        "1",
        "--law",
        "newton",
    ];
    let run = hodograph(&[&call[..], &["--state", "-"]].concat(), &state.to_string());
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let lines = run.lines();
    let (hits, samples): (Vec<&Value>, Vec<&Value>) =
        lines.iter().partition(|line| line.get("contact").is_some());
    assert_eq!(samples.len(), 5);
    assert!(!hits.is_empty(), "{}", run.stdout);
    let first = energy(&samples[0]["q"], &samples[0]["u"]);
    for sample in &samples {
        assert!((energy(&sample["q"], &sample["u"]) - first).abs() < 1e-6 * first, "{sample}");
    }
    let times: Vec<f64> = lines.iter().map(|line| number(&line["t"])).collect();
    assert!(times.is_sorted());
}

#[test]
fn a_rod_that_does_not_bounce_stays_in_contact() {
    let call = [
        "simulate",
        &model("slender_rod_5dof"),
        "--until",
        "0.6",
        "--mu",
        "0.5",
        "--e",
        "0",
        "--law",
        "stronge",
    ];
    let run = hodograph(&[&call[..], &["--state", r#"{"q":{"z":1}}"#]].concat(), "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines = run.lines();
    let at = lines.iter().position(|line| line["event"] == "contact").expect("contact that lasts");
    assert_eq!(lines[at]["contact"], "end");
    // Until it lifts off, if it does, the end stays on the ground; it is never below.
    let off = lines[at..].iter().position(|line| line["event"] == "lift_off").map_or(lines.len(), |k| at + k);
    let gap = |line: &Value| number(&line["q"]["z"]) - 0.5 * number(&line["q"]["q5"]).sin();
    assert!(lines[at..off].len() > 2);
    // Within steps the state is that of the dense output.
    assert!(lines[at..off].iter().all(|line| gap(line).abs() < 1e-8));
    assert!(lines.iter().all(|line| gap(line) > -1e-8));
    let below = hodograph(&[&call[..], &["--state", r#"{"q":{"z":-1}}"#]].concat(), "");
    assert_eq!(below.code, 1);
    assert!(below.stderr.contains("negative gap"), "{}", below.stderr);
}

/// The head of a module and `explain --cost` count the same operations in the same way.
#[test]
fn the_head_of_a_module_counts_as_explain_does() {
    for name in ["rolling_disc", "planar_double_pendulum"] {
        let table = hodograph(&["explain", &model(name), "--cost"], "").stdout;
        let line = table.lines().find(|line| line.starts_with("all together")).expect("a row for all");
        let numbers: Vec<&str> = line.split_whitespace().skip(2).collect();
        let (once, each) = (numbers[0], numbers[8]);
        let module = hodograph(&["expand", &model(name)], "").stdout;
        let head = format!("take {once} operations at construction and {each} per evaluation");
        assert!(module.contains(&head), "{name}: {head}\n{}", &module[..600]);
    }
}

#[test]
fn costs_are_a_table() {
    let run = hodograph(&["explain", &model("rolling_disc"), "--cost"], "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let row = run.stdout.lines().find(|line| line.starts_with("mass_matrix")).unwrap();
    let numbers: Vec<usize> = row.split_whitespace().skip(1).map(|cell| cell.parse().unwrap()).collect();
    let [_, configuration, speeds, kinds @ .., total, _] = &numbers[..] else { panic!("{row}") };
    assert_eq!(configuration + speeds, *total);
    assert_eq!(kinds.iter().sum::<usize>(), *total);
    #[cfg(feature = "derive")]
    {
        let run = hodograph(&["explain", &model("rolling_disc"), "--cost", "--passes"], "");
        assert!(run.stdout.contains("all, after pass contract"), "{}{}", run.stdout, run.stderr);
    }
}

/// The box begins with its corner on the ground, to within rounding even below it, and falls: it strikes at
/// once.
#[test]
fn what_touches_at_the_start_strikes_at_once() {
    let gap = |state: &str| {
        let run = hodograph(&["eval", &model("free_box_corner"), "--state", state], "");
        number(&run.line()["contacts"]["corner"]["gap"])
    };
    assert!(gap("{}") <= 0.0, "the case is not tried");
    for step in ["0.01", "0.1"] {
        let call = [
            "simulate",
            &model("free_box_corner"),
            "--until",
            "0.1",
            "--step",
            step,
            "--mu",
            "0.3",
            "--e",
            "0.5",
            "--law",
            "stronge",
        ];
        let run = hodograph(&call, "");
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        let lines = run.lines();
        assert_eq!(
            (number(&lines[1]["t"]), lines[1]["contact"].as_str()),
            (0.0, Some("corner")),
            "{}",
            run.stdout
        );
        for sample in lines.iter().filter(|line| line.get("q").is_some()) {
            let state = json!({"q": sample["q"]});
            assert!(gap(&state.to_string()) > -1e-9, "{sample}");
        }
    }
}

/// Bounces far shorter than a step are not missed.
#[test]
fn short_bounces_are_followed() {
    let state = r#"{"q":{"z":0.3},"u":{"u1":0,"u2":0,"u3":0,"u4":0,"u5":0},"parameters":{"l":0.5}}"#;
    let call = [
        "simulate",
        &model("slender_rod_5dof"),
        "--until",
        "1.5",
        "--step",
        "0.5",
        "--mu",
        "0",
        "--e",
        "0.3",
        "--law",
        "newton",
        "--state",
        state,
    ];
    let run = hodograph(&call, "");
    let lines = run.lines();
    let hits: Vec<f64> =
        lines.iter().filter(|line| line.get("contact").is_some()).map(|line| number(&line["t"])).collect();
    assert!(hits.len() > 3, "{}{}", run.stdout, run.stderr);
    assert!(hits[..5].windows(2).all(|pair| pair[1] - pair[0] < 0.05), "{hits:?}");
    for line in lines.iter().filter(|line| line.get("contact").is_none()) {
        let (z, q5) = (number(&line["q"]["z"]), number(&line["q"]["q5"]));
        assert!(z - 0.5 * q5.sin() > -1e-9, "{line}");
    }
}
