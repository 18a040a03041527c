//! Power series of the integrals along a sliding arc.
//!
//! Every integral sought is sigma R (or sigma^2 R for the last) with H R' + 2 K R = w, w a polynomial: one linear recurrence with four
//! taps. Four lanes share it: I_n, the integrals of cos and of sin over I_n, and a work. The rows are worked on in memory, which lets the
//! compiler keep the four lanes in one register.

use core::cell::Cell;

use super::chart::Chart;
use crate::{scalar::Real as Scalar, scalar::constant, scalar::fma};

/// Most terms of a series about a regular point.
pub(super) const TERMS: usize = 64;
/// Most terms of a series about a root.
pub(super) const MOST: usize = 104;
/// Rows of zeros before the first term, for the recurrence to start from.
const LEAD: usize = 4;
/// Terms with a right-hand side.
const HEAD: usize = 7;

/// One coefficient of the four lanes.
pub(super) type Row<T> = [T; 4];

/// The coefficients, after four rows of zeros.
pub(super) type Table<T> = [Row<T>; LEAD + MOST];

/// A table to write series into.
///
/// Only its first rows must be zero. The others hold a number from the problem, because filling memory with zeros costs a call that takes longer.
#[inline(always)]
pub(super) fn table<T: Scalar>(any: T) -> Table<T> {
    let mut table = [[any; 4]; LEAD + MOST];
    for row in table.iter_mut().take(LEAD) {
        *row = [T::zero(); 4];
    }
    table
}

/// The first `count` terms of a table.
#[inline(always)]
pub(super) fn terms<T: Scalar>(table: &Table<T>, count: usize) -> &[Row<T>] {
    table.get(LEAD..LEAD + count).unwrap_or(&[])
}

#[inline(always)]
fn mul_add<T: Scalar>(a: Row<T>, b: Row<T>, c: Row<T>) -> Row<T> {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3], [c0, c1, c2, c3]) = (a, b, c);
    [fma(a0, b0, c0), fma(a1, b1, c1), fma(a2, b2, c2), fma(a3, b3, c3)]
}

#[inline(always)]
fn mul<T: Scalar>(a: Row<T>, b: T) -> Row<T> {
    let [a0, a1, a2, a3] = a;
    [a0 * b, a1 * b, a2 * b, a3 * b]
}

/// A chart scaled to theta: y = reach theta. All polynomials are in theta.
#[derive(Clone, Copy)]
pub(super) struct Scaled<T> {
    /// H / reach, divided by `pivot`.
    pub h: [T; 5],
    /// 2 K / pivot.
    pub k: [T; 4],
    pub f: [T; 3],
    /// e, and c and z where slip = sigma (c, z).
    pub e: [T; 3],
    pub c: [T; 3],
    pub z: [T; 3],
    /// 1 / pivot.
    pub inverse: T,
}

impl<T: Scalar> Scaled<T> {
    #[inline]
    pub fn new(chart: &Chart<T>, reach: T, inverse: T) -> Self {
        let (zero, one, two) = (T::zero(), T::one(), constant::<T>(2.0));
        let x2 = reach * reach;
        let s = [inverse, inverse * reach, inverse * x2, inverse * x2 * reach];
        let [h0, h1, h2, h3, h4] = chart.h;
        let [k0, k1, k2, k3] = chart.k;
        let [f0, f1, f2] = chart.f;
        let kx = chart.kappa * reach;
        let k2x = kx * kx;
        Self {
            h: [h0 / reach * inverse, h1 * s[0], h2 * s[1], h3 * s[2], h4 * s[3]],
            k: [two * k0 * s[0], two * k1 * s[1], two * k2 * s[2], two * k3 * s[3]],
            f: [f0, f1 * reach, f2 * x2],
            e: [one, kx + kx, k2x + x2],
            c: [one, kx + kx, k2x - x2],
            z: [zero, reach + reach, two * kx * reach],
            inverse,
        }
    }

    /// The right-hand sides of the first terms: 2 e^2, 2 e c, 2 e z and, for the work of friction, 2 e^3.
    #[inline(always)]
    pub fn sources(&self, friction: bool) -> [Row<T>; HEAD] {
        let zero = T::zero();
        let two = self.inverse + self.inverse;
        let [e0, e1, e2] = self.e.map(|x| x * two);
        let square = |p: [T; 3]| {
            [
                e0 * p[0],
                e0 * p[1] + e1 * p[0],
                e0 * p[2] + e1 * p[1] + e2 * p[0],
                e1 * p[2] + e2 * p[1],
                e2 * p[2],
            ]
        };
        let a = square(self.e);
        let b = square(self.c);
        let c = square(self.z);
        let [g0, g1, g2] = if friction { self.e } else { [zero; 3] };
        let w = [
            a[0] * g0,
            a[0] * g1 + a[1] * g0,
            a[0] * g2 + a[1] * g1 + a[2] * g0,
            a[1] * g2 + a[2] * g1 + a[3] * g0,
            a[2] * g2 + a[3] * g1 + a[4] * g0,
            a[3] * g2 + a[4] * g1,
            a[4] * g2,
        ];
        [
            [a[0], b[0], c[0], w[0]],
            [a[1], b[1], c[1], w[1]],
            [a[2], b[2], c[2], w[2]],
            [a[3], b[3], c[3], w[3]],
            [a[4], b[4], c[4], w[4]],
            [zero, zero, zero, w[5]],
            [zero, zero, zero, w[6]],
        ]
    }

