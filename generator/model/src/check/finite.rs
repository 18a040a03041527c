//! Values that are finite at none of the states that were tried, or not at the initial values.

use super::motion;
use crate::diagnostics::{Diagnostic, Severity, codes};
use crate::model::mechanism::*;
use crate::numeric::hyper_dual::Triple;
use crate::numeric::{self, Failure, Level, State, Views};
use crate::span::Span;

/// What a part of the model is, and where it stands.
type Part = (String, Span);

/// The first definition or point that is finite at none of these, the states near the initial values; else the first
/// load or gap that is finite at none of these and of `far`: such may be defined for some values only.
pub fn never_finite(m: &Mechanism, views: &[&Views<'_>], far: &[Views<'_>]) -> Option<Diagnostic> {
    let all: Vec<&Views<'_>> = views.iter().copied().chain(far).collect();
    let (what, span) = geometry(m, views).or_else(|| forces(m, &all))?;
    let message = format!("the {what} is not finite at any state that was tried");
    let help = "check the values of the parameters, the arguments of sqrt, log, asin and acos, and powers of powers: numbers end at 1.8e308";
    Some(Diagnostic::new(codes::NUMBER_RANGE, span, message).help(help))
}

/// Says so where the initial values are a state without numbers, although others have them. A model that states
/// no initial value says nothing of its start; in one that is not `flawless` masses are not looked at.
pub fn at_the_start(m: &Mechanism, flawless: bool) -> Option<Diagnostic> {
    let stated = m.coordinates.iter().chain(&m.speeds).any(|variable| variable.value.is_some());
    let open = m.parameters.iter().any(|parameter| parameter.value.is_none());
    let mut state = State::of(m);
    if !stated || open || numeric::assemble(m, &mut state).is_err() {
        return None;
    }
    let views = Views::at(m, &state);
    let numbers = match &views {
        Ok(views) => numeric::evaluate_views(m, views),
        Err(failure) => Err(failure.clone()),
    };
    let without_inertia = match (&views, &numbers) {
        (Ok(views), Ok(at)) if flawless && !m.bodies.is_empty() => motion::without_inertia(m, views, at),
        _ => None,
    };
    let failure = numbers.err();
    let found = match (&views, &failure) {
        (Ok(views), None | Some(Failure::Unsupported(_))) => {
            geometry(m, &[views]).or_else(|| forces(m, &[views]))
        }
        _ => None,
    };
    let (message, span) = match (found, failure) {
        (Some((what, span)), _) => (format!("the {what} is not finite with the initial values"), span),
        (None, Some(Failure::DivisionByZero(span))) => {
            ("this is zero with the initial values, and something is divided by it".to_owned(), span)
        }
        (None, Some(failure)) => {
            let told = motion::nowhere(m, &state, &failure)?;
            (format!("with the initial values {}", told.message), told.primary.span)
        }
        (None, None) => {
            let speed = m.speeds.get(without_inertia?.0)?;
            let message = format!(
                "with the initial values the mass matrix is singular: nothing resists `{}`",
                speed.name
            );
            (message, speed.span)
        }
    };
    let help = "give initial values at which the model has numbers: no motion can begin at these";
    let told = Diagnostic::new(codes::NO_START, span, message).help(help);
    debug_assert_eq!(told.severity, Severity::Warning);
    Some(told)
}

/// Whether something has a value at each of some states, and it is not finite.
fn never(views: &[&Views<'_>], is_finite: &dyn Fn(&Views<'_>) -> Option<bool>) -> bool {
    !views.is_empty() && views.iter().all(|views| is_finite(views) == Some(false))
}

fn vector(views: &Views<'_>, vector: &Vector) -> Option<bool> {
    Some(finite(&views.now.vector(vector, Level::Motion).ok()?))
}

fn scalar(views: &Views<'_>, scalar: &Scalar) -> Option<bool> {
    Some(views.now.scalar(scalar, Level::Motion).ok()?.re.is_finite())
}

fn finite(value: &Triple) -> bool {
    value.iter().all(|c| c.re.is_finite())
}

fn geometry(m: &Mechanism, views: &[&Views<'_>]) -> Option<Part> {
    let definition = |(i, definition): (usize, &Definition)| {
        let id = DefinitionId(i);
        let found = never(views, &|views| match definition.value {
            DefinitionValue::Scalar(_) => scalar(views, &Scalar::Definition(id)),
            DefinitionValue::Vector(_) => vector(views, &Vector::Definition(id)),
        });
        found.then(|| (format!("definition `{}`", definition.name), definition.span))
    };
    let point = |(i, point): (usize, &Point)| {
        let id = PointId(i);
        let place = never(views, &|views| Some(finite(&views.now.position(id).ok()?)));
        let motion = never(views, &|views| Some(finite(&views.now.velocity(id).ok()?)));
        let what = if place { "position" } else { "velocity" };
        (place || motion).then(|| (format!("{what} of point `{}`", point.name), point.span))
    };
    let definitions = m.definitions.iter().enumerate().find_map(definition);
    definitions.or_else(|| m.points.iter().enumerate().find_map(point))
}

fn forces(m: &Mechanism, views: &[&Views<'_>]) -> Option<Part> {
    let load = |load: &Load| {
        let (what, vectors, scalars) = match &load.kind {
            LoadKind::Gravity(vector) => ("gravity", vec![vector], vec![]),
            LoadKind::Force { force, .. } => ("force", vec![force], vec![]),
            LoadKind::Torque { torque, .. } => ("torque", vec![torque], vec![]),
            LoadKind::Spring { stiffness, length, damping, .. } => {
                ("force of this spring", vec![], vec![stiffness, length, damping])
            }
            LoadKind::Torsion { axis, angle, rest, stiffness, damping, .. } => {
                ("torque of this spring", vec![axis], vec![angle, rest, stiffness, damping])
            }
        };
        let found = vectors.into_iter().any(|value| never(views, &|views| vector(views, value)))
            || scalars.into_iter().any(|value| never(views, &|views| scalar(views, value)));
        found.then(|| (what.to_owned(), load.span))
    };
    let gap = |contact: &Contact| {
        let gap = contact.gap.as_ref()?;
        let found = never(views, &|views| scalar(views, gap));
        found.then(|| (format!("gap of `{}`", contact.name), contact.gap_span))
    };
    m.loads.iter().find_map(load).or_else(|| m.contacts.iter().find_map(gap))
}
