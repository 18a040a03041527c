//! Shortens expressions: multiplies products out, replaces squares of sines or cosines, and replaces names by
//! their definitions.

use super::{Intermediates, Meaning};
use crate::algebra::expr::{Expr, SymbolId, View};
use hodograph_model::arithmetic::Function;
use hodograph_model::number::Number;

impl Intermediates {
    /// The expression with products multiplied out and sin^2 + cos^2 = 1 used wherever that makes it shorter.
    pub fn simplify(&mut self, expr: &Expr) -> Expr {
        let mut best = expr.expand();
        for (sine, cosine) in self.angles_squared(&best) {
            for (square, other) in [(sine, cosine), (cosine, sine)] {
                let other = Expr::symbol(other);
                let reduced = reduce_square(&best, square, &Expr::one().sub(&other.mul(&other)));
                if size(&reduced) < size(&best) {
                    best = reduced;
                }
            }
        }
        if size(expr) <= size(&best) { expr.clone() } else { best }
    }

    /// Pairs of sine and cosine symbols of one angle, one of which occurs squared.
    fn angles_squared(&self, expr: &Expr) -> Vec<(SymbolId, SymbolId)> {
        let mut pairs = Vec::new();
        for symbol in expr.symbols() {
            if let Meaning::Call(Function::Sin, arguments) = self.meaning(symbol)
                && let Some(&cosine) = self.calls.get(&(Function::Cos, arguments.clone()))
                && [symbol, cosine].iter().any(|&s| !expr.derivative(s).derivative(s).is_zero())
            {
                pairs.push((symbol, cosine));
            }
        }
        pairs
    }

    /// The expression with names replaced by their definitions, as long as its size stays below `most`.
    pub fn opened(&self, expr: &Expr, most: usize) -> Expr {
        let mut best = expr.clone();
        loop {
            let named = best.symbols().into_iter().find_map(|symbol| match self.meaning(symbol) {
                Meaning::Named(value) => Some((symbol, value.clone())),
                _ => None,
            });
            let Some((symbol, value)) = named else { return best };
            let next = best.replace(symbol, &value);
            if size(&next) > most {
                return best;
            }
            best = next;
        }
    }
}

/// `expr` with `symbol`^2 replaced by `square`, wherever it occurs in the expanded expression.
fn reduce_square(expr: &Expr, symbol: SymbolId, square: &Expr) -> Expr {
    if has_divisor(expr) {
        return expr.clone();
    }
    let mut result = Expr::zero();
    let mut rest = expr.clone();
    let mut factor = Expr::one();
    let mut order = 1i64;
    // Taylor coefficients in `symbol`: exact for a polynomial; give up on anything of high degree or not
    // polynomial.
    for power in 0..8u32 {
        let coefficient = rest.replace(symbol, &Expr::zero());
        let coefficient = coefficient.mul(&Expr::number(&Number::ratio(1, order)));
        result = result.add(&coefficient.mul(&factor));
        rest = rest.derivative(symbol);
        order *= power as i64 + 1;
        factor = if power % 2 == 0 {
            factor.mul(&Expr::symbol(symbol))
        } else {
            factor.replace(symbol, &Expr::one()).mul(square)
        };
        if rest.is_zero() {
            return result.expand();
        }
    }
    expr.clone()
}

/// Whether a negative power occurs.
fn has_divisor(expr: &Expr) -> bool {
    match expr.view() {
        View::Number(_) | View::Symbol(_) => false,
        View::Sum(parts) | View::Product(parts) => parts.iter().any(has_divisor),
        View::Power(base, n) => n < 0 || has_divisor(&base),
    }
}

/// The approximate number of operations of an expression.
pub fn size(expr: &Expr) -> usize {
    match expr.view() {
        View::Number(_) | View::Symbol(_) => 1,
        View::Sum(parts) | View::Product(parts) => parts.iter().map(size).sum::<usize>() + parts.len() - 1,
        View::Power(base, n) => size(&base) + n.unsigned_abs() as usize,
    }
}
