//! The collision integrated with the crate `ode_solvers`, as one would write it with a general integrator.
//!
//! (55) over tau, dI_n = s dtau, where it has no singular point; the end of each phase lies between two
//! steps, and is found by integrating to it again; once slip is below the tolerance, the rest is (57)-(62).

use hodograph::{Characteristics, Law, ReducedMatrix, Surface};
use nalgebra::Vector3;
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dopri5, SVector, System};

use crate::Outcome;

/// v_t, v_s, v_n, I_n, I_t, I_s, normal work.
type State = SVector<f64, 7>;

const V_N: usize = 2;
const I_N: usize = 3;
const WORK: usize = 6;

/// Longest stretch of tau, in units of the time in which friction stops slip.
const FAR: f64 = 1e4;

#[derive(Clone, Copy)]
struct Equations {
    matrix: ReducedMatrix<f64>,
    mu: f64,
    /// Slip that counts as none.
    rest: f64,
    stop: Stop,
}

/// Where a stretch ends: v_n rises or falls through zero, or the law's quantity reaches its target.
#[derive(Clone, Copy)]
enum Stop {
    Never,
    Compressed,
    Law(usize, f64),
}

impl Stop {
    /// What passes through zero, upwards.
    fn height(self, y: &State) -> f64 {
        match self {
            Self::Never => -1.0,
            Self::Compressed => y[V_N],
            Self::Law(index, target) => y[index] - target,
        }
    }
}

impl System<f64, State> for Equations {
    fn system(&self, _: f64, y: &State, dy: &mut State) {
        let ReducedMatrix { nn, nt, ns, tt, ts, ss } = self.matrix;
        let (t, s) = (y[0], y[1]);
        let slip = t.hypot(s);
        let mu = self.mu;
        dy[0] = nt * slip - mu * (tt * t + ts * s);
        dy[1] = ns * slip - mu * (ts * t + ss * s);
        dy[2] = nn * slip - mu * (nt * t + ns * s);
        dy[3] = slip;
        dy[4] = -mu * t;
        dy[5] = -mu * s;
        dy[6] = slip * y[V_N];
    }

    fn solout(&mut self, _: f64, y: &State, _: &State) -> bool {
        let falls = matches!(self.stop, Stop::Law(..)) && y[V_N] < 0.0;
        y[0].hypot(y[1]) <= self.rest || self.stop.height(y) >= 0.0 || falls
    }
}

/// Integrates a stretch; nothing where the integrator gives up.
fn run(equations: Equations, from: State, length: f64, tolerance: f64) -> Option<(State, f64, State)> {
    // Slip that counts as none must not be lost in the noise.
    let absolute = if equations.rest > 0.0 { 0.1 * equations.rest } else { 0.1 * tolerance };
    let mut stepper = Dopri5::new(equations, 0.0, length, length, from, tolerance, absolute);
    // Every step, and nothing between.
    stepper.set_output(OutputType::Sparse);
    stepper.integrate().ok()?;
    let (x, y) = (stepper.x_out(), stepper.y_out());
    let last = y.len().checked_sub(1)?;
    let before = last.saturating_sub(1);
    Some((*y.get(before)?, x.get(last)? - x.get(before)?, *y.get(last)?))
}

