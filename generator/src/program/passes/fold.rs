//! Folds what is known at build time: exactly while it is rational, then in doubles.

use num_rational::BigRational;

use super::{Survey, rebuild, rewrite};
use crate::number::Number;
use crate::program::arithmetic::{call, call2};
use crate::program::graph::{Graph, Node, Value};
use crate::program::operation::Stage;
use crate::program::routine::Derived;

/// Exact numbers longer than this many bits are rounded to doubles.
const LONGEST: u64 = 512;

/// Folds constants.
pub fn fold(derived: &Derived) -> Derived {
    let survey = Survey::new(derived);
    rewrite(derived, &survey, |graph, old, renamed| {
        let value = derived.graph.value(old);
        let node = rebuild(graph, value, renamed);
        if survey.stage(old) > Stage::Constant {
            return node;
        }
        let number = match graph.value(node) {
            Value::Pi => Some(std::f64::consts::PI),
            Value::Number(number) if bits(number) > LONGEST => Some(number.to_f64()),
            Value::Call(function, arguments) => match arguments[..] {
                [a] => double(graph, a).map(|a| call(*function, a)),
                [a, b] => double(graph, a).zip(double(graph, b)).map(|(a, b)| call2(*function, a, b)),
                _ => None,
            },
            _ => None,
        };
        // What is not finite stays as it is: it becomes an error when it is evaluated.
        match number.and_then(BigRational::from_float) {
            Some(number) => graph.number(Number(number)),
            None => node,
        }
    })
}

fn bits(number: &Number) -> u64 {
    number.0.numer().bits() + number.0.denom().bits()
}

fn double(graph: &Graph, node: Node) -> Option<f64> {
    graph.as_number(node).map(Number::to_f64)
}
