//! Emits the type of the mechanism, which holds the parameters and all values that depend on them only, and
//! its constructor.

use std::collections::BTreeSet;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use super::values::{Place, local};
use hodograph_program::program::operation::{Stage, Value};

impl Emitter<'_> {
    /// The type, its constructor and its defaults.
    pub fn mechanism_type(&self) -> TokenStream {
        let (krate, name) = (self.krate, &self.name);
        let count = Literal::usize_unsuffixed(self.hoisted.len());
        let docs = format!(" The mechanism `{}` with its parameters.", self.mechanism.name);
        let has_parameters = !self.parameters.is_empty();
        let field = has_parameters.then(|| quote!(parameters: Parameters<T>,));
        let argument = has_parameters.then(|| quote!(parameters: Parameters<T>));
        let by_reference = has_parameters.then(|| quote!(parameters: &Parameters<T>));
        let borrowed = has_parameters.then(|| quote!(&parameters));
        let keep = has_parameters.then(|| quote!(parameters,));
        let hoist = self.hoist();
        let check = self.check();
        let accessors = has_parameters.then(|| {
            quote! {
                /// The parameters.
                #[inline]
                pub fn parameters(&self) -> &Parameters<T> {
                    &self.parameters
                }

                /// Changes the parameters and recomputes the values that depend on them only.
                ///
                /// # Errors
                ///
                /// Those of [`Self::new`]; the mechanism is then unchanged.
                #[inline]
                pub fn set_parameters(
                    &mut self,
                    parameters: Parameters<T>,
                ) -> ::core::result::Result<(), #krate::ParameterError> {
                    *self = Self::new(parameters)?;
                    ::core::result::Result::Ok(())
                }
            }
        });
        let default = self.has_defaults().then(|| {
            let parameters = has_parameters
                .then(|| quote!(let parameters = <Parameters<T> as ::core::default::Default>::default();));
            quote! {
                /// The mechanism with the parameters that the model gives.
                impl<T: #krate::Scalar> ::core::default::Default for #name<T> {
                    #[inline]
                    fn default() -> Self {
                        #parameters
                        let hoisted = Self::hoist(#borrowed);
                        Self { #keep hoisted }
                    }
                }
            }
        });
        let constant = self.constant();
        let kept = has_parameters.then(|| quote!(parameters));
        quote! {
            #[doc = #docs]
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct #name<T = f64> {
                #field
                /// what depends on parameters alone
                hoisted: [T; #count],
            }

            impl<T: #krate::Scalar> #name<T> {
                /// The mechanism with these parameters. Values that depend on them only are computed here, once.
                ///
                /// # Errors
                ///
                /// A parameter is not finite, a mass or a dimension of a shape is not positive, no body can have an inertia, or a divisor is zero.
                pub fn new(#argument) -> ::core::result::Result<Self, #krate::ParameterError> {
                    Self::check(#borrowed)?;
                    let hoisted = Self::hoist(#borrowed);
                    if !#krate::generated::all_finite(hoisted) {
                        return ::core::result::Result::Err(#krate::StateError::NotFinite.into());
                    }
                    ::core::result::Result::Ok(Self { #keep hoisted })
                }

                #accessors

                fn hoist(#by_reference) -> [T; #count] {
                    #hoist
                }

                fn check(#by_reference) -> ::core::result::Result<(), #krate::ParameterError> {
                    #check
                }
            }

            #default
            #constant
            #krate::generated::in_lanes! { #name #kept }
        }
    }

    /// The mechanism as a constant, if no value is left to compute at run time.
    fn constant(&self) -> Option<TokenStream> {
        let name = &self.name;
        let known = self.parameters.is_empty() && self.hoisted.is_empty();
        known.then(|| {
            quote! {
                impl<T> #name<T> {
                    /// The mechanism: all parameters are fixed, so that it can stand in a constant or a `static`.
                    pub const MODEL: Self = Self { hoisted: [] };
                }
            }
        })
    }

    /// Whether all run-time parameters have a value in the model.
    fn has_defaults(&self) -> bool {
        self.mechanism.parameters.iter().all(|parameter| parameter.fixed || parameter.value.is_some())
    }

    fn hoist(&self) -> TokenStream {
        let krate = self.krate;
        let statements = self.at_construction(&self.hoisted);
        let values = self.hoisted.iter().map(|&value| local(value));
        quote! { #statements [#(#krate::generated::construction::rounded(#values)),*] }
    }

    /// Statements that compute the values that depend on parameters alone, in double-double arithmetic: they
    /// enter all results and are rounded only once.
    fn at_construction(&self, values: &[Value]) -> TokenStream {
        let mut needed = BTreeSet::new();
        let mut stack = values.to_vec();
        while let Some(value) = stack.pop() {
            if needed.insert(value) {
                stack.extend(self.program.operation(value).operands());
            }
        }
        let statements = needed.into_iter().filter_map(|value| self.statement(value, Place::Construction));
        quote! { #(#statements)* }
    }

    fn check(&self) -> TokenStream {
        let krate = self.krate;
        let finite = self.parameters.fields().map(|field| {
            let name = field.to_string();
            quote! {
                if !#krate::generated::all_finite([parameters.#field]) {
                    return ::core::result::Result::Err(#krate::ParameterError::NotFinite { name: #name });
                }
            }
        });
        let (bodies, shapes) = (self.body_checks(), self.shape_checks());
        let guards: Vec<_> =
            self.program.guards.iter().filter(|guard| self.guard_stage(guard) == Stage::Parameter).collect();
        let values: Vec<Value> =
            guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten().collect();
        let statements = self.at_construction(&values);
        let checked = values.iter().collect::<BTreeSet<_>>().into_iter().map(|&value| local(value));
        let rounded =
            checked.map(|name| quote!(let #name = #krate::generated::construction::rounded(#name);));
        let guards = guards.iter().map(|guard| self.guard(guard));
        quote! {
            #(#finite)*
            #bodies
            #shapes
            #statements
            #(#rounded)*
            #(#guards)*
            ::core::result::Result::Ok(())
        }
    }
}
