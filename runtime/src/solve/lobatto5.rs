//! Takes a short step along the sliding arc by collocation with five Lobatto nodes: from the last trial of
//! `event_location` to the event.
//!
//! The integrals are those of `gauss16`; over lengths of a few hundredths of a stretch five nodes give them
//! to machine precision. The first of them is the beginning, where all rates are known, and the last is the
//! end, so that four nodes are computed, and nothing else.
//!
//! Theory: docs/theory.md, section 8.5.

use super::{
    lanes::{Lanes, exp},
    sliding_arc::{ArcPoint, Rates, SlidingArc},
};
use crate::scalar::{Arithmetic, constant, fma};

/// The nodes in (0, 1]; the first of the five is zero.
const NODES: Lanes<f64> = [0.17267316464601143, 0.5, 0.8273268353539886, 1.0];

/// Their weights.
const WEIGHTS: Lanes<f64> = [0.2722222222222222, 0.35555555555555557, 0.2722222222222222, 0.05];

/// The weight of the beginning.
const FIRST: f64 = 0.05;

/// The integral from 0 to each node (within a row) of the polynomial that is one at one of the five nodes and
/// zero at the others.
const INTEGRALS: [Lanes<f64>; 5] = [
    [0.0677284321861569, 0.040625, 0.05370013924241453, 0.05],
    [0.11974476934341168, 0.30318418332304278, 0.2615863979968067, 0.2722222222222222],
    [-0.021735721866558114, 0.17777777777777778, 0.37729127742211367, 0.35555555555555557],
    [0.010635824225415492, -0.030961961100820556, 0.1524774528788105, 0.2722222222222222],
    [-0.0037001392424145306, 0.009375, -0.0177284321861569, 0.05],
];

/// Quantities at the four nodes: w, (dlambda/dc) / q (c from 0 to 1 along the step), e, d ln sigma / dc and
/// its integral, the terms of the sums.
struct Nodes<T> {
    w: Lanes<T>,
    value: Lanes<T>,
    e: Lanes<T>,
    rate: Lanes<T>,
    log: Lanes<T>,
    sums: [Lanes<T>; 3],
}

impl<T: Arithmetic> SlidingArc<T> {
    /// Moves the point, which has these rates, by `length` in lambda, with its work (backwards if `length` is
    /// negative).
    #[inline(never)]
    pub fn short_step(&self, point: &mut ArcPoint<T>, rates: &Rates<T>, length: T) {
        self.short_step_here::<false>(point, rates, length);
    }

    /// [`Self::short_step`] as a part of the caller, and with `HERE` all that it calls likewise.
    #[inline(always)]
    pub fn short_step_here<const HERE: bool>(&self, point: &mut ArcPoint<T>, rates: &Rates<T>, length: T) {
        let (one, any) = (T::one(), [length; 4]);
        let mut nodes = Nodes { w: any, value: any, e: any, rate: any, log: any, sums: [any; 3] };
        // tanh(length / 8), of which the next term is below the error of the steps to the event.
        let y = length * constant(0.125);
        let s = y * fma(y * y, constant(-1.0 / 3.0), one);
        let scale = s * constant(8.0);
        let begins = [point.w, s, scale, rates.growth * scale];
        if HERE {
            self.nodes_here(begins, &mut nodes);
        } else {
            self.nodes(begins, &mut nodes);
        }
        let begin = rates.e * rates.inverse * scale;
        let sigma = point.sigma;
        let [first, second, third] = &nodes.sums;
        let (first, second, third) = (sum(*first), sum(*second), sum(*third));
        let second_begin = begin * constant(FIRST) * point.w;
        let from = point.state;
        self.add(
            [
                fma(begin, constant(FIRST), first) * sigma,
                (second + second_begin) * sigma,
                fma(second_begin, point.w, third) * sigma,
            ],
            &mut point.state,
        );
        let slope = begin * rates.slope * rates.e;
        let pushed = if HERE { self.push_here(slope, &mut nodes) } else { self.push(slope, &mut nodes) };
        let done = fma(from.velocity, point.state.normal - from.normal, sigma * sigma * pushed);
        point.state.work += done;
        point.since += done;
        // The last node is the end.
        let ([.., w], [.., grown]) = (nodes.w, nodes.log);
        point.sigma = sigma * grown;
        point.w = w;
    }

