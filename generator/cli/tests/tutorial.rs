//! Follows the tutorial literally: its models, its commands with what they print, its crate and its program.
#![cfg(all(unix, feature = "derive"))]

use std::path::Path;
use std::process::Command;

use crate::common::{root, tool};
use crate::docs::matches;
use crate::own_crate::{commanded, succeeds};

/// One step of the page: a block with the language that its fence names.
struct Step {
    language: String,
    text: String,
}

fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut inside = false;
    for line in page.lines() {
        match line.strip_prefix("```") {
            Some("") => inside = false,
            Some(language) => {
                inside = true;
                steps.push(Step { language: language.to_owned(), text: String::new() });
            }
            None if inside => {
                let text = &mut steps.last_mut().unwrap().text;
                text.push_str(line);
                text.push('\n');
            }
            None => {}
        }
    }
    steps
}

fn write(folder: &Path, name: &str, text: &str) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

#[test]
fn the_tutorial_is_true() {
    let folder = tempfile::tempdir().unwrap();
    let (models, own) = (folder.path(), folder.path().join("balance"));
    let page = std::fs::read_to_string(root().join("docs/tutorial.md")).unwrap();
    let tool = tool();
    let tool = tool.parent().unwrap();
    let path = format!("{}:{}", tool.display(), std::env::var("PATH").unwrap_or_default());
    let clone = root().canonicalize().unwrap();
    let mut done = [0; 4];
    for step in steps(&page) {
        match step.language.as_str() {
            "text" => write(models, "cart.mech", &step.text),
            "toml" => {
                let manifest = step.text.replace("../hodograph", clone.to_str().unwrap()) + "\n[workspace]\n";
                write(&own, "Cargo.toml", &manifest);
                std::fs::copy(clone.join("Cargo.lock"), own.join("Cargo.lock")).unwrap();
                for file in ["cart.mech", "cart.derivation"] {
                    write(
                        &own,
                        &format!("models/{file}"),
                        &std::fs::read_to_string(models.join(file)).unwrap(),
                    );
                }
            }
            "rust" => write(&own, "src/main.rs", &step.text),
            "console" => {
                let mut commands: Vec<(&str, Vec<String>)> = Vec::new();
                for line in step.text.lines() {
                    match line.strip_prefix("$ ") {
                        Some(command) => commands.push((command, Vec::new())),
                        None => commands.last_mut().unwrap().1.push(line.to_owned()),
                    }
                }
                for (command, shown) in commands {
                    let printed = if command == "cargo run" {
                        succeeds(&mut commanded("run", &own), &own)
                    } else {
                        // the page shows what is said of files and mistakes, not the notes of a motion
                        let both = if command.contains("check") || command.contains("derive") {
                            " 2>&1"
                        } else {
                            ""
                        };
                        let mut shell = Command::new("sh");
                        shell.args(["-c", &format!("{command}{both}")]).env("PATH", &path);
                        let output = shell.current_dir(models).output().unwrap();
                        let fails = shown.iter().any(|line| line.starts_with("error"));
                        assert_eq!(output.status.success(), !fails, "{command}: {output:?}");
                        String::from_utf8(output.stdout).unwrap()
                    };
                    let silent = shown.is_empty() && !printed.is_empty();
                    assert!(
                        matches(&printed, &shown) && !silent,
                        "{command}\n{printed}\nshown:\n{}",
                        shown.join("\n")
                    );
                }
            }
            // how a reader of the repository makes the book is no step
            other => panic!("a block of the language `{other}`"),
        }
        let kind =
            ["text", "toml", "rust", "console"].iter().position(|kind| *kind == step.language).unwrap();
        done[kind] += 1;
    }
    assert_eq!(done, [3, 1, 1, 6], "models, manifests, programs, blocks of commands");
}
