//! Compiles a program to steps on slots. Values that depend on parameters alone become numbers, and a slot is
//! reused after the last use of its value.

use std::collections::{HashMap, HashSet, VecDeque};
use std::mem::discriminant;

use super::chains::{self, Term};
use crate::interpret::constants::Constants;
use crate::program::graph::Input;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::{Program, Quantity};
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
    pub(super) fn is_mul_add(self) -> bool {
        use Code::*;
        matches!(self, MulAddSSS | MulAddSUS | MulAddSSU | MulAddSUU | MulAddUUS)
    }

    pub(super) fn is_mul_sub(self) -> bool {
        use Code::*;
        matches!(self, MulSubSSS | MulSubSUS | MulSubSSU | MulSubSUU | MulSubUUS)
    }

    pub(super) fn is_neg_mul_add(self) -> bool {
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

/// Some quantities of a program, prepared for evaluation at many states with the same parameters.
#[derive(Clone, Debug)]
pub struct Columns {
    pub(super) runs: Vec<Run>,
    /// the terms of all chains: their factors are in these slots
    pub(super) terms: Vec<Term<Factor>>,
    /// slots that hold the same number for all states
    pub(super) same: Vec<(u32, Same)>,
    /// number of slots that the steps need
    pub(super) slots: usize,
    /// values that are the same for all states: the value of the program, and its number
    pub(super) uniforms: Vec<(Value, f64)>,
    /// results that are the same for all states: the index of the result, and its index in `uniforms`
    pub(super) uniform_results: Vec<(usize, u32)>,
    /// number of results of a state
    pub(super) len: usize,
    /// indices of the guards that are checked, in the order in which they are reported
    pub(super) guards: Vec<usize>,
}

impl Columns {
    /// Prepares those of the quantities that the program has, in this order.
    pub fn new(program: &Program, constants: &Constants, quantities: &[Quantity]) -> Self {
        columns(program, constants, quantities)
    }

    /// Replaces the parameters.
    pub fn refresh(&mut self, constants: &Constants) {
        for (value, number) in &mut self.uniforms {
            *number = constants.get(*value);
        }
    }

    /// Number of results of a state: the entries of all quantities, one after the other, each by rows.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no results, because the program has none of the quantities.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number of slots of a block, each of `8 LANES` bytes.
    pub fn slots(&self) -> usize {
        self.slots
    }
}

/// A factor of a term.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factor {
    pub slot: u32,
    /// all states have the same number: one group of them is read
    pub is_same: bool,
}

/// A number that is the same for all states.
#[derive(Clone, Copy, Debug)]
pub(super) enum Same {
    Uniform(u32),
    Number(f64),
}

/// A value that differs between states: a value of the program, or the cosine of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Varying {
    value: u32,
    cosine: bool,
}

/// An operand before slots are assigned.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Varying(Varying),
    Uniform(u32),
    /// in chains
    Number(f64),
}

/// A step before slots are assigned: the value that it defines, and its operands.
pub(super) struct Draft {
    pub code: Code,
    pub defines: [Option<Varying>; 2],
    pub number: u32,
    /// of a chain the first alone: what its terms are added to
    pub operands: [Option<Place>; 3],
    /// of a chain
    pub terms: Vec<Term<Place>>,
}

/// Compiles those of the quantities that the program has.
fn columns(program: &Program, constants: &Constants, quantities: &[Quantity]) -> Columns {
    let slice = program.slice(quantities);
    let mut compiler = Compiler { program, constants, uniforms: Vec::new(), numbers: HashMap::new() };
    let mut results: HashMap<Varying, Vec<u32>> = HashMap::new();
    let mut uniform_results = Vec::new();
    let mut len = 0;
    for &value in slice.outputs.iter().flat_map(|output| &output.values) {
        match compiler.place(value) {
            Place::Varying(varying) => results.entry(varying).or_default().push(len as u32),
            Place::Uniform(uniform) => uniform_results.push((len, uniform)),
            Place::Number(_) => {}
        }
        len += 1;
    }
    let (mut checks, mut guards) = (Vec::new(), Vec::new());
    for guard in &slice.guards {
        if program.guard_stage(guard, &constants.stages) > Stage::Parameter {
            checks.push((compiler.place(guard.value), guard.scale.map(|scale| compiler.place(scale))));
            guards.push(program.guards.iter().position(|other| other == *guard).unwrap_or(usize::MAX));
        }
    }
    let mut drafts = Vec::new();
    let mut defined: HashMap<Varying, ()> = HashMap::new();
    let mut open: Vec<usize> = (0..checks.len()).collect();
    for &value in &slice.order {
        if constants.stage(value) <= Stage::Parameter {
            continue;
        }
        let Some(draft) = compiler.draft(value) else { continue };
        let defines = draft.defines;
        drafts.push(draft);
        for varying in defines.into_iter().flatten() {
            defined.insert(varying, ());
            for &number in results.get(&varying).into_iter().flatten() {
                drafts.push(Draft::of(Code::Result, number, [Some(Place::Varying(varying)), None, None]));
            }
        }
        open.retain(|&check| {
            let (value, scale) = checks[check];
            let known = |place: Place| match place {
                Place::Varying(varying) => defined.contains_key(&varying),
                Place::Uniform(_) | Place::Number(_) => true,
            };
            let ready = known(value) && scale.is_none_or(known);
            if ready {
                let code = match (value, scale) {
                    (Place::Varying(_), None) => Code::NotZeroS,
                    (Place::Varying(_), Some(Place::Varying(_))) => Code::NotSmallSS,
                    (Place::Varying(_), Some(_)) => Code::NotSmallSU,
                    (_, _) => Code::NotSmallUS,
                };
                drafts.push(Draft::of(code, check as u32, [Some(value), scale, None]));
            }
            !ready
        });
    }
    let Slotted { runs, terms, same, slots } = with_slots(&grouped(chains::joined(drafts)));
    Columns { runs, terms, same, slots, uniforms: compiler.uniforms, uniform_results, len, guards }
}

