//! Arbitrary input: every text gives a result within bounded time, without a panic.

use std::time::{Duration, Instant};

use hodograph_generator::artifact::model_hash;
use hodograph_generator::diagnostics::codes;
use hodograph_generator::rendering::render;
use hodograph_generator::{check::check, files, source::Source};
use proptest::prelude::*;

/// Checks a text that must be refused with this code. The bound on the time is wide, so that it holds on
/// every machine: work that grows without bound is beyond it.
fn refused(what: &str, text: String, code: hodograph_generator::diagnostics::Code) {
    let begun = Instant::now();
    let source = Source::file("big.mech", text);
    let checked = check(&source);
    let said = render(&checked.diagnostics, &source);
    assert!(checked.mechanism.is_none(), "{what} is accepted");
    assert!(checked.diagnostics.iter().any(|d| d.code == code), "{what}: {said}");
    let taken = begun.elapsed();
    assert!(taken < Duration::from_secs(600), "{what} took {taken:?}");
}

const HEAD: &str = "mechanism M; parameters { m: kg = 1 } coordinates { q1: m } speeds { u1: m/s }\n";
const TAIL: &str = "points { P = O + q1*N.x; } particles { A { point: P, mass: m } }\n";

fn with(sections: &str) -> String {
    format!("{HEAD}{sections}\n{TAIL}")
}

#[test]
fn deep_nesting() {
    let n = 100_000;
    for (open, close) in [("(", ")"), ("[", "]"), ("sin(", ")"), ("d(", ")/dt"), ("A.vec(", ")")] {
        let n = if open.len() == 1 { n } else { n / 2 };
        let text = with(&format!("definitions {{ a = {}1{}; }}", open.repeat(n), close.repeat(n)));
        refused(open, text, codes::TOO_DEEP);
    }
    refused("signs", with(&format!("definitions {{ a = {}1; }}", "-".repeat(n))), codes::TOO_DEEP);
    refused("powers", with(&format!("definitions {{ a = {}1; }}", "2^".repeat(n))), codes::TOO_DEEP);
    refused("members", with(&format!("definitions {{ a = N{}; }}", ".x".repeat(n))), codes::TOO_DEEP);
    refused("braces", "{".repeat(n), codes::UNBALANCED);
    refused("comments", "/*".repeat(n), codes::UNBALANCED);
}

#[test]
fn towers_and_numbers() {
    refused("a tower", with("definitions { a = 10^10^6; }"), codes::EXPONENT);
    refused("a negative tower", with("definitions { a = 10^-10^6; }"), codes::EXPONENT);
    refused(
        "digits",
        with(&format!("definitions {{ a = {}; }}", "9".repeat(1_000_000))),
        codes::NUMBER_RANGE,
    );
    refused("an exponent", with("definitions { a = 1e999999999999; }"), codes::NUMBER_RANGE);
    let chain = "99^99*".repeat(2000);
    refused("a product", with(&format!("definitions {{ a = {chain}1; }}")), codes::NUMBER_RANGE);
    for (what, constant) in [
        ("a power that vanishes", "(3^-99)^99"),
        ("a product that vanishes", "1e-200*1e-200"),
        ("a quotient that vanishes", "1e-200/1e200"),
        ("a power of many digits", "((3/7 + 1/1234567)^99)^99"),
    ] {
        refused(what, with(&format!("definitions {{ a = {constant}; }}")), codes::NUMBER_RANGE);
    }
}

#[test]
fn large_files() {
    refused("50 MB of blanks", " ".repeat(50 << 20), codes::TOO_LARGE);
    refused("50 MB of words", "mechanism ".repeat(5 << 20), codes::TOO_LARGE);
    refused("4 MB of signs", "+".repeat(4 << 20), codes::TOO_LARGE);
    refused(
        "one long line",
        with(&format!("definitions {{ a = {}1; }}", "x+".repeat(200_000))),
        codes::UNKNOWN_NAME,
    );
    refused("many errors", with(&format!("definitions {{ {} }}", "= ; ".repeat(200_000))), codes::EXPECTED);
}

