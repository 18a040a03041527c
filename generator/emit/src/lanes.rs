//! Emits the columns of a matrix that are computed by the same operations as a single loop, so that vector
//! instructions compute several columns at a time.
//!
//! Columns that solve equations with the same factor differ only in their right sides. Such operations are
//! found from the results backwards, in parallel with those of another column: each has a factor that all
//! columns share, and other operands of its own. Every entry is computed by its own operations in their
//! order, so the bits are those of the program.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::storage::Storage;
use super::values::local;
use hodograph_program::program::Output;
use hodograph_program::program::operation::{Operation, Stage, Value};

/// The number of columns of a loop is a multiple of this: the doubles of a vector register.
const WIDTH: usize = 4;
/// The least number of instructions that a loop must save, by the estimate of [`Lanes::saves`].
const MIN_SAVING: usize = 100;

/// Operations that several columns have in common. Each list of values has one value per column.
pub struct Lanes {
    /// the operations, in order
    steps: Vec<Vec<Value>>,
    /// operands that differ between columns
    given: Vec<Vec<Value>>,
    /// operands that all columns share
    shared: Vec<Value>,
    /// indices of the steps that are results
    made: Vec<usize>,
}

/// An operation of a column: its kind, the factor that all columns share, and its own operands.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Step {
    kind: ComponentKind,
    shared: Option<Value>,
    own: [Option<Value>; 2],
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum ComponentKind {
    Neg,
    Mul,
    NegMulAdd,
}

/// The columns that need a value.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    Nobody,
    Column(usize),
    Several,
}

/// The dependencies between the operations of an output.
struct Columns<'a> {
    emitter: &'a Emitter<'a>,
    output: &'a Output,
    owners: BTreeMap<Value, Owner>,
    users: BTreeMap<Value, Vec<Value>>,
}

impl Emitter<'_> {
    /// The parts of an output, which needs the values `order`, that are computed in loops. `checked` are
    /// values that guards use.
    pub fn lanes(&self, output: &Output, order: &[Value], checked: &BTreeSet<Value>) -> Vec<Lanes> {
        let columns = Columns::new(self, output, order, checked);
        let mut left: Vec<usize> = (0..output.columns).collect();
        let mut found = Vec::new();
        while let Some(&first) = left.first() {
            let (members, lanes) = columns.group(first, &left);
            left.retain(|column| !members.contains(column));
            found.extend(lanes.filter(|lanes| lanes.saves() >= MIN_SAVING));
        }
        found
    }
}

impl<'a> Columns<'a> {
    fn new(emitter: &'a Emitter<'a>, output: &'a Output, order: &[Value], checked: &BTreeSet<Value>) -> Self {
        let mut owners: BTreeMap<Value, Owner> = BTreeMap::new();
        let mut users: BTreeMap<Value, Vec<Value>> = BTreeMap::new();
        for (place, &value) in output.values.iter().enumerate() {
            add(&mut owners, value, Owner::Column(place % output.columns));
        }
        checked.iter().for_each(|&value| add(&mut owners, value, Owner::Several));
        let sorted: BTreeSet<Value> = order.iter().copied().collect();
        for &value in sorted.iter().rev() {
            let owner = owners.get(&value).copied().unwrap_or(Owner::Several);
            for operand in emitter.program.operation(value).operands() {
                add(&mut owners, operand, owner);
                users.entry(operand).or_default().push(value);
            }
        }
        Columns { emitter, output, owners, users }
    }

    fn owner(&self, value: Value) -> Owner {
        self.owners.get(&value).copied().unwrap_or(Owner::Nobody)
    }

    /// The operation in a form that other columns may share.
    fn step(&self, value: Value) -> Option<Step> {
        let Owner::Column(_) = self.owner(value) else { return None };
        if self.emitter.stage(value) <= Stage::Parameter {
            return None;
        }
        let is_shared = |operand: Value| self.owner(operand) == Owner::Several;
        match self.emitter.program.operation(value) {
            Operation::Neg(a) => Some(Step { kind: ComponentKind::Neg, shared: None, own: [Some(a), None] }),
            Operation::Mul(a, b) if is_shared(a) != is_shared(b) => {
                let (shared, own) = if is_shared(a) { (a, b) } else { (b, a) };
                Some(Step { kind: ComponentKind::Mul, shared: Some(shared), own: [Some(own), None] })
            }
            Operation::NegMulAdd(a, b, c) if is_shared(a) && !is_shared(b) => {
                Some(Step { kind: ComponentKind::NegMulAdd, shared: Some(a), own: [Some(b), Some(c)] })
            }
            _ => None,
        }
    }

    /// The operations of one column, with the corresponding ones of another.
    fn alike(&self, first: usize, second: usize) -> BTreeMap<Value, Value> {
        let mut pairs = BTreeMap::new();
        let mut stack: Vec<(Value, Value)> = self.roots(first).zip(self.roots(second)).collect();
        while let Some((a, b)) = stack.pop() {
            let (Some(one), Some(other)) = (self.step(a), self.step(b)) else { continue };
            if a == b || pairs.contains_key(&a) || (one.kind, one.shared) != (other.kind, other.shared) {
                continue;
            }
            pairs.insert(a, b);
            let own = one.own.into_iter().flatten().zip(other.own.into_iter().flatten());
            stack.extend(own);
        }
        pairs
    }

