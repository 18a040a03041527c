//! Nothing that `check` accepts fails later: mutated models that it accepts are derived and become Rust.

#![cfg(feature = "derive")]

use std::path::Path;

use hodograph_generator::check::check;
use hodograph_generator::diagnostics::codes::ALL;
use hodograph_generator::emit::{self, Options};
use hodograph_generator::explanations::{explanation, whole};
use hodograph_generator::program::Program;
use hodograph_generator::source::Source;
use hodograph_generator::{DerivationError, derive};

/// What becomes of a model: `None` where `check` refuses it.
fn outcome(text: &str) -> Option<Result<(), String>> {
    let mechanism = check(&Source::file("accepted.mech", text)).mechanism?;
    let derived = match derive(&mechanism) {
        Ok(derived) => derived,
        Err(DerivationError::Model(error)) => return Some(Err(error.to_string())),
        Err(DerivationError::Session(error)) => return Some(Err(error.to_string())),
    };
    let program = Program::new(&derived);
    let options = Options {
        krate: "::hodograph".parse().expect("a path"),
        module: "accepted".to_owned(),
        tracked: Vec::new(),
        requests: emit::Requests::default(),
    };
    let module = emit::module(&mechanism, &program, &options);
    Some(
        module
            .and_then(|module| syn::parse2::<syn::File>(module).map(drop).map_err(|error| error.to_string())),
    )
}

/// The models of a folder of this package's neighbour.
fn models(folder: &str) -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let entries = std::fs::read_dir(folder).expect("models").filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "mech")).collect();
    paths.sort();
    let named = |path: &std::path::PathBuf| {
        (path.display().to_string(), std::fs::read_to_string(path).expect("a model"))
    };
    paths.iter().map(named).collect()
}

