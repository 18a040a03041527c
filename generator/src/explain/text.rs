//! Equations as plain text.

use super::{Document, Left, Rank, Term, decimal};

pub fn write(document: &Document) -> String {
    let mut out = format!("{}\n{}\n", document.title, "=".repeat(document.title.chars().count()));
    if !document.docs.is_empty() {
        out += &format!("\n{}\n", document.docs);
    }
    for (title, entries) in &document.names {
        out += &format!("\n{title}\n");
        for entry in entries {
            let docs = if entry.docs.is_empty() { String::new() } else { format!(": {}", entry.docs) };
            out += &format!("  {} [{}]{docs}\n", entry.name, entry.unit);
        }
    }
    for section in &document.sections {
        out += &format!("\n{}\n", section.title);
        for equation in &section.equations {
            out += &format!("  {} = {}\n", left(&equation.left), term(&equation.right, Rank::Sum));
        }
    }
    out
}

fn left(left: &Left) -> String {
    match left {
        Left::Z(index) => format!("z{index}"),
        Left::Of(name, false) => name.clone(),
        Left::Of(name, true) => format!("d({name})/dt"),
        Left::Entry(symbol, Some(row), Some(column)) => format!("{symbol}[{row},{column}]"),
        Left::Entry(symbol, Some(index), None) | Left::Entry(symbol, None, Some(index)) => {
            format!("{symbol}[{index}]")
        }
        Left::Entry(symbol, None, None) => symbol.clone(),
    }
}

/// A term, in brackets where something of at least this rank is needed.
fn term(term: &Term, needed: Rank) -> String {
    let text = match term {
        Term::Number(number) => decimal(*number),
        Term::Name(name) => name.clone(),
        Term::Rate(name) => format!("d({name})/dt"),
        Term::Z(index) => format!("z{index}"),
        Term::Neg(inner) => format!("-{}", self::term(inner, Rank::Product)),
        Term::Sum(terms) => {
            let mut out = String::new();
            for (index, part) in terms.iter().enumerate() {
                let (minus, part) = part.unsigned();
                out += match (index, minus) {
                    (0, false) => "",
                    (0, true) => "-",
                    (_, false) => " + ",
                    (_, true) => " - ",
                };
                out += &self::term(&part, Rank::Product);
            }
            out
        }
        Term::Product(factors) => {
            // A quotient that is not the first factor would take in what stands before it.
            let factors = factors.iter().enumerate().map(|(index, factor)| match factor {
                Term::Quotient(..) if index > 0 => self::term(factor, Rank::Atom),
                _ => self::term(factor, Rank::Product),
            });
            factors.collect::<Vec<_>>().join("*")
        }
        Term::Quotient(a, b) => format!("{}/{}", self::term(a, Rank::Product), self::term(b, Rank::Atom)),
        Term::Power(base, n) => format!("{}^{n}", self::term(base, Rank::Atom)),
        Term::Call(name, arguments) => {
            let arguments: Vec<String> = arguments.iter().map(|term| self::term(term, Rank::Sum)).collect();
            format!("{name}({})", arguments.join(", "))
        }
    };
    if term.rank() < needed { format!("({text})") } else { text }
}
