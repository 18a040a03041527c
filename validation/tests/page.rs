//! The numbers of `docs/validation.md` are those of the results: computed here once more, from the error of every toss.

use std::collections::BTreeMap;
use std::path::PathBuf;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Errors by toss, and how many lie on the right face.
fn errors(set: &str, simulator: &str) -> Option<(BTreeMap<u32, f64>, usize)> {
    let text = std::fs::read_to_string(root().join(format!("results/{set}_{simulator}_errors.csv"))).ok()?;
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("toss,error,after_flight,other_step,right_face"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
    let right = rows.iter().filter(|row| row[4] == 1.0).count();
    Some((rows.iter().map(|row| (row[0] as u32, row[1])).collect(), right))
}

/// Mean, its standard error, median.
fn summary(values: &[f64]) -> (f64, f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    let median = if sorted.len() % 2 == 1 { sorted[half] } else { (sorted[half - 1] + sorted[half]) / 2.0 };
    (mean, (square / count).sqrt(), median)
}

#[test]
fn numbers_of_the_page_are_those_of_the_results() {
    let page = std::fs::read_to_string(root().join("../docs/validation.md")).expect("docs/validation.md");
    let mut found = 0;
    for (set, judged) in [("cube", 495), ("elbow", 324)] {
        let Some((_, rest)) = page.split_once(&format!("<!-- results of the {set} -->")) else { continue };
        let (part, _) =
            rest.split_once(&format!("<!-- end of the results of the {set} -->")).expect("an end");
        let (own, _) = errors(set, "hodograph").expect("results of Hodograph");
        for (simulator, title) in [("hodograph", "Hodograph"), ("mujoco", "MuJoCo"), ("drake", "Drake")] {
            let Some((tosses, right)) = errors(set, simulator) else { continue };
            assert_eq!(tosses.len(), judged, "{set} {simulator}");
            let values: Vec<f64> = tosses.values().copied().collect();
            let (mean, error, median) = summary(&values);
            let row = format!("| {title} | {mean:.3} ± {error:.3} | {median:.3} | ");
            let line = part.lines().find(|line| line.starts_with(&row));
            let line = line.unwrap_or_else(|| panic!("{set}: no line begins with {row}"));
            if set == "cube" {
                let share = format!("| {:.1} % |", 100.0 * right as f64 / judged as f64);
                assert!(line.contains(&share), "{set}: {line} lacks {share}");
            }
            found += 1;
            if simulator == "hodograph" {
                continue;
            }
            assert!(own.keys().eq(tosses.keys()), "{set} {simulator}: other tosses");
            let differences: Vec<f64> = own.iter().map(|(toss, error)| error - tosses[toss]).collect();
            let (mean, error, median) = summary(&differences);
            let row = format!("| {title} | {mean:.3} ± {error:.3} | {:.1} | {median:.4} | ", mean / error);
            assert!(part.lines().any(|line| line.starts_with(&row)), "{set}: no line begins with {row}");
        }
    }
    assert!(found >= 2, "{found} simulators on the page");
}

/// What the set of outcomes holds of the measured ends of the cube.
#[test]
fn outcomes_of_the_page_are_those_of_the_results() {
    let page = std::fs::read_to_string(root().join("../docs/validation.md")).expect("docs/validation.md");
    let text = std::fs::read_to_string(root().join("results/cube_outcomes.csv")).expect("results");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("names").split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
    assert_eq!(rows.len(), 495);
    let place = |name: &str| names.iter().position(|other| *other == name).expect("a column");
    let share = |name: &str, holds: &dyn Fn(f64) -> bool| {
        100.0 * rows.iter().filter(|row| holds(row[place(name)])).count() as f64 / rows.len() as f64
    };
    for (what, value) in [
        ("the measured face is that of the single prediction", share("face_single", &|is| is == 1.0)),
        ("the measured face is among the drawn ones", share("face_drawn", &|is| is == 1.0)),
        (
            "the measured centre is within 1 mm of the range of the drawn ones",
            share("outside", &|m| m <= 1e-3),
        ),
    ] {
        let row = format!("| {what} | {value:.1} % |");
        assert!(page.contains(&row), "no line {row}");
    }
}

/// A toss is fitted if its rank is divisible by ten: what is judged is the rest.
#[test]
fn judged_tosses_are_those_of_the_plan() {
    let (tosses, _) = errors("cube", "hodograph").expect("results of the cube");
    assert_eq!(tosses.len(), 495);
    assert!(tosses.keys().all(|toss| *toss < 550 && toss % 10 != 0));
}

/// Every simulator had the same number of evaluations.
#[test]
fn effort_is_equal() {
    for set in ["cube", "elbow"] {
        for simulator in ["hodograph", "mujoco", "drake"] {
            let path = root().join(format!("results/{set}_{simulator}_search.csv"));
            let Ok(text) = std::fs::read_to_string(path) else { continue };
            assert_eq!(text.lines().count() - 1, 100, "{set} {simulator}");
        }
    }
}

/// What laws leave of the clean impacts of the second half.
#[test]
fn impacts_of_the_page_are_those_of_the_results() {
    let page = std::fs::read_to_string(root().join("../docs/validation.md")).expect("docs/validation.md");
    let text = std::fs::read_to_string(root().join("results/elbow_impacts.csv")).expect("results");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
    assert!(rows.len() > 80);
    for (name, title) in [
        ("coulomb", "Coulomb and Poisson, mu and e"),
        ("speed", "the same, e falls with the speed to the power 1/4"),
        ("springs", "springs in the contact, that e, ratio 0.8"),
        ("free springs", "the same, the ratio is a third constant"),
    ] {
        let column = names.iter().position(|other| *other == name).expect("a law");
        let judged: Vec<f64> = rows.iter().filter(|row| row[0] % 2.0 == 1.0).map(|row| row[column]).collect();
        let (mean, error, median) = summary(&judged);
        let expected = format!("| {:.1} ± {:.1} | {:.1} |", 100.0 * mean, 100.0 * error, 100.0 * median);
        let line = page.lines().find(|line| line.contains(title)).expect("a line for each law");
        assert!(line.ends_with(&expected), "{line} {expected}");
    }
}
