//! An independent solution of every collision, to some 25 digits: Taylor's method for the sliding equations
//! (34) in Cartesian components, with numbers of 32 digits.
//!
//! With dI_n = s dtau the equations are v_tan' = s b - mu T v_tan, v_n' = m_nn s - mu b.v_tan, I_tan' = -mu
//! v_tan, I_n' = s, W' = s v_n, and s follows from s^2 = v_tan^2. It shares no equation in phi, no chart and
//! no series with the solver. It takes its input as exact: a matrix counts as singular only if its
//! determinant is zero to 28 digits.

use hodograph::{Impact, Law, ReducedMatrix, Surface};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::double_double::{Double, EPSILON};

/// Terms of a step.
const ORDER: usize = 30;
/// Steps of an arc; more are needed only close to mu_c.
const STEPS: usize = 4000;

/// An outcome, rounded.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    pub impulse: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub contact_work: f64,
    pub normal_work: f64,
    pub compressions: u32,
    /// Slip stopped before the end.
    pub stopped: bool,
    /// How near v_n came to turning where that would change the outcome by a jump, over the speed of
    /// approach.
    pub margin: f64,
}

impl Outcome {
    /// The largest error: of the impulse over its largest component, of the velocity over approach plus
    /// separation, of the works over impulse times velocity.
    pub fn error(&self, hit: &Impact<f64>, approach: &Vector3<f64>) -> f64 {
        let (impulse, velocity) = (self.impulse.amax(), self.velocity.amax() + approach.amax());
        ((hit.impulse - self.impulse).amax() / impulse)
            .max((hit.velocity - self.velocity).amax() / velocity)
            .max((hit.contact_work - self.contact_work).abs() / (impulse * velocity))
            .max((hit.normal_work - self.normal_work).abs() / (impulse * velocity))
    }
}

/// The condition number of a matrix, without the eigenvalues that are zero to rounding.
pub fn condition(m: &ReducedMatrix<f64>) -> f64 {
    let values = SymmetricEigen::new(Matrix3::from(*m)).eigenvalues;
    let greatest = values.amax();
    let least = values.iter().filter(|x| **x > 1e-13 * greatest).fold(f64::INFINITY, |a, b| a.min(*b));
    greatest / least
}

/// Why there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    Wedged,
    /// Too many steps: nothing is known.
    Unfinished,
}

/// v_t, v_s, v_n, I_n, I_t, I_s, W.
type State = [Double; 7];
const VN: usize = 2;
const IN: usize = 3;
const W: usize = 6;

struct Problem {
    nn: Double,
    b: [Double; 2],
    t: [Double; 3],
    mu: Double,
    law: Law,
    e: Double,
    speed: Double,
}

/// The law, and what it has seen: compression ends at each upward zero of v_n, and none ends the collision
/// while v_n < 0.
struct Watch {
    compressions: u32,
    target: Option<Double>,
    least: Double,
    margin: f64,
}

enum Next {
    On(State),
    Over(State),
}

impl Problem {
    fn pull(&self, x: [Double; 2]) -> [Double; 2] {
        let [tt, ts, ss] = self.t;
        [tt * x[0] + ts * x[1], ts * x[0] + ss * x[1]]
    }

    fn watched(&self, y: &State) -> Double {
        match self.law {
            Law::Newton => y[VN],
            Law::Poisson => y[IN],
            Law::Stronge => y[W],
            other => panic!("no second road for {other:?}"),
        }
    }

    /// Takes note of an upward zero of v_n.
    fn compressed(&self, watch: &mut Watch, y: &State) {
        watch.compressions += 1;
        if y[W] < watch.least {
            watch.least = y[W];
        }
        let one = Double::from(1.0);
        watch.target = Some(match self.law {
            Law::Newton => self.e * self.speed,
            Law::Poisson => (one + self.e) * y[IN],
            Law::Stronge => (one - self.e * self.e) * watch.least,
            other => panic!("no second road for {other:?}"),
        });
    }

