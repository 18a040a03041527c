//! The operations of a program modulo a prime.

use num_rational::BigRational;

use super::functions::{Parts, Values, call, unknown};
use super::residue::Residue;
use super::{Residues, at_all_places};
use crate::arithmetic::Function;
use crate::number::Number;
use crate::program::graph::Input;
use crate::program::operation::{Operation, Value};
use crate::program::straight_line::Program;

impl Input {
    /// What stands for it at a place.
    pub(super) fn residue(self, place: u64) -> Residue {
        let (kind, index) = match self {
            Input::Time => (0, 0),
            Input::Parameter(index) => (1, index),
            Input::Coordinate(index) => (2, index),
            Input::Speed(index) => (3, index),
            Input::Input(index) => (4, index),
            Input::Acceleration(index) => (5, index),
            Input::Tangent(index) => (6, index),
        };
        Residue::arbitrary(&[place, kind, u64::from(index)])
    }
}

impl Program {
    /// What every operation is at arbitrary inputs, of a pair of sine and cosine the angle.
    ///
    /// What rounding takes from a sum of angles is 0 in exact arithmetic; it is kept as an unknown.
    pub(in crate::program::passes) fn residues(&self) -> Vec<Option<Residues>> {
        at_all_places(|place| {
            let mut values =
                Operations { program: self, residues: Vec::with_capacity(self.operations.len()) };
            for (index, &operation) in self.operations.iter().enumerate() {
                let residue = match is_rounding(self, operation) {
                    true => Some(Residue::arbitrary(&[place, 4 << 32, index as u64])),
                    false => values.of(operation, place),
                };
                values.residues.push(residue);
            }
            values.residues
        })
    }
}

/// The first operations of a program.
struct Operations<'a> {
    program: &'a Program,
    residues: Vec<Option<Residue>>,
}

impl Operations<'_> {
    fn of(&self, operation: Operation, place: u64) -> Option<Residue> {
        let at = |value: Value| self.residues[value.index()];
        let function = |function: Function, value: Value| call(self, function, value.index(), place);
        match operation {
            Operation::Constant(bits) => Residue::double(bits.get()),
            Operation::Input(input) => Some(input.residue(place)),
            Operation::Neg(a) => Some(-at(a)?),
            Operation::Add(a, b) => Some(at(a)? + at(b)?),
            Operation::Sub(a, b) => Some(at(a)? - at(b)?),
            Operation::Mul(a, b) => Some(at(a)? * at(b)?),
            Operation::Div(a, b) => Some(at(a)? * at(b)?.reciprocal()?),
            Operation::Recip(a) => at(a)?.reciprocal(),
            Operation::MulAdd(a, b, c) => Some(at(a)? * at(b)? + at(c)?),
            Operation::MulSub(a, b, c) => Some(at(a)? * at(b)? - at(c)?),
            Operation::NegMulAdd(a, b, c) => Some(at(c)? - at(a)? * at(b)?),
            Operation::SinCos(a) => at(a),
            Operation::Sine(pair) => function(Function::Sin, pair),
            Operation::Cosine(pair) => function(Function::Cos, pair),
            Operation::Call(name, a) => function(name, a),
            Operation::Call2(name, a, b) => Some(unknown(name, &[at(a)?, at(b)?], place)),
        }
    }

    /// A constant as a rational number.
    fn constant(&self, value: Value) -> Option<Number> {
        match self.program.operation(value) {
            Operation::Constant(bits) => BigRational::from_float(bits.get()).map(Number),
            _ => None,
        }
    }
}

impl Values for Operations<'_> {
    fn residue(&self, value: usize) -> Option<Residue> {
        self.residues[value]
    }

    fn parts(&self, value: usize) -> Option<Parts> {
        let operation = self.program.operations[value];
        let times = |sign: i64, value: Value| (Number::integer(sign), value.index());
        // a multiple by a constant
        let product = |a: Value, b: Value| {
            let by = |a: Value, b: Value| Some((self.constant(a)?, b.index()));
            by(a, b).or_else(|| by(b, a))
        };
        let sum = match operation {
            _ if is_rounding(self.program, operation) => None,
            Operation::Constant(_) => {
                return Some(Parts::Multiple(self.constant(Value(value as u32))?, Residue::ONE));
            }
            Operation::Neg(a) => Some(vec![times(-1, a)]),
            Operation::SinCos(a) => Some(vec![times(1, a)]),
            Operation::Add(a, b) => Some(vec![times(1, a), times(1, b)]),
            Operation::Sub(a, b) => Some(vec![times(1, a), times(-1, b)]),
            Operation::Mul(a, b) => product(a, b).map(|part| vec![part]),
            Operation::MulAdd(a, b, c) => product(a, b).map(|part| vec![part, times(1, c)]),
            Operation::MulSub(a, b, c) => product(a, b).map(|part| vec![part, times(-1, c)]),
            Operation::NegMulAdd(a, b, c) => {
                product(a, b).map(|(Number(factor), part)| vec![(Number(-factor), part), times(1, c)])
            }
            _ => None,
        };
        Some(match sum {
            Some(parts) => Parts::Sum(parts),
            None => Parts::Multiple(Number::integer(1), self.residues[value]?),
        })
    }
}

/// Whether it is a part of what rounding takes from a sum, `a - (t - (t - a))` where t is a sum with a,
/// however its operations are fused.
fn is_rounding(program: &Program, operation: Operation) -> bool {
    let (first, second) = match operation {
        Operation::Add(a, b) | Operation::Sub(a, b) => (a, b),
        Operation::MulAdd(_, _, c) | Operation::MulSub(_, _, c) | Operation::NegMulAdd(_, _, c) => (c, c),
        _ => return false,
    };
    let returns = |term: Value, part: Value| match program.operation(part) {
        Operation::Sub(total, other) => {
            let mut parts = program.operation(total).operands();
            let again = matches!(program.operation(other), Operation::Sub(t, _) if t == total);
            again || parts.any(|part| part == term || part == other)
        }
        _ => false,
    };
    returns(first, second) || returns(second, first)
}
