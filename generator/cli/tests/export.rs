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
    std::fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let target = root().join("target/tmp/downstream");
    let mut cargo = Command::new(env!("CARGO"));
    output(cargo.args(["build", "--offline", "--target-dir", target.to_str().unwrap()]), folder);
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
    // The last line of this name is the call whose answer stands where its argument stood.
    let again = answer.lines().filter(|line| line.starts_with("accelerations ")).collect::<Vec<_>>();
    assert_eq!(again.len(), 2);
    assert_eq!(again[0], again[1]);
}

/// The program of a library's README prints its number, and two mechanisms are in one program: as shared libraries,
/// and as objects of which only the functions of the headers are seen from outside.
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
    let headers = models.iter().map(|model| {
        let exported = export(model, folder.path(), &[]);
        std::fs::read_dir(exported.join("include")).unwrap().next().unwrap().unwrap().path()
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
