//! Steps of columns: what they do, and their operands before and after slots are assigned.

use crate::program::graph::Input;
use hodograph_model::arithmetic::Function;

/// The operation of a step on the operands `a`, `b`, `c`. The letters at the end say for each operand whether
/// it is in a slot (`S`) or the same for all states (`U`, uniform). Factors and terms may have been
/// exchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    Load(Input),
    Neg,
    Recip,
    SineCosine,
    AddSS,
    AddSU,
    SubSS,
    SubSU,
    SubUS,
    MulSS,
    MulSU,
    DivSS,
    DivSU,
    DivUS,
    MulAddSSS,
    MulAddSUS,
    MulAddSSU,
    MulAddSUU,
    MulAddUUS,
    MulSubSSS,
    MulSubSUS,
    MulSubSSU,
    MulSubSUU,
    MulSubUUS,
    NegMulAddSSS,
    NegMulAddSUS,
    NegMulAddSSU,
    NegMulAddSUU,
    NegMulAddUUS,
    /// the terms from `a` on, `b` of them, added to `c`
    Chain,
    Call(Function),
    CallSS(Function),
    CallSU(Function),
    CallUS(Function),
    /// the result of number `to` is in slot `a`
    Result,
    /// `a` must not vanish: check number `to`
    NotZeroS,
    /// `a` must not vanish beside `b`: check number `to`
    NotSmallSS,
    NotSmallSU,
    NotSmallUS,
}

impl Code {
    pub fn is_mul_add(self) -> bool {
        use Code::*;
        matches!(self, MulAddSSS | MulAddSUS | MulAddSSU | MulAddSUU | MulAddUUS)
    }

    pub fn is_mul_sub(self) -> bool {
        use Code::*;
        matches!(self, MulSubSSS | MulSubSUS | MulSubSSU | MulSubSUU | MulSubUUS)
    }

    pub fn is_neg_mul_add(self) -> bool {
        use Code::*;
        matches!(self, NegMulAddSSS | NegMulAddSUS | NegMulAddSSU | NegMulAddSUU | NegMulAddUUS)
    }
}

/// Steps with the same operation that follow each other.
#[derive(Clone, Debug)]
pub struct Run {
    pub code: Code,
    pub steps: Vec<Step>,
}

/// A step. Its result goes to slot `to`; sine and cosine go to `to` and `b`.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub to: u32,
    pub a: u32,
    pub b: u32,
    pub c: u32,
}

/// A product that is added to the sum of a chain.
#[derive(Clone, Copy, Debug)]
pub struct Term<P> {
    pub factors: [P; 2],
    /// the product is subtracted
    pub minus: bool,
    /// the sum so far changes its sign
    pub turned: bool,
}

/// A factor of a term.
#[derive(Clone, Copy, Debug)]
pub struct Factor {
    pub slot: u32,
    /// all states have the same number: one group of them is read
    pub is_same: bool,
}

/// A number that is the same for all states.
#[derive(Clone, Copy, Debug)]
pub enum Same {
    Uniform(u32),
    Number(f64),
}

/// A value that differs between states: a value of the program, or the cosine of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Varying {
    pub value: u32,
    pub cosine: bool,
}

/// An operand before slots are assigned.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    Varying(Varying),
    Uniform(u32),
    /// in chains
    Number(f64),
}

/// A step before slots are assigned: the value that it defines, and its operands.
pub struct Draft {
    pub code: Code,
    pub defines: [Option<Varying>; 2],
    pub number: u32,
    /// of a chain the first alone: what its terms are added to
    pub operands: [Option<Place>; 3],
    /// of a chain
    pub terms: Vec<Term<Place>>,
}

impl Draft {
    /// One that defines nothing.
    pub fn of(code: Code, number: u32, operands: [Option<Place>; 3]) -> Self {
        Draft { code, defines: [None; 2], number, operands, terms: Vec::new() }
    }

    fn places(&self) -> impl Iterator<Item = Place> {
        self.operands.iter().flatten().copied().chain(self.terms.iter().flat_map(|term| term.factors))
    }

    /// The values that it reads.
    pub fn reads(&self) -> impl Iterator<Item = Varying> {
        self.places().filter_map(|place| match place {
            Place::Varying(varying) => Some(varying),
            Place::Uniform(_) | Place::Number(_) => None,
        })
    }
}
