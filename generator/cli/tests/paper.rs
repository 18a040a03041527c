//! docs/paper.md: its commands run, its files, tests and programs exist, its figures are what its commands
//! draw; and what the tool shows of the paper agrees with the numbers that the paper prints.

use crate::common::{Run, hodograph, model, number, numbers, root};
use serde_json::{Value, json};

const NINE: &str = include_str!("../../../docs/paper/two_sleds.jsonl");

fn page() -> String {
    std::fs::read_to_string(root().join("docs/paper.md")).unwrap()
}

/// Runs a command of the page, which may read a file.
fn run(command: &str) -> Run {
    let (call, input) = match command.split_once(" < ") {
        Some((call, path)) => (call, std::fs::read_to_string(root().join(path)).expect(path)),
        None => (command, String::new()),
    };
    let words: Vec<String> = call
        .split_whitespace()
        .skip(1)
        .map(|word| match word.starts_with("models/") {
            true => root().join(word).to_str().unwrap().to_owned(),
            false => word.to_owned(),
        })
        .collect();
    hodograph(&words.iter().map(String::as_str).collect::<Vec<_>>(), &input)
}

/// The cells of every row of the page's tables of six columns.
fn rows(page: &str) -> Vec<[&str; 6]> {
    page.lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with("| ---") && !line.starts_with("| paper |"))
        .filter_map(|line| {
            let inner = line.strip_prefix('|')?.strip_suffix('|')?;
            let cells: Vec<&str> = inner.split('|').map(str::trim).collect();
            <[&str; 6]>::try_from(cells).ok()
        })
        .filter(|row| row[2].contains("]("))
        .collect()
}

/// Text and target of the links of a cell.
fn links(cell: &str) -> Vec<(String, String)> {
    cell.split('[')
        .skip(1)
        .filter_map(|part| {
            let (text, rest) = part.split_once("](")?;
            Some((text.trim_matches('`').to_owned(), rest.split_once(')')?.0.to_owned()))
        })
        .collect()
}

