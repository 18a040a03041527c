//! Checks the motion by numbers: the equations must determine the rates and the dependent speeds, and every
//! speed must have inertia.

use super::states::{Seen, at_rest};
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::*;
use crate::numeric::views::dot3;
use crate::numeric::{self, Evaluation, Failure, Level, State, Views};

/// What rounding can leave of a number beside its terms.
const ROUNDING: f64 = 1e-12;

/// Bodies whose inertia is given in a frame in which it changes, at all of the states.
pub fn changing_inertias(m: &Mechanism, seen: &[Seen<'_>]) -> Vec<Diagnostic> {
    let at: Vec<Vec<bool>> = seen.iter().map(|seen| turning_inertias(m, seen.state, &seen.at)).collect();
    let mut out = Vec::new();
    for (_, body) in m.bodies.iter().enumerate().filter(|(i, _)| at.iter().all(|turns| turns[*i])) {
        let frame = body.inertia.as_ref().map_or("", |inertia| m.frames[inertia.frame.0].name.as_str());
        let message = format!("the inertia of `{}` is not constant in `{frame}`", body.name);
        let help = format!(
            "the body turns in `{frame}`, but not about an axis of symmetry; give its inertia in its own frame"
        );
        let span = body.inertia.as_ref().map_or(body.span, |inertia| inertia.span);
        out.push(Diagnostic::new(codes::INERTIA, span, message).help(help));
    }
    out
}

/// For each body: whether its inertia is given in a frame in which it changes. It does not if turning about
/// the relative angular velocity W leaves it as it is: W I = I W.
pub fn turning_inertias(m: &Mechanism, state: &State, at: &Evaluation) -> Vec<bool> {
    let values = at_rest(m, state);
    let changes = |body: &Body| {
        let (Some(frame), Some(inertia)) = (body.frame, &body.inertia) else { return false };
        if inertia.frame == frame || inertia.about.is_some() {
            return false;
        }
        let Ok(Some(i)) = numeric::central_inertia(&values, body) else { return false };
        let (a, b) = (at.angular_velocities[frame.0], at.angular_velocities[inertia.frame.0]);
        let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        // what rounding leaves where both turn alike is no turning
        let speed = |w: &[f64; 3]| w.iter().fold(0.0_f64, |s, c| s.max(c.abs()));
        if speed(&[x, y, z]) <= ROUNDING * speed(&a).max(speed(&b)) {
            return false;
        }
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

/// What fails at every state.
pub fn nowhere(m: &Mechanism, state: &State, failure: &Failure) -> Option<Diagnostic> {
    Some(match failure {
        Failure::RatesUndetermined(q) => {
            let q = &m.coordinates[q.0];
            let message = format!("the kinematical equations do not determine d({})/dt", q.name);
            Diagnostic::new(codes::KINEMATICS_SINGULAR, q.span, message)
                .help("as many independent equations are needed as there are coordinates; those that `velocities` and `angular_velocities` state count")
        }
        Failure::MotionInconsistent(span, _) => {
            let message = "the motion stated here contradicts the position or another kinematical equation";
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
            let message = "this is zero at every state at which the model was evaluated";
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
pub fn inertia_of_speeds(m: &Mechanism, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    // a model without bodies has been reported already
    if m.bodies.is_empty() {
        return None;
    }
    let noise: Vec<Vec<f64>> = seen.iter().map(|seen| noise(m, &seen.views).unwrap_or_default()).collect();
    let column =
        |(seen, noise): (&Seen<'_>, &Vec<f64>)| numeric::singular_column(&seen.at.mass_matrix, noise);
    let columns: Vec<Option<usize>> = seen.iter().zip(&noise).map(column).collect();
    if !columns.iter().all(Option::is_some) {
        return None;
    }
    let column = columns.first()?.as_ref()?;
    let speed = m.speeds.get(*column)?;
    let still =
        |(seen, noise): (&Seen<'_>, &Vec<f64>)| seen.at.mass_matrix[*column][*column] <= noise[*column];
    let message = if seen.iter().zip(&noise).all(still) {
        format!("nothing that has mass moves with the speed `{}`", speed.name)
    } else {
        format!(
            "the mass matrix is singular: `{}` moves nothing that the other speeds do not move",
            speed.name
        )
    };
    let help = "give a mass or an inertia to what moves with the speed, remove the speed, or make it dependent by a constraint";
    Some(Diagnostic::new(codes::NO_INERTIA, speed.span, message).help(help))
}

/// The speed along which nothing resists at one state, if there is one.
pub fn without_inertia(m: &Mechanism, views: &Views<'_>, at: &Evaluation) -> Option<SpeedId> {
    numeric::singular_column(&at.mass_matrix, &noise(m, views)?).map(SpeedId)
}

/// What rounding can make of each diagonal entry of the mass matrix where it should be 0: by what moves at
/// all with that speed, whatever its units and however little that is.
fn noise(m: &Mechanism, views: &Views<'_>) -> Option<Vec<f64>> {
    let values = &views.now;
    let mut noise = vec![0.0_f64; views.units.len()];
    let mut masses = 0.0_f64;
    for body in &m.bodies {
        masses = masses.max(values.scalar(&body.mass, Level::Motion).ok()?.re.abs());
        let (Some(frame), Some(inertia)) = (body.frame, numeric::central_inertia(values, body).ok()?) else {
            continue;
        };
        let size = inertia.iter().flatten().fold(0.0_f64, |size, c| size.max(c.abs()));
        let turning = views.partials(|values| values.angular_velocity(frame)).ok()?;
        noise.iter_mut().zip(turning).for_each(|(noise, w)| *noise += ROUNDING * size * dot3(w, w));
    }
    let mut fastest = vec![0.0_f64; noise.len()];
    for i in 0..m.points.len() {
        let moving = views.partials(|values| values.velocity(PointId(i))).ok()?;
        fastest.iter_mut().zip(moving).for_each(|(fastest, v)| *fastest = fastest.max(dot3(v, v)));
    }
    noise.iter_mut().zip(fastest).for_each(|(noise, v)| *noise += ROUNDING * ROUNDING * masses * v);
    Some(noise)
}
