//! Writes equations as plain text.

use super::symbols::{Form, form, unit};
use super::{Document, Equation, Left, Rank, Term};

/// The greatest length of a line, if a sum can be broken.
const WIDTH: usize = 110;
/// The sign between factors.
const TIMES: &str = "·";

pub fn write(document: &Document) -> String {
    let mut out = format!("{}\n{}\n", document.title, "=".repeat(document.title.chars().count()));
    if !document.docs.is_empty() {
        out += &format!("\n{}\n", document.docs);
    }
    for (title, entries) in &document.names {
        out += &format!("\n{title}\n");
        for entry in entries {
            let docs = if entry.docs.is_empty() { String::new() } else { format!(": {}", entry.docs) };
            let unit = unit(&entry.unit);
            let unit = if unit.is_empty() { "1" } else { unit.as_str() };
            let value = entry.value.map_or(String::new(), |value| format!(" ({value} in the model)"));
            out += &format!("  {} [{unit}]{value}{docs}\n", entry.name);
        }
    }
    for section in &document.sections {
        out += &format!("\n{}\n", section.line());
        let lefts = section.equations.iter().map(|equation| left(document, &equation.left).chars().count());
        let widest = lefts.max().unwrap_or(0);
        for equation in &section.equations {
            let left = left(document, &equation.left);
            let lines = lines(document, &equation.right, WIDTH - widest - 5);
            let indent = " ".repeat(widest + 5);
            out += &format!("  {left:widest$} = {}\n", lines.join(&format!("\n{indent}")));
        }
    }
    out
}

/// An equation in one line.
pub fn equation(document: &Document, equation: &Equation) -> String {
    let writer = Writer { letter: document.symbols.letter };
    format!("{} = {}", left(document, &equation.left), writer.term(&equation.right, Rank::Sum))
}

fn left(document: &Document, left: &Left) -> String {
    match left {
        Left::Z(index) => format!("{}{index}", document.symbols.letter),
        Left::Of(name, false) => name.clone(),
        Left::Of(name, true) => format!("d({name})/dt"),
        Left::Entry(symbol, indices) if indices.is_empty() => symbol.clone(),
        Left::Entry(symbol, indices) => format!("{symbol}[{}]", indices.join(",")),
    }
}

/// A right side, broken before the signs of its summands.
fn lines(document: &Document, right: &Term, width: usize) -> Vec<String> {
    let writer = Writer { letter: document.symbols.letter };
    let Term::Sum(terms) = right else { return vec![writer.term(right, Rank::Sum)] };
    let mut lines = vec![String::new()];
    for (index, part) in terms.iter().enumerate() {
        let summand = writer.summand(index, part);
        let full = |line: &String| line.chars().count() + summand.chars().count() > width;
        match lines.last_mut() {
            Some(line) if index == 0 || !full(line) => line.push_str(&summand),
            _ => lines.push(summand.trim_start().to_owned()),
        }
    }
    lines
}

struct Writer {
    /// the letter of intermediate symbols
    letter: &'static str,
}

impl Writer {
    /// A summand with its sign.
    fn summand(&self, index: usize, part: &Term) -> String {
        let (minus, part) = part.unsigned();
        let sign = match (index, minus) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        format!("{sign}{}", self.term(&part, Rank::Product))
    }

    /// A term, in brackets if its rank is below `needed`.
    fn term(&self, term: &Term, needed: Rank) -> String {
        let text = match term {
            Term::Number(number) => self.number(*number, needed),
            Term::Name(name) => name.clone(),
            Term::Rate(name) => format!("d({name})/dt"),
            Term::Z(index) => format!("{}{index}", self.letter),
            Term::Neg(inner) => format!("-{}", self.term(inner, Rank::Product)),
            Term::Sum(terms) => {
                terms.iter().enumerate().map(|(index, part)| self.summand(index, part)).collect()
            }
            Term::Product(factors) => {
                // A quotient after another factor needs brackets: `a·b/c` would divide `a`, too.
                let factors = factors.iter().enumerate().map(|(index, factor)| match factor {
                    Term::Quotient(..) if index > 0 => self.term(factor, Rank::Atom),
                    _ => self.term(factor, Rank::Product),
                });
                factors.collect::<Vec<_>>().join(TIMES)
            }
            Term::Quotient(a, b) => {
                format!("{}/{}", self.term(a, Rank::Product), self.term(b, Rank::Atom))
            }
            Term::Power(base, n) => format!("{}^{n}", self.term(base, Rank::Atom)),
            Term::Call(name, arguments) => {
                let arguments: Vec<String> =
                    arguments.iter().map(|term| self.term(term, Rank::Sum)).collect();
                format!("{name}({})", arguments.join(", "))
            }
        };
        if term.rank() < needed { format!("({text})") } else { text }
    }

    fn number(&self, number: f64, needed: Rank) -> String {
        let sign = if number < 0.0 { "-" } else { "" };
        match form(number.abs()) {
            Form::Decimal(text) => format!("{sign}{text}"),
            Form::Ratio(a, b) if needed == Rank::Atom && number > 0.0 => format!("({a}/{b})"),
            Form::Ratio(a, b) => format!("{sign}{a}/{b}"),
            Form::Power(mantissa, exponent) => {
                let mantissa = if mantissa == "1" { String::new() } else { format!("{mantissa}{TIMES}") };
                let text = format!("{sign}{mantissa}10^{exponent}");
                if needed == Rank::Atom && number > 0.0 { format!("({text})") } else { text }
            }
        }
    }
}
