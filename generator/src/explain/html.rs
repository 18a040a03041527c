//! Equations as an HTML page with MathML, which browsers show without help.

use super::{Document, Left, Rank, Term, decimal};

pub fn write(document: &Document) -> String {
    let title = plain(&document.title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>body \
         {{ font-family: sans-serif; margin: 2em; }} math {{ display: block; margin: 0.4em 0; }} td {{ padding-right: \
         1em; vertical-align: top; }}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    for paragraph in document.docs.split("\n\n").filter(|paragraph| !paragraph.trim().is_empty()) {
        out += &format!("<p>{}</p>\n", plain(paragraph));
    }
    for (title, entries) in &document.names {
        out += &format!("<h2>{title}</h2>\n<table>\n");
        for entry in entries {
            let (name, unit, docs) = (plain(&entry.name), plain(&entry.unit), plain(&entry.docs));
            out += &format!("<tr><td>{name}</td><td>{unit}</td><td>{docs}</td></tr>\n");
        }
        out += "</table>\n";
    }
    for section in &document.sections {
        out += &format!("<h2>{}</h2>\n", plain(&section.title));
        for equation in &section.equations {
            let (left, right) = (left(&equation.left), term(&equation.right, Rank::Sum));
            out += &format!("<math>{left}<mo>=</mo>{right}</math>\n");
        }
    }
    out + "</body>\n</html>\n"
}

fn plain(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A name; digits at its end become an index.
fn name(text: &str) -> String {
    let head = text.trim_end_matches(|c: char| c.is_ascii_digit());
    match (head, &text[head.len()..]) {
        ("", _) | (_, "") => format!("<mi>{}</mi>", plain(text)),
        (head, index) => format!("<msub><mi>{}</mi><mn>{index}</mn></msub>", plain(head)),
    }
}

fn left(left: &Left) -> String {
    match left {
        Left::Z(index) => format!("<msub><mi>z</mi><mn>{index}</mn></msub>"),
        Left::Of(text, false) => name(text),
        Left::Of(text, true) => format!("<mover>{}<mo>&#x2d9;</mo></mover>", name(text)),
        Left::Entry(symbol, Some(row), Some(column)) => {
            format!("<msub><mi>{symbol}</mi><mrow><mn>{row}</mn><mo>,</mo><mn>{column}</mn></mrow></msub>")
        }
        Left::Entry(symbol, Some(index), None) | Left::Entry(symbol, None, Some(index)) => {
            format!("<msub><mi>{symbol}</mi><mn>{index}</mn></msub>")
        }
        Left::Entry(symbol, None, None) => format!("<mi>{symbol}</mi>"),
    }
}

fn term(term: &Term, needed: Rank) -> String {
    let text = match term {
        Term::Number(number) => format!("<mn>{}</mn>", decimal(*number)),
        Term::Name(text) if text == "time" => "<mi>t</mi>".to_owned(),
        Term::Name(text) => name(text),
        Term::Rate(text) => format!("<mover>{}<mo>&#x2d9;</mo></mover>", name(text)),
        Term::Z(index) => format!("<msub><mi>z</mi><mn>{index}</mn></msub>"),
        Term::Neg(inner) => format!("<mo>-</mo>{}", self::term(inner, Rank::Product)),
        Term::Sum(terms) => {
            let mut out = String::new();
            for (index, part) in terms.iter().enumerate() {
                let (minus, part) = part.unsigned();
                out += if minus { "<mo>-</mo>" } else { ["", "<mo>+</mo>"][usize::from(index > 0)] };
                out += &self::term(&part, Rank::Product);
            }
            out
        }
        Term::Product(factors) => factors.iter().map(|factor| self::term(factor, Rank::Product)).collect(),
        Term::Quotient(a, b) => {
            let (a, b) = (self::term(a, Rank::Sum), self::term(b, Rank::Sum));
            format!("<mfrac><mrow>{a}</mrow><mrow>{b}</mrow></mfrac>")
        }
        Term::Power(base, n) => {
            format!("<msup><mrow>{}</mrow><mn>{n}</mn></msup>", self::term(base, Rank::Atom))
        }
        Term::Call("sqrt", arguments) => format!("<msqrt>{}</msqrt>", self::term(&arguments[0], Rank::Sum)),
        Term::Call(function, arguments) => {
            let arguments: Vec<String> = arguments.iter().map(|term| self::term(term, Rank::Sum)).collect();
            format!("<mi>{function}</mi><mo>(</mo>{}<mo>)</mo>", arguments.join("<mo>,</mo>"))
        }
    };
    let text = if term.rank() < needed { format!("<mo>(</mo>{text}<mo>)</mo>") } else { text };
    format!("<mrow>{text}</mrow>")
}
