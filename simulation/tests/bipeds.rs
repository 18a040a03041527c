//! Bipeds land on heels and toes from random postures: up to four points strike, slide and stick at a time,
//! and the forces of a foot that stands are not unique.
//!
//! All starts: `HODOGRAPH_STARTS=100 cargo test --release -p hodograph-simulation --test all bipeds:: --
//! --nocapture`

use crate::common::names;
use biped::Biped;
use hodograph::{ComponentKind, Contacts, Law, Mechanism, State, Surface};
use hodograph_random::{Random, starts};
use hodograph_simulation::{Event, ImpactsAtOnce, Options, Progress, Simulation};

hodograph::mechanism!("models/biped.mech");

/// Two seconds from a random posture: how many events there were, or what went wrong.
fn land(biped: &dyn Contacts<f64>, seed: u64) -> Result<usize, String> {
    let mut random = Random::new(seed + 1);
    let count = |kind| biped.count(kind);
    let (mut q, mut u) =
        (vec![0.0; count(ComponentKind::Coordinate)], vec![0.0; count(ComponentKind::Speed)]);
    let mut inputs = vec![0.0; count(ComponentKind::Input)];
    biped.initial_state(&mut q, &mut u, &mut inputs).unwrap();
    for name in ["qh1", "qh2", "qk1", "qk2", "qa1", "qa2"] {
        q[Mechanism::index(biped, ComponentKind::Coordinate, name).unwrap()] += random.between(-0.35, 0.35);
    }
    u.iter_mut().for_each(|u| *u += random.between(-0.3, 0.3));
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
    let law = Law::ALL[random.below(Law::ALL.len())];
    let e = if random.below(3) == 0 { 0.0 } else { random.between(0.0, 0.7) };
    let surface = Surface { mu: random.between(0.05, 1.2), e, law };
    let options = Options {
        surface: Some(surface),
        compare_orders: false,
        together: ImpactsAtOnce::Sequential,
        ..Options::default()
    };
    let mut simulation =
        Simulation::new(biped, &state, options).map_err(|error| format!("{seed}: {error}"))?;
    let mut seen: Vec<Event> = Vec::new();
    loop {
        match simulation.advance(2.0) {
            Ok(Progress::Event(event)) => seen.push(event),
            Ok(Progress::Reached) => break,
            Err(error) => {
                return Err(format!(
                    "{seed} {surface:?}: {error} after {:?}",
                    names(&seen[seen.len().saturating_sub(8)..])
                ));
            }
        }
    }
    let (q, u) = (simulation.coordinates(), simulation.speeds());
    let state = State { time: simulation.time(), coordinates: q, speeds: u, inputs: &inputs };
    for contact in 0..count(ComponentKind::Contact) {
        let gap = biped.gap(contact, &state).unwrap().unwrap();
        assert!(gap > -1e-9, "{seed}: gap {gap:e}");
    }
    Ok(seen.len())
}

#[test]
fn bipeds_land() {
    let biped = Biped::<f64>::default();
    let starts = starts(2);
    let mut events = 0;
    let mut failed = Vec::new();
    for seed in starts.clone() {
        match land(&biped, seed) {
            Ok(count) => events += count,
            Err(why) => failed.push(why),
        }
    }
    println!("bipeds {starts:?}: {events} events, {} failed", failed.len());
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