impl Draft {
    fn of(code: Code, number: u32, operands: [Option<Place>; 3]) -> Self {
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

struct Compiler<'a> {
    program: &'a Program,
    constants: &'a Constants,
    uniforms: Vec<(Value, f64)>,
    numbers: HashMap<Value, u32>,
}

impl Compiler<'_> {
    fn place(&mut self, value: Value) -> Place {
        if self.constants.stage(value) <= Stage::Parameter {
            let (uniforms, constants) = (&mut self.uniforms, self.constants);
            return Place::Uniform(*self.numbers.entry(value).or_insert_with(|| {
                uniforms.push((value, constants.get(value)));
                uniforms.len() as u32 - 1
            }));
        }
        // The sine is the first number of its pair, the cosine the second.
        Place::Varying(match self.program.operation(value) {
            Operation::Sine(pair) => Varying { value: pair.0, cosine: false },
            Operation::Cosine(pair) => Varying { value: pair.0, cosine: true },
            _ => Varying { value: value.0, cosine: false },
        })
    }

    /// The step that computes a value; `None` for a sine or cosine, which the step of their pair computes.
    fn draft(&mut self, value: Value) -> Option<Draft> {
        use Operation as O;
        let first = Varying { value: value.0, cosine: false };
        let mut defines = [Some(first), None];
        let operation = self.program.operation(value);
        let mut places = operation.operands().map(|operand| self.place(operand));
        let mut operands: [Option<Place>; 3] = std::array::from_fn(|_| places.next());
        drop(places);
        // Uniform factors and terms go last. Of three operands, the first two are the factors.
        let exchangeable =
            matches!(operation, O::Add(..) | O::Mul(..) | O::MulAdd(..) | O::MulSub(..) | O::NegMulAdd(..));
        if exchangeable && matches!(operands[0], Some(Place::Uniform(_))) {
            operands.swap(0, 1);
        }
        let uniform = operands.map(|operand| matches!(operand, Some(Place::Uniform(_))));
        let code = match operation {
            O::Constant(_) | O::Sine(_) | O::Cosine(_) => return None,
            O::Input(input) => Code::Load(input),
            O::Neg(_) => Code::Neg,
            O::Recip(_) => Code::Recip,
            O::SinCos(_) => {
                defines[1] = Some(Varying { value: value.0, cosine: true });
                Code::SineCosine
            }
            O::Add(..) => {
                if uniform[1] {
                    Code::AddSU
                } else {
                    Code::AddSS
                }
            }
            O::Mul(..) => {
                if uniform[1] {
                    Code::MulSU
                } else {
                    Code::MulSS
                }
            }
            O::Sub(..) => pick([Code::SubSS, Code::SubSU, Code::SubUS], uniform),
            O::Div(..) => pick([Code::DivSS, Code::DivSU, Code::DivUS], uniform),
            O::MulAdd(..) => pick_of_five(
                [Code::MulAddSSS, Code::MulAddSUS, Code::MulAddSSU, Code::MulAddSUU, Code::MulAddUUS],
                uniform,
            ),
            O::MulSub(..) => pick_of_five(
                [Code::MulSubSSS, Code::MulSubSUS, Code::MulSubSSU, Code::MulSubSUU, Code::MulSubUUS],
                uniform,
            ),
            O::NegMulAdd(..) => pick_of_five(
                [
                    Code::NegMulAddSSS,
                    Code::NegMulAddSUS,
                    Code::NegMulAddSSU,
                    Code::NegMulAddSUU,
                    Code::NegMulAddUUS,
                ],
                uniform,
            ),
            O::Call(function, _) => Code::Call(function),
            O::Call2(function, ..) => {
                pick([Code::CallSS(function), Code::CallSU(function), Code::CallUS(function)], uniform)
            }
        };
        Some(Draft { code, defines, number: 0, operands, terms: Vec::new() })
    }
}

/// Chooses among the codes for operands SS, SU, US.
fn pick(codes: [Code; 3], uniform: [bool; 3]) -> Code {
    codes[if uniform[0] { 2 } else { usize::from(uniform[1]) }]
}

