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
    /// the terms from `a` on, `b` of them, added to the [`Factor`] `c`
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

/// A product that a chain adds to its sum.
#[derive(Clone, Copy, Debug)]
pub struct Term<P> {
    /// of factors in a chain with slots, those that are the same for all states stand last
    pub factors: [P; 2],
    pub sign: Sign,
}

/// How a chain goes on with a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sign {
    /// sum + product
    Plus,
    /// sum - product
    Minus,
    /// product - sum
    MinusSum,
}

/// An operand of a chain: a slot, or a number that is the same for all states.
#[derive(Clone, Copy, Debug)]
pub struct Factor(pub u32);

impl Factor {
    const SAME: u32 = 1 << 31;

    /// The slot of this index.
    pub fn in_slot(slot: u32) -> Self {
        Self(slot)
    }

    /// The number of this index among those that are the same for all states.
    pub fn same(number: u32) -> Self {
        Self(number | Self::SAME)
    }

    /// Whether it is the same for all states.
    #[inline(always)]
    pub fn is_same(self) -> bool {
        self.0 & Self::SAME != 0
    }

    /// Its index among slots or among numbers.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & !Self::SAME) as usize
    }
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
