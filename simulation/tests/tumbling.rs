//! A box that falls on its corners comes to rest on a face, and no event gives it energy.
//!
//! All 200 starts: `HODOGRAPH_STARTS=200 cargo test --release -p hodograph-simulation --test all tumbling:: --
//! --nocapture`

use crate::common::{names, start};
use hodograph::{ComponentKind, Contacts, Law, Mechanism, State, Surface};
use hodograph_random::{Random, starts};
use hodograph_simulation::{Event, EventKind, Options, Progress};
use tumbling_box::TumblingBox;

hodograph::mechanism!("models/tumbling_box.mech");

/// What one start gives.
struct Figures {
    events: usize,
    /// greatest change of kinetic energy at an impact, of the energy at the start
    gain: f64,
    /// what the account of energy is off by, of the energy at the start
    account: f64,
    /// when it came to rest, s
    rest: f64,
}

#[test]
fn a_tumbling_box_comes_to_rest_on_a_face() {
    let count = starts(5);
    let mut all = Vec::new();
    let mut failures = Vec::new();
    for seed in count.clone() {
        match tumble(seed) {
            Ok(figures) => {
                if count.end - count.start > 5 {
                    println!("start {seed}: {} events, account {:.1e}", figures.events, figures.account);
                }
                all.push(figures);
            }
            Err(message) => failures.push(format!("start {seed}: {message}")),
        }
    }
    let most = |of: fn(&Figures) -> f64| all.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    println!(
        "starts {count:?}, {} events: greatest gain of energy at an impact {:.1e} of the energy at the start, error of the account {:.1e}, latest rest {:.2} s",
        all.iter().map(|figures| figures.events).sum::<usize>(),
        most(|figures| figures.gain),
        most(|figures| figures.account),
        most(|figures| figures.rest)
    );
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Slow bounces in short steps of the corners of an edge that slides: where the return of a corner that had
/// just lifted off was found 1e-11 m too late, again and again, the box gained 4e-9 of its energy (72, 18, 127)
/// or rattled for ever on what it gained (161); corners moved by each other's correction struck without
/// end (81). At rest not even the last bit of the quaternion changes (80).
#[test]
fn corners_that_rattle_while_they_slide_keep_the_account() {
    for seed in [18, 72, 80, 81, 127, 161] {
        let figures = tumble(seed).unwrap_or_else(|message| panic!("start {seed}: {message}"));
        assert!(figures.account < 1e-11, "start {seed}: {:e}", figures.account);
    }
}

/// One box, from its fall to its rest.
fn tumble(seed: u64) -> Result<Figures, String> {
    let body = TumblingBox::<f64>::default();
    let mut random = Random::new(seed);
    let mut q = vec![0.0, 0.0, random.between(0.4, 1.0)];
    q.extend(random.rotation());
    let u: Vec<f64> =
        (0..6).map(|i| if i < 3 { random.between(-2.0, 2.0) } else { random.between(-8.0, 8.0) }).collect();
    let law = [Law::Stronge, Law::Poisson][random.below(2)];
    let surface = Surface { mu: random.between(0.1, 1.0), e: random.between(0.0, 0.7), law };
    let mut simulation = start(&body, &q, &u, Options { surface: Some(surface), ..Options::default() });
    let before = simulation.energy().unwrap().total().unwrap();
    let mut seen: Vec<Event> = Vec::new();
    let mut gain = f64::NEG_INFINITY;
    let wrong = |message: String, seen: &[Event]| {
        Err(format!("{surface:?}: {message}, after {:?}", names(&seen[seen.len().saturating_sub(8)..])))
    };
    let rest = loop {
        let event = match simulation.advance(60.0) {
            Ok(Progress::Event(event)) => event,
            Ok(Progress::Reached) => return wrong("no rest".to_owned(), &seen),
            Err(error) => return wrong(error.to_string(), &seen),
        };
        if let EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) = &event.kind {
            let kinetic = |speeds: &[f64]| {
                let state = State { time: event.time, coordinates: &event.coordinates, speeds, inputs: &[] };
                Mechanism::kinetic_energy(&body, &state).unwrap()
            };
            let change = (kinetic(&event.speeds) - kinetic(&struck.speeds_before)) / before;
            gain = gain.max(change);
            if change > 1e-13 {
                return wrong(format!("{} gives {change:e} of the energy", event.kind.name()), &seen);
            }
        }
        let ends = matches!(event.kind, EventKind::Rest);
        let time = event.time;
        seen.push(event);
        if ends {
            break time;
        }
    };
    let energy = simulation.energy().unwrap();
    let account = ((energy.total().unwrap() - energy.friction - energy.impacts - before) / before).abs();
    if account > 1e-9 {
        return wrong(format!("the account of energy is off by {account:e}"), &seen);
    }
    // On a face: four corners at the ground, the mass centre half a side above it.
    let state =
        State { time: rest, coordinates: simulation.coordinates(), speeds: simulation.speeds(), inputs: &[] };
    let gaps: Vec<f64> = (0..Mechanism::count(&body, ComponentKind::Contact))
        .map(|contact| Contacts::gap(&body, contact, &state).unwrap().unwrap())
        .collect();
    let down = gaps.iter().filter(|gap| gap.abs() < 1e-9).count();
    let height = simulation.coordinates()[2];
    if down != 4 || ![0.3, 0.2, 0.15].iter().any(|half| (height - half).abs() < 1e-9) {
        return wrong(format!("rests with the gaps {gaps:?}"), &seen);
    }
    if simulation.speeds() != [0.0; 6] {
        return wrong(format!("rests with the speeds {:?}", simulation.speeds()), &seen);
    }
    let still = simulation.coordinates().to_vec();
    match simulation.advance(rest + 1e4) {
        Ok(Progress::Reached) if simulation.coordinates() == still => {}
        other => return wrong(format!("does not stay at rest: {other:?}"), &seen),
    }
    Ok(Figures { events: seen.len(), gain, account, rest })
}