/// Examples and golden cases that are accepted, with warnings or without.
#[test]
fn accepted_examples_are_derived() {
    let (mut done, mut wrong) = (0, Vec::new());
    let examples = ALL.iter().filter_map(|(code, _)| explanation(*code)).flat_map(|explanation| {
        [explanation.wrong, explanation.right]
            .into_iter()
            .flatten()
            .map(|example| (explanation.code.to_string(), whole(example)))
    });
    for (name, text) in examples.chain(models("tests/diagnostics")).chain(models("tests/slips")) {
        match outcome(&text) {
            None => {}
            Some(Ok(())) => done += 1,
            Some(Err(error)) => wrong.push(format!("{name}: {error}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(done > 60, "{done}");
}

/// A number that looks random and is the same in every run.
fn next(bits: &mut u64) -> u64 {
    *bits ^= *bits << 13;
    *bits ^= *bits >> 7;
    *bits ^= *bits << 17;
    *bits >> 16
}

/// Names, numbers and signs of small models are exchanged for others of the same model.
#[test]
fn accepted_mutations_are_derived() {
    let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
    let sources: Vec<String> = models("tests/slips").into_iter().map(|(_, text)| text).collect();
    let (mut done, mut refused, mut wrong) = (0, 0, Vec::new());
    while done < 60 && refused < 20_000 {
        let text = &sources[next(&mut bits) as usize % sources.len()];
        let words = words(text);
        let mut changed = text.clone();
        let (at, by) = (next(&mut bits) as usize % words.len(), next(&mut bits) as usize % words.len());
        let ((from, to), (other, end)) = (words[at], words[by]);
        changed.replace_range(from..to, &text[other..end]);
        match outcome(&changed) {
            None => refused += 1,
            Some(Ok(())) => done += 1,
            Some(Err(error)) => wrong.push(format!("{error}\n{changed}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(done == 60, "{done} accepted, {refused} refused");
}

/// Where the names, numbers and signs of a model stand.
fn words(text: &str) -> Vec<(usize, usize)> {
    let mut words = Vec::new();
    let mut start = None;
    for (i, c) in text.char_indices() {
        let word = c.is_alphanumeric() || c == '_' || c == '.';
        match (start, word) {
            (None, true) => start = Some(i),
            (Some(from), false) => {
                words.push((from, i));
                start = None;
            }
            _ => {}
        }
        if "+-*/".contains(c) {
            words.push((i, i + 1));
        }
    }
    words
}

/// Constraints that couple dependent speeds at random, up to more at once than the derivation solves: what is
/// accepted is derived, and what is refused for its size is refused by `check`.
#[test]
fn coupled_constraints_are_derived_or_refused() {
    let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
    let mut pick = |most: u64| next(&mut bits) % most;
    let (mut derived, mut too_large) = (0, 0);
    let rings = [(9, true), (10, true)];
    let triangles = [(1_u64, false), (2, false), (5, false), (9, false), (12, false)];
    for (count, ring) in triangles.into_iter().chain(rings) {
        // each constraint has its own speed, the independent one and some others
        let others = if count > 8 { 1 } else { count / 2 };
        let constraints: Vec<String> = (0..count)
            .map(|row| {
                let mut terms = vec![format!("{}*u{} - u0", 2 + pick(5), row + 1)];
                terms.extend((0..others).filter_map(|_| {
                    let other = if ring { (row + 1) % count } else { pick(count) };
                    (ring || other < row).then(|| format!("{}*u{}", 1 + pick(3), other + 1))
                }));
                format!("{} = 0;", terms.join(" + "))
            })
            .collect();
        let list = |what: &dyn Fn(u64) -> String| (1..=count).map(what).collect::<Vec<_>>().join(", ");
        let text = format!(
            "mechanism Coupled; parameters {{ m: kg = 1 }} coordinates {{ q0: m, {} }} speeds {{ u0: m/s }} dependent {{ {} }} \
             points {{ P = O + q0*N.x; {} }} particles {{ A {{ point: P, mass: m }} }} constraints {{ {} }}",
            list(&|i| format!("q{i}: m")),
            list(&|i| format!("u{i}: m/s")),
            (1..=count).map(|i| format!("P{i} = P + q{i}*N.y;")).collect::<String>(),
            constraints.concat(),
        );
        match outcome(&text) {
            Some(result) => {
                result.unwrap_or_else(|error| panic!("{error}\n{text}"));
                derived += 1;
            }
            None => {
                let told = check(&Source::file("accepted.mech", text.as_str())).diagnostics;
                assert!(ring && told.iter().any(|d| d.code.0 == "E002"), "{told:?}\n{text}");
                too_large += 1;
            }
        }
    }
    assert_eq!((derived, too_large), (5, 2));
}

/// Definitions that square one another stay finite, and so are accepted; the digits of exact bounds of such
/// numbers double with each.
#[test]
fn definitions_that_square_one_another_are_derived() {
    for step in [
        "{a}*{a}/2 + {a}/3",
        "2*{a}^2 - 1",
        "{a}*sin({a}) + cos({a})/7",
        "({a} + 0.1)*({a} - 0.2)/(1 + {a}^2)",
    ] {
        let chain: String =
            (0..39).map(|i| format!("a{} = {}; ", i + 1, step.replace("{a}", &format!("a{i}")))).collect();
        let text = format!(
            "mechanism Squares; parameters {{ m: kg = 1, l: m = 1, g: m/s^2 = 9.81 }} coordinates {{ q1: rad = 0.3 }} \
             speeds {{ u1: rad/s }} definitions {{ a0 = cos(q1); {chain} }} points {{ P = O + l*(q1 + 0.1*a39)*N.x; }} \
             particles {{ A {{ point: P, mass: m }} }} loads {{ gravity: -g*N.x; }}"
        );
        assert_eq!(outcome(&text), Some(Ok(())), "{step}");
    }
}

/// Exponents of powers of powers are no larger than the algebra holds.
#[test]
fn powers_of_powers_are_derived() {
    let power = |base: &str| (0..5).fold(base.to_owned(), |power, _| format!("({power})^100"));
    for base in ["sin(q/l)", "sin(q/l)*cos(q/l)", "1/(1 + (q/l)^2)"] {
        let text = format!(
            "mechanism Num;
            parameters {{ m: kg = 1, l: m = 1, k: N = 1 }}
            coordinates {{ q: m = 0.999 }}
            speeds {{ u: m/s }}
            points {{ P = O + q*N.x; }}
            particles {{ A {{ point: P, mass: m }} }}
            loads {{ force on P: k*{}*N.x; }}",
            power(base)
        );
        assert_eq!(outcome(&text), Some(Ok(())), "{base}");
    }
}
