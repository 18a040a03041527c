//! The traits `Mechanism` and `Contacts`: generated modules and the interpreter compute the same bits, and
//! the same as the modules' own methods.

use crate::common::Model;
use crate::common::emitted::{Emitted, emitted, routine};
use crate::common::random::samples;
use hodograph::nalgebra::Vector3;
use hodograph::{
    ClosedContactError, CollisionError, ComponentKind, ContactMode, Contacts, ImpactError, Law,
    ParameterError, State, StateError, Surface,
};
use hodograph_generator::program::{ContactQuantity as C, Inputs, PointQuantity as P, Quantity as Q};
use hodograph_interpreter::InterpretedMechanism;

/// A module, and the interpreter at the same parameters.
fn both(module: &dyn Emitted, model: &Model, at: &Inputs) -> [Box<dyn Contacts>; 2] {
    let interpreted =
        InterpretedMechanism::with_parameters(model.mechanism.clone(), model.program.clone(), &at.parameters);
    [module.by_slices(at), Box::new(interpreted.expect("a mechanism"))]
}

fn state(at: &Inputs) -> State<'_> {
    State { time: at.time, coordinates: &at.coordinates, speeds: &at.speeds, inputs: &at.inputs }
}

/// All numbers that the traits tell of a state, each with its name.
fn everything(m: &dyn Contacts, state: &State<'_>) -> Vec<(String, Result<Vec<f64>, StateError>)> {
    let [n, p, d, c] = [
        ComponentKind::Coordinate,
        ComponentKind::Speed,
        ComponentKind::DependentSpeed,
        ComponentKind::DependentCoordinate,
    ]
    .map(|kind| m.count(kind));
    let mut all = Vec::new();
    let mut put = |name: String, numbers| all.push((name, numbers));
    let slice = |size: usize, write: &dyn Fn(&mut [f64]) -> Result<(), StateError>| {
        let mut numbers = vec![f64::NAN; size];
        write(&mut numbers).map(|()| numbers)
    };
    let accelerations: Vec<f64> = (0..p).map(|i| 0.7 - 0.4 * i as f64).collect();
    put("coordinate_rates".into(), slice(n, &|x| m.coordinate_rates(state, x)));
    put("accelerations".into(), slice(p, &|x| m.accelerations(state, x)));
    put("dependent_speeds".into(), slice(d, &|x| m.dependent_speeds(state, x)));
    put("dependent_accelerations".into(), slice(d, &|x| m.dependent_accelerations(state, x)));
    put("mass_matrix".into(), slice(p * p, &|x| m.mass_matrix(state, x)));
    put("forcing".into(), slice(p, &|x| m.forcing(state, x)));
    put("inverse_dynamics".into(), slice(p, &|x| m.inverse_dynamics(state, &accelerations, x)));
    put("kinetic_energy".into(), m.kinetic_energy(state).map(|energy| vec![energy]));
    put("potential_energy".into(), m.potential_energy(state).map(|energy| energy.into_iter().collect()));
    put(
        "configuration".into(),
        slice(c + c * c, &|x| {
            let (residual, jacobian) = x.split_at_mut(c);
            m.configuration(state, residual, jacobian)
        }),
    );
    let three = |v: Vector3<f64>| v.as_slice().to_vec();
    for i in 0..m.count(ComponentKind::Point) {
        put(format!("position {i}"), m.position(i, state).map(three));
        put(format!("velocity {i}"), m.velocity(i, state).map(three));
        put(format!("acceleration {i}"), m.acceleration(i, state, &accelerations).map(three));
        put(format!("jacobian {i}"), slice(3 * p, &|x| m.jacobian(i, state, x)));
    }
    for i in 0..m.count(ComponentKind::Quantity) {
        let (rows, columns) = m.quantity_shape(i).expect("a shape");
        put(format!("quantity {i}"), slice(rows * columns, &|x| m.quantity(i, state, x)));
    }
    for i in 0..m.count(ComponentKind::Point) {
        put(format!("angular momentum about {i}"), m.angular_momentum_about(i, state).map(three));
    }
    for i in 0..m.count(ComponentKind::Frame) {
        put(
            format!("orientation {i}"),
            m.orientation(i, state).map(|axes| axes.transpose().as_slice().to_vec()),
        );
    }
    for i in 0..m.count(ComponentKind::Contact) {
        put(
            format!("contact_state {i}"),
            m.contact_state(i, state).map(|contact| {
                let reduced: [f64; 6] = contact.reduced.into();
                let vectors =
                    [contact.normal, contact.first, contact.second, contact.velocity].map(three).concat();
                [vectors, reduced.to_vec(), contact.gap.into_iter().collect()].concat()
            }),
        );
        put(format!("gap {i}"), m.gap(i, state).map(|gap| gap.into_iter().collect()));
        put(format!("contact_velocity {i}"), m.contact_velocity(i, state).map(three));
        put(format!("free_acceleration {i}"), m.free_acceleration(i, state).map(three));
        put(format!("partial_velocities {i}"), slice(3 * p, &|x| m.partial_velocities(i, state, x)));
        put(format!("response {i}"), slice(3 * p, &|x| m.response(i, state, x)));
    }
    all
}

