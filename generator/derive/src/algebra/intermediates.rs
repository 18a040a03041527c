//! Intermediate symbols (the paper's Z's), which keep expressions short, and differentiation through them.
//!
//! Every symbol stands for an input, a named expression, or a function of expressions. A subexpression that
//! would otherwise be written out inside larger ones gets a name; equal expressions get the same name, so
//! that they are computed once. Derivatives follow from the chain rule through the names, and each is
//! computed once.

mod simplify;

use std::collections::{HashMap, HashSet};

use super::expr::{Expr, SymbolId, View};
use hodograph_model::arithmetic::Function;
use hodograph_model::number::Number;
use hodograph_program::program::graph::Input;
pub use simplify::size;

/// The meaning of a symbol.
#[derive(Clone, Debug)]
pub enum Meaning {
    /// an input: a parameter, coordinate, speed, named input or time
    Input(Input),
    /// pi
    Pi,
    /// an unknown of equations that are being set up (rate of a coordinate, dependent speed), until it is
    /// defined
    Unknown,
    /// a named expression
    Named(Expr),
    /// a function of expressions
    Call(Function, Vec<Expr>),
}

/// The derivatives of inputs along a direction; inputs that are not listed are constant.
#[derive(Clone, Debug, Default)]
pub struct Direction {
    rates: HashMap<SymbolId, Expr>,
    known: HashMap<SymbolId, Expr>,
}

impl Direction {
    /// The direction in which each of these symbols changes at the given rate.
    pub fn new(rates: impl IntoIterator<Item = (SymbolId, Expr)>) -> Self {
        Direction { rates: rates.into_iter().collect(), known: HashMap::new() }
    }

    /// The direction of one symbol.
    pub fn along(symbol: SymbolId) -> Self {
        Self::new([(symbol, Expr::one())])
    }
}

/// Largest number of binary digits of a number in a bound. A square has twice the digits of its base, so that
/// forty definitions that square one another would have enormous numbers; a quantity whose bound has more
/// digits is compared with itself.
const MOST_DIGITS: u64 = 1000;
/// A bound that is a larger number is replaced by the magnitude of the value itself; compared with the factor
/// 2^40 between a divisor that counts as zero and its bound, this is small.
const WIDE: f64 = 65536.0;

/// All symbols of a derivation and their meanings.
#[derive(Debug, Default)]
pub struct Intermediates {
    meanings: Vec<Meaning>,
    inputs: HashMap<Input, SymbolId>,
    names: HashMap<Expr, SymbolId>,
    calls: HashMap<(Function, Vec<Expr>), SymbolId>,
    pi: Option<SymbolId>,
    bounds: HashMap<SymbolId, Expr>,
    /// the names whose bounds are the magnitudes of their values
    bounded_by_themselves: HashSet<SymbolId>,
}

impl Intermediates {
    fn new_symbol(&mut self, meaning: Meaning) -> SymbolId {
        self.meanings.push(meaning);
        (self.meanings.len() - 1) as SymbolId
    }

    /// The meaning of a symbol.
    pub fn meaning(&self, symbol: SymbolId) -> &Meaning {
        &self.meanings[symbol as usize]
    }

    /// The symbol of an input.
    pub fn input_symbol(&mut self, input: Input) -> SymbolId {
        if let Some(&symbol) = self.inputs.get(&input) {
            return symbol;
        }
        let symbol = self.new_symbol(Meaning::Input(input));
        self.inputs.insert(input, symbol);
        symbol
    }

    /// An input.
    pub fn input(&mut self, input: Input) -> Expr {
        Expr::symbol(self.input_symbol(input))
    }

    /// pi, as a symbol.
    pub fn pi(&mut self) -> Expr {
        let symbol = match self.pi {
            Some(symbol) => symbol,
            None => self.new_symbol(Meaning::Pi),
        };
        self.pi = Some(symbol);
        Expr::symbol(symbol)
    }

    /// A symbol to solve for.
    pub fn unknown(&mut self) -> SymbolId {
        self.new_symbol(Meaning::Unknown)
    }

    /// Defines an unknown by its solution.
    pub fn define(&mut self, unknown: SymbolId, value: Expr) {
        self.meanings[unknown as usize] = Meaning::Named(value);
    }

