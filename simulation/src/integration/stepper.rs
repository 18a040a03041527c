//! Makes one step of the integration, with dense output.
//!
//! Dormand and Prince's method of order 8, with the coefficients of the crate `differential-equations` (E.
//! Hairer, S. P. Norsett and G. Wanner, *Solving Ordinary Differential Equations I*, section II.5 and II.6).
//! Time is relative to the start of the step, so that short steps late in a motion lose no digits. Known
//! rates are not evaluated again, and a step allocates its memory once.

mod transposed;

use std::sync::LazyLock;

use differential_equations::tableau::ButcherTableau;
use smallvec::SmallVec;

pub use transposed::{TransposedSystem, transpose};

/// Numbers of stages of the method and of its dense output including the rates at the end, and its order.
const STAGES: usize = 12;
const ALL_STAGES: usize = 16;
const ORDER: usize = 8;

static METHOD: LazyLock<ButcherTableau<f64, STAGES, ALL_STAGES>> = LazyLock::new(ButcherTableau::dop853);

/// Largest number of rejections of a step, each of which about halves it.
const REFUSALS: usize = 60;
/// Steps aim at this part of the size that the error allows, and change at most by these factors.
const SAFETY: f64 = 0.9;
const LEAST_FACTOR: f64 = 0.2;
const GREATEST_FACTOR: f64 = 10.0;

/// Rates jump within a step if all of them are those before or behind, up to this part of the change.
const JUMPS: f64 = 1e-2;

/// A system y' = f(t, y).
pub trait System {
    /// Writes the rates; NaN where it has none.
    fn rates(&mut self, t: f64, y: &[f64], rates: &mut [f64]);

    /// The state whose rates were asked for last is that of a step at a place of [`PLACES`], to a lower order than
    /// the step itself.
    fn at_place(&mut self, _place: usize) {}
}

impl<F: FnMut(f64, &[f64], &mut [f64])> System for F {
    fn rates(&mut self, t: f64, y: &[f64], rates: &mut [f64]) {
        self(t, y, rates);
    }
}

/// Stages at places that spread over a step, of the highest orders; the first is its start and the last its end.
const PLACES_OF: [usize; 8] = [0, 13, 14, 7, 9, 15, 10, 12];

/// The fractions of a step at which [`System::at_place`] tells of a state.
pub static PLACES: LazyLock<[f64; 8]> =
    LazyLock::new(|| PLACES_OF.map(|stage| if stage == STAGES { 1.0 } else { METHOD.c[stage] }));

/// An accepted step from `t` over `h`.
#[derive(Clone)]
pub struct Step {
    /// Its initial time.
    pub t: f64,
    /// Its length.
    pub h: f64,
    /// The next step size according to the error.
    pub next: f64,
    /// The state at its end.
    pub end: Vec<f64>,
    start: Vec<f64>,
    /// The rates at the start; empty for a step at rest.
    first: Vec<f64>,
    /// Coefficients of the dense output, [`ORDER`] vectors; empty for a step at rest.
    dense: Vec<f64>,
}

/// A state within a step; one of so many numbers needs no memory from the heap.
pub(crate) type Within = SmallVec<[f64; 32]>;

impl Step {
    /// A step at rest over this time.
    pub fn still(t: f64, h: f64, state: &[f64]) -> Self {
        let (end, start) = (state.to_vec(), state.to_vec());
        Self { t, h, next: h, end, start, first: Vec::new(), dense: Vec::new() }
    }

    /// The initial state.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The initial rates, if they are known.
    pub fn first(&self) -> Option<&[f64]> {
        (!self.first.is_empty()).then_some(&self.first)
    }

    /// The state at a fraction of the step.
    pub fn at(&self, fraction: f64) -> Within {
        let n = self.start.len();
        if fraction >= 1.0 || self.dense.is_empty() {
            return Within::from_slice(&self.end);
        }
        if fraction <= 0.0 {
            return Within::from_slice(&self.start);
        }
        // c0 + s (c1 + (1 - s) (c2 + s (c3 + (1 - s) (..)))).
        let mut state = Within::from_slice(&self.dense[(ORDER - 1) * n..]);
        for (place, coefficients) in self.dense.chunks_exact(n).enumerate().rev().skip(1) {
            let factor = if place % 2 == 0 { fraction } else { 1.0 - fraction };
            for (state, coefficient) in state.iter_mut().zip(coefficients) {
                *state = *state * factor + coefficient;
            }
        }
        state
    }

