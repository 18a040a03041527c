//! Warns of what holds with the values of the parameters alone: unit vectors, and inertias that do not change in the frame
//! in which they are given. Parameters may change at run time.

use super::independent_constraints::with_parameters_moved;
use super::motion::turning_inertias;
use super::states::at_rest;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::{self, Level, State, Views};
use crate::span::Span;

/// A vector is no unit vector if its length misses 1 by this much.
const UNIT: f64 = 1e-9;
const HELP: &str =
    "make the parameters whose values matter `fixed`, or state it such that it holds with all values";

/// A warning for each vector and inertia that is as it must be with the stated values, and not with others. Call it where
/// nothing is wrong with the stated ones.
pub fn by_values(m: &Mechanism, states: &[State]) -> Vec<Diagnostic> {
    if m.parameters.iter().all(|parameter| parameter.fixed) {
        return Vec::new();
    }
    let moved = states.iter().filter_map(|state| {
        let mut state = with_parameters_moved(m, state);
        numeric::assemble(m, &mut state).ok().map(|()| state)
    });
    let moved: Vec<State> = moved.collect();
    let mut out = Vec::new();
    let mut warn = |what: String, span: Span| {
        let message = format!("{what} with these values of the parameters alone");
        out.push(Diagnostic::new(codes::BY_VALUES, span, message).help(HELP));
    };
    let by_values = |vector: &Vector| {
        let off = |states: &[State]| states.iter().any(|state| is_longer_or_shorter(m, state, vector));
        !off(states) && off(&moved)
    };
    // without proper axes nothing turns as it should
    for vectors in [axes_of_frames(m), other_unit_vectors(m)] {
        let mut upright = true;
        for (what, vector, span) in vectors {
            if by_values(&vector) {
                warn(format!("{what} has the length 1"), span);
                upright = false;
            }
        }
        if !upright {
            return out;
        }
    }
    for (body, turns) in m.bodies.iter().zip(turning(m, &moved)) {
        if let (true, Some(inertia)) = (turns, &body.inertia) {
            let frame = &m.frames[inertia.frame.0].name;
            warn(format!("the inertia of `{}` is constant in `{frame}`", body.name), inertia.span);
        }
    }
    out
}

/// A vector that must be a unit vector: what it is, and where it stands.
type UnitVector = (String, Vector, Span);

fn axes_of_frames(m: &Mechanism) -> Vec<UnitVector> {
    let of_frame = |frame: &Frame| match &frame.orientation {
        Orientation::About { axis, .. } => {
            let components = Vector::Components(FrameId::N, axis.clone());
            Some((format!("the axis of `{}`", frame.name), components, frame.orientation_span))
        }
        _ => None,
    };
    m.frames.iter().filter_map(of_frame).collect()
}

/// Those of loads, shapes and contacts; normals of contacts of shapes follow from the shapes.
fn other_unit_vectors(m: &Mechanism) -> Vec<UnitVector> {
    let of_load = |load: &Load| match &load.kind {
        LoadKind::Torsion { axis, .. } => {
            Some(("the axis of this torsion spring".to_owned(), axis.clone(), load.span))
        }
        _ => None,
    };
    let of_shape = |shape: &Shape| {
        let what = if shape.kind.is_flat() { "normal" } else { "axis" };
        Some((format!("the {what} of `{}`", shape.name), shape.axis.clone()?, shape.axis_span))
    };
    let of_contact = |contact: &Contact| {
        let what = format!("the normal of `{}`", contact.name);
        contact.shapes.is_none().then(|| (what, contact.normal.clone(), contact.normal_span))
    };
    let loads = m.loads.iter().filter_map(of_load);
    loads
        .chain(m.shapes.iter().filter_map(of_shape))
        .chain(m.contacts.iter().filter_map(of_contact))
        .collect()
}

fn is_longer_or_shorter(m: &Mechanism, state: &State, vector: &Vector) -> bool {
    let Ok(v) = at_rest(m, state).vector(vector, Level::Motion) else { return false };
    let length = v.iter().map(|c| c.re * c.re).sum::<f64>().sqrt();
    length.is_finite() && (length - 1.0).abs() > UNIT
}

/// For each body whether its inertia changes in its frame, at all of the states.
fn turning(m: &Mechanism, states: &[State]) -> Vec<bool> {
    let at = states.iter().filter_map(|state| {
        let views = Views::at(m, state).ok()?;
        let at = numeric::evaluate_views(m, &views).ok()?;
        Some(turning_inertias(m, state, &at))
    });
    let at: Vec<Vec<bool>> = at.collect();
    (0..m.bodies.len()).map(|body| !at.is_empty() && at.iter().all(|turns| turns[body])).collect()
}
