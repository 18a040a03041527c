//! `check`, `derive` and `expand`: files, directories, Rust files with inline models.

use std::fs;
use std::path::Path;

use crate::common::{Run, hodograph, model};

const ROD: &str = "mechanism Rod;\nparameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }\ncoordinates { q1: rad = 0.3 }\n\
    speeds { u1: rad/s }\nframes { B = N.rotate(z, q1); }\npoints { G = O - l/2*B.y; P = O - l*B.y; }\n\
    bodies { Rod1 { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }\nloads { gravity: -g*N.y; }\n\
    contacts { tip { point: P of Rod1, normal: -N.x } }\n";

fn run(arguments: &[&str]) -> Run {
    hodograph(arguments, "")
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

#[test]
fn shipped_models_are_accepted_and_fresh() {
    let models = text(&crate::common::root().join("models"));
    let checked = run(&["check", &models]);
    assert_eq!(checked.code, 0, "{}", checked.stdout);
    // not every model is for simulation
    let said = checked.stdout.lines().filter(|line| line.starts_with("warning") || line.starts_with("error"));
    let others: Vec<&str> = said.filter(|line| !line.starts_with("warning[W014]")).collect();
    assert!(others.is_empty(), "{}", checked.stdout);
    let fresh = run(&["derive", "--check", &models]);
    assert_eq!(fresh.code, 0, "{}", fresh.stdout);
}

#[test]
fn all_mistakes_are_reported_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rod.mech");
    fs::write(&path, ROD.replace("m/s^2 = 9.81", "m = 9.81").replace("mass: m,", "mass: mm,")).unwrap();
    let checked = run(&["check", &text(&path)]);
    assert_eq!(checked.code, 1);
    assert!(
        checked.stdout.contains("rod.mech:7:") && checked.stdout.contains("rod.mech:8:"),
        "{}",
        checked.stdout
    );
    let evaluated = run(&["eval", &text(&path)]);
    assert_eq!(evaluated.code, 1);
    assert!(evaluated.stdout.is_empty() && evaluated.stderr.contains("rod.mech:7:"), "{}", evaluated.stderr);
    assert_eq!(run(&["check", "no/such.mech"]).code, 2);
    assert_eq!(run(&["check", &text(folder.path())]).code, 1);
    fs::remove_file(&path).unwrap();
    assert_eq!(run(&["check", &text(folder.path())]).code, 2, "no model at all");
}

#[test]
fn a_model_should_be_called_as_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stick.mech");
    fs::write(&path, ROD).unwrap();
    let checked = run(&["check", &text(&path)]);
    assert_eq!(checked.code, 0);
    assert!(checked.stdout.contains("should be called rod.mech"), "{}", checked.stdout);
}

#[test]
fn expand_prints_rust() {
    let expanded = run(&["expand", &model("two_sleds")]);
    assert_eq!(expanded.code, 0, "{}", expanded.stderr);
    for part in ["pub mod two_sleds", "pub struct TwoSleds", "pub fn collide_bc_ac", "pub fn mass_matrix"] {
        assert!(expanded.stdout.contains(part), "{part}");
    }
}

#[cfg(feature = "derive")]
mod deriving {
    use super::*;

    #[test]
    fn derivations_are_written_beside_the_model_and_noticed_when_stale() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rod.mech");
        fs::write(&path, ROD).unwrap();
        let kept = folder.path().join("rod.derivation");
        let check = || run(&["derive", "--check", &text(folder.path())]);

        let absent = check();
        assert_eq!(absent.code, 1);
        assert!(
            absent.stdout.contains("rod.derivation is not there; run `hodograph derive"),
            "{}",
            absent.stdout
        );
        let evaluated = run(&["eval", &text(&path)]);
        assert_eq!(evaluated.code, 0, "{}", evaluated.stderr);
        assert!(evaluated.stderr.contains("deriving in memory") && !kept.exists(), "{}", evaluated.stderr);
        assert_eq!(evaluated.stdout.lines().count(), 1, "nothing but the answer");

