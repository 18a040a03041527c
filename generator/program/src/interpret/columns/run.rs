//! Executes the steps on a block of states.

use super::compile::Columns;
use super::lanes::{InSlot, LANES, Numbers, Operand, Slot, Uniform, WIDTH};
use super::steps::{Code, Run, Same, Step};
use super::table::Table;
use crate::interpret::constants::holds;
use crate::interpret::prepared::Failed;
use crate::program::VANISHING;
use hodograph_model::arithmetic::{call, call2, mul_add};

/// The work space of a batch.
#[derive(Debug)]
pub struct Scratch {
    slots: Vec<Slot>,
    uniforms: Vec<f64>,
    same: Vec<f64>,
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
const ZERO: Slot = Slot::of(0.0);

impl Scratch {
    pub(super) fn new(columns: &Columns) -> Self {
        let uniforms: Vec<f64> = columns.uniforms.iter().map(|(_, number)| *number).collect();
        let mut results = vec![ZERO; columns.len];
        for &(place, uniform) in &columns.uniform_results {
            results[place] = Slot::of(uniforms[uniform as usize]);
        }
        let slots = vec![ZERO; columns.slots];
        let number = |same: &Same| match *same {
            Same::Uniform(uniform) => uniforms[uniform as usize],
            Same::Number(number) => number,
        };
        let same = columns.same.iter().map(number).collect();
        Scratch {
            slots,
            uniforms,
            same,
            results,
            failures: [None; LANES],
            failed: [NONE; LANES],
            finite: ZERO,
        }
    }
}

/// The states of a block that are evaluated.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) columns: &'a Columns,
    pub(super) table: &'a Table<'a>,
    pub(super) first: usize,
    pub(super) count: usize,
    pub(super) scratch: &'a mut Scratch,
}

/// Compiled once for each set of vector instructions; the bits do not depend on them.
#[cfg(target_arch = "x86_64")]
impl pulp::WithSimd for Task<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.execute();
    }
}

impl Task<'_> {
    /// Evaluates the states by the widest vector instructions that the processor has.
    pub(super) fn run(self) {
        #[cfg(target_arch = "x86_64")]
        pulp::Arch::new().dispatch(self);
        #[cfg(not(target_arch = "x86_64"))]
        self.execute();
    }

    /// Evaluates the states by the instructions for which the caller is compiled.
    #[inline(always)]
    pub(super) fn execute(self) {
        let Task { columns, table, first, count, scratch } = self;
        scratch.failed = [NONE; LANES];
        scratch.finite = ZERO;
        for Run { code, steps } in &columns.runs {
            match *code {
                Code::Load(input) => {
                    for step in steps {
                        table.gather(input, first, count, &mut scratch.slots[step.to as usize]);
                    }
                }
                Code::Chain => {
                    Numbers { slots: &mut scratch.slots, uniforms: &scratch.same }
                        .chain(steps, &columns.terms);
                }
                Code::Result => steps.iter().for_each(|step| scratch.keep(step)),
                Code::NotZeroS => scratch.check::<InSlot, InSlot>(steps, false),
                Code::NotSmallSS => scratch.check::<InSlot, InSlot>(steps, true),
                Code::NotSmallSU => scratch.check::<InSlot, Uniform>(steps, true),
                Code::NotSmallUS => scratch.check::<Uniform, InSlot>(steps, true),
                code => {
                    compute(code, steps, Numbers { slots: &mut scratch.slots, uniforms: &scratch.uniforms })
                }
            }
        }
        for (lane, failure) in scratch.failures.iter_mut().enumerate() {
            let (check, singular) = scratch.failed[lane];
            *failure = match columns.guards.get(check as usize) {
                Some(&guard) if singular => Some(Failed::Singular(guard)),
                Some(_) => Some(Failed::NotFinite),
                None => (scratch.finite.0.as_flattened()[lane] != 0.0).then_some(Failed::NotFinite),
            };
        }
    }
}

impl Scratch {
    /// Keeps a result.
    #[inline(always)]
    fn keep(&mut self, step: &Step) {
        let result = self.slots[step.a as usize];
        self.results[step.to as usize] = result;
        for (sum, numbers) in self.finite.0.iter_mut().zip(&result.0) {
            for (sum, &number) in sum.iter_mut().zip(numbers) {
                *sum += number * 0.0;
            }
        }
    }

