//! The rest of the sliding arc at once, by power series about the root of h that it runs into.
//!
//! There sigma = theta^alpha S(theta) with S analytic, and the integrals are sigma R with R analytic too: the arc from the present
//! direction (theta = 1) to the root (theta = 0) is one expansion. With alpha > 0 slip stops at the root; with alpha < 0 it grows without end.

use nalgebra::Vector2;

use super::{
    arc::{Arc, Point, Sought, Start, turning},
    chart::Chart,
    ledger::State,
    series::{MOST, Row, Scaled, Table, from_root, inverses, sum, sum_one, terms},
    terminal::Contact,
};
use crate::{scalar::Real as Scalar, scalar::constant, scalar::fma, scalar::larger};

/// Slip over |v_n1| (times mu if that is above one) beyond which the work would lose digits.
const FAST: f64 = 32.0;

/// Largest ratio of successive terms of the expansion that is used.
const RATIO: f64 = 0.73;

/// The rest of the arc; the parameter is lambda = -ln theta.
pub(super) struct Root<'a, T: Scalar> {
    terms: &'a [Row<T>],
    scaled: Scaled<T>,
    contact: Contact<T>,
    start: Start<T>,
    /// Direction of the root.
    direction: Vector2<T>,
    /// mu times b along the root and across it.
    across: [T; 2],
    /// sigma, its lanes and the slip at the start.
    sigma: T,
    first: Row<T>,
    slip: Vector2<T>,
    /// Exponent of sigma.
    pub alpha: T,
    /// Square of the ratio of terms at theta = 1.
    ratio: T,
    /// ln S as a series, without its first term.
    log: &'a [T],
    log_start: T,
}

/// The root of h that slip runs into: found once, it serves every piece of the arc.
#[derive(Clone, Copy)]
pub(super) struct Ahead<T: Scalar> {
    /// Direction of the root.
    direction: Vector2<T>,
    chart: Chart<T>,
    /// 1 / x of the other roots of H: a real one, and the middle and the square of half the difference of the others.
    poles: [T; 3],
}

impl<T: Scalar> Ahead<T> {
    /// The root ahead of a direction, if Newton's method finds it from a guess nearby or from the direction of b, where it is if friction is small.
    #[inline]
    pub fn of(contact: &Contact<T>, chart: &Chart<T>, d: &Vector2<T>) -> Option<Self> {
        let b = &contact.b;
        let forward = chart.h[0] > T::zero();
        let guess = match near(&chart.h) {
            Some(x) => x,
            None => (b.y * d.x - b.x * d.y) / ((b.x * b.x + b.y * b.y).sqrt() + b.x * d.x + b.y * d.y),
        };
        let x = stable(&chart.h, guess)?;
        let one = T::one();
        let size = one / (one + x * x);
        let (c, s) = ((one - x * x) * size, (x + x) * size);
        let direction = Vector2::new(d.x * c - d.y * s, d.y * c + d.x * s);
        let chart = Chart::about(contact, &direction);
        let [_, h1, h2, h3, h4] = chart.h;
        let inverse = one / h1;
        let (a, b, c) = (h2 * inverse, h3 * inverse, h4 * inverse);
        // w^3 + a w^2 + b w + c: from beyond all its roots, or from the end of the range if the real one is alone.
        let bound = one + larger(a.abs(), larger(b.abs(), c.abs()));
        let mut w = if fma(fma(-a, constant::<T>(2.0 / 9.0) * a, b) * constant(1.0 / 3.0), a, -c) > T::zero()
        {
            bound
        } else {
            -bound
        };
        for _ in 0..24 {
            let value = fma(fma(w + a, w, b), w, c);
            let slope = fma(fma(constant::<T>(3.0), w, a + a), w, b);
            let step = value / slope;
            w -= step;
            if step.abs() <= constant::<T>(1e-4) * w.abs() {
                break;
            }
        }
        let middle = -constant::<T>(0.5) * (a + w);
        let spread = middle * middle - fma(w + a, w, b);
        let found = Self { direction, chart, poles: [w, middle, spread] };
        if found.first(-one / x, forward) { Some(found) } else { None }
    }