        let derived = run(&["derive", &text(folder.path())]);
        assert_eq!(derived.code, 0, "{}", derived.stderr);
        assert!(derived.stdout.is_empty(), "{}", derived.stdout);
        assert_eq!(check().code, 0);
        assert!(run(&["eval", &text(&path)]).stderr.is_empty());
        let bytes = fs::read(&kept).unwrap();
        run(&["derive", "--force", &text(folder.path())]);
        assert_eq!(fs::read(&kept).unwrap(), bytes, "the same bytes every time");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "no temporary file is left");

        // Comments, blanks and defaults do not matter: the equations are the same to the byte.
        let other = format!("// a remark\n{ROD}").replace("m = 0.5", "m = 0.6").replace("rad = 0.3", "rad");
        fs::write(&path, other).unwrap();
        assert_eq!(check().code, 0);
        run(&["derive", "--force", &text(folder.path())]);
        assert_eq!(fs::read(&kept).unwrap(), bytes);
        // What is folded into the equations does.
        fs::write(&path, ROD.replace("l: m = 0.5", "fixed l: m = 0.5")).unwrap();
        let stale = check();
        assert_eq!(stale.code, 1);
        assert!(stale.stdout.contains("is stale: it was derived from another text"), "{}", stale.stdout);
        assert!(run(&["eval", &text(&path)]).stderr.contains("is stale"));
        fs::write(&kept, "nonsense").unwrap();
        assert!(check().stdout.contains("is damaged: line 1"), "{}", check().stdout);
    }

    #[test]
    fn a_changed_derivation_is_never_used() {
        let folder = tempfile::tempdir().unwrap();
        let (path, kept) = (folder.path().join("rod.mech"), folder.path().join("rod.derivation"));
        fs::write(&path, ROD).unwrap();
        assert_eq!(run(&["derive", &text(&path)]).code, 0);
        let right = run(&["eval", &text(&path)]).stdout;
        let written = fs::read_to_string(&kept).unwrap();
        fs::write(&kept, written.replacen("number 0.5", "number 0.6", 1)).unwrap();
        let check = run(&["derive", "--check", &text(&path)]);
        assert_eq!(check.code, 1);
        assert!(check.stdout.contains("is damaged: line"), "{}", check.stdout);
        let evaluated = run(&["eval", &text(&path)]);
        assert_eq!((evaluated.code, &evaluated.stdout), (0, &right));
        assert!(evaluated.stderr.contains("is damaged"), "{}", evaluated.stderr);
        // it is renewed without being asked to
        assert_eq!(run(&["derive", &text(&path)]).code, 0);
        assert_eq!(fs::read_to_string(&kept).unwrap(), written);
    }

    #[test]
    fn verification_derives_again() {
        let folder = tempfile::tempdir().unwrap();
        let (path, kept) = (folder.path().join("rod.mech"), folder.path().join("rod.derivation"));
        fs::write(&path, ROD).unwrap();
        let verify = || run(&["derive", "--verify", &text(&path)]);
        let absent = verify();
        assert_eq!(absent.code, 1);
        assert!(absent.stdout.contains("rod.derivation is not there"), "{}", absent.stdout);
        assert!(!kept.exists());
        run(&["derive", &text(&path)]);
        assert_eq!(verify().code, 0);
        // Whoever changes numbers and digest together is found out too.
        let source = hodograph_generator::source::Source::file("rod.mech", ROD);
        let mut artifact =
            hodograph_generator::artifact::decode(&fs::read_to_string(&kept).unwrap()).unwrap();
        artifact.program.guards.clear();
        let hash = hodograph_generator::artifact::model_hash(&source);
        fs::write(&kept, hodograph_generator::artifact::encode(&artifact.program, &hash)).unwrap();
        assert_eq!(run(&["derive", "--check", &text(&path)]).code, 0);
        let other = verify();
        assert_eq!(other.code, 1);
        assert!(
            other.stdout.contains("is not what the model gives: they differ from line"),
            "{}",
            other.stdout
        );
    }

    #[test]
    fn inline_models_are_kept_in_derived() {
        let folder = tempfile::tempdir().unwrap();
        let source = folder.path().join("src/lib.rs");
        fs::create_dir(folder.path().join("src")).unwrap();
        fs::write(folder.path().join("Cargo.toml"), "[package]").unwrap();
        fs::write(&source, format!("//! Rods.\nhodograph::mechanism! {{\n{ROD}}}\n")).unwrap();
        let derived = run(&["derive", &text(&source)]);
        assert_eq!(derived.code, 0, "{}", derived.stderr);
        assert!(folder.path().join("derived/rod.derivation").exists());
        assert_eq!(run(&["derive", "--check", &text(folder.path())]).code, 0);
        fs::write(
            &source,
            format!("\n\nhodograph::mechanism! {{\n{}}}\n", ROD.replace("mass: m,", "mass: mm,")),
        )
        .unwrap();
        let checked = run(&["check", &text(&source)]);
        assert_eq!(checked.code, 1);
        assert!(checked.stdout.contains("lib.rs:10:44"), "places are those of the file: {}", checked.stdout);
    }

    #[test]
    fn models_that_rust_files_name_are_derived_once() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("src")).unwrap();
        fs::write(folder.path().join("Cargo.toml"), "[package]").unwrap();
        fs::write(folder.path().join("rod.mech"), ROD).unwrap();
        let source = folder.path().join("src/lib.rs");
        fs::write(&source, "hodograph::mechanism!(\"rod.mech\");\n").unwrap();
        let derived = run(&["derive", &text(&source)]);
        assert_eq!(derived.code, 0, "{}", derived.stderr);
        assert!(folder.path().join("rod.derivation").exists());
        let checked = run(&["check", &text(folder.path()), &text(&source)]);
        assert_eq!(checked.code, 0, "{}", checked.stdout);
        assert!(checked.stderr.contains("1 model checked"), "{}", checked.stderr);
    }

    #[test]
    fn a_limit_of_no_time_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("arm_7dof.mech");
        fs::copy(model("arm_7dof"), &path).unwrap();
        let derived = run(&["derive", "--time-limit", "0", &text(&path)]);
        assert_eq!(derived.code, 1);
        assert!(derived.stderr.contains("took more than 0 seconds"), "{}", derived.stderr);
    }

    #[test]
    fn many_at_once_take_turns() {
        let folder = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for index in 0..4 {
                let path = folder.path().join(format!("rod{index}.mech"));
                fs::write(&path, ROD.replace("mechanism Rod", &format!("mechanism Rod{index}"))).unwrap();
                scope.spawn(move || {
                    let derived = run(&["derive", &text(&path)]);
                    assert_eq!(derived.code, 0, "{}", derived.stderr);
                });
            }
        });
    }
}

