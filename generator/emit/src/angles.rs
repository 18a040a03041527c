//! Emits the computation of several sines and cosines at once: with vector instructions eight take little
//! longer than one.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::Emitter;
use super::values::{Place, local};
use hodograph_program::program::operation::{Operation, Stage, Value};

/// The largest number of angles in one call of the runtime.
const MAX_ANGLES: usize = 8;

impl Emitter<'_> {
    /// The sine-cosine pairs among `values` that are computed joint_pairs, before all else: those whose angles
    /// contain no sine or cosine. Empty if there is only one.
    pub fn joint_pairs(&self, values: &[Value]) -> Vec<Value> {
        let mut late: BTreeSet<Value> = BTreeSet::new();
        let mut pairs = Vec::new();
        for &value in values.iter().filter(|&&value| self.stage(value) > Stage::Parameter) {
            let operation = self.program.operation(value);
            let waits = operation.operands().any(|operand| late.contains(&operand));
            match operation {
                Operation::SinCos(_) if !waits => {
                    pairs.push(value);
                    late.insert(value);
                }
                Operation::Call(..) | Operation::Call2(..) | Operation::SinCos(_) => {
                    late.insert(value);
                }
                _ if waits => {
                    late.insert(value);
                }
                _ => {}
            }
        }
        if pairs.len() > 1 { pairs } else { Vec::new() }
    }

    /// The values from which these pairs are computed, in the order of `values`.
    pub fn angles(&self, pairs: &[Value], values: &[Value]) -> Vec<Value> {
        let mut needed = BTreeSet::new();
        let mut stack: Vec<Value> =
            pairs.iter().flat_map(|&pair| self.program.operation(pair).operands()).collect();
        while let Some(value) = stack.pop() {
            if needed.insert(value) && self.stage(value) > Stage::Parameter {
                stack.extend(self.program.operation(value).operands());
            }
        }
        values.iter().copied().filter(|value| needed.contains(value)).collect()
    }

    /// The statements that compute these pairs.
    pub fn sines_and_cosines(&self, pairs: &[Value]) -> TokenStream {
        let krate = self.krate;
        let function = if self.inlined { quote!(sines_cosines_inlined) } else { quote!(sines_cosines) };
        let groups = pairs.chunks(MAX_ANGLES).map(|group| {
            if let [pair] = *group {
                return self.statement(pair, Place::Method).unwrap_or_default();
            }
            let angles = group.iter().flat_map(|&pair| self.program.operation(pair).operands()).map(local);
            let sines = group.iter().map(|&pair| local(pair));
            let cosines = group.iter().map(|&pair| format_ident!("{}c", local(pair)));
            quote! {
                let ([#(#sines),*], [#(#cosines),*]) = #krate::generated::#function([#(#angles),*]);
            }
        });
        groups.collect()
    }
}
