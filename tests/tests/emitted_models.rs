//! The emitted modules of all shipped models compute the bits that the interpreter computes, and their collisions obey mechanics.

mod common;

use common::emitted::{Emitted, Hit, emitted};
use common::random::samples;
use common::{Model, models};
use hodograph::{Law, Surface};
use hodograph_generator::interpret::Inputs;
use hodograph_generator::program::routine::{ContactQuantity as C, Quantity as Q};

#[test]
fn every_model_has_its_module() {
    let modules: Vec<&str> = emitted().iter().map(|module| module.name()).collect();
    for model in models() {
        let name = model.name;
        assert!(
            modules.contains(&name.as_str()),
            "add `{name}` to `modules!` at the end of tests/tests/common/emitted.rs, and to models/src/lib.rs"
        );
    }
}

/// The modules with their models.
fn pairs() -> Vec<(Box<dyn Emitted>, Model)> {
    let with_model = |module: Box<dyn Emitted>| {
        let model = Model::load(module.name());
        (module, model)
    };
    emitted().into_iter().map(with_model).collect()
}

#[test]
fn the_same_bits_as_the_interpreter() {
    for (module, model) in &pairs() {
        for sample in samples(model, 5) {
            let at = &sample.inputs;
            let get = |quantity| model.get(at, quantity).values;
            let name = module.name();
            assert_eq!(module.mass_matrix(at), get(Q::MassMatrix), "{name}");
            assert_eq!(module.forcing(at), get(Q::Forcing), "{name}");
            assert_eq!(module.accelerations(at), get(Q::Accelerations), "{name}");
            assert_eq!(module.coordinate_rates(at), get(Q::CoordinateRates), "{name}");
            assert_eq!(module.dependent_speeds(at), get(Q::DependentSpeeds), "{name}");
            assert_eq!([module.kinetic_energy(at)], get(Q::KineticEnergy)[..], "{name}");
            for contact in 0..model.mechanism.contacts.len() {
                let get = |quantity| get(Q::Contact(contact as u32, quantity));
                assert_eq!(module.reduced_matrix(contact, at), get(C::Reduced)[..], "{name}");
                assert_eq!(module.partial_velocities(contact, at), get(C::PartialVelocities), "{name}");
                assert_eq!(module.contact_velocity(contact, at), get(C::Velocity)[..], "{name}");
            }
        }
    }
}

#[test]
fn collisions_obey_mechanics() {
    let mut solved = 0;
    for (module, model) in &pairs() {
        for sample in samples(model, 5) {
            for contact in 0..model.mechanism.contacts.len() {
                solved += collide(&**module, model, contact, &sample.inputs);
            }
        }
    }
    assert!(solved > 500, "{solved} collisions");
}

/// Collides at a state, turned round if the bodies separate there; the number of collisions that have an outcome.
fn collide(module: &dyn Emitted, model: &Model, contact: usize, at: &Inputs) -> usize {
    let mut at = at.clone();
    if module.contact_velocity(contact, &at)[0] > 0.0 {
        at.speeds.iter_mut().for_each(|u| *u = -*u);
    }
    // With prescribed motion turning round need not make the bodies approach.
    if module.contact_velocity(contact, &at)[0] > -1e-3 {
        return 0;
    }
    let mut solved = 0;
    for law in [Law::Newton, Law::Poisson, Law::Stronge] {
        for (mu, e) in [(0.0, 0.5), (0.3, 0.0), (0.6, 0.7), (1.4, 0.9)] {
            let surface = Surface { mu, e, law };
            match module.collide(contact, &at, &surface) {
                Ok(hit) => {
                    check(module, model, contact, &at, &surface, &hit);
                    solved += 1;
                }
                Err(message) => assert!(message.contains("wedge"), "{}: {message}", module.name()),
            }
        }
    }
    solved
}

fn check(
    module: &dyn Emitted,
    model: &Model,
    contact: usize,
    at: &Inputs,
    surface: &Surface<f64>,
    hit: &Hit,
) {
    let name = format!("{} {surface:?} {hit:?}", module.name());
    let [i_n, i_t, i_s] = hit.impulse;
    let (speed, impulse) = (norm(&hit.approach) + norm(&hit.separation), norm(&hit.impulse));
    // The approach: t along the slip.
    assert!(hit.approach[1] >= 0.0 && hit.approach[2].abs() <= 1e-12 * speed, "{name}");
    // The reduced equations (20)-(22).
    let [nn, nt, ns, tt, ts, ss] = hit.reduced;
    let change =
        [nn * i_n + nt * i_t + ns * i_s, nt * i_n + tt * i_t + ts * i_s, ns * i_n + ts * i_t + ss * i_s];
    for ((after, before), change) in hit.separation.iter().zip(hit.approach).zip(change) {
        let bound = 1e-11 * (speed + norm(&[nn, tt, ss]) * impulse);
        assert!((after - before - change).abs() <= bound, "{name}");
    }
    // Coulomb's law in the large, and separation.
    assert!(i_t.hypot(i_s) <= surface.mu * i_n * (1.0 + 1e-10) + 1e-14, "{name}");
    assert!(i_n > 0.0 && hit.separation[0] >= -1e-11 * speed, "{name}");
    // (12a) ends at the velocity of separation.
    let after = Inputs { speeds: hit.speeds.clone(), ..at.clone() };
    let [n, ..] = module.contact_velocity(contact, &after);
    let size = speed + 1e-3 * hit.speeds.iter().fold(0.0_f64, |size, u| size.max(u.abs()));
    assert!((n - hit.separation[0]).abs() <= 1e-9 * size, "{name}: {n}");
    // (24): the change of energy that is reported is that of the kinetic energy.
    let gained = module.kinetic_energy(&after) - module.kinetic_energy(at);
    let scale = impulse * speed + 1e-2 * module.kinetic_energy(at).abs() + 1e-12;
    assert!((gained - hit.energy_change).abs() <= 1e-9 * scale, "{name}: {gained}");
    if surface.law == Law::Stronge {
        assert!(hit.contact_work <= 1e-12 * impulse * speed, "{name}");
    }
    let _ = model;
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
