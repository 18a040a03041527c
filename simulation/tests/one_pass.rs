//! What is asked of several contacts, by generated modules and interpreted models in one pass, and by their single
//! methods: what forces of closed contacts follow from, gaps, and velocities.

use hodograph::nalgebra::Vector3;
use hodograph::{ClosedContacts, ComponentKind, Contacts, Distance, State, StateError};

use crate::{bipeds, bodies, many, table, tosses, tumbling};

/// Numbers of a mechanism with k contacts: rates of coordinates and of speeds, partial velocities, responses, velocities,
/// free accelerations.
type Numbers = [Vec<f64>; 6];

fn room(mechanism: &dyn Contacts<f64>, k: usize) -> Numbers {
    let (n, p) = (mechanism.count(ComponentKind::Coordinate), mechanism.count(ComponentKind::Speed));
    [n, p, 3 * p * k, 3 * p * k, 3 * k, 3 * k].map(|count| vec![0.0; count])
}

fn in_one_pass(
    mechanism: &dyn Contacts<f64>,
    contacts: &[usize],
    state: &State<'_>,
) -> Result<Numbers, StateError> {
    let mut numbers = room(mechanism, contacts.len());
    let [q, u, partial, response, velocity, free] = &mut numbers;
    let mut values = ClosedContacts {
        coordinate_rates: q,
        accelerations: u,
        partial_velocities: partial,
        responses: response,
        velocities: velocity,
        free_accelerations: free,
    };
    mechanism.closed_contacts(contacts, state, &mut values)?;
    Ok(numbers)
}

fn one_by_one(
    mechanism: &dyn Contacts<f64>,
    contacts: &[usize],
    state: &State<'_>,
) -> Result<Numbers, StateError> {
    let p = mechanism.count(ComponentKind::Speed);
    let mut numbers = room(mechanism, contacts.len());
    let [q, u, partial, response, velocity, free] = &mut numbers;
    mechanism.coordinate_rates(state, q)?;
    mechanism.accelerations(state, u)?;
    for (place, &contact) in contacts.iter().enumerate() {
        let (rows, three) = (3 * p * place..3 * p * (place + 1), 3 * place..3 * place + 3);
        mechanism.partial_velocities(contact, state, &mut partial[rows.clone()])?;
        mechanism.response(contact, state, &mut response[rows])?;
        velocity[three.clone()].copy_from_slice(mechanism.contact_velocity(contact, state)?.as_slice());
        free[three].copy_from_slice(mechanism.free_acceleration(contact, state)?.as_slice());
    }
    Ok(numbers)
}

/// Both have the same bits, of any contacts in any order.
fn check(mechanism: &dyn Contacts<f64>) {
    let count = |kind| mechanism.count(kind);
    let (mut q, mut u) =
        (vec![0.0; count(ComponentKind::Coordinate)], vec![0.0; count(ComponentKind::Speed)]);
    let mut inputs = vec![0.0; count(ComponentKind::Input)];
    mechanism.initial_state(&mut q, &mut u, &mut inputs).unwrap();
    let all: Vec<usize> = (0..count(ComponentKind::Contact)).rev().collect();
    for turn in 0..5 {
        q.iter_mut().enumerate().for_each(|(i, q)| *q += 0.02 * (1.7 * i as f64 + f64::from(turn)).sin());
        u.iter_mut().enumerate().for_each(|(i, u)| *u += 0.3 * (1.3 * i as f64 + f64::from(turn)).cos());
        mechanism.normalise(&mut q).unwrap();
        let state = State { time: 0.4, coordinates: &q, speeds: &u, inputs: &inputs };
        for contacts in [&all[..], &all[..1], &all[all.len() / 2..], &[]] {
            let together = in_one_pass(mechanism, contacts, &state).unwrap();
            let bits =
                |numbers: Numbers| numbers.map(|list| list.into_iter().map(f64::to_bits).collect::<Vec<_>>());
            let alone = one_by_one(mechanism, contacts, &state).unwrap();
            assert_eq!(bits(together), bits(alone), "{} {contacts:?}", mechanism.name());
            gaps_and_velocities(mechanism, contacts, &state);
        }
        let missing = in_one_pass(mechanism, &[all.len()], &state);
        assert!(matches!(missing, Err(StateError::Missing { .. })), "{missing:?}");
        let wrong = State { speeds: &u[1..], ..state };
        assert!(matches!(in_one_pass(mechanism, &all, &wrong), Err(StateError::Length { .. })));
    }
}