    /// Whether no other root lies on the way from 1 / x = `from`.
    #[inline]
    fn first(&self, from: T, forward: bool) -> bool {
        let [w, p, spread] = self.poles;
        let beyond = |pole: T| if forward { pole > from } else { pole < from };
        let others = spread < T::zero() || {
            let r = spread.sqrt();
            beyond(p - r) && beyond(p + r)
        };
        others && beyond(w)
    }

    /// kappa for an expansion that reaches 1 / x = `from`, and the ratio of its terms there.
    #[inline]
    fn balance(&self, from: T) -> (T, T) {
        let [w, p, spread] = self.poles;
        let half = constant::<T>(0.5);
        let zero = T::zero();
        let (kappa, square) = if spread >= zero {
            let r = spread.sqrt();
            let (lo, hi) = (p - r, p + r);
            let (lo, hi) = (if w < lo { w } else { lo }, larger(w, hi));
            ((lo + hi) * half, (hi - lo) * (hi - lo) * constant(0.25))
        } else {
            let kappa = p + spread / (from - p);
            let pair = (p - kappa) * (p - kappa) - spread;
            let kappa = if (w - kappa) * (w - kappa) <= pair {
                kappa
            } else {
                (p * p - spread - w * w) * half / (p - w)
            };
            let pair = (p - kappa) * (p - kappa) - spread;
            (kappa, larger(pair, (w - kappa) * (w - kappa)))
        };
        (kappa, square / ((from - kappa) * (from - kappa)))
    }
}

/// A first guess at the root of H ahead, by the first three coefficients.
#[inline]
fn near<T: Scalar>(h: &[T; 5]) -> Option<T> {
    let [h0, h1, h2, ..] = *h;
    let two = constant::<T>(2.0);
    let disc = h1 * h1 - constant::<T>(4.0) * h0 * h2;
    let below = if disc > T::zero() { disc.sqrt() - h1 } else { return None };
    let x = two * h0 / below;
    if below > T::zero() && x.abs() <= two { Some(x) } else { None }
}

/// The stable root of H that Newton's method finds from a guess.
#[inline]
fn stable<T: Scalar>(h: &[T; 5], mut x: T) -> Option<T> {
    let [h0, h1, h2, h3, h4] = *h;
    let two = constant::<T>(2.0);
    let (d2, d3, d4) = (two * h2, constant::<T>(3.0) * h3, constant::<T>(4.0) * h4);
    for _ in 0..8 {
        let value = fma(fma(fma(fma(h4, x, h3), x, h2), x, h1), x, h0);
        let slope = fma(fma(fma(d4, x, d3), x, d2), x, h1);
        let step = value / slope;
        x -= step;
        if step.abs() <= T::default_epsilon() * constant(4.0) * x.abs() {
            return if slope < T::zero() { Some(x) } else { None };
        }
    }
    None
}

impl<'a, T: Scalar> Root<'a, T> {
    /// The expansion, if the root is near enough and v_n is monotone until there.
    #[inline]
    pub fn new(
        table: &'a mut Table<T>,
        contact: &Contact<T>,
        ahead: &Ahead<T>,
        start: Start<T>,
    ) -> Option<Self> {
        if start.slip * larger(T::one(), contact.mu) > constant(FAST) {
            return None;
        }
        let one = T::one();
        let (d, direction) = (&start.direction, ahead.direction);
        // tan of half the angle from the root to here.
        let x = (direction.x * d.y - direction.y * d.x) / (one + direction.dot(d));
        let from = one / x;
        let (kappa, ratio) = ahead.balance(from);
        let kappa = kappa.plain();
        // The square of the ratio of the terms.
        if ratio.partial_cmp(&constant(RATIO * RATIO)) != Some(core::cmp::Ordering::Less) {
            return None;
        }
        let here = ahead.chart.with_kappa(kappa);
        let [_, h1, ..] = here.h;
        let scaled = Scaled::new(&here, one / (from - kappa), one / h1);
        let [alpha, ..] = scaled.k;
        let usable = alpha.abs() > constant(0.03) && alpha > constant(-0.95) && alpha < constant(6.0);
        if !usable || turning(scaled.f, one, contact.size()).is_some() {
            return None;
        }
        let count = from_root(table, &scaled.taps(), &scaled.sources(true))?;
        let terms = terms(table, count);
        let poly = |p: [T; 3]| p[0] + p[1] + p[2];
        let sigma = start.slip / poly(scaled.e);
        Some(Self {
            terms,
            scaled,
            contact: *contact,
            start,
            direction,
            across: [
                contact.mu * contact.b.dot(&direction),
                contact.mu * (contact.b.y * direction.x - contact.b.x * direction.y),
            ],
            sigma,
            first: sum(terms, one),
            slip: Vector2::new(poly(scaled.c), poly(scaled.z)) * sigma,
            alpha,
            ratio,
            log: &[],
            log_start: T::zero(),
        })
    }

