//! The derived equations agree with numbers computed elsewhere (see `tests/data/README.md`).

use crate::common::{Model, Reference, difference, number, numbers, references};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::{ContactQuantity as C, Quantity as Q};
use serde_json::Value;

/// Compares one quantity and keeps what is too far off.
struct Judge {
    place: String,
    faults: Vec<String>,
}

impl Judge {
    fn compare(&mut self, what: &str, ours: &[f64], theirs: &[f64], bound: f64) {
        let error = difference(ours, theirs);
        if error.is_nan() || error > bound {
            self.faults.push(format!("{} {what}: {error:.1e}\n  {ours:?}\n  {theirs:?}", self.place));
        }
    }
}

#[test]
fn states_of_mechanisms() {
    let mut faults = Vec::new();
    let references = references();
    assert_eq!(references.len(), 22);
    for reference in &references {
        let model = Model::load(&reference.name);
        for (index, state) in reference.states().iter().enumerate() {
            let mut judge = Judge { place: format!("{} state {index}", model.name), faults: Vec::new() };
            compare_state(&model, reference, state, &mut judge);
            faults.append(&mut judge.faults);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn compare_state(model: &Model, reference: &Reference, state: &Value, judge: &mut Judge) {
    let inputs = reference.inputs(model, state);
    let get = |quantity| model.get(&inputs, quantity).values;
    judge.compare("mass matrix", &get(Q::MassMatrix), &numbers(&state["M"]), 1e-12);
    judge.compare("forcing", &get(Q::Forcing), &numbers(&state["forcing"]), 1e-11);
    judge.compare("accelerations", &get(Q::Accelerations), &numbers(&state["udot"]), 1e-10);
    judge.compare("coordinate rates", &get(Q::CoordinateRates), &numbers(&state["qdot"]), 1e-12);
    judge.compare("kinetic energy", &get(Q::KineticEnergy), &[number(&state["kinetic_energy"])], 1e-12);
    if model.mechanism.speeds.len() > model.freedom() {
        judge.compare("dependent speeds", &get(Q::DependentSpeeds), &numbers(&state["u_dep"]), 1e-12);
        if !state["udot_dep"].is_null() {
            let theirs = numbers(&state["udot_dep"]);
            judge.compare("dependent accelerations", &get(Q::DependentAccelerations), &theirs, 1e-10);
        }
    }
    let contacts = &model.mechanism.contacts;
    assert_eq!(state["contacts"].as_object().map(|contacts| contacts.len()), Some(contacts.len()));
    for (index, contact) in contacts.iter().enumerate() {
        compare_contact(
            model,
            &inputs,
            index as u32,
            &contact.name,
            &state["contacts"][&contact.name],
            judge,
        );
    }
}

fn compare_contact(model: &Model, inputs: &Inputs, index: u32, name: &str, data: &Value, judge: &mut Judge) {
    let get = |quantity| model.get(inputs, Q::Contact(index, quantity)).values;
    let basis = [get(C::Normal), get(C::First), get(C::Second)];
    let axes = ["n", "t", "s"].map(|axis| numbers(&data[axis]));
    judge.compare(&format!("{name} n"), &basis[0], &axes[0], 1e-12);
    // Ours are along the contact basis; theirs along n, t, s.
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let turn: Vec<Vec<f64>> =
        axes.iter().map(|axis| basis.iter().map(|ours| dot(axis, ours)).collect()).collect();
    let p = model.freedom();
    let v = get(C::PartialVelocities);
    let column = |j: usize| [v[j], v[p + j], v[2 * p + j]];
    let turned: Vec<f64> =
        turn.iter().flat_map(|row| (0..p).map(|j| dot(row, &column(j))).collect::<Vec<_>>()).collect();
    judge.compare(&format!("{name} V"), &turned, &numbers(&data["V"]), 1e-12);
    let [nn, n1, n2, m11, m12, m22] = get(C::Reduced)[..] else { panic!("six entries") };
    let m = [[nn, n1, n2], [n1, m11, m12], [n2, m12, m22]];
    let entry = |a: &[f64], b: &[f64]| -> f64 { dot(a, &m.map(|row| dot(&row, b))) };
    let reduced: Vec<f64> =
        turn.iter().flat_map(|a| turn.iter().map(|b| entry(a, b)).collect::<Vec<_>>()).collect();
    judge.compare(&format!("{name} reduced"), &reduced, &numbers(&data["reduced"]), 1e-12);
    let velocity = get(C::Velocity);
    let velocity: Vec<f64> = turn.iter().map(|row| dot(row, &velocity)).collect();
    let theirs = ["v_n1", "v_t1", "v_s1"].map(|key| number(&data[key]));
    judge.compare(&format!("{name} velocity"), &velocity, &theirs, 1e-12);
    let remainder = get(C::Remainder);
    if !remainder.is_empty() {
        let remainder: Vec<f64> = turn.iter().map(|row| dot(row, &remainder)).collect();
        let theirs = numbers(&data["v_remainder_nts"]);
        judge.compare(&format!("{name} remainder"), &remainder, &theirs, 1e-12);
    }
}
