//! Writes the equations of a mechanism for people: as text, LaTeX or HTML.
//!
//! The operations of a program are converted back to expressions; like terms are collected, and operations
//! that only correct rounding are left out. An expression that is used more than once, or would make a line
//! too long, gets a name: z1, z2 .. as in the paper.

mod arithmetic;
mod collect;
mod exact;
mod headings;
mod html;
mod latex;
pub mod symbols;
mod text;

use crate::program::Program;
use crate::program::Quantity;
use crate::program::operation::Stage;
use hodograph_model::model::mechanism::Mechanism;

/// The format of written equations.
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

/// The quantities of the program that a reader of the paper looks for.
pub fn usual(program: &Program) -> Vec<Quantity> {
    let wanted = |quantity: &Quantity| quantity.description().usual;
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

/// The precedence of a term, which decides where brackets are needed.
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

    /// The absolute term, and whether the term has a minus sign.
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

/// An equation: left side and right side.
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
    /// an entry of a quantity: its symbol, and its indices where it has more than one entry
    Entry(String, Vec<String>),
    /// a quantity that belongs to a name of the model; `true` if it is the rate of that name
    Of(String, bool),
}

/// Equations under a heading.
#[derive(Clone, Debug)]
struct Section {
    /// the contact, point or frame that the equations belong to; may be empty
    group: String,
    title: String,
    /// may be empty
    unit: String,
    /// the symbol of the whole quantity; `None` if its entries have names of the model
    symbol: Option<String>,
    /// for each row of a matrix the indices of its equations; empty if the quantity is not a matrix
    matrix: Vec<Vec<usize>>,
    equations: Vec<Equation>,
}

/// An entry of a matrix with more symbols than this is written as an equation below the matrix.
const SHORT: usize = 4;
/// The same limit for matrices with more than [`MANY_COLUMNS`] columns.
const SHORTEST: usize = 2;
const MANY_COLUMNS: usize = 4;

/// The heading of intermediate symbols.
const INTERMEDIATE: &str = "Intermediate symbols";

impl Section {
    /// The heading in one line.
    fn line(&self) -> String {
        match self.group.is_empty() || self.group == INTERMEDIATE {
            true => self.title.clone(),
            false => format!("{}: {}", self.group, self.title),
        }
    }

    /// The matrix of a section if it is worth showing: in each place the term, or the equation that is
    /// written below the matrix. Second, the equations to be written.
    fn laid_out(&self) -> (Vec<Vec<Place<'_>>>, Vec<&Equation>) {
        let many = self.matrix.first().is_some_and(|row| row.len() > MANY_COLUMNS);
        let short = if many { SHORTEST } else { SHORT };
        let is_short =
            |equation: &Equation| collect::size(&equation.right) <= short && is_flat(&equation.right);
        let vector = self.matrix.iter().all(|row| row.len() == 1);
        if self.matrix.is_empty() || (vector && !self.equations.iter().all(is_short)) {
            return (Vec::new(), self.equations.iter().collect());
        }
        let mut below: Vec<usize> = Vec::new();
        let mut places = Vec::new();
        for (row, line) in self.matrix.iter().enumerate() {
            let mut cells = Vec::new();
            for (column, &index) in line.iter().enumerate() {
                let equation = &self.equations[index];
                if is_short(equation) {
                    cells.push(Place::Term(&equation.right));
                    continue;
                }
                // The lower triangle of a symmetric matrix refers to the upper one.
                let mirror = self.matrix.get(column).and_then(|line| line.get(row)).copied();
                let index =
                    mirror.filter(|&mirror| column < row && self.equations[mirror].right == equation.right);
                let index = index.unwrap_or(line[column]);
                if !below.contains(&index) {
                    below.push(index);
                }
                cells.push(Place::Symbol(&self.equations[index].left));
            }
            places.push(cells);
        }
        (places, below.into_iter().map(|index| &self.equations[index]).collect())
    }
}

/// Whether every part of a term fits on the height of a line.
fn is_flat(term: &Term) -> bool {
    match term {
        Term::Number(_) | Term::Name(_) | Term::Rate(_) | Term::Z(_) => true,
        Term::Neg(term) | Term::Power(term, _) => is_flat(term),
        Term::Sum(terms) | Term::Product(terms) | Term::Call(_, terms) => terms.iter().all(is_flat),
        Term::Quotient(..) => false,
    }
}

/// The content of a place of a matrix.
enum Place<'a> {
    Term(&'a Term),
    Symbol(&'a Left),
}

/// A name of the model with its documentation.
#[derive(Clone, Debug)]
struct Entry {
    name: String,
    unit: String,
    docs: String,
    /// the value in the model, in its unit
    value: Option<f64>,
}

/// The content of a document.
#[derive(Clone, Debug)]
struct Document {
    title: String,
    docs: String,
    symbols: symbols::Symbols,
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

#[cfg(test)]
mod tests;
