//! Motions that did not settle once: two boxes with a hinge thrown on a table, and balls in a groove.

use crate::many::{Start, follow, model, surface, with_parameters};
use hodograph::{Law, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Simulation;

/// The numbers of an object in a state file: `"name": number`.
fn numbers(text: &str, object: &str) -> Vec<(String, f64)> {
    let from = text.find(&format!("\"{object}\"")).unwrap_or_else(|| panic!("no {object}"));
    let inner = text[from..].split(['{', '}']).nth(1).unwrap();
    let pair = |entry: &str| {
        let (name, value) = entry.split_once(':')?;
        Some((name.trim().trim_matches('"').to_owned(), value.trim().parse().ok()?))
    };
    inner.split(',').filter_map(pair).collect()
}

/// The ten states from which a hinged pair of boxes ended in an error or did not end.
#[test]
fn hinged_boxes_settle() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/many_contacts/elbow_states");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert_eq!(files.len(), 10);
    let elbow = model("elbow");
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let parameters = numbers(&text, "parameters");
        let parameters: Vec<(&str, f64)> = parameters.iter().map(|(name, x)| (name.as_str(), *x)).collect();
        let mechanism = with_parameters(&elbow, &parameters);
        let mut start = Start::of(&mechanism);
        let given: Vec<(String, f64)> = ["q", "u"].iter().flat_map(|object| numbers(&text, object)).collect();
        assert_eq!(given.len(), start.coordinates.len() + start.speeds.len());
        for (name, value) in given {
            start.set(&mechanism, &name, value);
        }
        let thick = path.ends_with("h4_442.json");
        let (mu, e) = if thick { (0.1434, 0.33) } else { (0.1834, 0.3189) };
        let end = follow(&mechanism, &start, surface(mu, e, Law::Stronge), 0.8);
        assert!(end.error.is_none(), "{path:?}: {:?}", end.error);
        assert!(end.gain().is_none_or(|(_, gain)| gain < 1e-12 * end.before.abs()), "{path:?}");
    }
}

/// Balls that are dropped without speed into a groove come to rest, 30 of 30.
#[test]
fn balls_rest_in_a_groove() {
    let groove = model("groove_drop");
    for k in 0..30 {
        let mut start = Start::of(&groove);
        start.speeds.fill(0.0);
        start.set(&groove, "y", 0.002 * f64::from(k - 15));
        let (mu, e) = ([0.2, 0.3, 0.6][k as usize % 3], [0.0, 0.3][k as usize % 2]);
        let end = follow(&groove, &start, surface(mu, e, Law::Poisson), 8.0);
        assert!(end.error.is_none(), "{k}: {:?}", end.error);
        assert!(end.speeds.iter().all(|speed| *speed == 0.0), "{k}: {:?} {:?}", end.speeds, end.names());
        assert!(end.account.abs() < 1e-10, "{k}: {:e}", end.account);
    }
}

/// Two cubes on each other rattle at six corners. The plastic impact that ends this left an approach of 1e-13 m/s, right
/// to 1e-12 of the slip, but 1.3e-12 of the first approach: 3000 impacts without impulses followed.
#[test]
fn cubes_that_rattle_end_with_one_plastic_impact() {
    let cubes = model("cubes2");
    let (coordinates, speeds) = (
        vec![
            -0.01829457826017546,
            0.015025381492870441,
            0.1020971545096321,
            0.9986724621130205,
            0.0070144242993166305,
            -0.0003584165162120539,
            -0.05102923482149949,
            0.0560032064509325,
            -0.10708340155818473,
            0.3005168028141661,
            0.9999033119003069,
            0.006977899688350266,
            -0.0007997040635499273,
            0.012001509911166906,
        ],
        vec![
            0.030226439842991077,
            -0.0031636703546386313,
            -0.05943798666676992,
            -0.4000388914273716,
            -0.002873210932271265,
            -0.2045253435916067,
            -0.31591565769859514,
            -0.3905968852424811,
            -0.05699960181555517,
            -0.3972234529812933,
            0.2291917394949926,
            -1.1531650973851006,
        ],
    );
    let start = Start { coordinates, speeds, inputs: vec![] };
    let end = follow(&cubes, &start, surface(0.5634622646000488, 0.24931545975906344, Law::Newton), 1e-6);
    assert!(end.error.is_none(), "{:?}", end.error);
    assert!(end.events.len() < 400 && end.account.abs() < 1e-10, "{} {:e}", end.events.len(), end.account);
}

/// A ball that bounces on a plate, comes to rest on it and leaves it where the plate falls away: then bodies part like the
/// third power of time, from a normal velocity that is less than what the rounding of a late time makes of that of the plate.
#[test]
fn a_ball_leaves_a_plate_late() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/gradients/tests/models/ball_on_plate.mech");
    let ball = InterpretedMechanism::read(path.as_ref()).unwrap();
    let mut left = 0;
    for a in [0.003_483, 0.003_597, 0.003_636_000_000_000_000_3, 0.003_828_000_000_000_000_2, 0.004_179] {
        let plate = with_parameters(&ball, &[("a", a)]);
        let start = State { time: 0.05, coordinates: &[0.0139], speeds: &[0.14], inputs: &[] };
        let options = surface(0.0, 0.7, Law::Newton);
        let mut simulation = Simulation::new(&plate, &start, options).unwrap();
        let events = simulation.advance_to(11.0).unwrap_or_else(|error| panic!("{a}: {error}"));
        left += events.iter().filter(|event| event.kind.name() == "lift_off").count();
    }
    assert!(left > 200, "{left}");
}