    /// The constants of the recurrence.
    #[inline(always)]
    pub fn taps(&self) -> Taps<T> {
        let [_, h1, h2, h3, h4] = self.h;
        let [k0, k1, k2, k3] = self.k;
        let lanes = |k: T, part: T| [part - k, part - k, part - k, part - k - k];
        Taps {
            base: [
                lanes(k0, T::zero()),
                lanes(k1, h2),
                lanes(k2, h3 + h3),
                lanes(k3, constant::<T>(3.0) * h4),
            ],
            slope: [[-h1; 4], [-h2; 4], [-h3; 4], [-h4; 4]],
        }
    }
}

/// Minus the multipliers m_j(n) = 2 K_j + (n - j) H_(j+1) as base + n slope; 4 K_j in the lane of the work.
pub(super) struct Taps<T> {
    base: [Row<T>; 4],
    slope: [Row<T>; 4],
}

/// The series that are nothing at a regular point (h[0] = 1): term n multiplies theta^(n + 1).
///
/// Fills terms `from` up to `to`; those before must be there.
#[inline(never)]
pub(super) fn from_rest<T: Scalar>(
    table: &mut Table<T>,
    taps: &Taps<T>,
    sources: &[Row<T>; HEAD],
    from: usize,
    to: usize,
) {
    let rows = Cell::from_mut(table.as_mut_slice()).as_slice_of_cells();
    let (Some(rows), Some(orders)) = (rows.get(from..to + LEAD), ORDERS.get(from..to)) else { return };
    let zero = [T::zero(); 4];
    let mut blocks = rows.windows(LEAD + 4).step_by(4).zip(orders.as_chunks::<4>().0);
    if from == 0 {
        // The sources end within the first two blocks.
        let [w0, w1, w2, w3, w4, w5, w6] = *sources;
        if let Some((window, orders)) = blocks.next() {
            four_terms(window, orders, taps, &[w0, w1, w2, w3]);
        }
        if let Some((window, orders)) = blocks.next() {
            four_terms(window, orders, taps, &[w4, w5, w6, zero]);
        }
    }
    for (window, orders) in blocks {
        four_terms(window, orders, taps, &[zero; 4]);
    }
}

/// Four terms from the four before them.
#[inline(always)]
fn four_terms<T: Scalar>(
    window: &[Cell<Row<T>>],
    [o0, o1, o2, o3]: &[[f64; 2]; 4],
    taps: &Taps<T>,
    [s0, s1, s2, s3]: &[Row<T>; 4],
) {
    let [a, b, c, d, e, f, g, h] = window else { return };
    four_taps([a, b, c, d, e], o0, taps, *s0);
    four_taps([b, c, d, e, f], o1, taps, *s1);
    four_taps([c, d, e, f, g], o2, taps, *s2);
    four_taps([d, e, f, g, h], o3, taps, *s3);
}

/// One term from the four before it.
#[inline(always)]
fn four_taps<T: Scalar>(
    [r3, r2, r1, r0, out]: [&Cell<Row<T>>; 5],
    [order, inverse]: &[f64; 2],
    taps: &Taps<T>,
    source: Row<T>,
) {
    let [b0, b1, b2, b3] = taps.base;
    let [s0, s1, s2, s3] = taps.slope;
    let n = [constant::<T>(*order); 4];
    let sum = mul_add(mul_add(n, s0, b0), r0.get(), source);
    let sum = mul_add(mul_add(n, s1, b1), r1.get(), sum);
    let sum = mul_add(mul_add(n, s2, b2), r2.get(), sum);
    let sum = mul_add(mul_add(n, s3, b3), r3.get(), sum);
    out.set(mul(sum, constant(*inverse)));
}

