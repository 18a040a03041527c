//! Contacts that a module reaches by number alone: the features of two boxes, and of a capsule and a box (docs/theory.md,
//! 16.10 and 16.11); and contacts whose routine solves an equation (16.13 and 16.15).

use hodograph::nalgebra::Vector3;
use hodograph::{
    ClosedContacts, ComponentKind, Contacts, Distance, Law, Mechanism, ParameterError, State, StateError,
};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_random::Random;

hodograph::mechanism!("../models/shapes/ball_on_waves.mech");
hodograph::mechanism!("../models/shapes/dominoes.mech");
hodograph::mechanism!("../models/shapes/tyre_on_hills.mech");
hodograph::mechanism!("../simulation/models/crate_on_table.mech");
hodograph::mechanism!("../simulation/models/egg_on_egg.mech");
hodograph::mechanism!("../simulation/models/log_on_table.mech");

use ball_on_waves::BallOnWaves;
use crate_on_table::CrateOnTable;
use dominoes::Dominoes;
use egg_on_egg::EggOnEgg;
use log_on_table::LogOnTable;
use tyre_on_hills::TyreOnHills;

/// The routines of the module are those of the program.
#[test]
fn modules_compute_what_the_program_says() {
    agree(&CrateOnTable::<f64>::default(), "simulation/models/crate_on_table", 52);
    agree(&LogOnTable::<f64>::default(), "simulation/models/log_on_table", 22);
    agree(&EggOnEgg::<f64>::default(), "simulation/models/egg_on_egg", 1);
    agree(&BallOnWaves::<f64>::default(), "models/shapes/ball_on_waves", 1);
    agree(&TyreOnHills::<f64>::default(), "models/shapes/tyre_on_hills", 1);
}

/// Dimensions that no shape has are refused by both, and the mechanism stays as it is.
#[test]
fn impossible_dimensions_are_refused() {
    let refuse = |mechanism: &mut dyn Mechanism<f64>| {
        let mut values = vec![0.0; mechanism.count(ComponentKind::Parameter)];
        mechanism.parameter_values(&mut values).unwrap();
        let place = mechanism.index(ComponentKind::Parameter, "a").unwrap();
        for a in [-1.0, 0.0] {
            let mut other = values.clone();
            other[place] = a;
            let error = mechanism.set_parameter_values(&other).unwrap_err();
            assert!(matches!(error, ParameterError::Size { shape: "Table", .. }), "{error:?}");
            assert_eq!(error.kind(), "impossible_size");
            assert!(error.to_string().ends_with(" of `Table` is not positive"), "{error}");
            let mut kept = vec![0.0; values.len()];
            mechanism.parameter_values(&mut kept).unwrap();
            assert_eq!(kept, values);
        }
    };
    refuse(&mut LogOnTable::<f64>::default());
    refuse(&mut interpreted("simulation/models/log_on_table"));
}

/// What a module says of an iteration in singles is what it says in doubles, to their rounding.
#[test]
fn equations_are_solved_in_singles_too() {
    let (egg, ball, tyre) = (EggOnEgg::<f64>::default(), BallOnWaves::default(), TyreOnHills::default());
    let doubles: [&dyn Contacts<f64>; 3] = [&egg, &ball, &tyre];
    let (egg, ball, tyre) = (EggOnEgg::<f32>::default(), BallOnWaves::default(), TyreOnHills::default());
    let singles: [&dyn Contacts<f32>; 3] = [&egg, &ball, &tyre];
    let mut random = Random::new(0x51ab_0042_77de_0013);
    for (exact, rough) in doubles.into_iter().zip(singles) {
        let mut refused = 0;
        for _ in 0..1000 {
            let mut q = [0.0_f32; 7];
            let turned = random.rotation();
            (0..3).for_each(|i| q[i] = random.between(-0.5, 0.5) as f32);
            q[2] += 0.5;
            (0..4).for_each(|i| q[3 + i] = turned[i] as f32);
            let (wide, still) = (q.map(f64::from), [0.0; 6]);
            let state = State { time: 0.0, coordinates: &wide, speeds: &still, inputs: &[] };
            let Ok(known) = exact.contact_state(0, &state) else {
                // the axle is almost upright: the rim lies flat
                let upright = 2.0 * (turned[2] * turned[3] + turned[0] * turned[1]);
                assert!(upright.abs() > 0.98, "{q:?}");
                refused += 1;
                continue;
            };
            let state = State { time: 0.0, coordinates: &q, speeds: &[0.0; 6], inputs: &[] };
            let found = rough.contact_state(0, &state).unwrap();
            let (gap, known_gap) = (f64::from(found.gap.unwrap()), known.gap.unwrap());
            assert!((gap - known_gap).abs() < 1e-5, "{gap} {known_gap} at {q:?}");
            assert!((found.normal.map(f64::from) - known.normal).norm() < 1e-4, "{q:?}");
        }
        assert!(refused < 5, "{refused}");
    }
}

