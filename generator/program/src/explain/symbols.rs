//! Symbols of names, printed forms of units, and forms of numbers (decimal, power of ten, quotient).

use std::collections::{HashMap, HashSet};

/// The symbol of a name: a letter or word, and its index, which may be empty.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Symbol {
    /// `q` of `q1`, the Greek letter of `gamma_0`, `mass` of `mass`
    pub head: String,
    /// `1` of `q1`, `0` of `gamma_0`, `a,b` of `m_a_b`
    pub index: String,
}

const GREEK: [(&str, char); 33] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Xi", 'Ξ'),
    ("Pi", 'Π'),
    ("Sigma", 'Σ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
];

/// The name of a Greek letter.
pub fn greek_name(letter: char) -> Option<&'static str> {
    GREEK.iter().find(|(_, known)| *known == letter).map(|(name, _)| *name)
}

/// The symbol of a single name: `q1` is q with the index 1, `gamma` a Greek letter, `m_arm` m with the index
/// arm, `vx` v with the index x, `walpha` w with the index alpha.
pub fn symbol(name: &str) -> Symbol {
    let (head, tail) = match name.split_once('_') {
        Some((head, tail)) if !head.is_empty() && !tail.is_empty() => (head, tail),
        _ => (name, ""),
    };
    let letters = head.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let (head, digits) = if letters.is_empty() { (head, "") } else { (letters, &head[letters.len()..]) };
    let (head, letter) = head.split_at(indexed(head));
    let parts = [letter, digits].into_iter().chain(tail.split('_')).filter(|part| !part.is_empty());
    let index = parts.collect::<Vec<_>>().join(",");
    let greek = GREEK.iter().find(|(name, _)| *name == head);
    Symbol { head: greek.map_or(head.to_owned(), |(_, letter)| letter.to_string()), index }
}

/// Where the index begins in a name without digits and underscores: after the first of two letters, or after
/// a letter that a Greek letter's name follows; else at the end.
fn indexed(letters: &str) -> usize {
    let greek = |text: &str| GREEK.iter().any(|(name, _)| *name == text);
    let mut rest = letters.chars();
    let first = rest.next().filter(char::is_ascii_alphabetic);
    let two = letters.len() == 2 && rest.clone().all(|letter| letter.is_ascii_alphabetic());
    match first {
        Some(_) if !greek(letters) && (two || greek(rest.as_str())) => 1,
        _ => letters.len(),
    }
}

/// The symbols of all names of a mechanism: no two of them look alike.
#[derive(Clone, Debug)]
pub struct Symbols {
    of: HashMap<String, Symbol>,
    /// the letter of intermediate symbols
    pub letter: &'static str,
}

impl Symbols {
    /// Symbols for these names. A name whose symbol is already taken is written out instead.
    pub fn new<'a>(names: impl Iterator<Item = &'a str> + Clone) -> Self {
        let numbered = |letter: &str| {
            let mut indexed = names.clone().filter_map(|name| name.strip_prefix(letter));
            indexed.any(|index| {
                let digits = index.trim_start_matches('_');
                !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit())
            })
        };
        let letter = ["z", "y", "w", "zz"].into_iter().find(|letter| !numbered(letter)).unwrap_or("zzz");
        let mut taken = HashSet::new();
        let mut of = HashMap::new();
        for name in names.chain(["time"]) {
            let own = if name == "time" { symbol("t") } else { symbol(name) };
            let written_out = Symbol { head: name.to_owned(), index: String::new() };
            let mut symbol = if taken.contains(&own) { written_out } else { own };
            while !taken.insert(symbol.clone()) {
                symbol.head.push('\'');
            }
            of.insert(name.to_owned(), symbol);
        }
        Symbols { of, letter }
    }

    /// The same symbols without that of the time, for a mechanism whose equations do not contain the time.
    pub fn without_time(mut self) -> Self {
        self.of.remove("time");
        self
    }

    /// Whether one of the names has this symbol.
    pub fn has(&self, symbol: &Symbol) -> bool {
        self.of.values().any(|known| known == symbol)
    }

    /// The symbol of a name.
    pub fn of(&self, name: &str) -> Symbol {
        match (self.of.get(name), name.strip_prefix("delta_").and_then(|name| self.of.get(name))) {
            (Some(symbol), _) => symbol.clone(),
            // the small deviation of a quantity
            (None, Some(symbol)) => {
                Symbol { head: format!("δ{}", symbol.head), index: symbol.index.clone() }
            }
            (None, None) => symbol(name),
        }
    }
}

/// A unit as it is printed: `kg·m²` for `kg*m^2`, nothing for `1`.
pub fn unit(text: &str) -> String {
    if text == "1" {
        return String::new();
    }
    let mut out = String::new();
    let mut raised = false;
    for letter in text.chars().filter(|letter| !letter.is_whitespace()) {
        const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
        match (letter, letter.to_digit(10)) {
            ('*', _) => out.push('·'),
            ('^', _) => {}
            ('-', _) if raised => out.push('⁻'),
            (_, Some(digit)) if raised => out.push(RAISED[digit as usize]),
            _ => out.push(letter),
        }
        raised = letter == '^' || (raised && (letter == '-' || letter.is_ascii_digit()));
    }
    out
}