/// The outcome; nothing where there is none, or the integrator gives up.
pub fn solve(
    m: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    surface: &Surface<f64>,
    tolerance: f64,
) -> Option<Outcome> {
    let Surface { mu, e, law } = *surface;
    let index = match law {
        Law::Newton => V_N,
        Law::Poisson => I_N,
        Law::Stronge => WORK,
        _ => return None,
    };
    let mut y = State::from_column_slice(&[v.y, v.z, v.x, 0.0, 0.0, 0.0, 0.0]);
    let slip = v.y.hypot(v.z);
    let mut equations = Equations { matrix: *m, mu, rest: tolerance * slip, stop: Stop::Compressed };
    let far = FAR / (m.nt.abs() + m.ns.abs() + mu * (m.tt + m.ss) + m.nn);
    let (mut target, mut least) = (f64::NAN, 0.0_f64);
    let mut compressed = |y: &State| {
        least = least.min(y[WORK]);
        target = match law {
            Law::Newton => -e * v.x,
            Law::Poisson => (1.0 + e) * y[I_N],
            Law::Stronge => (1.0 - e * e) * least,
            _ => f64::NAN,
        };
        target
    };
    for _ in 0..16 {
        if y[0].hypot(y[1]) <= equations.rest {
            break;
        }
        let (before, step, after) = run(equations, y, far, tolerance)?;
        if equations.stop.height(&after) < 0.0 {
            // Slip stopped, or the bodies approach again.
            y = after;
            equations.stop = if y[V_N] < 0.0 { Stop::Compressed } else { equations.stop };
            continue;
        }
        // Newton's method for the length of the last step.
        let (mut low, mut high, mut length, mut there) = (0.0, step, step, after);
        for _ in 0..12 {
            let height = equations.stop.height(&there);
            let mut rates = State::zeros();
            equations.system(0.0, &there, &mut rates);
            let rate = rates[match equations.stop {
                Stop::Law(index, _) => index,
                _ => V_N,
            }];
            if height >= 0.0 {
                high = length
            } else {
                low = length
            }
            let next = length - height / rate;
            if (next - length).abs() <= 1e-3 * tolerance * step {
                break;
            }
            length = if next > low && next < high { next } else { 0.5 * (low + high) };
            (_, _, there) =
                run(Equations { stop: Stop::Never, rest: 0.0, ..equations }, before, length, tolerance)?;
        }
        y = there;
        if let Stop::Law(..) = equations.stop {
            return Some(outcome(v, &y));
        }
        y[V_N] = 0.0;
        let target = compressed(&y);
        if e == 0.0 {
            return Some(outcome(v, &y));
        }
        equations.stop = Stop::Law(index, target);
    }
    // (57)-(62)
    let contact = Characteristics::of(m, mu);
    (y[0], y[1]) = (0.0, 0.0);
    let (rate, push, gain) = match (contact.renewal, contact.sticking) {
        (Some(renewal), _) => {
            let (sin, cos) = renewal.phi_hat.sin_cos();
            (renewal.f_hat, [mu * cos, mu * sin], [renewal.g_hat * cos, renewal.g_hat * sin])
        }
        (None, Some([n, t, s])) => (1.0 / n, [-t / n, -s / n], [0.0; 2]),
        (None, None) => return None,
    };
    let advance = |y: &mut State, i: f64| {
        y[WORK] += (y[V_N] + 0.5 * rate * i) * i;
        y[V_N] += rate * i;
        y[I_N] += i;
        (y[0], y[1]) = (y[0] + gain[0] * i, y[1] + gain[1] * i);
        (y[4], y[5]) = (y[4] - push[0] * i, y[5] - push[1] * i);
    };
    let mut target = match equations.stop {
        Stop::Law(_, target) => target,
        _ => f64::NAN,
    };
    if y[V_N] < 0.0 || target.is_nan() {
        let i = -y[V_N] / rate;
        advance(&mut y, i);
        target = compressed(&y);
    }
    let i = match law {
        Law::Newton => (target - y[V_N]) / rate,
        Law::Poisson => target - y[I_N],
        Law::Stronge => {
            let missing = target - y[WORK];
            2.0 * missing / (y[V_N] + (y[V_N] * y[V_N] + 2.0 * rate * missing).max(0.0).sqrt())
        }
        _ => return None,
    };
    if i > 0.0 {
        advance(&mut y, i);
    }
    Some(outcome(v, &y))
}

fn outcome(v: &Vector3<f64>, y: &State) -> Outcome {
    let (impulse, velocity) = (Vector3::new(y[I_N], y[4], y[5]), Vector3::new(y[V_N], y[0], y[1]));
    Outcome { impulse, velocity, contact_work: 0.5 * impulse.dot(&(velocity + v)), normal_work: y[WORK] }
}
