//! Evaluates Kane's equations numerically: mass matrix and forcing as sums over bodies and loads.

use super::evaluator::{Evaluator, Level};
use super::hyper_dual::*;
use super::state::{ContactEvaluation, Evaluation, Failure, State, TurningEvaluation};
use super::views::{Vector3, Views, accelerations, cross3, dot3, values};
use crate::model::mechanism::*;

fn apply3(m: &[Vector3; 3], v: Vector3) -> Vector3 {
    m.map(|row| dot3(row, v))
}

/// Mass matrix or forces are not finite.
pub const SINGULAR: Failure = Failure::Unsupported("a state at which the equations are singular");

/// Everything at a state.
pub fn evaluate(m: &Mechanism, state: &State) -> Result<Evaluation, Failure> {
    evaluate_views(m, &Views::at(m, state)?)
}

/// Everything at a state of which the views are known.
pub fn evaluate_views(m: &Mechanism, views: &Views<'_>) -> Result<Evaluation, Failure> {
    let p = views.units.len();
    let mut out = Evaluation {
        mass_matrix: vec![vec![0.0; p]; p],
        forcing: vec![0.0; p],
        rates: views.rates.clone(),
        speeds: views.speeds.clone(),
        kinetic_energy: 0.0,
        power: 0.0,
        potential_energy: Some(0.0),
        conservative_power: 0.0,
        contacts: Vec::new(),
        positions: Vec::new(),
        velocities: Vec::new(),
        accelerations: Vec::new(),
        orientations: Vec::new(),
        angular_velocities: Vec::new(),
        configuration: Vec::new(),
        dependent_accelerations: views.dependent_accelerations.clone(),
        dependent_partials: views.dependent_partials.clone(),
        prescribed_momentum: vec![0.0; p],
    };
    for body in &m.bodies {
        add_body(views, body, &mut out)?;
    }
    for load in &m.loads {
        add_load(m, views, load, &mut out)?;
    }
    for contact in &m.contacts {
        out.contacts.push(contact_values(views, contact)?);
    }
    geometry(m, &views.now, &mut out)?;
    for i in 0..m.points.len() {
        out.accelerations.push(accelerations(views.onward.velocity(PointId(i))?));
    }
    let finite = out.mass_matrix.iter().flatten().chain(&out.forcing).all(|v| v.is_finite());
    if finite { Ok(out) } else { Err(SINGULAR) }
}

/// Inertia as it is stated: along the axes of its frame, about its point.
pub fn own_inertia(values: &Evaluator<'_>, inertia: &Inertia) -> Result<Matrix3, Failure> {
    let mut components = [HyperDual::ZERO; 6];
    for (c, scalar) in components.iter_mut().zip(inertia.components.iter()) {
        *c = values.scalar(scalar, Level::Motion)?;
    }
    let [xx, yy, zz, xy, yz, zx] = components;
    Ok([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
}

/// Inertia about the mass centre, along N's axes.
pub fn central_inertia(values: &Evaluator<'_>, body: &Body) -> Result<Option<[Vector3; 3]>, Failure> {
    let Some(inertia) = &body.inertia else { return Ok(None) };
    let local = own_inertia(values, inertia)?;
    let axes = values.orientation(inertia.frame)?;
    let mut out = product(&product(&axes, &local), &transposed(&axes)).map(|row| row.map(|c| c.re));
    if let Some(point) = inertia.about {
        let mass = values.scalar(&body.mass, Level::Motion)?.re;
        let d = sub(values.position(body.centre)?, values.position(point)?).map(|c| c.re);
        for (i, row) in out.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let unit = if i == j { dot3(d, d) } else { 0.0 };
                *entry -= mass * (unit - d[i] * d[j]);
            }
        }
    }
    Ok(Some(out))
}