    /// The expression as a number, a symbol, or a number times a symbol; any other expression gets a name.
    pub fn name(&mut self, expr: Expr) -> Expr {
        match expr.view() {
            View::Number(_) | View::Symbol(_) => expr,
            View::Product(factors) if factors.len() == 2 && factors.iter().any(Expr::is_number) => {
                let (number, rest) = if factors[0].is_number() {
                    (&factors[0], &factors[1])
                } else {
                    (&factors[1], &factors[0])
                };
                if rest.as_symbol().is_some() { expr } else { number.mul(&self.name(rest.clone())) }
            }
            View::Product(factors) => {
                // The numeric coefficient is not part of the named expression.
                match factors.iter().position(Expr::is_number) {
                    Some(at) => {
                        let number = factors[at].clone();
                        let rest = factors.iter().enumerate().filter(|&(i, _)| i != at).map(|(_, f)| f);
                        let rest = rest.fold(Expr::one(), |product, factor| product.mul(factor));
                        number.mul(&self.name_exactly(rest))
                    }
                    None => self.name_exactly(expr),
                }
            }
            View::Sum(terms) => {
                // A sum and its negative share a name: that with the sign that makes the first term positive.
                let negative = terms.first().is_some_and(|term| leading_number(term).is_negative());
                if negative { self.name_exactly(opposite(&terms)).neg() } else { self.name_exactly(expr) }
            }
            View::Power(..) => self.name_exactly(expr),
        }
    }

    fn name_exactly(&mut self, expr: Expr) -> Expr {
        if expr.is_number() || expr.as_symbol().is_some() {
            return expr;
        }
        if let Some(&symbol) = self.names.get(&expr) {
            return Expr::symbol(symbol);
        }
        let symbol = self.new_symbol(Meaning::Named(expr.clone()));
        self.names.insert(expr, symbol);
        Expr::symbol(symbol)
    }

    /// A function of expressions, with the simplifications on which structure depends: odd and even functions
    /// of negatives, right angles, roots and powers of exact squares.
    pub fn call(&mut self, function: Function, arguments: Vec<Expr>) -> Expr {
        use Function::*;
        let arguments: Vec<Expr> = arguments.into_iter().map(|a| self.name(a)).collect();
        if let [argument] = &arguments[..] {
            let negative = leading_number(argument).is_negative();
            match function {
                Sin | Cos => {
                    if let Some(turns) = self.quarter_turns(argument) {
                        let turns = if function == Cos { turns + 1 } else { turns };
                        return Expr::integer([0, 1, 0, -1][turns.rem_euclid(4) as usize]);
                    }
                    if negative {
                        let value = self.call(function, vec![argument.neg()]);
                        return if function == Sin { value.neg() } else { value };
                    }
                }
                Tan => {
                    let sine = self.call(Sin, vec![argument.clone()]);
                    let cosine = self.call(Cos, vec![argument.clone()]);
                    // At a right angle the function is left unevaluated, and `check` refuses it.
                    if !cosine.is_zero() {
                        return sine.div(&cosine);
                    }
                }
                Abs | Cosh if negative => return self.call(function, vec![argument.neg()]),
                Asin | Atan | Sinh | Tanh | Frozen if negative => {
                    return self.call(function, vec![argument.neg()]).neg();
                }
                _ => {}
            }
            if argument.is_zero() {
                match function {
                    Asin | Atan | Sqrt | Abs | Sinh | Tanh | Frozen => return Expr::zero(),
                    Exp | Cosh => return Expr::one(),
                    _ => {}
                }
            }
            if argument.is_one() && matches!(function, Sqrt | Abs) {
                return Expr::one();
            }
            if let (View::Number(number), Sqrt | Abs) = (argument.view(), function) {
                let root = |n: &num_bigint::BigInt| Some(n.sqrt()).filter(|root| &(root * root) == n);
                if function == Abs {
                    return Expr::number(&Number(if number.is_negative() { -number.0 } else { number.0 }));
                }
                if !number.is_negative()
                    && let (Some(n), Some(d)) = (root(number.0.numer()), root(number.0.denom()))
                {
                    return Expr::number(&Number(num_rational::BigRational::new(n, d)));
                }
            }
        }
        let key = (function, arguments);
        if let Some(&symbol) = self.calls.get(&key) {
            return Expr::symbol(symbol);
        }
        let symbol = self.new_symbol(Meaning::Call(key.0, key.1.clone()));
        self.calls.insert(key, symbol);
        Expr::symbol(symbol)
    }

