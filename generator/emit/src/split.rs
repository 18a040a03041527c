//! Splits long routines into several functions, since the time to compile a function grows faster than its
//! length.
//!
//! A part receives inputs of the routine and the arrays that earlier parts have written, and writes an array
//! of its own: the values that later parts or the result need, each as soon as it is there. The operations
//! are the same as in one function, and so are the bits.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::groups::{Statement, grouped};
use super::storage::{ArrayEntry, Storage};
use super::values::{Place, local};
use hodograph_program::program::operation::{Operation, Stage, Value};

/// The greatest number of statements in one function of an emitted module, roughly. What passes from one
/// function to the next is stored and loaded.
pub const LONGEST: usize = 4400;

/// Where the values of earlier parts are.
#[derive(Default)]
struct Gone {
    places: BTreeMap<String, Slot>,
    /// values in the arrays of loops
    stored: BTreeSet<Value>,
    /// length of the array of each part
    lengths: Vec<usize>,
}

/// A place in an array.
#[derive(Clone)]
enum Slot {
    /// in that of a part
    Part { part: usize, at: usize },
    /// in one that loops read
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
    /// The statements that compute `values`, in their order, and fill the arrays of loops; `wanted` are those
    /// that are looked at afterwards.
    pub fn statements(&self, values: &[Value], wanted: &BTreeSet<Value>, storage: &Storage) -> TokenStream {
        let pairs = self.together(values);
        let angles = self.angles(&pairs, values);
        let of_angles = self.sines_and_cosines(&pairs);
        let first: BTreeSet<Value> = pairs.iter().chain(&angles).copied().collect();
        let rest: Vec<Value> = values.iter().copied().filter(|value| !first.contains(value)).collect();
        let angles = angles.into_iter().filter_map(|value| self.statement(value, Place::Method));
        let (work, given): (Vec<Value>, Vec<Value>) = rest.iter().partition(|&&value| self.is_work(value));
        if rest.len() <= self.longest {
            let statements = rest.iter().filter_map(|&value| self.listed(value)).collect();
            // The arrays of loops need what is in them.
            let needed = wanted.iter().copied().chain(storage.values());
            let needed = needed.map(|value| local(value).to_string()).collect();
            let (statements, full) = (grouped(statements, &needed), storage.full());
            return quote! { #(#angles)* #of_angles #statements #full };
        }
        let given = given.into_iter().filter_map(|value| self.statement(value, Place::Method));
        let parts = self.parts(&work, rest.len().div_ceil(self.longest.max(1)));
        let wanted: BTreeSet<String> = wanted.iter().map(|&value| local(value).to_string()).collect();
        let mut gone = Gone::default();
        let calls: Vec<TokenStream> =
            (0..parts.len()).map(|index| self.part(&parts, index, &wanted, storage, &mut gone)).collect();
        let looked_at = gone.places.iter().filter(|(name, _)| wanted.contains(*name));
        let looked_at = looked_at.map(|(name, place)| {
            let (name, place) = (format_ident!("{name}"), place.tokens());
            quote!(let #name = #place;)
        });
        let (empty, stores) = (storage.empty(), storage.stores(&gone.stored));
        quote! { #(#angles)* #of_angles #(#given)* #empty #(#calls)* #(#looked_at)* #stores }
    }

    /// Parts of about equal length, at least so many. None makes more variables than a function may, but for
    /// a sixth more, unless it is one statement.
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

    /// Whether it is computed in a method. Numbers, inputs and what is known at construction are only
    /// fetched.
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
        gone: &mut Gone,
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
            taken.into_iter().partition(|name| gone.places.contains_key(name));
        let mut places: BTreeMap<String, TokenStream> = BTreeMap::new();
        let mut arrays: BTreeSet<usize> = BTreeSet::new();
        let mut filled: BTreeSet<Ident> = BTreeSet::new();
        for name in earlier {
            if let Some(place) = gone.places.get(&name) {
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
                // A value is fetched where it is needed first: all at the start would not stay in registers.
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
                gone.stored.insert(value);
                gone.places.insert(local(value).to_string(), Slot::InArray(first.clone()));
                continue;
            }
            for name in self.makes(value) {
                if later.contains(&name) || wanted.contains(&name) {
                    let (at, name_) = (Literal::usize_unsuffixed(gives), format_ident!("{name}"));
                    statements.push(store(quote!(gives[#at] = #name_;), name.clone()));
                    gone.places.insert(name, Slot::Part { part: index, at: gives });
                    gives += 1;
                }
            }
        }
        gone.lengths.push(gives);
        let outside: Vec<_> = outside.iter().map(|name| format_ident!("{name}")).collect();
        let (takes, gives) = (Literal::usize_unsuffixed(outside.len()), Literal::usize_unsuffixed(gives));
        let earlier: Vec<_> = arrays.iter().map(|&part| array(part)).collect();
        let lengths = arrays.iter().map(|&part| Literal::usize_unsuffixed(gone.lengths[part]));
        let (name, own) = (format_ident!("part_{index}"), array(index));
        let shapes = filled.iter().map(|array| storage.shape(array));
        let shapes = filled.iter().zip(shapes).map(|(array, shape)| quote!(#array: &mut #shape,));
        let filled = filled.iter().map(|array| quote!(&mut #array,));
        let statements = grouped(statements, &BTreeSet::new());
        quote! {
            #[inline(never)]
            fn #name<T: #krate::Scalar>(taken: &[T; #takes], #(#earlier: &[T; #lengths],)* #(#shapes)* gives: &mut [T; #gives]) {
                #(#numbers)*
                #statements
            }
            // Ones, since compilers call a function to fill a long array with zeros, and that takes longer.
            let mut #own = [T::one(); #gives];
            #name(&[#(#outside),*], #(&#earlier,)* #(#filled)* &mut #own);
        }
    }

    /// The statement of a value for a list that may be grouped; `None` where it needs none.
    fn listed(&self, value: Value) -> Option<Statement> {
        let tokens = self.statement(value, Place::Method)?;
        let operation = self.program.operation(value);
        let cosine = matches!(operation, Operation::Cosine(_));
        let name = |operand| if cosine { format!("{}c", local(operand)) } else { local(operand).to_string() };
        Some(Statement { tokens, makes: self.makes(value), takes: operation.operands().map(name).collect() })
    }

    /// The variables that a statement makes.
    fn makes(&self, value: Value) -> Vec<String> {
        let name = local(value).to_string();
        match self.program.operation(value) {
            Operation::SinCos(_) => vec![format!("{name}c"), name],
            _ => vec![name],
        }
    }

    /// The variables that statements use, but for numbers.
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
