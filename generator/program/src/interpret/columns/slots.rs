//! Assigns slots to the values of steps.

use std::collections::HashMap;

use super::steps::{Code, Draft, Factor, Place, Run, Same, Step, Term, Varying};

/// Steps on slots.
pub struct Slotted {
    pub runs: Vec<Run>,
    /// of all chains
    pub terms: Vec<Term<Factor>>,
    /// numbers of chains that are the same for all states
    pub same: Vec<Same>,
    /// number of slots
    pub slots: usize,
}

/// The slots that are held.
#[derive(Default)]
struct Slots {
    held: HashMap<Varying, u32>,
    free: Vec<u32>,
    count: u32,
    /// the places of numbers that are the same for all states, by their bits or by their index
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

    /// The place of an operand of a chain.
    fn of(&mut self, place: Place, same: &mut Vec<Same>) -> Factor {
        let (key, number) = match place {
            Place::Varying(varying) => {
                return Factor::in_slot(self.held.get(&varying).copied().unwrap_or(0));
            }
            Place::Uniform(uniform) => ((true, u64::from(uniform)), Same::Uniform(uniform)),
            Place::Number(number) => ((false, number.to_bits()), Same::Number(number)),
        };
        let next = same.len() as u32;
        Factor::same(*self.same.entry(key).or_insert_with(|| {
            same.push(number);
            next
        }))
    }
}

/// Assigns slots; the slot that became free last is reused first.
pub fn with_slots(drafts: &[Draft]) -> Slotted {
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
                let mut factors = term.factors.map(|place| slots.of(place, &mut same));
                // what is the same for all states goes last
                factors.sort_by_key(|factor| factor.is_same());
                terms.push(Term { factors, sign: term.sign });
            }
            let sum = draft.operands[0].map_or(Factor::in_slot(0), |place| slots.of(place, &mut same));
            [first, draft.terms.len() as u32, sum.0]
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
