//! The equations of a mechanism, to be read: as text, LaTeX or HTML.
//!
//! The operations of a program become expressions again, like terms collected and what only mends rounding left out. What is used
//! more than once, or would make a line too long, gets a name: z1, z2 .. as in the paper.

mod arithmetic;
mod collect;
mod exact;
mod html;
mod latex;
mod text;

use crate::model::mechanism::Mechanism;
use crate::program::Program;
use crate::program::operation::Stage;
use crate::program::{ContactQuantity, Quantity};

/// How equations are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// plain text
    Text,
    /// a LaTeX document
    Latex,
    /// an HTML page with MathML
    Html,
}

/// The equations of some quantities of a mechanism.
pub fn explain(mechanism: &Mechanism, program: &Program, quantities: &[Quantity], format: Format) -> String {
    let document = collect::collect(mechanism, program, quantities);
    match format {
        Format::Text => text::write(&document),
        Format::Latex => latex::write(&document),
        Format::Html => html::write(&document),
    }
}

/// The quantities that a reader of the paper looks for, as far as the program has them.
pub fn usual(program: &Program) -> Vec<Quantity> {
    let wanted = |quantity: &Quantity| match quantity {
        Quantity::CoordinateRates
        | Quantity::DependentSpeeds
        | Quantity::MassMatrix
        | Quantity::Forcing
        | Quantity::KineticEnergy => true,
        Quantity::Contact(_, quantity) => {
            use ContactQuantity::*;
            matches!(
                quantity,
                Normal | First | Second | Velocity | PartialVelocities | Remainder | Reduced | Gap
            )
        }
        _ => false,
    };
    program.outputs.iter().map(|output| output.quantity).filter(wanted).collect()
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
enum Term {
    Number(f64),
    /// a name of the model
    Name(String),
    /// the time derivative of a name
    Rate(String),
    /// an intermediate symbol, counted from 1
    Z(usize),
    Neg(Box<Term>),
    Sum(Vec<Term>),
    Product(Vec<Term>),
    Quotient(Box<Term>, Box<Term>),
    Power(Box<Term>, u32),
    Call(&'static str, Vec<Term>),
}

/// What stands where, to know where brackets are needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Sum,
    Product,
    Atom,
}

impl Term {
    fn rank(&self) -> Rank {
        match self {
            Term::Sum(_) | Term::Neg(_) => Rank::Sum,
            Term::Number(number) if *number < 0.0 => Rank::Sum,
            Term::Product(_) | Term::Quotient(..) => Rank::Product,
            _ => Rank::Atom,
        }
    }

    /// The term without its sign, and whether it has one.
    fn unsigned(&self) -> (bool, Term) {
        match self {
            Term::Neg(term) => (true, (**term).clone()),
            Term::Number(number) if *number < 0.0 => (true, Term::Number(-number)),
            Term::Product(factors) => match factors[..] {
                [Term::Number(number), ref rest @ ..] if number < 0.0 => {
                    let number = (number != -1.0).then_some(Term::Number(-number));
                    (true, product(number.into_iter().chain(rest.iter().cloned()).collect()))
                }
                _ => (false, self.clone()),
            },
            _ => (false, self.clone()),
        }
    }
}

/// A product of factors, which may be a single one.
fn product(mut factors: Vec<Term>) -> Term {
    if factors.len() == 1 { factors.remove(0) } else { Term::Product(factors) }
}

/// An equation: what it is for, and what that is.
#[derive(Clone, Debug)]
struct Equation {
    left: Left,
    right: Term,
}

/// The left side of an equation.
#[derive(Clone, Debug)]
enum Left {
    /// an intermediate symbol
    Z(usize),
    /// an entry of a quantity: its symbol, and a row and column where it has more than one
    Entry(String, Option<usize>, Option<usize>),
    /// a quantity that belongs to a name of the model, such as a rate
    Of(String, bool),
}

/// Equations under a heading.
#[derive(Clone, Debug)]
struct Section {
    title: String,
    equations: Vec<Equation>,
}

/// A name of the model and what it stands for.
#[derive(Clone, Debug)]
struct Entry {
    name: String,
    unit: String,
    docs: String,
}

/// Everything to be written.
#[derive(Clone, Debug)]
struct Document {
    title: String,
    docs: String,
    names: Vec<(&'static str, Vec<Entry>)>,
    sections: Vec<Section>,
}

/// Heading of the intermediate symbols of a stage.
fn stage_title(stage: Stage) -> &'static str {
    match stage {
        Stage::Constant => "Constants",
        Stage::Parameter => "From the parameters alone",
        Stage::Configuration => "From the configuration",
        Stage::Velocity => "From the speeds and loads",
    }
}

/// The shortest decimal that reads back exactly, without a trailing `.0`.
fn decimal(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests;
