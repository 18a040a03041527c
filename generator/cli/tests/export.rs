//! `hodograph export --c`: the crate builds, a C program that calls it gets the answers of the tool, and
//! every header is C and C++.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{hodograph, root};

/// Exports a model to a folder of its own, and gives the folder.
fn export(model: &Path, into: &Path, options: &[&str]) -> PathBuf {
    let folder = into.join(model.file_stem().unwrap());
    let runtime = root().join("runtime");
    let mut call = vec!["export", "--c", model.to_str().unwrap(), "-o", folder.to_str().unwrap()];
    call.extend(["--hodograph", runtime.to_str().unwrap()]);
    call.extend(options);
    let run = hodograph(&call, "");
    assert_eq!((run.code, run.stdout.as_str()), (0, ""), "{}", run.stderr);
    folder
}

fn output(command: &mut Command, folder: &Path) -> Output {
    for (key, _) in std::env::vars_os() {
        let key = key.to_string_lossy().into_owned();
        if key.starts_with("CARGO_") && key != "CARGO_HOME" || key == "RUSTFLAGS" {
            command.env_remove(key);
        }
    }
    let output = command.current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{command:?}\n{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// Builds the crate in the folder with the workspace's versions of its dependencies, where the other crates
/// of tests are built.
fn build(folder: &Path) -> PathBuf {
    build_with(folder, &[])
}

/// As [`build`], with more arguments for cargo.
fn build_with(folder: &Path, more: &[&str]) -> PathBuf {
    std::fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fixtures");
    let mut cargo = Command::new(env!("CARGO"));
    output(cargo.args(["build", "--offline", "--target-dir", target.to_str().unwrap()]).args(more), folder);
    target
}

/// Every number of a field of a line of JSON, one after the other.
fn numbers(value: &serde_json::Value) -> Vec<f64> {
    match value {
        serde_json::Value::Number(number) => vec![number.as_f64().unwrap()],
        serde_json::Value::Array(values) => values.iter().flat_map(numbers).collect(),
        serde_json::Value::Object(values) => values.values().flat_map(numbers).collect(),
        other => panic!("no number: {other}"),
    }
}

#[test]
fn a_program_in_c_gets_the_answers_of_the_tool() {
    let folder = tempfile::tempdir().unwrap();
    let model = root().join("models/two_sleds.mech");
    let exported = export(&model, folder.path(), &[]);
    let library = build(&exported).join("debug/libtwo_sleds.a");
    let main = root().join("generator/cli/tests/export/main.c");
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-I", "include", "-o", "main"])
        .args([&main, &library]);
    output(cc.args(["-lm", "-lpthread", "-ldl"]), &exported);
    let answer = output(&mut Command::new(exported.join("main")), &exported);
    let answer = String::from_utf8(answer.stdout).unwrap();
    let line = |name: &str| -> Vec<f64> {
        let line = answer.lines().find_map(|line| line.strip_prefix(&format!("{name} "))).unwrap();
        line.split(' ').map(|number| number.parse().unwrap()).collect()
    };
    let model = model.to_str().unwrap();
    let eval = hodograph(&["eval", model], "").line();
    let hit = hodograph(&["collide", model, "--mu", "0.5", "--e", "0.5", "--law", "stronge"], "").line();
    assert_eq!(line("mass_matrix"), numbers(&eval["mass_matrix"]));
    let independent = |of: &serde_json::Value| -> Vec<f64> {
        let speeds = eval["speeds"].as_array().unwrap();
        speeds.iter().flat_map(|speed| numbers(&of[speed.as_str().unwrap()])).collect()
    };
    assert_eq!(line("accelerations"), independent(&eval["udot"]));
    assert_eq!(line("kinetic_energy"), numbers(&eval["kinetic_energy"]));
    // The module knows the structure of its reduced matrix and takes a shorter way than the tool: equal but
    // for rounding.
    for (name, expected) in [
        ("impulse", numbers(&hit["impulse"])),
        ("separation", numbers(&hit["v"])),
        ("speeds", independent(&hit["u_after"])),
        ("energy_change", numbers(&hit["kinetic_energy_change"])),
        ("works", [numbers(&hit["dE"]), numbers(&hit["dEn"])].concat()),
    ] {
        let found = line(name);
        let near =
            |(found, expected): (&f64, &f64)| (found - expected).abs() <= 1e-13 * expected.abs().max(1.0);
        assert!(
            found.len() == expected.len() && found.iter().zip(&expected).all(near),
            "{name} {found:?} {expected:?}"
        );
    }
    assert_eq!(line("position_bc").len(), 3);
    assert_eq!(line("compressions"), numbers(&hit["compressions"]));
    assert_eq!(hit["sensitivity"], serde_json::json!([]));
    assert_eq!(line("sensitivity"), [0.0; 5]);
    assert_eq!(line("energy_gained"), [0.0]);
    assert_eq!(line("selection"), [0.0]);
    // The last line of this name is the call whose answer stands where its argument stood.
    let again = answer.lines().filter(|line| line.starts_with("accelerations ")).collect::<Vec<_>>();
    assert_eq!(again.len(), 2);
    assert_eq!(again[0], again[1]);
}

/// Compiles a program in C against the static library of an exported crate and runs it; gives the rows of
/// numbers that it prints, each with the word before them.
fn run_in_c(exported: &Path, library: &Path, source: &Path, input: &str) -> Vec<(String, Vec<f64>)> {
    let said = said_in_c(exported, library, source, input);
    let row = |line: &str| {
        let (name, rest) = line.split_once(' ').unwrap();
        let numbers = rest.split_whitespace().filter_map(|word| word.parse().ok());
        (name.to_owned(), numbers.collect())
    };
    said.lines().map(row).collect()
}

/// What the program prints.
fn said_in_c(exported: &Path, library: &Path, source: &Path, input: &str) -> String {
    std::fs::write(exported.join("input.txt"), input).unwrap();
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-I", "include", "-o", "program"]);
    output(cc.arg(source).arg(library).args(["-lm", "-lpthread", "-ldl"]), exported);
    let input = std::fs::File::open(exported.join("input.txt")).unwrap();
    let said = output(Command::new(exported.join("program")).stdin(input), exported);
    String::from_utf8(said.stdout).unwrap()
}

/// The rows of a name.
fn rows<'a>(all: &'a [(String, Vec<f64>)], name: &str) -> Vec<&'a [f64]> {
    all.iter().filter(|(of, _)| of == name).map(|(_, numbers)| &**numbers).collect()
}

