//! Operations become expressions; what is shared gets a name.

use std::collections::HashMap;

use super::arithmetic::{ZERO, neg, quotient, sum, times};
use super::exact::Exact;
use super::{Document, Entry, Equation, Left, Section, Term, stage_title};
use crate::arithmetic::Function;
use crate::model::mechanism::{Mechanism, Variable};
use crate::program::graph::Input;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::{ContactQuantity, PointQuantity, Quantity};
use crate::program::{Output, Program};

/// An expression of more symbols than this is cut in two.
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
    let intermediate = intermediate.into_iter().filter(|(_, list)| !list.is_empty());
    let mut sections: Vec<Section> = intermediate
        .map(|(stage, equations)| Section { title: stage_title(stage).to_owned(), equations })
        .collect();
    sections.extend(slice.outputs.iter().map(|output| reader.section(output)));
    Document {
        title: mechanism.name.clone(),
        docs: mechanism.docs.clone(),
        names: names(mechanism),
        sections,
    }
}

fn names(mechanism: &Mechanism) -> Vec<(&'static str, Vec<Entry>)> {
    let entries = |list: &[Variable]| {
        let entry = |q: &Variable| Entry {
            name: q.name.clone(),
            unit: q.unit.clone(),
            docs: q.docs.replace('\n', " "),
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

/// Needs no name even if it is used often.
fn is_short(term: &Term) -> bool {
    match term {
        Term::Number(_) | Term::Name(_) | Term::Rate(_) | Term::Z(_) => true,
        Term::Neg(term) => is_short(term),
        Term::Call(_, arguments) => arguments.iter().all(|term| matches!(term, Term::Name(_) | Term::Z(_))),
        _ => false,
    }
}

/// Number of symbols.
fn size(term: &Term) -> usize {
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
        // Only what is exactly nothing has no term.
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

    /// The name of a small deviation: of an independent coordinate, an independent speed, or an input.
    fn deviation(&self, index: u32) -> String {
        let states = self.mechanism.coordinates.iter().chain(&self.mechanism.speeds).filter(|q| !q.dependent);
        let name = states.chain(&self.mechanism.inputs).nth(index as usize).map_or("?", |q| q.name.as_str());
        format!("delta_{name}")
    }

    fn section(&self, output: &Output) -> Section {
        let (title, symbol) = self.heading(output.quantity);
        let (independent, dependent): (Vec<&Variable>, Vec<&Variable>) =
            self.mechanism.speeds.iter().partition(|speed| !speed.dependent);
        let own =
            |list: Vec<&Variable>, rate: bool| list.iter().map(|q| Left::Of(q.name.clone(), rate)).collect();
        let lefts: Vec<Left> = match output.quantity {
            Quantity::CoordinateRates => own(self.mechanism.coordinates.iter().collect(), true),
            Quantity::DependentSpeeds => own(dependent, false),
            Quantity::Accelerations => own(independent, true),
            Quantity::DependentAccelerations => own(dependent, true),
            _ => {
                let several = |count: usize, index: usize| (count > 1).then_some(index + 1);
                (0..output.rows * output.columns)
                    .map(|place| (place / output.columns.max(1), place % output.columns.max(1)))
                    .map(|(row, column)| {
                        Left::Entry(
                            symbol.clone(),
                            several(output.rows, row),
                            several(output.columns, column),
                        )
                    })
                    .collect()
            }
        };
        let rights = output.values.iter().map(|&value| self.of(value));
        let equations = lefts.into_iter().zip(rights).map(|(left, right)| Equation { left, right }).collect();
        Section { title, equations }
    }

    /// The heading of a quantity, and the symbol for its entries.
    fn heading(&self, quantity: Quantity) -> (String, String) {
        let plain = |title: &str, symbol: &str| (title.to_owned(), symbol.to_owned());
        match quantity {
            Quantity::CoordinateRates => plain("Rates of the coordinates", "q"),
            Quantity::DependentSpeeds => plain("Dependent speeds", "u"),
            Quantity::MassMatrix => plain("Mass matrix", "M"),
            Quantity::Forcing => plain("Forcing: M du/dt = F", "F"),
            Quantity::Accelerations => plain("Accelerations", "a"),
            Quantity::DependentAccelerations => plain("Rates of the dependent speeds", "a"),
            Quantity::InverseDynamics => plain("Inverse dynamics", "Q"),
            Quantity::StateTangent => plain("Linearised rates", "l"),
            Quantity::KineticEnergy => plain("Kinetic energy", "K"),
            Quantity::PotentialEnergy => plain("Potential energy", "W"),
            Quantity::ConfigurationResidual => plain("Configuration equations", "c"),
            Quantity::ConfigurationJacobian => plain("Their derivatives by the dependent coordinates", "J"),
            Quantity::ConstraintResidual => plain("Velocity constraints", "r"),
            Quantity::Contact(index, quantity) => {
                let contact =
                    self.mechanism.contacts.get(index as usize).map_or("?", |contact| &contact.name);
                let (what, symbol) = contact_heading(quantity);
                (format!("Contact {contact}: {what}"), symbol.to_owned())
            }
            Quantity::Point(index, quantity) => {
                let point = self.mechanism.points.get(index as usize).map_or("?", |point| &point.name);
                let (what, symbol) = match quantity {
                    PointQuantity::Position => ("position along N.x, N.y, N.z", "p"),
                    PointQuantity::Velocity => ("velocity along N.x, N.y, N.z", "v"),
                    PointQuantity::Jacobian => ("partial velocities", "V"),
                };
                (format!("Point {point}: {what}"), symbol.to_owned())
            }
            Quantity::Orientation(index) => {
                let frame = self.mechanism.frames.get(index as usize).map_or("?", |frame| &frame.name);
                (format!("Frame {frame}: its axes in N"), "R".to_owned())
            }
        }
    }
}

fn contact_heading(quantity: ContactQuantity) -> (&'static str, &'static str) {
    match quantity {
        ContactQuantity::Normal => ("normal along N.x, N.y, N.z", "n"),
        ContactQuantity::First => ("first tangential axis along N.x, N.y, N.z", "t"),
        ContactQuantity::Second => ("second tangential axis along N.x, N.y, N.z", "s"),
        ContactQuantity::Velocity => ("relative velocity along n, t, s", "v"),
        ContactQuantity::PartialVelocities => ("partial velocities: rows n, t, s", "V"),
        ContactQuantity::Remainder => ("velocity that depends on no speed, along n, t, s", "r"),
        ContactQuantity::Reduced => ("reduced matrix: nn, nt, ns, tt, ts, ss", "m"),
        ContactQuantity::Response => ("change of the speeds per unit impulse", "R"),
        ContactQuantity::DependentResponse => ("change of the dependent speeds per unit impulse", "D"),
        ContactQuantity::Gap => ("gap", "d"),
        ContactQuantity::PrescribedWork => ("work of prescribed motion per unit impulse", "w"),
        ContactQuantity::Tangent => ("derivatives of velocity, reduced matrix, response and gap", "l"),
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
    }
}