    fn roots(&self, column: usize) -> impl Iterator<Item = Value> {
        self.output.values.iter().skip(column).step_by(self.output.columns).copied()
    }

    /// The columns for which a loop together with the first saves most, and that loop.
    fn group(&self, first: usize, left: &[usize]) -> (Vec<usize>, Option<Lanes>) {
        let others = left.iter().filter(|&&column| column != first);
        let mut others: Vec<_> = others.map(|&column| (column, self.alike(first, column))).collect();
        others.sort_by_key(|(column, pairs)| (std::cmp::Reverse(pairs.len()), *column));
        let (mut members, mut pairs, mut best) = (vec![first], Vec::new(), None);
        let mut saved = 0;
        for (column, more) in others {
            members.push(column);
            pairs.push(more);
            let lanes = self.common_operations(first, &members, &pairs);
            let saves = lanes.as_ref().map_or(0, Lanes::saves);
            if saves > saved {
                (saved, best) = (saves, lanes);
            } else if saved > 0 {
                // A loop that is no better may become better with further columns, up to a full register.
                let more = members.len() - best.as_ref().map_or(0, Lanes::columns);
                if more >= WIDTH {
                    break;
                }
            }
        }
        members.truncate(best.as_ref().map_or(1, Lanes::columns));
        (members, best)
    }

    /// The operations that all members share: results, and operations that only such operations use.
    fn common_operations(
        &self,
        first: usize,
        members: &[usize],
        pairs: &[BTreeMap<Value, Value>],
    ) -> Option<Lanes> {
        let mut steps: BTreeMap<Value, Vec<Value>> = BTreeMap::new();
        let common =
            pairs.first()?.keys().copied().filter(|value| pairs.iter().all(|p| p.contains_key(value)));
        let common: Vec<Value> = common.collect();
        let roots: Vec<Vec<Value>> = members.iter().map(|&column| self.roots(column).collect()).collect();
        for &value in common.iter().rev() {
            let values: Vec<Value> = std::iter::once(value).chain(pairs.iter().map(|p| p[&value])).collect();
            let inside = values.iter().zip(0..).all(|(value, lane)| {
                let users = self.users.get(value).map_or(&[][..], Vec::as_slice);
                users.iter().all(|user| steps.values().any(|step: &Vec<Value>| step[lane] == *user))
            });
            // A result must be one at the same place in all columns, since it is stored there.
            let places = |lane: usize, value: Value| -> Vec<bool> {
                roots.get(lane).into_iter().flatten().map(|&root| root == value).collect()
            };
            let alike = values.iter().zip(0..).all(|(&v, lane)| places(lane, v) == places(0, value));
            if inside && alike {
                steps.insert(value, values);
            }
        }
        let made_values: BTreeSet<Value> = self.roots(first).collect();
        let mut lanes = Lanes { steps: vec![], given: vec![], shared: vec![], made: vec![] };
        for (number, (value, values)) in steps.iter().enumerate() {
            if made_values.contains(value) {
                lanes.made.push(number);
            }
            lanes.steps.push(values.clone());
        }
        let is_step = |value: &Value| steps.contains_key(value);
        for value in steps.keys() {
            let step = self.step(*value)?;
            if let Some(shared) = step.shared.filter(|shared| !lanes.shared.contains(shared)) {
                lanes.shared.push(shared);
            }
            for (at, own) in step.own.into_iter().enumerate() {
                let Some(own) = own.filter(|own| !is_step(own)) else { continue };
                if lanes.given.iter().any(|given| given[0] == own) {
                    continue;
                }
                let values = steps[value].iter().map(|&value| self.step(value).and_then(|step| step.own[at]));
                lanes.given.push(values.collect::<Option<Vec<Value>>>()?);
            }
        }
        lanes.is_consistent(self).then_some(lanes)
    }
}

fn add(owners: &mut BTreeMap<Value, Owner>, value: Value, owner: Owner) {
    let known = owners.entry(value).or_insert(Owner::Nobody);
    *known = match *known {
        Owner::Nobody => owner,
        known if known == owner => owner,
        _ => Owner::Several,
    };
}

impl Lanes {
    /// Whether the operands of every column correspond to those of the first.
    fn is_consistent(&self, columns: &Columns<'_>) -> bool {
        let own = |value: Value| columns.step(value).map_or([None; 2], |step| step.own);
        let lists = || self.steps.iter().chain(&self.given);
        self.steps.iter().all(|values| {
            own(values[0]).into_iter().zip(0..).filter_map(|(own, at)| Some((own?, at))).all(
                |(first, at): (_, usize)| {
                    let Some(list) = lists().find(|list| list[0] == first) else { return false };
                    values.iter().zip(list).all(|(&value, &operand)| own(value)[at] == Some(operand))
                },
            )
        })
    }

