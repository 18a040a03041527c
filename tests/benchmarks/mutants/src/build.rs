//! Builds the copy with all mutants in it, without those that do not compile.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use serde_json::Value;

use crate::{
    Outcome, instrument,
    list::{self, Mutant},
};

/// What was built.
pub struct Built {
    /// The mutants that are in it, by their place in the list.
    pub ids: Vec<usize>,
    /// Name and file of each test program.
    pub tests: Vec<(String, PathBuf)>,
}

/// Instruments the copy, checks it, takes out what does not compile until all does, and builds the tests.
pub fn all_in_one(copy: &Path, package: &str, mutants: &[Mutant]) -> Outcome<Built> {
    let mut sources = HashMap::new();
    for mutant in mutants {
        if !sources.contains_key(&mutant.file) {
            sources.insert(mutant.file.clone(), fs::read_to_string(copy.join(&mutant.file))?);
        }
    }
    let library = copy.join(list::folder(package)).join("src/lib.rs");
    fs::write(&library, fs::read_to_string(&library)? + instrument::MODULE)?;
    let mut refused = BTreeSet::new();
    loop {
        let mut ids = Vec::new();
        let mut texts = BTreeMap::new();
        for (file, source) in &sources {
            let inside = |(id, mutant): &(usize, &Mutant)| mutant.file == *file && !refused.contains(id);
            let of_file: Vec<_> = mutants.iter().enumerate().filter(inside).collect();
            let (text, placed) = instrument::file(source, &of_file)?;
            fs::write(copy.join(file), &text)?;
            texts.insert(file.clone(), text);
            ids.extend(placed);
        }
        let checked = cargo(copy, &["check", "--lib", "-p", package])?;
        if checked.status.success() {
            ids.sort_unstable();
            let tests = tests(copy, package)?;
            return Ok(Built { ids, tests });
        }
        let before = refused.len();
        refused.extend(messages(&checked).iter().filter_map(|message| blamed(message, &texts)));
        eprintln!("{} mutants do not compile", refused.len());
        if refused.len() == before {
            return Err(rendered(&checked).into());
        }
    }
}

fn cargo(copy: &Path, arguments: &[&str]) -> Outcome<Output> {
    Ok(Command::new("cargo")
        .current_dir(copy)
        .args(arguments)
        .args(["--message-format", "json"])
        .env("CARGO_TARGET_DIR", copy.join("target"))
        .env("CARGO_INCREMENTAL", "0")
        .env("CARGO_PROFILE_DEV_OPT_LEVEL", "1")
        .env("CARGO_PROFILE_DEV_DEBUG", "false")
        .env("RUSTFLAGS", "-Awarnings")
        .output()?)
}

/// The mutant at fault: the last one that begins before the error; of a `match` that lacks patterns, the
/// first deleted arm after it.
fn blamed(message: &Value, texts: &BTreeMap<String, String>) -> Option<usize> {
    let message = &message["message"];
    if message["level"] != "error" {
        return None;
    }
    let span = message["spans"].as_array()?.iter().find(|span| span["is_primary"] == true)?;
    let text = texts.get(span["file_name"].as_str()?)?;
    let begin = span["byte_start"].as_u64()? as usize;
    let mark = if message["code"]["code"] == "E0004" {
        let deleted = format!("! {}", instrument::MARK);
        begin + text.get(begin..)?.find(&deleted)? + deleted.len()
    } else {
        let end = (begin + instrument::MARK.len()).min(text.len());
        text.get(..end)?.rfind(instrument::MARK)? + instrument::MARK.len()
    };
    let digits: String = text[mark..].chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

/// The compiler's errors, as it writes them.
fn rendered(output: &Output) -> String {
    let of = |message: &Value| message["message"]["rendered"].as_str().map(str::to_owned);
    messages(output).iter().filter_map(of).collect()
}

fn messages(output: &Output) -> Vec<Value> {
    String::from_utf8_lossy(&output.stdout)
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect()
}

fn tests(copy: &Path, package: &str) -> Outcome<Vec<(String, PathBuf)>> {
    let built = cargo(copy, &["test", "--no-run", "-p", package])?;
    if !built.status.success() {
        return Err(rendered(&built).into());
    }
    let program = |message: &Value| {
        let file = message["executable"].as_str().filter(|_| message["profile"]["test"] == true)?;
        Some((message["target"]["name"].as_str()?.to_owned(), PathBuf::from(file)))
    };
    Ok(messages(&built).iter().filter_map(program).collect())
}
