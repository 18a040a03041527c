//! Executes the steps on a block of states.

use super::compile::{Code, Columns, Step};
use super::lanes::{InSlot, LANES, Numbers, Operand, Slot, Uniform, WIDTH};
use super::table::Table;
use crate::interpret::constants::holds;
use crate::interpret::prepared::Failed;
use crate::program::VANISHING;
use hodograph_model::arithmetic::{call, call2, mul_add};

/// The work space of a batch.
pub struct Scratch {
    slots: Vec<Slot>,
    uniforms: Vec<f64>,
    /// the results of a block
    pub results: Vec<Slot>,
    /// why states of the block have no results
    pub failures: [Option<Failed>; LANES],
    /// for each state the first failed check, and whether its value is finite
    failed: [(u32, bool); LANES],
    /// 0 for each state whose results so far are all finite
    finite: Slot,
}

/// No check has failed.
const NONE: (u32, bool) = (u32::MAX, false);
const ZERO: Slot = [[0.0; WIDTH]; LANES / WIDTH];

impl Scratch {
    pub fn new(columns: &Columns) -> Self {
        let uniforms: Vec<f64> = columns.uniforms.iter().map(|(_, number)| *number).collect();
        let mut results = vec![ZERO; columns.len];
        for &(place, uniform) in &columns.uniform_results {
            results[place] = [[uniforms[uniform as usize]; WIDTH]; LANES / WIDTH];
        }
        Scratch {
            slots: vec![ZERO; columns.slots],
            uniforms,
            results,
            failures: [None; LANES],
            failed: [NONE; LANES],
            finite: ZERO,
        }
    }
}

impl Columns {
    /// Evaluates the states of a block.
    pub(super) fn run(&self, table: &Table<'_>, first: usize, count: usize, scratch: &mut Scratch) {
        scratch.failed = [NONE; LANES];
        scratch.finite = ZERO;
        let parts = count.div_ceil(WIDTH);
        for step in &self.steps {
            let Step { code, to, a, b, .. } = *step;
            match code {
                Code::Load(input) => table.gather(input, first, count, &mut scratch.slots[to as usize]),
                Code::Result => {
                    let result = scratch.slots[a as usize];
                    scratch.results[to as usize] = result;
                    for (sum, numbers) in scratch.finite.iter_mut().zip(&result) {
                        for (sum, &number) in sum.iter_mut().zip(numbers) {
                            *sum += number * 0.0;
                        }
                    }
                }
                Code::NotZeroS => scratch.check(to, InSlot(a), None::<InSlot>),
                Code::NotSmallSS => scratch.check(to, InSlot(a), Some(InSlot(b))),
                Code::NotSmallSU => scratch.check(to, InSlot(a), Some(Uniform(b))),
                Code::NotSmallUS => scratch.check(to, Uniform(a), Some(InSlot(b))),
                _ => compute(step, Numbers { slots: &mut scratch.slots, uniforms: &scratch.uniforms, parts }),
            }
        }
        for (lane, failure) in scratch.failures.iter_mut().enumerate() {
            let (check, singular) = scratch.failed[lane];
            *failure = match self.guards.get(check as usize) {
                Some(&guard) if singular => Some(Failed::Singular(guard)),
                Some(_) => Some(Failed::NotFinite),
                None => (scratch.finite.as_flattened()[lane] != 0.0).then_some(Failed::NotFinite),
            };
        }
    }
}

