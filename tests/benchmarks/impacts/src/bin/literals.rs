//! Examines every literal of the impact solver: `cargo run --release --bin literals [NAME or SECTION]
//! [COLLISIONS]`.
//!
//! Writes a copy of the runtime below `target/literals` in which a function stands in the place of each
//! literal of `literals/list.txt`, and runs a program with it that multiplies one literal after the other by
//! factors from 1/64 to 64. Shown are, over hard collisions of eighteen families, the errors above the bound
//! of the tests (with a floor of 2e-14 or, for some families, more), the worst of them, the geometric mean of
//! the errors and the work. docs/theory.md, section 18, says what was seen.

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Instructions of a stretch, a short step, a block of the series and the direct integration of work.
const WEIGHTS: &str = "[560.0, 220.0, 120.0, 250.0]";

fn main() -> Result<(), Box<dyn Error>> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let runtime = here.join("../../../runtime");
    let copy = here.join("../target/literals");
    let mut sources = Vec::new();
    read(&runtime.join("src"), &runtime.join("src"), &mut sources)?;
    let mut names = String::new();
    let mut number = 0;
    let mut missing = Vec::new();
    for line in
        fs::read_to_string(here.join("literals/list.txt"))?.lines().filter(|line| !line.starts_with('#'))
    {
        let parts: Vec<&str> = line.splitn(3, " | ").collect();
        let &[section, name, text] = &parts[..] else { return Err(format!("no three parts: {line}").into()) };
        let (from, to) = match text.split_once(" => ") {
            Some((from, to)) => (
                from.replace("K256", &(number - 1).to_string()),
                to.replace("K256", &(number - 1).to_string()),
            ),
            None => (
                text.replace("@(", "").replace(")@", ""),
                text.replace("@(", "crate::probe::of(@, ").replace(")@", ")"),
            ),
        };
        let to = to.replace('@', &number.to_string());
        let mut found = false;
        for (_, source) in &mut sources {
            if source.contains(&from) {
                *source = source.replace(&from, &to);
                found = true;
            }
        }
        if !found {
            missing.push(line.to_owned());
        }
        if section != "-" {
            names.push_str(&format!("({section:?}, {name:?}), "));
            number += 1;
        }
    }
    if !missing.is_empty() {
        return Err(format!("not in the source any more:\n{}", missing.join("\n")).into());
    }
    let target = copy.join("runtime/src");
    if target.exists() {
        fs::remove_dir_all(&target)?;
    }
    for (path, source) in &sources {
        let source = if path == Path::new("lib.rs") { alone(source) } else { source.clone() };
        write(&target.join(path), &source)?;
    }
    write(&target.join("probe.rs"), &fs::read_to_string(here.join("literals/hook.rs"))?)?;
    let arithmetic = runtime.join("arithmetic").canonicalize()?;
    write(
        &copy.join("runtime/Cargo.toml"),
        &RUNTIME.replace("@ARITHMETIC@", &arithmetic.display().to_string()),
    )?;
    write(&copy.join("Cargo.toml"), PROBE)?;
    let common = runtime.join("tests/common").canonicalize()?;
    let probe = fs::read_to_string(here.join("literals/probe.rs"))?
        .replace("@COMMON@", &common.display().to_string())
        .replace("@WEIGHTS@", WEIGHTS)
        .replace("@NAMES@", &names);
    write(&copy.join("src/main.rs"), &probe)?;
    let status = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".into()))
        .args(["run", "--release", "--quiet", "--manifest-path"])
        .arg(copy.join("Cargo.toml"))
        .arg("--")
        .args(std::env::args().skip(1))
        .status()?;
    if status.success() { Ok(()) } else { Err("the examination failed".into()) }
}

const RUNTIME: &str = r#"[package]
name = "hodograph"
version = "0.0.0"
edition = "2024"

[features]
default = ["std"]
std = []
serde = []
defmt = []

[dependencies]
hodograph-arithmetic = { path = "@ARITHMETIC@" }
nalgebra = { version = "0.35", features = ["libm"] }
num-traits = { version = "0.2.19", default-features = false }
"#;

const PROBE: &str = r#"[workspace]

[package]
name = "literals-probe"
version = "0.0.0"
edition = "2024"

[dependencies]
hodograph = { path = "runtime" }
nalgebra = { version = "0.35", features = ["libm"] }
"#;

/// The head of the crate without the macro, which needs the generator, and with what stands for literals.
fn alone(source: &str) -> String {
    let end = source.find("#[doc(hidden)]\npub use hodograph_macros").unwrap_or(source.len());
    let mut head = source[..end].to_owned();
    head.push_str("\n#[doc(hidden)]\npub mod probe;\n");
    head
}

fn read(folder: &Path, root: &Path, sources: &mut Vec<(PathBuf, String)>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            read(&path, root, sources)?;
        } else {
            sources.push((path.strip_prefix(root)?.to_owned(), fs::read_to_string(&path)?));
        }
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(path.parent().ok_or("no folder")?)?;
    Ok(fs::write(path, text)?)
}