fn add_body(views: &Views<'_>, body: &Body, out: &mut Evaluation) -> Result<(), Failure> {
    let mass = views.now.scalar(&body.mass, Level::Motion)?.re;
    let partial = views.partials(|values| values.velocity(body.centre))?;
    let velocity = values(views.now.velocity(body.centre)?);
    let prescribed = values(views.rest.velocity(body.centre)?);
    let acceleration = accelerations(views.onward.velocity(body.centre)?);
    let p = partial.len();
    out.kinetic_energy += 0.5 * mass * dot3(velocity, velocity);
    for r in 0..p {
        for s in 0..p {
            out.mass_matrix[r][s] += mass * dot3(partial[r], partial[s]);
        }
        out.forcing[r] -= mass * dot3(partial[r], acceleration);
        out.prescribed_momentum[r] += mass * dot3(partial[r], prescribed);
    }
    let (Some(frame), Some(inertia)) = (body.frame, central_inertia(&views.now, body)?) else {
        return Ok(());
    };
    let turning = views.partials(|values| values.angular_velocity(frame))?;
    let omega = values(views.now.angular_velocity(frame)?);
    let prescribed = apply3(&inertia, values(views.rest.angular_velocity(frame)?));
    let alpha = accelerations(views.onward.angular_velocity(frame)?);
    let momentum = apply3(&inertia, omega);
    out.kinetic_energy += 0.5 * dot3(omega, momentum);
    let gyroscopic = cross3(omega, momentum);
    let torque = apply3(&inertia, alpha);
    for r in 0..p {
        for s in 0..p {
            out.mass_matrix[r][s] += dot3(turning[r], apply3(&inertia, turning[s]));
        }
        out.forcing[r] -= dot3(turning[r], torque) + dot3(turning[r], gyroscopic);
        out.prescribed_momentum[r] += dot3(turning[r], prescribed);
    }
    Ok(())
}

/// Adds a force on a point.
fn add_force(views: &Views<'_>, point: PointId, force: Vector3, out: &mut Evaluation) -> Result<(), Failure> {
    let partial = views.partials(|values| values.velocity(point))?;
    for (entry, v) in out.forcing.iter_mut().zip(partial) {
        *entry += dot3(v, force);
    }
    out.power += dot3(values(views.now.velocity(point)?), force);
    Ok(())
}

/// Adds a torque on a frame.
fn add_torque(
    views: &Views<'_>,
    frame: FrameId,
    torque: Vector3,
    out: &mut Evaluation,
) -> Result<(), Failure> {
    let partial = views.partials(|values| values.angular_velocity(frame))?;
    for (entry, w) in out.forcing.iter_mut().zip(partial) {
        *entry += dot3(w, torque);
    }
    out.power += dot3(values(views.now.angular_velocity(frame)?), torque);
    Ok(())
}

/// Adds what is stored where a force or a torque has a potential: the energy, and the power that it gives.
/// Where it has none, it is one applied force more.
fn add_stored(load: &Load, energy: Option<f64>, power: f64, out: &mut Evaluation) {
    let energy = energy.filter(|_| load.potential);
    out.potential_energy = out.potential_energy.zip(energy).map(|(sum, energy)| sum + energy);
    if load.potential {
        out.conservative_power += power;
    }
}

