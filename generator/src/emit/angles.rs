//! Sines and cosines of several angles at once: vector instructions take little longer for eight than for one.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::Emitter;
use super::values::{Place, local};
use crate::program::operation::{Operation, Stage, Value};

impl Emitter<'_> {
    /// The sine-cosine pairs among `values` that are computed together, before all else: those of angles that no other sine or cosine
    /// enters. None where there is but one.
    pub fn together(&self, values: &[Value]) -> Vec<Value> {
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

    /// What these pairs are computed from, in the order of `values`.
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
        let mut left = pairs;
        let mut statements = quote!();
        while let Some((lanes, taken)) = lanes(left.len()) {
            let (group, rest) = left.split_at(taken);
            left = rest;
            if let [pair] = *group {
                statements.extend(self.statement(pair, Place::Method));
                continue;
            }
            // The last angle fills the lanes that are left over.
            let filled = (0..lanes).map(|lane| group[lane.min(taken - 1)]);
            let angles = filled.flat_map(|pair| self.program.operation(pair).operands()).map(local);
            let sines = group.iter().map(|&pair| local(pair));
            let cosines = group.iter().map(|&pair| format_ident!("{}c", local(pair)));
            let rest = (lanes > taken).then(|| quote!(..));
            statements.extend(quote! {
                let ([#(#sines,)* #rest], [#(#cosines,)* #rest]) = #krate::generated::sines_cosines([#(#angles),*]);
            });
        }
        statements
    }
}

/// How many lanes the first group of so many angles takes, and how many of the angles. Loops of 2, 4 and 8 cost about as much as 1.3, 1.9 and
/// 2.9 angles one by one.
fn lanes(angles: usize) -> Option<(usize, usize)> {
    match angles {
        0 => None,
        1 => Some((1, 1)),
        2 => Some((2, 2)),
        3..=5 => Some((4, angles.min(4))),
        _ => Some((8, angles.min(8))),
    }
}

#[cfg(test)]
mod tests {
    use super::lanes;

    #[test]
    fn all_angles_are_taken() {
        for count in 0..100 {
            let (mut left, mut groups) = (count, 0);
            while let Some((lanes, taken)) = lanes(left) {
                assert!((1..=lanes).contains(&taken) && taken <= left, "{count}");
                (left, groups) = (left - taken, groups + 1);
            }
            assert_eq!(left, 0);
            assert!(groups <= count / 8 + 2, "{count}: {groups}");
        }
    }
}
