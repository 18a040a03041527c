//! The operations of some quantities, ordered so that operations of the same kind follow each other as far as their
//! operands allow. The kind is then decided once for a run of operations, not for each of them.
//!
//! The order changes no bits: every operation has the operands that the program gives it.

use std::collections::VecDeque;

use super::constants::Constants;
use crate::program::graph::Input;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::slopes::slopes;
use crate::program::{Program, Slice};
use hodograph_model::arithmetic::{Arithmetic, Function};

/// What the steps of a run do with their operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Code {
    Neg,
    Recip,
    Add,
    Sub,
    Mul,
    Div,
    MulAdd,
    MulSub,
    NegMulAdd,
    /// has two results, the sine and the cosine
    SinCos,
    Call(Function),
    Call2(Function),
}

impl Code {
    /// The operation of a step on the numbers at these places.
    fn operation(self, step: Step) -> Operation {
        let [a, b, c] = step.map(Value);
        match self {
            Code::Neg => Operation::Neg(a),
            Code::Recip => Operation::Recip(a),
            Code::Add => Operation::Add(a, b),
            Code::Sub => Operation::Sub(a, b),
            Code::Mul => Operation::Mul(a, b),
            Code::Div => Operation::Div(a, b),
            Code::MulAdd => Operation::MulAdd(a, b, c),
            Code::MulSub => Operation::MulSub(a, b, c),
            Code::NegMulAdd => Operation::NegMulAdd(a, b, c),
            Code::SinCos => Operation::SinCos(a),
            Code::Call(function) => Operation::Call(function, a),
            Code::Call2(function) => Operation::Call2(function, a, b),
        }
    }
}

/// Places of the operands.
type Step = [u32; 3];

/// Steps with the same code. Their results follow each other.
#[derive(Clone, Debug)]
struct Run {
    code: Code,
    /// index of the first step, and of the first beyond
    steps: (usize, usize),
}

/// Operations in the order in which they are executed, on numbers in this order: constants, inputs, results.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// the values that depend on parameters alone and are used
    constants: Vec<Value>,
    /// in the order of the numbers after the constants
    inputs: Vec<Input>,
    steps: Vec<Step>,
    runs: Vec<Run>,
    /// number of numbers
    size: usize,
}

/// The places of values among the numbers of a schedule.
pub struct Places(Vec<usize>);

impl Places {
    /// The place of a value of the slice.
    pub fn of(&self, value: Value) -> usize {
        self.0[value.index()]
    }
}

impl Schedule {
    /// Orders the operations of a slice.
    pub fn new(program: &Program, constants: &Constants, slice: &Slice<'_>) -> (Self, Places) {
        let late = |value: Value| constants.stage(value) > Stage::Parameter;
        let mut places = vec![usize::MAX; program.operations.len()];
        let mut schedule = Schedule {
            constants: Vec::new(),
            inputs: Vec::new(),
            steps: Vec::new(),
            runs: Vec::new(),
            size: 0,
        };
        let of_guards = slice.guards.iter().flat_map(|guard| std::iter::once(guard.value).chain(guard.scale));
        let of_outputs = slice.outputs.iter().flat_map(|output| output.values.iter().copied());
        let operands = slice.order.iter().filter(|&&value| late(value));
        let operands = operands.flat_map(|&value| program.operation(value).operands());
        for value in operands.chain(of_guards).chain(of_outputs).filter(|&value| !late(value)) {
            if places[value.index()] == usize::MAX {
                places[value.index()] = schedule.constants.len();
                schedule.constants.push(value);
            }
        }
        schedule.size = schedule.constants.len();
        for &value in slice.order.iter().filter(|&&value| late(value)) {
            if let Operation::Input(input) = program.operation(value) {
                places[value.index()] = schedule.size;
                schedule.size += 1;
                schedule.inputs.push(input);
            }
        }
        schedule.append_runs(program, slice, late, &mut places);
        (schedule, Places(places))
    }

