//! Numerical integration of (55) with variable step (sections 3 and 4 of the paper).

use nalgebra::Vector3;

use super::{
    MethodError, Solution,
    equations::{I_N, I_S, I_T, NORMAL_WORK, PHI, Problem, S, State, Terminal, V_N, WORK},
    law::{Ending, Event},
    runge_kutta::step,
};
use crate::{Path, ReducedMatrix, Surface};

/// When lambda of (55) leaves zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Switch {
    /// Where slip stops. Below the threshold the equations (34) are integrated over the variable tau, dI_n =
    /// s dtau, in which they have no singular point, so the threshold has no effect on the result.
    AtRest,
    /// Where slip falls below the threshold, as the paper says (section 4, step 2): what slip is left is
    /// dropped, and the result is off in proportion to it.
    AtThreshold,
}

/// How (55) is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integration {
    /// Error allowed per step, relative to the approach (in its own units of velocity, impulse and work);
    /// 1e-14 to 0.1.
    pub tolerance: f64,
    /// The paper's eps_s, as a part of the slip at the start; above 0, below 1. With [`Switch::AtThreshold`]
    /// it may be greater: then all slip is dropped at the start.
    pub slip_threshold: f64,
    /// What happens at the threshold.
    pub switch: Switch,
    /// Steps after which the method gives up, rejected ones included.
    pub steps: u32,
}

impl Default for Integration {
    fn default() -> Self {
        Self { tolerance: 1e-10, slip_threshold: 0.01, switch: Switch::AtRest, steps: 100_000 }
    }
}

impl Integration {
    /// With a tolerance, else the defaults.
    pub fn with_tolerance(tolerance: f64) -> Self {
        Self { tolerance, ..Self::default() }
    }

    fn check(&self) -> Result<(), MethodError> {
        if !(1e-14..=0.1).contains(&self.tolerance) {
            return Err(MethodError::BadOption { name: "tolerance", value: self.tolerance });
        }
        let drops = self.switch == Switch::AtThreshold;
        if !(self.slip_threshold > 0.0 && (drops || self.slip_threshold < 1.0)) {
            return Err(MethodError::BadOption { name: "slip_threshold", value: self.slip_threshold });
        }
        Ok(())
    }

    /// How far v_n may be from zero where slip and normal velocity stop together.
    pub(super) fn slack(&self) -> f64 {
        1e3 * self.tolerance
    }
}

/// Integrates (55) until the law ends the collision (section 4): sliding (34) with lambda = 0, then sticking
/// (45) with lambda = -1 or renewal (46) with lambda = 1, by Dormand and Prince's method of order 5(4); the
/// ends of compression and of restitution are located to the tolerance.
///
/// The works are the integrals (35a) and (35b), independent of (23).
///
/// # Errors
/// As [`crate::solve`], else [`MethodError::Unfinished`] or [`MethodError::BadOption`].
pub fn integrate(
    matrix: &ReducedMatrix<f64>,
    approach: &Vector3<f64>,
    surface: &Surface<f64>,
    options: &Integration,
) -> Result<Solution, MethodError> {
    let problem = Problem::new(matrix, approach, surface)?;
    let mut ending = Ending::new(surface);
    let mut walk = Walk { problem: &problem, options, made: 0 };
    let at = match slide(&mut walk, &mut ending)? {
        Slid::Ended(end) => {
            return Ok(problem.outcome(approach, (&end, Path::Sliding), &ending, walk.made));
        }
        Slid::Stopped(at) => ending.slip_stopped(&problem, at),
    };
    let arc = problem.terminal();
    let mut at = arc.entered(at);
    ending.settle(&arc, &mut at, options.slack());
    // Whether an arc without limit ends is decided by formula, not by integration.
    let end = if arc.v_n > 0.0 {
        walk.run(Branch::Terminal(&arc), at, 1.0 / arc.v_n, &mut ending, |_, _| Next::Stay)?.0
    } else {
        ending.close(&problem, &arc, at, options.slack())?
    };
    let path = arc.path(problem.start()[S] > 0.0);
    Ok(problem.outcome(approach, (&end, path), &ending, walk.made))
}

