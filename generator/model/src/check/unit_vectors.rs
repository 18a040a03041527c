//! Checks that axes and normals are unit vectors and that initial quaternions have the length 1.

use super::bodies::number;
use super::states::at_rest;
use crate::diagnostics::{Code, Diagnostic, codes};
use crate::model::Readable;
use crate::model::mechanism::*;
use crate::numeric::{Level, State};
use crate::span::Span;

/// Initial values of quaternions may miss the length 1 by this much, as rounded numbers do: they are then
/// divided by it.
pub const ROUNDED_QUATERNION: f64 = 1e-6;
/// By so little they are left as they are.
pub const UNIT_QUATERNION: f64 = 1e-10;

/// Axes, normals and quaternions at states in which what the model does not say is not a number.
pub fn unit_vectors(m: &Mechanism, readable: &Readable, states: &[State]) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for (i, frame) in m.frames.iter().enumerate().filter(|(i, _)| readable.frames[*i]) {
        let Orientation::About { axis, .. } = &frame.orientation else { continue };
        let lengths = states.iter().filter_map(|state| {
            let values = at_rest(m, state);
            let squares = axis.iter().map(|c| Some(values.scalar(c, Level::Geometry).ok()?.re.powi(2)));
            Some(squares.sum::<Option<f64>>()?.sqrt())
        });
        let message = |length| format!("the axis of `{}` has the length {length}, not 1", m.frames[i].name);
        out.extend(not_unit(codes::FRAME, frame.orientation_span, lengths.collect(), message));
    }
    for load in &m.loads {
        let LoadKind::Torsion { axis, .. } = &load.kind else { continue };
        let message = |length| format!("the axis of this torsion spring has the length {length}, not 1");
        out.extend(not_unit(codes::LOAD, load.span, lengths(m, states, axis), message));
    }
    if readable.initial_values {
        out.extend(quaternions(m, readable));
    }
    out
}

/// The normals of the contacts.
pub fn normals(m: &Mechanism, states: &[State]) -> Vec<Diagnostic> {
    let check = |contact: &Contact| {
        let message = |length| format!("the normal of `{}` has the length {length}, not 1", contact.name);
        let valid: Vec<State> = states.iter().filter(|state| is_valid(m, state, contact)).cloned().collect();
        not_unit(codes::NORMAL, contact.normal_span, lengths(m, &valid, &contact.normal), message)
    };
    m.contacts.iter().filter_map(check).collect()
}

/// Whether a contact is within the faces and edges to which its normal belongs.
fn is_valid(m: &Mechanism, state: &State, contact: &Contact) -> bool {
    contact.validity.as_ref().is_none_or(|validity| {
        at_rest(m, state).scalar(validity, Level::Motion).is_ok_and(|validity| validity.re > 0.0)
    })
}

fn lengths(m: &Mechanism, states: &[State], vector: &Vector) -> Vec<f64> {
    let length = |state: &State| {
        let v = at_rest(m, state).vector(vector, Level::Motion).ok()?;
        Some(v.iter().map(|c| c.re * c.re).sum::<f64>().sqrt())
    };
    states.iter().filter_map(length).collect()
}

fn not_unit(
    code: Code,
    span: Span,
    lengths: Vec<f64>,
    message: impl Fn(String) -> String,
) -> Option<Diagnostic> {
    let off = |length: &f64| length.is_finite() && (length - 1.0).abs() > 1e-9;
    // at one state a vector may have the length 1 by chance
    let first = lengths.iter().find(|length| off(length))?;
    let help = match code {
        _ if *first < 1e-12 => "it is zero",
        codes::FRAME => "divide its components by its length",
        _ => "`unit(v)` is the unit vector along v",
    };
    Some(Diagnostic::new(code, span, message(length_shown(*first))).help(help))
}

/// A length that is not 1, with the digits that tell it from 1.
pub(super) fn length_shown(length: f64) -> String {
    if (length - 1.0).abs() < 1e-3 { format!("{length:.12}") } else { number(length) }
}

/// Initial values of quaternions: the first left out and the others too, or 0, is the identity.
fn quaternions(m: &Mechanism, readable: &Readable) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for (_, frame) in m.frames.iter().enumerate().filter(|(i, _)| readable.frames[*i]) {
        let Orientation::Quaternion(ids) = &frame.orientation else { continue };
        let values = ids.map(|id| m.coordinates[id.0].value.unwrap_or(0.0));
        let norm = values.iter().map(|e| e * e).sum::<f64>().sqrt();
        let stated = norm > 0.0 || m.coordinates[ids[0].0].value.is_some();
        if stated && (norm - 1.0).abs() > UNIT_QUATERNION {
            let message = format!(
                "the initial values of the quaternion of `{}` have the norm {}, not 1",
                frame.name,
                if (norm - 1.0).abs() < 1e-3 { format!("{norm:.9}") } else { number(norm) }
            );
            let help =
                "divide them by it (rounding of 1e-6 is mended); left out, they are those of the identity";
            out.push(Diagnostic::new(codes::QUATERNION, m.coordinates[ids[0].0].span, message).help(help));
        }
    }
    out
}
