//! Integrates one stretch of the sliding arc with sixteen Gauss nodes: impulses, v_n, work, w and sigma at
//! its end.
//!
//! Along a stretch w is proportional to ((1 + s t) / (1 - s t))^8, a rational function close to an
//! exponential; the nodes are those of t in [-1, 1]. ln(sigma w) is integrated by collocation; the errors of
//! all integrals over the whole stretch fall like rho^-32, those up to a node like rho^-16.
//!
//! The loops run over short arrays so that the compiler turns each into a few vector instructions.
//!
//! Theory: docs/theory.md, section 5.

mod tables;

use self::tables::{END, EVEN, HALF, NODES, ODD, WEIGHTS};
use super::{
    lanes::{Lanes, exp},
    sliding_arc::{ArcPoint, SlidingArc},
};
use crate::scalar::{Arithmetic, constant, dot, fma};

/// The coefficients of p(w) / w in the unit `middle` of w, for a quadratic p; `inverse` is 1 / `middle`.
#[inline(always)]
fn about<T: Arithmetic>([p0, p1, p2]: [T; 3], middle: T, inverse: T) -> [T; 3] {
    [p0 * inverse, p1, p2 * middle]
}

/// A quantity at the positive nodes (`ahead` of the middle) and at the negative ones (`behind`).
#[derive(Clone, Copy)]
struct Nodes<T> {
    ahead: [T; HALF],
    behind: [T; HALF],
}

/// Quantities at the nodes of a stretch. w is divided by its value in the middle, and quadratics in w are
/// divided by w.
pub(super) struct Panel<T> {
    w: Nodes<T>,
    /// (dlambda/dt) / q.
    inverse: Nodes<T>,
    e: Nodes<T>,
    /// d ln(sigma w) / dt and ln(sigma w), and then the terms of the four sums.
    rate: Nodes<T>,
    log: Nodes<T>,
    /// sigma w over its value in the middle.
    grown: Nodes<T>,
    /// The changes of ln(sigma w) from the middle to both ends, each twice to fill the lanes; afterwards
    /// their exponentials.
    ends: Lanes<T>,
    /// w and sigma w in the middle.
    middle: T,
    central: T,
    /// One more than the quadratures that the budget still allows; zero when one more was asked for.
    left: u32,
}

impl<T: Arithmetic> Panel<T> {
    /// A panel whose contents mean nothing yet: `step` overwrites all of them. `any` is any number that
    /// depends on the input.
    #[inline]
    pub fn new(any: T, quadratures: u32) -> Self {
        let nodes = Nodes { ahead: [any; HALF], behind: [any; HALF] };
        Self {
            w: nodes,
            inverse: nodes,
            e: nodes,
            rate: nodes,
            log: nodes,
            grown: nodes,
            ends: [any; 4],
            middle: any,
            central: any,
            left: quadratures.saturating_add(1),
        }
    }

    /// Whether the budget allows one more quadrature, which then counts as made.
    #[inline(always)]
    pub fn spend(&mut self) -> bool {
        self.left = self.left.saturating_sub(1);
        self.left > 0
    }

    /// Whether more quadratures were asked for than the budget allows.
    #[inline(always)]
    pub fn is_over_budget(&self) -> bool {
        self.left == 0
    }
}

impl<T: Arithmetic> SlidingArc<T> {
    /// Fills a panel whose middle is at w = `middle` (`unit` is its inverse). `s` is the parameter of the map
    /// from t to w.
    #[inline(always)]
    fn survey(&self, [middle, unit]: [T; 2], s: T, panel: &mut Panel<T>) {
        let one = T::one();
        let Panel { w, inverse, .. } = panel;
        let scale = s * constant(16.0);
        let inverses = inverse.ahead.iter_mut().zip(&mut inverse.behind);
        for (((node, w), v), (inverse, other)) in
            NODES.iter().zip(&mut w.ahead).zip(&mut w.behind).zip(inverses)
        {
            let t = s * constant(*node);
            let (up, down) = (one + t, one - t);
            let part = one / (up * down);
            *inverse = scale * part;
            *other = scale * part;
            let (up, down) = (up * up * part, down * down * part);
            let (up, down) = (up * up, down * down);
            let (up, down) = (up * up, down * down);
            *w = up * up;
            *v = down * down;
        }
        let Panel { w, inverse, e, rate, .. } = panel;
        let [q0, q1, q2] = about(self.q, middle, unit);
        let [k0, k1, k2] = about(self.central, middle, unit);
        let [e0, e1, e2] = [unit, self.middle, middle];
        let halves = [
            (&w.ahead, &mut inverse.ahead, &mut e.ahead, &mut rate.ahead),
            (&w.behind, &mut inverse.behind, &mut e.behind, &mut rate.behind),
        ];
        for (w, inverse, e, rate) in halves {
            for (((w, inverse), e), rate) in w.iter().zip(inverse).zip(e).zip(rate) {
                let w = *w;
                let over = *inverse / fma(fma(q2, w, q1), w, q0);
                *inverse = over;
                *e = fma(fma(e2, w, e1), w, e0);
                *rate = fma(fma(k2, w, k1), w, k0) * over;
            }
        }
    }

