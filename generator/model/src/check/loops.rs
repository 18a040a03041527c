//! Checks that loops which are stated by velocity constraints only are closed at the initial values.

use super::states::stated;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::Mechanism;
use crate::numeric::views::{norm3, sub3};
use crate::numeric::{self, State};

/// Points that are to be one may be this far apart, relative to their distance from O above 1 m: initial
/// values are rounded.
const OPEN: f64 = 1e-6;

/// Says so where the initial values leave a loop open. A model that states no initial value says nothing of
/// its start.
pub fn open_at_the_start(m: &Mechanism) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    if m.coordinates.iter().all(|coordinate| coordinate.value.is_none()) {
        return out;
    }
    let mut state = State::of(m);
    if numeric::assemble(m, &mut state).is_err() {
        return out;
    }
    let together = numeric::held_together(m, &state);
    let state = stated(m, &state, true);
    let values = super::states::at_rest(m, &state);
    for [p, q] in together {
        let [Ok(at), Ok(other)] = [p, q].map(|point| values.position(point)) else { continue };
        let [at, other] = [at, other].map(|v| v.map(|c| c.re));
        let apart = norm3(sub3(at, other));
        if apart > OPEN * norm3(at).max(norm3(other)).max(1.0) {
            let [a, b] = [p, q].map(|point| &m.points[point.0].name);
            let span = m.constraints.first().map_or(m.points[p.0].span, |equation| equation.span);
            let message = format!(
                "with the initial values `{a}` and `{b}` are {} m apart: a loop that is stated by velocities stays as open as it begins",
                super::bodies::number(apart)
            );
            let help = format!(
                "give initial values that close it, or add `configuration {{ position({a}) = position({b}); }}` with dependent coordinates"
            );
            out.push(Diagnostic::new(codes::NOT_CLOSED, span, message).help(help));
        }
    }
    out
}
