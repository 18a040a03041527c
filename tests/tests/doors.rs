//! The same twenty states through every door: `tests/data/doors` holds states of the double pendulum with their
//! accelerations and kinetic energies, and each door's own test gives these bits: here the generated module and the
//! interpreter; the command line tool and C (`generator/cli/tests`), Python, CasADi, FMI, SQL and the page.

//!
//! And bad input through every door: `tests/data/doors/errors.json` has a row for each mistake with the call that
//! makes it, the kind of the error and words that its message has. Each door's own test takes the rows that name it.

use hodograph::{ComponentKind, Contacts, Law, Mechanism, State, Surface};
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};
use hodograph_models::planar_double_pendulum::PlanarDoublePendulum;
use hodograph_simulation::{Options, Simulation};
use serde_json::Value;

use crate::common::root;

#[allow(missing_docs)]
mod emitted {
    hodograph::mechanism!("data/doors/errors.mech");
}

/// The rows of the table: q1, q2, u1, u2, u1', u2', kinetic energy.
fn rows() -> Vec<[f64; 7]> {
    let text = std::fs::read_to_string(root().join("tests/data/doors/planar_double_pendulum.csv")).unwrap();
    let row = |line: &str| -> [f64; 7] {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        numbers.try_into().unwrap()
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn twenty_states_have_the_same_bits_through_every_door() {
    let path = root().join("models/planar_double_pendulum.mech");
    let interpreted = InterpretedMechanism::read(&path).unwrap();
    let numeric = NumericMechanism::new(interpreted.model().clone()).unwrap();
    let generated = PlanarDoublePendulum::<f64>::default();
    let rows = rows();
    assert_eq!(rows.len(), 20);
    for [q1, q2, u1, u2, expected @ ..] in rows {
        let (q, u) = ([q1, q2], [u1, u2]);
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
        let answer = |mechanism: &dyn Mechanism| {
            let mut rates = [0.0; 2];
            mechanism.accelerations(&state, &mut rates).unwrap();
            [rates[0], rates[1], mechanism.kinetic_energy(&state).unwrap()]
        };
        let bits = |numbers: [f64; 3]| numbers.map(f64::to_bits);
        assert_eq!(bits(answer(&generated)), bits(expected), "{q:?} {u:?}");
        assert_eq!(bits(answer(&interpreted)), bits(expected), "{q:?} {u:?}");
        // Evaluated without equations they agree but for rounding.
        for (found, expected) in answer(&numeric).into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-11 * expected.abs().max(1.0), "{found} {expected}");
        }
    }
}

