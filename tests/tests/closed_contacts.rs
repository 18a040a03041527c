//! Mode and force of closed contacts of all shipped models in random states: every state gives a result or an
//! error, and every result satisfies the laws of mechanics.
//!
//! `HODOGRAPH_STATES=100000 cargo test -p hodograph-tests --test all closed_contacts:: -- --nocapture` tries so many
//! states.

use crate::common::Model;
use crate::common::emitted::emitted;
use crate::common::random::{Random, Sample, samples};
use hodograph::nalgebra::{DMatrix, DVector, Vector3};
use hodograph::{
    ClosedContactError, CollisionError, ComponentKind, ContactError, ContactMode, ContactOutcome, Contacts,
    ImpactError, Law, Selection, State, Surface,
};
use hodograph_generator::numeric;

/// How many states are tried in all, about.
fn wanted() -> usize {
    std::env::var("HODOGRAPH_STATES").map_or(4000, |count| count.parse().expect("a number"))
}

/// What was met.
#[derive(Debug, Default)]
struct Met {
    states: usize,
    modes: [usize; 4],
    several: usize,
    indeterminate: usize,
    without_collision: usize,
    wedged: usize,
    jams: usize,
    none: usize,
    /// greatest error of Newton's law, of the terms
    newton: f64,
    /// the same by the numeric evaluation of the model
    second_road: f64,
}

/// A matrix that a routine writes by rows.
fn rows(
    r: usize,
    c: usize,
    write: impl FnOnce(&mut [f64]) -> Result<(), hodograph::StateError>,
) -> DMatrix<f64> {
    let mut numbers = vec![f64::NAN; r * c];
    write(&mut numbers).expect("a regular state");
    DMatrix::from_row_slice(r, c, &numbers)
}

/// Speeds whose contact has no normal velocity, and with `rest` no slip, as nearly as rounding permits.
fn closed_speeds(m: &dyn Contacts, contact: usize, state: &State<'_>, rest: bool) -> Option<Vec<f64>> {
    let p = state.speeds.len();
    let mut speeds = state.speeds.to_vec();
    // Twice: the second time removes the rounding of the first.
    for _ in 0..2 {
        let state = State { speeds: &speeds, ..*state };
        let here = m.contact_state(contact, &state).ok()?;
        let response = rows(p, 3, |x| m.response(contact, &state, x));
        let matrix = hodograph::nalgebra::Matrix3::from(here.reduced);
        let impulse = if rest {
            matrix.pseudo_inverse(1e-9 * matrix.amax()).ok()? * -here.velocity
        } else {
            Vector3::new(-here.velocity.x / here.reduced.nn, 0.0, 0.0)
        };
        let change = response * impulse;
        speeds.iter_mut().zip(change.iter()).for_each(|(speed, change)| *speed += change);
    }
    // What can only stand still stands still.
    let fastest = |speeds: &[f64]| speeds.iter().fold(0.0_f64, |top, speed| top.max(speed.abs()));
    if fastest(&speeds) < 1e-12 * fastest(state.speeds) {
        speeds.fill(0.0);
    }
    Some(speeds)
}

/// Newton's law in full, M u' = forcing + V^T lambda, as a share of its terms.
fn newton(m: &dyn Contacts, contact: usize, state: &State<'_>, rates: &[f64], force: &Vector3<f64>) -> f64 {
    let p = rates.len();
    let mass = rows(p, p, |x| m.mass_matrix(state, x));
    let forcing = rows(p, 1, |x| m.forcing(state, x));
    let partial = rows(3, p, |x| m.partial_velocities(contact, state, x));
    let rates = DVector::from_column_slice(rates);
    let pushed = partial.transpose() * force;
    let left = &mass * &rates - &forcing - &pushed;
    let terms =
        (mass.abs() * rates.abs()).amax() + forcing.amax() + (partial.abs().transpose() * force.abs()).amax();
    left.amax() / terms.max(f64::MIN_POSITIVE)
}

/// The same with the numbers of the numeric evaluation, which shares nothing with the derivation but the
/// meaning of the model.
fn second_road(
    model: &Model,
    sample: &Sample,
    contact: usize,
    speeds: &[f64],
    rates: &[f64],
    force: &Vector3<f64>,
) -> f64 {
    let mut state = sample.state.clone();
    state.speeds.copy_from_slice(speeds);
    let numeric = numeric::evaluate(&model.mechanism, &state).expect("a regular state");
    let (mut worst, mut terms) = (0.0_f64, f64::MIN_POSITIVE);
    for (row, forcing) in numeric.mass_matrix.iter().zip(&numeric.forcing) {
        let at = numeric.forcing.iter().position(|x| std::ptr::eq(x, forcing)).expect("its place");
        let pushed = Vector3::from(numeric.contacts[contact].partial_velocities[at]).dot(force);
        let inertia: f64 = row.iter().zip(rates).map(|(mass, rate)| mass * rate).sum();
        worst = worst.max((inertia - forcing - pushed).abs());
        terms = terms.max(inertia.abs()).max(forcing.abs()).max(pushed.abs());
    }
    worst / terms
}