/// The anchor of a heading.
fn slug(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = text.chars().filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-');
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn commands(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// Names a program or a test that a command of cargo names and that is not there.
fn missing(command: &str) -> Option<String> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let after = |option: &str| words.iter().position(|word| *word == option).map(|place| words[place + 1]);
    let exists = |path: String| root().join(path).exists();
    match (words[1], after("--example"), after("--test")) {
        ("run", Some(name), _) => {
            let folder = if after("-p") == Some("hodograph") { "runtime" } else { "models" };
            let found = exists(format!("{folder}/examples/{name}.rs"))
                || exists(format!("{folder}/examples/{name}/main.rs"));
            (!found).then(|| name.to_owned())
        }
        ("test", _, Some("all")) => {
            let folder = if after("-p") == Some("hodograph") { "runtime/tests" } else { "tests/tests" };
            let Some((file, name)) = words[words.len() - 1].split_once("::") else {
                return Some(command.to_owned());
            };
            let text =
                std::fs::read_to_string(root().join(format!("{folder}/{file}.rs"))).unwrap_or_default();
            (!text.contains(&format!("fn {name}("))).then(|| name.to_owned())
        }
        _ => Some(command.to_owned()),
    }
}

#[test]
fn files_tests_and_commands_of_the_page_exist() {
    let page = page();
    let rows = rows(&page);
    assert!(rows.len() > 60, "{}", rows.len());
    let mut ran = std::collections::HashSet::new();
    for row in &rows {
        let [what, _, code, shown, held, misprint] = row;
        assert!(!links(code).is_empty() && !links(held).is_empty() && !commands(shown).is_empty(), "{row:?}");
        for (_, target) in links(code) {
            assert!(root().join("docs").join(&target).exists(), "{what}: {target}");
        }
        for (test, target) in links(held) {
            let name = test.rsplit("::").next().unwrap();
            let text = std::fs::read_to_string(root().join("docs").join(&target)).expect(&target);
            assert!(text.contains(&format!("fn {name}(")), "{what}: no test {name} in {target}");
        }
        assert!(misprint.is_empty() || misprint.contains("](assumptions.md#"), "{misprint}");
        for (_, target) in row.iter().flat_map(|cell| links(cell)) {
            if let Some((file, anchor)) = target.split_once('#') {
                let path = if file.is_empty() { "paper.md" } else { file };
                let text = std::fs::read_to_string(root().join("docs").join(path)).expect(path);
                let known = text.lines().any(|line| line.starts_with('#') && slug(line) == anchor);
                assert!(known, "{what}: no heading for {target}");
            }
        }
        for command in commands(shown) {
            if command.starts_with("cargo ") {
                assert_eq!(missing(command), None, "{command}");
                continue;
            }
            assert!(command.starts_with("hodograph "), "{command}");
            if ran.insert(command.to_owned()) {
                let found = run(command);
                assert_eq!(found.code, 0, "{command}\n{}{}", found.stdout, found.stderr);
                assert!(found.stdout.len() > 20 || command.contains(" check "), "{command}");
            }
        }
    }
    assert!(ran.len() > 15, "{ran:?}");
}

/// Every image of the page stands above a command that draws it. `HODOGRAPH_UPDATE=1` draws them anew.
#[test]
fn figures_are_fresh() {
    let page = page();
    let images: Vec<&str> = page
        .split("![")
        .skip(1)
        .map(|part| part.split_once("](").unwrap().1.split_once(')').unwrap().0)
        .collect();
    assert_eq!(images.len(), 3);
    for image in images {
        let command = page
            .split('`')
            .find(|part| {
                part.starts_with("hodograph plot") && part.ends_with(&format!("--output docs/{image}"))
            })
            .unwrap_or_else(|| panic!("no command draws {image}"));
        let (call, _) = command.split_once(" --output ").unwrap();
        let drawn = run(call);
        assert_eq!(drawn.code, 0, "{}", drawn.stderr);
        let path = root().join("docs").join(image);
        if crate::expectations::are_written_anew() {
            std::fs::write(&path, &drawn.stdout).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            kept == drawn.stdout,
            "{image}: run `HODOGRAPH_UPDATE=1 cargo test -p hodograph-cli --test all paper::`"
        );
    }
}

fn near(found: &Value, printed: f64, digits: i32) {
    let found = number(found);
    assert!((found - printed).abs() < 10f64.powi(-digits), "{found} {printed}");
}

/// `--characteristics` of `solve`, `collide` and `eval`, in JSON and as a table: the numbers of sections 5 and
/// 6.3.3.
#[test]
fn characteristics_are_shown() {
    let sleds = model("two_sleds");
    let call = ["collide", &sleds, "--mu", "1.1", "--e", "0.8", "--law", "newton"];
    let plain = hodograph(&call, "").line();
    let whole = hodograph(&[&call[..], &["--characteristics"]].concat(), "").line();
    let found = &whole["characteristics"];
    for (name, printed, digits) in [
        ("c_n", 42.59, 2),
        ("c_t", 37.3, 1),
        ("c_s", -35.8, 1),
        ("mu_c", 1.21, 2),
        ("phi_c", std::f64::consts::TAU - 3.906, 3),
        ("mu_s", 1.086, 3),
        ("phi_hat", std::f64::consts::TAU - 3.91, 2),
        ("f_hat", 0.0425, 4),
        ("phi_bar", -0.432, 3),
        ("E_nC", -1.295, 3),
        ("E_nS", -1.291, 3),
        ("v_nS", 0.0533, 4),
    ] {
        near(&found[name], printed, digits);
    }
    assert!(number(&found["dh_hat"]) < -number(&found["g_hat"]) && number(&found["g_hat"]) > 0.0);
    assert!(number(&found["I_nC"]) < number(&found["I_nS"]));
    // Nothing else changes.
    let mut rest = whole.clone();
    rest.as_object_mut().unwrap().remove("characteristics");
    assert_eq!(rest, plain);
    // `solve` and the paper's methods say the same.
    let lines =
        |arguments: &[&str]| hodograph(&[&["solve", "--characteristics"], arguments].concat(), NINE).lines();
    let (exact, integrated) = (lines(&[]), lines(&["--method", "integrate", "--tolerance", "1e-12"]));
    for (a, b) in exact.iter().zip(&integrated) {
        for (name, value) in a["characteristics"].as_object().unwrap() {
            match value.as_f64() {
                Some(value) => near(&b["characteristics"][name], value, 9),
                None => assert!(b["characteristics"][name].is_null(), "{name}"),
            }
        }
    }
    let of = |index: usize, name: &str| exact[index]["characteristics"][name].clone();
    assert!(of(0, "v_nS").is_null() && of(0, "phi_bar").is_null() && of(8, "phi_hat").is_null());
    // mu = 1.6: E_nC = -1.085, E_nS = -1.083, v_nS = 0.0402.
    near(&of(8, "E_nC"), -1.085, 3);
    near(&of(8, "E_nS"), -1.083, 3);
    near(&of(8, "v_nS"), 0.0402, 4);
    // `eval` without and with friction.
    let contact = |more: &[&str]| {
        hodograph(&[&["eval", &sleds, "--characteristics"], more].concat(), "").line()["contacts"]["BcAc"]
            ["characteristics"]
            .clone()
    };
    let (without, with) = (contact(&[]), contact(&["--mu", "1.1"]));
    assert_eq!((&without["mu_c"], without.get("phi_hat")), (&found["mu_c"], None));
    assert_eq!((&with["phi_hat"], &with["phi_bar"]), (&found["phi_hat"], &found["phi_bar"]));
    // Tables have the same numbers.
    let table = hodograph(&[&call[..], &["--characteristics=table"]].concat(), "").stdout;
    for (name, value) in found.as_object().unwrap() {
        let line = table.lines().find(|line| line.split_whitespace().next() == Some(name)).expect(name);
        assert_eq!(line.split_whitespace().nth(1).unwrap().parse::<f64>().ok(), value.as_f64());
    }
    let table = hodograph(&["eval", &sleds, "--characteristics=table"], "").stdout;
    assert!(table.starts_with("BcAc\n") && table.contains("(41a)"), "{table}");
    for wrong in [
        &["eval", &sleds, "--mu", "1"][..],
        &["eval", &sleds, "--characteristics", "--mu", "-1"],
        &["solve", "--characteristics=page"],
    ] {
        assert_eq!(hodograph(wrong, "").code, 2, "{wrong:?}");
    }
}

/// The paper's unit of impulse, its threshold and the number of its steps, and I_n2 that is known.
#[test]
fn methods_are_as_printed() {
    let steps = |more: &[&str]| -> Vec<u64> {
        let run = hodograph(&[&["solve", "--method", "sum", "--steps", "1"], more].concat(), NINE);
        run.lines().iter().map(|line| line["steps"].as_u64().unwrap()).collect()
    };
    // Newton's, Poisson's and Stronge's hypothesis for mu = 0.6, 1.1, 1.6.
    assert_eq!(steps(&["--unit", "1"]), [10, 7, 7, 20, 6, 7, 36, 5, 9]);
    assert_eq!(steps(&["--unit", "0.5"])[1], 2 * steps(&["--unit", "1"])[1] - 1);
    assert_ne!(steps(&[]), steps(&["--unit", "1"]));
    // The exact solver makes no steps of that kind.
    let exact = hodograph(&["solve"], NINE).lines();
    assert!(exact[0].get("steps").is_none());
    let threshold = |size: &str, method: &[&str]| {
        let call = [&["solve", "--threshold", size, "--method"], method].concat();
        hodograph(&call, NINE).lines()
    };
    let off = |found: &[Value], name: &str, index: usize| {
        let [a, b] = [found, &exact].map(|lines| number(&lines[index][name][0]));
        (a / b - 1.0).abs()
    };
    for method in [&["integrate"][..], &["irs", "--tolerance", "1e-10"]] {
        let (large, small) = (threshold("0.1", method), threshold("0.01", method));
        // Slip that is dropped at the threshold is missing in the outcome, unless slip never falls below it.
        assert!(off(&large, "impulse", 8) > 0.5 && off(&small, "impulse", 8) > 0.01);
        assert!(off(&small, "impulse", 2) < 1e-8);
        // More than all slip: it is dropped at the start.
        assert_eq!(threshold("9", method)[8]["path"], json!(["sliding", "sticking"]));
        // docs/paper.md: by up to so many percent.
        let most = |found: &[Value], name: &str| {
            let all = (0..9).map(|index| 100.0 * off(found, name, index));
            format!("{:.0} %", all.fold(0.0, f64::max))
        };
        let page = page();
        let section = page.split("## The threshold").nth(1).unwrap().split("\n## ").next().unwrap();
        for (found, name) in [(&large, "impulse"), (&small, "impulse"), (&large, "v"), (&small, "v")] {
            assert!(section.contains(&most(found, name)), "{}: {section}", most(found, name));
        }
    }
    let at = hodograph(&["solve", "--at", "0,2,40"], NINE).lines();
    for (line, exact) in at.iter().zip(&exact) {
        let states = line["at"].as_array().unwrap();
        assert_eq!(states.len(), 3);
        assert_eq!(numbers(&states[0]["v"]), [-0.946108022, 1.06306701, 0.0]);
        assert!(number(&states[2]["v"][0]) > number(&exact["v"][0]), "beyond the end");
        assert_eq!(states[1]["motion"], json!("sliding"));
        assert_eq!(line["impulse"], exact["impulse"]);
    }
    for wrong in [
        &["--unit", "1"][..],
        &["--method", "sum", "--unit", "0"],
        &["--method", "irs", "--tolerance", "1e-6", "--unit", "1"],
        &["--method", "sum", "--threshold", "0.1"],
        &["--method", "irs", "--threshold", "0.1"],
        &["--method", "integrate", "--threshold", "-1"],
        &["--method", "integrate", "--at", "1"],
        &["--at", "inf"],
        &["--at", "1,nan"],
    ] {
        let run = hodograph(&[&["solve"], wrong].concat(), "");
        assert!(run.code == 2 && run.stdout.is_empty(), "{wrong:?}");
    }
}

/// Appendix C: with eta = 0 the numbers of the contact are planar, and no collision takes a quadrature, although
/// the symbols do not show it.
#[test]
fn the_planar_sleds_take_the_closed_form() {
    let planar = model("two_sleds_planar");
    for mu in ["0.01", "0.1", "0.6", "1.6"] {
        for law in ["newton", "poisson", "stronge"] {
            for q3 in [0.1, 0.3, 0.785, 1.1] {
                let state = json!({"q": {"q3": q3}}).to_string();
                let call = ["collide", &planar, "--mu", mu, "--e", "0.8", "--law", law, "--state", &state];
                let answer = hodograph(&[&call[..], &["--budget", "0"]].concat(), "");
                assert_eq!(answer.code, 0, "{}", answer.stdout);
                let answer = answer.line();
                assert_eq!(number(&answer["impulse"][2]), 0.0);
                let flags = answer["sensitivity"].as_array().unwrap();
                assert!(!flags.contains(&json!("unstable_direction")), "{answer}");
            }
        }
    }
}

/// The figures are of any contact, and what they do not need is refused.
#[test]
fn conics_and_portraits_of_any_contact() {
    for contact in [
        json!({"m": [1, 0.3, 0, 2, 0, 0]}),
        json!({"m": [1, 0.3, 0.4, 2, 0, 2]}),
        json!({"m": [1, 0, 0, 2, 0.3, 1], "v": [-1, 0.2, 0.3]}),
    ] {
        let run = hodograph(&["plot", "--figure", "conics", "--mu", "0,0.2,3"], &contact.to_string());
        assert_eq!(run.code, 0, "{}", run.stderr);
        roxmltree::Document::parse(&run.stdout).expect("SVG is XML");
        assert!(!run.stdout.contains("NaN") && !run.stdout.contains("inf"));
    }
    let case = json!({"m": [1, 0.3, 0, 2, 0, 1], "v": [-1, 0, 0]}).to_string();
    let portrait = ["plot", "--figure", "portrait", "--mu", "0.5", "--e", "0.5", "--starts", "5"];
    let drawn = hodograph(&portrait, &case);
    assert_eq!(drawn.code, 0, "{}", drawn.stderr);
    assert!(!drawn.stdout.contains("NaN"));
    for wrong in [
        &["plot", "--figure", "conics", "--mu", "0.5", "--e", "0.5"][..],
        &["plot", "--figure", "portrait", "--mu", "0.5"],
        &["plot", "--mu", "0.5", "--e", "0.5", "--starts", "3"],
    ] {
        assert_eq!(hodograph(wrong, &case).code, 2, "{wrong:?}");
    }
    let impossible = json!({"m": [1, 2, 0, 1, 0, 1]}).to_string();
    let run = hodograph(&["plot", "--figure", "conics", "--mu", "0.5"], &impossible);
    assert_eq!((run.code, run.stdout.as_str()), (1, ""), "{}", run.stderr);
    assert!(run.stderr.contains("semidefinite"), "{}", run.stderr);
}
