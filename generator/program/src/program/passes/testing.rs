//! Common code of the tests of passes: small and random derivations, and comparison of programs by the
//! interpreter.

use super::lower;
use crate::interpret::Evaluator;
use crate::program::graph::{Graph, Input, Node};
use crate::program::inputs::Inputs;
use crate::program::operation::{Operation, Stage};
use crate::program::straight_line::Program;
use crate::program::{Derived, Output, Quantity};
use hodograph_model::arithmetic::Function;
use hodograph_model::number::Number;

/// A derivation with these nodes as its output.
pub fn small(build: impl FnOnce(&mut Graph) -> Vec<Node>) -> Derived {
    let mut graph = Graph::new();
    let nodes = build(&mut graph);
    let outputs = vec![Output { quantity: Quantity::Forcing, rows: nodes.len(), columns: 1, values: nodes }];
    Derived {
        graph,
        outputs,
        guards: vec![],
        structures: vec![],
        samples: vec![inputs()],
        apart: vec![],
        solve: None,
    }
}

/// Four inputs of the velocity stage.
pub fn speeds(graph: &mut Graph) -> [Node; 4] {
    [0, 1, 2, 3].map(|index| graph.input(Input::Speed(index)))
}

/// Three inputs that are known at construction.
pub fn parameters(graph: &mut Graph) -> [Node; 3] {
    [0, 1, 2].map(|index| graph.input(Input::Parameter(index)))
}

/// A random derivation, determined by the seed.
pub fn random(seed: u64) -> Derived {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as usize % below
    };
    let mut graph = Graph::new();
    let mut nodes: Vec<Node> = (0..3).map(|index| graph.input(Input::Parameter(index))).collect();
    nodes.extend((0..3).map(|index| graph.input(Input::Coordinate(index))));
    nodes.extend((0..3).map(|index| graph.input(Input::Speed(index))));
    nodes.push(graph.pi());
    nodes.extend([(-1, 1), (2, 1), (-3, 7), (1, 2)].map(|(n, d)| graph.number(Number::ratio(n, d))));
    for _ in 0..60 {
        let some: Vec<Node> = (0..2 + random(4)).map(|_| nodes[random(nodes.len())]).collect();
        let node = match random(8) {
            0..=2 => graph.sum(some),
            3..=5 => graph.product(some),
            6 => graph.power(some[0], [2, 3, -1, -2][random(4)]),
            _ => graph.call([Function::Sin, Function::Cos, Function::Abs][random(3)], vec![some[0]]),
        };
        nodes.push(node);
    }
    let nodes: Vec<Node> = nodes.iter().rev().take(12).copied().collect();
    let outputs = vec![Output { quantity: Quantity::Forcing, rows: 12, columns: 1, values: nodes }];
    Derived {
        graph,
        outputs,
        guards: vec![],
        structures: vec![],
        samples: vec![inputs()],
        apart: vec![],
        solve: None,
    }
}

/// Values for the inputs of random and small derivations.
pub fn inputs() -> Inputs {
    Inputs {
        parameters: vec![1.3, 0.4, 2.2],
        coordinates: vec![0.7, -0.3, 1.9],
        speeds: vec![0.2, 1.1, -0.6, 1.7],
        ..Default::default()
    }
}

/// The results of a program; `None` if one is not finite.
fn numbers(program: &Program) -> Option<Vec<f64>> {
    Some(Evaluator::new(program).evaluate(&inputs(), &[Quantity::Forcing]).ok()?.remove(0).values)
}

/// The bits of the results of a program.
pub fn bits(program: &Program) -> Option<Vec<u64>> {
    Some(numbers(program)?.into_iter().map(f64::to_bits).collect())
}

/// Both programs give the same numbers up to rounding.
pub fn agree(before: &Program, after: &Program, context: &str) {
    let Some(expected) = numbers(before) else { return };
    let found = numbers(after).unwrap_or_else(|| panic!("{context}: no number any more"));
    assert_eq!(expected.len(), found.len(), "{context}");
    for (expected, found) in expected.iter().zip(&found) {
        // the reciprocal of a rounding error of zero
        if expected.abs() > 1e14 && found.abs() > 1e14 {
            continue;
        }
        let difference = (expected - found).abs();
        assert!(difference <= 1e-6 * expected.abs().max(1e-3), "{context}: {expected} {found}");
    }
}

/// Checks that a pass on the graph keeps the meaning of random derivations, most of which have finite
/// results.
pub fn keeps_the_meaning(pass: fn(&Derived) -> Derived) {
    let mut compared = 0;
    for seed in 1..150 {
        let derived = random(seed);
        agree(&lower(&derived), &lower(&pass(&derived)), &format!("seed {seed}"));
        compared += usize::from(numbers(&lower(&derived)).is_some());
    }
    assert!(compared > 40, "{compared}");
}

/// The kinds of a program's operations in order, without inputs and constants.
pub fn operations(program: &Program) -> Vec<String> {
    let kind = |operation: &Operation| match operation {
        Operation::Input(_) | Operation::Constant(_) => None,
        _ => format!("{operation:?}").split('(').next().map(str::to_owned),
    };
    program.operations.iter().filter_map(kind).collect()
}

/// The operations of an evaluation, without those at construction.
pub fn late(derived: &Derived) -> Vec<String> {
    let program = lower(derived);
    let stages = program.stages();
    let mut late = program.clone();
    let mut at = 0;
    late.operations.retain(|_| {
        at += 1;
        stages[at - 1] > Stage::Parameter
    });
    operations(&late)
}
