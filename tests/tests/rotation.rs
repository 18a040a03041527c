//! The relative rotation of bodies in contact: generated modules and the interpreter compute the same bits, and what
//! cannot turn is refused.

use crate::common::{Model, root};
use hodograph::{Contacts, RelativeRotation, State, StateError};
use hodograph_generator::check::check;
use hodograph_generator::source::Source;
use hodograph_interpreter::InterpretedMechanism;

hodograph::mechanism!("../simulation/tests/models/turned_stool.mech");

/// All numbers of a relative rotation; none where the mechanism does not tell it.
fn rotation(m: &dyn Contacts, contact: usize, state: &State<'_>) -> Result<Option<Vec<f64>>, StateError> {
    let p = state.speeds.len();
    let (mut velocity, mut free) = (vec![f64::NAN; 3], vec![f64::NAN; 3]);
    let (mut rows, mut response) = (vec![f64::NAN; 3 * p], vec![f64::NAN; 3 * p]);
    let mut values = RelativeRotation {
        angular_velocity: &mut velocity,
        free_acceleration: &mut free,
        partial_velocities: &mut rows,
        response: &mut response,
    };
    let tells = m.relative_rotation(contact, state, &mut values)?;
    Ok(tells.then(|| [velocity, free, rows, response].concat()))
}

#[test]
fn modules_and_the_interpreter_agree_to_the_bit() {
    let model = Model::load("../simulation/tests/models/turned_stool");
    let interpreted = InterpretedMechanism::new(model.mechanism.clone(), model.program.clone()).unwrap();
    let module = turned_stool::TurnedStool::<f64>::default();
    let (q, u) = ([0.3, -0.2, 0.5, 0.8, 0.2, -0.4, 0.4], [0.5, -0.7, 0.1, 2.0, -3.0, 1.5]);
    let state = State { time: 0.7, coordinates: &q, speeds: &u, inputs: &[0.4] };
    for contact in 0..4 {
        let ours = rotation(&module, contact, &state).unwrap().unwrap();
        let theirs = rotation(&interpreted, contact, &state).unwrap().unwrap();
        assert!(ours.iter().all(|number| number.is_finite()) && ours[..3] != [0.0; 3]);
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&ours), bits(&theirs));
    }
    let missing = rotation(&interpreted, 4, &state);
    assert!(matches!(missing, Err(StateError::Missing { .. })), "{missing:?}");
    let short = State { speeds: &u[1..], ..state };
    assert!(matches!(rotation(&module, 0, &short), Err(StateError::Length { .. })));
    // Contacts without such friction do not tell it.
    let plain = Model::load("free_box_corner");
    let plain = InterpretedMechanism::new(plain.mechanism.clone(), plain.program.clone()).unwrap();
    let (n, p) = (plain.model().coordinates.len(), plain.model().speeds.len());
    let (q, u) = (vec![0.1; n], vec![0.1; p]);
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    assert_eq!(rotation(&plain, 0, &state), Ok(None));
}

/// Friction of rotation needs two bodies that turn.
#[test]
fn what_cannot_turn_is_refused_with_a_cure() {
    let path = root().join("simulation/tests/models/turned_stool.mech");
    let text = std::fs::read_to_string(path).unwrap();
    let table = "point: P1 of Stool,\n        against: Table,\n        normal: N.z,\n        gap: dot(position(P1), N.z),";
    for (from, to, says) in [
        ("point: P1 of Stool,", "point: P1,", "the point that strikes belongs to no body"),
        (
            table,
            "point: P1 of Stool, against: O, normal: N.z, gap: none,",
            "the point that is struck belongs to no body",
        ),
        (
            table,
            "point: P1 of Stool, against: velocity W*c*N.x, normal: N.z, gap: none,",
            "does not tell how it turns",
        ),
        (
            "contacts {",
            "particles { Dot { point: P1, mass: m } } \
             contacts { dot { point: P1 of Dot, normal: N.z, gap: none, surface: { spinning: 0 } },",
            "`Dot` is a particle, which does not turn",
        ),
        (
            "gap: dot(position(P1), N.z),\n        surface: { mu: 0.3, spinning: 0.01 }",
            "gap: dot(position(P1), N.z),\n        surface: { mu: 0.3, spinning: -0.01 }",
            "not negative",
        ),
    ] {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        let source = Source::file("stool.mech", text.replace(from, to));
        let found = check(&source);
        let told: Vec<String> = found.diagnostics.iter().map(|one| one.message.clone()).collect();
        assert!(found.mechanism.is_none(), "{to}");
        assert!(told.iter().any(|message| message.contains(says)), "{says}: {told:?}");
    }
}
