//! Mechanisms that touch the world at several points: what statics, symmetry and closed forms say of them.

use hodograph::{
    ClosedContacts, ComponentKind, Contacts, Law, Mechanism, Selection, State, StateError, Surface,
};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{
    Batch, Case, Drive, Event, EventKind, ImpactsAtOnce, Options, Outcome, OutcomeSet, Progress, Simulation,
    SimulationError, digest, simulate_many,
};

fn model(name: &str) -> InterpretedMechanism {
    let path = format!("{}/data/many_contacts/{name}.mech", env!("CARGO_MANIFEST_DIR"));
    InterpretedMechanism::read(path.as_ref()).unwrap()
}

/// The start state of the model, with some values changed.
struct Start {
    coordinates: Vec<f64>,
    speeds: Vec<f64>,
    inputs: Vec<f64>,
}

impl Start {
    fn of(mechanism: &InterpretedMechanism) -> Self {
        let model = mechanism.model();
        let values = |list: &[hodograph_generator::model::mechanism::Variable], kind| {
            (0..mechanism.count(kind))
                .map(|index| {
                    let name = mechanism.component(kind, index).unwrap().name;
                    list.iter().find(|other| other.name == name).and_then(|other| other.value).unwrap_or(0.0)
                })
                .collect()
        };
        Self {
            coordinates: values(&model.coordinates, ComponentKind::Coordinate),
            speeds: values(&model.speeds, ComponentKind::Speed),
            inputs: values(&model.inputs, ComponentKind::Input),
        }
    }

    fn set(&mut self, mechanism: &InterpretedMechanism, name: &str, value: f64) {
        let place = |kind| mechanism.index(kind, name);
        if let Some(index) = place(ComponentKind::Coordinate) {
            self.coordinates[index] = value;
        } else {
            self.speeds[place(ComponentKind::Speed).unwrap()] = value;
        }
    }
}

fn surface(mu: f64, e: f64) -> Options {
    Options { surface: Some(Surface { mu, e, law: Law::Poisson }), ..Options::default() }
}

struct Ended {
    events: Vec<Event>,
    error: Option<SimulationError>,
    coordinates: Vec<f64>,
    /// change of energy that no work accounts for, J
    account: f64,
}

impl Ended {
    fn names(&self) -> Vec<String> {
        self.events.iter().map(|event| format!("{} {:.12}", event.kind.name(), event.time)).collect()
    }

    fn rests(&self) -> bool {
        self.events.iter().any(|event| matches!(event.kind, EventKind::Rest))
    }
}

fn run(mechanism: &InterpretedMechanism, start: &Start, options: Options, until: f64) -> Ended {
    let state =
        State { time: 0.0, coordinates: &start.coordinates, speeds: &start.speeds, inputs: &start.inputs };
    let mut simulation = Simulation::new(mechanism, &state, options).unwrap();
    let before = simulation.energy().unwrap().total().unwrap();
    let (mut events, mut error) = (Vec::new(), None);
    loop {
        match simulation.advance(until) {
            Ok(Progress::Event(event)) => events.push(event),
            Ok(Progress::Reached) => break,
            Err(what) => {
                error = Some(what);
                break;
            }
        }
    }
    let after = simulation.energy().unwrap();
    Ended {
        events,
        error,
        coordinates: simulation.coordinates().to_vec(),
        account: after.total().unwrap() - after.friction - after.impacts - after.inputs - before,
    }
}

/// A uniform ladder on a floor against a wall, both of the same roughness, stands if and only if the tangent of
/// its angle with the floor is at least (1 - mu^2) / (2 mu).
#[test]
fn a_ladder_stands_if_friction_can_hold_it() {
    let ladder = model("ladder");
    let (mut stood, mut fell) = (0, 0);
    for mu in [0.2, 0.4, 0.6, 0.9] {
        for k in 0..12 {
            let angle = 0.5 + 0.08 * f64::from(k);
            let least = (1.0 - mu * mu) / (2.0 * mu);
            if (angle.tan() / least - 1.0).abs() < 1e-3 {
                continue;
            }
            let mut start = Start::of(&ladder);
            start.set(&ladder, "x", angle.cos());
            start.set(&ladder, "z", angle.sin());
            start.set(&ladder, "q", angle);
            let end = run(&ladder, &start, surface(mu, 0.0), 0.05);
            assert!(end.error.is_none(), "{mu} {angle}: {:?}", end.error);
            let stands = angle.tan() >= least;
            assert_eq!(end.rests(), stands, "{mu} {angle}: {:?}", end.names());
            if stands {
                let moved = end.coordinates.iter().zip(&start.coordinates).map(|(a, b)| (a - b).abs());
                assert!(moved.fold(0.0, f64::max) < 1e-14, "{mu} {angle}");
                stood += 1;
            } else {
                fell += 1;
            }
        }
    }
    assert!(stood > 15 && fell > 10, "{stood} {fell}");
}