/// Coulomb's and Signorini's laws, as a share of the terms.
fn laws(answer: &ContactOutcome<f64>, mu: f64) -> f64 {
    let (force, a) = (answer.answer.force, answer.answer.acceleration);
    let m = hodograph::nalgebra::Matrix3::from(answer.reduced);
    let beta = answer.free_acceleration;
    let size = beta.amax() + (m.abs() * force.abs()).amax();
    let pressed = force.amax().max(f64::MIN_POSITIVE);
    // Forces of a contact that is nearly wedged follow from differences of much larger terms.
    let rounding = 1.0 + m.amax() * force.amax() / beta.amax().max(f64::MIN_POSITIVE);
    let friction = force.yz();
    let mut worst = (m * force + beta - a).amax() / size.max(f64::MIN_POSITIVE);
    worst = worst.max(-force.x / pressed / rounding);
    worst = worst.max((friction.norm() - mu * force.x) / pressed / rounding / (1.0 + mu));
    match answer.answer.mode {
        ContactMode::Separate => {
            assert_eq!(force, Vector3::zeros());
            assert!(a.x >= 0.0);
        }
        ContactMode::Stick => worst = worst.max(a.amax() / size),
        ContactMode::Slide | ContactMode::BeginSlip => {
            let d = answer.answer.direction.expect("a direction");
            worst = worst.max(a.x.abs() / size);
            worst = worst.max((friction + d * (mu * force.x)).norm() / pressed / (1.0 + mu));
            if answer.answer.mode == ContactMode::BeginSlip {
                let along = a.yz().dot(&d);
                assert!(along > 0.0);
                worst = worst.max((a.yz() - d * along).norm() / size);
            } else {
                let slip = answer.velocity.yz();
                worst = worst.max((slip / slip.norm() - d).norm());
            }
        }
    }
    worst
}

/// One state of one contact.
fn one(
    m: &dyn Contacts,
    contact: usize,
    state: &State<'_>,
    rest: bool,
    surface: &Surface<f64>,
    met: &mut Met,
) -> Option<ContactOutcome<f64>> {
    met.states += 1;
    let mut rates = vec![f64::NAN; state.speeds.len()];
    let place = format!("{} {contact} {state:?} {surface:?}", m.name());
    match m.contact_mode(contact, state, surface, &mut rates) {
        Ok(answer) => {
            met.modes[answer.answer.mode as usize] += 1;
            met.several += usize::from(answer.answer.selection == Selection::SeveralModes);
            met.indeterminate += usize::from(answer.answer.selection == Selection::Indeterminate);
            let worst = laws(&answer, surface.mu);
            assert!(worst <= 1e-12, "{place}: {worst:e}\n{answer:?}");
            let worst = newton(m, contact, state, &rates, &answer.answer.force);
            met.newton = met.newton.max(worst);
            assert!(worst <= 1e-12, "{place}: Newton's law is off by {worst:e}\n{answer:?}");
            assert!(!rest || answer.answer.mode != ContactMode::Slide, "{place}: rounding slides");
            assert!(answer.answer.margins.ended().is_none() || answer.answer.mode != ContactMode::Slide);
            return Some(answer);
        }
        Err(ClosedContactError::Contact(ContactError::ImpactWithoutCollision { f, free_acceleration })) => {
            met.without_collision += 1;
            assert!(f < 0.0 && free_acceleration < 0.0, "{place}");
            let mut speeds = vec![f64::NAN; state.speeds.len()];
            let hit = match m.impact_without_collision(contact, state, surface, &mut speeds) {
                Ok(hit) => hit,
                // No impulse ends the approach of a contact with one or two freedoms that wedges.
                Err(CollisionError::Impact(ImpactError::Wedged { .. })) => {
                    met.wedged += 1;
                    return None;
                }
                Err(other) => panic!("{place}: {other:?}"),
            };
            let impulse = hit.impact.impulse;
            assert!(hit.impact.velocity.x >= -1e-12 && impulse.x > 0.0, "{place}: {hit:?}");
            assert!(impulse.yz().norm() <= surface.mu * impulse.x * (1.0 + 1e-12), "{place}: {hit:?}");
            // Momentum: M (u2 - u1) = V^T I along N.
            let p = state.speeds.len();
            let mass = rows(p, p, |x| m.mass_matrix(state, x));
            let partial = rows(3, p, |x| m.partial_velocities(contact, state, x));
            let here = m.contact_state(contact, state).expect("a regular state");
            let on = hit.impulse_on_point;
            let along = Vector3::new(here.normal.dot(&on), here.first.dot(&on), here.second.dot(&on));
            let change = DVector::from_fn(p, |i, _| speeds[i] - state.speeds[i]);
            let left = &mass * change - partial.transpose() * along;
            let terms = (partial.abs().transpose() * along.abs()).amax()
                + (mass.abs() * DVector::from_column_slice(&speeds).abs()).amax();
            assert!(left.amax() <= 1e-12 * terms, "{place}: {:e}", left.amax() / terms);
        }
        Err(ClosedContactError::Contact(ContactError::Jam { .. })) => met.jams += 1,
        Err(ClosedContactError::Contact(ContactError::NoMode { .. })) => met.none += 1,
        Err(other) => panic!("{place}: {other:?}"),
    }
    None
}

