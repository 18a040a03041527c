//! The numeric evaluation of models reproduces numbers that were computed outside this project, for every
//! shipped mechanism.

use std::path::{Path, PathBuf};

use hodograph_generator::model::mechanism::{Mechanism, Variable};
use hodograph_generator::numeric::{self, Evaluation, State};
use hodograph_generator::{check::check, files};
use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map_or(Vec::new(), |list| list.iter().filter_map(Value::as_f64).collect())
}

fn names(value: &Value) -> Vec<&str> {
    value.as_array().map_or(Vec::new(), |list| list.iter().filter_map(Value::as_str).collect())
}

fn index(list: &[Variable], name: &str) -> usize {
    list.iter().position(|q| q.name == name).unwrap_or_else(|| panic!("no quantity {name}"))
}

fn mechanism(name: &str) -> Mechanism {
    let path = root().join("models").join(format!("{name}.mech"));
    let source = files::model(&path);
    let checked = check(&source);
    let messages: Vec<String> = checked.diagnostics.iter().map(|d| d.one_line(&source)).collect();
    checked.mechanism.unwrap_or_else(|| panic!("{}", messages.join("\n")))
}

/// Largest difference over largest entry.
fn difference(what: &str, got: &[f64], want: &[f64]) -> f64 {
    assert_eq!(got.len(), want.len(), "{what}: lengths");
    let size = want.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let off = got.iter().zip(want).fold(0.0_f64, |m, (g, w)| m.max((g - w).abs()));
    if off == 0.0 { 0.0 } else { off / size.max(1e-3) }
}

fn compare(m: &Mechanism, data: &Value, state: &Value) -> f64 {
    let mut given = State::of(m);
    for section in ["params", "inputs"] {
        for (name, value) in data[section].as_object().into_iter().flatten() {
            let value = value.as_f64().expect("a number");
            match m.parameters.iter().position(|p| p.name == *name) {
                Some(i) => given.parameters[i] = value,
                None => given.inputs[index(&m.inputs, name)] = value,
            }
        }
    }
    given.time = state["t"].as_f64().unwrap_or(0.0);
    let coordinates = names(&data["q"]);
    for (name, value) in coordinates.iter().zip(numbers(&state["q"])) {
        given.coordinates[index(&m.coordinates, name)] = value;
    }
    for (name, value) in names(&data["u_ind"]).iter().zip(numbers(&state["u_ind"])) {
        given.speeds[index(&m.speeds, name)] = value;
    }
    let got = numeric::evaluate(m, &given).unwrap_or_else(|e| panic!("{}: {e}", m.name));
    let mut worst = 0.0_f64;
    let mut check = |what: &str, got: &[f64], want: &[f64]| {
        let off = difference(what, got, want);
        assert!(off < 1e-11, "{} {what}: off by {off:e}\n  got {got:?}\n want {want:?}", m.name);
        worst = worst.max(off);
    };
    let flat = |rows: &[Vec<f64>]| rows.iter().flatten().copied().collect::<Vec<f64>>();
    let flat_json =
        |rows: &Value| rows.as_array().into_iter().flatten().flat_map(numbers).collect::<Vec<f64>>();
    check("mass matrix", &flat(&got.mass_matrix), &flat_json(&state["M"]));
    check("forcing", &got.forcing, &numbers(&state["forcing"]));
    let rates: Vec<f64> = coordinates.iter().map(|name| got.rates[index(&m.coordinates, name)]).collect();
    check("rates", &rates, &numbers(&state["qdot"]));
    let dependent: Vec<f64> =
        names(&data["u_dep"]).iter().map(|name| got.speeds[index(&m.speeds, name)]).collect();
    check("dependent speeds", &dependent, &numbers(&state["u_dep"]));
    check("kinetic energy", &[got.kinetic_energy], &[state["kinetic_energy"].as_f64().expect("energy")]);
    contacts(m, &got, state, &mut check);
    worst
}

