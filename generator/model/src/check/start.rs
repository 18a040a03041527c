//! Completes the initial values of a mechanism: expressions of other quantities, coordinates with which
//! contacts are closed, and quaternions that are rounded.

use std::collections::HashMap;

use super::physics::with_room;
use super::unit_vectors::{ROUNDED_QUATERNION, UNIT_QUATERNION};
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::{Initial, Mechanism, Orientation, Variable};
use crate::numeric;
use crate::span::Span;

/// Completes what follows from other quantities; `sound` says whether all of the model could be read.
pub fn complete(m: &mut Mechanism, sound: bool) -> Vec<Diagnostic> {
    let mut out = expressions(m);
    if sound && out.is_empty() {
        out.extend(in_contact(m));
    }
    normalise_quaternions(m);
    if sound { out } else { Vec::new() }
}

/// Numbers for the initial values that are expressions of others.
fn expressions(m: &mut Mechanism) -> Vec<Diagnostic> {
    let open = numeric::start::evaluate(m);
    // what rests on a start in contact is known with that
    let touching = |q: &Variable| matches!(q.initial, Some(Initial::Touching { .. }));
    let rests = m.coordinates.iter().any(touching);
    let error =
        |(variable, circular): (Variable, bool)| {
            let span = variable.initial.as_ref().map_or(variable.span, Initial::span);
            if circular {
                let message = format!("the initial value of `{}` is stated through itself", variable.name);
                Some(
                    Diagnostic::new(codes::CYCLE, span, message)
                        .help("give one of the quantities that depend on each other a number"),
                )
            } else if rests {
                None
            } else {
                let message = format!("the initial value of `{}` is not finite", variable.name);
                Some(Diagnostic::new(codes::NUMBER_RANGE, span, message).help(
                    "check the values of the parameters, and the arguments of sqrt, log, asin and acos",
                ))
            }
        };
    // what rests on a circle has no value either: one word about each circle is enough
    match open.iter().position(|(_, circular)| *circular) {
        Some(first) => open.into_iter().nth(first).and_then(error).into_iter().collect(),
        None => open.into_iter().filter_map(error).collect(),
    }
}

/// Divides quaternions that are rounded by their lengths.
fn normalise_quaternions(m: &mut Mechanism) {
    for frame in &m.frames {
        let Orientation::Quaternion(ids) = &frame.orientation else { continue };
        let norm = ids.iter().map(|id| m.coordinates[id.0].value.unwrap_or(0.0).powi(2)).sum::<f64>().sqrt();
        let off = (norm - 1.0).abs();
        if off > UNIT_QUATERNION && off <= ROUNDED_QUATERNION {
            ids.iter().for_each(|id| {
                let value = &mut m.coordinates[id.0].value;
                *value = value.map(|e| e / norm);
            });
        }
    }
}

/// Finds the coordinates with which contacts are closed at the start.
fn in_contact(m: &mut Mechanism) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let mut first: HashMap<usize, Span> = HashMap::new();
    for q in &m.coordinates {
        let Some(Initial::Touching { contact, span, .. }) = &q.initial else { continue };
        let Some(named) = m.contacts.get(*contact) else { continue };
        if named.gap.is_none() {
            let message = format!("the contact `{}` has no gap that could be 0", named.name);
            let error =
                Diagnostic::new(codes::START, *span, message).related(named.span, "this has no `gap`");
            out.push(error.help("add a `gap` to the contact"));
        } else if let Some(other) = first.insert(*contact, *span) {
            let message = format!("two coordinates are to close the contact `{}`", named.name);
            let error = Diagnostic::new(codes::START, *span, message).related(other, "the other one");
            out.push(error.help("one closes it; give the other a value"));
        }
    }
    if out.is_empty() {
        for i in with_room(|| numeric::start::close(m)) {
            let Some(q) = m.coordinates.get(i) else { continue };
            let span = q.initial.as_ref().map_or(q.span, Initial::span);
            let message = format!("no value of `{}` near the guess closes the contact", q.name);
            out.push(Diagnostic::new(codes::START, span, message).help(
                "give a number near it as the second argument, as in `touching(floor, 0.4)`; the gap must depend on this coordinate",
            ));
        }
    }
    out
}
