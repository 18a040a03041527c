//! Quantities of the whole mechanism for the trait `Mechanism`: equations of motion, energies, configuration
//! equations, and the quantities that are offered by name.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::slice_of;
use crate::Emitter;
use crate::identifiers::ident;
use hodograph_program::program::Quantity;
use hodograph_program::program::quantity::{Entries, Offer, table::WHOLE};

impl Emitter<'_> {
    pub(super) fn quantities_by_slices(&self) -> Vec<TokenStream> {
        let methods = WHOLE.iter().filter_map(|&(quantity, row)| match row.offer {
            Offer::Written => Some(self.by_slice(quantity)),
            Offer::Answered if row.entries == Entries::Scalar => Some(self.by_number_alone(quantity)),
            Offer::Answered | Offer::Named | Offer::No => None,
        });
        methods.collect()
    }

    /// The method that writes a quantity into a slice.
    fn by_slice(&self, quantity: Quantity) -> TokenStream {
        let krate = self.krate;
        let (method, slice) = (ident(quantity.description().word), slice_of(quantity));
        let body = self.written(quantity);
        let takes = quantity.description().takes;
        let given = takes.accelerations.then(|| self.given_accelerations());
        let accelerations = takes.accelerations.then(|| quote!(accelerations: &[T],));
        quote! {
            fn #method(
                &self,
                state: &#krate::State<'_, T>,
                #accelerations
                #slice: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #given
                #body
            }
        }
    }

    /// The method that returns an energy. Every mechanism has kinetic energy, but some lack potential energy.
    fn by_number_alone(&self, quantity: Quantity) -> TokenStream {
        let krate = self.krate;
        let method = ident(quantity.description().word);
        let always = quantity == Quantity::KineticEnergy;
        let result = if always { quote!(T) } else { quote!(::core::option::Option<T>) };
        let body = match self.program.output(quantity).filter(|output| !output.values.is_empty()) {
            Some(_) => {
                let (unpack, call) = self.own(quantity);
                match always {
                    true => quote!(#unpack #call),
                    false => {
                        quote!(#unpack ::core::result::Result::map(#call, ::core::option::Option::Some))
                    }
                }
            }
            None => {
                let none = if always { quote!(T::zero()) } else { quote!(::core::option::Option::None) };
                quote! {
                    DESCRIPTION.check(state)?;
                    ::core::result::Result::Ok(#none)
                }
            }
        };
        quote! {
            fn #method(
                &self,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#result, #krate::StateError> {
                #body
            }
        }
    }

    pub(super) fn configuration_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let residual = self.written(Quantity::ConfigurationResidual);
        let jacobian = self.written(Quantity::ConfigurationJacobian);
        quote! {
            fn configuration(
                &self,
                state: &#krate::State<'_, T>,
                residual: &mut [T],
                jacobian: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                { #residual }?;
                #jacobian
            }
        }
    }

    /// The quantities that this mechanism has and that are offered by name.
    pub(super) fn named_quantities(&self) -> Vec<Quantity> {
        let has = |quantity: &Quantity| {
            self.program.output(*quantity).is_some_and(|output| !output.values.is_empty())
        };
        Quantity::named().filter(has).collect()
    }

    /// The method for the quantities that are offered by name; without any, the default of the trait is used.
    pub(super) fn named_by_slices(&self) -> Option<TokenStream> {
        let krate = self.krate;
        let named = self.named_quantities();
        if named.is_empty() {
            return None;
        }
        let values = ident("values");
        let arms =
            named.iter().map(|&quantity| self.written_to(quantity, &values, quantity.description().word));
        let body = self.by_number("quantity", "Quantity", arms.enumerate().collect());
        let shapes = named.iter().filter_map(|&quantity| self.program.output(quantity));
        let shapes = shapes.map(|output| {
            let [rows, columns] = [output.rows, output.columns].map(Literal::usize_unsuffixed);
            quote!((#rows, #columns))
        });
        Some(quote! {
            fn quantity_shape(&self, quantity: usize) -> ::core::option::Option<(usize, usize)> {
                [#(#shapes),*].get(quantity).copied()
            }
            fn quantity(
                &self,
                quantity: usize,
                state: &#krate::State<'_, T>,
                values: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #body
            }
        })
    }
}