    /// Moves the end of the step by a time so short that the rates at the end determine the state there up to
    /// rounding. Returns whether it is that short; else nothing changes.
    pub fn ends_later(&mut self, by: f64) -> bool {
        let n = self.start.len();
        if self.dense.is_empty() || self.h + by <= 0.0 {
            return false;
        }
        let (_, rest) = self.dense.split_at(n);
        let (change, rest) = rest.split_at(n);
        let (bend, rest) = rest.split_at(n);
        // The rate at the end times h, as the dense output has it.
        let last = |i: usize| change[i] - bend[i] - rest[i];
        let part = by / self.h;
        let known = |i: usize| {
            let (first, last) = (self.h * self.first[i], last(i));
            let size = self.end[i].abs() + first.abs() + last.abs();
            part * part * (last - first).abs() <= 4.0 * f64::EPSILON * size
        };
        if !(0..n).all(known) {
            return false;
        }
        let moved: Vec<f64> = (0..n).map(|i| part * last(i)).collect();
        for (i, moved) in moved.into_iter().enumerate() {
            self.end[i] += moved;
            self.dense[n + i] += moved;
        }
        self.h += by;
        true
    }

    /// Replaces the final state by one that is corrected for drift.
    pub fn corrected(&mut self, end: &[f64]) {
        self.end.copy_from_slice(end);
    }
}

impl std::fmt::Debug for Step {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "Step from {} over {}", self.t, self.h)
    }
}

/// Relative and absolute tolerance of a step; the absolute one per component.
#[derive(Clone, Debug)]
pub struct Tolerances {
    /// Relative to the state.
    pub relative: f64,
    /// In the units of the state.
    pub absolute: f64,
}

/// A step from (t, y) of at most `h` whose error is within the tolerances; `first` are the initial rates if
/// they are known. A step with rates that are not finite is rejected. `None` if the initial rates are not
/// finite, or the step became as small as a rounding error of the time and no jump of the rates is the cause.
pub fn step(
    system: &mut (impl System + ?Sized),
    (t, y, first): (f64, &[f64], Option<&[f64]>),
    mut h: f64,
    tolerances: &Tolerances,
) -> Option<Step> {
    let (asked, least) = (h, 16.0 * f64::EPSILON * t.abs().max(1e-9 * h));
    let mut stages = Stages::new(system, t, y, first);
    let mut refused = None;
    for _ in 0..REFUSALS {
        if h < least && h < asked {
            return refused.and_then(|h| stages.over_a_jump(system, h, tolerances));
        }
        let error = if stages.compute(system, h) { stages.error(h, tolerances) } else { f64::NAN };
        let mut factor = (SAFETY * error.powf(-1.0 / ORDER as f64)).clamp_from(LEAST_FACTOR, GREATEST_FACTOR);
        if error <= 1.0 {
            if refused.is_some() {
                factor = factor.min(1.0);
            }
            return stages.finish(system, h, h * factor);
        }
        refused = Some(h);
        h *= factor;
    }
    None
}

/// A step from (t, y) over exactly `h`, without error control: part of a step that was accepted.
pub fn part(
    system: &mut (impl System + ?Sized),
    (t, y, first): (f64, &[f64], Option<&[f64]>),
    h: f64,
) -> Option<Step> {
    if h <= 0.0 {
        return Some(Step::still(t, 0.0, y));
    }
    let mut stages = Stages::new(system, t, y, first);
    if stages.compute(system, h) { stages.finish(system, h, h * GREATEST_FACTOR) } else { None }
}

trait ClampFrom {
    fn clamp_from(self, least: f64, greatest: f64) -> f64;
}

impl ClampFrom for f64 {
    /// Limits a number to these bounds; NaN becomes the least.
    fn clamp_from(self, least: f64, greatest: f64) -> f64 {
        self.max(least).min(greatest)
    }
}

/// The stages of a step: rates k_1 .. k_16, one after the other, and states.
struct Stages<'y> {
    t: f64,
    start: &'y [f64],
    k: Vec<f64>,
    state: Vec<f64>,
    end: Vec<f64>,
}

