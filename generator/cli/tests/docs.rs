//! Runs the examples of the documentation and compares their output with that in the pages.
#![cfg(unix)]

use std::process::Command;

use hodograph::Cause;

use crate::common::{hodograph, root, tool};

/// The commands of a page and the lines that it shows for each.
fn examples(page: &str) -> Vec<(String, Vec<String>)> {
    let text = std::fs::read_to_string(root().join(page)).unwrap();
    let mut examples: Vec<(String, Vec<String>)> = Vec::new();
    for block in text.split("```console\n").skip(1) {
        for line in block.split("```").next().unwrap().lines() {
            match line.strip_prefix("$ ") {
                Some(command) => examples.push((command.to_owned(), Vec::new())),
                None => examples.last_mut().unwrap().1.push(line.to_owned()),
            }
        }
    }
    examples
}

/// Text, and numbers to the digits that the page gives: the last ones depend on the machine.
fn pieces(text: &str) -> Vec<String> {
    let mut pieces: Vec<String> = vec![String::new()];
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-' | '+');
    let mut inside = false;
    for c in text.chars() {
        let starts = c.is_ascii_digit() || c == '-';
        if (inside && !is_number(c)) || (!inside && starts) {
            pieces.push(String::new());
            inside = !inside && starts;
        }
        pieces.last_mut().unwrap().push(c);
    }
    pieces
}

fn agree(found: &str, shown: &str) -> bool {
    let (found, shown) = (pieces(found), pieces(shown));
    found.len() == shown.len()
        && found.iter().zip(&shown).all(|(a, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * b.abs().max(1e-6),
            _ => a == b,
        })
}

/// Whether the output looks as shown. `..` ends a line early, or stands for any lines.
pub fn matches(output: &str, shown: &[String]) -> bool {
    let mut lines = output.lines();
    let mut skipping = false;
    for wanted in shown {
        if wanted == ".." {
            skipping = true;
            continue;
        }
        let fits = |line: &str| match wanted.strip_suffix("..") {
            Some(beginning) => {
                let same = pieces(beginning).len();
                let head: String = pieces(line).into_iter().take(same).collect();
                // A number or a word may be cut off at the end.
                agree(&head, beginning) || line.starts_with(beginning)
            }
            None => agree(line, wanted),
        };
        let found = if skipping { lines.any(fits) } else { lines.next().is_some_and(fits) };
        if !found {
            return false;
        }
        skipping = false;
    }
    skipping || lines.next().is_none() || shown.is_empty()
}

/// Whether the first lines begin, character for character, as shown. From a line `..` on nothing is compared.
fn begins(output: &str, shown: &[String]) -> bool {
    let exact = shown.iter().take_while(|line| *line != "..");
    output.lines().zip(exact).all(|(line, wanted)| match wanted.strip_suffix("..") {
        Some(beginning) => line.starts_with(beginning),
        None => line == wanted,
    })
}

/// Writes what a command answers in the place of what a page shows of it.
fn renew(page: &str, shown: &[String], output: &str) {
    let path = root().join(page);
    let mut text = std::fs::read_to_string(&path).unwrap();
    for (line, wanted) in output.lines().zip(shown.iter().take_while(|line| *line != "..")) {
        let new = match wanted.strip_suffix("..") {
            Some(beginning) => line.chars().take(beginning.chars().count()).collect::<String>() + "..",
            None => line.to_owned(),
        };
        text = text.replacen(wanted.as_str(), &new, 1);
    }
    std::fs::write(&path, text).unwrap();
}

/// The figure at the head of the README is what this command draws. `HODOGRAPH_UPDATE=1` writes it anew.
#[test]
fn the_figure_of_the_readme_is_fresh() {
    let path = root().join("docs/two_sleds_hodograph.svg");
    let model = crate::common::model("two_sleds");
    let drawn = hodograph(&["plot", &model, "--mu", "0.6,1.1,1.6", "--e", "0.8"], "").stdout;
    if crate::expectations::are_written_anew() {
        std::fs::write(&path, &drawn).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    assert_eq!(kept, drawn, "run `HODOGRAPH_UPDATE=1 cargo test -p hodograph-cli --test all docs::`");
}

#[test]
fn examples_run_as_shown() {
    let tool = tool();
    let folder = tool.parent().unwrap();
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap_or_default());
    std::fs::create_dir_all(root().join("target")).unwrap();
    for page in ["docs/json.md", "docs/cli.md"] {
        let examples = examples(page);
        assert!(!examples.is_empty());
        for (command, shown) in examples {
            let output = Command::new("sh")
                .args(["-c", &command])
                .env("PATH", &path)
                .current_dir(root())
                .output()
                .unwrap_or_else(|error| panic!("{command}: {error}"));
            let stdout = String::from_utf8(output.stdout).unwrap();
            let fails = shown.iter().any(|line| line.contains("\"error\""));
            assert_eq!(
                output.status.success(),
                !fails,
                "{command}\n{}",
                String::from_utf8_lossy(&output.stderr)
            );
            if crate::expectations::are_written_anew() {
                renew(page, &shown, &stdout);
                continue;
            }
            assert!(matches(&stdout, &shown), "{page}: {command}\n{stdout}\nshown:\n{}", shown.join("\n"));
            // On the machines that the project is tested on, the pages show the tool's digits to the last.
            let same = cfg!(all(target_arch = "x86_64", target_os = "linux"));
            assert!(
                !same || begins(&stdout, &shown),
                "{page} shows other digits than `{command}`: run `HODOGRAPH_UPDATE=1 cargo test -p hodograph-cli --test all docs::`\n{stdout}"
            );
        }
    }
}

#[test]
fn every_command_and_kind_is_documented() {
    let page = |name: &str| std::fs::read_to_string(root().join(name)).unwrap();
    let (cli, json) = (page("docs/cli.md"), page("docs/json.md"));
    let help = hodograph(&["--help"], "").stdout;
    let commands = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names: Vec<&str> = commands
        .lines()
        .filter_map(|line| line.strip_prefix("  ").filter(|line| !line.starts_with(' ')))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|&name| name != "help")
        .collect();
    assert!(names.len() >= 9, "{names:?}");
    for name in names {
        assert!(cli.contains(&format!("| `{name}` |")), "{name}");
    }
    // Those of parameters and slices are told in other words, those of lasting contact are events.
    let untold = [Cause::WrongLength, Cause::UnknownName, Cause::ImpactWithoutCollision, Cause::NoMode];
    let causes = Cause::ALL.iter().filter(|cause| !untold.contains(cause)).map(|cause| cause.name());
    let own = [
        "bad_json",
        "missing_field",
        "unknown_name",
        "unsolved",
        "unfinished",
        "failed_motion",
        "not_found",
        "inconsistent_state",
    ];
    for kind in own.into_iter().chain(causes) {
        assert!(json.contains(&format!("| `{kind}` |")), "{kind}");
    }
}
