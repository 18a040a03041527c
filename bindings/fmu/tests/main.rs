//! Units without an importer: the description and the functions agree, and what they compute is the motion of the simulation.
//! `bindings/fmu/test` tries units in FMPy.

use std::collections::HashSet;
use std::path::Path;

use hodograph::{Contacts, Law, State, Surface};
use hodograph_fmu::{Defaults, Instance, Kind, Layout, Refusal, VariableKind, description};
use hodograph_models::four_bar::FourBar;
use hodograph_models::planar_double_pendulum::PlanarDoublePendulum;
use hodograph_simulation::{Options, Simulation};
use serde_json::Value;

#[allow(missing_docs)]
mod emitted {
    hodograph::mechanism!("../../tests/data/doors/errors.mech");
}

const DEFAULTS: Defaults = Defaults { max_step: f64::INFINITY, surfaces: &[(0, 0.4, 0.5, "stronge")] };

fn pendulum() -> Box<dyn Contacts> {
    Box::new(PlanarDoublePendulum::<f64>::default())
}

fn unit(kind: Kind) -> Instance {
    let mut unit = Instance::new(pendulum, DEFAULTS, kind).unwrap();
    unit.enter_initialization(0.0).unwrap();
    unit.exit_initialization().unwrap();
    unit
}

#[test]
fn the_description_names_every_variable_once() {
    for mechanism in [pendulum(), Box::new(FourBar::<f64>::default())] {
        let text = description(&*mechanism, &DEFAULTS, "unit", "<token>", "a \"test\" & more").unwrap();
        let document = roxmltree::Document::parse(&text).unwrap();
        let layout = Layout::of(&*mechanism, &DEFAULTS).unwrap();
        let of = |name: &str| document.descendants().find(|node| node.has_tag_name(name)).unwrap();
        assert_eq!(document.root_element().attribute("instantiationToken"), Some("<token>"));
        let variables: Vec<_> = of("ModelVariables").children().filter(|node| node.is_element()).collect();
        assert_eq!(variables.len(), layout.variables.len());
        let mut names = HashSet::new();
        for (reference, (node, variable)) in variables.iter().zip(&layout.variables).enumerate() {
            assert_eq!(node.attribute("valueReference"), Some(&*reference.to_string()));
            assert_eq!(node.attribute("name"), Some(&*variable.name));
            assert!(names.insert(&variable.name), "{}", variable.name);
        }
        let structure: Vec<_> = of("ModelStructure").children().filter(|node| node.is_element()).collect();
        let count = |name: &str| structure.iter().filter(|node| node.has_tag_name(name)).count();
        assert_eq!(count("EventIndicator"), layout.indicators.len());
        let [_, coordinates, speeds, _] = &layout.start;
        assert_eq!(count("ContinuousStateDerivative"), coordinates.len() + speeds.len());
        for node in structure {
            let reference: usize = node.attribute("valueReference").unwrap().parse().unwrap();
            assert!(reference < variables.len());
        }
    }
}

#[test]
fn co_simulation_is_the_motion_of_the_simulation() {
    let mut unit = unit(Kind::CoSimulation);
    let mut states = [0.0; 4];
    unit.states(&mut states).unwrap();
    let mechanism = pendulum();
    let (q, u) = states.split_at(2);
    let state = State { time: 0.0, coordinates: q, speeds: u, inputs: &[] };
    let surface = Some(Surface { mu: 0.4, e: 0.5, law: Law::Stronge });
    let mut simulation =
        Simulation::new(&*mechanism, &state, Options { surface, ..Options::default() }).unwrap();
    let mut events = 0;
    for step in 0..150 {
        unit.do_step(f64::from(step) * 0.01, 0.01).unwrap();
        events += simulation.advance_to(f64::from(step + 1) * 0.01).unwrap().len();
        unit.states(&mut states).unwrap();
        let expected = [simulation.coordinates(), simulation.speeds()].concat();
        for (found, expected) in states.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-9, "{step}: {states:?} {expected:?}");
        }
    }
    let mut counted = [0];
    let reference = unit.layout().reference(VariableKind::Events).unwrap() as u32;
    unit.integers(&[reference], &mut counted).unwrap();
    assert!(events > 0);
    assert_eq!(counted[0], events as i64);
}

#[test]
fn an_image_continues_to_the_bit_and_others_are_refused() {
    let mut unit = unit(Kind::CoSimulation);
    unit.do_step(0.0, 0.4).unwrap();
    let image = unit.image().unwrap();
    let mut ends = Vec::new();
    for _ in 0..2 {
        unit.do_step(0.4, 0.6).unwrap();
        let mut states = [0.0; 4];
        unit.states(&mut states).unwrap();
        ends.push(states.map(f64::to_bits));
        unit.restore(&image).unwrap();
    }
    assert_eq!(ends[0], ends[1]);
    let time = unit.time();
    for length in 0..image.len() {
        assert!(unit.restore(&image[..length]).is_err(), "{length}");
    }
    // One of the other kind, and bytes that are none.
    let mut other = Instance::new(pendulum, DEFAULTS, Kind::ModelExchange).unwrap();
    assert!(other.restore(&image).is_err());
    let mut seed = 1_u32;
    for _ in 0..2000 {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let mut bytes = image.clone();
        let place = (seed >> 8) as usize % bytes.len();
        bytes[place] ^= 1 << (seed % 8);
        // Taken or refused, but never a panic.
        let _ = unit.restore(&bytes);
    }
    unit.restore(&image).unwrap();
    assert_eq!(unit.time(), time);
}

