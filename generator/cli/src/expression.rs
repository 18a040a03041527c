//! Expressions of numbers, and of functions of time, in the syntax of the model language.

use std::fmt;
use std::sync::Arc;

use hodograph_generator::syntax::tree::{Expr, ExprKind};
use hodograph_generator::syntax::{lexer, parse};

/// Greatest length of an expression, in characters.
const MAX_LENGTH: usize = 4096;

/// A node of an expression.
#[derive(Clone, Debug)]
enum Node {
    Number(f64),
    Time,
    Sum(Vec<(bool, Node)>),
    Product(Vec<(bool, Node)>),
    Power(Box<Node>, Box<Node>),
    Neg(Box<Node>),
    Call(fn(f64) -> f64, Box<Node>),
    Call2(fn(f64, f64) -> f64, Box<Node>, Box<Node>),
}

/// What is wrong with an expression, in a sentence.
#[derive(Clone, Debug, PartialEq)]
pub enum Mistake {
    /// it is no expression of this kind
    Unreadable(String),
    /// it has a name that does not exist
    UnknownName(String),
    /// its value is not finite
    NotFinite(String),
}

impl fmt::Display for Mistake {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Unreadable(what) | Self::UnknownName(what) | Self::NotFinite(what)) = self;
        out.write_str(what)
    }
}

/// What an expression is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sort {
    Number,
    OfTime,
}

impl Sort {
    fn name(self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::OfTime => "an expression of the time t",
        }
    }
}

/// A function of the time `t`.
///
/// # Errors
///
/// The mistake.
pub fn of_time(text: &str) -> Result<Arc<dyn Fn(f64) -> f64 + Send + Sync>, Mistake> {
    let node = read(text, Sort::OfTime)?;
    Ok(Arc::new(move |t| value(&node, t)))
}

/// A number, as `pi/4` or `-2.5e-3`.
///
/// # Errors
///
/// The expression cannot be read, or its value is not finite.
pub fn number(text: &str) -> Result<f64, Mistake> {
    let not_finite = |number: f64| Err(Mistake::NotFinite(format!("it is {number}: it must be finite")));
    // What other programs write for numbers that are not finite is no expression.
    if let Some(number) = text.trim().parse().ok().filter(|number: &f64| !number.is_finite()) {
        return not_finite(number);
    }
    match value(&read(text, Sort::Number)?, 0.0) {
        number if number.is_finite() => Ok(number),
        number => not_finite(number),
    }
}

fn read(text: &str, sort: Sort) -> Result<Node, Mistake> {
    let unreadable = |what: String| Err(Mistake::Unreadable(what));
    if text.len() > MAX_LENGTH {
        return unreadable(format!("the expression is longer than {MAX_LENGTH} characters"));
    }
    if let Some(strange) = text.chars().find(|&c| matches!(c, ';' | '{' | '}' | '=')) {
        return unreadable(format!("`{strange}` is not allowed in {}", sort.name()));
    }
    if text.trim().is_empty() {
        return unreadable("a number is missing".to_owned());
    }
    let depth = |depth: i32, c| match c {
        '(' if depth >= 0 => depth + 1,
        ')' if depth >= 0 => depth - 1,
        _ => depth,
    };
    match text.chars().fold(0, depth) {
        0 => {}
        1.. => return unreadable("a bracket is not closed: `)` is missing".to_owned()),
        _ => return unreadable("a bracket is closed that was not opened: `(` is missing".to_owned()),
    }
    let model = format!("mechanism Input;\ndefinitions {{ x = {text}; }}\n");
    let (tree, mistakes) = parse(&lexer::tokens(&model, usize::MAX));
    if let Some(mistake) = mistakes.first() {
        // The text ends with the semicolon that was added after it.
        let message = mistake.message.replace("found `;`", "found the end");
        return unreadable(format!("it cannot be read: {message}"));
    }
    let [definition] = &tree.definitions[..] else {
        let example = if sort == Sort::Number { "pi/4" } else { "2*sin(3*t)" };
        return unreadable(format!("give {}, as in {example}", sort.name()));
    };
    node(&definition.value, sort)
}