    /// Appends runs: always the code of which most steps have all operands, and of it all that come to have them.
    fn append_runs(
        &mut self,
        program: &Program,
        slice: &Slice<'_>,
        late: impl Fn(Value) -> bool,
        places: &mut [usize],
    ) {
        // Sines and cosines have the places that their pair gives them.
        let pair = |value: Value| match program.operation(value) {
            Operation::Sine(pair) | Operation::Cosine(pair) => pair,
            _ => value,
        };
        let mut missing = vec![0_usize; program.operations.len()];
        let mut users: Vec<Vec<Value>> = vec![Vec::new(); program.operations.len()];
        let mut ready: Vec<(Code, VecDeque<Value>)> = Vec::new();
        let mut parts: Vec<Vec<Value>> = vec![Vec::new(); program.operations.len()];
        for &value in slice.order.iter().filter(|&&value| late(value)) {
            let operation = program.operation(value);
            if let Operation::Sine(pair) | Operation::Cosine(pair) = operation {
                parts[pair.index()].push(value);
                continue;
            }
            let Some(code) = code_of(operation) else { continue };
            for operand in operation.operands().map(pair) {
                if late(operand) && !matches!(program.operation(operand), Operation::Input(_)) {
                    missing[value.index()] += 1;
                    users[operand.index()].push(value);
                }
            }
            if missing[value.index()] == 0 {
                waiting(&mut ready, code).push_back(value);
            }
        }
        while let Some(code) = fullest(&ready) {
            let first = self.steps.len();
            while let Some(value) = waiting(&mut ready, code).pop_front() {
                let mut operands = program.operation(value).operands();
                let step = std::array::from_fn(|_| operands.next().map_or(0, |a| places[a.index()] as u32));
                self.steps.push(step);
                places[value.index()] = self.size;
                for &part in &parts[value.index()] {
                    let is_cosine = matches!(program.operation(part), Operation::Cosine(_));
                    places[part.index()] = self.size + usize::from(is_cosine);
                }
                self.size += if code == Code::SinCos { 2 } else { 1 };
                for user in std::mem::take(&mut users[value.index()]) {
                    missing[user.index()] -= 1;
                    if missing[user.index()] == 0
                        && let Some(code) = code_of(program.operation(user))
                    {
                        waiting(&mut ready, code).push_back(user);
                    }
                }
            }
            self.runs.push(Run { code, steps: (first, self.steps.len()) });
        }
    }

    /// The values that come first among the numbers.
    pub fn constants(&self) -> &[Value] {
        &self.constants
    }

    /// Computes all numbers, of which the first are the constants.
    pub fn execute<N: Arithmetic>(&self, constants: &[N], input: impl Fn(Input) -> N) -> Vec<N> {
        let mut numbers = Vec::with_capacity(self.size);
        numbers.extend_from_slice(constants);
        numbers.extend(self.inputs.iter().map(|&of| input(of)));
        let mut at = numbers.len();
        numbers.resize(self.size, N::exactly(0.0));
        for Run { code, steps } in &self.runs {
            let steps = &self.steps[steps.0..steps.1];
            let to = (at, &mut numbers[..]);
            at += if *code == Code::SinCos { 2 * steps.len() } else { steps.len() };
            match *code {
                Code::Neg => one(to, steps, |a| -a),
                Code::Recip => one(to, steps, |a| N::exactly(1.0) / a),
                Code::Add => two(to, steps, |a, b| a + b),
                Code::Sub => two(to, steps, |a, b| a - b),
                Code::Mul => two(to, steps, |a, b| a * b),
                Code::Div => two(to, steps, |a, b| a / b),
                Code::MulAdd => three(to, steps, |a, b, c| a.mul_add(b, c)),
                Code::MulSub => three(to, steps, |a, b, c| a.mul_add(b, -c)),
                Code::NegMulAdd => three(to, steps, |a, b, c| (-a).mul_add(b, c)),
                Code::SinCos => pairs(to, steps),
                Code::Call(function) => one(to, steps, |a| a.call(function)),
                Code::Call2(function) => two(to, steps, |a, b| a.call2(function, b)),
            }
        }
        numbers
    }
}

