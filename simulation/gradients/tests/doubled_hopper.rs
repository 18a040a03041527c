//! The driven hopper of `models/driven_hopper.mech` in numbers of twice the digits, by its own equations: linear in each mode of
//! contact, so that Taylor series give the motion and Newton's method the events to some 28 digits. Derivatives are
//! differences over 1e-10.

use hodograph_arithmetic::DoubleDouble;

pub type Number = DoubleDouble<f64>;

pub fn number(x: f64) -> Number {
    Number::new(x)
}

fn is_negative(x: Number) -> bool {
    x.is_less(number(0.0))
}

/// A mode of contact of the foot.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Flight,
    /// towards this direction
    Slip(f64),
    Stick,
}

/// Places x, z, s and their rates, sine and cosine of the drive, and one.
type Full = [Number; 9];

/// The parameters of the model, in its order, and mu.
#[derive(Clone, Copy)]
pub struct Hopper {
    pub parameters: [Number; 9],
    pub mu: Number,
}

/// What derivatives are taken by.
#[derive(Clone, Copy, Debug)]
pub enum Variable {
    /// a coordinate or speed at the start
    State(usize),
    /// a parameter, but for the slope
    Parameter(usize),
    Friction,
}

/// Changes by less than this time, s, are no progress: an event that has just happened does not happen again.
const PAUSE: f64 = 1e-12;
/// Longest Taylor step, s, and the number of its terms.
const STEP: f64 = 2e-3;
const TERMS: usize = 30;

impl Hopper {
    fn of(&self, place: usize) -> Number {
        self.parameters[place]
    }

    /// Components of the leg's direction.
    fn leg(&self) -> [Number; 2] {
        let (sine, cosine) = self.parameters[2].rounded().sin_cos();
        [number(sine), number(cosine)]
    }

    /// The accelerations of the foot by forces on it: (1 + d d^T mb / mf) / (mf + mb) times them.
    fn response(&self, [x, z]: [Number; 2]) -> [Number; 2] {
        let ([dx, dz], total) = (self.leg(), self.of(0) + self.of(1));
        let along = (dx * x + dz * z) * self.of(1) / self.of(0);
        [(x + dx * along) / total, (z + dz * along) / total]
    }

    /// Force of the leg, accelerations of the foot without forces at the contact.
    fn free(&self, y: &Full) -> (Number, [Number; 2]) {
        let [mf, mb, l, k, c, g, f] = [0, 1, 3, 4, 5, 6, 7].map(|place| self.of(place));
        let [dx, dz] = self.leg();
        let push = f * y[6] - k * (y[2] - l * y[8]) - c * y[5];
        let net = push - mb * g * dz * y[8];
        (push, self.response([-net * dx, -net * dz - (mf + mb) * g * y[8]]))
    }

    /// Forces at the contact.
    fn forces(&self, mode: Mode, [x, z]: [Number; 2]) -> [Number; 2] {
        let ([xx, xz], [_, zz]) = self.matrix();
        match mode {
            Mode::Flight => [number(0.0); 2],
            Mode::Slip(way) => {
                let rub = self.mu * number(way);
                let normal = -z / (zz - rub * xz);
                [-rub * normal, normal]
            }
            Mode::Stick => {
                let det = xx * zz - xz * xz;
                [(xz * z - zz * x) / det, (xz * x - xx * z) / det]
            }
        }
    }

    /// The reduced matrix of the contact.
    fn matrix(&self) -> ([Number; 2], [Number; 2]) {
        let (one, zero) = (number(1.0), number(0.0));
        (self.response([one, zero]), self.response([zero, one]))
    }

    fn rates(&self, mode: Mode, y: &Full) -> Full {
        let (push, free) = self.free(y);
        let forces = self.response(self.forces(mode, free));
        let [x, z] = [free[0] + forces[0], free[1] + forces[1]];
        let [dx, dz] = self.leg();
        let along = push / self.of(1) - self.of(6) * dz * y[8] - dx * x - dz * z;
        let w = self.of(8);
        [y[3], y[4], y[5], x, z, along, w * y[7], -w * y[6], number(0.0)]
    }

    /// The state after a time, by the Taylor series.
    fn after(&self, mode: Mode, y: &Full, time: Number) -> Full {
        let (mut sum, mut term) = (*y, *y);
        for order in 1..=TERMS {
            let scale = time / number(order as f64);
            term = self.rates(mode, &term).map(|rate| rate * scale);
            (0..9).for_each(|place| sum[place] = sum[place] + term[place]);
        }
        sum
    }

    /// Quantities whose fall through zero ends a mode.
    fn guards(&self, mode: Mode, y: &Full) -> Vec<Number> {
        let [x, normal] = self.forces(mode, self.free(y).1);
        match mode {
            Mode::Flight => vec![y[1]],
            Mode::Slip(way) => vec![normal, number(way) * y[3]],
            Mode::Stick => vec![normal, self.mu * normal - x, self.mu * normal + x],
        }
    }

    /// The mode after an event, of a foot on the floor that does not move away from it.
    fn resting(&self, y: &Full) -> Mode {
        let free = self.free(y).1;
        let slip = y[3].rounded();
        let mode = if slip.abs() > 1e-20 {
            Mode::Slip(slip.signum())
        } else {
            let [x, normal] = self.forces(Mode::Stick, free);
            if x.rounded().abs() <= (self.mu * normal).rounded() * (1.0 + 1e-20) && normal.rounded() > 0.0 {
                Mode::Stick
            } else {
                Mode::Slip(-x.rounded().signum())
            }
        };
        if is_negative(self.forces(mode, free)[1]) { Mode::Flight } else { mode }
    }