    /// Coefficients of the solution in tau about a state with slip.
    fn taylor(&self, y: &State) -> Vec<State> {
        let slip = (y[0] * y[0] + y[1] * y[1]).sqrt();
        let mut c = vec![*y];
        let mut s = vec![slip];
        for k in 0..ORDER {
            let now = c[k];
            let pull = self.pull([now[0], now[1]]);
            let rub = self.b[0] * now[0] + self.b[1] * now[1];
            let work = (0..=k).fold(Double::ZERO, |sum, i| sum + s[i] * c[k - i][VN]);
            let rates = [
                s[k] * self.b[0] - self.mu * pull[0],
                s[k] * self.b[1] - self.mu * pull[1],
                s[k] * self.nn - self.mu * rub,
                s[k],
                -(self.mu * now[0]),
                -(self.mu * now[1]),
                work,
            ];
            let n = Double::from((k + 1) as f64);
            c.push(rates.map(|rate| rate / n));
            let mut square = Double::ZERO;
            for i in 0..=k + 1 {
                square = square + c[i][0] * c[k + 1 - i][0] + c[i][1] * c[k + 1 - i][1];
                if i > 0 && i <= k {
                    square = square - s[i] * s[k + 1 - i];
                }
            }
            s.push(square / (slip * 2.0));
        }
        c
    }

    /// One step of the sliding arc, with whatever happens on it.
    fn step(&self, y: &State, watch: &mut Watch) -> Next {
        let c = self.taylor(y);
        let size = y[0].hi.hypot(y[1].hi);
        // Slip and its speed, which may be singular where slip is not: I_n' = s.
        let norm = |k: usize| c[k][0].hi.hypot(c[k][1].hi).max(c[k + 1][IN].hi.abs() * (k + 1) as f64);
        let reach = |k: usize| (EPSILON * size / norm(k).max(f64::MIN_POSITIVE)).powf(1.0 / k as f64);
        let h = (ORDER - 3..ORDER).map(reach).fold(1e9 * self.speed.hi / (self.nn.hi * size), f64::min);
        let at = |theta: Double| -> State {
            std::array::from_fn(|i| c.iter().rev().fold(Double::ZERO, |sum, y| sum * theta + y[i]))
        };
        // dv_n / dtau
        let slope = |y: &State| {
            let s = (y[0] * y[0] + y[1] * y[1]).sqrt();
            s * self.nn - self.mu * (self.b[0] * y[0] + self.b[1] * y[1])
        };
        let bisect = |lo: f64, hi: f64, over: &dyn Fn(&State) -> bool| {
            let (mut lo, mut hi) = (Double::from(lo), Double::from(hi));
            for _ in 0..110 {
                let middle = (lo + hi) * 0.5;
                if over(&at(middle)) { hi = middle } else { lo = middle }
            }
            hi
        };
        // Pieces on which v_n is monotone.
        const PARTS: usize = 12;
        let mut ends = vec![0.0];
        let mut falling = slope(y).hi < 0.0;
        for part in 1..=PARTS {
            let (lo, hi) = (h * (part - 1) as f64 / PARTS as f64, h * part as f64 / PARTS as f64);
            let falls = slope(&at(Double::from(hi))).hi < 0.0;
            if falls != falling {
                let turn = bisect(lo, hi, &|y| (slope(y).hi < 0.0) == falls);
                let there = at(turn);
                let target = if self.law == Law::Newton { self.e.hi } else { 0.0 };
                let height = there[VN].hi / self.speed.hi;
                watch.margin = watch.margin.min(height.abs());
                if falls && self.law == Law::Newton {
                    watch.margin = watch.margin.min((height - target).abs());
                }
                ends.push(turn.hi);
                falling = falls;
            }
        }
        ends.push(h);
        for window in ends.windows(2) {
            let (mut lo, hi) = (window[0], window[1]);
            let mut from = at(Double::from(lo));
            let to = at(Double::from(hi));
            if from[VN] < Double::ZERO {
                if to[VN] < Double::ZERO {
                    continue;
                }
                let rest = bisect(lo, hi, &|y| y[VN] >= Double::ZERO);
                from = at(rest);
                self.compressed(watch, &from);
                if self.e <= Double::ZERO {
                    return Next::Over(from);
                }
                lo = rest.hi;
            }
            let Some(target) = watch.target else { continue };
            let over = |y: &State| self.watched(y) >= target;
            let mut last = hi;
            if to[VN] < Double::ZERO {
                let fall = bisect(lo, hi, &|y| y[VN] < Double::ZERO);
                last = fall.hi;
                let top = at(fall);
                if self.law != Law::Newton {
                    let scale = if self.law == Law::Poisson { target.hi } else { watch.least.hi };
                    watch.margin = watch.margin.min(((self.watched(&top) - target).hi / scale).abs());
                }
            }
            if over(&from) {
                if self.law == Law::Newton && from[VN] > target {
                    continue;
                }
                return Next::Over(from);
            }
            if over(&at(Double::from(last))) {
                return Next::Over(at(bisect(lo, last, &over)));
            }
        }
        Next::On(at(Double::from(h)))
    }

