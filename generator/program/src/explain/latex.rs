//! Writes equations as a LaTeX document.

use super::collect::size;
use super::symbols::{Form, Symbol, form, greek_name, unit};
use super::{Document, Equation, Left, Place, Rank, Section, Term};

/// The largest number of symbols on a line of an equation.
const LINE: usize = 14;

const HEAD: &str = "\\documentclass[a4paper]{article}\n\\usepackage[T1]{fontenc}\n\\usepackage{textcomp}\n\\usepackage{amsmath}\n\
                    \\usepackage[margin=2cm]{geometry}\n\\allowdisplaybreaks\n\\setcounter{MaxMatrixCols}{60}\n\\setlength{\\parindent}{0pt}\n\
                    \\begin{document}\n";

pub fn write(document: &Document) -> String {
    let mut out = HEAD.to_owned();
    out += &format!("\\section*{{{}}}\n{}\n", plain(&document.title), plain(&document.docs));
    let writer = Writer { document };
    for (title, entries) in &document.names {
        out += &format!("\\subsection*{{{title}}}\n\\begin{{description}}\n");
        for entry in entries {
            let unit = unit(&entry.unit);
            let unit = if unit.is_empty() { "1" } else { unit.as_str() };
            let name = writer.name(&entry.name);
            let value = entry.value.map_or(String::new(), |value| format!(" ${}$", number(value)));
            out += &format!("\\item[${name}$] {{[}}{}{{]}}{value} {}\n", plain(unit), plain(&entry.docs));
        }
        out += "\\end{description}\n";
    }
    for section in &document.sections {
        out += &format!("\\subsection*{{{}}}\n", plain(&section.line()));
        out += &writer.section(section);
    }
    out + "\\end{document}\n"
}

/// Text with the special characters of LaTeX escaped; letters that its fonts lack are written by their code
/// points.
fn plain(text: &str) -> String {
    let mut out = String::new();
    for letter in text.chars() {
        match letter {
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '#' | '$' | '%' | '&' | '_' | '{' | '}' => out.extend(['\\', letter]),
            '"' => out.push_str("\\textquotedbl{}"),
            '·' => out.push_str("\\textperiodcentered{}"),
            '−' => out.push_str("$-$"),
            '⁻' => out.push_str("$^{-}$"),
            '⁰' => out.push_str("$^{0}$"),
            '¹' => out.push_str("$^{1}$"),
            '²' => out.push_str("$^{2}$"),
            '³' => out.push_str("$^{3}$"),
            '⁴'..='⁹' => out.push_str(&format!("$^{{{}}}$", letter as u32 - '⁰' as u32)),
            '\n'
            | ' '..='~'
            | '\u{a1}'..='\u{ac}'
            | '\u{ae}'..='\u{17e}'
            | '\u{2018}'..='\u{201d}'
            | '–'
            | '—' => out.push(letter),
            _ => match greek_name(letter) {
                Some(name) => out.push_str(&format!("$\\{name}$")),
                None if letter.is_control() => {}
                None => out.push_str(&format!("U+{:04X}", letter as u32)),
            },
        }
    }
    out
}

/// A letter or word in a formula.
fn identifier(text: &str) -> String {
    let mut rest = text;
    let mut out = String::new();
    while let Some((name, letter)) =
        rest.chars().next().and_then(|letter| Some((greek_name(letter)?, letter)))
    {
        out += &format!("\\{name}{{}}");
        rest = &rest[letter.len_utf8()..];
    }
    match rest.trim_end_matches('\'').chars().count() {
        0 => format!("{out}{rest}"),
        1 if rest.is_ascii() => format!("{out}{}", plain(rest)),
        1.. => format!("{out}\\mathrm{{{}}}", text_in_formula(rest)),
    }
}

fn text_in_formula(text: &str) -> String {
    if text.is_ascii() { plain(text) } else { format!("\\text{{{}}}", plain(text)) }
}

