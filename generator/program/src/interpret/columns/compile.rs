//! Compiles a program to steps on slots. Values that depend on parameters alone become numbers, and a slot is
//! reused after the last use of its value.

use std::collections::{HashMap, HashSet, VecDeque};
use std::mem::discriminant;

use super::chains;
use super::slots::{Slotted, with_slots};
use super::steps::{Code, Draft, Factor, Place, Run, Same, Term, Varying};
use crate::interpret::constants::Constants;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::{Program, Quantity};

/// Some quantities of a program, prepared for evaluation at many states with the same parameters.
#[derive(Clone, Debug)]
pub struct Columns {
    pub(super) runs: Vec<Run>,
    /// the terms of all chains: their factors are in these slots
    pub(super) terms: Vec<Term<Factor>>,
    /// the numbers of chains that are the same for all states
    pub(super) same: Vec<Same>,
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
