//! Takes a short step along the sliding arc by collocation with four Gauss nodes: from the last trial of `event_location` to the event.
//!
//! The integrals are those of `gauss16`; over lengths of a few hundredths of a stretch four nodes give them to machine precision.
//!
//! Theory: docs/theory.md, section 8.5.

use super::{
    lanes::{Lanes, exp},
    sliding_arc::{ArcPoint, SlidingArc},
};
use crate::scalar::{Real, constant, fma};

/// The nodes in (0, 1).
const NODES: Lanes<f64> = [0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263];

/// The weights.
const WEIGHTS: Lanes<f64> =
    [0.17392742256872692, 0.32607257743127305, 0.32607257743127305, 0.17392742256872692];

/// The integral from 0 to each node (within a row) of the polynomial that is one at one node and zero at the others.
const INTEGRALS: [Lanes<f64>; 4] = [
    [0.08696371128436346, 0.18811811749986806, 0.16719192197418878, 0.1774825722545226],
    [-0.026604180084998794, 0.16303628871563652, 0.35395300603374397, 0.31344511474186837],
    [0.012627462689404725, -0.027880428602470895, 0.16303628871563652, 0.35267675751627187],
    [-0.0035551496857956833, 0.006735500594538156, -0.014190694931141144, 0.08696371128436346],
];

/// Quantities at the nodes: w, sigma e / q and e, then the terms of the sums.
struct Nodes<T> {
    w: Lanes<T>,
    rate: Lanes<T>,
    value: Lanes<T>,
    e: Lanes<T>,
    log: Lanes<T>,
    sums: [Lanes<T>; 4],
    /// The factors by which sigma and w grow over the step, each twice to fill the lanes.
    ends: Lanes<T>,
}

impl<T: Real> SlidingArc<T> {
    /// Moves the point by `length` in lambda, with its work (backwards if `length` is negative).
    #[inline(never)]
    pub fn short_step(&self, point: &mut ArcPoint<T>, length: T) {
        let any = [length; 4];
        let mut nodes = Nodes { w: any, rate: any, value: any, e: any, log: any, sums: [any; 4], ends: any };
        let scale = length * point.sigma;
        self.approach(point, length, &mut nodes);
        let [first, second, third, _] = nodes.sums.map(sum);
        let from = point.state;
        self.add([first * scale, second * scale, third * scale], &mut point.state);
        // The integral over I_n of v_n less its value at the beginning.
        let pushed = self.push(&mut nodes);
        let done = fma(from.velocity, point.state.normal - from.normal, scale * scale * pushed);
        point.state.work += done;
        point.since += done;
        let [sigma, w, ..] = nodes.ends;
        point.sigma *= sigma;
        point.w *= w;
    }

    /// Fills `nodes` for a step from `from`.
    #[inline(never)]
    fn approach(&self, from: &ArcPoint<T>, length: T, nodes: &mut Nodes<T>) {
        let ([q0, q1, q2], [k0, k1, k2]) = (self.q, self.k);
        let (one, middle) = (T::one(), self.middle);
        let Nodes { w, rate, value, e, log, sums, ends } = nodes;
        let [s0, s1, s2, s3] = sums;
        *w = exp(NODES.map(|t| constant::<T>(t) * length));
        for ((((w, rate), value), e), s3) in
            w.iter_mut().zip(rate.iter_mut()).zip(value.iter_mut()).zip(e.iter_mut()).zip(s3.iter_mut())
        {
            *w *= from.w;
            let inverse = one / fma(fma(q2, *w, q1), *w, q0);
            *rate = fma(fma(k2, *w, k1), *w, k0) * inverse * length;
            *e = fma(*w + middle, *w, one);
            *value = *e * inverse;
            *s3 = *rate;
        }
        collocate(s3, log);
        *log = exp(*log);
        let known = w.iter().zip(value.iter_mut()).zip(log.iter()).zip(&WEIGHTS);
        let sums = s0.iter_mut().zip(s1.iter_mut()).zip(s2.iter_mut()).zip(rate.iter_mut());
        for ((((w, value), grown), weight), (((s0, s1), s2), rate)) in known.zip(sums) {
            let weight = constant::<T>(*weight);
            *value *= *grown;
            let first = *value * weight;
            let second = first * *w;
            *s0 = first;
            *s1 = second;
            *s2 = second * *w;
            *rate *= weight;
        }
        let grown = sum(*rate);
        *ends = exp([grown, length, grown, length]);
    }

    /// The integral over I_n of v_n less its value at the beginning, divided by the square of (sigma at the beginning times the length).
    #[inline(never)]
    fn push(&self, nodes: &mut Nodes<T>) -> T {
        let [f0, f1, f2] = self.f;
        let Nodes { w, rate, value, e, log, sums: [first, ..], .. } = nodes;
        for ((w, rate), value) in w.iter().zip(rate.iter_mut()).zip(value.iter()) {
            *rate = *value * fma(fma(f2, *w, f1), *w, f0);
        }
        collocate(rate, log);
        for ((velocity, e), first) in log.iter_mut().zip(e.iter()).zip(first.iter()) {
            *velocity *= *e * *first;
        }
        sum(*log)
    }
}

/// The integrals from the beginning to each node of a function with these values at the nodes.
#[inline(always)]
fn collocate<T: Real>(values: &Lanes<T>, out: &mut Lanes<T>) {
    *out = [T::zero(); 4];
    for (value, row) in values.iter().zip(&INTEGRALS) {
        for (out, part) in out.iter_mut().zip(row) {
            *out = fma(*value, constant(*part), *out);
        }
    }
}

/// The sum of the four lanes.
#[inline(always)]
fn sum<T: Real>([a, b, c, d]: Lanes<T>) -> T {
    (a + c) + (b + d)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::{
        ReducedMatrix,
        solve::{Contact, State},
    };

    #[test]
    fn a_nudge_is_of_fourth_order() {
        let matrix = ReducedMatrix::new(0.2251, -0.1094, 0.1258, 0.2360, 0.1158, 0.2702);
        for mu in [0.3, 0.6, 1.1, 1.6, 3.0] {
            let contact = Contact::new(&matrix, mu);
            let slip = Vector2::new(1.063, 0.2);
            let (arc, w) = SlidingArc::through(&contact, &slip.normalize());
            let from = ArcPoint { state: State::before(-1.0), since: 0.0, w, sigma: slip.norm() / arc.e(w) };
            let rates = arc.rates(&from);
            let error = |step: f64| {
                let (mut a, mut b) = (from, from);
                arc.short_step(&mut a, step);
                b.third_order_step(&arc, &rates, &arc.rate_changes(&from, &rates), step);
                let of = |p: &ArcPoint<f64>| {
                    let s = &p.state;
                    [s.normal, s.tangential.x, s.tangential.y, s.velocity, s.work, p.w, p.sigma]
                };
                let (a, b) = (of(&a), of(&b));
                core::array::from_fn::<f64, 7, _>(|i| (a[i] - b[i]).abs())
            };
            let (large, small) = (error(4e-3), error(1e-3));
            for (large, small) in large.iter().zip(&small) {
                assert!((200.0..300.0).contains(&(large / small)), "{mu}: {large:e} {small:e}");
            }
        }
    }
}