fn with_index(base: &str, index: &str) -> String {
    if index.is_empty() {
        return base.to_owned();
    }
    let part = |part: &str| match part.chars().count() {
        1 if part.is_ascii() => plain(part),
        _ if part.bytes().all(|digit| digit.is_ascii_digit()) => part.to_owned(),
        _ => format!("\\mathrm{{{}}}", text_in_formula(part)),
    };
    format!("{base}_{{{}}}", index.split(',').map(part).collect::<Vec<_>>().join(","))
}

fn symbol(symbol: &Symbol) -> String {
    with_index(&identifier(&symbol.head), &symbol.index)
}

fn rate(symbol: &Symbol) -> String {
    with_index(&format!("\\dot{{{}}}", identifier(&symbol.head)), &symbol.index)
}

fn number(number: f64) -> String {
    let sign = if number < 0.0 { "-" } else { "" };
    match form(number.abs()) {
        Form::Decimal(text) => format!("{sign}{text}"),
        Form::Ratio(a, b) => format!("{sign}\\tfrac{{{a}}}{{{b}}}"),
        Form::Power(mantissa, exponent) if mantissa == "1" => format!("{sign}10^{{{exponent}}}"),
        Form::Power(mantissa, exponent) => format!("{sign}{mantissa} \\cdot 10^{{{exponent}}}"),
    }
}

struct Writer<'a> {
    document: &'a Document,
}

