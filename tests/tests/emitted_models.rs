//! The emitted modules of all shipped models compute the same bits as the interpreter, and their collisions
//! satisfy the laws of mechanics.

use crate::common::emitted::{Emitted, Hit, emitted};
use crate::common::random::{Random, samples};
use crate::common::{Model, models, root};
use hodograph::lanes::Lanes;
use hodograph::{Law, Surface};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::{ContactQuantity as C, Quantity as Q};

#[test]
fn every_model_has_its_module() {
    let read = |path: &str| std::fs::read_to_string(root().join(path)).expect(path);
    let (library, package) = (read("models/src/lib.rs"), read("models/Cargo.toml"));
    for Model { name, .. } in models() {
        let lines = format!("#[cfg(feature = \"{name}\")]\nmechanism!(\"{name}.mech\");");
        assert!(library.contains(&lines), "add to models/src/lib.rs:\n{lines}");
        let (feature, of_all) = (format!("\n{name} = []\n"), format!("\n    \"{name}\",\n"));
        assert!(package.contains(&feature), "add the feature `{name} = []` to models/Cargo.toml");
        assert!(package.contains(&of_all), "add \"{name}\" to the feature `all` in models/Cargo.toml");
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
        let mechanism = &model.mechanism;
        let mut tried = 0;
        for sample in samples(model, 5) {
            let directions = mechanism.independent_states() + mechanism.inputs.len();
            let tangent = (0..directions).map(|i| 1.0 - 0.3 * i as f64).collect();
            let at = &Inputs { tangent, ..sample.inputs };
            for output in &model.program.outputs {
                let quantity = output.quantity;
                if let Some(value) = module.get(mechanism, quantity, at) {
                    assert_eq!(value, model.get(at, quantity).values, "{} {quantity:?}", module.name());
                    tried += 1;
                }
            }
        }
        assert!(tried >= 5 * 8, "{}: {tried}", module.name());
    }
}

/// A routine in place overwrites everything with the bits of the routine of the same name; those of the slices
/// are compared in `mechanisms_by_slices.rs`.
#[test]
fn in_place_the_same_bits() {
    for (module, model) in &pairs() {
        assert!(module.in_place().contains(&"mass_matrix"), "{}", module.name());
        let directions = model.mechanism.independent_states() + model.mechanism.inputs.len();
        let tangent: Vec<f64> = (0..directions).map(|i| 1.0 - 0.3 * i as f64).collect();
        for sample in samples(model, 3) {
            let at = &Inputs { tangent: tangent.clone(), ..sample.inputs };
            for routine in module.in_place() {
                let bits = |name: &str| {
                    let answer = module.call(name, at).expect("a routine");
                    answer.map(|numbers| numbers.into_iter().map(f64::to_bits).collect::<Vec<_>>())
                };
                let (by_value, in_place) = (bits(routine), bits(&format!("{routine}_into")));
                assert!(by_value.is_ok(), "{}::{routine}: {by_value:?}", module.name());
                assert_eq!(by_value, in_place, "{}::{routine}", module.name());
            }
        }
    }
}

/// Values and derivatives of four states at once have the bits that they have one by one, and fail where one of
/// the four fails. With `HODOGRAPH_STATES` in the environment so many states are taken of each model.
#[test]
fn in_lanes_the_same_bits() {
    let states = std::env::var("HODOGRAPH_STATES").map_or(200, |text| text.parse().expect("a number"));
    let (mut compared, mut failed) = (0, 0);
    for (module, model) in &pairs() {
        let regular: Vec<Inputs> = samples(model, 4).into_iter().map(|sample| sample.inputs).collect();
        assert!(module.of_lanes().contains(&"accelerations"), "{}", module.name());
        let mut random = Random::named(module.name());
        for block in 0..states / 4 {
            // one block in eight has a state that is no number
            let at = four(&regular, &mut random, block % 8 == 7);
            for routine in module.of_lanes() {
                let singly = at.each_ref().map(|at| module.call(routine, at).expect("a routine"));
                match module.in_lanes(routine, &at).expect("a routine") {
                    Ok(together) => {
                        for (lane, single) in singly.iter().enumerate() {
                            let single = single
                                .as_ref()
                                .unwrap_or_else(|error| panic!("{}::{routine}: {error}", module.name()));
                            let together = together.iter().map(|numbers| numbers.lane(lane).to_bits());
                            assert!(
                                together.eq(single.iter().map(|number| number.to_bits())),
                                "{}::{routine}, lane {lane} of {at:?}",
                                module.name()
                            );
                            compared += single.len();
                        }
                    }
                    Err(error) => {
                        assert!(singly.contains(&Err(error)), "{}::{routine}: {singly:?}", module.name());
                        failed += 1;
                    }
                }
            }
        }
    }
    println!("{compared} numbers compared, {failed} blocks with a state that fails");
    assert!(compared > 1000 * states && failed > states / 10);
}

