//! Checks the functions of implicit surfaces by numbers: each must vanish somewhere, and change its sign there with a
//! slope (section 16.15 of docs/theory.md).

use super::states::at_rest;
use crate::arbitrary::Arbitrary;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::views::{dot3, norm3, sub3};
use crate::numeric::{Evaluator, Level, State};

/// Distances from the place of the surface, m, at which the search for it begins, and how often at each.
const DISTANCES: [f64; 7] = [1e-3, 1e-2, 0.1, 0.4, 1.0, 10.0, 100.0];
const STARTS: usize = 4;
/// Steps of Newton's method: a function with a zero of the sixth order falls to a third in each.
const STEPS: usize = 40;
/// A function vanishes where it is this part of what it was at the start.
const VANISHES: f64 = 1e-13;
/// It has a slope there if this times the distance to the start is not this part of its value there.
const SLOPE: f64 = 1e-4;

/// What a search for the surface came to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Found {
    /// the function changes its sign
    Surface,
    /// the function vanishes with its gradient
    Flat,
    Nothing,
}

/// What is wrong with the function of an implicit surface.
pub fn implicit_surface(m: &Mechanism, state: &State, shape: &Shape) -> Option<Diagnostic> {
    let function = shape.function.as_ref()?;
    let values = at_rest(m, state);
    let mut arbitrary = Arbitrary::after(0x9e37_79b9_7f4a_7c15);
    let mut found = Vec::new();
    let mut signs = [false; 2];
    for distance in DISTANCES {
        for _ in 0..STARTS {
            let start = [0, 1, 2].map(|_| distance * arbitrary.number());
            let search = search(&values, function, start, &mut signs);
            if search == Some(Found::Surface) {
                return None;
            }
            found.extend(search);
        }
    }
    let (message, help) = if found.contains(&Found::Flat) {
        (
            format!("the function of `{}` vanishes only where its gradient does", shape.name),
            "its gradient is the direction of contact: write a function that has another sign on the other side, as x^2 + y^2 - r^2",
        )
    } else if found.is_empty() || signs == [true; 2] {
        return None;
    } else {
        (
            format!(
                "the function of `{}` vanishes nowhere: it has one sign wherever it was tried",
                shape.name
            ),
            "the surface is where the function is zero, and bodies are free where it is positive, as with x^2 + y^2 - r^2; check its signs and parameters",
        )
    };
    Some(Diagnostic::new(codes::SHAPE, shape.span, message).help(help))
}

/// Follows Newton's method to a zero. `None` where there are no numbers at the start.
fn search(
    values: &Evaluator<'_>,
    function: &OfPlace<3>,
    start: [f64; 3],
    signs: &mut [bool; 2],
) -> Option<Found> {
    let first = value(values, function, start)?;
    let (mut place, mut now) = (start, first);
    for _ in 0..STEPS {
        signs[usize::from(now < 0.0)] |= now != 0.0;
        let slopes = slopes(values, function, place)?;
        if now.abs() <= VANISHES * first.abs() {
            let slope = norm3(slopes) * norm3(sub3(place, start));
            return Some(if slope > SLOPE * first.abs() { Found::Surface } else { Found::Flat });
        }
        let square = dot3(slopes, slopes);
        if square == 0.0 {
            return Some(Found::Nothing);
        }
        place = [0, 1, 2].map(|i| place[i] - now / square * slopes[i]);
        let Some(next) = value(values, function, place) else { return Some(Found::Nothing) };
        now = next;
    }
    Some(Found::Nothing)
}

fn value(values: &Evaluator<'_>, function: &OfPlace<3>, place: [f64; 3]) -> Option<f64> {
    number(values, &function.value_at(place)?)
}

fn slopes(values: &Evaluator<'_>, function: &OfPlace<3>, place: [f64; 3]) -> Option<[f64; 3]> {
    let [x, y, z] = function.slopes_at(place)?.map(|slope| number(values, &slope));
    Some([x?, y?, z?])
}

fn number(values: &Evaluator<'_>, scalar: &Scalar) -> Option<f64> {
    Some(values.scalar(scalar, Level::Geometry).ok()?.re).filter(|value| value.is_finite())
}
