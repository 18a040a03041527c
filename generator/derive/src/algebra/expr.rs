//! Algebraic expressions, as a wrapper of the algebra engine's. Only this file and `session` name the engine.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use num_bigint::BigInt;
use num_rational::BigRational;
use symbolica::atom::{Atom, AtomCore, AtomView, Symbol};
use symbolica::domains::rational::Rational;

use hodograph_model::number::Number;

/// The number of a symbol. Names of users never reach the engine: symbols are numbered, and always created in
/// the order of their numbers, so that the engine's ordering does not depend on earlier derivations.
pub type SymbolId = u32;

/// An exact algebraic expression in numbered symbols: rational numbers, sums, products and integer powers.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Expr(Atom);

/// The outermost structure of an expression.
#[derive(Clone, Debug)]
pub enum View {
    /// a number
    Number(Number),
    /// a symbol
    Symbol(SymbolId),
    /// a sum
    Sum(Vec<Expr>),
    /// a product
    Product(Vec<Expr>),
    /// an integer power
    Power(Expr, i32),
}

/// The pool of symbols, in order, and their numbers.
#[derive(Default)]
struct Pool {
    symbols: Vec<Symbol>,
    numbers: HashMap<Symbol, SymbolId>,
}

static POOL: Mutex<Option<Pool>> = Mutex::new(None);

fn with_pool<R>(work: impl FnOnce(&mut Pool) -> R) -> R {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    work(pool.get_or_insert_with(Pool::default))
}

fn symbol(id: SymbolId) -> Symbol {
    with_pool(|pool| {
        while pool.symbols.len() <= id as usize {
            let number = pool.symbols.len() as u32;
            let symbol = symbolica::symbol!(format!("hodograph::v{number}"));
            pool.symbols.push(symbol);
            pool.numbers.insert(symbol, number);
        }
        pool.symbols[id as usize]
    })
}

fn number_of(symbol: Symbol) -> SymbolId {
    with_pool(|pool| pool.numbers.get(&symbol).copied().unwrap_or(SymbolId::MAX))
}

impl Expr {
    /// 0.
    pub fn zero() -> Self {
        Expr(Atom::num(0))
    }

    /// 1.
    pub fn one() -> Self {
        Expr(Atom::num(1))
    }

    /// An integer.
    pub fn integer(n: i64) -> Self {
        Expr(Atom::num(n))
    }

    /// An exact number.
    pub fn number(number: &Number) -> Self {
        match (i64::try_from(number.0.numer()), i64::try_from(number.0.denom())) {
            (Ok(n), Ok(d)) => Expr(Atom::num(Rational::from((n, d)))),
            _ => big(number.0.numer()).div(&big(number.0.denom())),
        }
    }

    /// A symbol.
    pub fn symbol(id: SymbolId) -> Self {
        Expr(Atom::var(symbol(id)))
    }

    /// Whether it is the number 0.
    pub fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// Whether it is the number 1.
    pub fn is_one(&self) -> bool {
        self.0.is_one()
    }

    /// Sum.
    pub fn add(&self, other: &Expr) -> Expr {
        Expr(&self.0 + &other.0)
    }

    /// Difference.
    pub fn sub(&self, other: &Expr) -> Expr {
        Expr(&self.0 - &other.0)
    }

    /// Product.
    pub fn mul(&self, other: &Expr) -> Expr {
        Expr(&self.0 * &other.0)
    }

    /// Quotient.
    pub fn div(&self, other: &Expr) -> Expr {
        self.mul(&other.pow(-1))
    }

    /// Negative.
    pub fn neg(&self) -> Expr {
        Expr(-&self.0)
    }

    /// Integer power; the power 0 of everything is 1, as in floating-point arithmetic.
    pub fn pow(&self, n: i32) -> Expr {
        if n == 0 {
            return Expr::one();
        }
        Expr(self.0.pow(Atom::num(n as i64)))
    }

    /// Sum of many terms.
    pub fn sum<'a>(terms: impl IntoIterator<Item = &'a Expr>) -> Expr {
        terms.into_iter().fold(Expr::zero(), |sum, term| sum.add(term))
    }

    /// The expression with products multiplied out.
    pub fn expand(&self) -> Expr {
        Expr(self.0.expand())
    }

    /// Partial derivative with respect to a symbol.
    pub fn derivative(&self, id: SymbolId) -> Expr {
        Expr(self.0.derivative(symbol(id)))
    }

    /// The expression with every occurrence of a symbol replaced.
    pub fn replace(&self, id: SymbolId, by: &Expr) -> Expr {
        Expr(self.0.replace(Atom::var(symbol(id))).with(by.0.clone()))
    }

    /// The symbols that occur, in order of their numbers.
    pub fn symbols(&self) -> Vec<SymbolId> {
        let mut symbols: Vec<_> = self.0.get_all_symbols(false).into_iter().map(number_of).collect();
        symbols.sort_unstable();
        symbols
    }

    /// Whether it is free of symbols.
    pub fn is_number(&self) -> bool {
        matches!(self.0.as_view(), AtomView::Num(_))
    }

    /// The symbol it is, if it is one.
    pub fn as_symbol(&self) -> Option<SymbolId> {
        match self.0.as_view() {
            AtomView::Var(var) => Some(number_of(var.get_symbol())),
            _ => None,
        }
    }

    /// The outermost structure.
    pub fn view(&self) -> View {
        match self.0.as_view() {
            AtomView::Num(_) => View::Number(exact(self.0.as_view())),
            AtomView::Var(var) => View::Symbol(number_of(var.get_symbol())),
            AtomView::Add(sum) => View::Sum(sum.iter().map(|term| Expr(term.to_owned())).collect()),
            AtomView::Mul(product) => View::Product(product.iter().map(|f| Expr(f.to_owned())).collect()),
            AtomView::Pow(power) => {
                let (base, exponent) = power.get_base_exp();
                let exponent = exact(exponent).to_integer().and_then(|n| i32::try_from(n).ok());
                View::Power(Expr(base.to_owned()), exponent.expect("only integer powers are built"))
            }
            AtomView::Fun(_) => unreachable!("functions are symbols of their own"),
        }
    }
}

fn big(integer: &BigInt) -> Expr {
    let base = Expr::integer(1 << 32);
    let (sign, digits) = integer.to_u32_digits();
    let value = digits
        .iter()
        .rev()
        .fold(Expr::zero(), |value, &digit| value.mul(&base).add(&Expr::integer(digit as i64)));
    if sign == num_bigint::Sign::Minus { value.neg() } else { value }
}

fn exact(view: AtomView<'_>) -> Number {
    let rational = Rational::try_from(view).expect("coefficients are rational");
    let parse = |text: String| text.parse::<BigInt>().expect("an integer prints as its digits");
    Number(BigRational::new(
        parse(rational.numerator_ref().to_string()),
        parse(rational.denominator_ref().to_string()),
    ))
}