    /// The number of right angles in an expression, if it is an integer multiple of one.
    fn quarter_turns(&mut self, argument: &Expr) -> Option<i64> {
        if argument.is_zero() {
            return Some(0);
        }
        let pi = self.pi?;
        let ratio = argument.derivative(pi);
        if !ratio.is_number() || !argument.sub(&ratio.mul(&Expr::symbol(pi))).is_zero() {
            return None;
        }
        match ratio.mul(&Expr::integer(2)).view() {
            View::Number(number) => number.to_integer(),
            _ => None,
        }
    }

    /// The derivative of an expression along a direction, through all names.
    pub fn differentiate(&mut self, expr: &Expr, direction: &mut Direction) -> Expr {
        let mut result = Expr::zero();
        for symbol in expr.symbols() {
            let rate = self.rate(symbol, direction);
            if !rate.is_zero() {
                result = result.add(&expr.derivative(symbol).mul(&rate));
            }
        }
        result
    }

    fn rate(&mut self, symbol: SymbolId, direction: &mut Direction) -> Expr {
        if let Some(rate) = direction.rates.get(&symbol).or_else(|| direction.known.get(&symbol)) {
            return rate.clone();
        }
        let rate = match self.meanings[symbol as usize].clone() {
            Meaning::Input(_) | Meaning::Pi | Meaning::Unknown => Expr::zero(),
            Meaning::Named(value) => {
                let rate = self.differentiate(&value, direction);
                self.name(rate)
            }
            Meaning::Call(function, arguments) => {
                let mut rate = Expr::zero();
                for (i, argument) in arguments.iter().enumerate() {
                    let inner = self.differentiate(argument, direction);
                    if !inner.is_zero() {
                        let inner = self.name(inner);
                        rate = rate.add(&self.slope(symbol, function, &arguments, i).mul(&inner));
                    }
                }
                self.name(rate)
            }
        };
        direction.known.insert(symbol, rate.clone());
        rate
    }

    /// Derivative of a function (whose value is `symbol`) with respect to its argument with index `i`.
    fn slope(&mut self, symbol: SymbolId, function: Function, arguments: &[Expr], i: usize) -> Expr {
        use Function::*;
        let value = Expr::symbol(symbol);
        let a = arguments[0].clone();
        let one_minus_square = |s: &mut Self| {
            let rest = Expr::one().sub(&a.mul(&a));
            let root = s.call(Sqrt, vec![rest]);
            root.pow(-1)
        };
        match function {
            Sin => self.call(Cos, vec![a]),
            Cos => self.call(Sin, vec![a]).neg(),
            Tan => Expr::one().add(&value.mul(&value)),
            Asin => one_minus_square(self),
            Acos => one_minus_square(self).neg(),
            Atan => Expr::one().add(&a.mul(&a)).pow(-1),
            Atan2 => {
                let b = &arguments[1];
                let square = self.name(a.mul(&a).add(&b.mul(b)));
                if i == 0 { b.div(&square) } else { a.neg().div(&square) }
            }
            Sqrt => Expr::number(&Number::ratio(1, 2)).div(&value),
            Exp => value,
            Log => a.pow(-1),
            Sinh => self.call(Cosh, vec![a]),
            Cosh => self.call(Sinh, vec![a]),
            Tanh => Expr::one().sub(&value.mul(&value)),
            Abs => self.call(Sign, vec![a]),
            Sign | Frozen => Expr::zero(),
            Min | Max => {
                // (1 +- sign(a - b)) / 2: the active branch.
                let sign = self.call(Sign, vec![a.sub(&arguments[1])]);
                let sign = if (function == Max) == (i == 0) { sign } else { sign.neg() };
                Expr::one().add(&sign).mul(&Expr::number(&Number::ratio(1, 2)))
            }
        }
    }

    /// An upper bound of the magnitude of an expression, made of parameters where possible: the scale
    /// relative to which a divisor counts as zero.
    pub fn bound(&mut self, expr: &Expr) -> Expr {
        let bound = match expr.view() {
            View::Number(number) => {
                Expr::number(&Number(if number.is_negative() { -number.0 } else { number.0 }))
            }
            View::Symbol(symbol) => self.bound_of_symbol(symbol),
            View::Sum(terms) => {
                let terms: Vec<_> = terms.iter().map(|term| self.bound(term)).collect();
                Expr::sum(&terms)
            }
            View::Product(factors) => {
                factors.iter().map(|f| self.bound(f)).fold(Expr::one(), |product, f| product.mul(&f))
            }
            View::Power(base, n) if n > 0 => self.bound(&base).pow(n),
            View::Power(base, n) => {
                let base = self.name(base);
                self.call(Function::Abs, vec![base]).pow(n)
            }
        };
        self.name(bound)
    }