impl Schedule {
    /// The inputs, in the order of the numbers after the constants.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// Adds to the cotangents of all numbers what those of the results of steps contribute, from the last step to
    /// the first: the transpose of the derivative of [`Schedule::execute`]. `numbers` are those that it returned.
    pub fn transpose(&self, numbers: &[f64], cotangents: &mut [f64]) {
        let mut end = self.size;
        for Run { code, steps } in self.runs.iter().rev() {
            for &step in self.steps[steps.0..steps.1].iter().rev() {
                end -= if *code == Code::SinCos { 2 } else { 1 };
                let by = cotangents[end];
                if *code == Code::SinCos {
                    let change = by * numbers[end + 1] - cotangents[end + 1] * numbers[end];
                    cotangents[step[0] as usize] += change;
                    continue;
                }
                // What does not depend on a value has no derivative by it, even where its slope is infinite.
                if by != 0.0 {
                    let operation = code.operation(step);
                    slopes(
                        operation,
                        numbers[end],
                        |a| numbers[a.index()],
                        |a, slope| cotangents[a.index()] += by * slope,
                    );
                }
            }
        }
    }
}

/// The code of an operation; `None` for those that are no step.
fn code_of(operation: Operation) -> Option<Code> {
    Some(match operation {
        Operation::Constant(_) | Operation::Input(_) | Operation::Sine(_) | Operation::Cosine(_) => {
            return None;
        }
        Operation::Neg(_) => Code::Neg,
        Operation::Recip(_) => Code::Recip,
        Operation::Add(..) => Code::Add,
        Operation::Sub(..) => Code::Sub,
        Operation::Mul(..) => Code::Mul,
        Operation::Div(..) => Code::Div,
        Operation::MulAdd(..) => Code::MulAdd,
        Operation::MulSub(..) => Code::MulSub,
        Operation::NegMulAdd(..) => Code::NegMulAdd,
        Operation::SinCos(_) => Code::SinCos,
        Operation::Call(function, _) => Code::Call(function),
        Operation::Call2(function, ..) => Code::Call2(function),
    })
}

/// The steps of a code that have all their operands.
fn waiting(ready: &mut Vec<(Code, VecDeque<Value>)>, code: Code) -> &mut VecDeque<Value> {
    let place = ready.iter().position(|(known, _)| *known == code).unwrap_or_else(|| {
        ready.push((code, VecDeque::new()));
        ready.len() - 1
    });
    &mut ready[place].1
}

/// The code of which most steps have all their operands, the first of several; `None` if there are no steps.
fn fullest(ready: &[(Code, VecDeque<Value>)]) -> Option<Code> {
    let most = ready.iter().rev().max_by_key(|(_, steps)| steps.len());
    most.filter(|(_, steps)| !steps.is_empty()).map(|(code, _)| *code)
}

/// Where the results of a run begin, and all numbers.
type To<'n, N> = (usize, &'n mut [N]);

#[inline(always)]
fn one<N: Arithmetic>((at, numbers): To<'_, N>, steps: &[Step], f: impl Fn(N) -> N) {
    for (k, &[a, ..]) in steps.iter().enumerate() {
        numbers[at + k] = f(numbers[a as usize]);
    }
}

#[inline(always)]
fn two<N: Arithmetic>((at, numbers): To<'_, N>, steps: &[Step], f: impl Fn(N, N) -> N) {
    for (k, &[a, b, _]) in steps.iter().enumerate() {
        numbers[at + k] = f(numbers[a as usize], numbers[b as usize]);
    }
}

#[inline(always)]
fn three<N: Arithmetic>((at, numbers): To<'_, N>, steps: &[Step], f: impl Fn(N, N, N) -> N) {
    for (k, &[a, b, c]) in steps.iter().enumerate() {
        numbers[at + k] = f(numbers[a as usize], numbers[b as usize], numbers[c as usize]);
    }
}

#[inline(always)]
fn pairs<N: Arithmetic>((at, numbers): To<'_, N>, steps: &[Step]) {
    for (k, &[a, ..]) in steps.iter().enumerate() {
        (numbers[at + 2 * k], numbers[at + 2 * k + 1]) = numbers[a as usize].sin_cos();
    }
}
