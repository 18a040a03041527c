//! The differential equations of a collision, (31)-(35), (45) and (46), in units where m_nn = 1 and v_n1 =
//! -1, for the paper's methods.

use hodograph_arithmetic::elementary::double::hypot;
use nalgebra::{Vector2, Vector3};

use super::MethodError;
use crate::{Path, ReducedMatrix, Surface};

/// Indices of a [`State`].
pub(super) const PHI: usize = 0;
pub(super) const S: usize = 1;
pub(super) const V_N: usize = 2;
pub(super) const I_T: usize = 3;
pub(super) const I_S: usize = 4;
pub(super) const WORK: usize = 5;
pub(super) const NORMAL_WORK: usize = 6;
pub(super) const I_N: usize = 7;

/// phi, s, v_n, I_t, I_s, Delta E (35a), Delta E_n (35b), I_n.
pub(super) type State = [f64; 8];

/// `from + part (to - from)`.
pub(super) fn between(from: &State, to: &State, part: f64) -> State {
    core::array::from_fn(|i| from[i] + part * (to[i] - from[i]))
}

/// One collision, scaled.
#[derive(Clone, Copy)]
pub(super) struct Problem {
    /// (m_nt, m_ns) / m_nn.
    b: Vector2<f64>,
    tt: f64,
    ts: f64,
    ss: f64,
    pub mu: f64,
    /// m_nn in 1/kg and -v_n1 in m/s: the units.
    pub nn: f64,
    pub speed: f64,
    /// Slip and its direction at the start.
    pub slip: f64,
    phi: f64,
}

/// The length of a vector; scaled where a square may overflow or lose digits.
#[inline]
pub(super) fn length(x: f64, y: f64) -> f64 {
    let length = (x * x + y * y).sqrt();
    if length > 1e-140 && length < 1e150 { length } else { hypot(x, y) }
}

impl Problem {
    /// Checks the input as the exact solver does, and scales it.
    pub fn new(
        matrix: &ReducedMatrix<f64>,
        approach: &Vector3<f64>,
        surface: &Surface<f64>,
    ) -> Result<Self, MethodError> {
        crate::solve::check(matrix, approach, surface)?;
        let speed = -approach.x;
        Ok(Self::scaled(
            matrix,
            surface.mu,
            speed,
            length(approach.y, approach.z) / speed,
            approach.z.atan2(approach.y),
        ))
    }

    /// The equations alone: a contact, a coefficient of friction, slip and direction.
    pub fn scaled(matrix: &ReducedMatrix<f64>, mu: f64, speed: f64, slip: f64, phi: f64) -> Self {
        let nn = matrix.nn;
        Self {
            b: Vector2::new(matrix.nt, matrix.ns) / nn,
            tt: matrix.tt / nn,
            ts: matrix.ts / nn,
            ss: matrix.ss / nn,
            mu,
            nn,
            speed,
            slip,
            phi,
        }
    }

