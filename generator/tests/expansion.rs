//! `mechanism!` as an editor's macro server runs it: many expansions in one process, from several threads at
//! once.
//!
//! Outside of a compiler `proc_macro2` stands in for its tokens, so `expand` can be called here. In the tests
//! of the whole workspace the feature `derive` is on, and then models without a derivation go through the
//! algebra engine.

use std::path::Path;
use std::process::Command;

use hodograph_generator::expand::expand;

/// A model without derivation, told apart by its name.
fn inline(i: usize) -> String {
    format!(
        "(::hodograph) mechanism Pendulum{i}; parameters {{ m: kg = 1, l: m = {}, g: m/s^2 = 9.81 }} coordinates {{ q1: rad }} \
         speeds {{ u1: rad/s }} frames {{ B = N.rotate(z, q1); }} points {{ P = O - l*B.y; }} particles {{ A {{ point: P, mass: m }} }} \
         loads {{ gravity: -g*N.y; }} contacts {{ wall {{ point: P, normal: -N.x }} }}",
        i + 1
    )
}

/// Inputs of all kinds: files with a derivation, a file that is not there, models without a derivation,
/// malformed ones.
fn inputs() -> Vec<String> {
    let file = |path: &str| format!("(::hodograph) \"{path}\"");
    let mut inputs = vec![
        file("../models/two_sleds.mech"),
        file("../models/rolling_disc.mech"),
        file("../models/four_bar.mech"),
        file("../models/no_such.mech"),
        file("tests/diagnostics/many_mistakes.mech"),
        "(::hodograph) mechanism Broken; parameters { m: kg = }".to_owned(),
        String::new(),
    ];
    inputs.extend((0..3).map(inline));
    inputs
}

fn expanded(input: &str) -> String {
    let tokens = input.parse().expect("tokens");
    expand(tokens, Path::new(env!("CARGO_MANIFEST_DIR"))).to_string()
}

fn has_error(code: &str) -> bool {
    code.contains("compile_error")
}

#[test]
fn each_input_is_answered() {
    for (i, input) in inputs().iter().enumerate() {
        let code = expanded(input);
        let derives = cfg!(feature = "derive");
        let sound = i < 3 || i >= 7 && derives;
        assert_eq!(has_error(&code), !sound, "{input}:\n{code}");
        assert!(!code.contains("the generator failed"), "{input}:\n{code}");
        // what the compiler is given can be read, whatever the model was
        syn::parse_str::<syn::File>(&code).unwrap_or_else(|error| panic!("{error} in\n{code}"));
    }
    let absent = expanded(&inline(0));
    if cfg!(not(feature = "derive")) {
        assert!(absent.contains("hodograph derive src/lib.rs"), "{absent}");
    }
}

/// A server that is asked by eight threads for a while answers as one that is asked once.
#[test]
fn many_threads_get_the_same_code() {
    let inputs = inputs();
    let expected: Vec<String> = inputs.iter().map(|input| expanded(input)).collect();
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let (inputs, expected) = (&inputs, &expected);
            scope.spawn(move || {
                for i in 0..inputs.len() {
                    let i = (i + thread) % inputs.len();
                    assert!(expanded(&inputs[i]) == expected[i], "{}", inputs[i]);
                }
            });
        }
    });
}

const CHILD: &str = "HODOGRAPH_TEST_EXPANDS";

/// Run by the test below, in a process of its own: expands everything and ends before the test harness says
/// more.
#[test]
fn expands_in_a_process_of_its_own() {
    if std::env::var_os(CHILD).is_some() {
        inputs().iter().for_each(|input| drop(expanded(input)));
        std::process::exit(0);
    }
}

/// Standard output belongs to the compiler, which speaks JSON there, or to the editor's protocol.
#[test]
fn nothing_is_printed_on_standard_output() {
    let output = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "expansion::expands_in_a_process_of_its_own", "--nocapture", "--test-threads=1"])
        .env(CHILD, "1")
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    let beyond: Vec<&str> =
        said.lines().filter(|line| !line.is_empty() && !line.starts_with("running 1 test")).collect();
    // the harness names the test before it runs it
    assert!(
        beyond.iter().all(|line| *line == "test expansion::expands_in_a_process_of_its_own ... "),
        "{said}"
    );
}
