//! The linearised equations: x' = A x + B w about a state, a column at a time from the program's directional derivative.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use crate::program::Quantity;

impl Emitter<'_> {
    /// Number of states and of named inputs.
    fn linear_sizes(&self) -> (usize, usize) {
        (self.mechanism.independent_states(), self.mechanism.inputs.len())
    }

    /// The type of a direction: states, then inputs.
    pub fn tangent_argument(&self) -> TokenStream {
        let (states, inputs) = self.linear_sizes();
        let size = Literal::usize_unsuffixed(states + inputs);
        quote!(tangent: &[T; #size],)
    }

    /// The record of the two matrices; nothing where the program has no directional derivative.
    pub fn linearisation_record(&self) -> TokenStream {
        if self.program.output(Quantity::StateTangent).is_none() {
            return quote!();
        }
        let krate = self.krate;
        let (states, inputs) = self.linear_sizes();
        let (n, m) = (Literal::usize_unsuffixed(states), Literal::usize_unsuffixed(inputs));
        let names = |dependent: bool| {
            let all = self.mechanism.coordinates.iter().chain(&self.mechanism.speeds);
            let names: Vec<_> =
                all.filter(|q| q.dependent == dependent).map(|q| format!("`{}`", q.name)).collect();
            names.join(", ")
        };
        let docs = format!(
            " Equations linearised about a state: x' = A x + B w for small deviations of the states {} (in this order){}.",
            names(false),
            if inputs == 0 { "" } else { " and of the named inputs w" },
        );
        quote! {
            #[doc = #docs]
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct Linearisation<T> {
                /// A: rates of the states (rows) per state (columns)
                pub a: #krate::nalgebra::SMatrix<T, #n, #n>,
                /// B: rates of the states (rows) per named input (columns)
                pub b: #krate::nalgebra::SMatrix<T, #n, #m>,
            }
        }
    }

    /// The method `linearise`; nothing where the program has no directional derivative.
    pub fn linearise(&self) -> TokenStream {
        if self.program.output(Quantity::StateTangent).is_none() {
            return quote!();
        }
        let krate = self.krate;
        let (states, inputs) = self.linear_sizes();
        let size = Literal::usize_unsuffixed(states + inputs);
        let (n, m) = (Literal::usize_unsuffixed(states), Literal::usize_unsuffixed(inputs));
        let mut arguments = self.arguments(&[Quantity::StateTangent]);
        arguments.tangent = false;
        let signature = self.signature(arguments);
        let passed = self.passed(arguments);
        quote! {
            /// The equations linearised about a state, exactly (by differentiation, not by differences). Dependent
            /// coordinates and speeds follow the independent ones; parameters and time are held.
            pub fn linearise(#signature) -> ::core::result::Result<Linearisation<T>, #krate::StateError> {
                let mut a = #krate::nalgebra::SMatrix::<T, #n, #n>::zeros();
                let mut b = #krate::nalgebra::SMatrix::<T, #n, #m>::zeros();
                for (number, mut column) in a.column_iter_mut().chain(b.column_iter_mut()).enumerate() {
                    let mut tangent = [T::zero(); #size];
                    if let Some(entry) = tangent.get_mut(number) {
                        *entry = T::one();
                    }
                    column.copy_from(&self.state_tangent(#passed &tangent)?);
                }
                ::core::result::Result::Ok(Linearisation { a, b })
            }
        }
    }
}
