//! Builds a program operation by operation: equal operations become one value, constants are folded,
//! negations are absorbed where possible.

use std::collections::HashMap;

use super::operation::{Bits, Operation, Stage, Value};
use hodograph_model::arithmetic::Function;
use hodograph_model::arithmetic::reproducible;

/// A program under construction.
#[derive(Debug, Default)]
pub struct Builder {
    operations: Vec<Operation>,
    stages: Vec<Stage>,
    known: HashMap<Operation, Value>,
}

impl Builder {
    /// The operations, in order.
    pub fn finish(self) -> Vec<Operation> {
        self.operations
    }

    /// The operation of a value.
    pub fn operation(&self, value: Value) -> Operation {
        self.operations[value.index()]
    }

    /// The stage of a value.
    pub fn stage(&self, value: Value) -> Stage {
        self.stages[value.index()]
    }

    /// The number of a value, if it is a constant.
    pub fn number(&self, value: Value) -> Option<f64> {
        match self.operation(value) {
            Operation::Constant(bits) => Some(bits.get()),
            _ => None,
        }
    }

    /// Appends an operation, unless an equal one exists already.
    pub fn push(&mut self, operation: Operation) -> Value {
        if let Some(&value) = self.known.get(&operation) {
            return value;
        }
        let value = Value(self.operations.len() as u32);
        self.stages.push(Stage::of(operation, |operand| self.stages[operand.index()]));
        self.operations.push(operation);
        self.known.insert(operation, value);
        value
    }

    /// A number.
    pub fn constant(&mut self, number: f64) -> Value {
        self.push(Operation::Constant(Bits::new(number)))
    }

    /// -a
    pub fn neg(&mut self, a: Value) -> Value {
        match self.operation(a) {
            Operation::Constant(bits) => self.constant(-bits.get()),
            Operation::Neg(b) => b,
            Operation::Sub(b, c) if self.known.contains_key(&Operation::Sub(c, b)) => {
                self.push(Operation::Sub(c, b))
            }
            _ => self.push(Operation::Neg(a)),
        }
    }

    /// a + b
    pub fn add(&mut self, a: Value, b: Value) -> Value {
        match (self.number(a), self.number(b)) {
            (Some(x), Some(y)) => self.constant(x + y),
            (Some(0.0), _) => b,
            (_, Some(0.0)) => a,
            _ => match (self.operation(a), self.operation(b)) {
                (_, Operation::Neg(c)) => self.sub(a, c),
                (Operation::Neg(c), _) => self.sub(b, c),
                _ => self.push(Operation::Add(a.min(b), a.max(b))),
            },
        }
    }

    /// a - b
    pub fn sub(&mut self, a: Value, b: Value) -> Value {
        match (self.number(a), self.number(b)) {
            (Some(x), Some(y)) => self.constant(x - y),
            (Some(0.0), _) => self.neg(b),
            (_, Some(0.0)) => a,
            _ if a == b => self.constant(0.0),
            _ => match self.operation(b) {
                Operation::Neg(c) => self.add(a, c),
                _ => self.push(Operation::Sub(a, b)),
            },
        }
    }

    /// a * b
    pub fn mul(&mut self, a: Value, b: Value) -> Value {
        match (self.number(a), self.number(b)) {
            (Some(x), Some(y)) => self.constant(x * y),
            (Some(0.0), _) | (_, Some(0.0)) => self.constant(0.0),
            (Some(1.0), _) => b,
            (_, Some(1.0)) => a,
            (Some(-1.0), _) => self.neg(b),
            (_, Some(-1.0)) => self.neg(a),
            _ => self.push(Operation::Mul(a.min(b), a.max(b))),
        }
    }

    /// a / b; a division by a number becomes a multiplication where that is exact.
    pub fn div(&mut self, a: Value, b: Value) -> Value {
        match (self.number(a), self.number(b)) {
            (Some(x), Some(y)) => self.constant(x / y),
            (_, Some(1.0)) => a,
            (_, Some(y)) => {
                let reciprocal = self.constant(1.0 / y);
                self.mul(a, reciprocal)
            }
            (Some(1.0), _) => self.recip(b),
            _ => self.push(Operation::Div(a, b)),
        }
    }

    /// 1 / a
    pub fn recip(&mut self, a: Value) -> Value {
        match self.number(a) {
            Some(x) => self.constant(1.0 / x),
            None => self.push(Operation::Recip(a)),
        }
    }

    /// a^n for n > 0, by repeated squaring.
    pub fn power(&mut self, a: Value, n: u32) -> Value {
        match n {
            0 => self.constant(1.0),
            1 => a,
            _ => {
                let half = self.power(a, n / 2);
                let square = self.mul(half, half);
                if n.is_multiple_of(2) { square } else { self.mul(square, a) }
            }
        }
    }

    /// The sine or the cosine of a value, taken from their common operation.
    pub fn sin_cos(&mut self, sine: bool, a: Value) -> Value {
        let pair = self.push(Operation::SinCos(a));
        self.push(if sine { Operation::Sine(pair) } else { Operation::Cosine(pair) })
    }

    /// A function of one value.
    pub fn call(&mut self, function: Function, a: Value) -> Value {
        match self.number(a) {
            Some(x) => self.constant(reproducible::call(function, x)),
            None => self.push(Operation::Call(function, a)),
        }
    }

    /// A function of two values.
    pub fn call2(&mut self, function: Function, a: Value, b: Value) -> Value {
        match (self.number(a), self.number(b)) {
            (Some(x), Some(y)) => self.constant(reproducible::call2(function, x, y)),
            _ => self.push(Operation::Call2(function, a, b)),
        }
    }
}