/// The value of a constant of an enum in a header.
fn constant(header: &str, name: &str) -> f64 {
    let line = header.lines().find_map(|line| line.trim().strip_prefix(&format!("{name} = "))).unwrap();
    line.trim_end_matches(',').parse().unwrap()
}

/// `simulation.c`, the program of the README and Python's ctypes follow the motion of the tool: its events
/// and its end.
#[test]
fn programs_in_c_follow_motions() {
    let folder = tempfile::tempdir().unwrap();
    let model = root().join("models/planar_double_pendulum.mech");
    let exported = export(&model, folder.path(), &[]);
    let built = build_with(&exported, &["--features", "simulation"]).join("debug");
    let library = built.join("libplanar_double_pendulum.a");
    let header = exported.join("include/planar_double_pendulum_simulation.h");
    let header = std::fs::read_to_string(header).unwrap();
    let table = std::fs::read_to_string(root().join("tests/data/doors/planar_double_pendulum.csv")).unwrap();
    let table: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let states: String = table.iter().map(|row| format!("{}\n", row[..4].join(" "))).collect();
    let source = root().join("generator/cli/tests/export/simulation.c");
    let said = run_in_c(&exported, &library, &source, &states);

    let surface = ["--mu", "0.3", "--e", "0.5", "--law", "stronge"];
    let call = ["simulate", model.to_str().unwrap(), "--until", "2", "--format", "json"];
    let lines = hodograph(&[&call[..], &surface].concat(), "").lines();
    let (expected, moments): (Vec<_>, Vec<_>) =
        lines.iter().partition(|line: &&serde_json::Value| line.get("event").is_some());
    // Up to the first collision module and tool compute the same; their collisions differ in rounding.
    let near = |(found, expected): (&f64, &f64)| (found - expected).abs() < 1e-9;
    let events = rows(&said, "event");
    assert!(events.len() == expected.len() && events.len() > 1, "{said:?}");
    assert_eq!(events[0][0], expected[0]["t"].as_f64().unwrap());
    for (event, expected) in events.iter().zip(&expected) {
        let kind = expected["event"].as_str().unwrap().to_uppercase();
        let kind = constant(&header, &format!("PLANAR_DOUBLE_PENDULUM_EVENT_{kind}"));
        assert_eq!(event[1..3], [kind, 0.0]);
        // The wall's normal is -N.x, and its impulse has no part along N.z.
        let impulse = numbers(&expected["impulse"]);
        assert!((event[4] + impulse[0]).abs() < 1e-9 && event[6] == 0.0, "{event:?} {expected}");
        let of_tool = [numbers(&expected["t"]), numbers(&expected["kinetic_energy_change"])].concat();
        assert!([event[0], event[3]].iter().zip(&of_tool).all(near), "{event:?} {expected}");
    }
    let last = moments.last().unwrap();
    let last = [numbers(&last["q"]), numbers(&last["u"])].concat();
    let end = rows(&said, "end")[0];
    assert!(end.len() == 4 && end.iter().zip(&last).all(near), "{end:?} {last:?}");
    assert_eq!(rows(&said, "force"), [[0.0; 3]]);

    // The twenty states of every door.
    let expected: Vec<Vec<f64>> =
        table.iter().map(|row| row[4..].iter().map(|number| number.parse().unwrap()).collect()).collect();
    assert_eq!((rows(&said, "state"), expected.len()), (expected.iter().map(|row| &**row).collect(), 20));

    // "0.05 s: event 0 at contact 0", from the same start with the same surface.
    let readme = std::fs::read_to_string(exported.join("README.md")).unwrap();
    let program = readme.split("```c\n").nth(2).unwrap().split("```").next().unwrap();
    std::fs::write(exported.join("readme.c"), program).unwrap();
    let told = run_in_c(&exported, &library, Path::new("readme.c"), "");
    let times: Vec<f64> = told.iter().map(|(time, _)| time.parse().unwrap()).collect();
    assert_eq!(times, events.iter().map(|event| event[0]).collect::<Vec<_>>());
    assert!(told.iter().zip(&events).all(|((_, numbers), event)| numbers[..] == event[1..3]), "{told:?}");

    // The shared library from Python, without a package, as the documents show it.
    let script = root().join("generator/cli/tests/export/motion.py");
    let documents = std::fs::read_to_string(root().join("docs/doors.md")).unwrap();
    assert!(documents.contains(&std::fs::read_to_string(&script).unwrap()));
    if Command::new("python3").arg("--version").output().is_ok_and(|python| python.status.success()) {
        let mut python = Command::new("python3");
        let said = output(python.arg(script).arg(built.join("libplanar_double_pendulum.so")), &exported);
        let said = String::from_utf8(said.stdout).unwrap();
        let again: Vec<f64> = said.split_whitespace().map(|number| number.parse().unwrap()).collect();
        assert_eq!(again, end);
    } else {
        println!("no python3 here: motion.py was not tried");
    }

    // A function of MATLAB and Octave, as the documents show it: the accelerations of the twenty states.
    let function = root().join("generator/cli/tests/export/planar_double_pendulum_rates.c");
    assert!(documents.contains(&std::fs::read_to_string(&function).unwrap()));
    let answers = |program: &str| {
        Command::new(program).arg("--version").output().is_ok_and(|told| told.status.success())
    };
    if answers("octave-cli") && answers("mkoctfile") {
        let mut compiler = Command::new("mkoctfile");
        output(compiler.args(["--mex", "-Iinclude"]).arg(&function).arg(&library), &exported);
        let states: String = table.iter().map(|row| format!("{};", row[..4].join(" "))).collect();
        let program = format!(
            "for state = [{states}]', printf(\"%.17g %.17g\\n\", planar_double_pendulum_rates(state(1:2), state(3:4))), end\n\
             for bad = {{{{[1 2 3], [0 0]}}, {{[nan 0], [0 0]}}, {{[1 2]}}}}, try, planar_double_pendulum_rates(bad{{1}}{{:}}), \
             catch mistake, disp(['mistake: ' mistake.message]), end, end"
        );
        let mut octave = Command::new("octave-cli");
        let said = output(octave.args(["--no-init-file", "--eval", &program]), &exported);
        let said = String::from_utf8(said.stdout).unwrap();
        let (states, mistakes): (Vec<&str>, Vec<&str>) =
            said.lines().partition(|line| !line.starts_with("mistake"));
        let found: Vec<Vec<f64>> = states
            .iter()
            .map(|line| line.split_whitespace().map(|number| number.parse().unwrap()).collect())
            .collect();
        assert_eq!(found, expected.iter().map(|row| row[..2].to_vec()).collect::<Vec<_>>());
        let of = ["q and u are", "not finite", "the call is"];
        assert!(mistakes.len() == 3 && mistakes.iter().zip(of).all(|(said, of)| said.contains(of)), "{said}");
    } else {
        println!("no Octave with mkoctfile here: planar_double_pendulum_rates.c was not tried");
    }
}