impl<'y> Stages<'y> {
    fn new(system: &mut (impl System + ?Sized), t: f64, start: &'y [f64], first: Option<&[f64]>) -> Self {
        let n = start.len();
        let mut k = vec![0.0; ALL_STAGES * n];
        match first {
            Some(first) => k[..n].copy_from_slice(first),
            None => {
                system.rates(t, start, &mut k[..n]);
                tell(system, 0);
            }
        }
        Self { t, start, k, state: vec![0.0; n], end: vec![0.0; n] }
    }

    fn k(&self, i: usize) -> &[f64] {
        &self.k[i * self.start.len()..][..self.start.len()]
    }

    /// The rates of stage i from the previous ones.
    fn stage(&mut self, system: &mut (impl System + ?Sized), i: usize, h: f64) {
        let n = self.start.len();
        let (before, rest) = self.k.split_at_mut(i * n);
        self.state.copy_from_slice(self.start);
        add(&mut self.state, before, &METHOD.a[i], h);
        system.rates(self.t + METHOD.c[i] * h, &self.state, &mut rest[..n]);
        tell(system, i);
    }

    /// All stages of a step, and its final state; `false` where a stage has no finite rates, which ends the step.
    fn compute(&mut self, system: &mut (impl System + ?Sized), h: f64) -> bool {
        let n = self.start.len();
        for i in 1..STAGES {
            self.stage(system, i, h);
            if !self.k(i).iter().all(|rate| rate.is_finite()) {
                self.k[(i + 1) * n..STAGES * n].fill(f64::NAN);
                return false;
            }
        }
        self.state.fill(0.0);
        add(&mut self.state, &self.k[..STAGES * n], &METHOD.b, 1.0);
        for ((end, start), sum) in self.end.iter_mut().zip(self.start).zip(&self.state) {
            *end = start + h * sum;
        }
        true
    }

    /// The error of the step relative to the tolerances. `state` is the mean rate.
    fn error(&self, h: f64, tolerances: &Tolerances) -> f64 {
        let (Some(er), Some(bh)) = (&METHOD.er, &METHOD.bh) else { return 0.0 };
        let n = self.start.len();
        let (mut fifth, mut third) = (0.0, 0.0);
        for i in 0..n {
            let (mut e5, mut e3) = (0.0, self.state[i]);
            for j in 0..STAGES {
                let k = self.k[j * n + i];
                e5 += er[j] * k;
                e3 -= bh[j] * k;
            }
            let allowed =
                tolerances.absolute + tolerances.relative * self.start[i].abs().max(self.end[i].abs());
            fifth += (e5 / allowed) * (e5 / allowed);
            third += (e3 / allowed) * (e3 / allowed);
        }
        let both = fifth + 0.01 * third;
        let both = if both <= 0.0 { 1.0 } else { both };
        h * fifth * (1.0 / (both * n as f64)).sqrt()
    }

    /// The step that was computed last, over a length that is a rounding error of the time, if its error is that of a jump of
    /// the rates: all rates within it are those of its start or of its end, and so are those behind it. The time of the jump is
    /// not known better.
    fn over_a_jump(
        mut self,
        system: &mut (impl System + ?Sized),
        h: f64,
        tolerances: &Tolerances,
    ) -> Option<Step> {
        let n = self.start.len();
        let allowed = |i: usize| tolerances.absolute + tolerances.relative * self.start[i].abs();
        let scales: Vec<f64> = (0..n).map(|i| 1.0 / allowed(i)).collect();
        let change = |from: &[f64], to: &[f64]| -> f64 {
            scales.iter().zip(from).zip(to).map(|((scale, from), to)| scale * (to - from).abs()).sum()
        };
        // The last stage is at the end. No comparison holds where a rate is not finite.
        let last = self.k(STAGES - 1).to_vec();
        let least = JUMPS * change(self.k(0), &last);
        let on_a_side = |i: usize| change(self.k(0), self.k(i)).min(change(self.k(i), &last)) <= least;
        if !(1..STAGES).all(on_a_side) {
            return None;
        }
        let mut behind = vec![0.0; n];
        self.state.copy_from_slice(&self.end);
        add(&mut self.state, &last, &[1.0], h);
        system.rates(self.t + 2.0 * h, &self.state, &mut behind);
        if change(&last, &behind) <= least { self.finish(system, h, h) } else { None }
    }

