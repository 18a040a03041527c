//! Decides whether an expression is identically 0, by evaluating it at random values of its inputs.
//!
//! The algebra does not recognise every cancellation, since named expressions are not multiplied out; a
//! vector that is transformed to rotating axes and back is an example. An expression that is not identically
//! 0 vanishes at random inputs with probability 0.

use std::collections::HashMap;

use super::expr::{Expr, SymbolId, View};
use super::intermediates::{Intermediates, Meaning};
use hodograph_model::arithmetic::Function;
use hodograph_program::program::graph::Input;

/// The rounding error of a sum that is exactly 0, relative to the size of its terms.
const ROUNDING: f64 = 1e-12;

/// A value, and the sum of the magnitudes of the terms that cause rounding errors.
#[derive(Clone, Copy, Debug)]
struct Sized {
    value: f64,
    terms: f64,
    /// an input, which has no rounding error
    exact: bool,
}

/// Sines of angles with a greater uncertainty (rad) give no information.
const ANGLE_KNOWN: f64 = 1e-3;

impl Sized {
    fn exact(value: f64) -> Self {
        Sized { value, terms: value.abs(), exact: true }
    }

    /// A function of the value with this derivative.
    fn mapped(self, value: f64, slope: f64) -> Self {
        let brought = if self.exact { 0.0 } else { slope.abs() * self.terms };
        Sized::rounded(value, value.abs() + brought)
    }

    fn rounded(value: f64, terms: f64) -> Self {
        Sized { value, terms, exact: false }
    }

    /// A function of the value as an angle: large angles must be exact.
    fn turned(self, value: f64, slope: f64) -> Self {
        let known = self.exact || ROUNDING * self.terms <= ANGLE_KNOWN;
        self.mapped(if known { value } else { f64::NAN }, slope)
    }
}

/// Values of all inputs.
#[derive(Clone, Debug, Default)]
pub struct Sample {
    inputs: HashMap<Input, f64>,
    known: HashMap<SymbolId, Sized>,
}

impl Sample {
    /// A sample in which these inputs have values, and others have none.
    pub fn new(inputs: HashMap<Input, f64>) -> Self {
        Sample { inputs, known: HashMap::new() }
    }

    /// The value of an expression, if it has one in this sample.
    pub fn value(&mut self, z: &Intermediates, expr: &Expr) -> Option<f64> {
        Some(self.sized(z, expr).value).filter(|value| value.is_finite())
    }

    /// Whether the expression is 0 in this sample up to rounding. `None` if it has no value.
    pub fn vanishes(&mut self, z: &Intermediates, expr: &Expr) -> Option<bool> {
        let Sized { value, terms, .. } = self.sized(z, expr);
        (value.is_finite() && terms.is_finite()).then(|| value.abs() <= ROUNDING * terms)
    }

    fn sized(&mut self, z: &Intermediates, expr: &Expr) -> Sized {
        match expr.view() {
            View::Number(number) => Sized::exact(number.to_f64()),
            View::Symbol(symbol) => self.symbol(z, symbol),
            View::Sum(terms) => {
                terms.iter().map(|term| self.sized(z, term)).fold(Sized::exact(0.0), |sum, term| {
                    Sized::rounded(sum.value + term.value, sum.terms + term.terms)
                })
            }
            View::Product(factors) => {
                factors.iter().map(|factor| self.sized(z, factor)).fold(Sized::exact(1.0), |a, b| {
                    let terms = a.value.abs() * b.terms + b.value.abs() * a.terms;
                    Sized::rounded(a.value * b.value, terms)
                })
            }
            View::Power(base, n) => {
                let base = self.sized(z, &base);
                base.mapped(base.value.powi(n), f64::from(n) * base.value.powi(n - 1))
            }
        }
    }

    fn symbol(&mut self, z: &Intermediates, symbol: SymbolId) -> Sized {
        if let Some(known) = self.known.get(&symbol) {
            return *known;
        }
        let value = match z.meaning(symbol) {
            Meaning::Input(input) => Sized::exact(self.inputs.get(input).copied().unwrap_or(f64::NAN)),
            Meaning::Pi => Sized::rounded(std::f64::consts::PI, std::f64::consts::PI),
            // It may be defined later, so the result is not stored.
            Meaning::Unknown => Sized::exact(f64::NAN),
            Meaning::Named(value) => self.sized(z, value),
            Meaning::Call(function, arguments) => {
                let a = self.sized(z, &arguments[0]);
                let b = arguments.get(1).map(|b| self.sized(z, b));
                call(*function, a, b.unwrap_or(Sized::exact(0.0)))
            }
        };
        if value.value.is_finite() {
            self.known.insert(symbol, value);
        }
        value
    }
}

fn call(function: Function, a: Sized, b: Sized) -> Sized {
    use Function::*;
    let x = a.value;
    match function {
        Sin => a.turned(x.sin(), x.cos()),
        Cos => a.turned(x.cos(), x.sin()),
        Tan => a.mapped(x.tan(), 1.0 + x.tan().powi(2)),
        Asin => a.mapped(x.asin(), 1.0 / (1.0 - x * x).sqrt()),
        Acos => a.mapped(x.acos(), 1.0 / (1.0 - x * x).sqrt()),
        Atan => a.mapped(x.atan(), 1.0 / (1.0 + x * x)),
        Atan2 => {
            let square = x * x + b.value * b.value;
            let terms = (b.value.abs() * a.terms + x.abs() * b.terms) / square;
            let value = x.atan2(b.value);
            Sized::rounded(value, terms + value.abs())
        }
        Sqrt => a.mapped(x.sqrt(), 0.5 / x.sqrt()),
        Exp => a.mapped(x.exp(), x.exp()),
        Log => a.mapped(x.ln(), 1.0 / x),
        Sinh => a.mapped(x.sinh(), x.cosh()),
        Cosh => a.mapped(x.cosh(), x.sinh()),
        Tanh => a.mapped(x.tanh(), 1.0 - x.tanh().powi(2)),
        Abs => a.mapped(x.abs(), 1.0),
        Frozen => a.mapped(x, 1.0),
        Sign => Sized::exact(if x < 0.0 { -1.0 } else { 1.0 }),
        Min => Sized::rounded(x.min(b.value), a.terms + b.terms),
        Max => Sized::rounded(x.max(b.value), a.terms + b.terms),
    }
}