#[test]
fn long_chains_of_names() {
    let n = 10_000;
    let chain: String = (0..n).map(|i| format!("a{i} = a{}; ", i + 1)).collect();
    refused("a chain", with(&format!("definitions {{ {chain} a{n} = 1; }}")), codes::TOO_DEEP);
    refused("a circle", with(&format!("definitions {{ {chain} a{n} = a0; }}")), codes::CYCLE);
    let frames: String = (0..n).map(|i| format!("F{i} = F{}.rotate(z, 1); ", i + 1)).collect();
    refused("frames", with(&format!("frames {{ {frames} F{n} = N; }}")), codes::TOO_DEEP);
}

#[test]
fn many_names() {
    let n = 40_000;
    let unknown: String = (0..n).map(|i| format!("a{i} = unknown{i}; ")).collect();
    refused("unknown names", with(&format!("definitions {{ {unknown} }}")), codes::UNKNOWN_NAME);
    let frames: String = (0..n).map(|i| format!("F{i} = N; ")).collect();
    let stated: String = (0..n).map(|i| format!("F{i} = w; ")).collect();
    let text = with(&format!("frames {{ {frames} }} angular_velocities {{ {stated} }}"));
    refused("stated motions", text, codes::UNKNOWN_NAME);
    let coordinates: String = (0..n).map(|i| format!("q{i}: m, ")).collect();
    let text = format!("mechanism M; coordinates {{ {coordinates} }} speeds {{ u1: m/s }}");
    refused("coordinates", text, codes::TOO_LARGE);
}

#[test]
fn many_wrong_units() {
    let n = 10_000;
    let parameters: String = (0..n).map(|i| format!("a{i}: kg = 1, b{i}: s = 1, ")).collect();
    let points: String =
        (0..n).map(|i| format!("P{i} = O + a{i}*N.x + b{i}*N.y; Q{i} = O + (a{i} - 2*b{i})*N.z; ")).collect();
    let text = format!("mechanism M; parameters {{ {parameters} }} points {{ {points} }}");
    refused("wrong units", text, codes::DIMENSION);
    let product: String = (0..n).map(|i| format!("a{i}*")).collect();
    let sum: String = (0..n).map(|i| format!("a{i}*b{} + ", n - 1 - i)).collect();
    let uses = format!("definitions {{ a = {product}1 + 1; b = {sum} time; c = b + time; }}");
    refused("large products", format!("mechanism M; parameters {{ {parameters} }} {uses}"), codes::EXPONENT);
}

/// Ten thousand of everything that may be many is a model like others.
#[test]
fn ten_thousand_parameters() {
    let n = 10_000;
    let parameters: String = (0..n).map(|i| format!("p{i}: m = {i}, ")).collect();
    let sum: String = (0..n).map(|i| format!("p{i} + ")).collect();
    let text = format!(
        "mechanism M; parameters {{ m: kg = 1, {parameters} }} coordinates {{ q1: m }} speeds {{ u1: m/s }}
         definitions {{ a = {sum} q1; }} points {{ P = O + a*N.x; }} particles {{ A {{ point: P, mass: m }} }}"
    );
    let begun = Instant::now();
    let checked = check(&Source::file("many.mech", text));
    assert!(checked.mechanism.is_some(), "{:?}", checked.diagnostics.first());
    assert!(begun.elapsed() < Duration::from_secs(600));
}

