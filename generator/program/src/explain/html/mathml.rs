//! Writes terms as MathML.
//!
//! A long right side is written as several `math` elements, one for each summand, between which a browser may
//! break the line; MathML itself has no line breaks.

use super::super::symbols::{Form, Symbol, Symbols, form};
use super::super::{Left, Rank, Term};
use super::escape::plain;

/// The sign between factors.
const TIMES: &str = "<mo lspace=\"0.12em\" rspace=\"0.12em\">&#x22C5;</mo>";
const PLUS: &str = "<mo form=\"infix\">+</mo>";
const MINUS: &str = "<mo form=\"infix\">&#x2212;</mo>";
const SIGN: &str = "<mo form=\"prefix\">&#x2212;</mo>";
const OPEN: &str = "<mo form=\"prefix\" stretchy=\"false\">(</mo>";
const CLOSE: &str = "<mo form=\"postfix\" stretchy=\"false\">)</mo>";
/// A bracketed factor with more symbols than this may be broken at its signs.
const BREAKABLE: usize = 4;

/// Writes terms with the symbols of a mechanism.
pub struct Writer<'a> {
    pub symbols: &'a Symbols,
}

/// A `math` element.
pub fn math(inner: &str) -> String {
    format!("<math displaystyle=\"true\">{inner}</math>")
}

/// A letter, which browsers set italic, or a word, which stands upright.
pub fn identifier(text: &str) -> String {
    format!("<mi>{}</mi>", plain(&text.replace('\'', "\u{2032}")))
}

/// A base with an index and an exponent, each of which may be empty.
fn scripted(base: String, index: &str, exponent: &str) -> String {
    if index.is_empty() {
        return if exponent.is_empty() { base } else { format!("<msup>{base}{exponent}</msup>") };
    }
    let parts = index.split(',').map(|part| {
        let number = part.bytes().all(|digit| digit.is_ascii_digit());
        let tag = if number { "mn" } else { "mi" };
        format!("<{tag}>{}</{tag}>", plain(part))
    });
    let parts = parts.collect::<Vec<_>>().join("<mo separator=\"true\" rspace=\"0\">,</mo>");
    match exponent.is_empty() {
        true => format!("<msub>{base}<mrow>{parts}</mrow></msub>"),
        false => format!("<msubsup>{base}<mrow>{parts}</mrow>{exponent}</msubsup>"),
    }
}

fn symbol(symbol: &Symbol, exponent: &str) -> String {
    scripted(identifier(&symbol.head), &symbol.index, exponent)
}

fn rate(symbol: &Symbol) -> String {
    let head = identifier(&symbol.head);
    scripted(format!("<mover accent=\"true\">{head}<mo>&#x2D9;</mo></mover>"), &symbol.index, "")
}

fn number(number: f64) -> String {
    match form(number) {
        Form::Decimal(text) => format!("<mn>{text}</mn>"),
        Form::Ratio(a, b) => format!("<mfrac><mn>{a}</mn><mn>{b}</mn></mfrac>"),
        Form::Power(mantissa, exponent) => {
            let exponent = match exponent < 0 {
                true => format!("<mrow>{SIGN}<mn>{}</mn></mrow>", -exponent),
                false => format!("<mn>{exponent}</mn>"),
            };
            let power = format!("<msup><mn>10</mn>{exponent}</msup>");
            match mantissa.as_str() {
                "1" => power,
                _ => format!("<mrow><mn>{mantissa}</mn>{TIMES}{power}</mrow>"),
            }
        }
    }
}

fn bracketed(inner: &str) -> String {
    format!("<mrow>{OPEN}<mrow>{inner}</mrow>{CLOSE}</mrow>")
}