/// A ball dropped into a groove comes to the end of the motion from everywhere, and rests or rolls along it.
#[test]
fn a_ball_in_a_groove_is_followed_to_the_end() {
    let groove = model("groove_drop");
    for k in 0..30 {
        let mut start = Start::of(&groove);
        start.set(&groove, "y", 0.002 * f64::from(k - 15));
        start.set(&groove, "wx", f64::from(k % 7) - 3.0);
        start.set(&groove, "wy", 2.0 * f64::from(k % 5));
        let (mu, e) = ([0.2, 0.3, 0.6][k as usize % 3], [0.0, 0.3][k as usize % 2]);
        let end = run(&groove, &start, surface(mu, e), 1.5);
        assert!(end.error.is_none(), "{k}: {:?}", end.error);
        assert!(end.account.abs() < 1e-10, "{k}: {:e}", end.account);
    }
}

/// A ball falls onto both walls of a groove at once. Either strikes first, and then perhaps the other, or both strike
/// together: three outcomes, two of which mirror each other, and the draws find all of them and no other.
#[test]
fn draws_find_every_outcome_of_a_tie() {
    let groove = model("groove_drop");
    let mut start = Start::of(&groove);
    start.set(&groove, "y", 0.0);
    let surface = Surface { mu: 0.0, e: 0.5, law: Law::Newton };
    let case = |row: usize| {
        let together = ImpactsAtOnce::Sampled(row as u64);
        let options = Options { surface: Some(surface), together, ..Options::default() };
        let Start { coordinates, speeds, inputs } = &start;
        let (coordinates, speeds, inputs) = (coordinates.clone(), speeds.clone(), inputs.clone());
        Ok(Case { mechanism: &groove, time: 0.0, coordinates, speeds, inputs, options, until: 0.22 })
    };
    let drawn = |batch: &Batch<'_>| -> Vec<Outcome> {
        simulate_many(400, case, batch).into_iter().flatten().collect()
    };
    let outcomes = drawn(&Batch::default());
    let set = OutcomeSet::of(&outcomes, &Options::default());
    assert_eq!((set.motions, set.failed, set.ends.len(), set.unseen()), (400, 0, 3, 0.0), "{:?}", set.ends);
    // Together in half of them, each wall first in a quarter.
    let counts: Vec<usize> = set.ends.iter().map(|end| end.count).collect();
    assert!(counts[0].abs_diff(200) < 40 && counts[1].abs_diff(100) < 35, "{counts:?}");
    let sideways: Vec<f64> = set.ends.iter().map(|end| outcomes[end.row].speeds[1]).collect();
    assert!(
        sideways[0].abs() < 1e-12 && (sideways[1] + sideways[2]).abs() < 1e-12 && sideways[1].abs() > 0.1
    );
    // The orders are those of sequential impacts, and the tie is that of impacts at once.
    for (together, of) in [(ImpactsAtOnce::Approaching, &[0][..]), (ImpactsAtOnce::Sequential, &[1, 2])] {
        let options = Options { surface: Some(surface), together, ..Options::default() };
        let end = run(&groove, &start, options, 0.22);
        let near = |&place: &usize| {
            let other = &outcomes[set.ends[place].row];
            end.coordinates.iter().zip(&other.coordinates).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        assert!(of.iter().any(near), "{together:?}: {:?}", end.coordinates);
    }
    // The draws depend on the seed and the state alone.
    assert_eq!(digest(&outcomes), digest(&drawn(&Batch { threads: Some(1), ..Batch::default() })));
}

/// Six discs in a pyramid can stand from mu = 0.434 on (a linear program says so), and below they cannot.
#[test]
fn a_pyramid_stands_where_forces_exist() {
    let pyramid = model("pyramid3");
    let start = Start::of(&pyramid);
    let end = run(&pyramid, &start, surface(0.45, 0.0), 0.2);
    assert!(end.error.is_none() && end.rests(), "{:?} {:?}", end.error, end.names());
    // That it falls obeys the laws as well, and is said.
    let several =
        |event: &Event| matches!(event.kind, EventKind::Contact { selection: Selection::SeveralModes, .. });
    assert!(end.events.iter().any(several), "{:?}", end.events);
    let end = run(&pyramid, &start, surface(0.40, 0.0), 0.05);
    assert!(end.error.is_none() && !end.rests(), "{:?} {:?}", end.error, end.names());
}

