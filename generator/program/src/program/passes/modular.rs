//! Evaluates the operations of a program modulo a prime.

use num_rational::BigRational;

use crate::program::operation::{Operation, Value};
use crate::program::straight_line::Program;
use hodograph_model::arithmetic::Function;
use hodograph_model::graph::modular::functions::{Parts, Values, call, unknown};
use hodograph_model::graph::modular::residue::Residue;
use hodograph_model::graph::modular::{Evaluate, Residues};
use hodograph_model::number::Number;

impl Program {
    /// The residues of every operation at random inputs; of a sine-cosine pair those of its angle.
    ///
    /// The computed rounding error of a sum of angles is 0 in exact arithmetic; it and the operations that
    /// compute it are kept as unknowns.
    pub(in crate::program::passes) fn residues(&self) -> Vec<Option<Residues>> {
        self.at_both()
    }
}

impl Evaluate for Program {
    fn at<const P: u64>(&self, place: u64) -> Vec<Option<Residue<P>>> {
        let mut values = Operations { program: self, residues: Vec::with_capacity(self.operations.len()) };
        for (index, &operation) in self.operations.iter().enumerate() {
            let residue = match is_rounding(self, operation) {
                true => Some(Residue::arbitrary(&[place, 4 << 32, index as u64])),
                false => values.of(operation, place),
            };
            values.residues.push(residue);
        }
        values.residues
    }
}

/// The operations of a program that are evaluated so far.
struct Operations<'a, const P: u64> {
    program: &'a Program,
    residues: Vec<Option<Residue<P>>>,
}

impl<const P: u64> Operations<'_, P> {
    fn of(&self, operation: Operation, place: u64) -> Option<Residue<P>> {
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

impl<const P: u64> Values<P> for Operations<'_, P> {
    fn residue(&self, value: usize) -> Option<Residue<P>> {
        self.residues[value]
    }

    fn parts(&self, value: usize) -> Option<Parts<P>> {
        let operation = self.program.operations[value];
        let times = |sign: i64, value: Value| (Number::integer(sign), value.index());
        // a product with a constant factor
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

/// Whether it belongs to the computation of the rounding error of a sum t = a + b (Knuth's two-sum): the part
/// of b in t, t - a, or the errors of a and of b, `a - (t - (t - a))` and `b - (t - a)`. These operations are
/// not fused ([`super::contract`]).
fn is_rounding(program: &Program, operation: Operation) -> bool {
    let (first, second) = match operation {
        Operation::Add(a, b) | Operation::Sub(a, b) => (a, b),
        _ => return false,
    };
    let is_term = |term: Value, total: Value| match program.operation(total) {
        Operation::Add(a, b) | Operation::Sub(a, b) => term == a || term == b,
        _ => false,
    };
    let is_part = matches!(operation, Operation::Sub(..)) && is_term(second, first);
    let is_left = |term: Value, part: Value| match program.operation(part) {
        Operation::Sub(total, other) => {
            let again = matches!(program.operation(other), Operation::Sub(t, _) if t == total);
            again || is_term(term, total) || is_term(other, total)
        }
        _ => false,
    };
    is_part || is_left(first, second) || is_left(second, first)
}
