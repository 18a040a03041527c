//! Every pass keeps the meaning: random graphs, the interpreter as referee. And what each is for, in small.

use super::*;
use crate::interpret::{Evaluator, Inputs};
use crate::model::mechanism::Function;
use crate::number::Number;
use crate::program::graph::Input;
use crate::program::routine::Quantity;
use crate::program::{Program, lower::lower};

/// A random derivation; the generator of random numbers is in the seed.
fn random(seed: u64) -> Derived {
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
    let outputs = vec![Output { quantity: Quantity::Forcing, rows: 12, columns: 1, nodes }];
    Derived { graph, outputs, guards: vec![], structures: vec![] }
}

fn inputs() -> Inputs {
    Inputs {
        parameters: vec![1.3, 0.4, 2.2],
        coordinates: vec![0.7, -0.3, 1.9],
        speeds: vec![0.2, 1.1, -0.6],
        ..Default::default()
    }
}

fn numbers(program: &Program) -> Option<Vec<f64>> {
    Some(Evaluator::new(program).evaluate(&inputs(), &[Quantity::Forcing]).ok()?.remove(0).values)
}

#[test]
fn every_pass_keeps_the_meaning() {
    let mut compared = 0;
    for seed in 1..400 {
        let mut derived = random(seed);
        let Some(expected) = numbers(&lower(&derived)) else { continue };
        for pass in PASSES {
            derived = (pass.run)(&derived);
            let found = numbers(&lower(&derived)).expect(pass.name);
            let fused = numbers(&fuse::fuse(&lower(&derived))).expect(pass.name);
            for (expected, found) in expected.iter().chain(&expected).zip(found.iter().chain(&fused)) {
                let difference = (expected - found).abs();
                assert!(
                    difference <= 1e-6 * expected.abs().max(1e-3),
                    "{} of seed {seed}: {expected} {found}",
                    pass.name
                );
            }
            compared += 1;
        }
    }
    assert!(compared > 400, "{compared}");
}

/// Operations at run time after all passes.
fn cost(build: impl FnOnce(&mut Graph) -> Vec<Node>) -> usize {
    let mut graph = Graph::new();
    let nodes = build(&mut graph);
    let outputs = vec![Output { quantity: Quantity::Forcing, rows: nodes.len(), columns: 1, nodes }];
    let program = Program::new(&Derived { graph, outputs, guards: vec![], structures: vec![] });
    let stages = program.stages();
    let late = |index: usize| stages[index] > Stage::Parameter;
    let counts = |operation: &crate::program::operation::Operation| match operation {
        crate::program::operation::Operation::Input(_) => 0,
        crate::program::operation::Operation::MulAdd(..) => 2,
        _ => 1,
    };
    program
        .operations
        .iter()
        .enumerate()
        .filter(|(index, _)| late(*index))
        .map(|(_, operation)| counts(operation))
        .sum()
}

fn speeds(graph: &mut Graph) -> [Node; 4] {
    [0, 1, 2, 3].map(|index| graph.input(Input::Speed(index)))
}

#[test]
fn like_terms_are_collected() {
    let operations = cost(|g| {
        let [a, b, ..] = speeds(g);
        let two = g.integer(2);
        let twice = g.product([two, a]);
        let minus = g.neg(b);
        let inner = g.sum([a, b]);
        vec![g.sum([inner, twice, minus])]
    });
    assert_eq!(operations, 1, "3 a");
}

#[test]
fn common_factors_are_taken_out() {
    let operations = cost(|g| {
        let [a, b, c, d] = speeds(g);
        let products = [g.product([a, b]), g.product([a, c]), g.product([a, d])];
        vec![g.sum(products)]
    });
    assert_eq!(operations, 3, "a (b + c + d)");
}

#[test]
fn parameters_are_grouped() {
    let operations = cost(|g| {
        let [a, b, ..] = speeds(g);
        let [m1, m2, l] = [0, 1, 2].map(|index| g.input(Input::Parameter(index)));
        let products = [g.product([m1, l, a, b]), g.product([m2, l, a, b])];
        vec![g.sum(products)]
    });
    assert_eq!(operations, 2, "(m1 l + m2 l) a b");
}

#[test]
fn products_and_sums_are_shared_up_to_sign() {
    let operations = cost(|g| {
        let [a, b, c, d] = speeds(g);
        let minus = g.integer(-1);
        let (left, right) = (g.product([a, b, c]), g.product([minus, a, b, d]));
        let (e, f) = (g.sub(c, d), g.sub(d, c));
        let f = g.product([f, a]);
        vec![left, right, e, f]
    });
    // a b, (a b) c, (a b) d and its negation, c - d, (c - d) a and its negation
    assert_eq!(operations, 7);
}