fn contacts(m: &Mechanism, got: &Evaluation, state: &Value, check: &mut impl FnMut(&str, &[f64], &[f64])) {
    for (name, want) in state["contacts"].as_object().into_iter().flatten() {
        let i =
            m.contacts.iter().position(|c| c.name == *name).unwrap_or_else(|| panic!("no contact {name}"));
        let contact = &got.contacts[i];
        check(&format!("{name} normal"), &contact.normal, &numbers(&want["n"]));
        // along the contact's own basis, where there is one: a contact without slip has none
        let basis: Vec<Vec<f64>> = ["n", "t", "s"].iter().map(|axis| numbers(&want[*axis])).collect();
        if basis.iter().any(|axis| axis.len() != 3) {
            continue;
        }
        let along =
            |v: [f64; 3]| basis.iter().map(move |axis| axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]);
        let columns: Vec<Vec<f64>> = contact.partial_velocities.iter().map(|v| along(*v).collect()).collect();
        let rows: Vec<f64> = (0..3).flat_map(|k| columns.iter().map(move |column| column[k])).collect();
        let want_rows: Vec<f64> = want["V"].as_array().into_iter().flatten().flat_map(numbers).collect();
        check(&format!("{name} V"), &rows, &want_rows);
        let velocity: Vec<f64> = along(contact.velocity).collect();
        let want_velocity: Vec<f64> =
            ["v_n1", "v_t1", "v_s1"].iter().map(|key| want[*key].as_f64().expect("a number")).collect();
        check(&format!("{name} velocity"), &velocity, &want_velocity);
        let remainder: Vec<f64> = along(contact.remainder).collect();
        if want["v_remainder_nts"].is_array() {
            check(&format!("{name} remainder"), &remainder, &numbers(&want["v_remainder_nts"]));
        }
    }
}

#[test]
fn all_mechanisms() {
    let mut count = 0;
    for folder in ["reference", "independent"] {
        let mut files: Vec<PathBuf> = std::fs::read_dir(root().join("tests/data").join(folder))
            .expect("data")
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.extension().is_some_and(|e| e == "json"))
            .collect();
        files.sort();
        for file in files {
            let text = std::fs::read_to_string(&file).expect("text");
            let data: Value = serde_json::from_str(&text).expect("JSON");
            let name = file.file_stem().and_then(|s| s.to_str()).expect("a name");
            let m = mechanism(name);
            for state in data["states"].as_array().expect("states") {
                let worst = compare(&m, &data, state);
                println!("{name}: {worst:.1e}");
                count += 1;
            }
        }
    }
    assert_eq!(count, 44, "states");
}

/// At random states: velocities of points are the rates of their positions, power balances.
#[test]
fn identities() {
    for name in ["arm_7dof", "rolling_disc", "spring_damper_cart_rod", "four_bar", "cart_5_link"] {
        let m = mechanism(name);
        let mut state = State::of(&m);
        for (i, q) in state.coordinates.iter_mut().enumerate() {
            *q += 0.3 + 0.17 * i as f64;
        }
        for (i, u) in state.speeds.iter_mut().enumerate() {
            *u = 0.4 - 0.23 * i as f64;
        }
        let now = numeric::evaluate(&m, &state).unwrap_or_else(|e| panic!("{name}: {e}"));
        let udot = solve(&now.mass_matrix, &now.forcing);
        let h = 1e-5;
        let step = |s: f64| {
            let mut moved = state.clone();
            moved.time += s * h;
            moved.coordinates.iter_mut().zip(&now.rates).for_each(|(q, r)| *q += s * h * r);
            moved.speeds.iter_mut().zip(&udot).for_each(|(u, d)| *u += s * h * d);
            numeric::evaluate(&m, &moved).expect("near")
        };
        let (after, before) = (step(1.0), step(-1.0));
        let rate = (after.kinetic_energy - before.kinetic_energy) / (2.0 * h);
        assert!((rate - now.power).abs() < 1e-6 * (1.0 + now.power.abs()), "{name}: {rate} {}", now.power);
        for (i, velocity) in now.velocities.iter().enumerate() {
            let (Some(a), Some(b)) = (after.positions[i], before.positions[i]) else { continue };
            for k in 0..3 {
                let v = (a[k] - b[k]) / (2.0 * h);
                let material = matches!(
                    m.points[i].place,
                    hodograph_generator::model::mechanism::Place::Material { .. }
                );
                assert!(
                    material || (v - velocity[k]).abs() < 1e-6 * (1.0 + v.abs()),
                    "{name}: {}",
                    m.points[i].name
                );
            }
        }
    }
}

fn solve(a: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut rows: Vec<Vec<f64>> =
        a.iter().zip(b).map(|(r, b)| r.iter().copied().chain([*b]).collect()).collect();
    for k in 0..n {
        let (above, below) = rows.split_at_mut(k + 1);
        for row in below {
            let factor = row[k] / above[k][k];
            row.iter_mut().zip(&above[k]).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        x[k] = (rows[k][n] - (k + 1..n).map(|j| rows[k][j] * x[j]).sum::<f64>()) / rows[k][k];
    }
    x
}
