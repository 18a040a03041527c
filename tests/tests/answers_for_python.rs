//! What generated modules answer, bit by bit, for the tests of the Python package (`bindings/python/test`): lines of `model
//! routine row bits..`; states come first.

use std::fmt::Write;
use std::path::Path;

use hodograph::{ComponentKind, Contacts, Law, State, Surface};

macro_rules! models {
    ($($name:literal $module:ident $mechanism:ident,)*) => {
        vec![$(($name, Box::new(hodograph_models::$module::$mechanism::<f64>::default()) as Box<dyn Contacts>)),*]
    };
}

fn models() -> Vec<(&'static str, Box<dyn Contacts>)> {
    hodograph_models::every_mechanism!(models)
}

fn line(text: &mut String, model: &str, routine: &str, row: usize, numbers: &[f64]) {
    let bits: Vec<String> = numbers.iter().map(|number| format!("{:016x}", number.to_bits())).collect();
    writeln!(text, "{model} {routine} {row} {}", bits.join(" ")).expect("written");
}

/// A number between -1 and 1.
fn number(row: usize, index: usize) -> f64 {
    ((row * 71 + index * 13 + 5) as f64 * 0.618_033_988_749_895).fract() * 2.0 - 1.0
}

#[test]
#[ignore = "writes a file for the tests of the Python package"]
fn answers_are_written_for_python() {
    let mut text = String::new();
    for (model, m) in models() {
        let [n, p, w] =
            [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input].map(|kind| m.count(kind));
        let (mut q0, mut u0, mut inputs) = (vec![0.0; n], vec![0.0; p], vec![0.0; w]);
        m.initial_state(&mut q0, &mut u0, &mut inputs).expect("an initial state");
        for row in 0..40 {
            let q: Vec<f64> = (0..n).map(|index| q0[index] + 0.2 * number(row, index)).collect();
            let u: Vec<f64> = (0..p).map(|index| u0[index] + 2.0 * number(row, index + 100)).collect();
            let inputs: Vec<f64> = (0..w).map(|index| number(row, index + 200)).collect();
            let state = State { time: 0.1 * row as f64, coordinates: &q, speeds: &u, inputs: &inputs };
            line(&mut text, model, "q", row, &q);
            line(&mut text, model, "u", row, &u);
            line(&mut text, model, "inputs", row, &inputs);
            let mut answer = |routine: &str, size: usize, write: &dyn Fn(&mut [f64]) -> bool| {
                let mut numbers = vec![0.0; size];
                if write(&mut numbers) {
                    line(&mut text, model, routine, row, &numbers);
                }
            };
            answer("accelerations", p, &|x| m.accelerations(&state, x).is_ok());
            answer("mass_matrix", p * p, &|x| m.mass_matrix(&state, x).is_ok());
            answer("forcing", p, &|x| m.forcing(&state, x).is_ok());
            answer("coordinate_rates", n, &|x| m.coordinate_rates(&state, x).is_ok());
            answer("inverse_dynamics", p, &|x| m.inverse_dynamics(&state, &u, x).is_ok());
            for contact in 0..m.count(ComponentKind::Contact) {
                let surface = Surface { mu: 0.1 * (row % 8) as f64, e: 0.7, law: Law::Stronge };
                answer(&format!("collide{contact}"), p, &|x| m.collide(contact, &state, &surface, x).is_ok());
            }
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bindings/python/target");
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("reference.txt"), text).expect("written");
}