/// How sliding ended.
pub(super) enum Slid {
    /// The law ended the collision.
    Ended(State),
    /// Slip stopped.
    Stopped(State),
}

/// Integrates the sliding part.
pub(super) fn slide(walk: &mut Walk<'_>, ending: &mut Ending) -> Result<Slid, MethodError> {
    walk.options.check()?;
    let problem = walk.problem;
    let mut at = problem.start();
    let start = at[S];
    if start <= 0.0 {
        return Ok(Slid::Stopped(at));
    }
    let threshold = walk.options.slip_threshold * start;
    if start < threshold && walk.options.switch == Switch::AtThreshold {
        return Ok(Slid::Stopped(at));
    }
    let rest = walk.options.tolerance / problem.pace();
    let mut first = 0.01 * (1.0 / problem.pace()).min(start / problem.turn().max(f64::MIN_POSITIVE));
    let mut branch = Branch::Impulse;
    loop {
        let (state, end) = walk.run(branch, at, first, ending, |branch, y| match branch {
            Branch::Impulse if y[S] < threshold => Next::Leave,
            Branch::Regular if y[S] > 2.0 * threshold => Next::Leave,
            Branch::Regular => {
                let (sin, cos) = y[PHI].sin_cos();
                let [_, g, _] = problem.fgh(cos, sin);
                if g < 0.0 && y[S] <= -g * rest { Next::Leave } else { Next::Stay }
            }
            _ => Next::Stay,
        })?;
        let Some(size) = end else { return Ok(Slid::Ended(state)) };
        at = state;
        match branch {
            Branch::Impulse if walk.options.switch == Switch::AtThreshold => return Ok(Slid::Stopped(at)),
            Branch::Impulse => (branch, first) = (Branch::Regular, size / at[S]),
            _ if at[S] > threshold => (branch, first) = (Branch::Impulse, size * at[S]),
            _ => {
                // What is left of slip goes straight to zero.
                let (sin, cos) = at[PHI].sin_cos();
                let [f, g, _] = problem.fgh(cos, sin);
                let arc = Terminal {
                    sticks: false,
                    phi: at[PHI],
                    impulse: -problem.mu * nalgebra::Vector2::new(cos, sin),
                    v_n: f,
                    s: g,
                };
                let left = -at[S] / g;
                return Ok(Slid::Stopped(arc.after(problem.mu, &at, left)));
            }
        }
    }
}

/// The equations that are integrated: lambda of (55), and the independent variable.
#[derive(Clone, Copy)]
enum Branch<'a> {
    /// (34) over I_n: lambda = 0.
    Impulse,
    /// (34) over tau, dI_n = s dtau: lambda = 0.
    Regular,
    /// (45), lambda = -1, or (46), lambda = 1.
    Terminal(&'a Terminal),
}

/// What to do after a step.
enum Next {
    Stay,
    Leave,
}

/// An integration under way.
pub(super) struct Walk<'a> {
    pub problem: &'a Problem,
    pub options: &'a Integration,
    pub made: u32,
}

/// The right-hand sides of (55) and (35).
fn rates_of(problem: &Problem, branch: Branch<'_>, y: &State) -> State {
    if let Branch::Terminal(arc) = branch {
        let work = y[V_N] - problem.mu * y[S];
        return [0.0, arc.s, arc.v_n, arc.impulse.x, arc.impulse.y, work, y[V_N], 1.0];
    }
    let (sin, cos) = y[PHI].sin_cos();
    let [f, g, h] = problem.fgh(cos, sin);
    let (mu, s, v) = (problem.mu, y[S], y[V_N]);
    let rates = [0.0, g, f, -mu * cos, -mu * sin, v - mu * s, v, 1.0];
    if let Branch::Regular = branch {
        let mut rates = rates.map(|rate| rate * s);
        rates[PHI] = h;
        return rates;
    }
    if s <= 0.0 {
        // Beyond the singular point: the step is refused.
        return [f64::NAN; 8];
    }
    let mut rates = rates;
    rates[PHI] = h / s;
    rates
}

