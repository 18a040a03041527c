//! One step along the sliding arc by power series about its beginning.

use nalgebra::Vector2;

use super::{
    arc::{Arc, Point, Sought, Start},
    chart::Chart,
    ledger::State,
    series::{Row, Scaled, TERMS, Table, from_rest, from_rest_direct, sum, terms},
    terminal::Contact,
};
use crate::{scalar::Real as Scalar, scalar::constant, scalar::fma, scalar::larger};

/// Slip over |v_n1| (times mu if that is above one) beyond which the work of the normal impulse is summed directly.
const FAST: f64 = 32.0;

/// A step from theta = 0 to `limit`.
pub(super) struct Regular<'a, T: Scalar> {
    terms: &'a [Row<T>],
    scaled: Scaled<T>,
    start: Start<T>,
    contact: Contact<T>,
    /// m_nt and m_ts, m_tt, along the slip at the start.
    along: [T; 3],
    /// mu times b across the slip at the start.
    across: T,
    fast: bool,
    /// Half the terms hold up to here.
    short: T,
    /// The series holds up to here.
    pub limit: T,
}

impl<'a, T: Scalar> Regular<'a, T> {
    /// The series about the direction of slip at the start; the next event is about the impulse `away`.
    #[inline]
    pub fn new(
        table: &'a mut Table<T>,
        contact: &Contact<T>,
        chart: &Chart<T>,
        start: Start<T>,
        away: T,
    ) -> Self {
        let half = constant::<T>(0.5);
        let [h0, h1, ..] = chart.h;
        // Move the two nearest roots of H to either side of the start.
        let chart = chart.with_kappa(-half * h1 / h0);
        let [h0, h1, h2, ..] = chart.h;
        let [k0, ..] = chart.k;
        // Nothing depends on it, so that it needs no derivative (and the root may have none).
        let pivot = (h1.abs() * half + (h2 * h0).abs().sqrt() + k0.abs() * half + h0.abs() * half).plain();
        let scaled = Scaled::new(&chart, h0 / pivot, T::one() / pivot);
        let b = &contact.b;
        let d = &start.direction;
        let along = b.dot(d);
        let across = b.y * d.x - b.x * d.y;
        let fast = start.slip * larger(T::one(), contact.mu) > constant(FAST);
        let taps = scaled.taps();
        let sources = scaled.sources(!fast);
        let mut count = TERMS / 2;
        let mut limit;
        let mut short = T::zero();
        if fast {
            count = TERMS;
            from_rest_direct(table, &taps, &sources, [-contact.mu * along, -contact.mu * across], count);
            limit = reach(terms(table, count)).sqrt();
        } else {
            from_rest(table, &taps, &sources, 0, count);
            limit = reach(terms(table, count));
            let rate = (start.slip + start.slip) * scaled.inverse;
            if away + away > limit * rate {
                short = limit;
                from_rest(table, &taps, &sources, count, TERMS);
                count = TERMS;
                limit = reach(terms(table, count)).sqrt();
            }
        }
        let tt = contact.tt * d.x * d.x + (contact.ts + contact.ts) * d.x * d.y + contact.ss * d.y * d.y;
        let ts = contact.ts * (d.x * d.x - d.y * d.y) + (contact.ss - contact.tt) * d.x * d.y;
        Self {
            terms: terms(table, count),
            scaled,
            start,
            contact: *contact,
            along: [along, contact.mu * tt, contact.mu * ts],
            across: contact.mu * across,
            fast,
            short,
            limit: limit.plain(),
        }
    }

    /// The terms that count at theta.
    #[inline(always)]
    fn enough(&self, theta: T) -> &'a [Row<T>] {
        if theta > self.short { self.terms } else { self.terms.get(..TERMS / 2).unwrap_or(self.terms) }
    }

    /// dI_n / dtheta at the start.
    #[inline]
    pub fn first_rate(&self) -> T {
        (self.start.slip + self.start.slip) * self.scaled.inverse
    }
}