/// A chain of links that turn about x, y, z in turn.
fn chain(links: usize, inertia: &str) -> String {
    let list =
        |of: &dyn Fn(usize) -> String, between: &str| (1..=links).map(of).collect::<Vec<_>>().join(between);
    let before = |i: usize, first: &str, name: &str| {
        if i == 1 { first.to_owned() } else { format!("{name}{}", i - 1) }
    };
    format!(
        "mechanism Chain; parameters {{ m: kg = 1, l: m = 0.5, J: kg*m^2 = 0.1 }}
         coordinates {{ {} }} speeds {{ {} }} frames {{ {} }} points {{ {} }} bodies {{ {} }}",
        list(&|i| format!("q{i}: rad = 0.{}", i % 9 + 1), ", "),
        list(&|i| format!("u{i}: rad/s"), ", "),
        list(&|i| format!("B{i} = {}.rotate({}, q{i});", before(i, "N", "B"), ["x", "y", "z"][i % 3]), " "),
        list(&|i| format!("P{i} = {} - l*B{i}.y;", before(i, "O", "P")), " "),
        list(&|i| format!("R{i} {{ frame: B{i}, centre: P{i}, mass: m, inertia: {inertia} }}"), ", "),
    )
}

/// A large mechanism is looked at in numbers too; one with more than 256 speeds is refused here
/// already.
#[test]
fn the_largest_mechanism() {
    let begun = Instant::now();
    let checked = check(&Source::file("chain.mech", chain(100, "[J, J, J]")));
    assert!(
        checked.mechanism.is_some() && checked.diagnostics.is_empty(),
        "{:?}",
        checked.diagnostics.first()
    );
    let checked = check(&Source::file("chain.mech", chain(64, "[J, J, 3*J]")));
    assert!(checked.diagnostics.len() == 64 && checked.diagnostics.iter().all(|d| d.code == codes::INERTIA));
    assert!(begun.elapsed() < Duration::from_secs(600), "{:?}", begun.elapsed());
    refused("257 speeds", chain(257, "[J, J, J]"), codes::TOO_LARGE);
}

/// What is not looked at is said.
#[test]
fn too_many_parts_to_look_at() {
    let frames: String = (0..8000).map(|i| format!("F{i} = N; ")).collect();
    let checked = check(&Source::file("many.mech", with(&format!("frames {{ {frames} }}"))));
    assert!(checked.mechanism.is_some());
    assert_eq!(checked.diagnostics.iter().map(|d| d.code).collect::<Vec<_>>(), [codes::UNCHECKED]);
}

#[test]
fn files_that_are_no_text() {
    let checked = check(&Source::bytes("x.mech", vec![b'm', 0xff, 0xfe]));
    assert_eq!(checked.diagnostics[0].code, codes::UNREADABLE);
    let checked = check(&files::model(std::path::Path::new("/no/such/file.mech")));
    assert_eq!(checked.diagnostics[0].code, codes::UNREADABLE);
    let texts = ["", "\u{feff}", "\n", "//", "/", "\0", "mechanism", "mechanism ;", "mechanism A;"];
    for text in
        texts.into_iter().chain(["mechanism \"A\";", "mechanism\" points- . \"", "mechanism! {", "\"\""])
    {
        let source = Source::file("x.mech", text);
        let checked = check(&source);
        assert!(checked.mechanism.is_none() && !checked.diagnostics.is_empty(), "{text:?}");
        render(&checked.diagnostics, &source);
    }
}

fn models() -> Vec<String> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("models").filter_map(|e| Some(e.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "mech"));
    paths.sort();
    paths.iter().map(|path| std::fs::read_to_string(path).expect("text")).collect()
}

const WORDS: &[&str] = &[
    "mechanism",
    "M",
    ";",
    "parameters",
    "{",
    "}",
    "m",
    ":",
    "kg",
    "=",
    "1",
    ",",
    "coordinates",
    "q1",
    "speeds",
    "u1",
    "frames",
    "B",
    "N",
    ".",
    "rotate",
    "(",
    "z",
    ")",
    "points",
    "P",
    "O",
    "+",
    "-",
    "*",
    "/",
    "^",
    "bodies",
    "frame",
    "centre",
    "mass",
    "inertia",
    "[",
    "]",
    "constraints",
    "velocity",
    "d",
    "dt",
    "contacts",
    "point",
    "of",
    "normal",
    "///",
    "\n",
    "in",
];