    /// Sets `to` to the point that lies `length` further in lambda, with its work, which is that of the
    /// balance of energy or, if `fast`, integrated directly. With `HERE` the
    /// quadrature becomes a part of the caller.
    #[inline(always)]
    pub fn step<const HERE: bool>(
        &self,
        from: &ArcPoint<T>,
        length: T,
        fast: bool,
        panel: &mut Panel<T>,
        to: &mut ArcPoint<T>,
    ) {
        if HERE {
            self.integrate_here(from, length, panel, to);
        } else {
            self.integrate(from, length, panel, to);
        }
        // Not within `integrate`: its frame is large where numbers carry derivatives.
        if fast {
            let done = self.direct(from, to, panel);
            to.state.work = from.state.work + done;
            to.since = from.since + done;
        }
    }

    /// [`Self::step`] with the work of the balance of energy.
    #[inline(never)]
    fn integrate(&self, from: &ArcPoint<T>, length: T, panel: &mut Panel<T>, to: &mut ArcPoint<T>) {
        self.integrate_here(from, length, panel, to);
    }

    /// [`Self::integrate`] as a part of the caller.
    #[inline(always)]
    fn integrate_here(&self, from: &ArcPoint<T>, length: T, panel: &mut Panel<T>, to: &mut ArcPoint<T>) {
        let one = T::one();
        // s = tanh(length / 32)
        let y = length * constant(1.0 / 32.0);
        let z = y * y;
        let s = y * fma(z, constant::<T>(105.0) + z, constant(945.0))
            / fma(z, fma(z, constant(15.0), constant(420.0)), constant(945.0));
        let ratio = (one + s) / (one - s);
        let ratio = ratio * ratio;
        let ratio = ratio * ratio;
        let ratio = ratio * ratio;
        let middle = from.w * ratio;
        let last = middle * ratio;
        let unit = one / middle;
        self.survey([middle, unit], s, panel);
        let [begin, end] = integrals(&panel.rate, &mut panel.log);
        // Exponentials of positive numbers only, and their inverses where needed: small exponentials would
        // lose digits.
        panel.ends = [begin.abs(), end.abs(), begin.abs(), end.abs()];
        Self::total(panel);
        let [before, after, ..] = panel.ends;
        let before = T::choose(T::zero().below(begin), || one / before, || before);
        let after = T::choose(end.below(T::zero()), || one / after, || after);
        let Panel { rate, log, .. } = &*panel;
        let [first, second, third, rubbed] =
            [sum(rate.ahead), sum(rate.behind), sum(log.ahead), sum(log.behind)];
        // sigma w in the middle.
        let central = from.sigma * from.w * before;
        (panel.middle, panel.central) = (middle, central);
        to.state = from.state;
        self.add([first * (central * unit), second * central, third * (central * middle)], &mut to.state);
        to.w = last;
        to.sigma = central * after / last;
        let done = self.balance(from, to, self.mu * central * central * rubbed);
        to.state.work = from.state.work + done;
        to.since = from.since + done;
    }

    /// The work of the normal impulse between two points, from the balance of energy and the loss by friction
    /// `rubbed` (theory, 4.16).
    #[inline(always)]
    fn balance(&self, from: &ArcPoint<T>, to: &ArcPoint<T>, rubbed: T) -> T {
        let slips = self.slip(from) + self.slip(to);
        let pushed = to.state.tangential - from.state.tangential;
        fma(
            constant::<T>(0.5),
            fma(
                from.state.velocity + to.state.velocity,
                to.state.normal - from.state.normal,
                dot(slips.x, pushed.x, slips.y, pushed.y),
            ),
            rubbed,
        )
    }

    /// The same work by integrating v_n over I_n (theory, 4.17): accurate also where the work is small beside
    /// the energies.
    #[cold]
    #[inline(never)]
    fn direct(&self, from: &ArcPoint<T>, to: &ArcPoint<T>, panel: &mut Panel<T>) -> T {
        let [f0, f1, f2] = about(self.f, panel.middle, T::one() / panel.middle);
        let Panel { w, inverse, e, grown, rate, log, central, .. } = panel;
        // sigma e / q takes the place of dlambda/dt over q.
        let halves = [
            ([&w.ahead, &w.behind, &grown.ahead, &e.ahead], &mut inverse.ahead, &mut rate.ahead),
            ([&w.behind, &w.ahead, &grown.behind, &e.behind], &mut inverse.behind, &mut rate.behind),
        ];
        for ([w, opposite, grown, e], value, rate) in halves {
            for (((((w, opposite), grown), e), value), rate) in
                w.iter().zip(opposite).zip(grown).zip(e).zip(value).zip(rate)
            {
                *value *= *grown * *e * *opposite;
                *rate = *value * fma(fma(f2, *w, f1), *w, f0);
            }
        }
        let [begin, _] = integrals(rate, log);
        let halves = [
            (&log.ahead, &inverse.ahead, &e.ahead, &mut rate.ahead),
            (&log.behind, &inverse.behind, &e.behind, &mut rate.behind),
        ];
        for (velocity, value, e, terms) in halves {
            for ((((velocity, value), e), weight), term) in
                velocity.iter().zip(value).zip(e).zip(&WEIGHTS).zip(terms)
            {
                *term = (*velocity - begin) * *value * *e * constant(*weight);
            }
        }
        let pushed = sum(rate.ahead) + sum(rate.behind);
        fma(from.state.velocity, to.state.normal - from.state.normal, *central * *central * pushed)
    }

