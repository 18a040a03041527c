//! Equations as a LaTeX document.

use super::{Document, Left, Rank, Term, decimal};

pub fn write(document: &Document) -> String {
    let mut out = "\\documentclass{article}\n\\usepackage{amsmath}\n\\usepackage[margin=2cm]{geometry}\n\
                   \\allowdisplaybreaks\n\\begin{document}\n"
        .to_owned();
    out += &format!("\\section*{{{}}}\n{}\n", plain(&document.title), plain(&document.docs));
    for (title, entries) in &document.names {
        out += &format!("\\subsection*{{{title}}}\n\\begin{{description}}\n");
        for entry in entries {
            out +=
                &format!("\\item[${}$] [{}] {}\n", name(&entry.name), plain(&entry.unit), plain(&entry.docs));
        }
        out += "\\end{description}\n";
    }
    for section in &document.sections {
        out += &format!("\\subsection*{{{}}}\n", plain(&section.title));
        let lines: Vec<String> = section
            .equations
            .iter()
            .map(|equation| format!("{} &= {}", left(&equation.left), term(&equation.right, Rank::Sum)))
            .collect();
        if !lines.is_empty() {
            out += &format!("\\begin{{align*}}\n{}\n\\end{{align*}}\n", lines.join(" \\\\\n"));
        }
    }
    out + "\\end{document}\n"
}

/// Text with what LaTeX would take for its own.
fn plain(text: &str) -> String {
    let mut out = String::new();
    for letter in text.chars() {
        match letter {
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '#' | '$' | '%' | '&' | '_' | '{' | '}' => out.extend(['\\', letter]),
            _ => out.push(letter),
        }
    }
    out
}

const GREEK: [&str; 30] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu",
    "nu", "xi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta",
    "Lambda", "Sigma", "Phi", "Psi", "Omega",
];

/// `q1` is q with the index 1, `gamma` a Greek letter, `m_arm` m with the index arm.
fn name(text: &str) -> String {
    let digits = text.trim_start_matches(|c: char| c.is_alphabetic());
    let (head, index) = match text.split_once('_') {
        Some((head, index)) if !head.is_empty() && !index.is_empty() => (head, index),
        _ if digits.len() < text.len() => (&text[..text.len() - digits.len()], digits),
        _ => (text, ""),
    };
    let head = match head {
        _ if GREEK.contains(&head) => format!("\\{head}"),
        _ if head.chars().count() == 1 => plain(head),
        _ => format!("\\mathrm{{{}}}", plain(head)),
    };
    if index.is_empty() { head } else { format!("{head}_{{\\mathrm{{{}}}}}", plain(index)) }
}

fn left(left: &Left) -> String {
    match left {
        Left::Z(index) => format!("z_{{{index}}}"),
        Left::Of(text, false) => name(text),
        Left::Of(text, true) => format!("\\tfrac{{d}}{{dt}} {}", name(text)),
        Left::Entry(symbol, Some(row), Some(column)) => format!("{symbol}_{{{row},{column}}}"),
        Left::Entry(symbol, Some(index), None) | Left::Entry(symbol, None, Some(index)) => {
            format!("{symbol}_{{{index}}}")
        }
        Left::Entry(symbol, None, None) => symbol.clone(),
    }
}

fn term(term: &Term, needed: Rank) -> String {
    let text = match term {
        Term::Number(number) => {
            decimal(*number).replace('e', " \\cdot 10^{")
                + if decimal(*number).contains('e') { "}" } else { "" }
        }
        Term::Name(text) if text == "time" => "t".to_owned(),
        Term::Name(text) => name(text),
        Term::Rate(text) => format!("\\dot{{{}}}", name(text)),
        Term::Z(index) => format!("z_{{{index}}}"),
        Term::Neg(inner) => format!("-{}", self::term(inner, Rank::Product)),
        Term::Sum(terms) => {
            let mut out = String::new();
            for (index, part) in terms.iter().enumerate() {
                let (minus, part) = part.unsigned();
                out += if minus { "-" } else { ["", "+"][usize::from(index > 0)] };
                out += &self::term(&part, Rank::Product);
            }
            out
        }
        Term::Product(factors) => {
            factors.iter().map(|factor| self::term(factor, Rank::Product)).collect::<Vec<_>>().join(" \\, ")
        }
        Term::Quotient(a, b) => {
            format!("\\frac{{{}}}{{{}}}", self::term(a, Rank::Sum), self::term(b, Rank::Sum))
        }
        Term::Power(base, n) => match &**base {
            Term::Call(function @ ("sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh"), arguments) => {
                format!("\\{function}^{{{n}}} {}", self::term(&arguments[0], Rank::Atom))
            }
            base => format!("{}^{{{n}}}", self::term(base, Rank::Atom)),
        },
        Term::Call("sqrt", arguments) => format!("\\sqrt{{{}}}", self::term(&arguments[0], Rank::Sum)),
        Term::Call("abs", arguments) => format!("\\left|{}\\right|", self::term(&arguments[0], Rank::Sum)),
        Term::Call(function @ ("sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "log"), arguments) => {
            format!("\\{function} {}", self::term(&arguments[0], Rank::Atom))
        }
        Term::Call(function, arguments) => {
            let arguments: Vec<String> = arguments.iter().map(|term| self::term(term, Rank::Sum)).collect();
            format!("\\operatorname{{{function}}}\\left({}\\right)", arguments.join(", "))
        }
    };
    if term.rank() < needed { format!("\\left({text}\\right)") } else { text }
}