    /// The step with its dense output; `None` if its final state is not finite.
    fn finish(mut self, system: &mut (impl System + ?Sized), h: f64, next: f64) -> Option<Step> {
        if !self.end.iter().all(|value| value.is_finite()) {
            return None;
        }
        let n = self.start.len();
        self.rates_at_end(system, h);
        let Some(by) = &METHOD.bi else { return None };
        for i in STAGES + 1..ALL_STAGES {
            self.stage(system, i, h);
        }
        let mut dense = vec![0.0; ORDER * n];
        for i in 0..n {
            let (start, change) = (self.start[i], self.end[i] - self.start[i]);
            let bend = h * self.k(0)[i] - change;
            for (place, value) in
                [start, change, bend, change - h * self.k(STAGES)[i] - bend].into_iter().enumerate()
            {
                dense[place * n + i] = value;
            }
        }
        for (place, dense) in dense.chunks_exact_mut(n).enumerate().skip(4) {
            add(dense, &self.k, &by[place], h);
        }
        self.unrounded(system, h);
        let first = self.k(0).to_vec();
        Some(Step { t: self.t, h, next, end: self.end, start: self.start.to_vec(), first, dense })
    }

    /// Replaces the result by that of the trapezoidal rule if both agree up to rounding (constant
    /// acceleration), since the rule has fewer roundings and no bias: over 1e4 bounces the rounding of the
    /// twelve weights of the method would be visible in the energy.
    fn unrounded(&mut self, system: &mut (impl System + ?Sized), h: f64) {
        let n = self.start.len();
        // Speeds first, then the coordinates, which depend on them.
        for again in [true, false] {
            let mut changed = false;
            for i in 0..n {
                let (first, last) = (self.k[i], self.k[STAGES * n + i]);
                let rule = self.start[i] + 0.5 * h * (first + last);
                let size = self.start[i].abs() + h * (first.abs() + last.abs());
                if rule != self.end[i] && (rule - self.end[i]).abs() <= 32.0 * f64::EPSILON * size {
                    self.end[i] = rule;
                    changed = true;
                }
            }
            if !(changed && again) {
                break;
            }
            self.rates_at_end(system, h);
        }
    }

    fn rates_at_end(&mut self, system: &mut (impl System + ?Sized), h: f64) {
        let n = self.start.len();
        system.rates(self.t + h, &self.end, &mut self.k[STAGES * n..][..n]);
        tell(system, STAGES);
    }
}

/// Tells the system of a stage at a place.
fn tell(system: &mut (impl System + ?Sized), stage: usize) {
    if let Some(place) = PLACES_OF.iter().position(|&of| of == stage) {
        system.at_place(place);
    }
}