#[test]
fn every_state_of_every_contact_has_an_answer_or_a_reason() {
    let modules = emitted();
    let contacts: usize =
        modules.iter().map(|module| Model::load(module.name()).mechanism.contacts.len()).sum();
    let speeds_of_each = 64;
    let places = wanted().div_ceil(contacts * speeds_of_each);
    let mut met = Met::default();
    for module in &modules {
        let model = Model::load(module.name());
        let mut random = Random::named(module.name());
        for sample in samples(&model, places) {
            let m = module.by_slices(&sample.inputs);
            for contact in 0..m.count(ComponentKind::Contact) {
                for case in 0..speeds_of_each {
                    let size = 10.0_f64.powf(1.5 * random.number());
                    let speeds: Vec<f64> =
                        sample.inputs.speeds.iter().map(|_| size * random.number()).collect();
                    let at = State {
                        time: sample.inputs.time,
                        coordinates: &sample.inputs.coordinates,
                        speeds: &speeds,
                        inputs: &sample.inputs.inputs,
                    };
                    let rest = case % 2 == 0;
                    let Some(speeds) = closed_speeds(&*m, contact, &at, rest) else { continue };
                    let at = State { speeds: &speeds, ..at };
                    let mu = if case % 9 == 0 { 0.0 } else { 1.5 + 1.5 * random.number() };
                    let law = if case % 4 < 2 { Law::Poisson } else { Law::Stronge };
                    let surface = Surface { mu, e: 0.5, law };
                    // Where motion is prescribed nothing may bring the slip to rest.
                    let slip = m.contact_velocity(contact, &at).expect("a regular state").yz().norm();
                    let rests = rest && slip < 1e-12 * size;
                    let answer = one(&*m, contact, &at, rests, &surface, &mut met);
                    if let Some(answer) = answer.filter(|_| case < 4) {
                        let mut rates = vec![0.0; speeds.len()];
                        let again = m.contact_mode(contact, &at, &surface, &mut rates).expect("as before");
                        assert_eq!(again, answer);
                        let force = answer.force_on_point;
                        let worst = second_road(&model, &sample, contact, &speeds, &rates, &force);
                        met.second_road = met.second_road.max(worst);
                        assert!(worst <= 1e-12, "{} {contact}: {worst:e}", module.name());
                    }
                }
            }
        }
    }
    println!("{met:#?}");
    assert!(met.states >= wanted() / 2, "{met:?}");
    assert!(met.modes.iter().all(|&count| count > met.states / 100), "{met:?}");
    assert!(met.without_collision > met.states / 400, "{met:?}");
}

/// Where a finite force exists, there is no impact without collision.
#[test]
fn an_impact_without_collision_is_refused_where_a_force_exists() {
    for module in &emitted() {
        let model = Model::load(module.name());
        let sample = &samples(&model, 1)[0];
        let m = module.by_slices(&sample.inputs);
        let at = State {
            time: sample.inputs.time,
            coordinates: &sample.inputs.coordinates,
            speeds: &sample.inputs.speeds,
            inputs: &sample.inputs.inputs,
        };
        for contact in 0..m.count(ComponentKind::Contact) {
            let mut speeds = vec![0.0; at.speeds.len()];
            let surface = Surface { mu: 0.0, e: 0.5, law: Law::Poisson };
            let answer = m.impact_without_collision(contact, &at, &surface, &mut speeds);
            assert!(
                matches!(answer, Err(CollisionError::Impact(ImpactError::NoImpact { .. }))),
                "{} {contact}: {answer:?}",
                module.name()
            );
        }
    }
}
