//! Converts the operations of a program to expressions; a value that is used more than once gets a name.

use std::collections::HashMap;

use super::arithmetic::{ZERO, neg, quotient, sum, times};
use super::exact::Exact;
use super::headings::{heading, lefts, matrix};
use super::symbols::{Symbol, Symbols};
use super::{Document, Entry, Equation, INTERMEDIATE, Left, Section, Term, stage_title};
use crate::program::graph::Input;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::{Output, Program, Quantity};
use hodograph_model::arithmetic::Function;
use hodograph_model::model::mechanism::{Mechanism, Variable};

/// An expression with more symbols than this is split.
const LONGEST: usize = 24;

pub fn collect(mechanism: &Mechanism, program: &Program, quantities: &[Quantity]) -> Document {
    let slice = program.slice(quantities);
    let exact = Exact::new(program, &slice);
    let stages = program.stages();
    let mut reader = Reader { mechanism, program, terms: HashMap::new(), count: 0 };
    let mut intermediate: Vec<(Stage, Vec<Equation>)> =
        [Stage::Constant, Stage::Parameter, Stage::Configuration, Stage::Velocity]
            .map(|s| (s, Vec::new()))
            .into();
    for &value in &slice.order {
        let Some(times) = exact.uses(value) else { continue };
        let term = reader.term(value);
        let pair = matches!(program.operation(value), Operation::SinCos(_));
        let named = !pair && !is_short(&term) && (times > 1 || (times == 1 && size(&term) > LONGEST));
        let term = if named {
            reader.count += 1;
            let equation = Equation { left: Left::Z(reader.count), right: term };
            let list = intermediate.iter_mut().find(|(stage, _)| *stage == stages[value.index()]);
            list.into_iter().for_each(|(_, list)| list.push(equation.clone()));
            Term::Z(reader.count)
        } else {
            term
        };
        reader.terms.insert(value, term);
    }
    let names = names(mechanism);
    let symbols = Symbols::new(names.iter().flat_map(|(_, list)| list).map(|entry| entry.name.as_str()));
    let timed =
        slice.order.iter().any(|&value| matches!(program.operation(value), Operation::Input(Input::Time)));
    let symbols = if timed { symbols } else { symbols.without_time() };
    let intermediate = intermediate.into_iter().filter(|(_, list)| !list.is_empty());
    let mut sections: Vec<Section> = intermediate
        .map(|(stage, equations)| Section {
            group: INTERMEDIATE.to_owned(),
            title: stage_title(stage).to_owned(),
            unit: String::new(),
            symbol: None,
            matrix: Vec::new(),
            equations,
        })
        .collect();
    sections.extend(slice.outputs.iter().map(|output| reader.section(output, &symbols)));
    Document { title: mechanism.name.clone(), docs: mechanism.docs.clone(), symbols, names, sections }
}

fn names(mechanism: &Mechanism) -> Vec<(&'static str, Vec<Entry>)> {
    let entries = |list: &[Variable]| {
        let entry = |q: &Variable| Entry {
            name: q.name.clone(),
            unit: q.unit.clone(),
            docs: q.docs.replace('\n', " "),
            value: q.value,
        };
        list.iter().map(entry).collect::<Vec<_>>()
    };
    let lists = [
        ("Parameters", entries(&mechanism.parameters)),
        ("Inputs", entries(&mechanism.inputs)),
        ("Coordinates", entries(&mechanism.coordinates)),
        ("Speeds", entries(&mechanism.speeds)),
    ];
    lists.into_iter().filter(|(_, list)| !list.is_empty()).collect()
}

/// Whether a term is so short that it needs no name even if it is used often.
fn is_short(term: &Term) -> bool {
    match term {
        Term::Number(_) | Term::Name(_) | Term::Rate(_) | Term::Z(_) => true,
        Term::Neg(term) => is_short(term),
        Term::Call(_, arguments) => arguments.iter().all(|term| matches!(term, Term::Name(_) | Term::Z(_))),
        _ => false,
    }
}

/// Number of symbols in a term.
pub fn size(term: &Term) -> usize {
    match term {
        Term::Number(_) | Term::Name(_) | Term::Rate(_) | Term::Z(_) => 1,
        Term::Neg(a) | Term::Power(a, _) => size(a),
        Term::Sum(list) | Term::Product(list) | Term::Call(_, list) => list.iter().map(size).sum(),
        Term::Quotient(a, b) => size(a) + size(b),
    }
}

struct Reader<'a> {
    mechanism: &'a Mechanism,
    program: &'a Program,
    terms: HashMap<Value, Term>,
    count: usize,
}