/// Adds a weighted sum of vectors, which are stored one after the other, times a factor.
fn add(sum: &mut [f64], vectors: &[f64], weights: &[f64], factor: f64) {
    for (vector, &weight) in vectors.chunks_exact(sum.len()).zip(weights) {
        if weight != 0.0 {
            let weight = weight * factor;
            for (sum, value) in sum.iter_mut().zip(vector) {
                *sum += weight * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oscillator(_: f64, y: &[f64], rates: &mut [f64]) {
        (rates[0], rates[1]) = (y[1], -y[0]);
    }

    /// Halving a step divides the error of its end by 2^9 and that of the dense output by 2^8.
    #[test]
    fn steps_and_dense_output_have_their_orders() {
        let errors = |h: f64| {
            let step = part(&mut oscillator, (0.0, &[1.0, 0.0], None), h).unwrap();
            let off = |t: f64, y: &[f64]| (y[0] - t.cos()).abs().max((y[1] + t.sin()).abs());
            let within = (1..50).map(|i| off(f64::from(i) / 50.0 * h, &step.at(f64::from(i) / 50.0)));
            (off(h, &step.end), within.fold(0.0, f64::max))
        };
        let (coarse, fine) = (errors(1.6), errors(0.8));
        let orders = ((coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2());
        assert!(orders.0 > 8.0 && orders.1 > 7.5, "{orders:?}");
        assert!(errors(0.2).1 < 1e-11, "{:e}", errors(0.2).1);
    }

    #[test]
    fn steps_keep_to_their_tolerance() {
        let tolerances = Tolerances { relative: 1e-10, absolute: 1e-10 };
        let step = step(&mut oscillator, (3.0, &[1.0, 0.0], None), 10.0, &tolerances).unwrap();
        assert!(step.h > 0.1 && step.h < 2.0 && (step.end[0] - step.h.cos()).abs() < 1e-10);
        // If no rates ahead are finite, there is no step.
        let mut broken =
            |t: f64, _: &[f64], rates: &mut [f64]| rates.fill(if t > 3.0 { f64::NAN } else { 1.0 });
        assert!(super::step(&mut broken, (3.0, &[1.0], None), 1.0, &tolerances).is_none());
    }

    /// Late in a motion a jump of the rates lies within a rounding error of the time; a pole has no step.
    #[test]
    fn a_jump_is_passed_by_a_step_as_short_as_the_time_is_known() {
        let tolerances = Tolerances { relative: 1e-12, absolute: 1e-12 };
        let mut jump = |_: f64, y: &[f64], rates: &mut [f64]| {
            (rates[0], rates[1]) = (y[1], if y[0] < 3.0 { 0.0 } else { -2e3 });
        };
        let (mut t, mut y) = (1e3, vec![0.0, 10.0]);
        while t < 1e3 + 0.3 + 1e-6 {
            let step = step(&mut jump, (t, &y, None), 1e3 + 0.3 + 1.1e-6 - t, &tolerances).unwrap();
            t += step.h;
            y = step.end;
        }
        assert!((y[1] - 10.0 + 2e3 * 1.1e-6).abs() < 1e-8, "{y:?}");
        let mut pole = |_: f64, y: &[f64], rates: &mut [f64]| rates[0] = 1.0 / (3.0 - y[0]).max(0.0);
        let (mut t, mut y) = (1e3, vec![0.0]);
        let stops = (0..10_000).any(|_| match step(&mut pole, (t, &y, None), 10.0, &tolerances) {
            Some(step) => {
                t += step.h;
                y = step.end;
                false
            }
            None => true,
        });
        assert!(stops && y[0] < 3.0, "{t} {y:?}");
    }

    /// The end of a step is moved by so short a time that nothing is lost, or not at all.
    #[test]
    fn the_end_of_a_step_moves_by_short_times_only() {
        let mut step = part(&mut oscillator, (0.0, &[1.0, 0.0], None), 0.5).unwrap();
        assert!(!step.ends_later(1e-6) && step.h == 0.5);
        for by in [1e-9, -3e-9] {
            let there = part(&mut oscillator, (0.0, &[1.0, 0.0], None), step.h + by).unwrap();
            assert!(step.ends_later(by) && step.h == there.h);
            for (moved, again) in step.end.iter().zip(&there.end) {
                assert!((moved - again).abs() < 4e-16);
            }
            assert!((step.at(0.999_999_999)[0] - there.at(0.999_999_999)[0]).abs() < 1e-15);
        }
    }

    /// The places at which a system is told of its states are in order, from the start to the end of the step.
    #[test]
    fn places_spread_over_a_step() {
        assert!(PLACES[0] == 0.0 && PLACES[7] == 1.0);
        assert!(PLACES.windows(2).all(|pair| pair[0] < pair[1] && pair[1] < pair[0] + 0.3));
        struct Told(f64, Vec<f64>);
        impl System for Told {
            fn rates(&mut self, t: f64, y: &[f64], rates: &mut [f64]) {
                self.0 = t;
                oscillator(t, y, rates);
            }
            fn at_place(&mut self, place: usize) {
                assert!((self.0 - 0.1 * PLACES[place]).abs() < 1e-15);
                self.1.push(PLACES[place]);
            }
        }
        let mut told = Told(0.0, Vec::new());
        part(&mut told, (0.0, &[1.0, 0.0], None), 0.1).unwrap();
        told.1.sort_by(f64::total_cmp);
        assert_eq!(told.1, *PLACES);
    }

    /// For constant acceleration the weights of the method cause no error.
    #[test]
    fn constant_accelerations_are_integrated_to_the_last_digit() {
        let mut fall = |_: f64, y: &[f64], rates: &mut [f64]| (rates[0], rates[1]) = (y[1], -9.81);
        let step = part(&mut fall, (0.0, &[2.0, 1.0], Some(&[1.0, -9.81])), 0.3).unwrap();
        assert_eq!(step.end, [2.0 + 0.15 * (1.0 + (1.0 - 0.3 * 9.81)), 1.0 - 0.3 * 9.81]);
    }
}
