//! Splits long routines into several functions, since compile time grows faster than the length of a
//! function.
//!
//! A part receives inputs of the routine and the arrays that earlier parts have written, and writes an array
//! of its own with the values that later parts or the result need, each as soon as it is computed. The
//! operations are the same as in one function, and so are the bits.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::groups::{Statement, grouped};
use super::storage::{ArrayEntry, Storage};
use super::values::{Place, local};
use hodograph_model::arithmetic::Function;
use hodograph_program::program::Program;
use hodograph_program::program::operation::{Operation, Stage, Value};

/// The approximate largest number of statements in a function of an emitted module. Values that pass from one
/// function to the next are stored and loaded.
const MAX_STATEMENTS: usize = 4400;
/// The same in modules whose contacts solve equations. Each `let` is a scope within that of the one before, and calls are
/// inlined into it: where line tables are written, the compiler descends into all of them, and ran out of its stack in
/// functions that are mostly such calls.
const MAX_STATEMENTS_OF_ITERATIONS: usize = 1500;

/// The approximate largest number of statements in a function of the module of a program.
pub fn longest(program: &Program) -> usize {
    let iterates = |operation: &Operation| matches!(operation, Operation::Call(Function::Frozen, _));
    if program.operations.iter().any(iterates) { MAX_STATEMENTS_OF_ITERATIONS } else { MAX_STATEMENTS }
}

/// The places of the values of earlier parts.
#[derive(Default)]
struct Earlier {
    places: BTreeMap<String, Slot>,
    /// values in the arrays of loops
    stored: BTreeSet<Value>,
    /// length of the array of each part
    lengths: Vec<usize>,
}

/// A place in an array.
#[derive(Clone)]
enum Slot {
    /// in the array of a part
    Part { part: usize, at: usize },
    /// in an array that loops read
    InArray(ArrayEntry),
}