impl Scratch {
    /// Records the states in which a value vanishes relative to a scale. The failure that is reported is the
    /// one that [`crate::interpret::Prepared`] finds first.
    #[inline(always)]
    fn check<A: Operand, B: Operand>(&mut self, check: u32, value: A, scale: Option<B>) {
        let (mut values, mut bounds) = (ZERO, ZERO);
        for part in 0..LANES / WIDTH {
            values[part] = value.part(&self.slots, &self.uniforms, part);
            if let Some(scale) = scale {
                bounds[part] =
                    scale.part(&self.slots, &self.uniforms, part).map(|scale| VANISHING * scale.abs());
            }
        }
        let pairs = || values.as_flattened().iter().zip(bounds.as_flattened());
        let above = pairs().fold(true, |above, (value, bound)| above & (value.abs() > *bound));
        if !above {
            for (failed, (&value, &bound)) in self.failed.iter_mut().zip(pairs()) {
                if check < failed.0 && !holds(value, bound) {
                    *failed = (check, value.is_finite() && bound.is_finite());
                }
            }
        }
    }
}

/// Executes an operation; it agrees with [`crate::program::operate`] in doubles.
#[inline(always)]
fn compute(step: &Step, mut on: Numbers<'_>) {
    use Code::*;
    let Step { code, to, a, b, c } = *step;
    let (sa, sb, sc) = (InSlot(a), InSlot(b), InSlot(c));
    let (ua, ub, uc) = (Uniform(a), Uniform(b), Uniform(c));
    let add = |a: f64, b: f64| a + b;
    let sub = |a: f64, b: f64| a - b;
    let mul = |a: f64, b: f64| a * b;
    let div = |a: f64, b: f64| a / b;
    let mul_sub = |a: f64, b: f64, c: f64| mul_add(a, b, -c);
    let neg_mul_add = |a: f64, b: f64, c: f64| mul_add(-a, b, c);
    match code {
        Neg => on.one(to, sa, |a| -a),
        Recip => on.one(to, sa, |a| 1.0 / a),
        SineCosine => on.sine_cosine(to, b, a),
        AddSS => on.two(to, sa, sb, add),
        AddSU => on.two(to, sa, ub, add),
        SubSS => on.two(to, sa, sb, sub),
        SubSU => on.two(to, sa, ub, sub),
        SubUS => on.two(to, ua, sb, sub),
        MulSS => on.two(to, sa, sb, mul),
        MulSU => on.two(to, sa, ub, mul),
        DivSS => on.two(to, sa, sb, div),
        DivSU => on.two(to, sa, ub, div),
        DivUS => on.two(to, ua, sb, div),
        MulAddSSS => on.three(to, (sa, sb, sc), mul_add),
        MulAddSUS => on.three(to, (sa, ub, sc), mul_add),
        MulAddSSU => on.three(to, (sa, sb, uc), mul_add),
        MulAddSUU => on.three(to, (sa, ub, uc), mul_add),
        MulAddUUS => on.three(to, (ua, ub, sc), mul_add),
        MulSubSSS => on.three(to, (sa, sb, sc), mul_sub),
        MulSubSUS => on.three(to, (sa, ub, sc), mul_sub),
        MulSubSSU => on.three(to, (sa, sb, uc), mul_sub),
        MulSubSUU => on.three(to, (sa, ub, uc), mul_sub),
        MulSubUUS => on.three(to, (ua, ub, sc), mul_sub),
        NegMulAddSSS => on.three(to, (sa, sb, sc), neg_mul_add),
        NegMulAddSUS => on.three(to, (sa, ub, sc), neg_mul_add),
        NegMulAddSSU => on.three(to, (sa, sb, uc), neg_mul_add),
        NegMulAddSUU => on.three(to, (sa, ub, uc), neg_mul_add),
        NegMulAddUUS => on.three(to, (ua, ub, sc), neg_mul_add),
        Call(function) => on.one(to, sa, |a| call(function, a)),
        CallSS(function) => on.two(to, sa, sb, |a, b| call2(function, a, b)),
        CallSU(function) => on.two(to, sa, ub, |a, b| call2(function, a, b)),
        CallUS(function) => on.two(to, ua, sb, |a, b| call2(function, a, b)),
        Load(_) | Result | NotZeroS | NotSmallSS | NotSmallSU | NotSmallUS => {}
    }
}
