//! The sliding arc of an isotropic contact, m_ts = 0 and m_tt = m_ss, in closed form.
//!
//! With slip (v_1, v_2) along b and across it, P = (s + v_1) / 2 and M = (s - v_1) / 2 obey P' = (beta -
//! kappa) P and M' = -(beta + kappa) M, where dI_n = s dsigma, beta = |b| and kappa = mu m_tt. All quantities
//! on the arc are therefore sums of exponentials of sigma. Eliminating sigma, s sin(psi) is proportional to
//! tan(psi/2)^(kappa/beta), psi being the angle of slip from b.
//!
//! Theory: docs/theory.md, section 11.2.

use nalgebra::{Vector2, Vector3};

use super::{
    Isotropic, Shape,
    course::{Course, Point, decayed, elapsed, follow},
};
use crate::{
    ReducedMatrix, Surface,
    scalar::{Real, constant, length},
    solve::{Contact, Restitution, Slide, State, slide_rarely, straight},
};

#[expect(private_bounds, private_interfaces, reason = "nobody else implements this")]
impl Shape for Isotropic {
    #[inline(always)]
    fn impose<T: Real>(m: &mut ReducedMatrix<T>, _: &mut Vector3<T>, _: &mut Surface<T>) {
        (m.ts, m.ss) = (T::zero(), m.tt);
    }

    #[inline(always)]
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T> {
        if !c.is_ordinary() {
            return slide_rarely(c, from, speed, restitution);
        }
        let d = from / speed;
        let beta = length(&c.b);
        let across = d.x * c.b.y - d.y * c.b.x;
        let noise = constant::<T>(4.0) * T::default_epsilon() * (beta + c.mu * (c.tt + c.ss));
        if across.abs() <= noise {
            return straight(c, d, speed, restitution.start(), restitution);
        }
        let axis = c.b / beta;
        let kappa = c.mu * c.tt;
        let (across, sizes) = split(&axis, &from, speed);
        let arc = Arc {
            mu: c.mu,
            axis,
            begin: restitution.start(),
            across,
            kappa,
            rates: [kappa - beta, kappa + beta],
            sizes,
            gains: [T::one() - c.mu * beta, T::one() + c.mu * beta],
        };
        follow(arc, restitution)
    }
}

/// v_2, and P and M.
#[inline(always)]
fn split<T: Real>(axis: &Vector2<T>, slip: &Vector2<T>, speed: T) -> (T, [T; 2]) {
    let (along, across) = (axis.dot(slip), axis.x * slip.y - axis.y * slip.x);
    // The lesser of P and M from P M = v_2^2 / 4.
    let large = (speed + along.abs()) * constant(0.5);
    let small = across * across * constant(0.25) / large;
    (across, if along > T::zero() { [large, small] } else { [small, large] })
}

/// The arc; xi = (1 - e^(-(kappa - beta) sigma)) / (kappa - beta), in which I_n soon becomes linear.
struct Arc<T: Real> {
    mu: T,
    /// Unit vector along b.
    axis: Vector2<T>,
    begin: State<T>,
    /// v_2 at the start.
    across: T,
    kappa: T,
    /// The rates at which P and M decay.
    rates: [T; 2],
    /// P and M at the start.
    sizes: [T; 2],
    /// dv_n / dI_n along b and against it.
    gains: [T; 2],
}