    /// An impact with e = 0, and Coulomb's law for a foot that may come to rest.
    fn impact(&self, y: &mut Full) {
        let ([xx, xz], [_, zz]) = self.matrix();
        let way = number(y[3].rounded().signum());
        let (along, up) = (xz - self.mu * way * xx, zz - self.mu * way * xz);
        let (to_end, to_stop) = (-y[4] / up, -y[3] / along);
        let stops = !is_negative(to_stop) && to_stop.is_less(to_end);
        let first = if stops { to_stop } else { to_end };
        let mut impulse = [-self.mu * way * first, first];
        let mut rests = false;
        if stops {
            // Friction holds the foot, or lets it slip the way it is pushed.
            let held = -xz / xx;
            rests = held.rounded().abs() <= self.mu.rounded();
            let rub = if rests { held } else { -self.mu * number(xz.rounded().signum()) };
            let rest = -(y[4] + up * first) / (zz + rub * xz);
            impulse = [impulse[0] + rub * rest, impulse[1] + rest];
        }
        let change = self.response(impulse);
        let [dx, dz] = self.leg();
        y[3] = if rests { number(0.0) } else { y[3] + change[0] };
        y[4] = number(0.0);
        y[5] = y[5] - dx * change[0] - dz * change[1];
    }

    /// The state at a time after the start at t = 0, and the times of the events.
    pub fn motion(&self, state: &[Number; 6], until: Number) -> ([Number; 6], Vec<(Number, &'static str)>) {
        let [x, z, s, ux, uz, us] = *state;
        let mut y: Full = [x, z, s, ux, uz, us, number(0.0), number(1.0), number(1.0)];
        let mut mode = if z.rounded() > 0.0 || uz.rounded() > 0.0 { Mode::Flight } else { self.resting(&y) };
        let (mut time, mut events) = (number(0.0), Vec::new());
        while time.is_less(until) {
            let left = until - time;
            let step = if left.is_less(number(STEP)) { left } else { number(STEP) };
            let next = self.after(mode, &y, step);
            // The first guard that falls through zero.
            let mut first: Option<(Number, usize)> = None;
            for (place, guard) in self.guards(mode, &next).into_iter().enumerate() {
                if !is_negative(guard) {
                    continue;
                }
                let mut at = step;
                for _ in 0..40 {
                    // Guards are linear in the state: their rates are those of the rates.
                    let there = self.after(mode, &y, at);
                    let rates = self.rates(mode, &there);
                    let change = self.guards(mode, &there)[place] / self.guards(mode, &rates)[place];
                    at = at - change;
                    if change.rounded().abs() < 1e-30 {
                        break;
                    }
                }
                if at.rounded() > PAUSE && first.is_none_or(|(before, _)| at.is_less(before)) {
                    first = Some((at, place));
                }
            }
            let Some((at, place)) = first else {
                (y, time) = (next, time + step);
                continue;
            };
            (y, time) = (self.after(mode, &y, at), time + at);
            let (name, then) = match (mode, place) {
                (Mode::Flight, _) => {
                    self.impact(&mut y);
                    y[1] = number(0.0);
                    ("collision", self.resting(&y))
                }
                (_, 0) => ("lift_off", Mode::Flight),
                (Mode::Slip(_), _) => {
                    y[3] = number(0.0);
                    let then = self.resting(&y);
                    (if then == Mode::Stick { "stick" } else { "slip" }, then)
                }
                (Mode::Stick, 1) => ("slip", Mode::Slip(-1.0)),
                (Mode::Stick, _) => ("slip", Mode::Slip(1.0)),
            };
            mode = then;
            events.push((time, name));
        }
        let [x, z, s, ux, uz, us, ..] = y;
        ([x, z, s, ux, uz, us], events)
    }

    /// Derivatives of the state at a time, and of the times of the events up to there: a column for each variable.
    pub fn derivatives(
        &self,
        state: &[Number; 6],
        until: Number,
        by: &[Variable],
    ) -> Vec<(Vec<f64>, Vec<f64>)> {
        let h = number(1e-10);
        let moved = |variable: Variable, h: Number| {
            let (mut hopper, mut state) = (*self, *state);
            let place = match variable {
                Variable::State(place) => &mut state[place],
                Variable::Parameter(place) => &mut hopper.parameters[place],
                Variable::Friction => &mut hopper.mu,
            };
            *place = *place + h;
            hopper.motion(&state, until)
        };
        let difference = |&variable: &Variable| {
            let ((ahead, later), (behind, sooner)) = (moved(variable, h), moved(variable, -h));
            let slope = |a: Number, b: Number| ((a - b) / (h + h)).rounded();
            assert_eq!(later.len(), sooner.len(), "differences see the same events");
            let states = ahead.iter().zip(&behind).map(|(a, b)| slope(*a, *b)).collect();
            (states, later.iter().zip(&sooner).map(|((a, _), (b, _))| slope(*a, *b)).collect())
        };
        by.iter().map(difference).collect()
    }
}