    /// Forms the terms of four sums, one for each pair of nodes: sigma e / q times 1, w and w^2, and sigma^2
    /// e^3 / q, where sigma w = 1 in the middle.
    ///
    /// 1 / w at one node of a pair is w at the other.
    #[inline(always)]
    fn total(panel: &mut Panel<T>) {
        let Panel { w, inverse, e, log, grown, rate, ends, .. } = panel;
        *ends = exp(*ends);
        for (log, grown) in [(&log.ahead, &mut grown.ahead), (&log.behind, &mut grown.behind)] {
            for (log, grown) in log.as_chunks::<4>().0.iter().zip(grown.as_chunks_mut::<4>().0) {
                *grown = exp(*log);
            }
        }
        let (Nodes { ahead: s0, behind: s1 }, Nodes { ahead: s2, behind: s3 }) = (rate, log);
        let sums = s0.iter_mut().zip(s1.iter_mut()).zip(s2.iter_mut()).zip(s3.iter_mut()).zip(&WEIGHTS);
        let ahead = w.ahead.iter().zip(&inverse.ahead).zip(&e.ahead).zip(&grown.ahead);
        let behind = w.behind.iter().zip(&inverse.behind).zip(&e.behind).zip(&grown.behind);
        for (((((s0, s1), s2), s3), weight), (ahead, behind)) in sums.zip(ahead.zip(behind)) {
            let ((((w, inverse), e), grown), (((opposite, other), d), shrunk)) = (ahead, behind);
            let [a0, a1, a2, a3] = terms(*w, *opposite, *inverse, *e, *grown, *weight);
            let [b0, b1, b2, b3] = terms(*opposite, *w, *other, *d, *shrunk, *weight);
            (*s0, *s1, *s2, *s3) = (a0 + b0, a1 + b1, a2 + b2, a3 + b3);
        }
    }
}

/// The terms of one node in the four sums.
#[inline(always)]
fn terms<T: Arithmetic>(w: T, opposite: T, inverse: T, e: T, grown: T, weight: f64) -> [T; 4] {
    let slip = grown * e;
    let value = slip * inverse;
    let second = value * constant(weight);
    let first = second * opposite;
    [first, second, second * w, first * (slip * opposite * e)]
}

/// The sum of the eight pairs.
#[inline(always)]
fn sum<T: Arithmetic>([a, b, c, d, e, f, g, h]: [T; HALF]) -> T {
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}

/// The integrals of a function from the middle to each node (in `log`), and to both ends (returned).
#[inline(always)]
fn integrals<T: Arithmetic>(rate: &Nodes<T>, log: &mut Nodes<T>) -> [T; 2] {
    let zero = T::zero();
    let (mut even, mut odd) = ([zero; HALF], [zero; HALF]);
    for (((even, odd), ahead), behind) in even.iter_mut().zip(&mut odd).zip(&rate.ahead).zip(&rate.behind) {
        *even = *ahead + *behind;
        *odd = *ahead - *behind;
    }
    let (mut rise, mut bend) = ([zero; HALF], [zero; HALF]);
    if T::SEVERAL {
        // The same sums one after the other: all of them at once have no place in the registers.
        for (node, (rise, bend)) in rise.iter_mut().zip(&mut bend).enumerate() {
            for (((even, odd), rows), columns) in even.iter().zip(&odd).zip(&EVEN).zip(&ODD) {
                *rise = fma(*even, constant(rows[node]), *rise);
                *bend = fma(*odd, constant(columns[node]), *bend);
            }
        }
    } else {
        for (((even, odd), rows), columns) in even.iter().zip(&odd).zip(&EVEN).zip(&ODD) {
            for (((rise, bend), row), column) in rise.iter_mut().zip(&mut bend).zip(rows).zip(columns) {
                *rise = fma(*even, constant(*row), *rise);
                *bend = fma(*odd, constant(*column), *bend);
            }
        }
    }
    let (mut halves, mut sides) = ([zero; HALF], [zero; HALF]);
    for (((even, weight), end), (odd, (half, side))) in
        even.iter().zip(&WEIGHTS).zip(&END).zip(odd.iter().zip(halves.iter_mut().zip(&mut sides)))
    {
        *half = *even * constant(*weight);
        *side = *odd * constant(*end);
    }
    let (half, side) = (sum(halves) * constant(0.5), sum(sides));
    for (((ahead, behind), rise), bend) in log.ahead.iter_mut().zip(&mut log.behind).zip(&rise).zip(&bend) {
        *ahead = *bend + *rise;
        *behind = *bend - *rise;
    }
    [side - half, side + half]
}