fn interpreted(name: &str) -> InterpretedMechanism {
    let path = format!("{}/../{name}.mech", env!("CARGO_MANIFEST_DIR"));
    InterpretedMechanism::read(path.as_ref()).unwrap()
}

fn agree(module: &dyn Contacts<f64>, name: &str, contacts: usize) {
    let interpreted = interpreted(name);
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

/// What several contacts answer in one pass.
#[derive(Debug, PartialEq)]
struct Several {
    distances: Vec<Distance>,
    velocities: Vec<Vector3<f64>>,
    closed: [Vec<f64>; 6],
}

fn several(m: &dyn Contacts<f64>, contacts: &[usize], state: &State<'_>) -> Result<Several, StateError> {
    let [n, p] = [ComponentKind::Coordinate, ComponentKind::Speed].map(|kind| m.count(kind));
    let k = contacts.len();
    let mut distances = vec![Distance::default(); k];
    m.gaps(contacts, state, &mut distances)?;
    let mut velocities = vec![Vector3::zeros(); k];
    m.contact_velocities(contacts, state, &mut velocities)?;
    let mut closed = [n, p, 3 * k * p, 3 * k * p, 3 * k, 3 * k].map(|length| vec![0.0; length]);
    let [rates, accelerations, partial_velocities, responses, speeds, free] = &mut closed;
    let mut slices = ClosedContacts {
        coordinate_rates: rates,
        accelerations,
        partial_velocities,
        responses,
        velocities: speeds,
        free_accelerations: free,
    };
    m.closed_contacts(contacts, state, &mut slices)?;
    Ok(Several { distances, velocities, closed })
}

/// Modules compute pair of shapes by pair, in whatever order contacts are asked for; the numbers are those of the single
/// methods, and of the program.
#[test]
fn contacts_of_several_pairs_in_one_pass() {
    agree_on_pairs(&Dominoes::<f64>::default(), "models/shapes/dominoes");
}

fn agree_on_pairs(module: &dyn Contacts<f64>, name: &str) {
    let interpreted = interpreted(name);
    let count = module.count(ComponentKind::Contact);
    let pairs: Vec<Option<usize>> = (0..count + 1).map(|contact| module.pair(contact)).collect();
    assert_eq!(pairs, (0..count + 1).map(|contact| interpreted.pair(contact)).collect::<Vec<_>>());
    let mut firsts: Vec<usize> = pairs.iter().copied().flatten().collect();
    firsts.dedup();
    assert!(firsts.len() > 2 && pairs.last() == Some(&None), "{pairs:?}");
    let mut random = Random::named(name);
    let [n, p] = [ComponentKind::Coordinate, ComponentKind::Speed].map(|kind| module.count(kind));
    for number in 0..200 {
        let q: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
        let u: Vec<f64> = (0..p).map(|_| random.between(-1.0, 1.0)).collect();
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
        let asked: Vec<usize> = (0..number % 7 + 2).map(|_| random.below(count)).collect();
        let found = several(module, &asked, &state);
        assert_eq!(found, several(&interpreted, &asked, &state), "{asked:?}");
        let found = found.unwrap();
        for (&contact, (distance, velocity)) in
            asked.iter().zip(found.distances.iter().zip(&found.velocities))
        {
            assert_eq!(distance.gap, module.gap(contact, &state).unwrap());
            assert_eq!(distance.validity, module.validity(contact, &state).unwrap());
            assert_eq!(*velocity, module.contact_velocity(contact, &state).unwrap());
        }
        let mut clearances = [vec![0.0; firsts.len()], vec![0.0; firsts.len()]];
        module.clearances(&firsts, &state, &mut clearances[0]).unwrap();
        interpreted.clearances(&firsts, &state, &mut clearances[1]).unwrap();
        assert_eq!(clearances[0], clearances[1]);
    }
    // numbers that no contact has, and contacts that are not the first of a pair
    let (q, u) = (vec![0.1; n], vec![0.0; p]);
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    for m in [module, &interpreted as &dyn Contacts<f64>] {
        let missing = Err(StateError::Missing { kind: ComponentKind::Contact, index: count });
        assert_eq!(m.gaps(&[0, count], &state, &mut [Distance::default(); 2]), missing);
        assert_eq!(m.clearances(&[count], &state, &mut [0.0]), missing);
        let undefined = Err(StateError::Undefined { what: "clearance of this contact" });
        assert_eq!(m.clearances(&[firsts[0] + 1], &state, &mut [0.0]), undefined);
    }
}
