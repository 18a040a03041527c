//! Reads a derivation file. Every text gives either a valid program or an error.

use std::borrow::Cow;
use std::fmt;

use super::{Artifact, DIGEST, FORMAT, FUNCTIONS, hash, is_binary};
use crate::program::graph::Input;
use crate::program::operation::{Bits, Operation, Value};
use crate::program::{Guard, Output, Program};
use crate::program::{Quantity, Structure};

/// The error of a text that is not a derivation in this format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodeError {
    /// line of the error, counted from 1
    pub line: usize,
    /// description of the error
    pub message: String,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for DecodeError {}

/// Reads a derivation. The text must equal the written one byte for byte; only LF may have become CR LF on
/// all lines, as some checkouts do.
pub fn decode(text: &str) -> Result<Artifact, DecodeError> {
    let text = &*line_feeds(text);
    let mut lines = Lines { rest: text, number: 0 };
    let artifact = body(&mut lines)?;
    let written = &text[..text.len() - lines.rest.len()];
    let digest = lines.after(DIGEST)?;
    if !lines.rest.is_empty() {
        lines.number += 1;
        return Err(lines.error("there is text after the end of the derivation"));
    }
    if digest != hash::of_text(written) {
        return Err(lines.error(
            "the text does not agree with its digest: it was changed after it was written, by hand or by a merge",
        ));
    }
    Ok(artifact)
}

/// The text with LF line ends, if all its line ends are CR LF; else the text as it is.
fn line_feeds(text: &str) -> Cow<'_, str> {
    let ends = text.matches('\n').count();
    let all = text.matches("\r\n").count() == ends && text.matches('\r').count() == ends;
    if ends > 0 && all { text.replace("\r\n", "\n").into() } else { text.into() }
}

/// Reads everything before the digest.
fn body(lines: &mut Lines<'_>) -> Result<Artifact, DecodeError> {
    let header = lines.after("hodograph derivation ")?;
    if header != FORMAT.to_string() {
        let message = format!(
            "the derivation has format {header:?}, this generator reads format {FORMAT}: derive it again"
        );
        return Err(lines.error(message));
    }
    let generator = lines.after("generator ")?.to_string();
    let model = lines.after("model ")?.to_string();
    let mut program = Program::default();
    for word in lines.after("structures")?.split_whitespace() {
        let structure = Structure::from_word(word).ok_or_else(|| lines.error("unknown structure"))?;
        program.structures.push(structure);
    }
    loop {
        let line = lines.next()?;
        let (head, tail) = line
            .split_once(" : ")
            .or_else(|| line.strip_suffix(" :").map(|head| (head, "")))
            .unwrap_or((line, ""));
        let words: Vec<&str> = head.split(' ').collect();
        let wrong = |message: &str| DecodeError { line: lines.number, message: message.to_string() };
        match words[..] {
            ["end", count] if count == program.operations.len().to_string() => break,
            ["output", ref words @ .., rows, columns] => {
                program.outputs.push(
                    output(&program, words, rows, columns, tail)
                        .ok_or_else(|| wrong("not a valid output"))?,
                );
            }
            ["guard", ref words @ ..] => {
                program.guards.push(guard(&program, words, tail).ok_or_else(|| wrong("not a valid guard"))?);
            }
            [index, ref words @ ..]
                if program.outputs.is_empty() && index == program.operations.len().to_string() =>
            {
                let operation = operation(&program, words).ok_or_else(|| wrong("not a valid operation"))?;
                program.operations.push(operation);
            }
            _ => return Err(wrong("not a line of a derivation (was the file cut off, or merged?)")),
        }
    }
    Ok(Artifact { generator, model, program })
}

struct Lines<'a> {
    rest: &'a str,
    number: usize,
}

impl<'a> Lines<'a> {
    fn error(&self, message: impl Into<String>) -> DecodeError {
        DecodeError { line: self.number, message: message.into() }
    }

