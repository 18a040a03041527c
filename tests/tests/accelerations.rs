//! Accelerations of points and free accelerations of contacts, each computed in three ways: by the derived
//! program, by numbers that carry derivatives, and by differences along the motion.

use crate::common::random::{Sample, samples};
use crate::common::{Model, models, models_of_shapes};
use hodograph_generator::program::{ContactQuantity as C, Inputs, PointQuantity as P, Quantity as Q};
use nalgebra::Vector3;

fn vector(numbers: &[f64]) -> Vector3<f64> {
    Vector3::from_row_slice(numbers)
}

/// Inputs a little later, moving by (1, q', u'); later still for greater `h`, earlier for negative.
fn moved(at: &Inputs, rates: &[f64], accelerations: &[f64], h: f64) -> Inputs {
    let mut at = at.clone();
    at.time += h;
    at.coordinates.iter_mut().zip(rates).for_each(|(q, rate)| *q += h * rate);
    at.speeds.iter_mut().zip(accelerations).for_each(|(u, rate)| *u += h * rate);
    at
}

/// The derivative of a quantity along the motion, by central differences of two widths, so that the error is
/// of fourth order.
fn difference(model: &Model, at: &Inputs, accelerations: &[f64], quantity: Q) -> Vec<f64> {
    let rates = model.get(at, Q::CoordinateRates).values;
    let fastest = rates.iter().chain(accelerations).fold(1.0_f64, |top, x| top.max(x.abs()));
    let h = 2e-3 / fastest;
    let central = |h: f64| -> Vec<f64> {
        let [after, before] =
            [h, -h].map(|h| model.get(&moved(at, &rates, accelerations, h), quantity).values);
        after.iter().zip(before).map(|(a, b)| (a - b) / (2.0 * h)).collect()
    };
    let (wide, narrow) = (central(h), central(0.5 * h));
    narrow.iter().zip(wide).map(|(narrow, wide)| (4.0 * narrow - wide) / 3.0).collect()
}

/// Whether they are equal up to a bound, relative to the scale.
fn close(what: &str, ours: &[f64], theirs: &[f64], scale: f64, bound: f64) -> Option<String> {
    let error = ours.iter().zip(theirs).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / scale;
    (error.is_nan() || error > bound || ours.len() != theirs.len())
        .then(|| format!("{what} is off by {error:.1e}\n  {ours:?}\n  {theirs:?}"))
}

/// The greatest of 1 and the sizes of these numbers.
fn scale(numbers: &[f64]) -> f64 {
    numbers.iter().fold(1.0_f64, |top, x| top.max(x.abs()))
}

fn points(model: &Model, sample: &Sample) -> Vec<String> {
    let at = &sample.inputs;
    let mut faults = Vec::new();
    for (index, point) in model.mechanism.points.iter().enumerate().skip(1) {
        let of = |quantity| Q::Point(index as u32, quantity);
        let ours = model.get(at, of(P::Acceleration)).values;
        let jacobian = model.get(at, of(P::Jacobian));
        let numeric: Vec<f64> = (0..3)
            .map(|axis| {
                let terms = at.accelerations.iter().enumerate();
                let held = sample.numeric.accelerations[index][axis];
                held + terms.map(|(column, rate)| jacobian.at(axis, column) * rate).sum::<f64>()
            })
            .collect();
        let size = scale(&numeric);
        let difference = difference(model, at, &at.accelerations, of(P::Velocity));
        faults.extend(close(&format!("{}: numbers", point.name), &ours, &numeric, size, 1e-10));
        faults.extend(close(&format!("{}: differences", point.name), &ours, &difference, size, 1e-6));
    }
    faults
}

fn contacts(model: &Model, sample: &Sample) -> Vec<String> {
    let at = &sample.inputs;
    let accelerations = model.get(at, Q::Accelerations).values;
    let mut faults = Vec::new();
    for (index, contact) in model.mechanism.contacts.iter().enumerate() {
        let of = |quantity| Q::Contact(index as u32, quantity);
        let beta = model.get(at, of(C::FreeAcceleration)).values;
        // The numbers know the normal and the relative velocity as vectors; the tangential axes are the
        // program's own. What does not depend on these axes: the normal component, and the rate of
        // the square of the slip.
        let known = &sample.numeric.contacts[index];
        let [n, n_rate, v] = [known.normal, known.normal_rate, known.velocity].map(|v| vector(&v));
        let partials = known.partial_velocities.iter().zip(&accelerations);
        let a =
            partials.fold(vector(&known.acceleration), |sum, (partial, rate)| sum + vector(partial) * *rate);
        let components = model.get(at, of(C::Velocity)).values;
        let normal = n_rate.dot(&v) + n.dot(&a);
        let slip = v.dot(&a) - n.dot(&v) * normal;
        let ours = [beta[0], components[1] * beta[1] + components[2] * beta[2]];
        let size = scale(&[a.norm(), v.norm() * a.norm(), n_rate.norm() * v.norm()]);
        faults.extend(close(&format!("{}: numbers", contact.name), &ours, &[normal, slip], size, 1e-9));
        let there = difference(model, at, &accelerations, of(C::Velocity));
        faults.extend(close(&format!("{}: differences", contact.name), &beta, &there, size, 1e-6));
        let Some(turning) = &known.turning else { continue };
        // The same of the relative rotation.
        let o = vector(&turning.angular_velocity);
        let partials = turning.partial_velocities.iter().zip(&accelerations);
        let a = partials
            .fold(vector(&turning.acceleration), |sum, (partial, rate)| sum + vector(partial) * *rate);
        let beta = model.get(at, of(C::FreeAngularAcceleration)).values;
        let components = model.get(at, of(C::AngularVelocity)).values;
        let normal = n_rate.dot(&o) + n.dot(&a);
        let rolls = o.dot(&a) - n.dot(&o) * normal;
        let ours = [beta[0], components[1] * beta[1] + components[2] * beta[2]];
        let size = scale(&[a.norm(), o.norm() * a.norm(), n_rate.norm() * o.norm()]);
        faults.extend(close(&format!("{}: rotation", contact.name), &ours, &[normal, rolls], size, 1e-9));
        let there = difference(model, at, &accelerations, of(C::AngularVelocity));
        faults.extend(close(&format!("{}: rotation", contact.name), &beta, &there, size, 1e-6));
    }
    faults
}

#[test]
fn velocities_change_as_the_accelerations_say() {
    let (mut faults, mut tried) = (Vec::new(), [0, 0]);
    let turn = |model: &Model| model.mechanism.contacts.iter().any(|contact| contact.turning.is_some());
    for model in models().into_iter().chain(models_of_shapes().into_iter().filter(turn)) {
        for sample in samples(&model, 4) {
            let all = [points(&model, &sample), contacts(&model, &sample)].concat();
            faults.extend(all.into_iter().map(|fault| format!("{}: {fault}", model.name)));
            tried[0] += model.mechanism.points.len() - 1;
            tried[1] += model.mechanism.contacts.len();
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(tried[0] > 400 && tried[1] > 80, "{tried:?}");
}