/// Bad input has the errors that every door has: the status is that of the cause, and motions have the words.
#[test]
fn bad_input_has_the_errors_of_every_door() {
    use serde_json::Value;

    let folder = tempfile::tempdir().unwrap();
    let exported = export(&root().join("tests/data/doors/errors.mech"), folder.path(), &[]);
    let library = build_with(&exported, &["--features", "simulation"]).join("debug/liberrors.a");
    let header = std::fs::read_to_string(exported.join("include/errors.h")).unwrap();
    let mistakes: Vec<Value> = serde_json::from_str(&crate::common::data("doors/errors.json")).unwrap();
    let is_of = |mistake: &&Value, door| mistake["doors"].as_array().unwrap().iter().any(|of| of == door);
    let mistakes: Vec<&Value> =
        mistakes.iter().filter(|one| is_of(one, "c") || is_of(one, "motion")).collect();
    let line = |mistake: &&Value| -> String {
        let number = |section: &str, name: &str, default: f64| match &mistake[section][name] {
            Value::Null => default.to_string(),
            Value::String(text) => text.clone(),
            number => number.to_string(),
        };
        let of = |name: &str, default: f64| mistake[name].as_f64().unwrap_or(default);
        let call = ["accelerations", "collide", "simulate"].iter().position(|call| mistake["call"] == *call);
        let law = if mistake["law"] == "hooke" { 9 } else { 0 };
        let mut words =
            vec![(call.unwrap() + 1).to_string(), of("mu", 0.3).to_string(), of("e", 0.5).to_string()];
        words.extend([law.to_string(), of("tolerance", 1e-9).to_string()]);
        let parameters = [("m", 2.0), ("j", 0.1), ("k", 0.15), ("w", 1.0), ("g", 9.81)];
        words.extend(parameters.map(|(name, default)| number("parameters", name, default)));
        words.extend([("s", 1.0), ("z", 0.5), ("a", 0.0)].map(|(name, default)| number("q", name, default)));
        words.extend(
            [("us", 1.0), ("uz", -1.0), ("ua", 0.5)].map(|(name, default)| number("u", name, default)),
        );
        words.join(" ") + "\n"
    };
    let input: String = mistakes.iter().map(line).collect();
    let source = root().join("generator/cli/tests/export/errors.c");
    let said = said_in_c(&exported, &library, &source, &input);
    assert_eq!(said.lines().count(), mistakes.len(), "{said}");
    let (mut statuses, mut words) = (0, 0);
    for (mistake, said) in mistakes.iter().zip(said.lines()) {
        let kind = mistake["kind"].as_str().unwrap();
        match said.split_once(' ') {
            // REFUSED, with a message.
            Some(("-1", message)) => {
                assert!(message.starts_with(&format!("{kind}: ")), "{mistake}: {message}");
                assert!(message.contains(mistake["words"].as_str().unwrap()), "{mistake}: {message}");
                words += 1;
            }
            _ => {
                let status = constant(&header, &format!("ERRORS_{}", kind.to_uppercase()));
                assert_eq!(said.parse::<f64>().unwrap(), status, "{mistake}");
                statuses += 1;
            }
        }
    }
    assert!(statuses > 9 && words > 4, "{statuses} {words}");
}

