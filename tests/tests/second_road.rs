//! Every shipped model at random states: the derived program against the numeric evaluation of the model,
//! which shares nothing with the derivation but the meaning of the model, and against identities of
//! mechanics.

use crate::common::random::{Sample, samples};
use crate::common::rates::Rates;
use crate::common::{Model, models, models_of_shapes};
use hodograph::{ComponentKind, Mechanism, State};
use hodograph_generator::interpret::Array;
use hodograph_generator::model::mechanism::{LoadKind, Place, PointId};
use hodograph_generator::numeric::{Level, TurningEvaluation, Views, central_inertia, views};
use hodograph_generator::program::Inputs;
use hodograph_generator::program::{ContactQuantity as C, PointQuantity as P, Quantity as Q};
use hodograph_generator::program::{graph::Input, operation::Operation};
use hodograph_interpreter::InterpretedMechanism;
use nalgebra::{DMatrix, DVector, Vector3};

/// Runs a check on every model at random states and reports all that fail.
fn everywhere(check: impl Fn(&Model, &Sample) -> Result<(), String>) {
    let mut faults = Vec::new();
    for model in models().into_iter().chain(models_of_shapes()) {
        for (index, sample) in samples(&model, 6).iter().enumerate() {
            if let Err(fault) = check(&model, sample) {
                faults.push(format!("{} sample {index}: {fault}", model.name));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn close(what: &str, ours: &[f64], theirs: &[f64], bound: f64) -> Result<(), String> {
    if ours.len() != theirs.len() {
        return Err(format!("{what}: {} numbers, {} expected", ours.len(), theirs.len()));
    }
    // Velocities that vanish identically are compared with those of their surroundings, about 1.
    let top = theirs.iter().fold(1e-3_f64, |top, x| top.max(x.abs()));
    let error = ours.iter().zip(theirs).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / top;
    if error <= bound {
        Ok(())
    } else {
        Err(format!("{what} is off by {error:.1e}\n  {ours:?}\n  {theirs:?}"))
    }
}

fn matrix(array: &Array) -> DMatrix<f64> {
    DMatrix::from_row_slice(array.rows, array.columns, &array.values)
}

fn flat(rows: &[Vec<f64>]) -> Vec<f64> {
    rows.concat()
}

#[test]
fn mass_matrix_is_the_sum_over_bodies_and_positive_definite() {
    everywhere(|model, sample| {
        let m = model.get(&sample.inputs, Q::MassMatrix);
        close("mass matrix", &m.values, &flat(&sample.numeric.mass_matrix), 1e-11)?;
        let m = matrix(&m);
        if m != m.transpose() {
            return Err(format!("the mass matrix is not symmetric: {m}"));
        }
        m.cholesky().map(|_| ()).ok_or("the mass matrix is not positive definite".to_string())
    });
}

#[test]
fn forcing_and_accelerations() {
    everywhere(|model, sample| {
        let forcing = model.get(&sample.inputs, Q::Forcing).values;
        close("forcing", &forcing, &sample.numeric.forcing, 1e-9)?;
        let m = matrix(&model.get(&sample.inputs, Q::MassMatrix));
        let u = DVector::from_vec(model.get(&sample.inputs, Q::Accelerations).values);
        close("M u'", (m * u).as_slice(), &forcing, 1e-9)
    });
}

#[test]
fn inverse_dynamics_undoes_forward_dynamics() {
    everywhere(|model, sample| {
        let m = matrix(&model.get(&sample.inputs, Q::MassMatrix));
        let forcing = DVector::from_vec(model.get(&sample.inputs, Q::Forcing).values);
        let given = DVector::from_column_slice(&sample.inputs.accelerations);
        let expected = &m * given - forcing;
        close(
            "inverse dynamics",
            &model.get(&sample.inputs, Q::InverseDynamics).values,
            expected.as_slice(),
            1e-9,
        )
    });
}

#[test]
fn rates_and_dependent_speeds() {
    everywhere(|model, sample| {
        let rates = model.get(&sample.inputs, Q::CoordinateRates).values;
        close("rates of coordinates", &rates, &sample.numeric.rates, 1e-10)?;
        let p = model.freedom();
        let dependent = model.get(&sample.inputs, Q::DependentSpeeds).values;
        close("dependent speeds", &dependent, &sample.numeric.speeds[p..], 1e-10)?;
        let residual = model.get(&sample.inputs, Q::ConstraintResidual).values;
        let size = sample.numeric.speeds.iter().fold(1.0_f64, |size, u| size.max(u.abs()));
        if residual.iter().any(|r| r.abs() > 1e-11 * size) {
            return Err(format!("the constraints are left with {residual:?}"));
        }
        let residual = model.get(&sample.inputs, Q::ConfigurationResidual).values;
        if residual.iter().chain(&sample.numeric.configuration).any(|r| r.abs() > 1e-12) {
            return Err(format!("the loops are open by {residual:?}"));
        }
        dependent_accelerations(model, sample)
    });
}

/// The rates of the dependent speeds: what they are with u' = 0, plus the part linear in u'.
fn dependent_accelerations(model: &Model, sample: &Sample) -> Result<(), String> {
    let speeds_at = |speeds: Vec<f64>| {
        let inputs = Inputs { speeds, ..sample.inputs.clone() };
        DVector::from_vec(model.get(&inputs, Q::DependentSpeeds).values)
    };
    let p = model.freedom();
    let rest = speeds_at(vec![0.0; p]);
    let accelerations = model.get(&sample.inputs, Q::Accelerations).values;
    let mut expected = DVector::from_vec(sample.numeric.dependent_accelerations.clone());
    for r in 0..p {
        let mut unit = vec![0.0; p];
        unit[r] = 1.0;
        expected += (speeds_at(unit) - &rest) * accelerations[r];
    }
    let ours = model.get(&sample.inputs, Q::DependentAccelerations).values;
    close("rates of dependent speeds", &ours, expected.as_slice(), 1e-8)
}

#[test]
fn contacts() {
    everywhere(|model, sample| {
        let p = model.freedom();
        let inverse =
            matrix(&model.get(&sample.inputs, Q::MassMatrix)).try_inverse().ok_or("M is singular")?;
        for (index, theirs) in sample.numeric.contacts.iter().enumerate() {
            let name = &model.mechanism.contacts[index].name;
            let get = |quantity| model.get(&sample.inputs, Q::Contact(index as u32, quantity));
            let basis = [C::Normal, C::First, C::Second].map(|axis| DVector::from_vec(get(axis).values));
            let basis = DMatrix::from_columns(&basis);
            close(&format!("{name} normal"), basis.column(0).as_slice(), &theirs.normal, 1e-12)?;
            let identity = DMatrix::<f64>::identity(3, 3);
            let orthonormal = basis.transpose() * &basis;
            close(&format!("{name} basis"), orthonormal.as_slice(), identity.as_slice(), 1e-13)?;
            if (basis.determinant() - 1.0).abs() > 1e-12 {
                return Err(format!("the basis of {name} is left-handed"));
            }
            let v = matrix(&get(C::PartialVelocities));
            if v.shape() != (3, p) {
                return Err(format!("partial velocities of {name}: {:?} for {p} speeds", v.shape()));
            }
            let partials: Vec<_> =
                theirs.partial_velocities.iter().map(|v| DVector::from_column_slice(v)).collect();
            let partials = DMatrix::from_columns(&partials);
            close(&format!("{name} V"), (&basis * &v).as_slice(), partials.as_slice(), 1e-11)?;
            let velocity = &basis * DVector::from_vec(get(C::Velocity).values);
            close(&format!("{name} velocity"), velocity.as_slice(), &theirs.velocity, 1e-11)?;
            let remainder = get(C::Remainder).values;
            if !remainder.is_empty() {
                let remainder = &basis * DVector::from_vec(remainder);
                close(&format!("{name} remainder"), remainder.as_slice(), &theirs.remainder, 1e-11)?;
            }
            let response = &inverse * v.transpose();
            close(
                &format!("{name} response"),
                matrix(&get(C::Response)).as_slice(),
                response.as_slice(),
                1e-9,
            )?;
            let m = &v * response;
            let reduced = [m[(0, 0)], m[(0, 1)], m[(0, 2)], m[(1, 1)], m[(1, 2)], m[(2, 2)]];
            close(&format!("{name} reduced matrix"), &get(C::Reduced).values, &reduced, 1e-9)?;
            turning(name, theirs.turning.as_ref(), &basis, &inverse, get)?;
            let gap: Vec<f64> = theirs.gap.into_iter().collect();
            close(&format!("{name} gap"), &get(C::Gap).values, &gap, 1e-12)?;
            let validity: Vec<f64> = theirs.validity.into_iter().collect();
            close(&format!("{name} validity"), &get(C::Validity).values, &validity, 1e-12)?;
            let clearance: Vec<f64> = theirs.clearance.into_iter().collect();
            close(&format!("{name} clearance"), &get(C::Clearance).values, &clearance, 1e-12)?;
        }
        Ok(())
    });
}

/// The relative rotation of the bodies in contact, where friction resists it.
fn turning(
    name: &str,
    theirs: Option<&TurningEvaluation>,
    basis: &DMatrix<f64>,
    inverse: &DMatrix<f64>,
    get: impl Fn(C) -> Array,
) -> Result<(), String> {
    let velocity = get(C::AngularVelocity).values;
    let Some(theirs) = theirs else {
        let none = velocity.is_empty() && get(C::AngularResponse).values.is_empty();
        return if none { Ok(()) } else { Err(format!("{name} has a rotation that nobody asked for")) };
    };
    let velocity = basis * DVector::from_vec(velocity);
    close(&format!("{name} rotation"), velocity.as_slice(), &theirs.angular_velocity, 1e-11)?;
    let rows = matrix(&get(C::PartialAngularVelocities));
    let partials: Vec<_> = theirs.partial_velocities.iter().map(|v| DVector::from_column_slice(v)).collect();
    let partials = DMatrix::from_columns(&partials);
    close(&format!("{name} O"), (basis * &rows).as_slice(), partials.as_slice(), 1e-11)?;
    let response = inverse * rows.transpose();
    let ours = matrix(&get(C::AngularResponse));
    close(&format!("{name} response to torques"), ours.as_slice(), response.as_slice(), 1e-9)
}

/// Some models ask for relative rotations, others do not.
#[test]
fn relative_rotations_are_there_where_friction_resists_them() {
    let asked = models_of_shapes().into_iter().filter(|model| {
        let contacts = &model.mechanism.contacts;
        let outputs = |i: usize| model.program.output(Q::Contact(i as u32, C::AngularVelocity)).is_some();
        assert!((0..contacts.len()).all(|i| outputs(i) == contacts[i].turning.is_some()), "{}", model.name);
        contacts.iter().any(|contact| contact.turning.is_some())
    });
    assert_eq!(asked.map(|model| model.name).collect::<Vec<_>>(), ["shapes/billiard_balls"]);
}

#[test]
fn power_is_balanced() {
    let (mut moved_by_loads, mut stored_in_springs) = (0, 0);
    for model in models().into_iter().chain(models_of_shapes()) {
        let springs = model
            .mechanism
            .loads
            .iter()
            .any(|load| matches!(load.kind, LoadKind::Spring { .. } | LoadKind::Torsion { .. }));
        let prescribed = model.program.operations.contains(&Operation::Input(Input::Time));
        for sample in samples(&model, 6) {
            let numeric = &sample.numeric;
            let rates = Rates::along_motion(&model, &sample.inputs);
            let hold = |what: &str, ours: &[f64], theirs: f64, scale: f64, bound: f64| {
                let off = ours.iter().map(|ours| (ours - theirs).abs()).fold(0.0, f64::max) / scale;
                assert!(
                    ours.len() == 1 && off <= bound,
                    "{}: {what}: {ours:?} {theirs}: {off:e}",
                    model.name
                );
            };
            let energy = model.get(&sample.inputs, Q::KineticEnergy).values;
            hold("kinetic energy", &energy, numeric.kinetic_energy, 1e-3 + numeric.kinetic_energy, 1e-11);
            // What moves as prescribed does work that no load accounts for.
            let scale = 1.0 + numeric.power.abs() + energy[0];
            if !prescribed {
                hold("power of the loads", &rates.of(Q::KineticEnergy), numeric.power, scale, 1e-10);
                moved_by_loads += 1;
            }
            // A mechanism whose place is ignorable (the bicycle) has no potential energy to state.
            let potential = model.get(&sample.inputs, Q::PotentialEnergy).values;
            if potential.is_empty() {
                assert_eq!(numeric.potential_energy, None, "{}", model.name);
                continue;
            }
            let stored = numeric.potential_energy.expect("heights that the derivation knows");
            hold("potential energy", &potential, stored, 1.0 + stored.abs(), 1e-12);
            let lost = rates.of(Q::PotentialEnergy);
            hold("power of gravity and springs", &lost, -numeric.conservative_power, scale, 1e-10);
            stored_in_springs += usize::from(springs);
        }
    }
    assert!(moved_by_loads > 0 && stored_in_springs > 0, "{moved_by_loads} {stored_in_springs}");
}

/// Sums over the bodies by the numeric evaluation: mass, m v, m r and the angular momentum about O; the last
/// two only where all mass centres have a place.
struct Sums {
    mass: f64,
    momentum: Vector3<f64>,
    placed: Option<(Vector3<f64>, Vector3<f64>)>,
}

fn sums(model: &Model, sample: &Sample) -> Sums {
    let m = &model.mechanism;
    let views = Views::at(m, &sample.state).unwrap();
    let now = &views.now;
    let mut sums =
        Sums { mass: 0.0, momentum: Vector3::zeros(), placed: Some((Vector3::zeros(), Vector3::zeros())) };
    for body in &m.bodies {
        let mass = now.scalar(&body.mass, Level::Motion).unwrap().re;
        let velocity = Vector3::from(views::values(now.velocity(body.centre).unwrap()));
        sums.mass += mass;
        sums.momentum += mass * velocity;
        let known = now.root(body.centre) == PointId::O
            && !matches!(m.points[body.centre.0].place, Place::Velocity(_));
        let Some((moment, spin)) = sums.placed.as_mut().filter(|_| known) else {
            sums.placed = None;
            continue;
        };
        let position = Vector3::from(views::values(now.position(body.centre).unwrap()));
        *moment += mass * position;
        *spin += mass * position.cross(&velocity);
        if let (Some(frame), Some(inertia)) = (body.frame, central_inertia(now, body).unwrap()) {
            let turning = views::values(now.angular_velocity(frame).unwrap());
            *spin += Vector3::from(inertia.map(|row| views::dot3(row, turning)));
        }
    }
    sums
}

#[test]
fn momenta_are_sums_over_the_bodies() {
    let mut placed = 0;
    everywhere(|model, sample| {
        let Sums { mass, momentum, .. } = sums(model, sample);
        let get = |quantity| model.get(&sample.inputs, quantity).values;
        let hold = |what: &str, quantity, theirs: Vector3<f64>| {
            close(what, &get(quantity), theirs.as_slice(), 1e-10)
        };
        hold("momentum", Q::Momentum, momentum)?;
        let velocity = momentum / mass;
        hold("velocity of the mass centre", Q::MassCentreVelocity, velocity)
    });
    for model in models() {
        for sample in samples(&model, 3) {
            let Sums { mass, momentum, placed: Some((moment, spin)) } = sums(&model, &sample) else {
                let absent = model.get(&sample.inputs, Q::AngularMomentum).values;
                assert!(absent.is_empty(), "{}", model.name);
                continue;
            };
            placed += 1;
            let get = |quantity| model.get(&sample.inputs, quantity).values;
            let position = moment / mass;
            let central = spin - position.cross(&momentum);
            for (quantity, theirs) in [
                (Q::MassCentrePosition, position),
                (Q::AngularMomentum, spin),
                (Q::CentralAngularMomentum, central),
            ] {
                close(&quantity.to_string(), &get(quantity), theirs.as_slice(), 1e-10)
                    .unwrap_or_else(|fault| panic!("{}: {fault}", model.name));
            }
            // about every point of the model, by the trait
            let machine = InterpretedMechanism::with_parameters(
                model.mechanism.clone(),
                model.program.clone(),
                &sample.inputs.parameters,
            )
            .unwrap();
            let Inputs { time, coordinates, speeds, inputs, .. } = &sample.inputs;
            let state = State { time: *time, coordinates, speeds, inputs };
            for point in 0..machine.count(ComponentKind::Point) {
                let Some(at) = sample.numeric.positions[point] else { continue };
                let Ok(about) = machine.angular_momentum_about(point, &state) else { continue };
                let theirs = central + (position - Vector3::from(at)).cross(&momentum);
                close("about a point", about.as_slice(), theirs.as_slice(), 1e-9)
                    .unwrap_or_else(|fault| panic!("{} {point}: {fault}", model.name));
            }
        }
    }
    assert!(placed > 20, "{placed}");
}

#[test]
fn momentum_changes_by_the_forces() {
    everywhere(|model, sample| {
        // The sum of mass times acceleration over the bodies is the sum of the forces on them.
        let Sums { mass, placed, .. } = sums(model, sample);
        let views = Views::at(&model.mechanism, &sample.state).map_err(|failure| failure.to_string())?;
        let given = model.get(&sample.inputs, Q::Accelerations).values;
        let inputs = Inputs { accelerations: given, ..sample.inputs.clone() };
        let mut force = Vector3::zeros();
        for body in &model.mechanism.bodies {
            let own = views.now.scalar(&body.mass, Level::Motion).map_err(|failure| failure.to_string())?;
            let acceleration = model.get(&inputs, Q::Point(body.centre.0 as u32, P::Acceleration)).values;
            if acceleration.is_empty() {
                return Ok(());
            }
            force += own.re * Vector3::from_column_slice(&acceleration);
        }
        let rates = Rates::along_motion(model, &sample.inputs);
        let changes = rates.of(Q::Momentum);
        close("rate of the momentum, beside the forces", &changes, force.as_slice(), 1e-10)?;
        if placed.is_none() {
            return Ok(());
        }
        let velocity = model.get(&sample.inputs, Q::MassCentreVelocity).values;
        let moves = rates.of(Q::MassCentrePosition);
        let material = |body: &hodograph_generator::model::mechanism::Body| {
            matches!(model.mechanism.points[body.centre.0].place, Place::Material { .. })
        };
        if model.mechanism.bodies.iter().any(material) {
            return Ok(());
        }
        close(&format!("motion of the mass centre ({mass} kg)"), &moves, &velocity, 1e-10)
    });
}

/// Of a free body gravity changes the momentum, and nothing the angular momentum about the mass centre.
#[test]
fn a_free_body_keeps_its_angular_momentum() {
    for name in ["free_box_corner", "free_box_quaternion"] {
        let model = Model::load(name);
        for sample in samples(&model, 6) {
            let Sums { mass, .. } = sums(&model, &sample);
            let spin = Vector3::from_vec(model.get(&sample.inputs, Q::CentralAngularMomentum).values);
            let rates = Rates::along_motion(&model, &sample.inputs);
            let changes = Vector3::from_vec(rates.of(Q::CentralAngularMomentum));
            assert!(spin.norm() > 1e-3 && changes.norm() < 1e-12 * (1.0 + spin.norm()), "{name}: {changes}");
            let fall = Vector3::from_vec(rates.of(Q::Momentum)) / mass;
            let g = model.mechanism.parameters.iter().position(|parameter| parameter.name == "g");
            let g = sample.inputs.parameters[g.expect("the acceleration of gravity")];
            assert!((fall.norm() - g).abs() < 1e-12 * g, "{name}: {fall}");
        }
    }
}

#[test]
fn velocities_are_rates_of_positions() {
    everywhere(|model, sample| {
        let rates = Rates::along_motion(model, &sample.inputs);
        for (index, point) in model.mechanism.points.iter().enumerate() {
            let quantity = |quantity| Q::Point(index as u32, quantity);
            let velocity = model.get(&sample.inputs, quantity(P::Velocity)).values;
            if velocity.is_empty() {
                continue;
            }
            let what = format!("velocity of {}", point.name);
            close(&what, &velocity, &sample.numeric.velocities[index], 1e-10)?;
            let position = model.get(&sample.inputs, quantity(P::Position)).values;
            if let (false, Some(theirs)) = (position.is_empty(), sample.numeric.positions[index]) {
                close(&format!("position of {}", point.name), &position, &theirs, 1e-12)?;
            }
            // A material point of a rolling or spinning body is another one an instant later.
            let material =
                matches!(point.place, hodograph_generator::model::mechanism::Place::Material { .. });
            if !position.is_empty() && !material {
                close(
                    &format!("rate of the position, {what}"),
                    &rates.of(quantity(P::Position)),
                    &velocity,
                    1e-10,
                )?;
            }
            jacobian(model, sample, index)?;
        }
        Ok(())
    });
}

/// The partial velocities of a point are the change of its velocity per unit of each speed.
fn jacobian(model: &Model, sample: &Sample, point: usize) -> Result<(), String> {
    let quantity = |quantity| Q::Point(point as u32, quantity);
    let partials = model.get(&sample.inputs, quantity(P::Jacobian));
    if partials.values.is_empty() {
        return Ok(());
    }
    let velocity = |speeds: Vec<f64>| {
        let inputs = Inputs { speeds, ..sample.inputs.clone() };
        model.get(&inputs, quantity(P::Velocity)).values
    };
    let p = model.freedom();
    let rest = velocity(vec![0.0; p]);
    let partials = matrix(&partials);
    for r in 0..p {
        let mut unit = vec![0.0; p];
        unit[r] = 1.0;
        let expected: Vec<f64> = velocity(unit).iter().zip(&rest).map(|(a, b)| a - b).collect();
        let off = partials.column(r).iter().zip(&expected).any(|(a, b)| (a - b).abs() > 1e-11);
        if off {
            return Err(format!(
                "partial velocity {r} of point {point}: {} {expected:?}",
                partials.column(r)
            ));
        }
    }
    Ok(())
}

#[test]
fn orientations() {
    everywhere(|model, sample| {
        for (index, theirs) in sample.numeric.orientations.iter().enumerate() {
            let ours = model.get(&sample.inputs, Q::Orientation(index as u32)).values;
            if let (Some(theirs), false) = (theirs, ours.is_empty()) {
                let name = &model.mechanism.frames[index].name;
                close(&format!("orientation of {name}"), &ours, &theirs.concat(), 1e-13)?;
            }
        }
        Ok(())
    });
}
