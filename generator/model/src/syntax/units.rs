//! Units: dimension and SI factor of expressions such as `kg*m^2` or `mm`.

use super::tree::{Expr, ExprKind};
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::dimension::{Dimension, Exponent};
use crate::number::Number;
use crate::unicode;
use crate::{suggest, vocabulary};

/// A unit: its dimension and its size in SI, `number * pi^pi_power`.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// what kind of quantity it measures
    pub dimension: Dimension,
    /// its size in SI units, but for powers of pi
    pub number: Number,
    /// powers of pi in its size: 1 for `deg`
    pub pi_power: i32,
    /// as written, without blanks
    pub text: String,
}

impl Unit {
    /// Whether it is an SI unit.
    pub fn is_si(&self) -> bool {
        self.number.is_one() && self.pi_power == 0
    }

    /// Its size in SI units.
    pub fn factor(&self) -> f64 {
        self.number.to_f64() * std::f64::consts::PI.powi(self.pi_power)
    }

    /// A size that quantities with this unit commonly have, counted in it: that of a mechanism of half a
    /// metre, a kilogram and a quarter of a second, whose radii of gyration are an eighth of a metre; for
    /// numbers and angles a half. (A weight is 8 N then.) Powers of 2 are the same on every machine.
    pub fn typical(&self) -> f64 {
        let [metre, _, second] =
            self.dimension.exponents.map(|exponent| exponent.to_integer().clamp(-30, 30));
        let halves = match self.dimension {
            none if none.is_none() => 1,
            inertia if inertia == Dimension::of(2, 1, 0) => 6,
            _ => metre + 2 * second,
        };
        0.5_f64.powi(halves) / self.factor()
    }
}