/// One style: written to the file or to standard output, asked for with `--check`, refused where there are
/// mistakes. The hash of the equations stays.
#[test]
fn models_are_laid_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rod.mech");
    let written = ROD.replace("m: kg = 1, l:", "// lengths\n  m:kg=1,   l:");
    fs::write(&path, &written).unwrap();
    let asked = run(&["fmt", "--check", &text(&path)]);
    assert_eq!((asked.code, asked.stdout.trim()), (1, text(&path).as_str()), "{}", asked.stderr);
    assert_eq!(fs::read_to_string(&path).unwrap(), written);
    assert_eq!(run(&["derive", &text(&path)]).code, 0);
    let laid_out = run(&["fmt", &text(folder.path())]);
    assert_eq!(laid_out.code, 0, "{}", laid_out.stderr);
    let now = fs::read_to_string(&path).unwrap();
    assert!(now.contains("parameters {\n    // lengths\n    m: kg    = 1,\n    l: m     = 0.5,\n"), "{now}");
    assert_eq!(run(&["derive", "--check", &text(&path)]).code, 0, "the derivation is fresh");
    assert_eq!(run(&["fmt", "--check", &text(&path)]).code, 0);
    let streamed = hodograph(&["fmt", "-"], &written);
    assert_eq!((streamed.code, streamed.stdout), (0, now));
    assert_eq!(hodograph(&["fmt", "--check", "-"], &written).code, 1);
    // what cannot be read stays as it is
    fs::write(&path, "mechanism A;\nframes { A = ; }\n").unwrap();
    let refused = run(&["fmt", &text(&path)]);
    assert_eq!((refused.code, refused.stderr.contains("rod.mech:2:")), (1, true), "{}", refused.stderr);
    assert_eq!(fs::read_to_string(&path).unwrap(), "mechanism A;\nframes { A = ; }\n");
    assert_eq!(run(&["fmt", "no/such.mech"]).code, 2);
    assert_eq!(run(&["fmt", "-", &text(&path)]).code, 2);
}
