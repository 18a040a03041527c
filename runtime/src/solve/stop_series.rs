//! Integrates the rest of the sliding arc, until slip stops, by power series in u = 1 / w.
//!
//! Near the stable direction slip is sigma_u (b + a u)^2 with sigma_u = sigma w^2. The integrals from here to the end
//! of slip are sigma_u R(u) (sigma_u^2 R(u) for the work of friction), where Q u R' - K R is a known polynomial in u.
//! The coefficients of R obey a three-term recurrence, which runs for four integrals at once. They are kept
//! in arrays of four, which the compiler holds in one vector register.
//!
//! Theory: docs/theory.md, section 6.

use core::{cell::Cell, hint::black_box};

use super::{
    restitution::State,
    sliding_arc::{ArcPoint, SlidingArc},
};
use crate::scalar::{Arithmetic, Mask, constant, dot, fma, larger};

/// One coefficient of each series, for the integrals of sigma e w^2 / q, sigma e w / q, sigma e / q and for
/// the work of friction.
type Row<T> = [T; 4];

/// The number of terms between two tests for convergence.
const BLOCK: usize = 8;

/// The greatest number of blocks. Four suffice if u is less than half the distance to the zeros of Q.
const BLOCKS: u32 = 12;

/// The coefficients of the recurrence (theory, 6.4), each as `base` + n `slope`: of term n on its left side,
/// and of terms n - 1 and n - 2 on its right side.
struct Taps<T> {
    base: [Row<T>; 3],
    slope: [Row<T>; 3],
}

impl<T: Arithmetic> SlidingArc<T> {
    /// Whether 64 terms of the series suffice from here, where slip is `share` of the slip at the start.
    #[inline(always)]
    pub fn settles(&self, point: &ArcPoint<T>, share: T) -> T::Mask {
        let ratio = point.w / self.outer;
        ratio.at_most(constant(1.3)).not().and(|| self.settles_beyond(point, ratio, share))
    }

    /// [`Self::settles`] where w is this often the modulus of the zeros of q.
    #[inline(always)]
    fn settles_beyond(&self, point: &ArcPoint<T>, ratio: T, share: T) -> T::Mask {
        let [q0, q1, q2] = self.q;
        let [k0, k1, _] = self.k;
        // The terms must also decrease from the first on: large powers of the distance from the zeros of q
        // would let them grow first.
        let u = T::one() / point.w;
        let (last, fall) = (-self.last_rate(), q2 - self.last_rate());
        let rise = larger(((k1 + q1 + q1).abs() + (k0 + q0 + q0).abs() * u) * u - fall, T::zero());
        // The terms after the 64th must be below rounding.
        let power = ratio * ratio;
        let power = power * power;
        let power = power * power;
        let power = power * power;
        let power = power * power;
        let small = share.at_most(power * power * T::default_epsilon());
        let falls = || (rise * rise * last).at_most(constant::<T>(4.0) * q2 * fall * fall);
        small.and(|| rise.at_most(fall)).and(falls)
    }

    /// The state where slip stops (g < 0 at the stable end), and the normal work since compression ended.
    #[inline(never)]
    pub fn stop(&self, point: &ArcPoint<T>) -> (State<T>, T) {
        self.stop_here::<false>(point)
    }

