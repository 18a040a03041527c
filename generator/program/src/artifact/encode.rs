//! Writes a derivation file.

use std::fmt::Write;

use super::{DIGEST, FORMAT, FUNCTIONS};
use crate::program::Program;
use crate::program::graph::Input;
use crate::program::operation::{Operation, Value};
use hodograph_model::arithmetic::Function;

/// The text of a derivation. `model` is the [`model_hash`](super::model_hash) of the model.
pub fn encode(program: &Program, model: &str) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write(&mut text, program, model);
    let digest = super::hash::of_text(&text);
    let _ = writeln!(text, "{DIGEST}{digest}");
    text
}

fn write(text: &mut String, program: &Program, model: &str) -> std::fmt::Result {
    writeln!(text, "hodograph derivation {FORMAT}")?;
    writeln!(text, "generator {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(text, "model {model}")?;
    write!(text, "structures")?;
    for structure in &program.structures {
        write!(text, " {structure}")?;
    }
    writeln!(text)?;
    for (index, &operation) in program.operations.iter().enumerate() {
        write!(text, "{index} ")?;
        match operation {
            Operation::Constant(bits) => write!(text, "number {:?}", bits.get())?,
            Operation::Input(input) => self::input(text, input)?,
            _ => write!(text, "{}", word(operation))?,
        }
        for operand in operation.operands() {
            write!(text, " {}", operand.0)?;
        }
        writeln!(text)?;
    }
    for output in &program.outputs {
        write!(text, "output {} {} {} :", output.quantity, output.rows, output.columns)?;
        values(text, &output.values)?;
        writeln!(text)?;
    }
    for guard in &program.guards {
        write!(text, "guard {}", guard.value.0)?;
        if let Some(scale) = guard.scale {
            write!(text, " scale {}", scale.0)?;
        }
        // A message is written on one line.
        let message: Vec<&str> = guard.message.split_whitespace().collect();
        writeln!(text, " : {}", message.join(" "))?;
    }
    writeln!(text, "end {}", program.operations.len())
}

fn values(text: &mut String, values: &[Value]) -> std::fmt::Result {
    values.iter().try_for_each(|value| write!(text, " {}", value.0))
}

fn input(text: &mut String, input: Input) -> std::fmt::Result {
    match input {
        Input::Time => write!(text, "time"),
        Input::Parameter(index) => write!(text, "parameter {index}"),
        Input::Coordinate(index) => write!(text, "coordinate {index}"),
        Input::Speed(index) => write!(text, "speed {index}"),
        Input::Input(index) => write!(text, "input {index}"),
        Input::Acceleration(index) => write!(text, "acceleration {index}"),
        Input::Tangent(index) => write!(text, "tangent {index}"),
    }
}

fn word(operation: Operation) -> &'static str {
    match operation {
        Operation::Constant(_) | Operation::Input(_) => "",
        Operation::Neg(_) => "neg",
        Operation::Add(..) => "add",
        Operation::Sub(..) => "sub",
        Operation::Mul(..) => "mul",
        Operation::Div(..) => "div",
        Operation::Recip(_) => "recip",
        Operation::MulAdd(..) => "muladd",
        Operation::MulSub(..) => "mulsub",
        Operation::NegMulAdd(..) => "negmuladd",
        Operation::SinCos(_) => "sincos",
        Operation::Sine(_) => "sine",
        Operation::Cosine(_) => "cosine",
        Operation::Call(function, _) | Operation::Call2(function, ..) => name(function),
    }
}

fn name(function: Function) -> &'static str {
    FUNCTIONS.iter().find(|(known, _)| *known == function).map_or("?", |(_, name)| name)
}
