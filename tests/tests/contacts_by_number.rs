//! Contacts that a module reaches by number alone: the features of two boxes, and of a capsule and a box (docs/theory.md,
//! 16.10 and 16.11).

use hodograph::{Contacts, Law, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_random::Random;

hodograph::mechanism!("../simulation/models/crate_on_table.mech");
hodograph::mechanism!("../simulation/models/log_on_table.mech");

use crate_on_table::CrateOnTable;
use log_on_table::LogOnTable;

/// The routines of the module are those of the program.
#[test]
fn modules_compute_what_the_program_says() {
    agree(&CrateOnTable::<f64>::default(), "crate_on_table", 52);
    agree(&LogOnTable::<f64>::default(), "log_on_table", 22);
}

fn agree(module: &dyn Contacts<f64>, name: &str, contacts: usize) {
    let path = format!("{}/../simulation/models/{name}.mech", env!("CARGO_MANIFEST_DIR"));
    let interpreted: InterpretedMechanism = InterpretedMechanism::read(path.as_ref()).unwrap();
    let mut random = Random::new(0x51ab_0042_77de_0001);
    for _ in 0..20 {
        let q: Vec<f64> = (0..7).map(|_| random.between(-1.0, 1.0)).collect();
        let u: Vec<f64> = (0..6).map(|_| random.between(-1.0, 1.0)).collect();
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
        for contact in 0..contacts {
            let both: [&dyn Contacts<f64>; 2] = [module, &interpreted];
            let [one, other] = both.map(|m| (m.gap(contact, &state), m.validity(contact, &state)));
            assert_eq!(one, other);
            let [one, other] = both.map(|m| m.contact_state(contact, &state));
            assert_eq!(one, other);
            let [one, other] = both.map(|m| m.free_acceleration(contact, &state));
            assert_eq!(one, other);
            let [one, other] = both.map(|m| {
                let (mut speeds, mut rates) = ([0.0; 6], [0.0; 6]);
                let surface = hodograph::Surface { mu: 0.3, e: 0.2, law: Law::Poisson };
                let hit = m.collide(contact, &state, &surface, &mut speeds).is_ok();
                let mode = m.contact_mode(contact, &state, &surface, &mut rates).is_ok();
                (hit.then_some(speeds), mode.then_some(rates))
            });
            assert_eq!(one, other);
        }
    }
}
