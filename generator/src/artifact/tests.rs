use super::*;
use crate::program::graph::{Graph, Input};
use crate::program::{Derived, Guard, Output, Quantity, Structure};

fn program() -> Program {
    let mut graph = Graph::new();
    let q = graph.input(Input::Coordinate(0));
    let m = graph.input(Input::Parameter(0));
    let sine = graph.call(Function::Sin, vec![q]);
    let cosine = graph.call(Function::Cos, vec![q]);
    let third = graph.number(crate::number::Number::ratio(-1, 3));
    let product = graph.product([third, m, sine]);
    let quotient = graph.div(product, cosine);
    let angle = graph.call(Function::Atan2, vec![quotient, m]);
    let outputs = vec![
        Output { quantity: Quantity::Forcing, rows: 2, columns: 1, values: vec![quotient, angle] },
        Output { quantity: Quantity::DependentSpeeds, rows: 0, columns: 1, values: vec![] },
    ];
    let guards = vec![Guard { value: cosine, scale: Some(m), message: "the arm\nis  stretched".into() }];
    Program::new(&Derived {
        graph,
        outputs,
        guards,
        structures: vec![Structure::Planar, Structure::General],
        samples: vec![],
    })
}

#[test]
fn what_is_written_reads_back() {
    let mut program = program();
    let text = encode(&program, "00ff");
    program.guards[0].message = "the arm is stretched".into();
    let artifact = decode(&text).unwrap();
    assert_eq!(artifact.model, "00ff");
    assert_eq!(artifact.program, program);
    assert_eq!(encode(&artifact.program, "00ff"), text);
}

#[test]
fn damaged_derivations_are_refused_or_valid() {
    let text = encode(&program(), "00ff");
    for end in 0..text.len() - 1 {
        assert!(decode(&text[..end]).is_err(), "cut at {end}");
    }
    // Every single character replaced: never a panic, never an operand out of order.
    for at in 0..text.len() {
        for replacement in ["", "9", " ", "\n", "-", "x", "99999999999999999999"] {
            let damaged = format!("{}{replacement}{}", &text[..at], &text[at + 1..]);
            if let Ok(artifact) = decode(&damaged) {
                for (index, operation) in artifact.program.operations.iter().enumerate() {
                    assert!(operation.operands().all(|operand| operand.index() < index));
                }
            }
        }
    }
}

#[test]
fn another_format_is_named() {
    let text = encode(&program(), "00ff").replacen("derivation 1", "derivation 7", 1);
    let error = decode(&text).unwrap_err();
    assert_eq!(error.line, 1);
    assert!(error.message.contains("format \"7\""), "{error}");
}