/// The theta up to which the terms left out are below rounding, for 32 terms: the 32nd root of what is allowed over what is there.
#[inline(always)]
fn reach<T: Scalar>(terms: &[Row<T>]) -> T {
    let ([first, ..], [.., a, b]) = (terms, terms) else { return T::zero() };
    let size = |r: &Row<T>| {
        let [i, c, s, w] = r;
        larger(larger(i.abs(), w.abs()), larger(c.abs(), s.abs()))
    };
    let [first, ..] = first;
    let tail = larger(size(a), size(b)) / first.abs();
    let allowed = constant::<T>(4.0) * T::default_epsilon();
    let ratio = allowed / larger(tail, allowed * allowed);
    ratio.sqrt().sqrt().sqrt().sqrt().sqrt()
}

impl<T: Scalar> Arc<T> for Regular<'_, T> {
    #[inline]
    fn at(&self, theta: T) -> Point<T> {
        let lanes = sum(self.enough(theta), theta);
        let [i, c, s, w] = lanes.map(|x| x * theta);
        let poly = |p: [T; 3]| (p[2] * theta + p[1]) * theta + p[0];
        let (cos, sin, e) = (poly(self.scaled.c), poly(self.scaled.z), poly(self.scaled.e));
        // 1 / sigma = c - (b I_n + T I_tan) / sigma, along the slip at the start.
        let [b1, m11, m12] = self.along;
        let sigma = T::one() / (cos - (b1 * i - m11 * c - m12 * s));
        let size = self.start.slip * sigma;
        let (di, dc, ds) = (size * i, size * c, size * s);
        let slip = Vector2::new(size * cos, size * sin);
        let from = &self.start;
        let d = &from.direction;
        let (dt, dn) = (-self.contact.mu * dc, -self.contact.mu * ds);
        let tangential = Vector2::new(dt * d.x - dn * d.y, dt * d.y + dn * d.x);
        let velocity = from.state.velocity + di + self.contact.b.dot(&tangential);
        let work = if self.fast {
            from.state.velocity * di + size * size * w
        } else {
            constant::<T>(0.5)
                * ((from.state.velocity + velocity) * di + (from.slip + slip.x) * dt + slip.y * dn)
                + self.contact.mu * size * size * w
        };
        let poly2 = |p: [T; 5]| (((p[4] * theta + p[3]) * theta + p[2]) * theta + p[1]) * theta + p[0];
        Point {
            state: State {
                normal: from.state.normal + di,
                tangential: from.state.tangential + tangential,
                velocity,
                work: from.state.work + work,
            },
            rate: (size + size) * e * e * self.scaled.inverse / poly2(self.scaled.h),
            slope: poly(self.scaled.f) / e,
            slip: Vector2::new(slip.x * d.x - slip.y * d.y, slip.x * d.y + slip.y * d.x),
        }
    }

    #[inline]
    fn value(&self, theta: T, sought: &Sought<T>) -> (T, T) {
        let poly = |p: [T; 3]| fma(fma(p[2], theta, p[1]), theta, p[0]);
        let poly2 = |p: [T; 5]| fma(fma(fma(fma(p[4], theta, p[3]), theta, p[2]), theta, p[1]), theta, p[0]);
        let from = &self.start;
        let [b1, m11, m12] = self.along;
        let e = poly(self.scaled.e);
        let (first, slope) = match *sought {
            Sought::Velocity(target) => (from.state.velocity - target, poly(self.scaled.f)),
            Sought::Impulse(target) => (from.state.normal - target, e),
            Sought::Work(_) => {
                let point = self.at(theta);
                return (sought.of(&point.state), sought.slope(&point.state, point.rate, point.slope));
            }
        };
        let [i, c, s, _] = sum(self.enough(theta), theta);
        let inverse = poly(self.scaled.c) - fma(b1, i, -fma(m11, c, m12 * s)) * theta;
        let gain = match sought {
            Sought::Velocity(_) => i - (self.contact.mu * b1) * c - self.across * s,
            _ => i,
        };
        let rate = (from.slip + from.slip) * e * self.scaled.inverse / poly2(self.scaled.h);
        let sigma = T::one() / inverse;
        (fma(from.slip * theta * gain, sigma, first), rate * slope * sigma)
    }

    #[inline]
    fn end(&self) -> T {
        super::arc::turning(self.scaled.f, self.limit, self.contact.size()).unwrap_or(self.limit)
    }

    #[inline]
    fn guess(&self, _: T, linear: T, _: T) -> T {
        linear
    }
}