/// Both feet of a crate begin to slip at once when the push is mu m g, whatever mu.
#[test]
fn both_feet_of_a_crate_begin_to_slip_at_once() {
    let krate = model("crate");
    for k in 1..=18 {
        let mu = 0.05 * f64::from(k);
        let drive = Drive::Continuous(std::sync::Arc::new(|t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
            inputs[0] = 20.0 * t
        }));
        let options = Options { drive, max_step: 0.05, ..surface(mu, 0.0) };
        let begins = mu * 2.0 * 9.81 / 20.0;
        let end = run(&krate, &Start::of(&krate), options, 1.2 * begins);
        assert!(end.error.is_none(), "{mu}: {:?}", end.error);
        let slips: Vec<f64> = end
            .events
            .iter()
            .filter(|event| matches!(event.kind, EventKind::Slip { .. }))
            .map(|event| event.time)
            .collect();
        assert_eq!(slips.len(), 2, "{mu}: {:?}", end.names());
        assert!(slips.iter().all(|time| (time - begins).abs() < 1e-9), "{mu}: {slips:?} {begins}");
        assert!(end.account.abs() < 1e-9, "{mu}: {:e}", end.account);
    }
}

/// A particle between two walls may be held or fall: it is held, and said to be one of several.
#[test]
fn several_modes_are_said() {
    let wedge = model("wedge");
    let end = run(&wedge, &Start::of(&wedge), surface(0.3, 0.0), 0.1);
    assert!(end.error.is_none() && end.rests(), "{:?}", end.names());
    let several =
        |event: &Event| matches!(event.kind, EventKind::Contact { selection: Selection::SeveralModes, .. });
    assert!(end.events.iter().any(several), "{:?}", end.events);
}

/// Chains, dominoes and stacks come to the end of the motion, and their energies agree with the works.
#[test]
fn chains_dominoes_and_stacks_come_to_the_end() {
    for (name, mu, e, until) in [
        ("chain5", 0.3, 0.0, 0.6),
        ("domino3", 0.3, 0.0, 0.7),
        ("domino3", 0.5, 0.2, 0.2),
        ("dropped5", 0.4, 0.0, 0.3),
        ("stack10", 0.5, 0.0, 1.0),
    ] {
        let mechanism = model(name);
        let start = Start::of(&mechanism);
        let end = run(&mechanism, &start, surface(mu, e), until);
        assert!(end.error.is_none(), "{name} {mu} {e}: {:?}", end.error);
        assert!(end.account.abs() < 1e-9, "{name} {mu} {e}: {:e}", end.account);
        if name == "stack10" {
            let moved = end.coordinates.iter().zip(&start.coordinates).map(|(a, b)| (a - b).abs());
            assert!(end.rests() && moved.fold(0.0, f64::max) < 1e-14, "{:?}", end.names());
        }
    }
}

/// Boxes that fall flat on each other keep their symmetry: no box turns when all corners strike at once.
#[test]
fn a_stack_that_falls_flat_does_not_turn() {
    let boxes = model("dropped5");
    let mut start = Start::of(&boxes);
    for k in 1..=5 {
        start.set(&boxes, &format!("x{k}"), 0.0);
    }
    for together in [ImpactsAtOnce::Approaching, ImpactsAtOnce::Simultaneous] {
        for e in [0.0, 0.5] {
            let options = Options { together, ..surface(0.4, e) };
            let end = run(&boxes, &start, options, 0.0999);
            assert!(end.error.is_none(), "{:?}", end.error);
            for k in 0..5 {
                assert!(end.coordinates[3 * k].abs() < 1e-13, "{together:?} {e}: {:?}", end.coordinates);
                assert!(end.coordinates[3 * k + 2].abs() < 1e-12, "{together:?} {e}: {:?}", end.coordinates);
            }
        }
    }
}

/// A gap whose rate is not the normal velocity cannot be held closed: an error, and no motion through a table.
#[test]
fn a_face_that_ends_by_a_maximum_is_refused() {
    let table = model("table_edge");
    let end = run(&table, &Start::of(&table), surface(0.2, 0.0), 1.0);
    let error = end.error.expect("the table ends");
    assert_eq!(error.kind.name(), "drift", "{error}");
    assert_eq!(error.contact.as_deref(), Some("top"));
    assert!(end.coordinates[1].abs() < 1e-9, "{:?}", end.coordinates);
}