/// Gaps, validities and velocities have the same bits, too.
fn gaps_and_velocities(mechanism: &dyn Contacts<f64>, contacts: &[usize], state: &State<'_>) {
    let mut distances = vec![Distance::default(); contacts.len()];
    let mut velocities = vec![Vector3::zeros(); contacts.len()];
    mechanism.gaps(contacts, state, &mut distances).unwrap();
    mechanism.contact_velocities(contacts, state, &mut velocities).unwrap();
    let number = |length: Option<f64>| length.map(f64::to_bits);
    for (&contact, (distance, velocity)) in contacts.iter().zip(distances.iter().zip(&velocities)) {
        let (gap, validity) =
            (mechanism.gap(contact, state).unwrap(), mechanism.validity(contact, state).unwrap());
        let found = [distance.gap, distance.validity].map(number);
        assert_eq!(found, [gap, validity].map(number), "{} {contact}", mechanism.name());
        let alone = mechanism.contact_velocity(contact, state).unwrap();
        assert_eq!(velocity.map(f64::to_bits), alone.map(f64::to_bits), "{} {contact}", mechanism.name());
    }
    let (too_few, too_many) = (&mut distances[..], &mut vec![Vector3::zeros(); contacts.len() + 1]);
    if !too_few.is_empty() {
        let wrong = mechanism.gaps(contacts, state, &mut too_few[1..]);
        assert!(matches!(wrong, Err(StateError::Length { .. })), "{wrong:?}");
    }
    let wrong = mechanism.contact_velocities(contacts, state, too_many);
    assert!(matches!(wrong, Err(StateError::Length { .. })), "{wrong:?}");
    let missing = mechanism.gaps(&[usize::MAX, usize::MAX], state, &mut [Distance::default(); 2]);
    assert!(matches!(missing, Err(StateError::Missing { .. })), "{missing:?}");
}

macro_rules! shipped {
    ($($feature:literal $module:ident $mechanism:ident,)*) => {
        /// Those of the package of models that have all of it of their contacts.
        fn shipped() -> Vec<Box<dyn Contacts<f64>>> {
            vec![$(Box::new(hodograph_models::$module::$mechanism::<f64>::default())),*]
        }
    };
}
hodograph_models::every_mechanism!(shipped);

#[test]
fn one_pass_has_the_bits_of_the_single_methods() {
    check(&tumbling::tumbling_box::TumblingBox::<f64>::default());
    check(&bodies::rattleback_on_floor::RattlebackOnFloor::<f64>::default());
    check(&bodies::cradle::Cradle::<f64>::default());
    check(&bipeds::biped::Biped::<f64>::default());
    check(&tosses::measured_cube::MeasuredCube::<f64>::default());
    check(&table::table::Table::<f64>::default());
    check(&many::model("two_blocks"));
    check(&many::model("crate_on_table"));
    let mut checked = 0;
    for mechanism in shipped() {
        let count = |kind| mechanism.count(kind);
        let (mut q, mut u) =
            (vec![0.0; count(ComponentKind::Coordinate)], vec![0.0; count(ComponentKind::Speed)]);
        let mut inputs = vec![0.0; count(ComponentKind::Input)];
        mechanism.initial_state(&mut q, &mut u, &mut inputs).unwrap();
        let state = State { time: 0.4, coordinates: &q, speeds: &u, inputs: &inputs };
        let all: Vec<usize> = (0..count(ComponentKind::Contact)).collect();
        if count(ComponentKind::DependentCoordinate) == 0
            && !all.is_empty()
            && one_by_one(&*mechanism, &all, &state).is_ok()
        {
            check(&*mechanism);
            checked += 1;
        }
    }
    assert!(checked > 8, "{checked}");
}
