//! Flattens nested sums of operations to lists of terms, and rebuilds them in another order.

use std::collections::HashMap;

use super::adjoint::Sensitivity;
use crate::program::operation::{Bits, Operation, Stage, Value};
use crate::program::straight_line::Program;

/// A term with its sign.
#[derive(Clone, Debug)]
pub struct Term {
    negative: bool,
    kind: TermKind,
}

#[derive(Clone, Debug)]
enum TermKind {
    Value(Value),
    Product(Value, Value),
    /// terms that are known at construction: their sum is one value
    Known(Vec<Term>),
}

impl Term {
    fn value(negative: bool, value: Value) -> Self {
        Term { negative, kind: TermKind::Value(value) }
    }

    fn product(negative: bool, a: Value, b: Value) -> Self {
        Term { negative, kind: TermKind::Product(a, b) }
    }

    /// Whether it is a product, which a fused operation adds without rounding it.
    pub fn is_product(&self) -> bool {
        matches!(self.kind, TermKind::Product(..))
    }

    /// Its value at a state.
    pub fn number(&self, state: &Sensitivity) -> f64 {
        let number = match &self.kind {
            TermKind::Value(value) => state.number(*value),
            TermKind::Product(a, b) => state.number(*a) * state.number(*b),
            TermKind::Known(terms) => terms.iter().map(|term| term.number(state)).sum(),
        };
        if self.negative { -number } else { number }
    }
}

/// Number of operations, outputs and guards that refer to each value.
fn uses(program: &Program) -> Vec<u32> {
    let mut uses = vec![0; program.operations.len()];
    let operands = program.operations.iter().flat_map(|operation| operation.operands());
    let outputs = program.outputs.iter().flat_map(|output| output.values.iter().copied());
    let guards = program.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten();
    operands.chain(outputs).chain(guards).for_each(|value| uses[value.index()] += 1);
    uses
}

/// The sums of a program.
pub struct Sums<'a> {
    program: &'a Program,
    stages: Vec<Stage>,
    uses: Vec<u32>,
}

/// A sum as a list of terms.
#[derive(Default)]
pub struct Sum {
    /// its terms
    pub terms: Vec<Term>,
    /// operations that only this sum uses
    pub inner: Vec<Value>,
}

impl<'a> Sums<'a> {
    /// The sums of a program.
    pub fn new(program: &'a Program) -> Self {
        Sums { program, stages: program.stages(), uses: uses(program) }
    }

    /// The stage of a value.
    pub fn stage(&self, value: Value) -> Stage {
        self.stages[value.index()]
    }

    /// The terms of a sum; a sum without terms for any other operation.
    pub fn open(&self, value: Value) -> Sum {
        let mut sum = Sum::default();
        self.take(value, &mut sum);
        let is_known = |term: &Term| match term.kind {
            TermKind::Value(value) => self.stages[value.index()] <= Stage::Parameter,
            _ => false,
        };
        if sum.terms.iter().filter(|term| is_known(term)).count() > 1 {
            let (known, late) = sum.terms.into_iter().partition(is_known);
            sum.terms = late;
            sum.terms.push(Term { negative: false, kind: TermKind::Known(known) });
        }
        sum
    }

    /// The two operands of a sum; `None` for any other operation.
    fn parts(&self, value: Value, negative: bool) -> Option<[Part; 2]> {
        let (rest, part) = match self.program.operation(value) {
            Operation::Add(a, b) => ((a, negative), Part::Value(negative, b)),
            Operation::Sub(a, b) => ((a, negative), Part::Value(!negative, b)),
            Operation::MulAdd(a, b, c) => ((c, negative), Part::Product(negative, a, b)),
            Operation::MulSub(a, b, c) => ((c, !negative), Part::Product(negative, a, b)),
            Operation::NegMulAdd(a, b, c) => ((c, negative), Part::Product(!negative, a, b)),
            _ => return None,
        };
        Some([Part::Value(rest.1, rest.0), part])
    }

