//! Sines, cosines and exponentials of residues, which obey their addition theorems.
//!
//! An argument is written as a sum of multiples c x of values x that are no sums. To each x belongs an
//! arbitrary residue z(x) that stands for e^(i x / D), so that e^(i c x) is z(x)^(c D) where c D is an
//! integer, and the product of these is that of the sum. For a multiple of pi it is a root of unity. Then cos
//! = (z + 1/z) / 2 and sin = (z - 1/z) / (2 i), where i is a root of -1. The real exponential is made in the
//! same way from residues of its own.

use std::collections::BTreeMap;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

use super::residue::Residue;
use crate::arithmetic::Function;
use crate::number::Number;

/// D: multiples of 1 / D of a value are seen to belong to it.
const DENOMINATOR: i64 = 5040;
/// An argument with more parts counts as one value.
const LARGEST: usize = 4096;

/// What an argument of a function is a sum of.
pub enum Parts {
    /// multiples of other values
    Sum(Vec<(Number, usize)>),
    /// this multiple of a value with this residue
    Multiple(Number, Residue),
    /// pi
    Pi,
}

/// Values, as their functions see them.
pub trait Values {
    /// The residue of a value.
    fn residue(&self, value: usize) -> Option<Residue>;

    /// What the value is a sum of; `None` where that is not known.
    fn parts(&self, value: usize) -> Option<Parts>;
}

/// What is no sum.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Term {
    Pi,
    Value(Residue),
}

/// A function of one value at a place. Of a function with branches it is an unknown.
pub fn call(values: &impl Values, function: Function, value: usize, place: u64) -> Option<Residue> {
    use Function::*;
    let half = Residue::integer(2).reciprocal()?;
    let circle = || {
        let z = exponential(values, value, true, place)?;
        let inverse = z.reciprocal()?;
        let imaginary = Residue::root_of_unity(1, 2)?;
        Some(((z + inverse) * half, (z - inverse) * half * imaginary.reciprocal()?))
    };
    let line = || {
        let e = exponential(values, value, false, place)?;
        let inverse = e.reciprocal()?;
        Some(((e + inverse) * half, (e - inverse) * half))
    };
    let quotient = |(cosine, sine): (Residue, Residue)| Some(sine * cosine.reciprocal()?);
    match function {
        Sin => circle().map(|(_, sine)| sine),
        Cos => circle().map(|(cosine, _)| cosine),
        Tan => circle().and_then(quotient),
        Exp => exponential(values, value, false, place),
        Sinh => line().map(|(_, sine)| sine),
        Cosh => line().map(|(cosine, _)| cosine),
        Tanh => line().and_then(quotient),
        Asin | Acos | Atan | Atan2 | Sqrt | Log | Abs | Sign | Min | Max => {
            Some(unknown(function, &[values.residue(value)?], place))
        }
    }
}

/// An unknown that belongs to a function and its arguments.
pub fn unknown(function: Function, arguments: &[Residue], place: u64) -> Residue {
    let mut seed = vec![place, 1 << 32 | function as u64];
    seed.extend(arguments.iter().map(|argument| argument.number()));
    Residue::arbitrary(&seed)
}

/// What stands for e^(i x) or e^x.
fn exponential(values: &impl Values, value: usize, imaginary: bool, place: u64) -> Option<Residue> {
    let mut product = Residue::ONE;
    for (term, multiple) in terms(values, value)? {
        let whole = &multiple * BigInt::from(DENOMINATOR);
        let factor = match term {
            _ if multiple.is_zero() => Residue::ONE,
            Term::Pi if imaginary => {
                Residue::root_of_unity(multiple.numer().to_i128()?, multiple.denom().to_u64()?)?
            }
            Term::Pi => return None,
            Term::Value(Residue::ZERO) => Residue::ONE,
            Term::Value(residue) => {
                match whole.is_integer().then(|| whole.to_integer().to_i128()).flatten() {
                    Some(exponent) => of_value(residue, imaginary, place).power(exponent),
                    None => {
                        let of_its_own = Residue::rational(&Number(multiple))? * residue;
                        of_value(of_its_own, imaginary, place).power(i128::from(DENOMINATOR))
                    }
                }
            }
        };
        product = product * factor;
    }
    Some(product)
}

/// z(x) of a value x: that of -x is its reciprocal.
fn of_value(residue: Residue, imaginary: bool, place: u64) -> Residue {
    let positive = residue.min(-residue);
    let z = Residue::arbitrary(&[place, 2 << 32 | u64::from(imaginary), positive.number()]);
    if positive == residue { z } else { z.power(-1) }
}