    /// A linear arc, until the law ends the collision or for the impulse `length`.
    fn line(
        &self,
        from: &State,
        line: &Line,
        length: Option<Double>,
        watch: &mut Watch,
    ) -> Result<Next, Failure> {
        let rate = line.normal;
        let advance = |y: &State, i: Double| -> State {
            let vn = y[VN] + rate * i;
            [
                y[0] + line.gain[0] * i,
                y[1] + line.gain[1] * i,
                vn,
                y[IN] + i,
                y[4] - line.push[0] * i,
                y[5] - line.push[1] * i,
                y[W] + (y[VN] + vn) * i * 0.5,
            ]
        };
        let on = |y: &State, left: Option<Double>| match left {
            Some(left) => Ok(Next::On(advance(y, left))),
            None => Err(Failure::Wedged),
        };
        let (mut y, mut left) = (*from, length);
        if y[VN] < Double::ZERO {
            let i = -y[VN] / rate;
            // Where slip ends with compression, rounding must not tell which is first.
            if rate <= Double::ZERO || left.is_some_and(|left| (i - left).hi > 1e-26 * i.hi) {
                return on(&y, left);
            }
            y = advance(&y, i);
            y[VN] = Double::ZERO;
            left = left.map(|left| left - i);
            self.compressed(watch, &y);
            if self.e <= Double::ZERO {
                return Ok(Next::Over(y));
            }
        }
        let Some(target) = watch.target else { return on(&y, left) };
        let missing = target - self.watched(&y);
        let end = match self.law {
            _ if missing <= Double::ZERO => Some(Double::ZERO),
            Law::Newton => (rate > Double::ZERO).then(|| missing / rate),
            Law::Poisson => Some(missing),
            Law::Stronge => {
                let square = y[VN] * y[VN] + missing * rate * 2.0;
                let sum = y[VN] + square.sqrt();
                (square >= Double::ZERO && sum > Double::ZERO).then(|| missing * 2.0 / sum)
            }
            other => panic!("no second road for {other:?}"),
        };
        match end {
            Some(i)
                if left.is_none_or(|left| i <= left) && (y[VN] + rate * i).hi >= -1e-28 * self.speed.hi =>
            {
                Ok(Next::Over(advance(&y, i)))
            }
            _ => on(&y, left),
        }
    }

    /// The direction d with (mu T + g) d = b, g > 0, and g: by bisection, |(mu T + g)^-1 b| falls with g.
    fn renewal(&self) -> ([Double; 2], Double) {
        let solve = |g: Double| {
            let [tt, ts, ss] = self.t.map(|x| x * self.mu);
            let (p, q) = (tt + g, ss + g);
            let det = p * q - ts * ts;
            [(q * self.b[0] - ts * self.b[1]) / det, (p * self.b[1] - ts * self.b[0]) / det]
        };
        let size = |x: [Double; 2]| (x[0] * x[0] + x[1] * x[1]).sqrt();
        let (mut lo, mut hi) = (Double::ZERO, size(self.b));
        for _ in 0..400 {
            let middle = (lo + hi) * 0.5;
            if size(solve(middle)) > Double::from(1.0) { lo = middle } else { hi = middle }
        }
        let d = solve(hi);
        let norm = size(d);
        (d.map(|x| x / norm), hi)
    }

    /// The least-norm x with T x = b, and m_nn - b.x.
    fn hold(&self) -> ([Double; 2], Double) {
        let [tt, ts, ss] = self.t;
        let [b1, b2] = self.b;
        let det = tt * ss - ts * ts;
        let trace = tt + ss;
        let x = if det.hi > 1e-28 * tt.hi * ss.hi {
            [(ss * b1 - ts * b2) / det, (tt * b2 - ts * b1) / det]
        } else if trace > Double::ZERO {
            // T = trace u u^T.
            let square = trace * trace;
            [(tt * b1 + ts * b2) / square, (ts * b1 + ss * b2) / square]
        } else {
            [Double::ZERO; 2]
        };
        let rate = self.nn - b1 * x[0] - b2 * x[1];
        (x, if rate.hi <= 1e-24 * self.nn.hi { Double::ZERO } else { rate })
    }

