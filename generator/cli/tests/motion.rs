//! `simulate`: times of events, contact that lasts, and what is refused.

use crate::common::{Run, hodograph, number, root};
use serde_json::Value;

fn model(name: &str) -> String {
    root().join(format!("tests/data/motion/{name}.mech")).display().to_string()
}

fn simulate(name: &str, arguments: &[&str]) -> Run {
    hodograph(&[&["simulate", &model(name)], arguments].concat(), "")
}

fn events<'a>(lines: &'a [Value], name: &str) -> Vec<&'a Value> {
    lines.iter().filter(|line| line["event"] == name).collect()
}

const BALL: [&str; 6] = ["--mu", "0", "--e", "0.5", "--law", "newton"];

/// The first hit of a ball that falls 1 m, whatever the step; the end of its bounces; rest.
#[test]
fn hits_do_not_depend_on_the_step() {
    let fall = (2.0_f64 / 9.81).sqrt();
    let mut all = Vec::new();
    for step in ["1", "0.013", "10"] {
        let run = simulate("bouncing_ball", &[&["--until", "10", "--step", step], &BALL[..]].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        let lines = run.lines();
        let times: Vec<f64> = events(&lines, "collision").iter().map(|line| number(&line["t"])).collect();
        assert!((times[0] - fall).abs() < 1e-11, "{}", times[0]);
        assert!((times[1] - 2.0 * fall).abs() < 1e-11, "{}", times[1]);
        let first = events(&lines, "collision")[0];
        assert!((number(&first["v"][0]) - 0.5 * 9.81 * fall).abs() < 1e-10, "{first}");
        let contact = events(&lines, "contact")[0];
        assert!((number(&contact["t"]) - 3.0 * fall).abs() < 1e-10, "{contact}");
        assert_eq!(events(&lines, "rest").len(), 1);
        let last = lines.last().unwrap();
        assert_eq!((number(&last["t"]), number(&last["u"]["v"])), (10.0, 0.0));
        all.push(times);
    }
    assert_eq!(all[0], all[1]);
    assert_eq!(all[0], all[2]);
}

/// A ball thrown up strikes the ceiling within the first step and comes back: nothing inside a step is
/// missed.
#[test]
fn hits_inside_a_step_are_found() {
    let run = simulate("ceiling", &[&["--until", "2", "--step", "1"], &BALL[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines = run.lines();
    let hit = (5.0 - (25.0_f64 - 2.0 * 9.81 * 1.2).sqrt()) / 9.81;
    let collisions = events(&lines, "collision");
    assert_eq!(collisions.len(), 1);
    assert!((number(&collisions[0]["t"]) - hit).abs() < 1e-11, "{}", collisions[0]);
}

/// A block on an incline does not creep; pulled by a force that grows it begins to slip when friction is used
/// up, and stops when it ends.
#[test]
fn a_block_sticks_and_slips() {
    let surface = ["--mu", "0.5", "--e", "0", "--law", "poisson"];
    let run = simulate("incline", &[&["--until", "100000", "--step", "25000"], &surface[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines = run.lines();
    assert_eq!(events(&lines, "rest").len(), 1);
    for line in &lines {
        assert_eq!([&line["q"]["x"], &line["q"]["y"]].map(number), [0.0, 0.0], "{line}");
    }
    // Downhill: F = -3 t adds to gravity.
    let pulled =
        simulate("incline", &[&["--until", "4", "--step", "1", "--input", "F=-3*t"], &surface[..]].concat());
    assert_eq!(pulled.code, 0, "{}", pulled.stderr);
    let lines = pulled.lines();
    let slip = events(&lines, "slip")[0];
    let expected = 2.0 * 9.81 * (0.5 * 0.3_f64.cos() - 0.3_f64.sin()) / 3.0;
    assert!((number(&slip["t"]) - expected).abs() < 1e-9, "{slip} {expected}");
    let t: f64 = 4.0 - expected;
    let moved = number(&lines.last().unwrap()["q"]["x"]);
    assert!((moved + t.powi(3) / 4.0).abs() < 1e-8, "{moved}");
}

#[test]
fn surfaces_are_asked_for_and_checked_before_the_start() {
    let none = simulate("bouncing_ball", &["--until", "1"]);
    assert_eq!(none.code, 2);
    assert!(none.stderr.contains("contact floor has no surface"), "{}", none.stderr);
    let own =
        simulate("bouncing_ball", &["--until", "0.1", "--step", "0.1", "--surface", "floor=0,0.5,newton"]);
    assert_eq!((own.code, own.lines().len()), (0, 2), "{}", own.stderr);
    let unknown = simulate("bouncing_ball", &["--until", "1", "--surface", "flor=0,0.5,newton"]);
    assert_eq!(unknown.told(), (1, "error: there is no contact `flor`: did you mean `floor`?"));
    let much = simulate("bouncing_ball", &["--until", "0.1", "--mu", "0", "--e", "2", "--law", "newton"]);
    assert_eq!(much.told(), (1, "error: the coefficient of restitution is 2: it must lie between 0 and 1"));
    let part = simulate("bouncing_ball", &["--until", "0.1", "--mu", "0", "--law", "newton"]);
    assert!(part.told().1.contains("contact floor has no surface: e is missing"), "{}", part.stderr);
    let back = simulate("bouncing_ball", &[&["--until", "-1"], &BALL[..]].concat());
    assert_eq!(back.code, 2);
    assert!(back.stderr.contains("before the start"), "{}", back.stderr);
    let free = hodograph(
        &[
            "simulate",
            &crate::common::model("shaken_pendulum_moving_plate"),
            "--until",
            "0.1",
            "--step",
            "0.1",
        ],
        "",
    );
    assert!(free.code == 0 || free.stderr.contains("has no surface"), "{}", free.stderr);
}

#[test]
fn rows_and_figures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let figure = folder.path().join("ball.svg").display().to_string();
    let call = [&["--until", "1", "--step", "0.1", "--format", "csv", "--plot", &figure], &BALL[..]].concat();
    let run = simulate("bouncing_ball", &call);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let mut rows = run.stdout.lines();
    assert_eq!(rows.next(), Some("t,event,contact,z,v"));
    assert!(rows.clone().all(|row| row.split(',').count() == 5));
    assert!(rows.any(|row| row.contains(",collision,floor,")));
    let drawn = std::fs::read_to_string(&figure).unwrap();
    assert!(drawn.starts_with("<svg") || drawn.contains("<svg"), "{drawn:.80}");
}

/// Where a motion cannot be followed, the lines before it are there, and the error says when, where and why.
#[test]
fn no_line_before_an_error_is_lost() {
    let surface = ["--mu", "0.5", "--e", "0", "--law", "poisson"];
    let times = |run: &Run| -> Vec<f64> {
        run.lines().iter().filter(|line| line["event"].is_null()).map(|line| number(&line["t"])).collect()
    };
    // An input that is NaN from some time on.
    let call = [&["--until", "1", "--step", "0.1", "--input", "F=sqrt(0.35-t)"], &surface[..]].concat();
    let run = simulate("incline", &call);
    assert_eq!(run.code, 1);
    assert_eq!(times(&run), [0.0, 0.1, 0.2, 0.1 * 3.0]);
    assert!(run.stderr.contains("at t = 0.3") && run.stderr.contains("the input F is NaN"), "{}", run.stderr);
    // From the start on.
    let run = simulate("incline", &[&["--until", "1", "--input", "F=log(t)"], &surface[..]].concat());
    assert_eq!((run.code, run.stdout.as_str()), (1, ""));
    assert!(run.stderr.contains("at t = 0: the input F is -inf"), "{}", run.stderr);
    // Several contacts struck together, where that is to be an error.
    let model = root().join("simulation/models/tumbling_box.mech").display().to_string();
    let flat = r#"{"q":{"e0":1,"e1":0,"e2":0,"e3":0},"u":{"u1":0,"u4":0,"u5":0,"u6":0}}"#;
    let call = ["simulate", &model, "--until", "1", "--step", "0.3", "--together", "stop", "--state", flat];
    let run = hodograph(&[&call[..], &surface[..]].concat(), "");
    assert_eq!(run.code, 1);
    assert_eq!(times(&run), [0.0, 0.3]);
    let fall = (2.0_f64 * 0.65 / 9.81).sqrt();
    assert!(run.stderr.contains(&format!("at t = {fall:.9}")), "{} {fall}", run.stderr);
    assert!(run.stderr.contains("c1, c2, c3, c4 are struck together"), "{}", run.stderr);
}

#[test]
fn starts_inside_a_wall_are_refused() {
    let call = [&["--until", "1", "--state", r#"{"q":{"z":-0.1}}"#], &BALL[..]].concat();
    let run = simulate("bouncing_ball", &call);
    assert_eq!((run.code, run.stdout.as_str()), (1, ""));
    assert!(run.stderr.contains("at t = 0, contact floor: the negative gap -0.1"), "{}", run.stderr);
}

/// A contact without gap is told, and needs no surface.
#[test]
fn missing_gaps_are_told() {
    let model = crate::common::model("rolling_disc");
    let run = hodograph(&["simulate", &model, "--until", "0.1", "--step", "0.1"], "");
    assert_eq!((run.code, run.lines().len()), (0, 2), "{}", run.stderr);
    assert!(run.stderr.contains("contact rim_wall has no gap in the model"), "{}", run.stderr);
}

/// The page holds the points where the lines say that they are, every event, and what acts; also where the
/// motion ends with an error.
#[test]
fn pages_show_the_motion() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("ball.html").display().to_string();
    let data = |page: &str| -> Value {
        let text = std::fs::read_to_string(page).unwrap();
        let data = text.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
        serde_json::from_str(data).unwrap()
    };
    let run =
        simulate("bouncing_ball", &[&["--until", "3", "--step", "0.1", "--html", &page], &BALL[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (lines, shown) = (run.lines(), data(&page));
    let times = shown["times"].as_array().unwrap();
    assert_eq!(shown["up"][2], 1.0);
    let ball = shown["points"].as_array().unwrap().iter().find(|point| point["name"] != "O").unwrap();
    let curve = |name: &str| {
        let series = shown["series"].as_array().unwrap();
        series.iter().find(|series| series["name"] == name).unwrap()["values"].as_array().unwrap().clone()
    };
    let (places, kinetic) = (ball["places"].as_array().unwrap(), curve("kinetic"));
    // A line of a state is one moment, that of an event two: before it, and after it.
    let mut moment = 0;
    for line in &lines {
        for _ in 0..if line["event"].is_null() { 1 } else { 2 } {
            assert_eq!(line["t"], times[moment]);
            assert!((number(&line["q"]["z"]) - number(&places[moment][2])).abs() < 1e-12, "{line}");
            moment += 1;
        }
        if line["event"] == "collision" {
            let (before, after) = (number(&kinetic[moment - 2]), number(&kinetic[moment - 1]));
            assert!((before - 0.5 * number(&line["u"]["v"]).powi(2)).abs() < 1e-9, "{line}");
            assert!((after - before - number(&line["kinetic_energy_change"])).abs() < 1e-9, "{line}");
        }
    }
    assert_eq!(moment, times.len());
    // The weight does not press before it does: no force at the moment before contact begins.
    let pressed = curve("floor");
    assert_eq!(pressed.len(), times.len());
    let told: Vec<String> =
        lines.iter().filter_map(|line| line["event"].as_str().map(|event| event.replace('_', " "))).collect();
    let marked: Vec<&str> =
        shown["events"].as_array().unwrap().iter().map(|event| event["label"].as_str().unwrap()).collect();
    assert_eq!(told, marked);
    let hit = lines.iter().find(|line| line["event"] == "collision").unwrap();
    assert!((number(&hit["impulse"][0]) - number(&shown["events"][0]["impulse"][2])).abs() < 1e-12);
    // At rest its weight presses on the floor, and the force is that of the model: m g.
    let force = shown["forces"][0]["force"].as_array().unwrap().last().unwrap();
    let weight = shown["series"].as_array().unwrap().iter().find(|series| series["panel"] == "normal force");
    let pressed = number(weight.unwrap()["values"].as_array().unwrap().last().unwrap());
    assert!((number(&force[2]) - pressed).abs() < 1e-9 && pressed > 1.0, "{force} {pressed}");
    let call = ["--until", "1", "--step", "0.1", "--input", "F=sqrt(0.35-t)", "--html", &page];
    let surface = ["--mu", "0.5", "--e", "0", "--law", "poisson"];
    assert_eq!(simulate("incline", &[&call[..], &surface[..]].concat()).code, 1);
    assert!(data(&page)["times"].as_array().unwrap().iter().any(|time| (number(time) - 0.3).abs() < 1e-9));
}

/// Contacts that are struck together answer by their stiffnesses, and what is refused there.
#[test]
fn balls_answer_by_their_stiffnesses() {
    let model = root().join("simulation/models/cradle.mech").display().to_string();
    let call = |more: &[&str]| {
        let call = [
            "simulate", &model, "--until", "0.2", "--step", "0.2", "--mu", "0", "--e", "1", "--law",
            "stronge",
        ];
        hodograph(&[&call[..], more].concat(), "")
    };
    let run = call(&["--together", "lzb", "--stiffness", "left=1e6", "--stiffness", "right=1"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines = run.lines();
    let impact = events(&lines, "struck_together")[0];
    assert!((number(&impact["u_after"]["u3"]) - 1.0).abs() < 5e-3, "{impact}");
    assert_eq!(number(&impact["u"]["u1"]), 1.0);
    assert_eq!(impact["shares"][1]["contact"], "right");
    assert!((number(&impact["shares"][0]["impulse"]) - 1.0).abs() < 5e-3, "{impact}");
    for (more, code, what) in [
        (&["--together", "lzb", "--stiffness", "left"][..], 2, "--stiffness left: give CONTACT=NUMBER"),
        (&["--together", "lzb", "--stiffness", "left=-1"][..], 2, "with a positive number"),
        (&["--together", "lzb", "--stiffness", "lift=1"][..], 1, "there is no contact `lift`"),
        (&["--stiffness", "left=1"][..], 2, "--together lzb alone"),
        (&["--together", "lzb", "--surface", "right=0.1,1,stronge"][..], 1, "without friction only"),
    ] {
        let run = call(more);
        assert_eq!(run.code, code, "{more:?} {}", run.stderr);
        let said = format!("{}{}", run.stderr, run.stdout);
        assert!(said.contains(what), "{more:?} {} {}", run.stderr, run.stdout);
    }
}

/// A commanded speed is that of its time: at a collision, in `u_after`, and in the energies at the end, which are those of
/// the last state that is told.
#[test]
fn driven_speeds_are_those_of_their_time() {
    let cart = root().join("simulation/tests/models/driven_cart.mech");
    let call = ["simulate", cart.to_str().unwrap(), "--until", "1", "--step", "1", "--input", "s=1+0.5*t"];
    let json = hodograph(&[&call[..], &["--format", "json"]].concat(), "");
    assert_eq!(json.code, 0, "{}", json.stderr);
    let lines = json.lines();
    let hit = lines.iter().find(|line| line["event"] == "collision").unwrap();
    let commanded = 2.0_f64.sqrt();
    let after = |name: &str| number(&hit["u_after"][name]);
    assert!((after("U") - commanded).abs() < 1e-11, "{hit}");
    assert!((after("u") - 1.5 * commanded).abs() < 1e-11 && after("W") == 0.0, "{hit}");
    let end = &lines.last().unwrap()["u"];
    let [u, w] = ["u", "w"].map(|name| number(&end[name]));
    let kinetic = 0.5 * (2.0 * u * u + 5.0 * 1.5 * 1.5 + 0.16 * w * w);
    let table = hodograph(&[&call[..], &["--format", "table"]].concat(), "");
    let row = table.stdout.lines().find(|line| line.contains("kinetic")).unwrap();
    let told: Vec<f64> = row.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(told.iter().any(|told| (told - kinetic).abs() < 1e-5 * kinetic), "{kinetic} {row}");
    let stuck = hodograph(&[&call[..6], &["--input", "s=1", "--input", "r=0.1*t"]].concat(), "");
    assert!(
        stuck.code == 1 && stuck.stderr.contains("the input r is part of the velocity"),
        "{}",
        stuck.stderr
    );
    let grips = hodograph(&[&call[..6], &["--mu", "1e155", "--e", "0", "--law", "newton"]].concat(), "");
    assert!(grips.code != 0 && grips.stderr.contains("at most 1e100"), "{}", grips.stderr);
}

/// A word that is not understood, or stands there twice, is refused with its place; what a table says is what
/// an expression says.
#[test]
fn inputs_and_surfaces_are_read_with_care() {
    let folder = tempfile::tempdir().unwrap();
    let table = |text: &str| {
        let path = folder.path().join("inputs.csv");
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let surface = ["--mu", "0.5", "--e", "0", "--law", "poisson"];
    let call = |more: &[&str]| {
        simulate("incline", &[&["--until", "0.5", "--step", "0.25"], &surface[..], more].concat())
    };
    for (more, what) in [
        (&["--input", "F=2*sin(t"][..], "`)` is missing"),
        (&["--input", "F=sin)t("][..], "`(` is missing"),
        (&["--input", "F=foo(t)"][..], "there is no function `foo`: there are sin cos"),
        (&["--input", "F=x"][..], "`x` is unknown"),
        (&["--input", "F=1", "--input", "F=2"][..], "F is given twice"),
        (&["--surface", "plane=1,0,newton", "--surface", "plane=0,0,newton"][..], "plane has two surfaces"),
    ] {
        let run = call(more);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{more:?} {}", run.stderr);
        assert!(run.stderr.contains(what), "{more:?} {}", run.stderr);
    }
    for (text, what) in [
        ("", ":1: the file is empty"),
        ("t;F\n0;1\n", ":1: the first line names the columns, separated by commas"),
        ("t,F\n", ":1: there is no row"),
        ("t,F,F\n0,1,2\n", ":1: the column `F` stands there twice"),
        ("t,F\n0,1\n1,2\n\n1,3\n", ":5: t = 1 after t = 1"),
        ("t,F\n0,1\n1\n", ":3: 1 values for 2 columns"),
        ("t,F\n0,nan\n", ":2: `nan` is not a finite number"),
    ] {
        let run = call(&["--inputs", &table(text)]);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{text} {}", run.stderr);
        assert!(run.stderr.contains(what), "{text} {}", run.stderr);
    }
    let unknown = call(&["--inputs", &table("t,G\n0,1\n")]);
    assert_eq!(unknown.told(), (1, "error: Incline has no input `G`: there are: F"));
    let both = call(&["--inputs", &table("t,F\n0,1\n"), "--input", "F=1"]);
    assert!(both.code == 2 && both.stderr.contains("F is given twice"), "{}", both.stderr);
    // The same force: as other programs write tables, as an expression of `t`, and of `time`, as models call
    // it.
    let rows = call(&["--inputs", &table("\u{feff}t, F\r\n0, 0\r\n10, -300\r\n")]);
    assert_eq!(rows.code, 0, "{}", rows.stderr);
    assert!(number(&rows.lines().last().unwrap()["q"]["x"]) < -0.1, "{}", rows.stdout);
    for expression in ["F=-30*t", "F=-30*time", "F=min(-30*t, pow(t, 2))*sign(t)"] {
        let run = call(&["--input", expression]);
        let [a, b] = [&rows, &run].map(|run| number(&run.lines().last().unwrap()["q"]["x"]));
        assert!((a - b).abs() < 1e-12, "{expression}: {a} {b}");
    }
    // min and max do not hide NaN.
    let hidden = call(&["--input", "F=max(0, sqrt(0.2-t))"]);
    assert!(hidden.code == 1 && hidden.stderr.contains("the input F is NaN"), "{}", hidden.stderr);
}

/// A push between steps that would be long gives its whole impulse, 2 N s on 2 kg: of a millisecond in
/// flight, and of 50 ms against friction that held the block before.
#[test]
fn short_pushes_of_a_table_are_not_stepped_over() {
    let folder = tempfile::tempdir().unwrap();
    let surface = ["--mu", "0.5", "--e", "0", "--law", "newton"];
    let end = |half: f64, state: &str, more: &[&str]| {
        let path = folder.path().join("push.csv").display().to_string();
        let (top, last, force) = (0.5 + half, 0.5 + 2.0 * half, 2.0 / half);
        std::fs::write(&path, format!("t,F\n0,0\n0.5,0\n{top},{force}\n{last},0\n2,0\n")).unwrap();
        let call = ["--until", "0.6", "--step", "0.6", "--inputs", &path, "--state", state];
        let run = simulate("incline", &[&call[..], &surface[..], more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        number(&run.lines().last().unwrap()["u"]["u"])
    };
    for more in [&[][..], &["--max-step", "1"][..]] {
        let flight = end(0.0005, r#"{"parameters":{"alpha":0},"q":{"z":10}}"#, more);
        assert!((flight - 1.0).abs() < 1e-10, "{flight}");
        // It slips from the time at which F = mu m g.
        let slid = end(0.025, r#"{"parameters":{"alpha":0}}"#, more);
        let (friction, rate): (f64, f64) = (0.5 * 2.0 * 9.81, 80.0 / 0.025);
        let wait = friction / rate;
        let expected = (2.0 - 0.5 * friction * wait - friction * (0.1 - wait)) / 2.0;
        assert!((slid - expected).abs() < 1e-9, "{slid} {expected}");
    }
    let bad = simulate("incline", &[&["--until", "1", "--max-step", "0"], &surface[..]].concat());
    assert!(bad.code == 2 && bad.stderr.contains("--max-step"), "{}", bad.stderr);
}

/// The set of outcomes of a ball that strikes both walls of a groove at once; a file of rows or a picture of it there is not.
#[test]
fn sets_of_outcomes_are_written() {
    let groove = root().join("tests/data/many_contacts/groove_drop.mech").display().to_string();
    let surface = ["--mu", "0", "--e", "0.5", "--law", "newton"];
    let asked = ["--state", "y=0", "--until", "0.22", "--outcomes", "40", "--seed", "5"];
    let simulate =
        |more: &[&str]| hodograph(&[&["simulate", &groove], &surface[..], &asked, more].concat(), "");
    let run = simulate(&[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let set = &run.lines()[0];
    assert_eq!(set["outcomes"], 40);
    assert_eq!((&set["failed"], &set["seed"], &set["different"]), (&0.into(), &5.into(), &3.into()), "{set}");
    let ends = set["ends"].as_array().unwrap();
    assert_eq!(ends.iter().map(|end| end["count"].as_u64().unwrap()).sum::<u64>(), 40);
    let sideways = &set["u"]["uy"];
    assert!((number(&sideways["least"]) + number(&sideways["greatest"])).abs() < 1e-12, "{sideways}");
    assert_eq!(simulate(&[]).stdout, run.stdout);
    let table = simulate(&["--format", "table"]).stdout;
    assert!(table.contains("40 motions, 3 different ends"), "{table}");
    for (more, told) in [
        (&["--format", "csv"][..], "--outcomes has no rows"),
        (&["--plot", "set.svg"], "--outcomes writes no pictures"),
        (&["--together", "sequential"], "cannot be used with"),
        (&["--outcomes", "0"], "--outcomes"),
    ] {
        let run = simulate(more);
        assert!(run.code == 2 && run.stderr.contains(told), "{more:?}: {}", run.stderr);
    }
    let lonely = hodograph(&[&["simulate", &groove, "--seed", "5"], &surface[..]].concat(), "");
    assert!(
        lonely.told().0 == 2 && lonely.stderr.contains("--seed is of --outcomes alone"),
        "{}",
        lonely.stderr
    );
}

/// The account of energy begins before the impacts at the start.
#[test]
fn impacts_at_the_start_stand_in_the_account_of_energy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.mech");
    let text = "mechanism Ball;
parameters { m: kg = 1, g: m/s^2 = 10 }
coordinates { x: m, y: m }
speeds { u: m/s, v: m/s }
points { P = O + x*N.x + y*N.y; }
particles { B { point: P, mass: m } }
loads { gravity: -g*N.y; }
kinematics { d(x)/dt = u; d(y)/dt = v; }
contacts { floor { point: P, normal: N.y, gap: y, surface: { mu: 0, e: 0.5, law: newton } } }
";
    std::fs::write(&path, text).unwrap();
    let call =
        ["simulate", path.to_str().unwrap(), "--until", "0.05", "--state", "v=-1,u=1", "--format", "table"];
    let table = hodograph(&call, "").stdout;
    let numbers = |name: &str| -> Vec<f64> {
        let row = table
            .lines()
            .find(|line| line.trim_start().starts_with(name))
            .unwrap_or_else(|| panic!("{table}"));
        row.split_whitespace().filter_map(|word| word.parse().ok()).collect()
    };
    // 1 J at first; the impact leaves half of the normal velocity, and gravity takes 10 m/s^2 of it for 0.05 s.
    assert_eq!(numbers("kinetic"), [1.0, 0.5, -0.5], "{table}");
    assert_eq!(numbers("impacts"), [-0.375], "{table}");
}
