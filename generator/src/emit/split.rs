//! Splits long routines into several functions, since the time to compile a function grows faster than its length.
//!
//! A part receives values of earlier parts and inputs of the routine, and returns the values that later parts or the result need. The operations are the
//! same as in one function, and so are the bits.

use std::collections::BTreeSet;

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::values::{Place, local};
use crate::program::operation::{Operation, Stage, Value};

/// The greatest number of statements in one function of an emitted module, roughly. In builds with debug information each opens a scope within the
/// one before, and the compiler descends into them: at 4100 its stack overflows.
pub const LONGEST: usize = 3000;

impl Emitter<'_> {
    /// The statements that compute `values`, in their order; `wanted` are those that are looked at afterwards.
    pub fn statements(&self, values: &[Value], wanted: &BTreeSet<Value>) -> TokenStream {
        let pairs = self.together(values);
        let angles = self.angles(&pairs, values);
        let of_angles = self.sines_and_cosines(&pairs);
        let first: BTreeSet<Value> = pairs.iter().chain(&angles).copied().collect();
        let rest: Vec<Value> = values.iter().copied().filter(|value| !first.contains(value)).collect();
        let angles = angles.into_iter().filter_map(|value| self.statement(value, Place::Method));
        let (work, given): (Vec<Value>, Vec<Value>) = rest.iter().partition(|&&value| self.is_work(value));
        if rest.len() <= self.longest {
            let statements = rest.iter().filter_map(|&value| self.statement(value, Place::Method));
            return quote! { #(#angles)* #of_angles #(#statements)* };
        }
        let given = given.into_iter().filter_map(|value| self.statement(value, Place::Method));
        let length = work.len().div_ceil(rest.len().div_ceil(self.longest.max(1))).max(1);
        let parts: Vec<&[Value]> = work.chunks(length).collect();
        let wanted: BTreeSet<String> = wanted.iter().map(|&value| local(value).to_string()).collect();
        let calls = (0..parts.len()).map(|index| self.part(&parts, index, &wanted));
        quote! { #(#angles)* #of_angles #(#given)* #(#calls)* }
    }

    /// Whether it is computed in a method. Numbers, inputs and what is known at construction are only fetched.
    pub fn is_work(&self, value: Value) -> bool {
        self.stage(value) > Stage::Parameter && !matches!(self.program.operation(value), Operation::Input(_))
    }

    /// A part as a function, and its call.
    fn part(&self, parts: &[&[Value]], index: usize, wanted: &BTreeSet<String>) -> TokenStream {
        let krate = self.krate;
        let part = parts[index];
        let made: BTreeSet<String> = part.iter().flat_map(|&value| self.makes(value)).collect();
        let used: BTreeSet<Value> =
            part.iter().flat_map(|&value| self.program.operation(value).operands()).collect();
        let numbers = used.iter().filter(|&&value| self.stage(value) == Stage::Constant);
        let numbers = numbers.filter_map(|&value| self.statement(value, Place::Method));
        let taken = self.takes(part);
        let taken: Vec<_> = taken.difference(&made).map(|name| format_ident!("{name}")).collect();
        let later: BTreeSet<String> = parts[index + 1..].iter().flat_map(|part| self.takes(part)).collect();
        let given = made.iter().filter(|name| later.contains(*name) || wanted.contains(*name));
        let given: Vec<_> = given.map(|name| format_ident!("{name}")).collect();
        let (takes, gives) = (Literal::usize_unsuffixed(taken.len()), Literal::usize_unsuffixed(given.len()));
        let statements = part.iter().filter_map(|&value| self.statement(value, Place::Method));
        let name = format_ident!("part_{index}");
        quote! {
            #[inline(never)]
            fn #name<T: #krate::Scalar>(taken: &[T; #takes]) -> [T; #gives] {
                let [#(#taken),*] = *taken;
                #(#numbers)*
                #(#statements)*
                [#(#given),*]
            }
            let [#(#given),*] = #name(&[#(#taken),*]);
        }
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