/// How a positive number is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Form {
    /// digits with or without a point
    Decimal(String),
    /// a decimal and a power of ten
    Power(String, i32),
    /// a quotient of two small numbers
    Ratio(u32, u32),
}

/// Denominators up to this are tried.
const LARGEST_DENOMINATOR: u32 = 360;
/// A number with fewer digits is written as a decimal.
const MANY_DIGITS: usize = 10;

/// The shortest form that reads back as the same double: a decimal, or a quotient if the decimal would be
/// long.
pub fn form(number: f64) -> Form {
    let text = format!("{number:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if mantissa.len() > MANY_DIGITS {
        let fits = |denominator: &u32| {
            let numerator = (number * f64::from(*denominator)).round();
            (1.0..1000.0).contains(&numerator) && numerator / f64::from(*denominator) == number
        };
        if let Some(denominator) = (2..=LARGEST_DENOMINATOR).find(fits) {
            return Form::Ratio((number * f64::from(denominator)).round() as u32, denominator);
        }
    }
    match exponent {
        -4..=5 => Form::Decimal(format!("{number}")),
        6..=15 if number.fract() == 0.0 && mantissa.len() + 3 > exponent as usize => {
            Form::Decimal(format!("{number}"))
        }
        _ => Form::Power(mantissa.to_owned(), exponent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_symbols() {
        let pairs = [
            ("q1", "q", "1"),
            ("m", "m", ""),
            ("gamma", "γ", ""),
            ("omega_x", "ω", "x"),
            ("theta12", "θ", "12"),
            ("m_arm", "m", "arm"),
            ("v1_a_b", "v", "1,a,b"),
            ("_x", "_x", ""),
            ("mass", "mass", ""),
            ("vx", "v", "x"),
            ("mf", "m", "f"),
            ("walpha", "w", "alpha"),
            ("Ixx", "Ixx", ""),
            ("vx2", "v", "x,2"),
            ("mu", "μ", ""),
            ("mmu", "m", "mu"),
        ];
        for (name, head, index) in pairs {
            assert_eq!(symbol(name), Symbol { head: head.to_owned(), index: index.to_owned() }, "{name}");
        }
    }

    #[test]
    fn no_two_names_look_alike() {
        let names = ["q1", "q_1", "t", "z3", "y_7", "gamma", "γ", "delta_q1"];
        let symbols = Symbols::new(names.into_iter());
        let mut seen: Vec<Symbol> = names.iter().chain(&["time"]).map(|name| symbols.of(name)).collect();
        seen.sort_by_key(|symbol| format!("{symbol:?}"));
        assert!(seen.windows(2).all(|pair| pair[0] != pair[1]), "{seen:?}");
        assert_eq!(symbols.letter, "w");
        assert_eq!(Symbols::new(["z", "zeta", "z_x"].into_iter()).letter, "z");
        let deviation = Symbol { head: "δq".to_owned(), index: "1".to_owned() };
        assert_eq!(Symbols::new(["q1"].into_iter()).of("delta_q1"), deviation);
    }

    #[test]
    fn units_are_printed() {
        for (text, printed) in [
            ("kg*m^2", "kg·m²"),
            ("m/s^2", "m/s²"),
            ("s^-12", "s⁻¹²"),
            ("1", ""),
            ("N*m*s/rad", "N·m·s/rad"),
            ("1/s", "1/s"),
        ] {
            assert_eq!(unit(text), printed);
        }
    }

    #[test]
    fn numbers_read_back_as_they_are() {
        let written = |number: f64| match form(number) {
            Form::Decimal(text) => text,
            Form::Power(mantissa, exponent) => format!("{mantissa} 10^{exponent}"),
            Form::Ratio(a, b) => format!("{a}/{b}"),
        };
        let cases = [
            (1.0 / 3.0, "1/3"),
            (2.0 / 15.0, "2/15"),
            (0.25, "0.25"),
            (2e-10, "2 10^-10"),
            (1.5e300, "1.5 10^300"),
            (5e-324, "5 10^-324"),
            (9.81, "9.81"),
            (123456.0, "123456"),
            (2.5e6, "2.5 10^6"),
            (1234567.0, "1234567"),
            (1e9, "1 10^9"),
            (0.8728715609439696, "0.8728715609439696"),
            (1.0 / 12.0, "1/12"),
            (0.000125, "0.000125"),
            (0.0000125, "1.25 10^-5"),
            (0.0, "0"),
        ];
        for (number, text) in cases {
            assert_eq!(written(number), text);
        }
        // Every form reads back as the same double.
        let mut random = hodograph_random::Random::new(1);
        for _ in 0..20_000 {
            let number = f64::from_bits(random.bits() >> 1);
            if !number.is_finite() {
                continue;
            }
            let back = match form(number) {
                Form::Decimal(text) => text.parse::<f64>().unwrap(),
                Form::Power(mantissa, exponent) => format!("{mantissa}e{exponent}").parse().unwrap(),
                Form::Ratio(a, b) => f64::from(a) / f64::from(b),
            };
            assert_eq!(back, number);
        }
    }
}
