//! Emitted code computes the same bits as the interpreter, and its collisions obey (12a) and (24).

#[allow(missing_docs)]
mod golden {
    include!("../../generator/emit/tests/golden/pendulum.rs");
    include!("../../generator/emit/tests/golden/pendulum_in_parts.rs");
}

use golden::pendulum::{Coordinates, Inputs, Parameters, Pendulum, Speeds};
use hodograph::{Law, Surface};
use hodograph_generator::artifact;
use hodograph_generator::interpret::Evaluator;
use hodograph_generator::program::{ContactQuantity, PointQuantity, Quantity};

#[test]
fn the_same_bits() {
    let artifact =
        artifact::decode(include_str!("../../generator/program/tests/golden/pendulum.derivation")).unwrap();
    let evaluator = Evaluator::new(&artifact.program);
    for step in 0..200 {
        let x = f64::from(step) * 0.37 - 30.0;
        let (m, l, g) = (1.3, 0.7, 9.81);
        let pendulum = Pendulum::new(Parameters { m, l, g }).unwrap();
        let (q, u, inputs) = (Coordinates { q1: x }, Speeds { u1: 0.9 * x }, Inputs { tau: x.cos() });
        let outside = hodograph_generator::program::Inputs {
            parameters: vec![m, l, g],
            coordinates: vec![q.q1],
            speeds: vec![u.u1],
            inputs: vec![inputs.tau],
            ..Default::default()
        };
        let interpreted = |quantity| evaluator.evaluate(&outside, &[quantity]).unwrap().remove(0).values;
        assert_eq!(
            interpreted(Quantity::Accelerations),
            [pendulum.accelerations(&q, &u, &inputs).unwrap().u1]
        );
        assert_eq!(interpreted(Quantity::Forcing), pendulum.forcing(&q, &u, &inputs).unwrap().as_slice());
        assert_eq!(interpreted(Quantity::KineticEnergy), [pendulum.kinetic_energy(&q, &u).unwrap()]);
        let position = pendulum.position_p(&q).unwrap();
        assert_eq!(interpreted(Quantity::Point(1, PointQuantity::Position)), position.as_slice());
        let reduced: [f64; 6] = pendulum.reduced_matrix_tip_wall(&q).unwrap().into();
        assert_eq!(interpreted(Quantity::Contact(0, ContactQuantity::Reduced)), reduced);
    }
}

#[test]
fn routines_in_parts_compute_the_same_bits() {
    use golden::pendulum_in_parts as parts;
    let (whole, split) = (Pendulum::<f64>::default(), parts::Pendulum::<f64>::default());
    for step in 0..50 {
        let x = f64::from(step) * 0.37 - 9.0;
        let (q, u) = (Coordinates { q1: x }, Speeds { u1: 0.9 * x });
        let (q2, u2) = (parts::Coordinates { q1: x }, parts::Speeds { u1: 0.9 * x });
        let reduced = whole.reduced_matrix_tip_wall(&q).unwrap();
        assert_eq!(reduced, split.reduced_matrix_tip_wall(&q2).unwrap());
        let velocity = whole.contact_velocity_tip_wall(&q, &u).unwrap();
        assert_eq!(velocity, split.contact_velocity_tip_wall(&q2, &u2).unwrap());
        let tau = x.cos();
        let rates = whole.accelerations(&q, &u, &Inputs { tau }).unwrap();
        assert_eq!(rates.u1, split.accelerations(&q2, &u2, &parts::Inputs { tau }).unwrap().u1);
    }
}

#[test]
fn a_collision_changes_speeds_and_energy() {
    let pendulum = Pendulum::<f64>::default();
    let (q, u) = (Coordinates { q1: 0.4 }, Speeds { u1: 3.0 });
    let hit = pendulum.collide_tip_wall(&q, &u, &Surface { mu: 0.2, e: 0.5, law: Law::Newton }).unwrap();
    assert!((hit.separation.x + 0.5 * hit.approach.x).abs() < 1e-12, "Newton: v_n2 = -e v_n1");
    let energy = pendulum.kinetic_energy(&q, &hit.speeds).unwrap() - pendulum.kinetic_energy(&q, &u).unwrap();
    assert!((energy - hit.energy_change).abs() < 1e-12, "{energy} {}", hit.energy_change);
    assert_eq!(hit.impulse_on_point, -hit.impulse_on_struck);
    let velocity = pendulum.contact_velocity_tip_wall(&q, &hit.speeds).unwrap();
    assert!((velocity.x - hit.separation.x).abs() < 1e-12);
}

#[test]
fn impossible_parameters_and_states_are_named() {
    use hodograph::{ParameterError, StateError};
    let parameters = Parameters { m: -1.0, l: 1.0, g: 9.81 };
    assert_eq!(Pendulum::new(parameters), Err(ParameterError::Mass { body: "Bob" }));
    assert_eq!(
        Pendulum::new(Parameters { m: 1.0, l: 0.0, g: 9.81 }),
        Err(ParameterError::Singular { what: "the bob has no inertia" })
    );
    assert_eq!(
        Pendulum::new(Parameters { m: 1.0, l: 1.0, g: f64::NAN }),
        Err(ParameterError::NotFinite { name: "g" })
    );
    let pendulum = Pendulum::<f64>::default();
    assert_eq!(pendulum.position_p(&Coordinates { q1: f64::INFINITY }), Err(StateError::NotFinite));
}