    /// [`Self::stop`] as a part of the caller, and with `HERE` its blocks likewise.
    #[inline(always)]
    pub fn stop_here<const HERE: bool>(&self, point: &ArcPoint<T>) -> (State<T>, T) {
        // Where the compiler knows that it is zero, it may call a function that fills memory.
        let zero = if HERE { black_box(T::zero()) } else { T::zero() };
        let (one, three) = (T::one(), constant::<T>(3.0));
        let u = one / point.w;
        let (uu, middle) = (u * u, self.middle * u);
        let [q0, q1, q2] = self.q;
        let [k0, k1, _] = self.k;
        // K and Q; powers of u are included in their coefficients.
        let far = [self.last_rate(), (k1 + q1 + q1) * u, (k0 + q0 + q0) * uu];
        let [k0, k1, k2] = far.map(|k| [k, k, k, k + k]);
        let (q0, q1, q2) = (q2, q1 * u, q0 * uu);
        let mut taps = Taps {
            base: [k0.map(|k| -k), k1.map(|k| k + q1), k2.map(|k| k + q2 + q2)],
            slope: [[q0; 4], [-q1; 4], [-q2; 4]],
        };
        // The sources: e times 1, u and u^2, and e^3.
        let (e1, e2) = (middle, uu);
        let square = e1 * e1;
        let s2 = three * (square + e2);
        let mut sources = [
            [one, zero, zero, one],
            [e1, u, zero, three * e1],
            [e2, u * e1, uu, s2],
            [zero, u * e2, uu * e1, e1 * fma(constant::<T>(6.0), e2, square)],
            [zero, zero, uu * e2, e2 * s2],
            [zero, zero, zero, e2 * e2 * (three * e1)],
            [zero, zero, zero, e2 * e2 * e2],
            [zero; 4],
        ];
        let mut rows = [[zero; 4]; BLOCK + 2];
        let mut total = [zero; 4];
        let eps = T::default_epsilon();
        let sigma_u = point.sigma * point.w * point.w;
        let before = point.state.normal / sigma_u;
        let worked = point.state.work.abs() / (sigma_u * sigma_u * self.mu);
        let mut going = T::Mask::all();
        for _ in 0..BLOCKS {
            let before_block = total;
            if HERE {
                block_here(&mut rows, &mut sources, &mut taps, &mut total, zero);
            } else {
                block(&mut rows, &mut sources, &mut taps, &mut total);
            }
            total = T::iterated(going, || total, before_block);
            let [[a, b, c, d], [a1, b1, c1, d1], ..] = rows;
            let [sum, .., rubbed] = total;
            // The last two terms, compared with the whole impulse and the whole work since the start.
            let left = (a.abs() + b.abs() + c.abs()) + (a1.abs() + b1.abs() + c1.abs());
            let ends = left.at_most(eps * (sum + before));
            let ends = ends.and(|| (d.abs() + d1.abs()).at_most(eps * (rubbed + worked)));
            going = going.and(|| ends.not());
            if !going.any() {
                break;
            }
        }
        let [third, second, first, rubbed] = total;
        let from = &point.state;
        let mut state = *from;
        self.add([first * sigma_u, second * sigma_u, third * sigma_u], &mut state);
        let (slip, pushed) = (self.slip(point), state.tangential - from.tangential);
        let done = fma(
            constant::<T>(0.5),
            fma(
                from.velocity + state.velocity,
                state.normal - from.normal,
                dot(slip.x, pushed.x, slip.y, pushed.y),
            ),
            self.mu * sigma_u * sigma_u * rubbed,
        );
        state.work += done;
        (state, point.since + done)
    }
}

/// Computes eight terms from the two before them, which are the first two of `rows`, and adds them to
/// `total`. Prepares `rows`, `sources` and `taps` for the next block.
///
/// A function of its own: the bound of a collision's instructions (`tests/firmware/work.awk`) counts its
/// calls.
#[inline(never)]
fn block<T: Arithmetic>(
    rows: &mut [Row<T>; BLOCK + 2],
    sources: &mut [Row<T>; BLOCK],
    taps: &mut Taps<T>,
    total: &mut Row<T>,
) {
    block_here(rows, sources, taps, total, T::zero());
}

/// [`block`] as a part of the caller.
#[inline(always)]
fn block_here<T: Arithmetic>(
    rows: &mut [Row<T>; BLOCK + 2],
    sources: &mut [Row<T>; BLOCK],
    taps: &mut Taps<T>,
    total: &mut Row<T>,
    zero: T,
) {
    let [p, q, r] = taps.base;
    let [dp, dq, dr] = taps.slope;
    let cells = Cell::from_mut(rows.as_mut_slice()).as_slice_of_cells();
    let one = [T::one(); 4];
    let mut n = [zero; 4];
    for (window, source) in cells.windows(3).zip(sources.iter()) {
        let [before, last, out] = window else { return };
        let sum = mul_add(mul_add(n, dq, q), last.get(), *source);
        let [a, b, c, d] = mul_add(mul_add(n, dr, r), before.get(), sum);
        let [p, q, r, s] = mul_add(n, dp, p);
        out.set([a / p, b / q, c / r, d / s]);
        n = added(n, one);
    }
    let [_, _, terms @ ..] = rows;
    for term in terms.iter() {
        let ([t0, t1, t2, t3], [x0, x1, x2, x3]) = (&mut *total, term);
        *t0 += *x0;
        *t1 += *x1;
        *t2 += *x2;
        *t3 += *x3;
    }
    let [.., a, b] = *terms;
    let [first, second, ..] = rows;
    (*first, *second) = (a, b);
    for source in sources {
        *source = [zero; 4];
    }
    let length = [constant::<T>(BLOCK as f64); 4];
    let [p, q, r] = &mut taps.base;
    *p = mul_add(length, dp, *p);
    *q = mul_add(length, dq, *q);
    *r = mul_add(length, dr, *r);
}

#[inline(always)]
fn mul_add<T: Arithmetic>(
    [a0, a1, a2, a3]: Row<T>,
    [b0, b1, b2, b3]: Row<T>,
    [c0, c1, c2, c3]: Row<T>,
) -> Row<T> {
    [fma(a0, b0, c0), fma(a1, b1, c1), fma(a2, b2, c2), fma(a3, b3, c3)]
}

#[inline(always)]
fn added<T: Arithmetic>([a0, a1, a2, a3]: Row<T>, [b0, b1, b2, b3]: Row<T>) -> Row<T> {
    [a0 + b0, a1 + b1, a2 + b2, a3 + b3]
}
