//! Reports masses and inertias that no body can have.

use std::collections::HashMap;

use super::states::at_rest;
use crate::diagnostics::{Code, Diagnostic, Label, codes};
use crate::model::Readable;
use crate::model::mechanism::{Body, BodyId, Mechanism, Scalar};
use crate::numeric::views::{dot3, sub3, values as components};
use crate::numeric::{self, Evaluator, Level, State};
use hodograph_arithmetic::POSSIBLE_INERTIA;

/// What rounding can leave of a difference beside its terms.
const ROUNDING: f64 = 1e-13;

/// What a body cannot have with some values of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Impossible {
    /// of this body
    pub body: BodyId,
    /// [`codes::MASS`] or [`codes::INERTIA`]
    pub code: Code,
    /// what is impossible, to go on after `the mass of X` or `the inertia of X`
    pub what: String,
}

/// The masses that are not positive and the inertias that no body has, with the parameters of a state. What
/// has no value there is passed over.
pub fn impossible_bodies(m: &Mechanism, state: &State) -> Vec<Impossible> {
    let values = at_rest(m, state);
    let of =
        |(i, body): (usize, &Body)| impossible(&values, body).map(|(code, what)| (BodyId(i), code, what));
    let found = m.bodies.iter().enumerate().filter_map(of);
    found.map(|(body, code, what)| Impossible { body, code, what }).collect()
}

fn impossible(values: &Evaluator<'_>, body: &Body) -> Option<(Code, String)> {
    if let Ok(mass) = values.scalar(&body.mass, Level::Motion)
        && mass.re <= 0.0
    {
        // the inertia mostly has it as a factor
        return Some((codes::MASS, format!("is {}", number(mass.re))));
    }
    let inertia = body.inertia.as_ref()?;
    // what is possible does not depend on the axes, only on the point
    let i = match inertia.about {
        Some(_) => numeric::central_inertia(values, body).ok()??,
        None => numeric::own_inertia(values, inertia).ok()?.map(|row| row.map(|c| c.re)),
    };
    let trace = i[0][0] + i[1][1] + i[2][2];
    let size = i.iter().flatten().fold(0.0_f64, |s, c| s.max(c.abs()));
    let possible = POSSIBLE_INERTIA * size + ROUNDING * moved(values, body).unwrap_or(0.0);
    // second moments of mass: tr(I)/2 - I must not be negative along any direction; that implies I is not
    // either
    let mut moments = i.map(|row| row.map(|c| -c));
    (0..3).for_each(|k| moments[k][k] += 0.5 * trace);
    if !i.iter().flatten().all(|c| c.is_finite()) || least_eigenvalue(&moments) >= -possible {
        return None;
    }
    let why = if least_eigenvalue(&i) < -possible {
        "a moment of inertia about some axis is negative"
    } else {
        "the largest principal moment exceeds the sum of the two others"
    };
    Some((
        codes::INERTIA,
        if inertia.about.is_some() { format!("about the mass centre, {why}") } else { why.to_owned() },
    ))
}

/// What an inertia about another point has more than that about the mass centre.
fn moved(values: &Evaluator<'_>, body: &Body) -> Option<f64> {
    let point = body.inertia.as_ref()?.about?;
    let mass = values.scalar(&body.mass, Level::Motion).ok()?.re;
    let arm = sub3(components(values.position(body.centre).ok()?), components(values.position(point).ok()?));
    Some(mass * dot3(arm, arm))
}

/// The same as messages about a model with its own values. `readable` says which bodies could be read,
/// `upright` whether axes are unit vectors.
pub(super) fn bodies(m: &Mechanism, state: &State, readable: &Readable, upright: bool) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    // bodies that have the same mass: it is one mistake
    let mut masses: HashMap<String, usize> = HashMap::new();
    for found in impossible_bodies(m, state) {
        let body = &m.bodies[found.body.0];
        let of_mass = found.code == codes::MASS;
        let about = body.inertia.as_ref().is_some_and(|inertia| inertia.about.is_some());
        if !of_mass && about && !upright {
            continue;
        }
        if !(if of_mass { &readable.masses } else { &readable.bodies })[found.body.0] {
            continue;
        }
        if of_mass {
            let mass = format!("{:?}", body.mass);
            if let Some(first) = masses.get(&mass) {
                let text = format!("so is that of `{}`", body.name);
                out[*first].related.push(Label { span: body.mass_span, text });
                continue;
            }
            masses.insert(mass, out.len());
        }
        out.push(if of_mass {
            let message = format!("the mass of `{}` {} with the values of the model", body.name, found.what);
            let error = Diagnostic::new(codes::MASS, body.mass_span, message).help("a mass is positive");
            match &body.mass {
                Scalar::Parameter(id) => {
                    let parameter = &m.parameters[id.0];
                    error.related(parameter.span, format!("`{}` is declared here", parameter.name))
                }
                _ => error,
            }
        } else {
            let message = format!("no body has the inertia of `{}` with the values of the model", body.name);
            let span = body.inertia.as_ref().map_or(body.span, |inertia| inertia.span);
            Diagnostic::new(codes::INERTIA, span, message).help(found.what)
        });
    }
    out
}

/// A number as a message shows it.
pub(super) fn number(value: f64) -> String {
    let rounded = format!("{value:.4}").parse::<f64>().unwrap_or(value);
    if rounded != 0.0 || value == 0.0 { rounded.to_string() } else { format!("{value:e}") }
}

/// The least eigenvalue of a symmetric 3 x 3 matrix: rotations that make it diagonal.
fn least_eigenvalue(matrix: &[[f64; 3]; 3]) -> f64 {
    let mut a = *matrix;
    for _ in 0..30 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = 0.5 * (2.0 * a[p][q]).atan2(a[q][q] - a[p][p]);
            let (s, c) = theta.sin_cos();
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (up, uq) = (a[p], a[q]);
            for k in 0..3 {
                (a[p][k], a[q][k]) = (c * up[k] - s * uq[k], s * up[k] + c * uq[k]);
            }
        }
    }
    a[0][0].min(a[1][1]).min(a[2][2])
}