    fn next(&mut self) -> Result<&'a str, DecodeError> {
        self.number += 1;
        let (line, rest) = self.rest.split_once('\n').ok_or_else(|| self.error("the file ends too early"))?;
        self.rest = rest;
        Ok(line)
    }

    fn after(&mut self, prefix: &str) -> Result<&'a str, DecodeError> {
        let line = self.next()?;
        line.strip_prefix(prefix)
            .ok_or_else(|| self.error(format!("expected `{prefix}..`: this is not a derivation")))
    }
}

/// An earlier value that is a number, not a sine-cosine pair.
fn value(program: &Program, word: &str) -> Option<Value> {
    let value = Value(word.parse().ok()?);
    let operation = program.operations.get(value.index())?;
    (!matches!(operation, Operation::SinCos(_))).then_some(value)
}

fn pair(program: &Program, word: &str) -> Option<Value> {
    let value = Value(word.parse().ok()?);
    matches!(program.operations.get(value.index())?, Operation::SinCos(_)).then_some(value)
}

fn operation(program: &Program, words: &[&str]) -> Option<Operation> {
    let of = |word: &str| value(program, word);
    Some(match *words {
        ["number", number] => Operation::Constant(Bits::new(number.parse().ok()?)),
        ["time"] => Operation::Input(Input::Time),
        ["parameter", index] => Operation::Input(Input::Parameter(index.parse().ok()?)),
        ["coordinate", index] => Operation::Input(Input::Coordinate(index.parse().ok()?)),
        ["speed", index] => Operation::Input(Input::Speed(index.parse().ok()?)),
        ["input", index] => Operation::Input(Input::Input(index.parse().ok()?)),
        ["acceleration", index] => Operation::Input(Input::Acceleration(index.parse().ok()?)),
        ["tangent", index] => Operation::Input(Input::Tangent(index.parse().ok()?)),
        ["neg", a] => Operation::Neg(of(a)?),
        ["recip", a] => Operation::Recip(of(a)?),
        ["sincos", a] => Operation::SinCos(of(a)?),
        ["sine", a] => Operation::Sine(pair(program, a)?),
        ["cosine", a] => Operation::Cosine(pair(program, a)?),
        ["add", a, b] => Operation::Add(of(a)?, of(b)?),
        ["sub", a, b] => Operation::Sub(of(a)?, of(b)?),
        ["mul", a, b] => Operation::Mul(of(a)?, of(b)?),
        ["div", a, b] => Operation::Div(of(a)?, of(b)?),
        ["muladd", a, b, c] => Operation::MulAdd(of(a)?, of(b)?, of(c)?),
        ["mulsub", a, b, c] => Operation::MulSub(of(a)?, of(b)?, of(c)?),
        ["negmuladd", a, b, c] => Operation::NegMulAdd(of(a)?, of(b)?, of(c)?),
        [name, ref operands @ ..] => {
            let (function, _) = FUNCTIONS.iter().find(|(_, known)| *known == name)?;
            match (operands, is_binary(*function)) {
                (&[a], false) => Operation::Call(*function, of(a)?),
                (&[a, b], true) => Operation::Call2(*function, of(a)?, of(b)?),
                _ => return None,
            }
        }
        [] => return None,
    })
}

fn output(program: &Program, words: &[&str], rows: &str, columns: &str, values: &str) -> Option<Output> {
    let quantity = Quantity::from_words(words)?;
    let (rows, columns): (usize, usize) = (rows.parse().ok()?, columns.parse().ok()?);
    let values: Vec<Value> =
        values.split_whitespace().map(|word| value(program, word)).collect::<Option<_>>()?;
    let valid = program.output(quantity).is_none() && rows.checked_mul(columns) == Some(values.len());
    valid.then_some(Output { quantity, rows, columns, values })
}

fn guard(program: &Program, words: &[&str], message: &str) -> Option<Guard> {
    let (value, scale) = match *words {
        [value] => (self::value(program, value)?, None),
        [value, "scale", scale] => (self::value(program, value)?, Some(self::value(program, scale)?)),
        _ => return None,
    };
    Some(Guard { value, scale, message: message.to_string() })
}