#[test]
fn modules_and_the_interpreter_answer_with_the_same_bits() {
    let mut refused = 0;
    for module in &emitted() {
        let model = Model::load(module.name());
        for sample in samples(&model, 3) {
            let at = &sample.inputs;
            let [generated, interpreted] = both(&**module, &model, at);
            let state = state(at);
            let (a, b) = (everything(&*generated, &state), everything(&*interpreted, &state));
            assert!(a.iter().filter(|(_, numbers)| numbers.is_ok()).count() >= 8, "{}", module.name());
            // At a regular state only what the model leaves open has no number: positions of points,
            // orientations of frames.
            for (name, numbers) in &a {
                let open = ["position", "orientation", "angular momentum about"];
                let open = open.iter().any(|open| name.starts_with(open));
                assert!(numbers.is_ok() || open, "{} {name}: {numbers:?}", module.name());
            }
            for ((name, a), (_, b)) in a.iter().zip(&b) {
                assert_eq!(a, b, "{} {name}", module.name());
            }
            for &law in Law::ALL {
                for contact in 0..generated.count(ComponentKind::Contact) {
                    let surface = Surface { mu: 0.4, e: 0.6, law };
                    let collide = |m: &dyn Contacts| {
                        let mut speeds = vec![0.0; at.speeds.len()];
                        m.collide(contact, &state, &surface, &mut speeds).map(|hit| (speeds, hit))
                    };
                    assert_eq!(collide(&*generated), collide(&*interpreted), "{} {law:?}", module.name());
                    for quadratures in [0, 1, 2, 1000] {
                        let surface = surface.with_budget(quadratures);
                        let budgeted = |m: &dyn Contacts| {
                            let mut speeds = vec![0.0; at.speeds.len()];
                            m.collide_with_budget(contact, &state, &surface, &mut speeds)
                                .map(|hit| (speeds, hit))
                        };
                        let answer = budgeted(&*generated);
                        assert_eq!(answer, budgeted(&*interpreted), "{} {law:?}", module.name());
                        match answer {
                            Err(CollisionError::Impact(ImpactError::BudgetExceeded { .. }))
                                if quadratures < 1000 =>
                            {
                                refused += 1;
                            }
                            answer => assert_eq!(answer, collide(&*generated), "{} {law:?}", module.name()),
                        }
                    }
                    let jump = |m: &dyn Contacts| {
                        let mut speeds = vec![0.0; at.speeds.len()];
                        m.impact_without_collision(contact, &state, &surface, &mut speeds)
                            .map(|hit| (speeds, hit))
                    };
                    assert_eq!(jump(&*generated), jump(&*interpreted), "{} {law:?}", module.name());
                    let mode = |m: &dyn Contacts, kept: Option<ContactMode>| {
                        let mut rates = vec![0.0; at.speeds.len()];
                        let answer = match kept {
                            None => m.contact_mode(contact, &state, &surface, &mut rates),
                            Some(mode) => m.contact_force(contact, mode, &state, &surface, &mut rates),
                        };
                        answer.map(|answer| (rates, answer))
                    };
                    let kept = [
                        ContactMode::Separate,
                        ContactMode::Slide,
                        ContactMode::Stick,
                        ContactMode::BeginSlip,
                    ];
                    for kept in [None].into_iter().chain(kept.map(Some)) {
                        let [a, b] = [mode(&*generated, kept), mode(&*interpreted, kept)];
                        assert_eq!(a, b, "{} {kept:?}", module.name());
                        // Undefined would be as equal.
                        assert!(!matches!(a, Err(ClosedContactError::State(_))), "{}: {a:?}", module.name());
                    }
                }
            }
        }
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn names_units_and_initial_values_are_those_of_the_model() {
    for module in &emitted() {
        let model = Model::load(module.name());
        let initial = model.initial();
        let machines = both(&**module, &model, &initial);
        for m in &machines {
            assert_eq!(m.name(), model.mechanism.name);
            for &kind in ComponentKind::ALL {
                assert_eq!(m.component(kind, m.count(kind)), None);
                for index in 0..m.count(kind) {
                    let component = m.component(kind, index).expect("a component");
                    assert_eq!(Some(component), machines[0].component(kind, index));
                    assert_eq!(m.index(kind, component.name), Some(index), "{}", model.name);
                    assert!(!component.name.is_empty());
                }
                assert_eq!(m.index(kind, "no such name"), None);
            }
            for (index, speed) in model.mechanism.speeds.iter().filter(|speed| !speed.dependent).enumerate() {
                let component = m.component(ComponentKind::Speed, index).expect("a speed");
                assert_eq!((component.name, component.unit), (speed.name.as_str(), speed.unit.as_str()));
            }
            for index in 0..m.count(ComponentKind::DependentCoordinate) {
                let place = m.dependent_coordinate(index).expect("a dependent coordinate");
                assert!(model.mechanism.coordinates[place].dependent);
                assert_eq!(
                    m.component(ComponentKind::Coordinate, place),
                    m.component(ComponentKind::DependentCoordinate, index)
                );
            }
            let sizes = [
                ComponentKind::Coordinate,
                ComponentKind::Speed,
                ComponentKind::Input,
                ComponentKind::Parameter,
            ]
            .map(|kind| m.count(kind));
            let [mut q, mut u, mut w, mut parameters] = sizes.map(|size| vec![f64::NAN; size]);
            m.initial_state(&mut q, &mut u, &mut w).expect("an initial state");
            assert_eq!((&u, &w), (&initial.speeds, &initial.inputs));
            let quaternion = |index: &usize| (q[*index], initial.coordinates[*index]) == (1.0, 0.0);
            let different: Vec<usize> = (0..q.len()).filter(|&i| q[i] != initial.coordinates[i]).collect();
            assert!(different.iter().all(quaternion), "{}: {q:?}", model.name);
            m.parameter_values(&mut parameters).expect("parameters");
            assert_eq!(parameters, initial.parameters);
        }
    }
}

/// The methods of the trait are those of the mechanism's type.
#[test]
fn the_trait_gives_what_the_type_gives() {
    for module in &emitted() {
        let model = Model::load(module.name());
        let at = &samples(&model, 1)[0].inputs;
        let m = module.by_slices(at);
        let own = |quantity: Q| {
            let name = routine(&model.mechanism, quantity).expect("a routine");
            module.call(&name, at).map(|numbers| numbers.expect("a regular state"))
        };
        let all: std::collections::BTreeMap<_, _> = everything(&*m, &state(at)).into_iter().collect();
        let told = |name: &str| all[name].clone().expect("a regular state");
        assert_eq!(Some(told("accelerations")), own(Q::Accelerations));
        assert_eq!(Some(told("mass_matrix")), own(Q::MassMatrix));
        assert_eq!(Some(told("coordinate_rates")), own(Q::CoordinateRates));
        for (index, _) in model.mechanism.points.iter().enumerate().skip(1) {
            assert_eq!(Some(told(&format!("velocity {index}"))), own(Q::Point(index as u32, P::Velocity)));
        }
        for (index, _) in model.mechanism.contacts.iter().enumerate() {
            let of = |quantity| own(Q::Contact(index as u32, quantity));
            assert_eq!(Some(told(&format!("contact_velocity {index}"))), of(C::Velocity));
            assert_eq!(Some(told(&format!("partial_velocities {index}"))), of(C::PartialVelocities));
            assert_eq!(Some(told(&format!("contact_state {index}"))[12..18].to_vec()), of(C::Reduced));
            assert_eq!(Some(told(&format!("gap {index}"))).filter(|gap| !gap.is_empty()), of(C::Gap));
        }
    }
}

#[test]
fn wrong_lengths_and_numbers_are_named() {
    for module in &emitted() {
        let model = Model::load(module.name());
        let at = &samples(&model, 1)[0].inputs;
        let [n, p] = [at.coordinates.len(), at.speeds.len()];
        for m in &mut both(&**module, &model, at) {
            let good = state(at);
            let mut rates = vec![0.0; n + 1];
            let wrong = |what, expected, found| Err(StateError::Length { what, expected, found });
            let found = m.coordinate_rates(&good, &mut rates);
            assert_eq!(found, wrong("the rates of the coordinates", n, n + 1), "{}", model.name);
            let short = State { speeds: &at.speeds[1..], ..good };
            assert_eq!(
                m.kinetic_energy(&short),
                Err(StateError::Length { what: "speeds", expected: p, found: p - 1 })
            );
            let long = State { inputs: &[0.0; 40], ..good };
            let expected = at.inputs.len();
            assert_eq!(m.mass_matrix(&long, &mut vec![0.0; p * p]), wrong("inputs", expected, 40));
            assert_eq!(
                m.set_parameter_values(&[1.0; 99]),
                Err(ParameterError::Length { expected: m.count(ComponentKind::Parameter), found: 99 })
            );
            let index = m.count(ComponentKind::Contact);
            let missing = StateError::Missing { kind: ComponentKind::Contact, index };
            assert_eq!(m.gap(index, &good), Err(missing));
            let surface = Surface { mu: 0.0, e: 0.0, law: Law::Newton };
            let mut speeds = vec![0.0; p];
            assert_eq!(m.collide(index, &good, &surface, &mut speeds), Err(CollisionError::State(missing)));
            let index = m.count(ComponentKind::Point);
            assert_eq!(
                m.position(index, &good),
                Err(StateError::Missing { kind: ComponentKind::Point, index })
            );
            let not_finite = vec![f64::NAN; p];
            let bad = State { speeds: &not_finite, ..good };
            assert_eq!(m.kinetic_energy(&bad), Err(StateError::NotFinite));
        }
    }
}

/// Refused parameters are refused by both, in the same words, and change nothing; good ones change the
/// numbers.
#[test]
fn parameters_change_or_stay() {
    for module in &emitted() {
        let model = Model::load(module.name());
        let at = &samples(&model, 1)[0].inputs;
        let [mut generated, mut interpreted] = both(&**module, &model, at);
        let before = everything(&*interpreted, &state(at));
        for index in 0..at.parameters.len() {
            for value in [f64::NAN, -1.0, 0.0] {
                let mut parameters = at.parameters.clone();
                parameters[index] = value;
                let answers = [&mut generated, &mut interpreted].map(|m| m.set_parameter_values(&parameters));
                assert_eq!(
                    answers[0], answers[1],
                    "{} {}",
                    model.name, model.mechanism.parameters[index].name
                );
                if answers[0].is_ok() {
                    assert_eq!(everything(&*generated, &state(at)), everything(&*interpreted, &state(at)));
                    generated.set_parameter_values(&at.parameters).expect("good parameters");
                    interpreted.set_parameter_values(&at.parameters).expect("good parameters");
                }
                assert_eq!(before, everything(&*interpreted, &state(at)), "{}", model.name);
            }
        }
    }
}

/// A unit of impulse at one contact changes the velocity of another as the coupled matrix says; its own block
/// is the reduced matrix.
#[test]
fn the_coupled_matrix_is_what_impulses_do() {
    let mut coupled = 0;
    for module in &emitted() {
        let model = Model::load(module.name());
        let at = &samples(&model, 1)[0].inputs;
        let m = module.by_slices(at);
        let contacts: Vec<usize> = (0..m.count(ComponentKind::Contact)).collect();
        let (k, p) = (contacts.len(), at.speeds.len());
        if k == 0 {
            continue;
        }
        let size = 3 * k;
        let mut matrix = vec![f64::NAN; size * size];
        let mut workspace = vec![f64::NAN; 3 * p * (k + 1)];
        m.coupled_matrix(&contacts, &state(at), &mut matrix, &mut workspace).expect("a matrix");
        let short = m.coupled_matrix(&contacts, &state(at), &mut matrix, &mut workspace[1..]);
        assert!(matches!(short, Err(StateError::Length { what: "the workspace", .. })), "{short:?}");
        for (j, axis) in (0..k).flat_map(|j| (0..3).map(move |axis| (j, axis))) {
            let mut response = vec![0.0; 3 * p];
            m.response(j, &state(at), &mut response).expect("a response");
            let speeds: Vec<f64> =
                at.speeds.iter().zip(response.chunks(3)).map(|(u, r)| u + r[axis]).collect();
            let after = State { speeds: &speeds, ..state(at) };
            for i in 0..k {
                let change = m.contact_velocity(i, &after).expect("a velocity")
                    - m.contact_velocity(i, &state(at)).expect("a velocity");
                for row in 0..3 {
                    let entry = matrix[(3 * i + row) * size + 3 * j + axis];
                    let mirrored = matrix[(3 * j + axis) * size + 3 * i + row];
                    let scale = 1.0 + matrix.iter().fold(0.0_f64, |top, x| top.max(x.abs()));
                    assert!(
                        (change[row] - entry).abs() < 1e-9 * scale,
                        "{} {entry} {}",
                        model.name,
                        change[row]
                    );
                    assert_eq!(entry, mirrored);
                    coupled += usize::from(i != j && entry != 0.0);
                }
            }
        }
        // u' with forces: M (u' - u'_free) = V^T lambda
        let forces: Vec<(usize, Vector3<f64>)> =
            contacts.iter().map(|&i| (i, Vector3::new(1.0, -0.4, 0.3 + i as f64))).collect();
        let [mut with, mut free] = [vec![0.0; p], vec![0.0; p]];
        m.accelerations_with_forces(&state(at), &forces, &mut with, &mut workspace).expect("accelerations");
        m.accelerations(&state(at), &mut free).expect("accelerations");
        let mut mass = vec![0.0; p * p];
        m.mass_matrix(&state(at), &mut mass).expect("a mass matrix");
        let mut expected = vec![0.0; p];
        for (contact, force) in &forces {
            let mut rows = vec![0.0; 3 * p];
            m.partial_velocities(*contact, &state(at), &mut rows).expect("partial velocities");
            for (i, sum) in expected.iter_mut().enumerate() {
                *sum += (0..3).map(|axis| rows[axis * p + i] * force[axis]).sum::<f64>();
            }
        }
        for (row, expected) in mass.chunks(p).zip(&expected) {
            let terms: Vec<f64> =
                row.iter().zip(with.iter().zip(&free)).map(|(m, (a, b))| m * (a - b)).collect();
            let size = terms.iter().fold(1.0 + expected.abs(), |size, term| size.max(term.abs()));
            let large = free.iter().zip(row).fold(size, |size, (rate, m)| size.max((rate * m).abs()));
            assert!((terms.iter().sum::<f64>() - expected).abs() < 1e-9 * large, "{}", model.name);
        }
    }
    assert!(coupled > 0, "no model couples contacts");
}