impl Reader<'_> {
    fn of(&self, value: Value) -> Term {
        // Only values that are exactly 0 have no term.
        self.terms.get(&value).cloned().unwrap_or(ZERO)
    }

    fn term(&self, value: Value) -> Term {
        use Operation::*;
        let of = |value| self.of(value);
        match self.program.operation(value) {
            Constant(bits) => Term::Number(bits.get()),
            Input(input) => self.input(input),
            Neg(a) => neg(of(a)),
            Add(a, b) => sum(of(a), of(b)),
            Sub(a, b) => sum(of(a), neg(of(b))),
            Mul(a, b) => times(of(a), of(b)),
            Div(a, b) => quotient(of(a), of(b)),
            Recip(a) => quotient(Term::Number(1.0), of(a)),
            MulAdd(a, b, c) => sum(times(of(a), of(b)), of(c)),
            MulSub(a, b, c) => sum(times(of(a), of(b)), neg(of(c))),
            NegMulAdd(a, b, c) => sum(of(c), neg(times(of(a), of(b)))),
            SinCos(a) => of(a),
            Sine(pair) => Term::Call("sin", vec![of(pair)]),
            Cosine(pair) => Term::Call("cos", vec![of(pair)]),
            Call(function, a) => Term::Call(function_name(function), vec![of(a)]),
            Call2(function, a, b) => Term::Call(function_name(function), vec![of(a), of(b)]),
        }
    }

    fn input(&self, input: Input) -> Term {
        let name = |list: &[Variable], index: u32| {
            list.get(index as usize).map_or("?".to_owned(), |q| q.name.clone())
        };
        let mechanism = self.mechanism;
        match input {
            Input::Time => Term::Name("time".to_owned()),
            Input::Parameter(index) => Term::Name(name(&mechanism.parameters, index)),
            Input::Coordinate(index) => Term::Name(name(&mechanism.coordinates, index)),
            Input::Speed(index) => Term::Name(name(&mechanism.speeds, index)),
            Input::Input(index) => Term::Name(name(&mechanism.inputs, index)),
            Input::Acceleration(index) => Term::Rate(name(&mechanism.speeds, index)),
            Input::Tangent(index) => Term::Name(self.deviation(index)),
        }
    }

    /// The name of a small deviation of an independent coordinate, an independent speed, or an input.
    fn deviation(&self, index: u32) -> String {
        let states = self.mechanism.coordinates.iter().chain(&self.mechanism.speeds).filter(|q| !q.dependent);
        let name = states.chain(&self.mechanism.inputs).nth(index as usize).map_or("?", |q| q.name.as_str());
        format!("delta_{name}")
    }

    /// The equations of a quantity. Its symbol gets a prime if one of its entries would look like a name of
    /// the model.
    fn section(&self, output: &Output, symbols: &Symbols) -> Section {
        let heading = heading(self.mechanism, output.quantity);
        let taken = |head: &str, index: String| symbols.has(&Symbol { head: head.to_owned(), index });
        let clash = |left: &Left| match left {
            Left::Entry(symbol, indices) => taken(symbol, indices.join(",")),
            Left::Z(_) | Left::Of(..) => false,
        };
        let matrix = matrix(output);
        let mut symbol = heading.symbol.to_owned();
        let mut left_sides = lefts(self.mechanism, output, &symbol);
        // A matrix is written with its symbol, which must differ from all names, too.
        while left_sides.iter().any(clash) || (!matrix.is_empty() && taken(&symbol, String::new())) {
            symbol.push('\'');
            left_sides = lefts(self.mechanism, output, &symbol);
        }
        let rights = output.values.iter().map(|&value| self.of(value));
        Section {
            group: heading.group,
            title: heading.title.to_owned(),
            unit: heading.unit.to_owned(),
            symbol: Some(symbol).filter(|symbol| !taken(symbol, String::new())),
            matrix,
            equations: left_sides
                .into_iter()
                .zip(rights)
                .map(|(left, right)| Equation { left, right })
                .collect(),
        }
    }
}

fn function_name(function: Function) -> &'static str {
    match function {
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Tan => "tan",
        Function::Asin => "asin",
        Function::Acos => "acos",
        Function::Atan => "atan",
        Function::Atan2 => "atan2",
        Function::Sqrt => "sqrt",
        Function::Exp => "exp",
        Function::Log => "log",
        Function::Sinh => "sinh",
        Function::Cosh => "cosh",
        Function::Tanh => "tanh",
        Function::Abs => "abs",
        Function::Sign => "sign",
        Function::Min => "min",
        Function::Max => "max",
        Function::Frozen => "frozen",
    }
}
