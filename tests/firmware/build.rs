//! The reference collisions and the states that `run worst` chose, as Rust, and the memory of the emulated
//! boards.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

fn main() {
    let out = env::var("OUT_DIR").expect("cargo sets it");
    let out = Path::new(&out);
    let data =
        Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../data/impact_cases.jsonl");
    println!("cargo::rerun-if-changed={}", data.display());
    let text = fs::read_to_string(&data).expect("the reference collisions are in tests/data");
    fs::write(out.join("cases.rs"), cases(&text, false)).expect("the folder can be written");
    fs::write(out.join("families.rs"), cases(&text, true)).expect("the folder can be written");
    println!("cargo::rerun-if-env-changed=HODOGRAPH_CHOSEN");
    let chosen = env::var("HODOGRAPH_CHOSEN").map_or("&[]".into(), |file| {
        println!("cargo::rerun-if-changed={file}");
        fs::read_to_string(file).expect("HODOGRAPH_CHOSEN names a file")
    });
    fs::write(out.join("chosen.rs"), chosen).expect("the folder can be written");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let memory = "MEMORY { FLASH : ORIGIN = 0, LENGTH = 4M\nRAM : ORIGIN = 0x20000000, LENGTH = 4M }\n";
        fs::write(out.join("memory.x"), memory).expect("the folder can be written");
        println!("cargo::rustc-link-search={}", out.display());
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
}

/// Every line with a reduced matrix as (m, v, mu, e, law), or (family, (m, v, mu, e, law)).
fn cases(text: &str, families: bool) -> String {
    let mut code = String::from("[\n");
    for line in text.lines().filter(|line| line.contains("\"m\": ")) {
        let after = |key: &str| line.split_once(&format!("\"{key}\": ")).map_or("", |(_, rest)| rest);
        let list = |key: &str| {
            let inside = after(key).trim_start_matches('[').split(']').next().unwrap_or("");
            let numbers = inside.split(',').map(|number| number.trim().trim_matches('"'));
            numbers.map(decimal).collect::<Vec<_>>().join(", ")
        };
        let one = |key: &str| after(key).split([',', '}']).next().unwrap_or("").trim_matches('"').to_owned();
        let law = match one("law").as_str() {
            "newton" => "Newton",
            "poisson" => "Poisson",
            _ => "Stronge",
        };
        let (m, v, mu, e) = (list("m"), list("v"), decimal(&one("mu")), decimal(&one("e")));
        let case = format!("([{m}], [{v}], {mu}, {e}, Law::{law})");
        let line = if families { format!("({:?}, {case}),", one("family")) } else { format!("{case},") };
        writeln!(code, "{line}").expect("a string can be written to");
    }
    code + "]"
}

/// A number as Rust writes a double.
fn decimal(text: &str) -> String {
    format!("{:?}", text.trim().parse::<f64>().expect("the data hold numbers"))
}