    fn slide(&self, y: &mut State, watch: &mut Watch) -> Result<bool, Failure> {
        let [b1, b2] = self.b;
        let size = b1.abs() + b2.abs() + self.mu * (self.t[0] + self.t[2]);
        let begin = (y[0] * y[0] + y[1] * y[1]).sqrt();
        for _ in 0..STEPS {
            let slip = (y[0] * y[0] + y[1] * y[1]).sqrt();
            let d = [y[0] / slip, y[1] / slip];
            let pull = self.pull(d).map(|x| x * self.mu);
            let rate = [b1 - pull[0], b2 - pull[1]];
            let g = d[0] * rate[0] + d[1] * rate[1];
            let h = d[0] * rate[1] - d[1] * rate[0];
            if h.abs().hi <= 1e-27 * size.hi || (g.hi < 0.0 && slip.hi <= 1e-27 * begin.hi) {
                // The direction stays.
                let stays = g.hi < -1e-26 * size.hi;
                let length = stays.then(|| -slip / g);
                let line = Line {
                    gain: [d[0] * g, d[1] * g],
                    normal: self.nn - self.mu * (b1 * d[0] + b2 * d[1]),
                    push: d.map(|x| x * self.mu),
                };
                return match self.line(y, &line, length, watch)? {
                    Next::Over(end) => {
                        *y = end;
                        Ok(true)
                    }
                    Next::On(end) => {
                        *y = end;
                        Ok(false)
                    }
                };
            }
            match self.step(y, watch) {
                Next::Over(end) => {
                    *y = end;
                    return Ok(true);
                }
                Next::On(end) => *y = end,
            }
        }
        Err(Failure::Unfinished)
    }
}

/// A linear arc, per I_n: tangential velocity, normal velocity, and the opposite of the tangential impulse.
struct Line {
    gain: [Double; 2],
    normal: Double,
    push: [Double; 2],
}

/// The outcome of a collision.
pub fn solve(m: &ReducedMatrix<f64>, v: &Vector3<f64>, surface: &Surface<f64>) -> Result<Outcome, Failure> {
    solve_from(m, v, -v.x, surface)
}

/// The outcome of an impact without collision: v_n1 = 0, and Newton's target with it.
pub fn without_collision(
    m: &ReducedMatrix<f64>,
    slip: [f64; 2],
    surface: &Surface<f64>,
) -> Result<Outcome, Failure> {
    let e = if surface.law == Law::Newton { 0.0 } else { surface.e };
    let speed = slip[0].hypot(slip[1]);
    solve_from(m, &Vector3::new(0.0, slip[0], slip[1]), speed, &Surface { e, ..*surface })
}

/// The same for any unit of speed.
fn solve_from(
    m: &ReducedMatrix<f64>,
    v: &Vector3<f64>,
    speed: f64,
    surface: &Surface<f64>,
) -> Result<Outcome, Failure> {
    let problem = Problem {
        nn: m.nn.into(),
        b: [m.nt.into(), m.ns.into()],
        t: [m.tt.into(), m.ts.into(), m.ss.into()],
        mu: surface.mu.into(),
        law: surface.law,
        e: surface.e.into(),
        speed: speed.into(),
    };
    let mut watch = Watch { compressions: 0, target: None, least: Double::ZERO, margin: 1.0 };
    let zero = Double::ZERO;
    let mut y: State = [v.y.into(), v.z.into(), v.x.into(), zero, zero, zero, zero];
    let slips = v.y != 0.0 || v.z != 0.0;
    let over = slips && problem.slide(&mut y, &mut watch)?;
    if !over {
        let (hold, rate) = problem.hold();
        let mu_c = (hold[0] * hold[0] + hold[1] * hold[1]).sqrt();
        (y[0], y[1]) = (zero, zero);
        if slips && y[VN].hi.abs() <= 1e-26 * problem.speed.hi {
            // Slip and normal velocity stop together.
            y[VN] = zero;
            if watch.compressions == 0 {
                problem.compressed(&mut watch, &y);
            }
        }
        let line = if mu_c <= problem.mu {
            Line { gain: [zero; 2], normal: rate, push: hold }
        } else {
            let (d, g) = problem.renewal();
            let normal = problem.nn - problem.mu * (problem.b[0] * d[0] + problem.b[1] * d[1]);
            Line { gain: d.map(|x| x * g), normal, push: d.map(|x| x * problem.mu) }
        };
        match problem.line(&y, &line, None, &mut watch)? {
            Next::Over(end) | Next::On(end) => y = end,
        }
    }
    let impulse = [y[IN], y[4], y[5]];
    let velocity = [y[VN], y[0], y[1]];
    let mut work = zero;
    for (i, (after, before)) in impulse.iter().zip(velocity.iter().zip([v.x, v.y, v.z])) {
        work = work + *i * (*after + Double::from(before)) * 0.5;
    }
    let plain = |x: [Double; 3]| Vector3::from(x.map(|x| x.hi));
    Ok(Outcome {
        impulse: plain(impulse),
        velocity: plain(velocity),
        contact_work: work.hi,
        normal_work: y[W].hi,
        compressions: watch.compressions,
        stopped: !over && slips,
        margin: watch.margin,
    })
}
