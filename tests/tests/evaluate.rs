//! Sets of quantities, `evaluate control(mass_matrix, ..)`: their answers are those of the separate methods
//! and of the interpreter, for less work.

use crate::common::Model;
use crate::common::random::samples;
use hodograph::nalgebra::SMatrix;
use hodograph_generator::interpret::Evaluator;
use hodograph_generator::program::{ContactQuantity as C, Quantity as Q};

hodograph::mechanism!(
    "../models/four_bar.mech",
    evaluate control(mass_matrix, forcing, accelerations, dependent_accelerations),
    evaluate at_the_wall(
        contact_state_coupler_wall, response_coupler_wall, contact_matrices_coupler_wall, mass_matrix, kinetic_energy,
    ),
    evaluate gradients(
        mass_matrix, accelerations_derivatives, inverse_dynamics_derivatives, forcing, accelerations, contact_tangent_coupler_wall,
    ),
);

use four_bar::{Coordinates, FourBar, Parameters, Speeds};

/// Rounding that two forms of the same quantity may differ by, relative to the largest entry.
const ROUNDING: f64 = 2e-12;

fn list<const R: usize, const K: usize>(matrix: SMatrix<f64, R, K>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}

/// The largest difference relative to the largest entry.
fn differ(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().chain(b).fold(0.0_f64, |size, x| size.max(x.abs()));
    let difference = a.iter().zip(b).fold(0.0_f64, |most, (x, y)| most.max((x - y).abs()));
    if size > 0.0 { difference / size } else { difference }
}

fn agree(what: &str, a: &[f64], b: &[f64]) {
    let difference = differ(a, b);
    assert!(difference < ROUNDING, "{what}: {difference:e}\n{a:?}\n{b:?}");
}

/// A list of the numbers of a value with its derivatives, by rows.
macro_rules! beside {
    ($d:expr) => {{
        let d = $d;
        let rows = d.value.iter().enumerate().flat_map(|(row, value)| {
            let of = |matrix: &[f64], rows: usize| -> Vec<f64> {
                matrix.iter().skip(row).step_by(rows).copied().collect()
            };
            let rows = d.value.len();
            let (q, u, w) = (d.by_coordinates.as_slice(), d.by_speeds.as_slice(), d.by_inputs.as_slice());
            [vec![*value], of(q, rows), of(u, rows), of(w, rows)].concat()
        });
        rows.collect::<Vec<f64>>()
    }};
}