/// Chooses among the codes for the operands SSS, SUS, SSU, SUU, UUS.
fn pick_of_five(codes: [Code; 5], uniform: [bool; 3]) -> Code {
    codes[if uniform[0] { 4 } else { usize::from(uniform[1]) + 2 * usize::from(uniform[2]) }]
}

/// Number of waiting steps that are searched for one with the same code as the last step.
const WINDOW: usize = 128;

/// Orders the steps so that steps with the same code follow each other as far as their operands allow; this
/// helps the processor's branch prediction. Steps move by a bounded distance only, so that the number of live
/// values hardly grows.
fn grouped(drafts: Vec<Draft>) -> Vec<Draft> {
    let mut waiting = VecDeque::from(drafts);
    let mut defined = HashSet::<Varying>::new();
    let mut ordered: Vec<Draft> = Vec::with_capacity(waiting.len());
    loop {
        let last = ordered.last().map(|draft| discriminant(&draft.code));
        let alike = waiting.iter().take(WINDOW).position(|draft| {
            Some(discriminant(&draft.code)) == last && draft.reads().all(|varying| defined.contains(&varying))
        });
        // The operands of the first waiting step are defined by earlier steps.
        let Some(draft) = waiting.remove(alike.unwrap_or(0)) else { return ordered };
        defined.extend(draft.defines.iter().flatten());
        ordered.push(draft);
    }
}

/// Steps on slots.
struct Slotted {
    runs: Vec<Run>,
    terms: Vec<Term<Factor>>,
    same: Vec<(u32, Same)>,
    slots: usize,
}

/// The slots that are held.
#[derive(Default)]
struct Slots {
    held: HashMap<Varying, u32>,
    free: Vec<u32>,
    count: u32,
    /// of numbers that are the same for all states, by their bits or by their index
    same: HashMap<(bool, u64), u32>,
}

impl Slots {
    fn new_slot(&mut self) -> u32 {
        self.count += 1;
        self.count - 1
    }

    fn take(&mut self, varying: Varying) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| self.new_slot());
        self.held.insert(varying, slot);
        slot
    }

    fn release(&mut self, varying: Varying) {
        self.free.extend(self.held.remove(&varying));
    }

    /// The slot of an operand of a chain.
    fn of(&mut self, place: Place, same: &mut Vec<(u32, Same)>) -> u32 {
        let (key, number) = match place {
            Place::Varying(varying) => return self.held.get(&varying).copied().unwrap_or(0),
            Place::Uniform(uniform) => ((true, u64::from(uniform)), Same::Uniform(uniform)),
            Place::Number(number) => ((false, number.to_bits()), Same::Number(number)),
        };
        if let Some(slot) = self.same.get(&key) {
            return *slot;
        }
        let slot = self.new_slot();
        self.same.insert(key, slot);
        same.push((slot, number));
        slot
    }
}

/// Assigns slots; the slot that became free last is reused first.
fn with_slots(drafts: &[Draft]) -> Slotted {
    let mut last: HashMap<Varying, usize> = HashMap::new();
    for (index, draft) in drafts.iter().enumerate() {
        for varying in draft.reads().chain(draft.defines.into_iter().flatten()) {
            last.insert(varying, index);
        }
    }
    let mut slots = Slots::default();
    let (mut runs, mut terms, mut same): (Vec<Run>, Vec<_>, Vec<_>) = (Vec::new(), Vec::new(), Vec::new());
    for (index, draft) in drafts.iter().enumerate() {
        let [a, b, c] = if draft.code == Code::Chain {
            let first = terms.len() as u32;
            for term in &draft.terms {
                let factors = term.factors.map(|place| Factor {
                    slot: slots.of(place, &mut same),
                    is_same: !matches!(place, Place::Varying(_)),
                });
                terms.push(Term { factors, minus: term.minus, turned: term.turned });
            }
            let sum = draft.operands[0].map_or(0, |place| slots.of(place, &mut same));
            [first, draft.terms.len() as u32, sum]
        } else {
            draft.operands.map(|place| match place {
                Some(Place::Varying(varying)) => slots.held.get(&varying).copied().unwrap_or(0),
                Some(Place::Uniform(uniform)) => uniform,
                Some(Place::Number(_)) | None => 0,
            })
        };
        for varying in draft.reads().filter(|varying| last.get(varying) == Some(&index)) {
            slots.release(varying);
        }
        let defined = draft.defines.map(|varying| varying.map(|varying| slots.take(varying)));
        // values that are never used
        for varying in draft.defines.into_iter().flatten().filter(|varying| last.get(varying) == Some(&index))
        {
            slots.release(varying);
        }
        let step = Step { to: defined[0].unwrap_or(draft.number), a, b: defined[1].unwrap_or(b), c };
        match runs.last_mut().filter(|run| run.code == draft.code) {
            Some(run) => run.steps.push(step),
            None => runs.push(Run { code: draft.code, steps: vec![step] }),
        }
    }
    Slotted { runs, terms, same, slots: slots.count as usize }
}