/// All mistakes.
fn mistakes() -> Vec<Value> {
    let text = std::fs::read_to_string(root().join("tests/data/doors/errors.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn is_of(mistake: &Value, door: &str) -> bool {
    mistake["doors"].as_array().unwrap().iter().any(|other| other == door)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

/// Kind and words of what a mechanism says of a mistake.
fn told(mechanism: &mut dyn Contacts, mistake: &Value) -> (&'static str, String) {
    let zeros = |kind| vec![0.0; mechanism.count(kind)];
    let mut parameters = zeros(ComponentKind::Parameter);
    let (mut q, mut u) = (zeros(ComponentKind::Coordinate), zeros(ComponentKind::Speed));
    let mut inputs = zeros(ComponentKind::Input);
    mechanism.parameter_values(&mut parameters).unwrap();
    mechanism.initial_state(&mut q, &mut u, &mut inputs).unwrap();
    for (section, kind, numbers) in [
        ("parameters", ComponentKind::Parameter, &mut parameters),
        ("q", ComponentKind::Coordinate, &mut q),
        ("u", ComponentKind::Speed, &mut u),
    ] {
        for (name, value) in mistake[section].as_object().into_iter().flatten() {
            numbers[mechanism.index(kind, name).unwrap()] = number(value);
        }
    }
    if let Some(count) = mistake["count"].as_u64() {
        q.truncate(count as usize);
    }
    if let Err(error) = mechanism.set_parameter_values(&parameters) {
        return (error.kind(), error.to_string());
    }
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
    let mut speeds = vec![0.0; u.len()];
    if mistake["call"] == "accelerations" {
        let error = mechanism.accelerations(&state, &mut speeds).unwrap_err();
        return (error.kind(), error.to_string());
    }
    // Contacts go by number here: one that is not there has the number after the last.
    let contact = mistake["contact"].as_str().unwrap_or("floor");
    let count = mechanism.count(ComponentKind::Contact);
    let contact = mechanism.index(ComponentKind::Contact, contact).unwrap_or(count);
    let surface = match mistake["law"].as_str().map(Law::read) {
        None => None,
        Some(Ok(law)) => Some(Surface { mu: number(&mistake["mu"]), e: number(&mistake["e"]), law }),
        Some(Err(error)) => return (error.kind(), error.to_string()),
    };
    if mistake["call"] == "collide" {
        let error = mechanism.collide(contact, &state, &surface.unwrap(), &mut speeds).unwrap_err();
        return (error.kind(), error.to_string());
    }
    let mut options = Options::default();
    options.surfaces.extend(surface.map(|surface| (contact, surface)));
    if let Some(tolerance) = mistake["tolerance"].as_f64() {
        options.relative_tolerance = tolerance;
    }
    let begun = Simulation::new(&*mechanism, &state, options);
    let error = match begun {
        Ok(mut simulation) => simulation.advance(0.1).unwrap_err(),
        Err(error) => error,
    };
    (error.kind.name(), error.to_string())
}

#[test]
fn bad_input_has_the_errors_of_every_door() {
    let path = root().join("tests/data/doors/errors.mech");
    let interpreted = InterpretedMechanism::read(&path).unwrap();
    let numeric = NumericMechanism::new(interpreted.model().clone()).unwrap();
    let mut count = 0;
    for mistake in mistakes().iter().filter(|mistake| is_of(mistake, "rust")) {
        let mechanisms: [Box<dyn Contacts>; 3] = [
            Box::new(emitted::errors::Errors::<f64>::default()),
            Box::new(interpreted.clone()),
            Box::new(numeric.clone()),
        ];
        for (mut mechanism, road) in mechanisms.into_iter().zip(["generated", "interpreted", "numeric"]) {
            let (kind, words) = told(&mut *mechanism, mistake);
            assert_eq!(kind, mistake["kind"], "{road}, {}: {words}", mistake["name"]);
            let expected = mistake["words"].as_str().unwrap();
            // What a singular state lacks is known from the equations.
            let expected = if road == "numeric" { expected.split(": ").next().unwrap() } else { expected };
            assert!(words.contains(expected), "{road}, {}: {words}", mistake["name"]);
        }
        count += 1;
    }
    assert!(count > 15, "{count}");
}

/// The table of `docs/doors.md`. `HODOGRAPH_UPDATE=1 cargo test -p hodograph-tests --test all doors::` writes it anew.
#[test]
fn the_table_of_bad_input_is_documented() {
    const DOORS: [(&str, &str); 8] = [
        ("rust", "Rust"),
        ("tool", "tool"),
        ("python", "Python"),
        ("casadi", "CasADi"),
        ("c", "C"),
        ("motion", "motions in C"),
        ("sql", "SQL"),
        ("fmu", "FMI"),
    ];
    let path = root().join("docs/doors.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let head = "| bad input | kind | words | doors that can be given it |\n| --- | --- | --- | --- |\n";
    let rows: String = mistakes()
        .iter()
        .map(|mistake| {
            let of = |field: &str| mistake[field].as_str().unwrap().to_owned();
            let doors = DOORS.iter().filter(|(door, _)| is_of(mistake, door)).map(|(_, name)| *name);
            let doors: Vec<&str> = doors.collect();
            format!("| {} | `{}` | {} | {} |\n", of("name"), of("kind"), of("words"), doors.join(", "))
        })
        .collect();
    let (before, rest) = page.split_once(head).expect("the head of the table");
    let after = rest.find("\n\n").map_or("", |end| &rest[end + 1..]);
    let expected = format!("{before}{head}{rows}{after}");
    if page != expected && std::env::var_os("HODOGRAPH_UPDATE").is_some() && std::env::var_os("CI").is_none()
    {
        std::fs::write(&path, &expected).unwrap();
        return;
    }
    assert!(page == expected, "run `HODOGRAPH_UPDATE=1 cargo test -p hodograph-tests --test all doors::`");
}