/// A value as a sum of multiples; of one and the same value, and of its opposite, there is one multiple.
fn terms(values: &impl Values, value: usize) -> Option<BTreeMap<Term, BigRational>> {
    let mut sum: BTreeMap<Term, BigRational> = BTreeMap::new();
    let mut open = vec![(BigRational::one(), value)];
    let mut seen = 0;
    while let Some((multiple, part)) = open.pop() {
        seen += 1;
        if seen > LARGEST {
            return Some(BTreeMap::from([(Term::Value(values.residue(value)?), BigRational::one())]));
        }
        let (term, own) = match values.parts(part)? {
            Parts::Sum(parts) => {
                open.extend(parts.into_iter().map(|(factor, part)| (&multiple * factor.0, part)));
                continue;
            }
            Parts::Multiple(Number(own), residue) if residue > -residue => (Term::Value(-residue), -own),
            Parts::Multiple(Number(own), residue) => (Term::Value(residue), own),
            Parts::Pi => (Term::Pi, BigRational::one()),
        };
        *sum.entry(term).or_insert_with(BigRational::zero) += multiple * own;
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::graph::{Graph, Input, Node};

    /// The residues of nodes that are made of two angles.
    fn residues(build: impl FnOnce(&mut Graph, Node, Node) -> Vec<Node>) -> Vec<Residue> {
        let mut graph = Graph::new();
        let [x, y] = [0, 1].map(|index| graph.input(Input::Coordinate(index)));
        let nodes = build(&mut graph, x, y);
        let residues = graph.residues();
        nodes.into_iter().map(|node| residues[node.0 as usize].expect("a residue")[0]).collect()
    }

    /// A multiple of a node.
    fn times(graph: &mut Graph, n: i64, d: i64, node: Node) -> Node {
        let number = graph.number(Number::ratio(n, d));
        graph.intern(crate::program::graph::NodeKind::Product(vec![number, node]))
    }

    fn of(graph: &mut Graph, function: Function, node: Node) -> Node {
        graph.intern(crate::program::graph::NodeKind::Call(function, vec![node]))
    }

    #[test]
    fn addition_theorems_hold() {
        use Function::*;
        let found = residues(|graph, x, y| {
            let half = times(graph, -1, 2, y);
            let angle = graph.sum([x, half]);
            let mut nodes = Vec::new();
            for function in [Sin, Cos, Sinh, Cosh, Tan, Tanh, Exp] {
                nodes.extend([x, half, angle].map(|node| of(graph, function, node)));
            }
            nodes
        });
        let [sin, cos, sinh, cosh, tan, tanh, exp] =
            std::array::from_fn(|function| std::array::from_fn::<_, 3, _>(|at| found[3 * function + at]));
        assert_eq!(sin[2], sin[0] * cos[1] + cos[0] * sin[1]);
        assert_eq!(cos[2], cos[0] * cos[1] - sin[0] * sin[1]);
        assert_eq!(sinh[2], sinh[0] * cosh[1] + cosh[0] * sinh[1]);
        assert_eq!(cosh[2], cosh[0] * cosh[1] + sinh[0] * sinh[1]);
        assert_eq!(exp[2], exp[0] * exp[1]);
        for at in 0..3 {
            assert_eq!(sin[at] * sin[at] + cos[at] * cos[at], Residue::ONE);
            assert_eq!(tan[at] * cos[at], sin[at]);
            assert_eq!(tanh[at] * cosh[at], sinh[at]);
            assert_eq!(exp[at], sinh[at] + cosh[at]);
        }
    }

    #[test]
    fn fractions_of_pi_have_their_values() {
        let found = residues(|graph, x, _| {
            let pi = graph.pi();
            let [sixth, right] = [6, 2].map(|d| times(graph, 1, d, pi));
            let shifted = graph.sum([x, right]);
            vec![
                of(graph, Function::Sin, sixth),
                of(graph, Function::Cos, right),
                of(graph, Function::Sin, shifted),
                of(graph, Function::Cos, x),
            ]
        });
        assert_eq!(found[0] * Residue::integer(2), Residue::ONE);
        assert_eq!(found[1], Residue::ZERO);
        assert_eq!(found[2], found[3]);
    }

    #[test]
    fn what_is_not_known_spreads() {
        let mut graph = Graph::new();
        let (x, pi) = (graph.input(Input::Coordinate(0)), graph.pi());
        let seventh = times(&mut graph, 1, 7, pi);
        let sine = of(&mut graph, Function::Sin, seventh);
        let sum = graph.sum([sine, x]);
        let residues = graph.residues();
        assert!(residues[seventh.0 as usize].is_some());
        assert!(residues[sine.0 as usize].is_none() && residues[sum.0 as usize].is_none());
    }

    #[test]
    fn other_angles_are_other_values() {
        let found = residues(|graph, x, y| {
            let angles = [times(graph, 2, 1, x), times(graph, 1, 11, x), x, y, times(graph, -1, 1, x)];
            angles.map(|angle| of(graph, Function::Cos, angle)).to_vec()
        });
        assert_eq!(found[2], found[4], "the cosine is even");
        for (i, a) in found.iter().enumerate().take(4) {
            assert!(found[..i].iter().all(|b| a != b), "{i}");
        }
    }
}