    /// The state at the beginning.
    pub fn start(&self) -> State {
        [self.phi, self.slip, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }

    /// An impulse of the input, in the units of the method.
    pub fn impulse(&self, newton_seconds: f64) -> f64 {
        newton_seconds * self.nn / self.speed
    }

    /// A velocity of the method, in the units of the input.
    pub fn velocity(&self, scaled: f64) -> f64 {
        scaled * self.speed
    }

    /// A bound of the rate of v_n, as a scale.
    pub fn pace(&self) -> f64 {
        1.0 + self.mu * self.b.norm()
    }

    /// A bound of g and h, as a scale.
    pub fn turn(&self) -> f64 {
        self.b.norm() + self.mu * (self.tt + self.ss)
    }

    /// f (31), g (32) and h (33), from the cosine and sine of phi.
    #[inline]
    pub fn fgh(&self, cos: f64, sin: f64) -> [f64; 3] {
        let along = self.b.x * cos + self.b.y * sin;
        let across = self.b.y * cos - self.b.x * sin;
        let g = along - self.mu * (self.tt * cos * cos + self.ss * sin * sin + 2.0 * self.ts * sin * cos);
        let h = across - self.mu * (self.ts * (cos * cos - sin * sin) - (self.tt - self.ss) * sin * cos);
        [1.0 - self.mu * along, g, h]
    }

    /// dg/dphi and dh/dphi.
    pub fn derivatives(&self, cos: f64, sin: f64) -> [f64; 2] {
        let along = self.b.x * cos + self.b.y * sin;
        let across = self.b.y * cos - self.b.x * sin;
        let (double_cos, double_sin) = (cos * cos - sin * sin, 2.0 * sin * cos);
        let difference = self.tt - self.ss;
        [
            across - self.mu * (2.0 * self.ts * double_cos - difference * double_sin),
            -along + self.mu * (2.0 * self.ts * double_sin + difference * double_cos),
        ]
    }

    /// The arc after slip has stopped: sticking (3.2) if mu >= mu_c, else renewal (3.3).
    pub fn terminal(&self) -> Terminal {
        // Eigenvalues and -vectors of T; b in those axes.
        let (half, mean) = ((self.tt - self.ss) / 2.0, (self.tt + self.ss) / 2.0);
        let radius = length(half, self.ts);
        let (sin, cos) = if radius > 0.0 { halved(half / radius, self.ts / radius) } else { (0.0, 1.0) };
        let top = mean + radius;
        // The product of the eigenvalues is the determinant: no cancellation.
        let low = if top > 0.0 { (self.tt * self.ss - self.ts * self.ts) / top } else { 0.0 };
        let values = [top, low.max(0.0)];
        let parts = [self.b.x * cos + self.b.y * sin, self.b.y * cos - self.b.x * sin];
        let back = |x: [f64; 2]| Vector2::new(cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]);
        let tiny = 64.0 * f64::EPSILON * top;
        let inverse = |i: usize| if values[i] > tiny { parts[i] / values[i] } else { 0.0 };
        let hold = [inverse(0), inverse(1)];
        if length(hold[0], hold[1]) <= self.mu {
            let rate = 1.0 - parts[0] * hold[0] - parts[1] * hold[1];
            let rate = if rate <= 64.0 * f64::EPSILON { 0.0 } else { rate };
            return Terminal { sticks: true, phi: 0.0, impulse: -back(hold), v_n: rate, s: 0.0 };
        }
        // (mu T + gamma) d = b with |d| = 1 and gamma = g_hat > 0, by Newton's method on 1 / |d|, which rises
        // to the root.
        let denominators = [self.mu * values[0], self.mu * values[1]];
        let solution = |gamma: f64| {
            let part = |i: usize| if parts[i] == 0.0 { 0.0 } else { parts[i] / (denominators[i] + gamma) };
            [part(0), part(1)]
        };
        let bound = |i: usize| parts[i].abs() - denominators[i];
        let mut gamma = bound(0).max(bound(1)).max(f64::EPSILON * f64::EPSILON * self.b.norm());
        for _ in 0..100 {
            let d = solution(gamma);
            let size = length(d[0], d[1]);
            let slope = d[0] * d[0] / (denominators[0] + gamma) + d[1] * d[1] / (denominators[1] + gamma);
            let step = size * size * (size - 1.0) / slope;
            gamma += step;
            if step.abs() <= 4.0 * f64::EPSILON * gamma {
                break;
            }
        }
        let d = back(solution(gamma)).normalize();
        let [f, g, _] = self.fgh(d.x, d.y);
        Terminal { sticks: false, phi: d.y.atan2(d.x), impulse: -d * self.mu, v_n: f, s: g }
    }
}

/// Sine and cosine of half the angle in (-pi, pi] whose cosine and sine are given.
fn halved(cos: f64, sin: f64) -> (f64, f64) {
    if cos >= 0.0 {
        let half = ((1.0 + cos) * 0.5).sqrt();
        (0.5 * sin / half, half)
    } else {
        let half = ((1.0 - cos) * 0.5).sqrt().copysign(sin);
        (half, 0.5 * sin / half)
    }
}

/// The terminal arc: every rate with respect to I_n is constant.
#[derive(Clone, Copy)]
pub(super) struct Terminal {
    /// Sticking (45), else renewal (46).
    pub sticks: bool,
    /// phi_hat.
    pub phi: f64,
    /// d(I_t, I_s)/dI_n: (c_t, c_s) / c_n, or -mu (cos, sin) of phi_hat.
    pub impulse: Vector2<f64>,
    /// dv_n/dI_n: 1 / c_n, or f_hat.
    pub v_n: f64,
    /// ds/dI_n: 0, or g_hat.
    pub s: f64,
}

impl Terminal {
    /// The path of a collision that ends on this arc.
    pub fn path(&self, slid: bool) -> Path {
        match (slid, self.sticks) {
            (true, true) => Path::SlidingThenSticking,
            (true, false) => Path::SlidingThenRenewal,
            (false, true) => Path::Sticking,
            (false, false) => Path::Renewal,
        }
    }

    /// The state with which the arc begins: no slip, and the direction it will have.
    pub fn entered(&self, mut from: State) -> State {
        from[PHI] = self.phi;
        from[S] = 0.0;
        from
    }

    /// The state after a further normal impulse: the closed forms (57)-(60), the works with them.
    pub fn after(&self, mu: f64, from: &State, impulse: f64) -> State {
        let mut to = *from;
        to[S] += self.s * impulse;
        to[V_N] += self.v_n * impulse;
        to[I_T] += self.impulse.x * impulse;
        to[I_S] += self.impulse.y * impulse;
        to[I_N] += impulse;
        let normal = (from[V_N] + to[V_N]) / 2.0 * impulse;
        to[NORMAL_WORK] += normal;
        to[WORK] += normal - mu * (from[S] + to[S]) / 2.0 * impulse;
        to
    }
}