impl Walk<'_> {
    /// The largest error of a step, as a part of what is allowed.
    fn error(&self, from: &State, to: &State, error: &State) -> f64 {
        let unit = 1.0 / self.problem.pace();
        let of = |i: usize, least: f64| error[i].abs() / from[i].abs().max(to[i].abs()).max(least);
        let slip = 1e-3 * self.problem.start()[S];
        let friction = self.problem.mu.max(1.0) * unit;
        let work = unit * (1.0 + self.problem.mu * self.problem.start()[S]);
        let parts = [
            error[PHI].abs(),
            if error[S] == 0.0 { 0.0 } else { of(S, slip) },
            of(V_N, 1.0),
            of(I_T, friction),
            of(I_S, friction),
            of(WORK, work),
            of(NORMAL_WORK, unit),
            of(I_N, unit),
        ];
        // Not `max`: it would lose what is not a number.
        parts.iter().fold(0.0, |top, &x| if x <= top { top } else { x }) / self.options.tolerance
    }

    /// Integrates until the law ends the collision (no step size is returned) or `next` says to leave (the
    /// next step size is).
    fn run(
        &mut self,
        branch: Branch<'_>,
        mut at: State,
        mut h: f64,
        ending: &mut Ending,
        next: impl Fn(Branch<'_>, &State) -> Next,
    ) -> Result<(State, Option<f64>), MethodError> {
        let problem = self.problem;
        let rates = |y: &State| rates_of(problem, branch, y);
        let mut first = rates(&at);
        loop {
            if self.made >= self.options.steps || at[I_N] > 1e15 {
                let normal_velocity = self.problem.velocity(at[V_N]);
                return Err(MethodError::Unfinished { steps: self.made, normal_velocity });
            }
            self.made += 1;
            let tried = step(rates, &at, &first, h);
            let error = self.error(&at, &tried.state, &tried.error);
            if error > 1.0 || error.is_nan() {
                h *= if error.is_finite() { (0.9 * error.powf(-0.2)).max(0.1) } else { 0.1 };
                continue;
            }
            let size = h * if error > 0.0 { (0.9 * error.powf(-0.2)).clamp(0.2, 5.0) } else { 5.0 };
            let leaves = matches!(next(branch, &tried.state), Next::Leave);
            if let Some(event) = ending.between(&tried.state) {
                let locate = |event, width| {
                    locate(
                        |x| step(rates, &at, &first, x).state,
                        (&at, width),
                        |y| ending.height(event, y),
                        |y| ending.slope(event, &rates(y)),
                        1e-3 * self.options.tolerance,
                    )
                };
                let (mut event, (mut width, mut found)) = (event, locate(event, h));
                if event == Event::Approach && ending.is_over(&found) {
                    event = Event::End;
                    (width, found) = locate(event, width);
                }
                let over = ending.note(event, &mut found);
                at = found;
                if over {
                    return Ok((at, None));
                }
                first = rates(&at);
                // The rest of the step, known to be good.
                h = (h - width).max(1e-3 * h);
                continue;
            }
            (at, first, h) = (tried.state, tried.rates, size);
            if leaves {
                return Ok((at, Some(size)));
            }
        }
    }
}

/// The point in (0, width] where a height rises through zero, and the state there: Newton's method inside a
/// bracket.
fn locate(
    state: impl Fn(f64) -> State,
    (from, width): (&State, f64),
    height: impl Fn(&State) -> f64,
    slope: impl Fn(&State) -> f64,
    tolerance: f64,
) -> (f64, State) {
    let (mut low, mut high) = (0.0, width);
    let mut x = (-height(from) / slope(from)).clamp(0.0, width);
    if !(x > 0.0 && x < width) {
        x = width / 2.0;
    }
    let mut found = state(x);
    for _ in 0..100 {
        let y = height(&found);
        if y < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let correction = -y / slope(&found);
        let newton = x + correction;
        if correction.abs() <= tolerance * width || high - low <= f64::EPSILON * high {
            break;
        }
        x = if newton > low && newton < high { newton } else { (low + high) / 2.0 };
        found = state(x);
    }
    (x, found)
}