/// A block with two contacts and an input: it falls (0.1 m), lies, holds 5 N by friction and gives way to
/// 15 N.
#[test]
fn programs_in_c_change_inputs() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("pushed_block.mech");
    std::fs::copy(root().join("generator/cli/tests/export/pushed_block.mech"), &model).unwrap();
    assert_eq!(hodograph(&["derive", model.to_str().unwrap()], "").code, 0);
    let exported = export(&model, folder.path(), &[]);
    let library = build_with(&exported, &["--features", "simulation"]).join("debug/libpushed_block.a");
    let header = std::fs::read_to_string(exported.join("include/pushed_block_simulation.h")).unwrap();
    let source = root().join("generator/cli/tests/export/pushed_block.c");
    let said = run_in_c(&exported, &library, &source, "");
    let (m, g, mu) = (2.0, 9.81, 0.5);
    let events = rows(&said, "event");
    let event = |kind: &str| {
        let kind = constant(&header, &format!("PUSHED_BLOCK_EVENT_{kind}"));
        events.iter().find(|event| event[1] == kind).copied().unwrap()
    };
    let floor = constant(&header, "PUSHED_BLOCK_CONTACT_FLOOR");
    for (kind, time, contact) in [
        ("COLLISION", (0.2_f64 / g).sqrt(), floor),
        ("CONTACT", (0.2_f64 / g).sqrt(), floor),
        ("REST", (0.2_f64 / g).sqrt(), -1.0),
        ("SLIP", 1.0, floor),
    ] {
        let found = event(kind);
        assert!((found[0] - time).abs() < 1e-11 && found[2] == contact, "{kind} {found:?}");
    }
    let rate = 15.0 / m - mu * g;
    let near = |found: &[f64], expected: &[f64]| {
        let all = found.iter().zip(expected).all(|(found, expected)| {
            found == expected || (found - expected).abs() <= 1e-11 * expected.abs().max(1.0)
        });
        assert!(found.len() == expected.len() && all, "{found:?} {expected:?}");
    };
    // Time, x, z, ux, uz, force of the floor (its second tangent is out of the plane), normal force of the
    // wall.
    let moments = rows(&said, "at");
    assert_eq!(moments.len(), 4);
    near(moments[0], &[0.5, 0.0, 0.0, 0.0, 0.0, m * g, 0.0, 0.0, 0.0]);
    near(moments[1], &[0.75, 0.0, 0.0, 0.0, 0.0, m * g, -5.0, 0.0, 0.0]);
    near(moments[2], &[1.0, 0.0, 0.0, 0.0, 0.0, m * g, -5.0, 0.0, 0.0]);
    near(moments[3], &[1.5, rate * 0.125, 0.0, rate * 0.5, 0.0, m * g, -mu * m * g, 0.0, 0.0]);
    // lambda_n, f, cone, s: of a contact that sticks, and of one that slides at 0.25 m/s, whose f is 1/m.
    let margins = rows(&said, "margins");
    near(margins[0], &[m * g, f64::INFINITY, mu * m * g - 5.0, f64::INFINITY]);
    near(margins[1], &[m * g, 1.0 / m, f64::INFINITY, 0.25]);
    // Straight at 1 m/s without restitution: all of its energy, and of the flags that there was no slip.
    near(rows(&said, "impact")[0], &[-m / 2.0, -m / 2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
}

/// The program of a library's README prints its number, and two mechanisms are in one program: as shared
/// libraries, and as objects of which only the functions of the headers are seen from outside.
#[test]
fn several_mechanisms_are_in_one_program() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["two_sleds", "spherical_pendulum"];
    let models = names.map(|name| root().join(format!("models/{name}.mech")));
    let exported = models.each_ref().map(|model| export(model, folder.path(), &[]));
    let built = exported.each_ref().map(|exported| build(exported).join("debug"))[0].clone();
    let energies = models.each_ref().map(|model| {
        let found = hodograph(&["eval", model.to_str().unwrap()], "").line();
        found["kinetic_energy"].as_f64().unwrap()
    });
    // The first block of C in the README.
    let readme = std::fs::read_to_string(exported[0].join("README.md")).unwrap();
    let program = readme.split("```c\n").nth(1).unwrap().split("```").next().unwrap();
    std::fs::write(exported[0].join("main.c"), program).unwrap();
    let flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-I", "include"];
    let mut cc = Command::new("cc");
    cc.args(flags).args(["-o", "main", "main.c"]).arg(built.join("libtwo_sleds.a"));
    output(cc.args(["-lm", "-lpthread", "-ldl"]), &exported[0]);
    let said = output(&mut Command::new(exported[0].join("main")), &exported[0]);
    let said = String::from_utf8(said.stdout).unwrap();
    let energy = said.trim().strip_prefix("kinetic energy ").unwrap().strip_suffix(" J").unwrap();
    assert!((energy.parse::<f64>().unwrap() / energies[0] - 1.0).abs() < 1e-5, "{said}");
    // Both at once.
    let part = |name: &str| {
        let upper = name.to_uppercase();
        format!(
            "    {{\n        {name}_parameters parameters;\n        {name}_coordinates q;\n        {name}_speeds u;\n        {name} mechanism;\n        double energy;\n\n\
             if ({name}_default_parameters(&parameters) != {upper}_OK || {name}_new(&parameters, &mechanism) != {upper}_OK)\n            return 1;\n\
             if ({name}_default_coordinates(&q) != {upper}_OK || {name}_default_speeds(&u) != {upper}_OK)\n            return 2;\n\
             if ({name}_kinetic_energy(&mechanism, &q, &u, &energy) != {upper}_OK)\n            return 3;\n        printf(\"%.17g\\n\", energy);\n    }}\n"
        )
    };
    let includes: String = names.iter().map(|name| format!("#include \"{name}.h\"\n")).collect();
    let both = format!(
        "#include <stdio.h>\n{includes}\nint main(void)\n{{\n{}{}    return 0;\n}}\n",
        part(names[0]),
        part(names[1])
    );
    std::fs::write(folder.path().join("both.c"), both).unwrap();
    let prints_both = |link: &[String]| {
        let mut cc = Command::new("cc");
        cc.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-o", "both", "both.c"]);
        for exported in &exported {
            cc.arg("-I").arg(exported.join("include"));
        }
        output(cc.args(link).args(["-lm", "-lpthread", "-ldl"]), folder.path());
        let said = output(&mut Command::new(folder.path().join("both")), folder.path());
        let said = String::from_utf8(said.stdout).unwrap();
        let numbers: Vec<f64> = said.lines().map(|line| line.parse().unwrap()).collect();
        assert_eq!(numbers, energies);
    };
    let place = built.display().to_string();
    let shared = names.iter().map(|name| format!("-l:lib{name}.so"));
    let shared: Vec<String> =
        [format!("-L{place}"), format!("-Wl,-rpath,{place}")].into_iter().chain(shared).collect();
    prints_both(&shared);
    let objects = names.map(|name| {
        let object = folder.path().join(format!("{name}.o")).display().to_string();
        let library = built.join(format!("lib{name}.a")).display().to_string();
        output(Command::new("ld").args(["-r", "-o", &object, "--whole-archive", &library]), folder.path());
        let kept = format!("{name}_*");
        output(
            Command::new("objcopy").args(["--wildcard", "--keep-global-symbol", &kept, &object]),
            folder.path(),
        );
        object
    });
    prints_both(&objects);
}