#[test]
fn calls_at_the_wrong_time_are_refused() {
    let mut fresh = Instance::new(pendulum, DEFAULTS, Kind::ModelExchange).unwrap();
    let refused = fresh.update_discrete_states().unwrap_err();
    assert_eq!(refused.0, "the call is not allowed now: the unit is instantiated, and not yet initialized");
    assert!(fresh.exit_initialization().is_err() && fresh.do_step(0.0, 0.1).is_err());
    // Nothing moves before the initialization, whose time is that of the motion.
    assert!(fresh.states(&mut [0.0; 4]).is_err() && fresh.rates(&mut [0.0; 4]).is_err());
    assert!(fresh.indicators(&mut []).is_err());
    let mut unit = unit(Kind::ModelExchange);
    assert!(unit.step_completed().is_err());
    assert!(unit.enter_initialization(0.0).is_err());
    unit.enter_continuous_time().unwrap();
    assert!(unit.set_states(&[0.0; 3]).is_err() && unit.set_states(&[f64::NAN; 4]).is_err());
    unit.set_states(&[0.1, 0.2, 0.0, 0.0]).unwrap();
    let mut rates = [0.0; 4];
    unit.rates(&mut rates).unwrap();
    unit.terminate().unwrap();
    assert!(unit.set_time(1.0).is_err());
    unit.reset();
    unit.enter_initialization(0.0).unwrap();
}

#[test]
fn a_contact_without_a_surface_is_refused() {
    let none = Defaults { max_step: 1.0, surfaces: &[] };
    let refused = Layout::of(&*pendulum(), &none).unwrap_err();
    assert_eq!(refused, "no_surface: contact tip_wall has no surface");
}

/// What a unit refuses, which is what it writes to the log of the importer.
fn refused(mistake: &Value) -> Result<(), Refusal> {
    let make: fn() -> Box<dyn Contacts> = || Box::new(emitted::errors::Errors::<f64>::default());
    let defaults = match &mistake["mu"] {
        Value::Null if mistake["call"] == "simulate" => Defaults { max_step: 1.0, surfaces: &[] },
        _ => DEFAULTS,
    };
    let exchange = mistake["call"] == "accelerations";
    let mut unit =
        Instance::new(make, defaults, if exchange { Kind::ModelExchange } else { Kind::CoSimulation })?;
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap());
    let reference = |name: &str, unit: &Instance| {
        unit.layout().variables.iter().position(|variable| variable.name == name).unwrap() as u32
    };
    let mut set = |name: &str, value: &Value| -> Result<(), Refusal> {
        if value.is_null() { Ok(()) } else { unit.set_floats(&[reference(name, &unit)], &[number(value)]) }
    };
    set("contacts.floor.mu", &mistake["mu"])?;
    set("contacts.floor.e", &mistake["e"])?;
    set("hodograph.tolerance", &mistake["tolerance"])?;
    let sections: &[&str] = if exchange { &["parameters"] } else { &["parameters", "q", "u"] };
    for section in sections {
        for (name, value) in mistake[section].as_object().into_iter().flatten() {
            set(name, value)?;
        }
    }
    if mistake["law"] == "hooke" {
        unit.set_integers(&[reference("contacts.floor.law", &unit)], &[9])?;
    }
    unit.enter_initialization(0.0)?;
    unit.exit_initialization()?;
    if !exchange {
        return unit.do_step(0.0, 0.1);
    }
    // The importer comes to the state while it integrates.
    unit.enter_continuous_time()?;
    let mut states = [0.0; 6];
    unit.states(&mut states)?;
    for (place, name) in ["s", "z", "a", "us", "uz", "ua"].into_iter().enumerate() {
        for section in ["q", "u"] {
            let value = &mistake[section][name];
            states[place] = if value.is_null() { states[place] } else { number(value) };
        }
    }
    unit.set_states(&states)?;
    unit.rates(&mut [0.0; 6])
}

#[test]
fn bad_input_has_the_errors_of_every_door() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/doors/errors.json");
    let mistakes: Vec<Value> = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut count = 0;
    for mistake in
        mistakes.iter().filter(|one| one["doors"].as_array().unwrap().iter().any(|door| door == "fmu"))
    {
        let Err(Refusal(said)) = refused(mistake) else { panic!("{mistake} is taken") };
        assert!(said.starts_with(&format!("{}: ", mistake["kind"].as_str().unwrap())), "{mistake}: {said}");
        assert!(said.contains(mistake["words"].as_str().unwrap()), "{mistake}: {said}");
        count += 1;
    }
    assert!(count > 10, "{count}");
}