    /// From here on the bound of a name is the magnitude of its value. Bounds of iterations, in which each step is made of the
    /// last, would be many powers of ten above the values, and divisors count as zero that are not.
    pub fn bound_by_itself(&mut self, name: &Expr) {
        if let View::Symbol(symbol) = name.view() {
            self.bounded_by_themselves.insert(symbol);
        }
    }

    fn bound_of_symbol(&mut self, symbol: SymbolId) -> Expr {
        if let Some(bound) = self.bounds.get(&symbol) {
            return bound.clone();
        }
        use Function::*;
        let own = self.bounded_by_themselves.contains(&symbol);
        let bound = match self.meanings[symbol as usize].clone() {
            Meaning::Named(_) if own => self.call(Abs, vec![Expr::symbol(symbol)]),
            Meaning::Named(value) => match self.bound(&value) {
                bound if digits(&bound) <= MOST_DIGITS && !is_wide(&bound) => bound,
                _ => self.call(Abs, vec![Expr::symbol(symbol)]),
            },
            Meaning::Call(Sin | Cos | Sign | Tanh, _) => Expr::one(),
            Meaning::Pi => Expr::symbol(symbol),
            _ => self.call(Abs, vec![Expr::symbol(symbol)]),
        };
        self.bounds.insert(symbol, bound.clone());
        bound
    }

    /// Whether anything in the expression, through any names, is divided by this.
    pub fn is_divided_by(&self, expr: &Expr, divisor: &Expr) -> bool {
        let mut seen = vec![false; self.meanings.len()];
        let mut open = vec![expr.clone()];
        while let Some(expr) = open.pop() {
            match expr.view() {
                View::Number(_) => {}
                View::Symbol(symbol) => {
                    if std::mem::replace(&mut seen[symbol as usize], true) {
                        continue;
                    }
                    match self.meaning(symbol) {
                        Meaning::Named(value) => open.push(value.clone()),
                        Meaning::Call(_, arguments) => open.extend(arguments.iter().cloned()),
                        _ => {}
                    }
                }
                View::Sum(parts) | View::Product(parts) => open.extend(parts),
                View::Power(base, n) if n < 0 && &base == divisor => return true,
                View::Power(base, _) => open.push(base),
            }
        }
        false
    }

    /// Whether the expression depends, through any names, on a symbol that `matters`.
    pub fn depends(&self, expr: &Expr, matters: &mut impl FnMut(SymbolId) -> bool) -> bool {
        let mut seen = vec![false; self.meanings.len()];
        let mut open = expr.symbols();
        while let Some(symbol) = open.pop() {
            if std::mem::replace(&mut seen[symbol as usize], true) {
                continue;
            }
            if matters(symbol) {
                return true;
            }
            match self.meaning(symbol) {
                Meaning::Named(value) => open.extend(value.symbols()),
                Meaning::Call(_, arguments) => open.extend(arguments.iter().flat_map(Expr::symbols)),
                _ => {}
            }
        }
        false
    }
}

/// Number of binary digits of the number in an expression from [`Intermediates::name`].
fn digits(named: &Expr) -> u64 {
    let number = leading_number(named).0;
    number.numer().bits() + number.denom().bits()
}

/// Whether a bound is such a large number that it may be far above the value: bounds of values that square
/// one another grow like the squares, while the values stay near 1. Relative to such a bound any divisor
/// would count as zero.
fn is_wide(bound: &Expr) -> bool {
    match bound.view() {
        View::Number(number) => number.to_f64() > WIDE,
        _ => false,
    }
}

/// The negative of a sum, term by term.
fn opposite(terms: &[Expr]) -> Expr {
    let terms: Vec<_> = terms.iter().map(Expr::neg).collect();
    Expr::sum(&terms)
}

/// The numeric factor of a term.
fn leading_number(term: &Expr) -> Number {
    match term.view() {
        View::Number(number) => number,
        View::Product(factors) => factors
            .iter()
            .find_map(|factor| match factor.view() {
                View::Number(number) => Some(number),
                _ => None,
            })
            .unwrap_or_else(|| Number::integer(1)),
        View::Sum(terms) => terms.first().map_or_else(|| Number::integer(1), leading_number),
        _ => Number::integer(1),
    }
}
