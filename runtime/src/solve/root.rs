//! The rest of the sliding arc at once, by power series about the root of h that it runs into.
//!
//! There sigma = theta^alpha S(theta) with S analytic, and the integrals are sigma R with R analytic too: the arc from the present
//! direction (theta = 1) to the root (theta = 0) is one expansion. With alpha > 0 slip stops at the root; with alpha < 0 it grows without end.

use nalgebra::Vector2;

use super::{
    arc::{Arc, Point, Start, turning},
    chart::Chart,
    ledger::State,
    series::{Row, Scaled, TERMS, Table, from_root, inverses, sum, sum_one, terms},
    terminal::Contact,
};
use crate::{scalar::Real as Scalar, scalar::constant, scalar::fma, scalar::larger};

/// Slip over |v_n1| (times mu if that is above one) beyond which the work would lose digits.
const FAST: f64 = 32.0;

/// The rest of the arc; the parameter is lambda = -ln theta.
pub(super) struct Root<'a, T: Scalar> {
    terms: &'a [Row<T>],
    scaled: Scaled<T>,
    contact: Contact<T>,
    start: Start<T>,
    /// Direction of the root.
    direction: Vector2<T>,
    /// sigma, its lanes and the slip at the start.
    sigma: T,
    first: Row<T>,
    slip: Vector2<T>,
    /// Exponent of sigma.
    pub alpha: T,
    /// ln S as a series, without its first term.
    log: &'a [T],
    log_start: T,
}

/// The stable root of H ahead, if it is in reach.
#[inline]
fn ahead<T: Scalar>(h: &[T; 5]) -> Option<T> {
    let [h0, h1, h2, h3, h4] = *h;
    let two = constant::<T>(2.0);
    let disc = h1 * h1 - constant::<T>(4.0) * h0 * h2;
    let below = if disc > T::zero() { disc.sqrt() - h1 } else { -h1 };
    if below <= T::zero() {
        return None;
    }
    let mut x = two * h0 / below;
    if x.abs() > two {
        return None;
    }
    for _ in 0..8 {
        let value = fma(fma(fma(fma(h4, x, h3), x, h2), x, h1), x, h0);
        let slope = fma(fma(fma(constant::<T>(4.0) * h4, x, constant::<T>(3.0) * h3), x, two * h2), x, h1);
        let step = value / slope;
        x -= step;
        if step.abs() <= T::default_epsilon() * constant(4.0) * x.abs() {
            let right = slope < T::zero() && x * h0 > T::zero() && x.abs() < two;
            return if right { Some(x) } else { None };
        }
    }
    None
}

/// Whether every root of 1 + a x + b x^2 + c x^3 lies outside a circle of radius 4/3, by Cauchy's bound after two of Graeffe's squarings.
#[inline]
fn apart<T: Scalar>(mut a: T, mut b: T, mut c: T) -> bool {
    for _ in 0..2 {
        (a, b, c) = (b + b - a * a, b * b - (a + a) * c, -c * c);
    }
    // (3/4)^4
    let q = constant::<T>(0.316);
    ((q - a.abs()) * q - b.abs()) * q > c.abs()
}

impl<'a, T: Scalar> Root<'a, T> {
    /// The expansion, if the root is near enough and v_n is monotone until there.
    #[inline]
    pub fn new(
        table: &'a mut Table<T>,
        contact: &Contact<T>,
        chart: &Chart<T>,
        start: Start<T>,
    ) -> Option<Self> {
        if start.slip * larger(T::one(), contact.mu) > constant(FAST) {
            return None;
        }
        let x = ahead(&chart.h)?;
        let one = T::one();
        let size = one + x * x;
        let (c, s) = ((one - x * x) / size, (x + x) / size);
        let d = &start.direction;
        let direction = Vector2::new(d.x * c - d.y * s, d.y * c + d.x * s);
        let here = Chart::about(contact, &direction);
        let [_, h1, h2, ..] = here.h;
        let kappa = -constant::<T>(0.5) * h2 / h1;
        let room = one + kappa * x;
        let (kappa, room) = if room > constant(0.25) { (kappa, room) } else { (T::zero(), one) };
        let here = here.with_kappa(kappa);
        let scaled = Scaled::new(&here, -x / room, one / h1);
        let [_, _, p2, p3, p4] = scaled.h;
        let [alpha, ..] = scaled.k;
        let usable = alpha.abs() > constant(0.03) && alpha > constant(-0.95) && alpha < constant(6.0);
        if !usable || !apart(p2, p3, p4) || turning(scaled.f, one).is_some() {
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
            sigma,
            first: sum(terms, one),
            slip: Vector2::new(poly(scaled.c), poly(scaled.z)) * sigma,
            alpha,
            log: &[],
            log_start: T::zero(),
        })
    }

    /// Prepares the expansion for points on the way; false if that takes too many terms.
    #[inline]
    pub fn prepare(&mut self, log: &'a mut [T; TERMS]) -> bool {
        let [_, _, h2, h3, h4] = self.scaled.h;
        let [alpha, k1, k2, k3] = self.scaled.k;
        let (mut l1, mut l2, mut l3) = (k3 - alpha * h4, k2 - alpha * h3, k1 - alpha * h2);
        // The sources come first: what is left of them is carried in the terms before.
        let (mut a, mut b, mut c) = (l3, l2, l1);
        (l1, l2, l3) = (T::zero(), T::zero(), T::zero());
        let mut total = T::zero();
        for (slot, inverse) in log.iter_mut().zip(inverses()) {
            let l = a - h2 * l1 - h3 * l2 - h4 * l3;
            (a, b, c) = (b, c, T::zero());
            *slot = l * inverse;
            total += *slot;
            (l3, l2, l1) = (l2, l1, l);
        }
        let [.., y, z] = log;
        let settled = y.abs() + z.abs() <= constant::<T>(2.0) * T::default_epsilon();
        self.log = log;
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

    /// dI_n / dlambda at the start.
    #[inline]
    pub fn first_rate(&self) -> T {
        let [_, h1, h2, h3, h4] = self.scaled.h;
        let e = self.scaled.e[0] + self.scaled.e[1] + self.scaled.e[2];
        -(self.sigma + self.sigma) * e * e * self.scaled.inverse / (h1 + h2 + h3 + h4)
    }
}

impl<T: Scalar> Arc<T> for Root<'_, T> {
    #[inline]
    fn at(&self, lambda: T) -> Point<T> {
        let theta = (-lambda).exp();
        let lanes = sum(self.terms, theta);
        let log = sum_one(self.log, theta);
        let sigma = self.sigma * (log * theta - self.log_start - self.alpha * lambda).exp();
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
    fn guess(&self, lo: T, linear: T, fraction: T) -> T {
        if self.alpha > T::zero() {
            // What is left decays like exp(-alpha lambda).
            lo - larger(T::one() - fraction, T::default_epsilon()).ln() / self.alpha
        } else {
            lo - (T::one() - self.alpha * (linear - lo)).ln() / self.alpha
        }
    }
}