    /// Flattens a sum. Sums may be nested very deep, so an explicit stack replaces recursion.
    fn take(&self, value: Value, sum: &mut Sum) {
        let mut left: Vec<Part> = self.parts(value, false).into_iter().flatten().rev().collect();
        while let Some(part) = left.pop() {
            let (negative, value) = match part {
                Part::Product(negative, a, b) => {
                    sum.terms.push(Term::product(negative, a, b));
                    continue;
                }
                Part::Value(negative, value) => (negative, value),
            };
            // Terms that are known at construction stay together.
            let alone = self.uses[value.index()] == 1 && self.stages[value.index()] > Stage::Parameter;
            let parts = match self.program.operation(value) {
                _ if !alone => None,
                Operation::Mul(a, b) => Some(vec![Part::Product(negative, a, b)]),
                _ => self.parts(value, negative).map(Vec::from),
            };
            match parts {
                Some(parts) => {
                    sum.inner.push(value);
                    left.extend(parts.into_iter().rev());
                }
                None => sum.terms.push(Term::value(negative, value)),
            }
        }
    }
}

/// A part of a sum that is still to be flattened, with its sign.
enum Part {
    Value(bool, Value),
    Product(bool, Value, Value),
}

/// The program with the sums of the plans in place of the old ones; equal operations become one.
pub fn rebuild(program: &Program, plans: &[Option<Vec<Term>>]) -> Program {
    let mut operations = Operations::default();
    let mut renamed: Vec<Value> = Vec::with_capacity(program.operations.len());
    for (&operation, plan) in program.operations.iter().zip(plans) {
        let of = |value: Value| renamed[value.index()];
        let new = match plan {
            None => operations.push(operation.map(of)),
            Some(terms) => match add_up(terms, &of, &mut operations) {
                (value, false) => value,
                (value, true) => operations.push(Operation::Neg(value)),
            },
        };
        renamed.push(new);
    }
    let of = |value: Value| renamed[value.index()];
    let mut new = Program { operations: operations.list, ..program.clone() };
    new.outputs.iter_mut().flat_map(|output| &mut output.values).for_each(|value| *value = of(*value));
    for guard in &mut new.guards {
        guard.value = of(guard.value);
        guard.scale = guard.scale.map(of);
    }
    new
}

#[derive(Default)]
struct Operations {
    list: Vec<Operation>,
    places: HashMap<Operation, Value>,
}

impl Operations {
    fn push(&mut self, operation: Operation) -> Value {
        *self.places.entry(operation).or_insert_with(|| {
            self.list.push(operation);
            Value(self.list.len() as u32 - 1)
        })
    }
}

/// Adds terms in this order and returns the sum, and whether it is negated. A sum of negative terms is
/// computed as the negative of a sum.
fn add_up(terms: &[Term], of: &impl Fn(Value) -> Value, operations: &mut Operations) -> (Value, bool) {
    let mut sum: Option<(Value, bool)> = None;
    for term in terms {
        let (value, minus) = match &term.kind {
            TermKind::Value(value) => (of(*value), term.negative),
            TermKind::Known(terms) => add_up(terms, of, operations),
            &TermKind::Product(a, b) => {
                let (a, b, minus) = (of(a), of(b), term.negative);
                let (operation, sign) = match sum {
                    None => (Operation::Mul(a, b), minus),
                    Some((before, false)) if minus => (Operation::NegMulAdd(a, b, before), false),
                    Some((before, true)) if !minus => (Operation::MulSub(a, b, before), false),
                    Some((before, sign)) => (Operation::MulAdd(a, b, before), sign),
                };
                sum = Some((operations.push(operation), sign));
                continue;
            }
        };
        sum = Some(match sum {
            None => (value, minus),
            Some(before) => add(before, (value, minus), operations),
        });
    }
    sum.unwrap_or_else(|| (operations.push(Operation::Constant(Bits::new(0.0))), false))
}

/// Adds two values with their signs; the sum of two constants is a constant.
fn add(a: (Value, bool), b: (Value, bool), operations: &mut Operations) -> (Value, bool) {
    if let (Operation::Constant(first), Operation::Constant(second)) =
        (operations.list[a.0.index()], operations.list[b.0.index()])
    {
        let signed = |number: Bits, negative| if negative { -number.get() } else { number.get() };
        let number = signed(first, a.1) + signed(second, b.1);
        return (operations.push(Operation::Constant(Bits::new(number.abs()))), number < 0.0);
    }
    let (operation, negative) = match (a.1, b.1) {
        (false, true) => (Operation::Sub(a.0, b.0), false),
        (true, false) => (Operation::Sub(b.0, a.0), false),
        (sign, _) => (Operation::Add(a.0, b.0), sign),
    };
    (operations.push(operation), negative)
}