/// Symbol, powers of m, kg, s, size as a fraction, powers of pi, whether it may have a prefix.
type Symbol = (&'static str, [i32; 3], [i64; 2], i32, bool);

const SYMBOLS: &[Symbol] = &[
    ("m", [1, 0, 0], [1, 1], 0, true),
    ("g", [0, 1, 0], [1, 1000], 0, true),
    ("s", [0, 0, 1], [1, 1], 0, true),
    ("min", [0, 0, 1], [60, 1], 0, false),
    ("h", [0, 0, 1], [3600, 1], 0, false),
    ("rad", [0, 0, 0], [1, 1], 0, true),
    ("deg", [0, 0, 0], [1, 180], 1, false),
    ("rev", [0, 0, 0], [2, 1], 1, false),
    ("N", [1, 1, -2], [1, 1], 0, true),
    ("Pa", [-1, 1, -2], [1, 1], 0, true),
    ("J", [2, 1, -2], [1, 1], 0, true),
    ("W", [2, 1, -3], [1, 1], 0, true),
    ("Hz", [0, 0, -1], [1, 1], 0, true),
];

const PREFIXES: &[(&str, i32)] = &[
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("da", 1),
    ("d", -1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// The unit of a symbol, perhaps with a prefix.
pub fn of_symbol(name: &str) -> Option<Unit> {
    let unit = |&(text, [m, kg, s], [n, d], pi_power, _): &Symbol, exponent: i32| Unit {
        dimension: Dimension::of(m, kg, s),
        number: Number(Number::ratio(n, d).0 * Number::integer(10).0.pow(exponent)),
        pi_power,
        text: text.to_owned(),
    };
    if let Some(found) = SYMBOLS.iter().find(|s| s.0 == name) {
        return Some(unit(found, 0));
    }
    PREFIXES.iter().find_map(|&(prefix, exponent)| {
        let rest = name.strip_prefix(prefix)?;
        let found = SYMBOLS.iter().find(|s| s.0 == rest && s.4)?;
        Some(Unit { text: name.to_owned(), ..unit(found, exponent) })
    })
}

/// The symbols without prefixes, each with its dimension.
pub fn symbols() -> impl Iterator<Item = (&'static str, Dimension)> {
    SYMBOLS.iter().map(|&(text, [m, kg, s], ..)| (text, Dimension::of(m, kg, s)))
}

/// Whether it is the symbol of a unit, perhaps with a prefix.
pub fn is_symbol(name: &str) -> bool {
    of_symbol(name).is_some()
}

/// Reads a unit.
pub fn read(expr: &Expr) -> Result<Unit, Option<Box<Diagnostic>>> {
    let wrong = || {
        let message = "a unit is a product or quotient of unit symbols with whole powers";
        let error = Diagnostic::new(codes::UNKNOWN_UNIT, expr.span, message)
            .help("for instance `kg*m^2`, `m/s`, `1/s` or `1`");
        Some(Box::new(error))
    };
    match &expr.kind {
        ExprKind::Error => Err(None),
        ExprKind::Number(text) if text == "1" => Ok(Unit {
            dimension: Dimension::none(),
            number: Number::integer(1),
            pi_power: 0,
            text: "1".to_owned(),
        }),
        ExprKind::Name(name) => of_symbol(name).ok_or_else(|| Some(Box::new(unknown(name, expr)))),
        ExprKind::Power(base, exponent) => {
            let mut unit = part(base)?;
            let (negative, exponent) = match &exponent.kind {
                ExprKind::Neg(inner) => (true, &**inner),
                _ => (false, &**exponent),
            };
            let ExprKind::Number(text) = &exponent.kind else { return Err(wrong()) };
            let size: i32 = text.parse().ok().filter(|n| (1..=12).contains(n)).ok_or_else(wrong)?;
            let power = if negative { -size } else { size };
            unit.dimension = unit.dimension.power(Exponent::from_integer(power)).ok_or_else(wrong)?;
            unit.number = Number(unit.number.0.pow(power));
            unit.pi_power *= power;
            unit.text = if unit.text.contains(['*', '/', '^']) {
                format!("({})^{power}", unit.text)
            } else {
                format!("{}^{power}", unit.text)
            };
            Ok(unit)
        }
        ExprKind::Product(factors) if factors.len() <= 12 => {
            let mut product: Option<Unit> = None;
            for (divides, factor) in factors {
                let unit = part(factor)?;
                let compound = matches!(factor.kind, ExprKind::Product(_));
                let text = if compound { format!("({})", unit.text) } else { unit.text.clone() };
                product = Some(match product {
                    None => Unit { text, ..unit },
                    Some(so_far) => {
                        let (dimension, number, sign) = if *divides {
                            (so_far.dimension.over(&unit.dimension), so_far.number.0 / unit.number.0, -1)
                        } else {
                            (so_far.dimension.times(&unit.dimension), so_far.number.0 * unit.number.0, 1)
                        };
                        Unit {
                            dimension: dimension.ok_or_else(wrong)?,
                            number: Number(number),
                            pi_power: so_far.pi_power + sign * unit.pi_power,
                            text: format!("{}{}{text}", so_far.text, if *divides { '/' } else { '*' }),
                        }
                    }
                });
            }
            product.ok_or_else(wrong)
        }
        _ => Err(wrong()),
    }
}

/// Reads a part of a unit. What is to be written for it there may need parentheses, and is not offered.
fn part(expr: &Expr) -> Result<Unit, Option<Box<Diagnostic>>> {
    read(expr).map_err(|error| {
        error.map(|mut error| {
            error.fixes.retain(|fix| !fix.text.contains(['*', '/', '^']));
            error
        })
    })
}

fn unknown(name: &str, expr: &Expr) -> Diagnostic {
    let error = Diagnostic::new(codes::UNKNOWN_UNIT, expr.span, format!("there is no unit `{name}`"));
    // the two letters mu: the sign of micro, and the Greek letter
    if let Some(rest) = name.strip_prefix(['\u{b5}', '\u{3bc}']).filter(|rest| is_symbol(&format!("u{rest}")))
    {
        return error.help(format!("write `u{rest}`: the prefix for a millionth is `u`"));
    }
    if let Some(found) = unicode::lookalike(name) {
        return error.help(found.advice());
    }
    if let Some(right) = vocabulary::unit(name) {
        return error.fix(Place::Replace(expr.span), right).help(format!("write `{right}`"));
    }
    let digits = name.trim_start_matches(|c: char| !c.is_ascii_digit());
    if let Some(base) = name.strip_suffix(digits).filter(|base| !digits.is_empty() && is_symbol(base)) {
        let right = format!("{base}^{digits}");
        return error.help(format!("write `{right}`")).fix(Place::Replace(expr.span), right);
    }
    if let Some(advice) = vocabulary::unit_advice(name) {
        return error.help(advice);
    }
    let prefixed =
        PREFIXES.iter().find(|(p, _)| name.strip_prefix(p).is_some_and(|r| SYMBOLS.iter().any(|s| s.0 == r)));
    if prefixed.is_some() {
        return error.help("this unit takes no prefix");
    }
    match suggest::nearest(name, SYMBOLS.iter().map(|s| s.0).chain(["kg", "mm", "cm", "km", "ms", "kN"])) {
        Some(near) => error.did_you_mean(near),
        None => error
            .help("units are kg g m s min h rad deg rev N Pa J W Hz 1, with SI prefixes, and their products"),
    }
}
