//! Checks that need numbers: they look at the mechanism at several arbitrary states near its initial values. What is wrong at
//! all of them is wrong with the mechanism; what is wrong at one may be a singular state, which is no mistake of the model.

use crate::diagnostics::{Code, Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::{self, Evaluation, Evaluator, Failure, Level, State, hyper_dual::HyperDual};
use crate::span::Span;

/// Mechanisms of more parts than this are not looked at: it would take too long.
pub const MOST_PARTS: usize = 2000;
/// How far the states lie from the initial values.
const DISTANCES: [f64; 5] = [0.7, 0.4, 0.2, 0.05, 0.0];

/// Mistakes that show in numbers; `name` is where the mechanism is named.
pub fn physics(m: &Mechanism, name: Span) -> Vec<Diagnostic> {
    let parts = m.points.len() + m.frames.len() + m.definitions.len() + m.bodies.len() + m.contacts.len();
    if parts > MOST_PARTS {
        let message = format!("a mechanism of {parts} parts is not looked at in numbers");
        let help = "what shows in numbers alone (impossible inertias, singular constraints, normals that are no unit vectors) is not found \
                    in more than 2000 points, frames, definitions, bodies and contacts";
        return vec![Diagnostic::new(codes::UNCHECKED, name, message).help(help)];
    }
    // names may refer to names deeply: a stack of its own, and the thread's end is the end of any trouble
    let look = || look(m);
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(64 << 20).spawn_scoped(scope, look);
        match thread.map(|thread| thread.join()) {
            Ok(Ok(found)) => found,
            // tests and the fuzzer must see trouble; a build must go on
            Ok(Err(panic)) if cfg!(debug_assertions) => std::panic::resume_unwind(panic),
            Ok(Err(_)) | Err(_) => Vec::new(),
        }
    })
}

fn look(m: &Mechanism) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let states: Vec<State> = DISTANCES.iter().enumerate().map(|(i, d)| state(m, *d, i as u64)).collect();
    axes(m, &states, &mut out);
    quaternions(m, &mut out);
    // without proper axes nothing turns as it should
    if out.is_empty() {
        bodies(m, &states, &mut out);
    }
    if !out.is_empty() {
        return out;
    }
    let (mut seen, mut states_seen) = (Vec::new(), Vec::new());
    let mut turns: Option<Vec<bool>> = None;
    let mut failures = Vec::new();
    for mut state in states {
        let result = numeric::assemble(m, &mut state).and_then(|()| numeric::evaluate(m, &state));
        match result {
            Ok(evaluation) => {
                let turning = turning_inertias(m, &state, &evaluation);
                turns = Some(turns.map_or(turning.clone(), |before: Vec<bool>| {
                    before.iter().zip(&turning).map(|(a, b)| *a && *b).collect()
                }));
                states_seen.push((state.clone(), evaluation.clone()));
                seen.push(evaluation);
            }
            Err(failure) => failures.push((state, failure)),
        }
    }
    if seen.is_empty() && failures.iter().all(|(_, f)| matches!(f, Failure::NotClosed(_))) {
        let message = "the configuration equations have no solution near the values of the model";
        let span = m.configuration.first().map_or(Span::default(), |equation| equation.span);
        let help = "check the lengths, and the guesses of the dependent coordinates; until they fit, what shows in numbers is not looked at";
        out.push(Diagnostic::new(codes::NOT_CLOSED, span, message).help(help));
    } else if seen.is_empty() {
        // the first state is the most general one
        if let Some((state, failure)) = failures.iter().find(|(_, f)| !matches!(f, Failure::NotClosed(_))) {
            out.extend(nowhere(m, state, failure));
        }
    } else {
        for (body, _) in m.bodies.iter().zip(turns.unwrap_or_default()).filter(|(_, turns)| *turns) {
            let frame = body.inertia.as_ref().map_or("", |inertia| m.frames[inertia.frame.0].name.as_str());
            let message = format!("the inertia of `{}` is not constant in `{frame}`", body.name);
            let help = format!(
                "the body turns in `{frame}`, but not about an axis of symmetry; give its inertia in its own frame"
            );
            let span = body.inertia.as_ref().map_or(body.span, |inertia| inertia.span);
            out.push(Diagnostic::new(codes::INERTIA, span, message).help(help));
        }
        inertia_of_speeds(m, &seen, &mut out);
        out.extend(super::body_points::strangers(m, &seen));
        contacts(m, &seen, &mut out);
        out.extend(super::vector_constraints::inseparable(m, &states_seen));
    }
    out
}

