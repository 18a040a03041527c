//! Finds the hulls of polytopes in numbers, before the contacts of a model are known: how many contacts a pair of
//! polytopes has follows from their edges.

use super::start;
use crate::diagnostics::Diagnostic;
use crate::model::hulls::{Hull, Hulls, NoHull};
use crate::model::mechanism::{Anchor, Shape};
use crate::model::{self, pairs};
use crate::numeric::hyper_dual::HyperDual;
use crate::numeric::{Evaluator, Failure, Level, State};
use crate::syntax::tree::Tree;

/// The hulls of the polytopes whose pairs need them, with the values that the model gives.
pub fn hulls(tree: &Tree) -> Hulls {
    let needed: Vec<&str> = pairs::need_hulls(tree);
    if needed.is_empty() {
        return Hulls::new();
    }
    let without_contacts = Tree { contacts: Vec::new(), ..tree.clone() };
    let mut lowered = model::lower(&without_contacts, &Hulls::new(), Vec::new());
    let sound = !lowered.diagnostics.iter().any(Diagnostic::hides_meaning);
    start::complete(&mut lowered.mechanism, sound);
    let m = &lowered.mechanism;
    let state = State::of(m);
    let coordinates = state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect();
    let speeds = state.speeds.iter().map(|_| HyperDual::ZERO).collect();
    let values = Evaluator::new(m, &state.parameters, &state.inputs, HyperDual::ZERO, coordinates, speeds);
    let hull = |name: &str| {
        let number = m.shapes.iter().position(|shape| shape.name == name)?;
        let is_read = lowered.readable.shapes.get(number).copied().unwrap_or(false);
        let places = is_read.then(|| places(&values, &m.shapes[number]));
        Some(places.and_then(Result::ok).map_or(Err(NoHull::Unknown), |places| Hull::of(&places)))
    };
    needed.into_iter().filter_map(|name| Some((name.to_owned(), hull(name)?))).collect()
}

/// Where the vertices are.
fn places(values: &Evaluator<'_>, shape: &Shape) -> Result<Vec<[f64; 3]>, Failure> {
    let place = |anchor: &Anchor| {
        let (at, by) = (values.position(anchor.point)?, values.vector(&anchor.by, Level::Geometry)?);
        Ok([0, 1, 2].map(|i| at[i].re + by[i].re))
    };
    shape.vertices.iter().map(place).collect()
}