/// Four states near regular ones.
fn four(regular: &[Inputs], random: &mut Random, spoiled: bool) -> [Inputs; 4] {
    let mut all: [Inputs; 4] = std::array::from_fn(|lane| regular[lane].clone());
    for at in &mut all {
        let lists = [&mut at.coordinates, &mut at.speeds, &mut at.inputs, &mut at.accelerations];
        lists.into_iter().flatten().for_each(|number| *number += 0.3 * random.number());
    }
    if spoiled && let Some(number) = all[2].coordinates.first_mut() {
        *number = f64::NAN;
    }
    all
}

/// `mass_matrix_lower` has the bits of one triangle of `mass_matrix`; where that has one entry only, there is
/// no such method.
#[test]
fn one_triangle_of_the_mass_matrix() {
    let mut tried = 0;
    for (module, model) in &pairs() {
        let p = model.freedom();
        for sample in samples(model, 3) {
            let lower = module.call("mass_matrix_lower", &sample.inputs);
            assert_eq!(lower.is_some(), p > 1, "{}", module.name());
            let Some(lower) = lower else { continue };
            let whole = model.get(&sample.inputs, Q::MassMatrix).values;
            let of_row = |row: usize| whole[row * p..=row * p + row].iter().copied();
            assert_eq!(lower, Ok((0..p).flat_map(of_row).collect()), "{}", module.name());
            tried += 1;
        }
    }
    let several = pairs().iter().filter(|(_, model)| model.freedom() > 1).count();
    assert_eq!(tried, 3 * several);
}

/// Every quantity that a derivation delivers has a routine, but for those that only collisions use.
#[test]
fn every_quantity_has_a_routine() {
    for (module, model) in &pairs() {
        let at = &samples(model, 1)[0].inputs;
        for output in model.program.outputs.iter().filter(|output| !output.values.is_empty()) {
            let inner = matches!(
                output.quantity,
                Q::Contact(_, C::Normal | C::First | C::Second | C::DependentResponse | C::PrescribedWork)
            );
            let at = Inputs {
                tangent: vec![0.0; model.mechanism.independent_states() + at.inputs.len()],
                ..at.clone()
            };
            let there = module.get(&model.mechanism, output.quantity, &at).is_some();
            assert!(there || inner, "{}: {:?}", module.name(), output.quantity);
        }
    }
}

/// A column of the linearised equations is the directional derivative of the accelerations that the program
/// delivers, but for rounding.
#[test]
fn linearisation_is_made_of_tangents() {
    for (module, model) in &pairs() {
        let m = &model.mechanism;
        let Some(output) = model.program.output(Q::StateTangent) else { continue };
        let (states, inputs) = (m.independent_states(), m.inputs.len());
        assert_eq!(output.rows, states);
        let at = &samples(model, 1)[0].inputs;
        let both = module.call("linearise", at).expect("a linearisation").expect("a regular state");
        let (a, b) = both.split_at(states * states);
        for column in 0..states + inputs {
            let tangent = (0..states + inputs).map(|i| f64::from(u8::from(i == column))).collect();
            let expected = model.get(&Inputs { tangent, ..at.clone() }, Q::StateTangent).values;
            let column: Vec<f64> = (0..states)
                .map(|row| {
                    if column < states { a[row * states + column] } else { b[row * inputs + column - states] }
                })
                .collect();
            let size = expected.iter().fold(1.0_f64, |size, entry| size.max(entry.abs()));
            let off = column.iter().zip(&expected).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
            assert!(off <= 1e-11 * size, "{} off by {off:e} of {size:e}", module.name());
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

/// Collides at a state, turned round if the bodies separate there; the number of collisions that have an
/// outcome.
fn collide(module: &dyn Emitted, model: &Model, contact: usize, at: &Inputs) -> usize {
    let mut at = at.clone();
    if approach(module, model, contact, &at) > 0.0 {
        at.speeds.iter_mut().for_each(|u| *u = -*u);
    }
    // With prescribed motion turning round need not make the bodies approach.
    if approach(module, model, contact, &at) > -1e-3 {
        return 0;
    }
    let mut solved = 0;
    for &law in Law::ALL {
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
    let n = approach(module, model, contact, &after);
    let size = speed + 1e-3 * hit.speeds.iter().fold(0.0_f64, |size, u| size.max(u.abs()));
    assert!((n - hit.separation[0]).abs() <= 1e-9 * size, "{name}: {n}");
    // (24): the change of energy that is reported is that of the kinetic energy.
    let gained = kinetic_energy(module, model, &after) - kinetic_energy(module, model, at);
    let scale = impulse * speed + 1e-2 * kinetic_energy(module, model, at).abs() + 1e-12;
    assert!((gained - hit.energy_change).abs() <= 1e-9 * scale, "{name}: {gained}");
    if surface.law == Law::Stronge {
        assert!(hit.contact_work <= 1e-12 * impulse * speed, "{name}");
    }
}

/// Velocity of the contact along its normal.
fn approach(module: &dyn Emitted, model: &Model, contact: usize, at: &Inputs) -> f64 {
    let quantity = Q::Contact(contact as u32, C::Velocity);
    module.get(&model.mechanism, quantity, at).expect("a velocity")[0]
}

fn kinetic_energy(module: &dyn Emitted, model: &Model, at: &Inputs) -> f64 {
    module.get(&model.mechanism, Q::KineticEnergy, at).expect("a kinetic energy")[0]
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