fn node(expression: &Expr, sort: Sort) -> Result<Node, Mistake> {
    let unreadable = |what: String| Err(Mistake::Unreadable(what));
    let node = |expression: &Expr| self::node(expression, sort);
    let many = |terms: &[(bool, Expr)]| {
        terms.iter().map(|(inverse, term)| Ok((*inverse, node(term)?))).collect::<Result<Vec<_>, Mistake>>()
    };
    Ok(match &expression.kind {
        ExprKind::Number(text) => {
            let wrong = |_| Mistake::Unreadable(format!("`{text}` is not a number"));
            Node::Number(text.parse().map_err(wrong)?)
        }
        // Models use the name `time`.
        ExprKind::Name(name) if name == "t" || name == "time" => match sort {
            Sort::OfTime => Node::Time,
            Sort::Number => return unreadable("it depends on the time t: give a number".to_owned()),
        },
        ExprKind::Name(name) if name == "pi" => Node::Number(std::f64::consts::PI),
        ExprKind::Name(name) => {
            let cure = match sort {
                Sort::Number => "a number may have pi and functions in it, but no names of the model",
                Sort::OfTime => "an input is an expression of the time t alone",
            };
            return Err(Mistake::UnknownName(format!("`{name}` is unknown: {cure}")));
        }
        ExprKind::Sum(terms) => Node::Sum(many(terms)?),
        ExprKind::Product(terms) => Node::Product(many(terms)?),
        ExprKind::Power(base, exponent) => Node::Power(Box::new(node(base)?), Box::new(node(exponent)?)),
        ExprKind::Neg(inner) => Node::Neg(Box::new(node(inner)?)),
        ExprKind::Call(name, arguments) => call(&name.text, arguments, sort)?,
        _ => {
            let time = if sort == Sort::OfTime { " t," } else { "" };
            return unreadable(format!("only numbers,{time} pi, + - * / ^ and functions are allowed"));
        }
    })
}

fn call(name: &str, arguments: &[Expr], sort: Sort) -> Result<Node, Mistake> {
    let node = |argument: &Expr| node(argument, sort);
    let one: Option<fn(f64) -> f64> = match name {
        "sin" => Some(f64::sin),
        "cos" => Some(f64::cos),
        "tan" => Some(f64::tan),
        "asin" => Some(f64::asin),
        "acos" => Some(f64::acos),
        "atan" => Some(f64::atan),
        "sinh" => Some(f64::sinh),
        "cosh" => Some(f64::cosh),
        "tanh" => Some(f64::tanh),
        "exp" => Some(f64::exp),
        "log" | "ln" => Some(f64::ln),
        "sqrt" => Some(f64::sqrt),
        "abs" => Some(f64::abs),
        // as in models: 1 at zero
        "sign" => Some(|x| match x {
            x if x.is_nan() => x,
            x if x < 0.0 => -1.0,
            _ => 1.0,
        }),
        _ => None,
    };
    let two: Option<fn(f64, f64) -> f64> = match name {
        // NaN propagates; the simulation refuses it
        "min" => Some(|a, b| if a.is_nan() || a < b { a } else { b }),
        "max" => Some(|a, b| if a.is_nan() || a > b { a } else { b }),
        "atan2" => Some(f64::atan2),
        "pow" => Some(f64::powf),
        _ => None,
    };
    match (one, two, arguments) {
        (Some(function), _, [argument]) => Ok(Node::Call(function, Box::new(node(argument)?))),
        (_, Some(function), [a, b]) => Ok(Node::Call2(function, Box::new(node(a)?), Box::new(node(b)?))),
        (None, None, _) => Err(Mistake::UnknownName(format!(
            "there is no function `{name}`: there are sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt abs sign min max pow"
        ))),
        _ => Err(Mistake::Unreadable(format!("`{name}` does not take {} arguments", arguments.len()))),
    }
}

fn value(node: &Node, t: f64) -> f64 {
    match node {
        Node::Number(number) => *number,
        Node::Time => t,
        Node::Sum(terms) => terms
            .iter()
            .fold(0.0, |sum, (minus, term)| if *minus { sum - value(term, t) } else { sum + value(term, t) }),
        Node::Product(factors) => factors.iter().fold(1.0, |product, (divide, factor)| {
            if *divide { product / value(factor, t) } else { product * value(factor, t) }
        }),
        Node::Power(base, exponent) => value(base, t).powf(value(exponent, t)),
        Node::Neg(inner) => -value(inner, t),
        Node::Call(function, argument) => function(value(argument, t)),
        Node::Call2(function, a, b) => function(value(a, t), value(b, t)),
    }
}

#[cfg(test)]
mod tests {
    use super::{number, of_time};

    #[test]
    fn expressions_of_time_are_read() {
        for (text, t, expected) in [
            ("2*sin(3*t) - 1", 0.5, 2.0 * 1.5_f64.sin() - 1.0),
            (" -t^2/4 + pi ", 3.0, std::f64::consts::PI - 2.25),
            ("max(0, min(1, t))", 0.25, 0.25),
            ("5", 1.0, 5.0),
        ] {
            let found = of_time(text).unwrap()(t);
            assert!((found - expected).abs() < 1e-15, "{text}: {found}");
        }
        for text in ["", "2*", "q1", "sin(t, t)", "foo(t)", "1; y = 2", "t }"] {
            assert!(of_time(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_are_read() {
        for (text, expected) in [("pi/4", std::f64::consts::FRAC_PI_4), (" -2.5e-3", -2.5e-3), ("3", 3.0)] {
            assert_eq!(number(text).unwrap(), expected, "{text}");
        }
        for text in ["", "t", "1/0", "sqrt(-1)", "NaN", "two", "1,2", "1e999", "max(0, t - 1)", "0*t"] {
            assert!(number(text).is_err(), "{text}");
        }
    }
}
