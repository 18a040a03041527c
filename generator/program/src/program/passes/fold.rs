//! Folds constants: exactly while they are rational, then in doubles.

use num_rational::BigRational;

use super::rewrite::{Survey, rebuild, rewrite};
use crate::program::derivation::Derived;
use crate::program::graph::{Graph, Node, NodeKind};
use crate::program::operation::Stage;
use hodograph_model::arithmetic::reproducible::{call, call2};
use hodograph_model::number::Number;

/// Exact numbers longer than this many bits are rounded to doubles.
const LONGEST: u64 = 512;

/// Folds constants.
pub fn fold(derived: &Derived) -> Derived {
    let survey = Survey::new(derived);
    rewrite(derived, &survey, |graph, old, renamed| {
        let value = derived.graph.kind(old);
        let node = rebuild(graph, value, renamed);
        if survey.stage(old) > Stage::Constant {
            return node;
        }
        let number = match graph.kind(node) {
            NodeKind::Pi => Some(std::f64::consts::PI),
            NodeKind::Number(number) if bits(number) > LONGEST => Some(number.to_f64()),
            NodeKind::Call(function, arguments) => match arguments[..] {
                [a] => double(graph, a).map(|a| call(*function, a)),
                [a, b] => double(graph, a).zip(double(graph, b)).map(|(a, b)| call2(*function, a, b)),
                _ => None,
            },
            _ => None,
        };
        // An infinite number or NaN stays as it is; evaluating it gives an error.
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

#[cfg(test)]
mod tests {
    use super::super::testing::{keeps_the_meaning, late, parameters, small, speeds};
    use super::*;
    use hodograph_model::arithmetic::Function;

    fn folded(build: impl FnOnce(&mut Graph) -> Vec<Node>) -> Vec<NodeKind> {
        let folded = fold(&small(build));
        folded.outputs[0].values.iter().map(|&node| folded.graph.kind(node).clone()).collect()
    }

    #[test]
    fn rational_numbers_stay_exact() {
        let third = |g: &mut Graph| {
            let (n, d) = (g.integer(1), g.integer(3));
            let third = g.div(n, d);
            let sixth = g.number(Number::ratio(1, 6));
            vec![g.sum([third, sixth])]
        };
        assert_eq!(folded(third), [NodeKind::Number(Number::ratio(1, 2))]);
    }

    #[test]
    fn functions_of_numbers_become_the_nearest_double() {
        let sine = |g: &mut Graph| {
            let (pi, third) = (g.pi(), g.number(Number::ratio(1, 3)));
            let angle = g.product([pi, third]);
            vec![g.call(Function::Sin, vec![angle])]
        };
        let [NodeKind::Number(number)] = &folded(sine)[..] else { panic!("not folded") };
        assert_eq!(number.to_f64(), call(Function::Sin, std::f64::consts::PI * (1.0 / 3.0)));
    }

    #[test]
    fn numbers_that_are_not_finite_are_left_for_the_evaluation_to_report() {
        let root = |g: &mut Graph| {
            let minus = g.integer(-1);
            vec![g.call(Function::Sqrt, vec![minus])]
        };
        assert!(matches!(folded(root)[..], [NodeKind::Call(Function::Sqrt, _)]));
    }

    #[test]
    fn long_numbers_are_rounded_to_doubles() {
        let long = |g: &mut Graph| {
            let third = g.number(Number::ratio(1, 3));
            vec![g.power(third, 400)]
        };
        let [NodeKind::Number(number)] = &folded(long)[..] else { panic!("no number") };
        assert!(number.to_f64() > 0.0, "{number:?}");
        assert_eq!(BigRational::from_float(number.to_f64()).as_ref(), Some(&number.0));
    }

    #[test]
    fn parameters_are_no_numbers() {
        let derived = small(|g| {
            let ([m, ..], [u, ..]) = (parameters(g), speeds(g));
            vec![g.product([m, u])]
        });
        assert_eq!(late(&fold(&derived)), ["Mul"]);
        keeps_the_meaning(fold);
    }
}