impl<T: Real> Arc<T> {
    /// The state where the integrals of P, M and v_2 over sigma are `p`, `m` and `across` times their values
    /// at the start, and the normal work since the start. `mixed` is likewise the double integral of
    /// P(sigma) M(sigma') over sigma' < sigma.
    #[inline(always)]
    fn state(&self, [p, m, across]: [T; 3], mixed: T) -> (State<T>, T) {
        let half = constant::<T>(0.5);
        let [a, b] = self.gains;
        let [size_p, size_m] = self.sizes;
        let (p, m) = (size_p * p, size_m * m);
        let normal = p + m;
        let rubbed = self.axis * (p - m) + Vector2::new(-self.axis.y, self.axis.x) * (self.across * across);
        let mixed = size_p * size_m * mixed;
        let State { normal: before, tangential, velocity, work } = self.begin;
        let since = half * (a * p * p + b * m * m) + b * mixed + a * (p * m - mixed) + velocity * normal;
        let state = State {
            normal: before + normal,
            tangential: tangential - rubbed * self.mu,
            velocity: a * p + b * m + velocity,
            work: work + since,
        };
        (state, since)
    }
}

impl<T: Real> Course<T> for Arc<T> {
    #[inline(always)]
    fn start(&self) -> Point<T> {
        let [p, m] = self.sizes;
        let [a, b] = self.gains;
        let rate = p + m;
        Point {
            state: self.begin,
            slip: self.axis * (p - m) + Vector2::new(-self.axis.y, self.axis.x) * self.across,
            rate,
            slope: (a * p + b * m) / rate,
            since: T::zero(),
        }
    }

    #[inline(always)]
    fn at(&self, xi: T) -> Point<T> {
        let [p, m] = self.rates;
        let sigma = elapsed(p, xi);
        let (state, since) =
            self.state([xi, decayed(m, sigma), decayed(self.kappa, sigma)], mixed(p, m, sigma));
        // dxi = e^(-p sigma) dsigma
        let left = T::one() - p * xi;
        let fast = (-m * sigma).exp();
        let [size_p, size_m] = self.sizes;
        let (now_p, now_m) = (size_p * left, size_m * fast);
        let across = self.across * (-self.kappa * sigma).exp();
        let s = now_p + now_m;
        let [a, b] = self.gains;
        Point {
            state,
            slip: self.axis * (now_p - now_m) + Vector2::new(-self.axis.y, self.axis.x) * across,
            rate: size_p + now_m / left,
            slope: (a * now_p + b * now_m) / s,
            since,
        }
    }

    #[inline(always)]
    fn from(&self, point: &Point<T>) -> Self {
        let (across, sizes) = split(&self.axis, &point.slip, length(&point.slip));
        Self { begin: point.state, across, sizes, ..*self }
    }

    #[inline(always)]
    fn stop(&self) -> Option<(T, State<T>, T)> {
        let [p, m] = self.rates;
        let one = T::one();
        if p <= T::zero() {
            return None;
        }
        let mixed = one / (p * (p + m));
        let (state, since) = self.state([one / p, one / m, one / self.kappa], mixed);
        Some((one / p, state, since))
    }

    /// a P + b M = 0 with M / P = e^(-2 beta sigma) M_0 / P_0.
    #[inline(always)]
    fn turn(&self) -> Option<T> {
        let [a, b] = self.gains;
        let [p, m] = self.rates;
        let [size_p, size_m] = self.sizes;
        let ratio = -b * size_m / (a * size_p);
        let turns = a < T::zero() && ratio > T::one();
        if turns { Some(decayed(p, ratio.primal().ln() / (m - p))) } else { None }
    }
}

/// The integral of e^(-p t) (1 - e^(-m t)) / m from 0 to sigma.
#[inline(always)]
fn mixed<T: Real>(p: T, m: T, sigma: T) -> T {
    let (x, y) = (-p * sigma, -(p + m) * sigma);
    if y.abs() > T::one() || x.abs() > T::one() {
        return (decayed(p, sigma) - decayed(p + m, sigma)) / m;
    }
    // The second divided difference of the exponential at 0, x and y, by its series.
    let (mut power, mut sum) = (T::one(), T::one());
    let mut factor = constant::<T>(0.5);
    let mut total = factor;
    for k in 1..20_u32 {
        power *= y;
        sum = x * sum + power;
        factor /= constant::<T>(f64::from(k) + 2.0);
        total += sum * factor;
    }
    sigma * sigma * total
}
