//! Emits the check that results are finite.
//!
//! A sum, difference or product with an operand that is not finite is not finite either, nor is a quotient
//! with such a dividend. A result that enters another result through such operations alone needs no check of
//! its own: for example, the rate of a joint enters the rates of all joints that it carries.

use std::collections::BTreeSet;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use super::lanes::Lanes;
use super::values::local;
use hodograph_program::program::operation::{Operation, Stage, Value};

impl Emitter<'_> {
    /// The expression for whether a result, including those of loops, is not finite; `None` if all results
    /// are constants.
    pub fn not_finite(&self, results: &BTreeSet<Value>, lanes: &[Lanes]) -> Option<TokenStream> {
        let krate = self.krate;
        let ends = self.ends(results);
        let made: BTreeSet<Value> = lanes.iter().flat_map(Lanes::results).collect();
        let single: Vec<_> = ends.difference(&made).copied().map(local).collect();
        let single = (!single.is_empty()).then(|| quote!(#krate::generated::all_finite([#(#single),*])));
        let rows = lanes.iter().zip(0..).flat_map(|(lanes, number)| {
            let made = Lanes::made_array(number);
            let rows = lanes.rows_with(&ends);
            if 2 * rows.len() > lanes.made_rows() {
                return vec![quote!(#krate::generated::all_rows_finite(&#made))];
            }
            let rows = rows.into_iter().map(|row| {
                let row = Literal::usize_unsuffixed(row);
                quote!(#krate::generated::all_rows_finite(::core::array::from_ref(&#made[#row])))
            });
            rows.collect()
        });
        let checks: Vec<TokenStream> = single.into_iter().chain(rows).collect();
        match &checks[..] {
            [] => None,
            [check] => Some(quote!(!#check)),
            _ => Some(quote!(!(#(#checks)&&*))),
        }
    }

    /// The results that are finite only if all results are.
    fn ends(&self, results: &BTreeSet<Value>) -> BTreeSet<Value> {
        let mut ends = BTreeSet::new();
        // Operands are earlier values, so everything that a result enters has been visited before it.
        let mut entered: BTreeSet<Value> = BTreeSet::new();
        for &result in results.iter().rev().filter(|&&value| self.stage(value) > Stage::Parameter) {
            if entered.contains(&result) {
                continue;
            }
            ends.insert(result);
            let mut stack = vec![result];
            while let Some(value) = stack.pop() {
                stack.extend(
                    operands_that_must_be_finite(self.program.operation(value))
                        .filter(|&operand| entered.insert(operand)),
                );
            }
        }
        ends
    }
}

/// The operands that must be finite for the value to be finite.
fn operands_that_must_be_finite(operation: Operation) -> impl Iterator<Item = Value> {
    use Operation::*;
    let known = match operation {
        // An infinite divisor gives zero; functions may have limits.
        Recip(_) | Call(..) | Call2(..) => 0,
        Div(..) => 1,
        Constant(_) | Input(_) | Neg(_) | Add(..) | Sub(..) | Mul(..) | MulAdd(..) | MulSub(..)
        | NegMulAdd(..) | SinCos(_) | Sine(_) | Cosine(_) => 3,
    };
    operation.operands().take(known)
}