impl Writer<'_> {
    fn name(&self, name: &str) -> String {
        symbol(&self.document.symbols.of(name))
    }

    fn z(&self, index: usize) -> String {
        with_index(&identifier(self.document.symbols.letter), &index.to_string())
    }

    fn left(&self, left: &Left) -> String {
        match left {
            Left::Z(index) => self.z(*index),
            Left::Of(name, false) => self.name(name),
            Left::Of(name, true) => rate(&self.document.symbols.of(name)),
            Left::Entry(symbol, indices) => with_index(symbol, &indices.join(",")),
        }
    }

    fn section(&self, section: &Section) -> String {
        let (places, below) = section.laid_out();
        let mut out = String::new();
        if !places.is_empty() {
            let cell = |place: &Place<'_>| match place {
                Place::Term(term) => self.term(term, Rank::Sum),
                Place::Symbol(left) => self.left(left),
            };
            let rows = places.iter().map(|row| row.iter().map(cell).collect::<Vec<_>>().join(" & "));
            let rows = rows.collect::<Vec<_>>().join(" \\\\\n");
            let symbol = section.symbol.as_ref().map_or(String::new(), |symbol| format!("{symbol} = "));
            out += &format!("\\[\n{symbol}\\begin{{bmatrix}}\n{rows}\n\\end{{bmatrix}}\n\\]\n");
        }
        let lines: Vec<String> = below.into_iter().map(|equation| self.equation(equation)).collect();
        if !lines.is_empty() {
            out += &format!("\\begin{{align*}}\n{}\n\\end{{align*}}\n", lines.join(" \\\\\n"));
        }
        out
    }

    /// An equation, a long right side in several lines.
    fn equation(&self, equation: &Equation) -> String {
        let mut out = format!("{} &= ", self.left(&equation.left));
        let mut used = 0;
        for (index, (piece, size)) in self.pieces(&equation.right).into_iter().enumerate() {
            if index > 0 && used + size > LINE {
                out.push_str(" \\\\\n&\\quad {} ");
                used = 0;
            }
            used += size;
            out.push_str(&piece);
        }
        out
    }

    /// A right side in pieces, between which a line may be broken, with the number of symbols of each.
    fn pieces(&self, term: &Term) -> Vec<(String, usize)> {
        match term {
            Term::Sum(terms) => self.summands(terms),
            _ => self.factors(term, Rank::Sum),
        }
    }

    fn summands(&self, terms: &[Term]) -> Vec<(String, usize)> {
        let mut all = Vec::new();
        for (index, part) in terms.iter().enumerate() {
            let (minus, part) = part.unsigned();
            let mut pieces = self.factors(&part, Rank::Product);
            let sign = if minus { "-" } else { ["", "+"][usize::from(index > 0)] };
            pieces[0].0.insert_str(0, sign);
            all.append(&mut pieces);
        }
        all
    }

    /// A summand in pieces: a long bracketed factor may be broken at its signs.
    fn factors(&self, term: &Term, needed: Rank) -> Vec<(String, usize)> {
        let long =
            |term: &Term| matches!(term, Term::Sum(_)) && size(term) > LINE / 2 && super::is_flat(term);
        let factors = match term {
            Term::Product(factors) if factors.iter().any(long) => factors,
            _ => return vec![(self.term(term, needed), size(term))],
        };
        let mut pieces = vec![(String::new(), 0)];
        for (index, factor) in factors.iter().enumerate() {
            let mut more = match factor {
                Term::Sum(terms) if long(factor) => {
                    let mut inner = self.summands(terms);
                    inner[0].0.insert(0, '(');
                    if let Some((last, _)) = inner.last_mut() {
                        last.push(')');
                    }
                    inner
                }
                _ => vec![(self.term(factor, Rank::Product), size(factor))],
            };
            let (first, symbols) = more.remove(0);
            if let Some((text, used)) = pieces.last_mut() {
                text.push_str(if index > 0 { " \\, " } else { "" });
                text.push_str(&first);
                *used += symbols;
            }
            pieces.append(&mut more);
        }
        pieces
    }

    fn summand(&self, index: usize, part: &Term) -> String {
        let (minus, part) = part.unsigned();
        let sign = if minus { "-" } else { ["", "+"][usize::from(index > 0)] };
        format!("{sign}{}", self.term(&part, Rank::Product))
    }

    fn term(&self, term: &Term, needed: Rank) -> String {
        let text = match term {
            Term::Number(value) => number(*value),
            Term::Name(name) => self.name(name),
            Term::Rate(name) => rate(&self.document.symbols.of(name)),
            Term::Z(index) => self.z(*index),
            Term::Neg(inner) => format!("-{}", self.term(inner, Rank::Product)),
            Term::Sum(terms) => {
                terms.iter().enumerate().map(|(index, part)| self.summand(index, part)).collect()
            }
            Term::Product(factors) => factors
                .iter()
                .map(|factor| self.term(factor, Rank::Product))
                .collect::<Vec<_>>()
                .join(" \\, "),
            Term::Quotient(a, b) => {
                format!("\\frac{{{}}}{{{}}}", self.term(a, Rank::Sum), self.term(b, Rank::Sum))
            }
            Term::Power(base, n) => self.power(base, *n),
            Term::Call("sqrt", arguments) => format!("\\sqrt{{{}}}", self.term(&arguments[0], Rank::Sum)),
            Term::Call("abs", arguments) => {
                format!("\\left|{}\\right|", self.term(&arguments[0], Rank::Sum))
            }
            Term::Call(function @ ("sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "log"), arguments) => {
                let function = if *function == "log" { "ln" } else { function };
                format!("\\{function} {}", self.argument(&arguments[0]))
            }
            Term::Call(function, arguments) => {
                let arguments: Vec<String> =
                    arguments.iter().map(|term| self.term(term, Rank::Sum)).collect();
                format!("\\operatorname{{{function}}}\\left({}\\right)", arguments.join(", "))
            }
        };
        if term.rank() < needed { format!("\\left({text}\\right)") } else { text }
    }

    /// The argument of a function: a single symbol as it is, anything else in brackets.
    fn argument(&self, term: &Term) -> String {
        match term {
            Term::Name(_) | Term::Z(_) | Term::Rate(_) => self.term(term, Rank::Atom),
            _ => format!("\\left({}\\right)", self.term(term, Rank::Sum)),
        }
    }

    fn power(&self, base: &Term, n: u32) -> String {
        match base {
            Term::Call(function @ ("sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh"), arguments) => {
                format!("\\{function}^{{{n}}} {}", self.argument(&arguments[0]))
            }
            Term::Name(_) | Term::Z(_) => format!("{{{}}}^{{{n}}}", self.term(base, Rank::Atom)),
            _ => format!("\\left({}\\right)^{{{n}}}", self.term(base, Rank::Sum)),
        }
    }
}