    /// Prepares the expansion for points on the way; false if that takes too many terms.
    #[inline]
    pub fn prepare(&mut self, log: &'a mut [T; MOST]) -> bool {
        let [_, _, h2, h3, h4] = self.scaled.h;
        let [alpha, k1, k2, k3] = self.scaled.k;
        let (mut l1, mut l2, mut l3) = (k3 - alpha * h4, k2 - alpha * h3, k1 - alpha * h2);
        // The sources come first: what is left of them is carried in the terms before.
        let (mut a, mut b, mut c) = (l3, l2, l1);
        (l1, l2, l3) = (T::zero(), T::zero(), T::zero());
        let mut total = T::zero();
        let mut count = 0;
        let mut settled = false;
        for (slot, inverse) in log.iter_mut().zip(inverses()) {
            let l = a - h2 * l1 - h3 * l2 - h4 * l3;
            (a, b, c) = (b, c, T::zero());
            *slot = l * inverse;
            total += *slot;
            (l3, l2, l1) = (l2, l1, l);
            count += 1;
            if count % 8 == 0 && (l1.abs() + l2.abs()) * inverse <= T::default_epsilon() {
                settled = true;
                break;
            }
        }
        self.log = log.get(..count).unwrap_or(&[]);
        self.log_start = total;
        settled
    }

    /// The state where slip is sigma (c, z) times `sigma`, with the lanes there.
    #[inline]
    fn state(&self, sigma: T, lanes: Row<T>, slip: &Vector2<T>) -> State<T> {
        let [i, c, s, w] = lanes;
        let [i1, c1, s1, w1] = self.first;
        let (di, dc, ds) =
            (sigma * i - self.sigma * i1, sigma * c - self.sigma * c1, sigma * s - self.sigma * s1);
        let rubbed = sigma * sigma * w - self.sigma * self.sigma * w1;
        let (dt, dn) = (-self.contact.mu * dc, -self.contact.mu * ds);
        let d = &self.direction;
        let tangential = Vector2::new(dt * d.x - dn * d.y, dt * d.y + dn * d.x);
        let from = &self.start.state;
        let velocity = from.velocity + di + self.contact.b.dot(&tangential);
        let work = constant::<T>(0.5)
            * ((from.velocity + velocity) * di + (self.slip.x + slip.x) * dt + (self.slip.y + slip.y) * dn)
            + self.contact.mu * rubbed;
        State {
            normal: from.normal + di,
            tangential: from.tangential + tangential,
            velocity,
            work: from.work + work,
        }
    }

    /// The state where slip stops (alpha > 0).
    #[inline]
    pub fn stop(&self) -> State<T> {
        self.state(T::zero(), [T::zero(); 4], &Vector2::zeros())
    }

    /// theta, sigma and the lanes.
    #[inline(always)]
    fn lanes(&self, lambda: T) -> (T, T, Row<T>) {
        let theta = (-lambda).exp();
        // The terms fall off like theta times the ratio: nearer to the root fewer of them count.
        let (mut terms, mut log) = (self.terms, self.log);
        let mut near = self.ratio;
        for _ in 0..3 {
            if theta * theta > near {
                break;
            }
            terms = half(terms);
            log = half(log);
            near *= near;
        }
        let lanes = sum(terms, theta);
        let log = sum_one(log, theta);
        let sigma = self.sigma * (log * theta - self.log_start - self.alpha * lambda).exp();
        (theta, sigma, lanes)
    }

