//! A specialised collision is one routine: in the machine code of `tests/fixtures/inlined` it calls no function but
//! those for cold paths, which the compiler puts into the section `.text.unlikely`.
//!
//! The machine code is the compiler's own listing (`rustc --emit asm`), so that no disassembler is needed:
//! for this machine if it is x86-64, and for Cortex-M4F in singles and Cortex-M7 in doubles where the compiler
//! has the target's core library, or `tests/firmware/run` has unpacked one that has.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The target of Cortex-M processors.
const CORTEX_M: &str = "thumbv7em-none-eabihf";

/// The routines that `tests/fixtures/inlined` compiles specialised: model, method.
const ROUTINES: [[&str; 2]; 12] = [
    ["two_sleds", "newton"],
    ["two_sleds", "poisson"],
    ["two_sleds", "stronge"],
    ["two_sleds", "any_law"],
    ["planar_double_pendulum", "poisson"],
    ["arm_7dof", "fixed"],
    ["crossing_rails", "isotropic"],
    ["crossing_rails", "isotropic_any_law"],
    ["gantry", "diagonal"],
    ["gantry", "diagonal_any_law"],
    ["askew_gantry", "balanced"],
    ["askew_gantry", "balanced_any_law"],
];

/// The same collisions as usual.
const SHARED: [[&str; 2]; 5] = [
    ["inlined", "sleds_shared"],
    ["inlined", "arm_shared"],
    ["inlined", "rails_shared"],
    ["inlined", "gantry_shared"],
    ["inlined", "askew_shared"],
];

/// A function of a listing.
#[derive(Default)]
struct Function {
    cold: bool,
    instructions: usize,
    /// whom it calls, or jumps to at its end
    calls: Vec<String>,
}

/// The functions of a listing, by their symbols.
struct Listing(BTreeMap<String, Function>);

impl Listing {
    fn read(text: &str) -> Self {
        let mut functions: BTreeMap<String, Function> = BTreeMap::new();
        let (mut section, mut now) = (String::new(), None);
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let Some(&first) = words.first() else { continue };
            if let Some(label) = line.strip_suffix(':').filter(|label| !label.starts_with([' ', '\t'])) {
                if !label.starts_with(".L") && section.starts_with(".text") {
                    let cold = section.starts_with(".text.unlikely");
                    functions.insert(label.to_owned(), Function { cold, ..Function::default() });
                    now = Some(label.to_owned());
                }
            } else if first == ".section" {
                let name = words.get(1).and_then(|word| word.split(',').next()).unwrap_or_default();
                // A name with `$` is quoted.
                section = name.trim_matches('"').to_owned();
            } else if first == ".text" {
                section = first.to_owned();
            } else if !first.starts_with(['.', '#', '@']) && section.starts_with(".text") {
                let Some(function) = now.as_ref().and_then(|name| functions.get_mut(name)) else { continue };
                function.instructions += 1;
                function.calls.extend(callee(first, words.get(1).copied().unwrap_or_default()));
            }
        }
        Listing(functions)
    }

    /// The one function whose symbol has all of these words, mangled.
    fn find(&self, words: &[&str]) -> (&str, &Function) {
        let has = |symbol: &str| words.iter().all(|word| symbol.contains(&format!("{}{word}", word.len())));
        let mut found = self.0.iter().filter(|(symbol, _)| has(symbol));
        let (symbol, function) = found.next().unwrap_or_else(|| panic!("no function {words:?}"));
        assert!(found.next().is_none(), "{words:?} are several functions");
        (symbol, function)
    }

    /// The functions that a function calls and that are not cold.
    fn hot_calls(&self, words: &[&str]) -> Vec<&str> {
        let (_, function) = self.find(words);
        let hot = |callee: &&String| self.0.get(*callee).is_none_or(|callee| !callee.cold);
        function.calls.iter().filter(hot).map(String::as_str).collect()
    }
}