/// A state away from the initial one. The numbers are arbitrary but always the same.
fn state(m: &Mechanism, distance: f64, seed: u64) -> State {
    let mut state = State::of(m);
    let mut bits = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed + 1);
    let mut next = || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    for (value, parameter) in state.parameters.iter_mut().zip(&m.parameters) {
        if parameter.value.is_none() {
            *value = 1.0 + 0.5 * next();
        }
    }
    state.time = 0.5 * (1.0 + next());
    for q in &mut state.coordinates {
        *q += distance * next();
    }
    for u in &mut state.speeds {
        *u += 0.5 + 0.4 * next();
    }
    for input in &mut state.inputs {
        *input += next();
    }
    for frame in &m.frames {
        if let Orientation::Quaternion(ids) = &frame.orientation {
            let length = ids.iter().map(|id| state.coordinates[id.0].powi(2)).sum::<f64>().sqrt();
            if length > 0.0 {
                ids.iter().for_each(|id| state.coordinates[id.0] /= length);
            }
        }
    }
    state
}

/// Values of expressions at a state at rest.
fn at_rest<'m>(m: &'m Mechanism, state: &'m State) -> Evaluator<'m> {
    let coordinates = state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect();
    let speeds = vec![HyperDual::ZERO; m.speeds.len()];
    Evaluator::new(m, &state.parameters, &state.inputs, HyperDual::constant(state.time), coordinates, speeds)
}

/// Does the model say what every parameter is?
fn has_values(m: &Mechanism) -> bool {
    m.parameters.iter().all(|p| p.value.is_some())
}

fn bodies(m: &Mechanism, states: &[State], out: &mut Vec<Diagnostic>) {
    let Some(state) = states.last().filter(|_| has_values(m)) else { return };
    let values = at_rest(m, state);
    for body in &m.bodies {
        if let Ok(mass) = values.scalar(&body.mass, Level::Motion)
            && mass.re <= 0.0
        {
            let message =
                format!("the mass of `{}` is {} with the values of the model", body.name, number(mass.re));
            out.push(Diagnostic::new(codes::MASS, body.mass_span, message).help("a mass is positive"));
            // the inertia mostly has it as a factor
            continue;
        }
        let Ok(Some(i)) = numeric::central_inertia(&values, body) else { continue };
        let trace = i[0][0] + i[1][1] + i[2][2];
        let size = i.iter().flatten().fold(0.0_f64, |s, c| s.max(c.abs()));
        // second moments of mass: tr(I)/2 - I must not be negative along any direction; that implies I is not either
        let mut moments = i.map(|row| row.map(|c| -c));
        (0..3).for_each(|k| moments[k][k] += 0.5 * trace);
        let least = least_eigenvalue(&moments);
        let least_inertia = least_eigenvalue(&i);
        if least < -1e-9 * size {
            let code = codes::INERTIA;
            let message = format!("no body has the inertia of `{}` with the values of the model", body.name);
            let about = body.inertia.as_ref().is_some_and(|inertia| inertia.about.is_some());
            let help = if least_inertia < -1e-9 * size {
                "a moment of inertia about some axis is negative"
            } else {
                "the largest principal moment exceeds the sum of the two others"
            };
            let help = if about { format!("about the mass centre, {help}") } else { help.to_owned() };
            let span = body.inertia.as_ref().map_or(body.span, |inertia| inertia.span);
            out.push(Diagnostic::new(code, span, message).help(help));
        }
    }
}

/// For each body: is its inertia given in a frame in which it changes? It does not if turning about the relative angular
/// velocity W leaves it as it is: W I = I W.
fn turning_inertias(m: &Mechanism, state: &State, at: &Evaluation) -> Vec<bool> {
    let values = at_rest(m, state);
    let changes = |body: &Body| {
        let (Some(frame), Some(inertia)) = (body.frame, &body.inertia) else { return false };
        if inertia.frame == frame || inertia.about.is_some() {
            return false;
        }
        let Ok(Some(i)) = numeric::central_inertia(&values, body) else { return false };
        let (a, b) = (at.angular_velocities[frame.0], at.angular_velocities[inertia.frame.0]);
        let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let w = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        let entry = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3], r: usize, c: usize| {
            (0..3).map(|k| a[r][k] * b[k][c]).sum::<f64>()
        };
        let size = |a: &[[f64; 3]; 3]| a.iter().flatten().fold(0.0_f64, |s, e| s.max(e.abs()));
        let change = (0..9)
            .map(|n| (entry(&w, &i, n / 3, n % 3) - entry(&i, &w, n / 3, n % 3)).abs())
            .fold(0.0, f64::max);
        change > 1e-9 * size(&w) * size(&i)
    };
    m.bodies.iter().map(changes).collect()
}