    /// Number of columns.
    fn columns(&self) -> usize {
        self.steps.first().map_or(0, Vec::len)
    }

    /// Estimate of the saved instructions: a single operation takes two instructions including moves; an
    /// operation of a loop takes one for every four columns.
    fn saves(&self) -> usize {
        let columns = self.columns();
        let (steps, moved) = (self.steps.len(), self.given.len() + self.made.len());
        let alone = 2 * steps * columns;
        let looped = (steps + moved) * columns.div_ceil(WIDTH) + 2 * self.shared.len() + moved * columns;
        alone.saturating_sub(looped)
    }

    /// All values that the loop computes.
    pub fn computed(&self) -> impl Iterator<Item = Value> {
        self.steps.iter().flatten().copied()
    }

    /// Number of columns of the loop, rounded up to full registers.
    fn width(&self) -> usize {
        self.columns().next_multiple_of(WIDTH)
    }

    /// The array of the operands that differ between columns.
    fn given_array(number: usize) -> Ident {
        format_ident!("given_{number}")
    }

    /// The array of the results.
    pub fn made_array(number: usize) -> Ident {
        format_ident!("made_{number}")
    }

    /// All results.
    pub fn results(&self) -> impl Iterator<Item = Value> {
        self.made.iter().flat_map(|&step| &self.steps[step]).copied()
    }

    /// Number of rows of the array of results.
    pub fn made_rows(&self) -> usize {
        self.made.len()
    }

    /// The rows of the results that contain one of these values.
    pub fn rows_with(&self, values: &BTreeSet<Value>) -> Vec<usize> {
        let has = |step: usize| self.steps[step].iter().any(|value| values.contains(value));
        self.made.iter().enumerate().filter(|&(_, &step)| has(step)).map(|(row, _)| row).collect()
    }

    /// The results as local variables.
    pub fn fetch(&self, number: usize) -> TokenStream {
        let made = Self::made_array(number);
        let fetch = self.made.iter().enumerate().flat_map(|(row, &step)| {
            let made = &made;
            self.steps[step].iter().enumerate().map(move |(lane, &value)| {
                let (row, lane) = (Literal::usize_unsuffixed(row), Literal::usize_unsuffixed(lane));
                let value = local(value);
                quote!(let #value = #made[#row][#lane];)
            })
        });
        quote!(#(#fetch)*)
    }

    /// The loop as a function, and its call. `common` are the values in the array that all loops share.
    fn statements(&self, emitter: &Emitter<'_>, number: usize, common: &[Value]) -> TokenStream {
        let krate = emitter.krate;
        let index = Literal::usize_unsuffixed;
        let [width, given_rows, made_rows, common_count] =
            [self.width(), self.given.len(), self.made.len(), common.len()].map(index);
        let (name, given, made) =
            (format_ident!("lanes_{number}"), Self::given_array(number), Self::made_array(number));
        let places = common.iter().enumerate().filter(|(_, value)| self.shared.contains(value));
        let shared = places.map(|(at, &value)| {
            let (at, value) = (index(at), local(value));
            quote!(let #value = shared[#at];)
        });
        let load = self.given.iter().enumerate().map(|(row, values)| {
            let (row, value) = (index(row), local(values[0]));
            quote!(let #value = given[#row][lane];)
        });
        let steps =
            self.steps.iter().filter_map(|values| emitter.statement(values[0], super::values::Place::Method));
        let results = self.made.iter().enumerate().map(|(row, &step)| {
            let (row, value) = (index(row), local(self.steps[step][0]));
            quote!(made[#row][lane] = #value;)
        });
        quote! {
            #[inline(never)]
            fn #name<T: #krate::Number>(
                shared: &[T; #common_count],
                given: &[[T; #width]; #given_rows],
                made: &mut [[T; #width]; #made_rows],
            ) {
                #(#shared)*
                for lane in 0..#width {
                    #(#load)*
                    #(#steps)*
                    #(#results)*
                }
            }
            // Initialised with ones: for zeros compilers call a function, which takes longer.
            let mut #made = [[T::one(); #width]; #made_rows];
            #name(&shared, &#given, &mut #made);
        }
    }
}

/// The values that loops share, in the order of their first use.
fn common(lanes: &[Lanes]) -> Vec<Value> {
    let mut seen = BTreeSet::new();
    lanes.iter().flat_map(|lanes| &lanes.shared).copied().filter(|&value| seen.insert(value)).collect()
}

/// The arrays that loops read.
pub fn storage(lanes: &[Lanes]) -> Storage {
    let mut storage = Storage::default();
    if !lanes.is_empty() {
        storage.list("shared", common(lanes));
    }
    for (number, lanes) in lanes.iter().enumerate() {
        storage.table(&Lanes::given_array(number), lanes.given.clone(), lanes.width());
    }
    storage
}

/// All loops.
pub fn loops(lanes: &[Lanes], emitter: &Emitter<'_>) -> TokenStream {
    let common = common(lanes);
    let loops = lanes.iter().enumerate().map(|(number, lanes)| lanes.statements(emitter, number, &common));
    quote!(#(#loops)*)
}