/// A mechanism that is called like a word of Rust, with names of other letters: the crate builds, and C has names that
/// every linker takes.
#[test]
fn names_of_any_letters_build() {
    let folder = tempfile::tempdir().unwrap();
    let into = folder.path().join("exported");
    std::fs::create_dir(&into).unwrap();
    for (stem, mechanism) in [("box", "Box"), ("crate", "Crate")] {
        let model = folder.path().join(format!("{stem}.mech"));
        let text = format!(
            "//! ~~~\n//! a box\n//! ~~~\nmechanism {mechanism}; parameters {{ größe: m = 2, m: kg = 1, g: m/s^2 = 9.81 }} \
             coordinates {{ höhe: m = 1 }} speeds {{ v: m/s }} points {{ Fuß = O + höhe*N.y; }} \
             particles {{ Körper {{ point: Fuß, mass: m }} }} loads {{ gravity: -g*N.y; }} kinematics {{ d(höhe)/dt = v; }} \
             contacts {{ stoß {{ point: Fuß, normal: N.y, gap: höhe - größe/4, surface: {{ e: 0.5 }} }} }}"
        );
        std::fs::write(&model, text).unwrap();
        let derived = hodograph(&["derive", model.to_str().unwrap()], "");
        assert_eq!(derived.code, 0, "{}", derived.stderr);
        let exported = export(&model, &into, &[]);
        let headers = std::fs::read_dir(exported.join("include")).unwrap();
        let texts = headers.map(|header| std::fs::read_to_string(header.unwrap().path()).unwrap());
        let header: String = texts.collect();
        let code: String = header.lines().filter(|line| line.contains('(')).collect();
        assert!(code.contains("_gap_stou00df(") && code.contains("_collide_stou00df("), "{header}");
        build(&exported);
    }
}