fn add_load(m: &Mechanism, views: &Views<'_>, load: &Load, out: &mut Evaluation) -> Result<(), Failure> {
    let now = &views.now;
    let level = Level::Motion;
    match &load.kind {
        LoadKind::Gravity(vector) => {
            let g = values(now.vector(vector, level)?);
            for body in &m.bodies {
                let mass = now.scalar(&body.mass, level)?.re;
                let weight = g.map(|c| mass * c);
                add_force(views, body.centre, weight, out)?;
                let height = match now.root(body.centre) == PointId::O {
                    true => Some(-dot3(values(now.position(body.centre)?), weight)),
                    false => None,
                };
                add_stored(load, height, dot3(values(now.velocity(body.centre)?), weight), out);
            }
        }
        LoadKind::Force { on, from, force } => {
            let force = values(now.vector(force, level)?);
            add_force(views, *on, force, out)?;
            if let Some(from) = from {
                add_force(views, *from, force.map(|c| -c), out)?;
            }
        }
        LoadKind::Torque { on, from, torque } => {
            let torque = values(now.vector(torque, level)?);
            add_torque(views, *on, torque, out)?;
            if let Some(from) = from {
                add_torque(views, *from, torque.map(|c| -c), out)?;
            }
        }
        LoadKind::Spring { a, b, stiffness, length, damping } => {
            let line = sub(now.position(*b)?, now.position(*a)?);
            let distance = dot(line, line).sqrt();
            if distance.re == 0.0 {
                return Err(Failure::DivisionByZero(m.points[a.0].span));
            }
            let [k, rest, c] = [stiffness, length, damping].map(|s| now.scalar(s, level));
            let (k, stretch) = (k?.re, distance.re - rest?.re);
            let along = values(line).map(|c| c / distance.re);
            let apart = dot3(values(sub(now.velocity(*b)?, now.velocity(*a)?)), along);
            add_stored(load, Some(0.5 * k * stretch * stretch), -k * stretch * apart, out);
            let tension = k * stretch + c?.re * apart;
            let pull = along.map(|c| tension * c);
            add_force(views, *a, pull, out)?;
            add_force(views, *b, pull.map(|c| -c), out)?;
        }
        LoadKind::Torsion { on, from, axis, angle, rest, stiffness, damping, .. } => {
            let axis = values(now.vector(axis, level)?);
            let angle = now.scalar(angle, Level::Geometry)?;
            let [rest, k, c] = [rest, stiffness, damping].map(|s| now.scalar(s, level));
            let (k, stretch) = (k?.re, angle.re - rest?.re);
            let mut turning = now.angular_velocity(*on)?;
            if let Some(from) = from {
                turning = sub(turning, now.angular_velocity(*from)?);
            }
            add_stored(
                load,
                Some(0.5 * k * stretch * stretch),
                -k * stretch * dot3(values(turning), axis),
                out,
            );
            let size = -(k * stretch + c?.re * angle.e1);
            let torque = axis.map(|c| size * c);
            add_torque(views, *on, torque, out)?;
            if let Some(from) = from {
                add_torque(views, *from, torque.map(|c| -c), out)?;
            }
        }
    }
    Ok(())
}

fn contact_values(views: &Views<'_>, contact: &Contact) -> Result<ContactEvaluation, Failure> {
    let partial_velocities = views.partials(|values| values.contact_velocity(contact))?;
    let length = |of: &Option<Scalar>| -> Result<Option<f64>, Failure> {
        of.as_ref().map(|of| Ok(views.now.scalar(of, Level::Motion)?.re)).transpose()
    };
    Ok(ContactEvaluation {
        normal: values(views.now.vector(&contact.normal, Level::Motion)?),
        velocity: values(views.now.contact_velocity(contact)?),
        remainder: values(views.rest.contact_velocity(contact)?),
        partial_velocities,
        gap: length(&contact.gap)?,
        validity: length(&contact.validity)?,
        clearance: length(&contact.clearance)?,
        normal_rate: accelerations(views.onward.vector(&contact.normal, Level::Motion)?),
        acceleration: accelerations(views.onward.contact_velocity(contact)?),
        turning: contact.turning.map(|frames| turning_values(views, frames)).transpose()?,
    })
}

/// The relative rotation of two frames.
fn turning_values(views: &Views<'_>, [of, within]: [FrameId; 2]) -> Result<TurningEvaluation, Failure> {
    let turning =
        |values: &Evaluator<'_>| Ok(sub(values.angular_velocity(of)?, values.angular_velocity(within)?));
    Ok(TurningEvaluation {
        angular_velocity: values(turning(&views.now)?),
        partial_velocities: views.partials(turning)?,
        acceleration: accelerations(turning(&views.onward)?),
    })
}

fn geometry(m: &Mechanism, now: &Evaluator<'_>, out: &mut Evaluation) -> Result<(), Failure> {
    for i in 0..m.points.len() {
        let known = now.root(PointId(i)) == PointId::O;
        out.positions.push(if known { Some(values(now.position(PointId(i))?)) } else { None });
        out.velocities.push(values(now.velocity(PointId(i))?));
    }
    for i in 0..m.frames.len() {
        out.orientations.push(match now.orientation(FrameId(i)) {
            Ok(axes) => Some(axes.map(values)),
            Err(Failure::Unsupported(_)) => None,
            Err(other) => return Err(other),
        });
        out.angular_velocities.push(values(now.angular_velocity(FrameId(i))?));
    }
    for equation in &m.configuration {
        out.configuration.extend(now.residual(equation, Level::Geometry)?.into_iter().map(|r| r.re));
    }
    Ok(())
}