    /// Fills `nodes` for a step from w = `from`, where d ln sigma / dc is `growth`. w changes by ((1 + s c) /
    /// (1 - s c))^4.
    #[inline(never)]
    fn nodes(&self, begins: [T; 4], nodes: &mut Nodes<T>) {
        self.nodes_here(begins, nodes);
    }

    /// [`Self::nodes`] as a part of the caller.
    #[inline(always)]
    fn nodes_here(&self, [from, s, scale, growth]: [T; 4], nodes: &mut Nodes<T>) {
        let ([q0, q1, q2], [k0, k1, k2]) = (self.q, self.k);
        let (one, middle) = (T::one(), self.middle);
        let Nodes { w, value, e, rate, log, sums: [s0, s1, s2] } = nodes;
        let known =
            NODES.iter().zip(w.iter_mut()).zip(value.iter_mut()).zip(e.iter_mut()).zip(rate.iter_mut());
        for ((((node, w), value), e), rate) in known {
            let t = s * constant(*node);
            let (up, down) = (one + t, one - t);
            let part = one / (up * down);
            // The ratio less one, which keeps the digits of a short step.
            let more = (t + t) * up * part;
            let more = fma(more, more, more + more);
            let more = fma(more, more, more + more);
            *w = fma(from, more, from);
            *value = scale * part / fma(fma(q2, *w, q1), *w, q0);
            *rate = fma(fma(k2, *w, k1), *w, k0) * *value;
            *e = fma(*w + middle, *w, one);
        }
        collocate(growth, rate, log);
        *log = exp(*log);
        let known = w.iter().zip(value.iter_mut()).zip(e.iter()).zip(log.iter()).zip(&WEIGHTS);
        let sums = s0.iter_mut().zip(s1.iter_mut()).zip(s2.iter_mut());
        for (((((w, value), e), grown), weight), ((s0, s1), s2)) in known.zip(sums) {
            *value *= *e * *grown;
            *s0 = *value * constant(*weight);
            *s1 = *s0 * *w;
            *s2 = *s1 * *w;
        }
    }

    /// The integral over I_n of v_n less its value at the beginning, where its derivative is `begin`, divided
    /// by the square of sigma at the beginning.
    #[inline(never)]
    fn push(&self, begin: T, nodes: &mut Nodes<T>) -> T {
        self.push_here(begin, nodes)
    }

    /// [`Self::push`] as a part of the caller.
    #[inline(always)]
    fn push_here(&self, begin: T, nodes: &mut Nodes<T>) -> T {
        let [f0, f1, f2] = self.f;
        let Nodes { w, rate, value, e, sums: [first, second, ..], .. } = nodes;
        for ((w, rate), value) in w.iter().zip(rate.iter_mut()).zip(value.iter()) {
            *rate = *value * fma(fma(f2, *w, f1), *w, f0);
        }
        collocate(begin, rate, second);
        for ((velocity, e), first) in second.iter_mut().zip(e.iter()).zip(first.iter()) {
            *velocity *= *e * *first;
        }
        sum(*second)
    }
}

/// The integrals from the beginning to each node of a function with these values at the beginning and at the
/// nodes.
#[inline(always)]
fn collocate<T: Arithmetic>(begin: T, values: &Lanes<T>, out: &mut Lanes<T>) {
    let [first, rows @ ..] = &INTEGRALS;
    *out = first.map(|part| begin * constant(part));
    for (value, row) in values.iter().zip(rows) {
        for (out, part) in out.iter_mut().zip(row) {
            *out = fma(*value, constant(*part), *out);
        }
    }
}

/// The sum of the four lanes.
#[inline(always)]
fn sum<T: Arithmetic>([a, b, c, d]: Lanes<T>) -> T {
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
                arc.short_step(&mut a, &rates, step);
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