    /// Records the states in which values vanish, relative to scales if there are any. The failure that is
    /// reported is the one that [`crate::interpret::Prepared`] finds first.
    #[inline(always)]
    fn check<A: Operand, B: Operand>(&mut self, steps: &[Step], scaled: bool) {
        for step in steps {
            let (mut values, mut bounds) = (ZERO, ZERO);
            for part in 0..LANES / WIDTH {
                values.0[part] = A::at(step.a).part(&self.slots, &self.uniforms, part);
                if scaled {
                    let scale = B::at(step.b).part(&self.slots, &self.uniforms, part);
                    bounds.0[part] = scale.map(|scale| VANISHING * scale.abs());
                }
            }
            let pairs = || values.0.as_flattened().iter().zip(bounds.0.as_flattened());
            let above = pairs().fold(true, |above, (value, bound)| above & (value.abs() > *bound));
            if !above {
                for (failed, (&value, &bound)) in self.failed.iter_mut().zip(pairs()) {
                    if step.to < failed.0 && !holds(value, bound) {
                        *failed = (step.to, value.is_finite() && bound.is_finite());
                    }
                }
            }
        }
    }
}

/// Executes an operation; it agrees with [`crate::program::operate`] in doubles.
#[inline(always)]
fn compute(code: Code, steps: &[Step], mut on: Numbers<'_>) {
    use Code::*;
    use {InSlot as S, Uniform as U};
    let add = |a: f64, b: f64| a + b;
    let sub = |a: f64, b: f64| a - b;
    let mul = |a: f64, b: f64| a * b;
    let div = |a: f64, b: f64| a / b;
    let mul_sub = |a: f64, b: f64, c: f64| mul_add(a, b, -c);
    let neg_mul_add = |a: f64, b: f64, c: f64| mul_add(-a, b, c);
    match code {
        Neg => on.one::<S>(steps, |a| -a),
        Recip => on.one::<S>(steps, |a| 1.0 / a),
        SineCosine => on.sine_cosine(steps),
        AddSS => on.two::<S, S>(steps, add),
        AddSU => on.two::<S, U>(steps, add),
        SubSS => on.two::<S, S>(steps, sub),
        SubSU => on.two::<S, U>(steps, sub),
        SubUS => on.two::<U, S>(steps, sub),
        MulSS => on.two::<S, S>(steps, mul),
        MulSU => on.two::<S, U>(steps, mul),
        DivSS => on.two::<S, S>(steps, div),
        DivSU => on.two::<S, U>(steps, div),
        DivUS => on.two::<U, S>(steps, div),
        MulAddSSS => on.three::<S, S, S>(steps, mul_add),
        MulAddSUS => on.three::<S, U, S>(steps, mul_add),
        MulAddSSU => on.three::<S, S, U>(steps, mul_add),
        MulAddSUU => on.three::<S, U, U>(steps, mul_add),
        MulAddUUS => on.three::<U, U, S>(steps, mul_add),
        MulSubSSS => on.three::<S, S, S>(steps, mul_sub),
        MulSubSUS => on.three::<S, U, S>(steps, mul_sub),
        MulSubSSU => on.three::<S, S, U>(steps, mul_sub),
        MulSubSUU => on.three::<S, U, U>(steps, mul_sub),
        MulSubUUS => on.three::<U, U, S>(steps, mul_sub),
        NegMulAddSSS => on.three::<S, S, S>(steps, neg_mul_add),
        NegMulAddSUS => on.three::<S, U, S>(steps, neg_mul_add),
        NegMulAddSSU => on.three::<S, S, U>(steps, neg_mul_add),
        NegMulAddSUU => on.three::<S, U, U>(steps, neg_mul_add),
        NegMulAddUUS => on.three::<U, U, S>(steps, neg_mul_add),
        Call(function) => on.one::<S>(steps, |a| call(function, a)),
        CallSS(function) => on.two::<S, S>(steps, |a, b| call2(function, a, b)),
        CallSU(function) => on.two::<S, U>(steps, |a, b| call2(function, a, b)),
        CallUS(function) => on.two::<U, S>(steps, |a, b| call2(function, a, b)),
        Load(_) | Chain | Result | NotZeroS | NotSmallSS | NotSmallSU | NotSmallUS => {}
    }
}