#[test]
fn every_header_is_c_and_cpp() {
    let folder = tempfile::tempdir().unwrap();
    // Names that C reserves, no parameters at run time, no inputs.
    let reserved = folder.path().join("int.mech");
    let text = "mechanism Int; parameters { fixed m: kg = 2, fixed l: m = 0.5, fixed g: m/s^2 = 9.81 }
        coordinates { int: rad = 0.3, /** */ int_: m = 0 } speeds { double: rad/s = 0, u: m/s = 0 }
        frames { A = N.rotate(z, int); } points { P = O + (l + int_)*A.x; } particles { Bob { point: P, mass: m } }
        loads { gravity: -g*N.y; } kinematics { d(int)/dt = double; d(int_)/dt = u; }
        contacts { auto { point: P, normal: N.x, gap: dot(position(P), N.x) } }";
    std::fs::write(&reserved, text.replace("/** */ ", "")).unwrap();
    assert_eq!(hodograph(&["derive", reserved.to_str().unwrap()], "").code, 0);
    let shipped = std::fs::read_dir(root().join("models")).unwrap().map(|entry| entry.unwrap().path());
    let models = shipped.filter(|path| path.extension().is_some_and(|end| end == "mech"));
    // Names of macros and of the standard library, and those that compilers keep for themselves.
    let taken = folder.path().join("signal.mech");
    let list: String = TAKEN.split_whitespace().map(|name| format!("{name}: 1 = 1, ")).collect();
    let text = format!(
        "mechanism Signal; parameters {{ m: kg = 1, {list} }} coordinates {{ errno: m, INFINITY: m }}
         speeds {{ stdout: m/s, NULL: m/s }} points {{ P = O + errno*N.x + INFINITY*N.y; }}
         particles {{ A {{ point: P, mass: m }} }} kinematics {{ d(errno)/dt = stdout; d(INFINITY)/dt = NULL; }}
         contacts {{ assert {{ point: P, normal: N.x, gap: errno }} }}"
    );
    std::fs::write(&taken, text).unwrap();
    assert_eq!(hodograph(&["derive", taken.to_str().unwrap()], "").code, 0);
    let models: Vec<PathBuf> = models.chain([reserved, taken]).collect();
    assert!(models.len() > 20);
    let headers = models.iter().flat_map(|model| {
        let exported = export(model, folder.path(), &[]);
        let headers = std::fs::read_dir(exported.join("include")).unwrap();
        headers.map(|header| header.unwrap().path()).collect::<Vec<_>>()
    });
    let includes: String = headers.map(|header| format!("#include \"{}\"\n", header.display())).collect();
    // All together, so that their names do not clash either.
    let all = folder.path().join("all.h");
    std::fs::write(&all, format!("#ifdef AMONG_OTHERS\n{STANDARD_HEADERS}#endif\n{includes}")).unwrap();
    for (language, standard, among) in [
        ("c", "c99", false),
        ("c", "gnu99", true),
        ("c", "gnu11", true),
        ("c", "gnu17", true),
        ("c", "c90", false),
        ("c++", "c++98", false),
        ("c++", "c++11", false),
        ("c++", "gnu++20", true),
    ] {
        let mut cc = Command::new("cc");
        cc.args([
            "-x",
            language,
            &format!("-std={standard}"),
            "-Wall",
            "-Wextra",
            "-pedantic",
            "-Werror",
            "-fsyntax-only",
        ]);
        cc.args(among.then_some("-DAMONG_OTHERS")).arg("-D_XOPEN_SOURCE=700");
        output(cc.arg(&all), folder.path());
    }
}