impl Writer<'_> {
    /// The symbol of a name.
    pub fn name(&self, name: &str) -> String {
        symbol(&self.symbols.of(name), "")
    }

    fn z(&self, index: usize, exponent: &str) -> String {
        scripted(identifier(self.symbols.letter), &index.to_string(), exponent)
    }

    /// The left side of an equation.
    pub fn left(&self, left: &Left) -> String {
        match left {
            Left::Z(index) => self.z(*index, ""),
            Left::Of(name, false) => self.name(name),
            Left::Of(name, true) => rate(&self.symbols.of(name)),
            Left::Entry(symbol, indices) => scripted(identifier(symbol), &indices.join(","), ""),
        }
    }

    /// A right side in pieces, between which a line may be broken.
    pub fn pieces(&self, term: &Term) -> Vec<String> {
        match term {
            Term::Sum(terms) => self.summands(terms),
            Term::Neg(inner) => {
                let mut pieces = self.factors(inner, Rank::Product);
                pieces[0].insert_str(0, SIGN);
                pieces
            }
            _ => self.factors(term, Rank::Sum),
        }
    }

    fn summands(&self, terms: &[Term]) -> Vec<String> {
        let mut all = Vec::new();
        for (index, part) in terms.iter().enumerate() {
            let (minus, part) = part.unsigned();
            let mut pieces = self.factors(&part, Rank::Product);
            let sign = match (minus, index) {
                (true, 0) => SIGN,
                (false, 0) => "",
                (true, _) => MINUS,
                (false, _) => PLUS,
            };
            pieces[0].insert_str(0, sign);
            all.append(&mut pieces);
        }
        all
    }

    /// A summand in pieces: a bracketed factor may be broken at its signs.
    fn factors(&self, term: &Term, needed: Rank) -> Vec<String> {
        let long = |term: &Term| {
            matches!(term, Term::Sum(_))
                && super::super::collect::size(term) > BREAKABLE
                && super::super::is_flat(term)
        };
        let Term::Product(factors) = term else { return vec![self.term(term, needed)] };
        if !factors.iter().any(long) {
            return vec![self.term(term, needed)];
        }
        let mut pieces = vec![String::new()];
        for (index, factor) in factors.iter().enumerate() {
            let times = if index > 0 { TIMES } else { "" };
            let mut more = match factor {
                Term::Sum(terms) if long(factor) => {
                    let mut inner = self.summands(terms);
                    inner[0].insert_str(0, OPEN);
                    if let Some(last) = inner.last_mut() {
                        last.push_str(CLOSE);
                    }
                    inner
                }
                _ => vec![self.term(factor, Rank::Product)],
            };
            let first = more.remove(0);
            if let Some(last) = pieces.last_mut() {
                last.push_str(times);
                last.push_str(&first);
            }
            pieces.append(&mut more);
        }
        pieces
    }

    /// A term in one piece, in brackets if its rank is below `needed`.
    pub fn term(&self, term: &Term, needed: Rank) -> String {
        let text = match term {
            Term::Number(value) if *value < 0.0 => format!("{SIGN}{}", number(-value)),
            Term::Number(value) => number(*value),
            Term::Name(name) => self.name(name),
            Term::Rate(name) => rate(&self.symbols.of(name)),
            Term::Z(index) => self.z(*index, ""),
            Term::Neg(inner) => format!("{SIGN}{}", self.term(inner, Rank::Product)),
            Term::Sum(terms) => self.summands(terms).concat(),
            Term::Product(factors) => {
                let factors: Vec<String> =
                    factors.iter().map(|factor| self.term(factor, Rank::Product)).collect();
                factors.join(TIMES)
            }
            Term::Quotient(a, b) => {
                let (a, b) = (self.term(a, Rank::Sum), self.term(b, Rank::Sum));
                format!("<mfrac><mrow>{a}</mrow><mrow>{b}</mrow></mfrac>")
            }
            Term::Power(base, n) => self.power(base, *n),
            Term::Call(function, arguments) => self.call(function, arguments, ""),
        };
        let bare = matches!(term, Term::Sum(_) | Term::Product(_) | Term::Neg(_));
        match term.rank() < needed {
            true => bracketed(&text),
            false if bare && needed != Rank::Sum => format!("<mrow>{text}</mrow>"),
            false => text,
        }
    }

    fn power(&self, base: &Term, n: u32) -> String {
        let exponent = format!("<mn>{n}</mn>");
        match base {
            Term::Call(function @ ("sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh"), arguments) => {
                self.call(function, arguments, &exponent)
            }
            // A term that ends in a bracket, an index or a bar can bear an exponent; a fraction or a product
            // cannot.
            Term::Number(value) if !matches!(form(*value), Form::Decimal(_)) => {
                format!("<msup>{}{exponent}</msup>", bracketed(&self.term(base, Rank::Sum)))
            }
            Term::Name(name) => symbol(&self.symbols.of(name), &exponent),
            Term::Z(index) => self.z(*index, &exponent),
            Term::Number(value) => format!("<msup>{}{exponent}</msup>", number(*value)),
            _ => format!("<msup>{}{exponent}</msup>", bracketed(&self.term(base, Rank::Sum))),
        }
    }

    fn call(&self, function: &str, arguments: &[Term], exponent: &str) -> String {
        let all: Vec<String> = arguments.iter().map(|term| self.term(term, Rank::Sum)).collect();
        match (function, &all[..]) {
            ("sqrt", [inner]) => format!("<msqrt><mrow>{inner}</mrow></msqrt>"),
            ("abs", [inner]) => {
                let bar = |form| format!("<mo form=\"{form}\" stretchy=\"false\">|</mo>");
                format!("<mrow>{}<mrow>{inner}</mrow>{}</mrow>", bar("prefix"), bar("postfix"))
            }
            ("exp", [inner]) => format!("<msup><mi mathvariant=\"normal\">e</mi><mrow>{inner}</mrow></msup>"),
            _ => {
                let name = match function {
                    "log" => "ln",
                    "asin" => "arcsin",
                    "acos" => "arccos",
                    "atan" => "arctan",
                    "sign" => "sgn",
                    other => other,
                };
                let name = match exponent {
                    "" => format!("<mi>{name}</mi>"),
                    _ => format!("<msup><mi>{name}</mi>{exponent}</msup>"),
                };
                let simple = matches!(arguments, [Term::Name(_) | Term::Z(_) | Term::Rate(_)])
                    && matches!(function, "sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "log");
                match simple {
                    true => format!("<mrow>{name}<mo rspace=\"0.16em\">&#x2061;</mo>{}</mrow>", all[0]),
                    false => {
                        let all = all.join("<mo separator=\"true\">,</mo>");
                        format!("<mrow>{name}<mo>&#x2061;</mo>{}</mrow>", bracketed(&all))
                    }
                }
            }
        }
    }
}