/// A number as a message shows it.
fn number(value: f64) -> String {
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

/// Axes that must be unit vectors.
fn axes(m: &Mechanism, states: &[State], out: &mut Vec<Diagnostic>) {
    if !has_values(m) {
        return;
    }
    for frame in &m.frames {
        let Orientation::About { axis, .. } = &frame.orientation else { continue };
        let lengths = states.iter().filter_map(|state| {
            let values = at_rest(m, state);
            let squares = axis.iter().map(|c| Some(values.scalar(c, Level::Geometry).ok()?.re.powi(2)));
            Some(squares.sum::<Option<f64>>()?.sqrt())
        });
        let message = |length| format!("the axis of `{}` has the length {length}, not 1", frame.name);
        not_unit(codes::FRAME, frame.orientation_span, lengths.collect(), message, out);
    }
    for load in &m.loads {
        let LoadKind::Torsion { axis, .. } = &load.kind else { continue };
        let lengths = states.iter().filter_map(|state| {
            let v = at_rest(m, state).vector(axis, Level::Motion).ok()?;
            Some(v.iter().map(|c| c.re * c.re).sum::<f64>().sqrt())
        });
        let message = |length| format!("the axis of this torsion spring has the length {length}, not 1");
        not_unit(codes::LOAD, load.span, lengths.collect(), message, out);
    }
}

/// Initial values of quaternions: all left out (or 0) is the identity.
fn quaternions(m: &Mechanism, out: &mut Vec<Diagnostic>) {
    for frame in &m.frames {
        let Orientation::Quaternion(ids) = &frame.orientation else { continue };
        let values = ids.map(|id| m.coordinates[id.0].value.unwrap_or(0.0));
        let norm = values.iter().map(|e| e * e).sum::<f64>().sqrt();
        if norm > 0.0 && (norm - 1.0).abs() > 1e-10 {
            let message = format!(
                "the initial values of the quaternion of `{}` have the norm {}, not 1",
                frame.name,
                number(norm)
            );
            let help = "divide them by it; left out, they are those of the identity";
            out.push(Diagnostic::new(codes::QUATERNION, m.coordinates[ids[0].0].span, message).help(help));
        }
    }
}

fn not_unit(
    code: Code,
    span: Span,
    lengths: Vec<f64>,
    message: impl Fn(String) -> String,
    out: &mut Vec<Diagnostic>,
) {
    let off = |length: &f64| length.is_finite() && (length - 1.0).abs() > 1e-9;
    if let Some(first) = lengths.first().filter(|_| lengths.iter().all(off)) {
        let help = match code {
            _ if *first < 1e-12 => "it is zero",
            codes::FRAME => "divide its components by its length",
            _ => "`unit(v)` is the unit vector along v",
        };
        out.push(Diagnostic::new(code, span, message(number(*first))).help(help));
    }
}

/// What fails at every state.
fn nowhere(m: &Mechanism, state: &State, failure: &Failure) -> Option<Diagnostic> {
    Some(match failure {
        Failure::RatesUndetermined(q) => {
            let q = &m.coordinates[q.0];
            let message = format!("the kinematical equations do not determine d({})/dt", q.name);
            Diagnostic::new(codes::KINEMATICS_SINGULAR, q.span, message)
                .help("as many independent equations are needed as there are coordinates; those that `velocities` and `angular_velocities` state count")
        }
        Failure::MotionInconsistent(span, _) => {
            let message =
                "the motion stated of this contradicts its position or another kinematical equation";
            let help = "a stated velocity must be one that the position can have, and no rate may be stated twice with different values";
            Diagnostic::new(codes::INCONSISTENT, *span, message).help(help)
        }
        Failure::SpeedsUndetermined(u) => {
            let u = &m.speeds[u.0];
            let dependent = m.speeds.iter().filter(|u| u.dependent).count();
            match numeric::constraint_rank(m, state) {
                Ok(rank) if rank < dependent => {
                    let message = format!(
                        "the constraints amount to {} for {dependent} dependent speeds",
                        count(rank, "independent equation")
                    );
                    Diagnostic::new(
                        codes::CONSTRAINT_COUNT,
                        m.constraints.first().map_or(u.span, |e| e.span),
                        message,
                    )
                    .related(u.span, "this is not determined")
                    .help("add constraints, or declare fewer speeds under `dependent`")
                }
                _ => Diagnostic::new(
                    codes::CONSTRAINT_SINGULAR,
                    u.span,
                    format!("the constraints do not determine the dependent speed `{}`", u.name),
                )
                .help("declare another speed dependent, one that the constraints speak of"),
            }
        }
        Failure::ConstraintsInconsistent(span) => {
            let dependent = m.speeds.iter().filter(|u| u.dependent).count();
            let message = match numeric::constraint_rank(m, state) {
                Ok(rank) if rank > dependent => format!(
                    "the constraints amount to {} for {}",
                    count(rank, "independent equation"),
                    count(dependent, "dependent speed")
                ),
                _ => "the constraints contradict each other".to_owned(),
            };
            Diagnostic::new(codes::CONSTRAINT_COUNT, *span, message)
                .label("this is one too many")
                .help("each independent constraint needs a speed under `dependent`")
        }
        Failure::DivisionByZero(span) => {
            let message = "this is zero at every state that was tried";
            Diagnostic::new(codes::ZERO_DIVISOR, *span, message).help(
                "division by it is not possible; if a parameter is 0 only by default, give it another value",
            )
        }
        Failure::NotFinite(span) => {
            let message = "this is not finite at any state that was tried";
            let help = "check the values of the parameters, and the arguments of sqrt, log, asin and acos";
            Diagnostic::new(codes::NUMBER_RANGE, *span, message).help(help)
        }
        Failure::NotClosed(_) | Failure::TooDeep | Failure::Unsupported(_) => return None,
    })
}

fn count(n: usize, word: &str) -> String {
    format!("{n} {word}{}", if n == 1 { "" } else { "s" })
}

/// Speeds along which nothing resists.
fn inertia_of_speeds(m: &Mechanism, seen: &[Evaluation], out: &mut Vec<Diagnostic>) {
    let columns: Vec<Option<usize>> = seen.iter().map(|e| numeric::singular_column(&e.mass_matrix)).collect();
    if !columns.iter().all(Option::is_some) {
        return;
    }
    let Some(Some(column)) = columns.first() else { return };
    let Some(speed) = m.speeds.get(*column) else { return };
    let alone = seen.iter().all(|e| e.mass_matrix[*column][*column].abs() < 1e-15);
    let message = if alone {
        format!("nothing that has mass moves with the speed `{}`", speed.name)
    } else {
        format!(
            "the mass matrix is singular: `{}` moves nothing that the other speeds do not move",
            speed.name
        )
    };
    out.push(Diagnostic::new(codes::NO_INERTIA, speed.span, message).help(
        "give what it moves a mass or inertia, remove the speed, or make it dependent by a constraint",
    ));
}

fn contacts(m: &Mechanism, seen: &[Evaluation], out: &mut Vec<Diagnostic>) {
    for (i, contact) in m.contacts.iter().enumerate() {
        let length = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        if has_values(m) {
            let lengths = seen.iter().map(|e| length(&e.contacts[i].normal)).collect();
            let message = |length| format!("the normal of `{}` has the length {length}, not 1", contact.name);
            not_unit(codes::NORMAL, contact.normal_span, lengths, message, out);
        }
        let velocities = |e: &'_ Evaluation| {
            let contact = &e.contacts[i];
            contact.partial_velocities.iter().chain([&contact.remainder]).copied().collect::<Vec<_>>()
        };
        let any = |moves: &dyn Fn(&[f64; 3], &[f64; 3]) -> bool| {
            seen.iter().any(|e| velocities(e).iter().any(|v| moves(v, &e.contacts[i].normal)))
        };
        if !any(&|v, _| length(v) > 1e-12) {
            let message =
                format!("the relative velocity of `{}` is always zero: nothing can strike", contact.name);
            let help = "check `point`, `against` and the bodies they belong to";
            out.push(Diagnostic::new(codes::CONTACT_STILL, contact.span, message).help(help));
        } else if !any(&|v, n| (0..3).map(|k| v[k] * n[k]).sum::<f64>().abs() > 1e-12 * length(v)) {
            let message = format!("`{}` never moves along its normal: nothing can strike", contact.name);
            let help = "check `normal`; it points from what is struck to the body that strikes";
            out.push(Diagnostic::new(codes::NEVER_APPROACHES, contact.span, message).help(help));
        }
    }
}