impl Slot {
    fn tokens(&self) -> TokenStream {
        match self {
            Slot::Part { part, at } => {
                let (array, at) = (array(*part), Literal::usize_unsuffixed(*at));
                quote!(#array[#at])
            }
            Slot::InArray(entry) => entry.tokens(),
        }
    }
}

/// The array that a part writes.
fn array(part: usize) -> Ident {
    format_ident!("of_part_{part}")
}

impl Emitter<'_> {
    /// The statements that compute `values` in order and fill the arrays of loops; `wanted` are the values
    /// that are used afterwards.
    pub fn statements(&self, values: &[Value], wanted: &BTreeSet<Value>, storage: &Storage) -> TokenStream {
        let pairs = self.joint_pairs(values);
        let angles = self.angles(&pairs, values);
        let of_angles = self.sines_and_cosines(&pairs);
        let first: BTreeSet<Value> = pairs.iter().chain(&angles).copied().collect();
        let rest: Vec<Value> = values.iter().copied().filter(|value| !first.contains(value)).collect();
        let angles = angles.into_iter().filter_map(|value| self.statement(value, Place::Method));
        let (work, given): (Vec<Value>, Vec<Value>) = rest.iter().partition(|&&value| self.is_work(value));
        if rest.len() <= self.longest {
            let statements = rest.iter().filter_map(|&value| self.listed(value)).collect();
            // Values in the arrays of loops are used, too.
            let needed = wanted.iter().copied().chain(storage.values());
            let needed = needed.map(|value| local(value).to_string()).collect();
            let (statements, full) = (grouped(statements, &needed), storage.full());
            return quote! { #(#angles)* #of_angles #statements #full };
        }
        let given = given.into_iter().filter_map(|value| self.statement(value, Place::Method));
        let parts = self.parts(&work, rest.len().div_ceil(self.longest.max(1)));
        let wanted: BTreeSet<String> = wanted.iter().map(|&value| local(value).to_string()).collect();
        let mut earlier_parts = Earlier::default();
        let calls: Vec<TokenStream> = (0..parts.len())
            .map(|index| self.part(&parts, index, &wanted, storage, &mut earlier_parts))
            .collect();
        let looked_at = earlier_parts.places.iter().filter(|(name, _)| wanted.contains(*name));
        let looked_at = looked_at.map(|(name, place)| {
            let (name, place) = (format_ident!("{name}"), place.tokens());
            quote!(let #name = #place;)
        });
        let (empty, stores) = (storage.empty(), storage.stores(&earlier_parts.stored));
        quote! { #(#angles)* #of_angles #(#given)* #empty #(#calls)* #(#looked_at)* #stores }
    }

    /// Parts of about equal length, at least `least` of them. Each defines at most a sixth more variables
    /// than a function may, unless it is a single statement.
    fn parts<'v>(&self, work: &'v [Value], least: usize) -> Vec<&'v [Value]> {
        let most = self.longest + self.longest / 6;
        let variables = |part: &[Value]| {
            let operands = part.iter().flat_map(|&value| self.program.operation(value).operands());
            operands.chain(part.iter().copied()).collect::<BTreeSet<Value>>().len()
        };
        let mut count = least.max(1);
        loop {
            let length = work.len().div_ceil(count).max(1);
            let parts: Vec<&[Value]> = work.chunks(length).collect();
            if length == 1 || parts.iter().all(|part| variables(part) <= most) {
                return parts;
            }
            count += 1;
        }
    }

    /// Whether a method computes the value. Constants, inputs and values known at construction are only
    /// loaded.
    pub fn is_work(&self, value: Value) -> bool {
        self.stage(value) > Stage::Parameter && !matches!(self.program.operation(value), Operation::Input(_))
    }

    /// A part as a function, and its call.
    fn part(
        &self,
        parts: &[&[Value]],
        index: usize,
        wanted: &BTreeSet<String>,
        storage: &Storage,
        earlier_parts: &mut Earlier,
    ) -> TokenStream {
        let krate = self.krate;
        let part = parts[index];
        let made: BTreeSet<String> = part.iter().flat_map(|&value| self.makes(value)).collect();
        let used: BTreeSet<Value> =
            part.iter().flat_map(|&value| self.program.operation(value).operands()).collect();
        let numbers = used.iter().filter(|&&value| self.stage(value) == Stage::Constant);
        let numbers = numbers.filter_map(|&value| self.statement(value, Place::Method));
        let later: BTreeSet<String> = parts[index + 1..].iter().flat_map(|part| self.takes(part)).collect();
        let taken: BTreeSet<String> = self.takes(part).difference(&made).cloned().collect();
        let (earlier, outside): (Vec<String>, Vec<String>) =
            taken.into_iter().partition(|name| earlier_parts.places.contains_key(name));
        let mut places: BTreeMap<String, TokenStream> = BTreeMap::new();
        let mut arrays: BTreeSet<usize> = BTreeSet::new();
        let mut filled: BTreeSet<Ident> = BTreeSet::new();
        for name in earlier {
            if let Some(place) = earlier_parts.places.get(&name) {
                match place {
                    Slot::Part { part, .. } => drop(arrays.insert(*part)),
                    Slot::InArray(entry) => drop(filled.insert(entry.array.clone())),
                }
                places.insert(name, place.tokens());
            }
        }
        for (at, name) in outside.iter().enumerate() {
            let at = Literal::usize_unsuffixed(at);
            places.insert(name.clone(), quote!(taken[#at]));
        }
        let mut statements = Vec::new();
        let mut gives = 0;
        for &value in part {
            for name in self.takes(&[value]) {
                // A value is loaded before its first use: loaded at the start, it would not stay in a
                // register.
                if let Some(place) = places.remove(&name) {
                    let local = format_ident!("{name}");
                    let tokens = quote!(let #local = #place;);
                    statements.push(Statement { tokens, makes: vec![name], takes: BTreeSet::new() });
                }
            }
            statements.extend(self.listed(value));
            let store = |tokens, name| Statement { tokens, makes: vec![], takes: BTreeSet::from([name]) };
            if let [first, ..] = storage.of(value) {
                for entry in storage.of(value) {
                    statements.push(store(entry.store(value), local(value).to_string()));
                    filled.insert(entry.array.clone());
                }
                earlier_parts.stored.insert(value);
                earlier_parts.places.insert(local(value).to_string(), Slot::InArray(first.clone()));
                continue;
            }
            for name in self.makes(value) {
                if later.contains(&name) || wanted.contains(&name) {
                    let (at, name_) = (Literal::usize_unsuffixed(gives), format_ident!("{name}"));
                    statements.push(store(quote!(gives[#at] = #name_;), name.clone()));
                    earlier_parts.places.insert(name, Slot::Part { part: index, at: gives });
                    gives += 1;
                }
            }
        }
        earlier_parts.lengths.push(gives);
        let outside: Vec<_> = outside.iter().map(|name| format_ident!("{name}")).collect();
        let (takes, gives) = (Literal::usize_unsuffixed(outside.len()), Literal::usize_unsuffixed(gives));
        let earlier: Vec<_> = arrays.iter().map(|&part| array(part)).collect();
        let lengths = arrays.iter().map(|&part| Literal::usize_unsuffixed(earlier_parts.lengths[part]));
        let (name, own) = (format_ident!("part_{index}"), array(index));
        let shapes = filled.iter().map(|array| storage.shape(array));
        let shapes = filled.iter().zip(shapes).map(|(array, shape)| quote!(#array: &mut #shape,));
        let filled = filled.iter().map(|array| quote!(&mut #array,));
        let statements = grouped(statements, &BTreeSet::new());
        quote! {
            #[inline(never)]
            fn #name<T: #krate::Number>(taken: &[T; #takes], #(#earlier: &[T; #lengths],)* #(#shapes)* gives: &mut [T; #gives]) {
                #(#numbers)*
                #statements
            }
            // Initialised with ones: for zeros compilers call a function, which takes longer.
            let mut #own = [T::one(); #gives];
            #name(&[#(#outside),*], #(&#earlier,)* #(#filled)* &mut #own);
        }
    }

    /// The statement of a value for a list that may be grouped; `None` if it needs none.
    fn listed(&self, value: Value) -> Option<Statement> {
        let tokens = self.statement(value, Place::Method)?;
        let operation = self.program.operation(value);
        let cosine = matches!(operation, Operation::Cosine(_));
        let name = |operand| if cosine { format!("{}c", local(operand)) } else { local(operand).to_string() };
        Some(Statement { tokens, makes: self.makes(value), takes: operation.operands().map(name).collect() })
    }

    /// The variables that a statement defines.
    fn makes(&self, value: Value) -> Vec<String> {
        let name = local(value).to_string();
        match self.program.operation(value) {
            Operation::SinCos(_) => vec![format!("{name}c"), name],
            _ => vec![name],
        }
    }

    /// The variables that statements use, without constants.
    fn takes(&self, part: &[Value]) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        for &value in part {
            let operation = self.program.operation(value);
            for operand in operation.operands().filter(|&operand| self.stage(operand) > Stage::Constant) {
                let name = local(operand);
                let cosine = matches!(operation, Operation::Cosine(_));
                names.insert(if cosine { format!("{name}c") } else { name.to_string() });
            }
        }
        names
    }
}