    /// dI_n / dlambda at the start.
    #[inline]
    pub fn first_rate(&self) -> T {
        let [_, h1, h2, h3, h4] = self.scaled.h;
        let e = self.scaled.e[0] + self.scaled.e[1] + self.scaled.e[2];
        -(self.sigma + self.sigma) * e * e * self.scaled.inverse / (h1 + h2 + h3 + h4)
    }
}

/// The first half of the terms, a multiple of eight.
#[inline(always)]
fn half<R>(terms: &[R]) -> &[R] {
    terms.get(..(terms.len() + 8) / 16 * 8 + 8).unwrap_or(terms)
}

impl<T: Scalar> Arc<T> for Root<'_, T> {
    #[inline]
    fn at(&self, lambda: T) -> Point<T> {
        let (theta, sigma, lanes) = self.lanes(lambda);
        let poly = |p: [T; 3]| (p[2] * theta + p[1]) * theta + p[0];
        let e = poly(self.scaled.e);
        let slip = Vector2::new(poly(self.scaled.c), poly(self.scaled.z)) * sigma;
        let [_, h1, h2, h3, h4] = self.scaled.h;
        let h = ((h4 * theta + h3) * theta + h2) * theta + h1;
        let d = &self.direction;
        Point {
            state: self.state(sigma, lanes, &slip),
            rate: -(sigma + sigma) * e * e * self.scaled.inverse / h,
            slope: poly(self.scaled.f) / e,
            slip: Vector2::new(slip.x * d.x - slip.y * d.y, slip.x * d.y + slip.y * d.x),
        }
    }

    #[inline]
    fn value(&self, lambda: T, sought: &Sought<T>) -> (T, T) {
        if let Sought::Work(_) = sought {
            let point = self.at(lambda);
            return (sought.of(&point.state), sought.slope(&point.state, point.rate, point.slope));
        }
        let (theta, sigma, [i, c, s, _]) = self.lanes(lambda);
        let poly = |p: [T; 3]| fma(fma(p[2], theta, p[1]), theta, p[0]);
        let [_, h1, h2, h3, h4] = self.scaled.h;
        let h = fma(fma(fma(h4, theta, h3), theta, h2), theta, h1);
        let e = poly(self.scaled.e);
        let rate = -(sigma + sigma) * e * self.scaled.inverse / h;
        let from = &self.start.state;
        let [i1, c1, s1, _] = self.first;
        let di = sigma * i - self.sigma * i1;
        match *sought {
            Sought::Velocity(target) => {
                let [b1, b2] = self.across;
                let (dc, ds) = (sigma * c - self.sigma * c1, sigma * s - self.sigma * s1);
                (from.velocity - target + di - b1 * dc - b2 * ds, rate * poly(self.scaled.f))
            }
            Sought::Impulse(target) | Sought::Work(target) => (from.normal - target + di, rate * e),
        }
    }

    /// Where nothing is left of the distance to the root.
    #[inline]
    fn end(&self) -> T {
        constant::<T>(1.05) * -T::default_epsilon().ln()
            / if self.alpha > T::zero() && self.alpha < T::one() { self.alpha } else { T::one() }
    }

    #[inline]
    fn last(&self, end: T) -> Point<T> {
        if self.alpha > T::zero() {
            let zero = T::zero();
            return Point { state: self.stop(), rate: zero, slope: zero, slip: Vector2::zeros() };
        }
        self.at(end)
    }

    #[inline]
    fn winds(&self) -> bool {
        true
    }

    /// All quantities run like exp(-alpha lambda) in the end.
    #[inline]
    fn step(&self, newton: T) -> Option<T> {
        let left = T::one() - self.alpha * newton;
        Some(if left > constant(0.01) { -left.ln() / self.alpha } else { newton })
    }

    #[inline]
    fn guess(&self, lo: T, linear: T, fraction: T) -> T {
        if self.alpha > T::zero() {
            // What is left decays like exp(-alpha lambda).
            lo - larger(T::one() - fraction, T::default_epsilon()).ln() / self.alpha
        } else {
            lo - (T::one() - self.alpha * (linear - lo)).ln() / self.alpha
        }
    }
}