/// An answer, whatever it is; a refusal has reasons, and all of it can be shown.
fn answered(bytes: Vec<u8>) {
    let source = Source::bytes("x.mech", bytes);
    let checked = check(&source);
    assert!(checked.mechanism.is_some() || !checked.diagnostics.is_empty());
    render(&checked.diagnostics, &source);
    model_hash(&source);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(60), ..ProptestConfig::with_cases(256) })]

    #[test]
    fn arbitrary_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        answered(bytes);
    }

    #[test]
    fn arbitrary_text(text in ".{0,200}") {
        answered(format!("mechanism M; parameters {{ {text} }}").into_bytes());
    }

    #[test]
    fn soups_of_words(words in proptest::collection::vec(proptest::sample::select(WORDS), 0..120)) {
        answered(words.join(" ").into_bytes());
    }

    #[test]
    fn changed_models(
        which in any::<prop::sample::Index>(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), 0_usize..10, proptest::sample::select(WORDS)), 1..5),
    ) {
        let mut text = models()[which.index(models().len())].clone().into_bytes();
        for (at, length, word) in changes {
            let at = at.index(text.len());
            let end = (at + length).min(text.len());
            text.splice(at..end, word.bytes());
        }
        answered(text);
    }
}

/// A frame that turns back by a constant angle is fixed in the body, whatever rounding leaves of their relative
/// angular velocity.
#[test]
fn an_inertia_in_a_frame_that_is_fixed_in_the_body_is_constant() {
    for step in 1..60 {
        let angle = f64::from(step) * 0.1;
        let text = format!(
            "mechanism Fork; parameters {{ m: kg = 1, J: kg*m^2 = 0.02, c: rad = {angle} }}\n\
             coordinates {{ q1: rad = 0.3, q2: rad = 0.7, q3: rad = 0.2 }} speeds {{ u1: rad/s = 0.9, u2: rad/s = 1.3, u3: rad/s = 0.4 }}\n\
             frames {{ A = N.rotate(z, q1); B = A.rotate(y, q2 + c); C = B.rotate(x, q3); D = B.rotate(y, -c); E = C.rotate(y, -c); }}\n\
             bodies {{ P {{ frame: B, centre: O, mass: m, inertia: [J, 2*J, 2.5*J, 0, 0, J/9] in D }}, \
             Q {{ frame: C, centre: O, mass: m, inertia: [J, 2*J, 2.5*J, 0, 0, J/9] in E }} }}\n"
        );
        let found = check(&Source::file("fork", text.as_str())).diagnostics;
        assert!(found.is_empty(), "{angle}: {:?}", found.iter().map(|d| &d.message).collect::<Vec<_>>());
    }
}

/// A point that stands still because motions cancel is a point of N, whatever rounding leaves of its velocity.
#[test]
fn a_point_whose_motions_cancel_stands_still() {
    for step in 1..60 {
        let k = f64::from(step) * 0.1;
        let text = format!(
            "mechanism Still; parameters {{ m: kg = 1, l: m = 0.7, k: 1 = {k} }} coordinates {{ q1: rad = 0.3, q2: rad = 0.7 }}\n\
             speeds {{ u1: rad/s = 0.9, u2: rad/s = 1.3 }} frames {{ A = N.rotate(z, q1); B = A.rotate(x, q2); C = A.rotate(x, q2); }}\n\
             points {{ P = O + l*B.z; Q = P - k*l*A.y; R = Q - l*C.z; S = R + k*l*A.y; T of N = S + l*N.x; }}\n\
             particles {{ E {{ point: P, mass: m }}, F {{ point: R, mass: m }} }}\n"
        );
        let found = check(&Source::file("still", text.as_str())).diagnostics;
        assert!(
            found.is_empty(),
            "{k}: {:?}",
            found.iter().map(|d| (d.code, &d.message)).collect::<Vec<_>>()
        );
    }
}