/// Whom an instruction calls: the symbol, or the operand where it is no symbol. A jump to a label of the same
/// function calls nobody.
fn callee(instruction: &str, operand: &str) -> Option<String> {
    let calls = matches!(instruction, "call" | "callq" | "bl" | "blx");
    let jumps = matches!(instruction, "jmp" | "jmpq") || instruction == "b" || instruction.starts_with("b.");
    let symbol = operand.trim_start_matches('*').split(['@', '(']).next().unwrap_or_default();
    // `jmpq *%rax` with a register is the jump of a `match`.
    let away = jumps && !symbol.is_empty() && !symbol.starts_with(['.', '%']);
    (calls || away).then(|| if symbol.is_empty() { operand.to_owned() } else { symbol.to_owned() })
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The listing of `tests/fixtures/inlined` with a feature, compiled in a folder of builds by this cargo, for another target
/// than this machine where one is given.
fn listing(cargo: &Path, builds: &str, target: Option<&str>, feature: &str, flags: &str) -> Listing {
    let builds = Path::new(env!("CARGO_TARGET_TMPDIR")).join(builds);
    let mut command = Command::new(cargo);
    command
        .args(["rustc", "--release", "--offline", "--locked", "--lib", "--features", feature, "--target-dir"])
        .arg(&builds)
        .args(target.map(|target| format!("--target={target}")))
        .args(["--", "--emit", "asm"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/inlined"));
    // What belongs to the outer build must not leak into the inner one.
    for (key, _) in std::env::vars_os() {
        let key = key.to_string_lossy().into_owned();
        if key.starts_with("CARGO_") && key != "CARGO_HOME" || key == "RUSTFLAGS" || key == "RUSTC" {
            command.env_remove(key);
        }
    }
    let output = command.env("RUSTFLAGS", flags).output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let folder = target.map_or_else(|| builds.clone(), |target| builds.join(target)).join("release/deps");
    let listed = std::fs::read_dir(folder).expect("a folder").flatten().filter(|entry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        name.starts_with("inlined-") && name.ends_with(".s")
    });
    let dated = listed
        .map(|entry| (entry.metadata().and_then(|data| data.modified()).expect("a time"), entry.path()));
    let (_, path) = dated.max().expect("cargo has written a listing");
    Listing::read(&std::fs::read_to_string(path).expect("text"))
}

fn own_cargo() -> PathBuf {
    std::env::var_os("CARGO").map_or_else(|| "cargo".into(), PathBuf::from)
}

/// A cargo whose compiler has the core library for Cortex-M.
fn cargo_for_cortex_m() -> Option<PathBuf> {
    let folder =
        Command::new("rustc").args(["--print", "target-libdir", "--target", CORTEX_M]).output().ok()?;
    let folder = PathBuf::from(String::from_utf8_lossy(&folder.stdout).trim());
    let has_core = |folder: &Path| {
        let mut files = std::fs::read_dir(folder).into_iter().flatten().flatten();
        files.any(|file| file.file_name().to_string_lossy().starts_with("libcore-"))
    };
    if has_core(&folder) {
        return Some(own_cargo());
    }
    let tools = std::env::var_os("HODOGRAPH_TARGETS")
        .map_or_else(|| repository().join("target/targets"), PathBuf::from);
    let root = tools.join("rust");
    let has = root.join("usr/lib/rustlib").join(CORTEX_M).join("lib/complete").is_file();
    has.then(|| root.join("bin/cargo"))
}

/// Every routine calls cold functions only, and all of them together those of other packages whose names
/// `outside` lists, each of them; the same collisions as usual call others.
fn one_routine_each(listing: &Listing, outside: &[&str]) {
    let mut called = BTreeSet::new();
    for routine in ROUTINES {
        for callee in listing.hot_calls(&routine) {
            let name = outside.iter().find(|name| callee.contains(&format!("{}{name}", name.len())));
            called.insert(*name.unwrap_or_else(|| panic!("{routine:?} calls {callee}")));
        }
    }
    assert!(called.iter().eq(&outside.iter().copied().collect::<BTreeSet<_>>()), "{called:?} of {outside:?}");
    for routine in SHARED {
        let hot = listing.hot_calls(&routine);
        assert!(hot.iter().any(|name| name.contains("hodograph")), "{routine:?} calls {hot:?} alone");
    }
    // A law that is known makes the routine shorter.
    let length = |law: &str| listing.find(&["two_sleds", law]).1.instructions;
    for law in ["newton", "poisson", "stronge"] {
        assert!(length(law) < length("any_law"), "{law}: {} {}", length(law), length("any_law"));
    }
}

#[test]
fn a_specialised_collision_calls_no_function_on_x86_64() {
    if !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        eprintln!("skipped: this machine is no x86-64 with Linux, whose listing the test reads");
        return;
    }
    // where the other crates of tests are built
    one_routine_each(&listing(&own_cargo(), "fixtures", None, "std", ""), &[]);
}

/// What is called on these processors, by name. Square roots: without the standard library the processor's
/// instruction is out of reach (docs/real-time.md), and `libm` takes some fifty instead, which fifty places of a
/// routine share. And the reduction of angles `beyond` 128 rad (2^19 rad in doubles), which is cold, but of another
/// package, whose section this listing does not show.
const ON_CORTEX_M: [(&str, &str, &[&str]); 2] =
    [("cortex-m4", "single", &["sqrtf", "beyond"]), ("cortex-m7", "", &["sqrt", "beyond"])];

#[test]
fn a_specialised_collision_calls_square_roots_alone_on_cortex_m() {
    let Some(cargo) = cargo_for_cortex_m() else {
        eprintln!(
            "skipped: no compiler here has the core library for {CORTEX_M}; `rustup target add {CORTEX_M}` or `tests/firmware/run` brings one"
        );
        return;
    };
    for (processor, feature, outside) in ON_CORTEX_M {
        let (builds, flags) = (format!("inlined/{processor}"), format!("-Ctarget-cpu={processor}"));
        let listing = listing(&cargo, &builds, Some(CORTEX_M), feature, &flags);
        one_routine_each(&listing, outside);
    }
}

#[test]
fn calls_are_seen_in_listings() {
    let listing = Listing::read(
        "\t.section\t.text._ZN1a4hereE,\"ax\",@progbits\n_ZN1a4hereE:\n\tcallq\t*_ZN1a3farE@GOTPCREL(%rip)\n\tjmp\t.LBB0_1\n\
         .LBB0_1:\n\tcallq\t_ZN1a4coldE\n\tjmpq\t*%rax\n\tjmp\t_ZN1a4tailE\n\tcallq\t*%rax\n\t.section\t\".text.unlikely._ZN1a4coldE\",\"ax\"\n_ZN1a4coldE:\n\
         \tretq\n\t.section\t.text._ZN1a5there,\"ax\"\n_ZN1a5thereE:\n\tbl\t_ZN1a4coldE\n\tb\t.LBB1_2\n\tblx\tr3\n\tb.w\t_ZN1a3farE\n\tbl\tsqrt\n",
    );
    assert_eq!(listing.hot_calls(&["here"]), ["_ZN1a3farE", "_ZN1a4tailE", "%rax"]);
    assert_eq!(listing.hot_calls(&["there"]), ["r3", "_ZN1a3farE", "sqrt"]);
    assert_eq!((listing.find(&["here"]).1.instructions, listing.find(&["cold"]).1.cold), (6, true));
}
