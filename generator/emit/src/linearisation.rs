//! Emits the derivatives of accelerations and inverse dynamics as matrices, and the linearised equations x' =
//! A x + B w formed from them.

use std::ops::Range;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use super::routine::Arguments;
use super::values::local;
use hodograph_program::program::{Output, Quantity};

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
            #[must_use]
            #[non_exhaustive]
            pub struct Linearisation<T> {
                /// A: derivatives of the rates of the states (rows) with respect to the states (columns)
                pub a: #krate::nalgebra::SMatrix<T, #n, #n>,
                /// B: derivatives of the rates of the states (rows) with respect to the named inputs (columns)
                pub b: #krate::nalgebra::SMatrix<T, #n, #m>,
            }
        }
    }

    /// The record of a value and its derivatives; nothing where the program has none.
    pub fn derivatives_record(&self) -> TokenStream {
        let of = [Quantity::AccelerationsDerivatives, Quantity::InverseDynamicsDerivatives];
        if of.iter().all(|&quantity| self.program.output(quantity).is_none()) {
            return quote!();
        }
        let krate = self.krate;
        let [rows, coordinates, inputs] = [
            self.speeds.len(),
            self.mechanism.independent_states() - self.speeds.len(),
            self.mechanism.inputs.len(),
        ]
        .map(Literal::usize_unsuffixed);
        quote! {
            /// Accelerations or generalized forces with their derivatives. Rows: independent speeds.
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct Derivatives<T> {
                /// the quantity itself
                pub value: #krate::nalgebra::SVector<T, #rows>,
                /// derivatives with respect to the independent coordinates (columns, in their order)
                pub by_coordinates: #krate::nalgebra::SMatrix<T, #rows, #coordinates>,
                /// derivatives with respect to the independent speeds (columns, in their order)
                pub by_speeds: #krate::nalgebra::SMatrix<T, #rows, #rows>,
                /// derivatives with respect to the named inputs (columns, in their order)
                pub by_inputs: #krate::nalgebra::SMatrix<T, #rows, #inputs>,
            }
        }
    }

    /// The type and the expression of a value with its derivatives.
    pub fn value_and_derivatives(&self, output: &Output) -> (TokenStream, TokenStream) {
        let (states, inputs) = self.linear_sizes();
        let coordinates = 1 + states - self.speeds.len();
        let [(_, value), (_, by_coordinates), (_, by_speeds), (_, by_inputs)] =
            [0..1, 1..coordinates, coordinates..1 + states, 1 + states..1 + states + inputs]
                .map(|columns| self.block(output, columns));
        let fields = quote! {
            value: #value, by_coordinates: #by_coordinates, by_speeds: #by_speeds, by_inputs: #by_inputs
        };
        (quote!(Derivatives<T>), quote!(Derivatives { #fields }))
    }

    /// The method `linearise`; nothing where the program has no directional derivative.
    pub fn linearise(&self) -> TokenStream {
        if self.program.output(Quantity::StateTangent).is_none() {
            return quote!();
        }
        let krate = self.krate;
        let mut arguments = self.arguments(&[Quantity::StateTangent]);
        arguments.tangent = false;
        let signature = self.signature(arguments);
        let body = match self.program.output(Quantity::AccelerationsDerivatives) {
            Some(_) => self.by_derivatives(arguments),
            None => self.by_tangents(arguments),
        };
        quote! {
            /// The equations linearised about a state, by exact differentiation. Dependent coordinates and speeds follow the independent ones; parameters
            /// and time are constant.
            pub fn linearise(#signature) -> ::core::result::Result<Linearisation<T>, #krate::StateError> {
                #body
                ::core::result::Result::Ok(Linearisation { a, b })
            }
        }
    }

    /// Rows of coordinates from the derivatives of their rates, rows of speeds from those of the
    /// accelerations.
    fn by_derivatives(&self, arguments: Arguments) -> TokenStream {
        let krate = self.krate;
        let (states, inputs) = self.linear_sizes();
        let coordinates = states - self.speeds.len();
        let passed = self.passed(arguments);
        let rates = self.program.output(Quantity::RatesDerivatives);
        let compute = rates.map(|_| self.compute(&[Quantity::RatesDerivatives]));
        let entry = |row: usize, column: usize| {
            let Some(row) = row.checked_sub(coordinates).map(Literal::usize_unsuffixed) else {
                let value = rates.and_then(|output| output.values.get(row * output.columns + column));
                let value = value.map(|&value| local(value));
                return quote!(#value);
            };
            let (block, first) = match column {
                column if column < coordinates => (quote!(by_coordinates), 0),
                column if column < states => (quote!(by_speeds), coordinates),
                _ => (quote!(by_inputs), states),
            };
            let column = Literal::usize_unsuffixed(column - first);
            quote!(#block[#column][#row])
        };
        let matrix = |columns: Range<usize>| {
            if columns.is_empty() {
                return quote!(#krate::nalgebra::SMatrix::zeros());
            }
            let columns = columns.map(|column| {
                let entries = (0..states).map(|row| entry(row, column));
                quote!([#(#entries),*])
            });
            quote!(#krate::nalgebra::SMatrix::from([#(#columns),*]))
        };
        let (a, b) = (matrix(0..states), matrix(states..states + inputs));
        quote! {
            #compute
            let of_speeds = self.accelerations_derivatives(#passed)?;
            let (by_coordinates, by_speeds, by_inputs) =
                (&of_speeds.by_coordinates.data.0, &of_speeds.by_speeds.data.0, &of_speeds.by_inputs.data.0);
            let (a, b) = (#a, #b);
        }
    }

    /// A column at a time: where all derivatives at once would be too long a program.
    fn by_tangents(&self, arguments: Arguments) -> TokenStream {
        let krate = self.krate;
        let (states, inputs) = self.linear_sizes();
        let (n, m) = (Literal::usize_unsuffixed(states), Literal::usize_unsuffixed(inputs));
        let size = Literal::usize_unsuffixed(states + inputs);
        let passed = self.passed(arguments);
        quote! {
            let mut a = #krate::nalgebra::SMatrix::<T, #n, #n>::zeros();
            let mut b = #krate::nalgebra::SMatrix::<T, #n, #m>::zeros();
            for (number, mut column) in a.column_iter_mut().chain(b.column_iter_mut()).enumerate() {
                let mut tangent = [T::zero(); #size];
                if let Some(entry) = tangent.get_mut(number) {
                    *entry = T::one();
                }
                column.copy_from(&self.state_tangent(#passed &tangent)?);
            }
        }
    }
}