/// Some of what headers define: a macro of each family.
const TAKEN: &str = "EOF NAN linux unix _Bool _Complex __FILE__ __x I complex INT_MAX PATH_MAX ARG_MAX NAME_MAX M_PI near far small stdin stderr and xor \
     nullptr DBL_MAX SIGINT EDOM LC_ALL BUFSIZ CLOCKS_PER_SEC FE_INVALID FP_NAN HUGE_VAL PRId32 RAND_MAX SEEK_SET ATOMIC_FLAG_INIT noreturn alignas \
     thread_local consteval char8_t restrict typename template EXIT_SUCCESS NDEBUG WEOF MB_CUR_MAX TMP_MAX L_tmpnam SIZE_MAX PTRDIFF_MAX O_RDONLY \
     math_errhandling R_OK STDIN_FILENO P_tmpdir st_atime sa_handler bool_ NAN_ printf sin exit time_t size_t FILE";

/// The standard headers that C and C++ have in common, and some of POSIX.
const STANDARD_HEADERS: &str = "#include <assert.h>\n#include <complex.h>\n#include <ctype.h>\n#include <errno.h>\n#include <fenv.h>\n#include <float.h>\n\
     #include <inttypes.h>\n#include <iso646.h>\n#include <limits.h>\n#include <locale.h>\n#include <math.h>\n#include <setjmp.h>\n#include <signal.h>\n\
     #include <stdarg.h>\n#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n\
     #include <tgmath.h>\n#include <time.h>\n#include <wchar.h>\n#include <wctype.h>\n#include <unistd.h>\n#include <fcntl.h>\n#include <sys/stat.h>\n";

#[test]
fn mistakes_of_the_call_are_said_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let there = folder.path().join("there");
    std::fs::create_dir(&there).unwrap();
    let model = root().join("models/two_sleds.mech");
    let model = model.to_str().unwrap();
    let none = folder.path().join("none/at/all");
    let (there, none) = (there.to_str().unwrap(), none.to_str().unwrap());
    let nowhere = folder.path().join("new");
    let nowhere = nowhere.to_str().unwrap();
    for (call, code, says) in [
        (vec!["export", "--c", model, "-o", there], 2, "exists"),
        (vec!["export", "--c", model, "-o", none], 1, "cannot write"),
        (vec!["export", "--c", model, "-o", nowhere, "--hodograph", there], 2, "has no Cargo.toml"),
        (vec!["export", model, "-o", nowhere], 2, "--c"),
        (vec!["export", "--c", "no.mech", "-o", nowhere], 2, "no.mech"),
    ] {
        let run = hodograph(&call, "");
        assert_eq!(run.code, code, "{call:?} {}", run.stderr);
        assert!(run.stderr.contains(says), "{call:?} {}", run.stderr);
    }
    let left: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["there"]);
}
