//! Stack of every routine in `tests/freestanding`: the frames along the deepest way through the calls, from the machine code.
//!
//! `cargo run --release --manifest-path tests/instructions/Cargo.toml --bin stack` builds that program and prints a table. It needs `objdump`.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, ExitCode};

/// A function of the program.
#[derive(Default)]
struct Function {
    /// its name; instances for several types share one
    name: String,
    /// saved registers and local variables, bytes
    frame: u64,
    /// where the functions begin that it calls
    callees: Vec<u64>,
}

/// Functions by where they begin.
type Functions = BTreeMap<u64, Function>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../freestanding");
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/freestanding");
    execute(
        Command::new("cargo")
            .args(["build", "--release", "--manifest-path"])
            .arg(package.join("Cargo.toml"))
            .arg("--target-dir")
            .arg(&target),
    )?;
    let code = execute(
        Command::new("objdump")
            .args(["-d", "-C", "--no-show-raw-insn"])
            .arg(target.join("release/freestanding")),
    )?;
    let functions = read(&code);
    println!("| routine | own frame (bytes) | deepest (bytes) |\n| --- | ---: | ---: |");
    let mut lines = Vec::new();
    for (&at, function) in &functions {
        if let Some(name) = function.name.strip_prefix("freestanding::") {
            lines.push(format!(
                "| {name} | {} | {} |",
                function.frame,
                depth(at, &functions, &mut Vec::new())?
            ));
        }
    }
    lines.sort();
    lines.iter().for_each(|line| println!("{line}"));
    Ok(())
}

/// What a command prints.
fn execute(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr)))
    }
}

/// The functions of a program from what `objdump -d` prints of it.
fn read(code: &str) -> Functions {
    let mut functions = Functions::new();
    let mut at = 0;
    // a large frame is taken page by page: the sum is told before
    let mut in_pages = false;
    for line in code.lines() {
        if let Some((begin, name)) = line.strip_suffix(">:").and_then(|line| line.split_once(" <")) {
            at = number(begin);
            in_pages = false;
            functions.insert(at, Function { name: name.to_owned(), ..Function::default() });
            continue;
        }
        let (Some(instruction), Some(function)) = (line.split('\t').nth(1), functions.get_mut(&at)) else {
            continue;
        };
        let (operation, operands) = instruction.split_once(' ').unwrap_or((instruction, ""));
        let operands = operands.trim();
        match operation {
            "push" => function.frame += 8,
            "lea" if operands.starts_with("-0x") && operands.ends_with("(%rsp),%r11") => {
                function.frame += number(operands.trim_start_matches('-'));
                in_pages = true;
            }
            "sub" if operands.ends_with(",%rsp") => {
                let bytes = number(operands.trim_start_matches('$'));
                if in_pages && bytes == 4096 {
                    in_pages = false;
                } else {
                    function.frame += bytes;
                }
            }
            "call" | "jmp" => {
                // a jump within the function has an offset
                if let Some((callee, _)) = operands.split_once(" <").filter(|(_, name)| !name.contains("+0x"))
                {
                    function.callees.push(number(callee));
                }
            }
            _ => {}
        }
    }
    functions
}

/// A hexadecimal number at the beginning of a text.
fn number(text: &str) -> u64 {
    let digits: String = text.trim_start_matches("0x").chars().take_while(char::is_ascii_hexdigit).collect();
    u64::from_str_radix(&digits, 16).unwrap_or(0)
}

/// Bytes from the entry of a function to the deepest point of what it calls, its return address included.
fn depth(at: u64, functions: &Functions, way: &mut Vec<u64>) -> Result<u64, String> {
    let Some(function) = functions.get(&at) else { return Ok(8) };
    if way.contains(&at) {
        return Err(format!("{} calls itself: it has no bound", function.name));
    }
    way.push(at);
    let mut deepest = 0;
    // a loop may begin where the function does
    for &callee in function.callees.iter().filter(|callee| **callee != at) {
        deepest = deepest.max(depth(callee, functions, way)?);
    }
    way.pop();
    Ok(8 + function.frame + deepest)
}
