//! Events of a motion go to JSON and back without the loss of a bit: the feature `serde` of `hodograph-simulation`.

use hodograph::{Law, Surface};
use hodograph_models::slender_rod_5dof::{Coordinates, SlenderRod5dof, Speeds};
use hodograph_simulation::{Event, Options, Progress, Simulation};

#[test]
fn events_are_read_as_they_were_written() {
    let rod = SlenderRod5dof::<f64>::default();
    let q: [f64; 5] = Coordinates { z: 2.0, ..Coordinates::default() }.into();
    let u: [f64; 5] = Speeds::default().into();
    let start = hodograph::State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    let surface = Some(Surface { mu: 0.3, e: 0.5, law: Law::Stronge });
    let mut motion = Simulation::new(&rod, &start, Options { surface, ..Options::default() }).unwrap();
    let mut events: Vec<Event> = Vec::new();
    while let Progress::Event(event) = motion.advance(3.0).unwrap() {
        events.push(event);
    }
    assert!(events.iter().any(|event| event.kind.name() == "collision"), "{events:?}");
    for event in &events {
        let text = serde_json::to_string(event).unwrap();
        let read: Event = serde_json::from_str(&text).unwrap();
        assert_eq!(format!("{read:?}"), format!("{event:?}"), "{text}");
    }

    // errors are written, with the name of their kind
    let overlap = hodograph::State { time: 0.0, coordinates: &[f64::NAN; 5], speeds: &u, inputs: &[] };
    let error = Simulation::new(&rod, &overlap, Options { surface, ..Options::default() }).unwrap_err();
    let written = serde_json::to_value(&error).unwrap();
    assert_eq!(written["time"], 0.0, "{written}");
    assert!(written["kind"].is_object() || written["kind"].is_string(), "{written}");
}