/// A rod that turns hundreds of times within a step of the integration strikes where its gap first closes.
#[test]
fn fast_spins_miss_no_collision() {
    let rod = model("spin");
    let mut longest = 0.0_f64;
    for k in 0..120 {
        let spin = 20.0 + 1.7 * f64::from(k) + 0.013 * f64::from(k * k % 97);
        let mut start = Start::of(&rod);
        start.set(&rod, "u1", spin);
        start.set(&rod, "q1", 0.1 * f64::from(k));
        let gap = |t: f64| 1.9 - 0.3 * t + (0.1 * f64::from(k) + spin * t).cos();
        // The envelope 0.9 - 0.3 t closes at 3 s: the first turn after that, by small steps and halving.
        let (mut low, mut t) = (2.9, 2.9);
        while gap(t) > 0.0 {
            low = t;
            t += 0.002 / spin;
        }
        let mut high = t;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if gap(middle) > 0.0 { low = middle } else { high = middle }
        }
        let end = run(&rod, &start, surface(0.3, 0.5), high + 0.01);
        assert!(end.error.is_none(), "{spin}: {:?}", end.error);
        let first = end.events.first().unwrap_or_else(|| panic!("{spin}: missed"));
        assert_eq!(first.kind.name(), "collision");
        longest = longest.max((first.time - high).abs());
    }
    assert!(longest < 1e-7, "{longest:e}");
}

/// What forces of closed contacts follow from has the same bits in one pass and by the single methods.
#[test]
fn one_pass_has_the_bits_of_the_single_methods() {
    for name in ["chain5", "domino3", "groove_drop", "ladder", "stack10"] {
        let machine = model(name);
        let mut start = Start::of(&machine);
        start.speeds.iter_mut().enumerate().for_each(|(i, u)| *u += 0.3 * (1.0 + i as f64).sin());
        let state = State {
            time: 0.4,
            coordinates: &start.coordinates,
            speeds: &start.speeds,
            inputs: &start.inputs,
        };
        let (n, p) = (start.coordinates.len(), start.speeds.len());
        let all: Vec<usize> = (0..machine.count(ComponentKind::Contact)).rev().collect();
        for contacts in [&all[..], &all[..1], &all[1..], &[]] {
            let k = contacts.len();
            let room = || [n, p, 3 * p * k, 3 * p * k, 3 * k, 3 * k].map(|count| vec![0.0_f64; count]);
            let [mut q, mut u, mut partial, mut response, mut velocity, mut free] = room();
            let mut values = ClosedContacts {
                coordinate_rates: &mut q,
                accelerations: &mut u,
                partial_velocities: &mut partial,
                responses: &mut response,
                velocities: &mut velocity,
                free_accelerations: &mut free,
            };
            machine.closed_contacts(contacts, &state, &mut values).unwrap();
            let [mut q1, mut u1, mut partial1, mut response1, mut velocity1, mut free1] = room();
            machine.coordinate_rates(&state, &mut q1).unwrap();
            machine.accelerations(&state, &mut u1).unwrap();
            for (place, &contact) in contacts.iter().enumerate() {
                let (rows, three) = (3 * p * place..3 * p * (place + 1), 3 * place..3 * place + 3);
                machine.partial_velocities(contact, &state, &mut partial1[rows.clone()]).unwrap();
                machine.response(contact, &state, &mut response1[rows]).unwrap();
                let v = machine.contact_velocity(contact, &state).unwrap();
                velocity1[three.clone()].copy_from_slice(v.as_slice());
                free1[three].copy_from_slice(machine.free_acceleration(contact, &state).unwrap().as_slice());
            }
            assert_eq!(
                [q, u, partial, response, velocity, free],
                [q1, u1, partial1, response1, velocity1, free1]
            );
        }
        let mut none: [Vec<f64>; 4] = [vec![0.0; n], vec![0.0; p], vec![0.0; 3 * p], vec![0.0; 3 * p]];
        let [q, u, partial, response] = &mut none;
        let mut values = ClosedContacts {
            coordinate_rates: q,
            accelerations: u,
            partial_velocities: partial,
            responses: response,
            velocities: &mut [0.0; 3],
            free_accelerations: &mut [0.0; 3],
        };
        let missing = machine.closed_contacts(&[all.len()], &state, &mut values);
        assert!(matches!(missing, Err(StateError::Missing { .. })), "{name}: {missing:?}");
    }
}