/// The same, with the integral of v_n less its first value for the work: `normal` makes v_n of the other lanes. It keeps its digits where
/// slip is fast, and takes longer.
#[inline(never)]
pub(super) fn from_rest_direct<T: Scalar>(
    table: &mut Table<T>,
    taps: &Taps<T>,
    sources: &[Row<T>; HEAD],
    normal: [T; 2],
    count: usize,
) {
    let [[a0, ..], [a1, ..], [a2, ..], [a3, ..], [a4, ..], ..] = *sources;
    let [nc, ns] = normal;
    let mut v = [T::zero(); 5];
    let mut sources = sources.iter();
    let rows = Cell::from_mut(table.as_mut_slice()).as_slice_of_cells();
    for (window, [order, inverse]) in rows.windows(LEAD + 1).zip(ORDERS).take(count) {
        let [r3, r2, r1, r0, out] = window else { return };
        let source = sources.next().copied().unwrap_or([T::zero(); 4]);
        let [i, c, s, _] = r0.get();
        let [v0, v1, v2, v3, _] = v;
        v = [i + nc * c + ns * s, v0, v1, v2, v3];
        let [v0, v1, v2, v3, v4] = v;
        let mut sum = source;
        for ((base, slope), row) in taps.base.iter().zip(&taps.slope).zip([r0, r1, r2, r3]) {
            sum = mul_add(mul_add([constant::<T>(order); 4], *slope, *base), row.get(), sum);
        }
        let [i, c, s, w] = sum;
        let w = w + a0 * v0 + a1 * v1 + a2 * v2 + a3 * v3 + a4 * v4;
        out.set(mul([i, c, s, w], constant(inverse)));
    }
}

/// The series regular at a simple root of H (h = [0, 1, ..]): term n multiplies theta^n.
///
/// Gives the number of terms that rounding leaves at theta = 1, or `None` if they are too many.
#[inline(never)]
pub(super) fn from_root<T: Scalar>(
    table: &mut Table<T>,
    taps: &Taps<T>,
    sources: &[Row<T>; HEAD],
) -> Option<usize> {
    let tolerance = T::default_epsilon();
    let rows = Cell::from_mut(table.as_mut_slice()).as_slice_of_cells();
    let zero = [T::zero(); 4];
    let mut windows = rows.windows(LEAD + 1).zip(&ORDERS);
    for (source, (window, order)) in sources.iter().zip(&mut windows) {
        three_taps(window, order, taps, *source);
    }
    let [.., first, _, _, _] = rows.get(..LEAD + 4)? else { return None };
    let [size, .., work] = first.get().map(|x| x.abs() * tolerance);
    let mut count = HEAD;
    for (window, order) in windows {
        three_taps(window, order, taps, zero);
        count += 1;
        if count.is_multiple_of(8) {
            // Two terms: every other one may vanish.
            let [.., a, b] = window else { return None };
            let ([i, _, _, v], [j, _, _, w]) = (a.get(), b.get());
            if i.abs() + j.abs() <= size && v.abs() + w.abs() <= work {
                return Some(count);
            }
        }
    }
    None
}

/// One term about a root from the three before it: the tap j = 0 is the pivot, so that the others stand one order lower.
#[inline(always)]
fn three_taps<T: Scalar>(window: &[Cell<Row<T>>], [order, _]: &[f64; 2], taps: &Taps<T>, source: Row<T>) {
    let [_, r2, r1, r0, out] = window else { return };
    let [[p0, p1, p2, p3], b1, b2, b3] = taps.base;
    let [_, s1, s2, s3] = taps.slope;
    let order = constant::<T>(*order);
    let n = [order; 4];
    let sum = mul_add(mul_add(n, s1, b1), r0.get(), source);
    let sum = mul_add(mul_add(n, s2, b2), r1.get(), sum);
    let [q0, q1, q2, q3] = mul_add(mul_add(n, s3, b3), r2.get(), sum);
    out.set([q0 / (order - p0), q1 / (order - p1), q2 / (order - p2), q3 / (order - p3)]);
}

/// n and 1 / (n + 1).
const ORDERS: [[f64; 2]; MOST] = {
    let mut table = [[0.0; 2]; MOST];
    let mut n = 0;
    while n < MOST {
        table[n] = [n as f64, 1.0 / (n as f64 + 1.0)];
        n += 1;
    }
    table
};

/// 1, 1/2, 1/3, ...
#[inline(always)]
pub(super) fn inverses<T: Scalar>() -> impl Iterator<Item = T> {
    ORDERS.iter().map(|[_, inverse]| constant(*inverse))
}

/// The sum of the lanes at theta, for terms that begin with theta^0; there are a multiple of eight.
#[inline(always)]
pub(super) fn sum<T: Scalar>(terms: &[Row<T>], theta: T) -> Row<T> {
    let at = [theta; 4];
    let mut total = [T::zero(); 4];
    let (blocks, _) = terms.as_chunks::<8>();
    for [a, b, c, d, e, f, g, h] in blocks.iter().rev() {
        total = mul_add(mul_add(mul_add(mul_add(total, at, *h), at, *g), at, *f), at, *e);
        total = mul_add(mul_add(mul_add(mul_add(total, at, *d), at, *c), at, *b), at, *a);
    }
    total
}

/// The same for one series.
#[inline(always)]
pub(super) fn sum_one<T: Scalar>(terms: &[T], theta: T) -> T {
    let mut total = T::zero();
    let (blocks, _) = terms.as_chunks::<8>();
    for [a, b, c, d, e, f, g, h] in blocks.iter().rev() {
        total = fma(fma(fma(fma(total, theta, *h), theta, *g), theta, *f), theta, *e);
        total = fma(fma(fma(fma(total, theta, *d), theta, *c), theta, *b), theta, *a);
    }
    total
}
