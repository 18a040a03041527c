//! Sines, cosines and exponentials of residues, which obey their addition theorems.
//!
//! An argument is written as a sum of multiples c x of values x that are no sums. To each x belongs an
//! arbitrary residue z(x) that stands for e^(i x / D), so that e^(i c x) is z(x)^(c D) where c D is an
//! integer, and the product of these is that of the sum. Then cos
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
/// Beyond this magnitude a multiple c D of a value counts as a value by itself: powers of a residue repeat.
const GREATEST: i128 = 1 << 48;
/// An argument with more parts counts as one value.
const LARGEST: usize = 4096;

/// What an argument of a function is a sum of.
pub enum Parts<const P: u64> {
    /// multiples of other values
    Sum(Vec<(Number, usize)>),
    /// this multiple of a value with this residue
    Multiple(Number, Residue<P>),
}

/// Values, as their functions see them.
pub trait Values<const P: u64> {
    /// The residue of a value.
    fn residue(&self, value: usize) -> Option<Residue<P>>;

    /// What the value is a sum of; `None` where that is not known.
    fn parts(&self, value: usize) -> Option<Parts<P>>;
}

/// A function of one value at a place. Of a function with branches it is an unknown.
pub fn call<const P: u64>(
    values: &impl Values<P>,
    function: Function,
    value: usize,
    place: u64,
) -> Option<Residue<P>> {
    use Function::*;
    let half = Residue::integer(2).reciprocal()?;
    let circular = || {
        let z = exponential(values, value, true, place)?;
        let (inverse, i) = (z.reciprocal()?, Residue::imaginary());
        Some(((z + inverse) * half, (z - inverse) * half * i.reciprocal()?))
    };
    let hyperbolic = || {
        let e = exponential(values, value, false, place)?;
        let inverse = e.reciprocal()?;
        Some(((e + inverse) * half, (e - inverse) * half))
    };
    let quotient = |(cosine, sine): (Residue<P>, Residue<P>)| Some(sine * cosine.reciprocal()?);
    match function {
        Sin => circular().map(|(_, sine)| sine),
        Cos => circular().map(|(cosine, _)| cosine),
        Tan => circular().and_then(quotient),
        Exp => exponential(values, value, false, place),
        Sinh => hyperbolic().map(|(_, sine)| sine),
        Cosh => hyperbolic().map(|(cosine, _)| cosine),
        Tanh => hyperbolic().and_then(quotient),
        Frozen => values.residue(value),
        Asin | Acos | Atan | Atan2 | Sqrt | Log | Abs | Sign | Min | Max => {
            Some(unknown(function, &[values.residue(value)?], place))
        }
    }
}

/// An unknown that belongs to a function and its arguments.
pub fn unknown<const P: u64>(function: Function, arguments: &[Residue<P>], place: u64) -> Residue<P> {
    let mut seed = vec![place, 1 << 32 | function as u64];
    seed.extend(arguments.iter().map(|argument| argument.number()));
    Residue::arbitrary(&seed)
}

/// What stands for e^(i x) or e^x.
fn exponential<const P: u64>(
    values: &impl Values<P>,
    value: usize,
    imaginary: bool,
    place: u64,
) -> Option<Residue<P>> {
    let mut product = Residue::ONE;
    for (residue, multiple) in terms(values, value)? {
        let whole = &multiple * BigInt::from(DENOMINATOR);
        let exponent = whole.is_integer().then(|| whole.to_integer().to_i128()).flatten();
        let factor = match exponent.filter(|exponent| exponent.abs() <= GREATEST) {
            _ if multiple.is_zero() || residue == Residue::ZERO => Residue::ONE,
            Some(exponent) => of_value(residue, imaginary, place).power(exponent),
            // the multiple is a value by itself
            None => {
                let itself = Residue::rational(&Number(multiple))? * residue;
                of_value(itself, imaginary, place).power(i128::from(DENOMINATOR))
            }
        };
        product = product * factor;
    }
    Some(product)
}

/// z(x) of a value x: that of -x is its reciprocal.
fn of_value<const P: u64>(residue: Residue<P>, imaginary: bool, place: u64) -> Residue<P> {
    let positive = residue.min(-residue);
    let z = Residue::arbitrary(&[place, 2 << 32 | u64::from(imaginary), positive.number()]);
    if positive == residue { z } else { z.power(-1) }
}

/// A value as a sum of multiples of values that are no sums, which stand for themselves by their residues; of
/// one and the same value, and of its opposite, there is one multiple.
fn terms<const P: u64>(values: &impl Values<P>, value: usize) -> Option<BTreeMap<Residue<P>, BigRational>> {
    let mut sum: BTreeMap<Residue<P>, BigRational> = BTreeMap::new();
    let mut open = vec![(BigRational::one(), value)];
    let mut seen = 0;
    while let Some((multiple, part)) = open.pop() {
        seen += 1;
        if seen > LARGEST {
            return Some(BTreeMap::from([(values.residue(value)?, BigRational::one())]));
        }
        let (term, own) = match values.parts(part)? {
            Parts::Sum(parts) => {
                open.extend(parts.into_iter().map(|(factor, part)| (&multiple * factor.0, part)));
                continue;
            }
            Parts::Multiple(Number(own), residue) if residue > -residue => (-residue, -own),
            Parts::Multiple(Number(own), residue) => (residue, own),
        };
        *sum.entry(term).or_insert_with(BigRational::zero) += multiple * own;
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::super::residue::FIRST_PRIME;
    use super::*;
    use crate::graph::{Graph, Input, Node};

    /// The residues of nodes that are made of two angles.
    fn residues(build: impl FnOnce(&mut Graph, Node, Node) -> Vec<Node>) -> Vec<Residue<FIRST_PRIME>> {
        let mut graph = Graph::new();
        let [x, y] = [0, 1].map(|index| graph.input(Input::Coordinate(index)));
        let nodes = build(&mut graph, x, y);
        let residues = graph.residues();
        nodes.into_iter().map(|node| residues[node.0 as usize].expect("a residue").0).collect()
    }

    /// A multiple of a node.
    fn times(graph: &mut Graph, n: i64, d: i64, node: Node) -> Node {
        let number = graph.number(Number::ratio(n, d));
        graph.intern(crate::graph::NodeKind::Product(vec![number, node]))
    }

    fn of(graph: &mut Graph, function: Function, node: Node) -> Node {
        graph.intern(crate::graph::NodeKind::Call(function, vec![node]))
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
    fn large_multiples_are_not_lost() {
        // 2^60 - 1 and more: powers of a residue repeat
        let found = residues(|graph, x, _| {
            let multiples = [(1 << 60) - 1, i64::MAX, 76_861_433_622_560_768];
            multiples.map(|n| times(graph, n, 1, x)).map(|angle| of(graph, Function::Cos, angle)).to_vec()
        });
        for (i, a) in found.iter().enumerate() {
            assert!(*a != Residue::ONE && found[..i].iter().all(|b| a != b), "{i}");
        }
    }

    #[test]
    fn what_is_not_known_spreads() {
        let mut graph = Graph::new();
        let (x, zero) = (graph.input(Input::Coordinate(0)), graph.integer(0));
        let infinite = graph.intern(crate::graph::NodeKind::Power(zero, -1));
        let sine = of(&mut graph, Function::Sin, infinite);
        let sum = graph.intern(crate::graph::NodeKind::Sum(vec![sine, x]));
        let residues = graph.residues();
        assert!([infinite, sine, sum].iter().all(|node| residues[node.0 as usize].is_none()));
        assert!(residues[x.0 as usize].is_some());
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