#[test]
fn a_set_gives_what_its_methods_and_the_interpreter_give() {
    let model = Model::load("four_bar");
    let evaluator = Evaluator::new(&model.program);
    for sample in samples(&model, 5) {
        let mut at = sample.inputs;
        at.accelerations = vec![0.7];
        at.tangent = vec![0.3, -0.8];
        let of = |list: &[Q]| -> Vec<Vec<f64>> {
            let arrays = evaluator.evaluate(&at, list).expect("a regular state");
            arrays.into_iter().map(|array| array.values).collect()
        };
        let bar = FourBar::<f64>::new(Parameters::from(array(&at.parameters))).unwrap();
        let (q, u) = (Coordinates::from(array(&at.coordinates)), Speeds::from(array(&at.speeds)));
        let acceleration = Speeds { u1: 0.7 };

        let all = bar.control(&q, &u).unwrap();
        assert_eq!(all.mass_matrix, bar.mass_matrix(&q).unwrap());
        assert_eq!(all.forcing, bar.forcing(&q, &u).unwrap());
        assert_eq!(all.accelerations, bar.accelerations(&q, &u).unwrap());
        assert_eq!(all.dependent_accelerations, bar.dependent_accelerations(&q, &u).unwrap());
        let road = of(&[Q::MassMatrix, Q::Forcing, Q::Accelerations, Q::DependentAccelerations]);
        let own: [f64; 2] = all.dependent_accelerations.into();
        agree("M", &road[0], &list(all.mass_matrix));
        agree("forcing", &road[1], &list(all.forcing));
        agree("u'", &road[2], &[all.accelerations.u1]);
        agree("dependent u'", &road[3], &own);

        let all = bar.at_the_wall(&q, &u).unwrap();
        assert_eq!(all.contact_state_coupler_wall, bar.contact_state_coupler_wall(&q, &u).unwrap());
        assert_eq!(all.response_coupler_wall, bar.response_coupler_wall(&q).unwrap());
        assert_eq!(all.contact_matrices_coupler_wall, bar.contact_matrices_coupler_wall(&q).unwrap());
        assert_eq!(all.mass_matrix, bar.mass_matrix(&q).unwrap());
        assert_eq!(all.kinetic_energy, bar.kinetic_energy(&q, &u).unwrap());
        let road = of(&[Q::Contact(0, C::Response), Q::Contact(0, C::Reduced), Q::KineticEnergy]);
        let reduced: [f64; 6] = all.contact_state_coupler_wall.reduced.into();
        agree("response", &road[0], &list(all.response_coupler_wall));
        agree("reduced", &road[1], &reduced);
        agree("energy", &road[2], &[all.kinetic_energy]);

        let tangent = [0.3, -0.8];
        let all = bar.gradients(&q, &u, &acceleration, &tangent).unwrap();
        let road =
            of(&[Q::AccelerationsDerivatives, Q::InverseDynamicsDerivatives, Q::Contact(0, C::Tangent)]);
        let alone = bar.accelerations_derivatives(&q, &u).unwrap();
        agree("derivatives of u'", &beside!(all.accelerations_derivatives), &beside!(alone));
        agree("derivatives of u'", &beside!(all.accelerations_derivatives), &road[0]);
        let alone = bar.inverse_dynamics_derivatives(&q, &u, &acceleration).unwrap();
        agree("derivatives of forces", &beside!(all.inverse_dynamics_derivatives), &beside!(alone));
        agree("derivatives of forces", &beside!(all.inverse_dynamics_derivatives), &road[1]);
        let alone = bar.contact_tangent_coupler_wall(&q, &u, &tangent).unwrap();
        agree("tangent", &list(all.contact_tangent_coupler_wall), &list(alone));
        agree("tangent", &list(all.contact_tangent_coupler_wall), &road[2]);
        agree("M", &list(all.mass_matrix), &list(bar.mass_matrix(&q).unwrap()));
        agree("forcing", &list(all.forcing), &list(bar.forcing(&q, &u).unwrap()));
    }
}

#[test]
fn a_set_fails_where_one_of_its_methods_fails() {
    let bar = FourBar::<f64>::default();
    let q = Coordinates { q1: f64::NAN, ..Coordinates::default() };
    let u = Speeds::default();
    assert!(bar.mass_matrix(&q).is_err());
    assert!(bar.control(&q, &u).is_err() && bar.at_the_wall(&q, &u).is_err());
    // A stretched linkage: the constraints cannot be solved for the dependent speeds.
    let q = Coordinates { q1: 0.0, q2: 0.0, q3: 0.0 };
    assert_eq!(bar.accelerations(&q, &u).unwrap_err(), bar.control(&q, &u).unwrap_err());
}

fn array<const N: usize>(numbers: &[f64]) -> [f64; N] {
    numbers.try_into().expect("as many as the record has")
}

/// What a controller asks for costs less in one call than in several.
#[test]
fn a_set_takes_fewer_operations_than_its_methods() {
    for name in ["arm_7dof", "puma_560", "four_bar", "whipple_bicycle", "two_sleds"] {
        let model = Model::load(name);
        let set = [
            Q::MassMatrix,
            Q::Forcing,
            Q::Accelerations,
            Q::Contact(0, C::PartialVelocities),
            Q::Contact(0, C::Reduced),
        ];
        let together = model.program.cost(&set).evaluation().total();
        let alone: usize = set.iter().map(|&one| model.program.cost(&[one]).evaluation().total()).sum();
        println!("{name}: {together} operations together, {alone} one by one");
        assert!(together < alone, "{name}: {together} {alone}");
    }
}
