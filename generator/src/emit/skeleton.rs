//! The module of a model with mistakes: enough that one mistake does not cause ten.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::names;

/// A module with the types that every mechanism has, and nothing in them. `tracked` as in [`super::Options`].
pub fn skeleton(module: &str, mechanism: Option<&str>, tracked: &[TokenStream]) -> TokenStream {
    let module = names::ident(module);
    let name = format_ident!("{}", names::type_name(mechanism.unwrap_or("Mechanism")));
    let records = ["Parameters", "Coordinates", "Speeds", "DependentSpeeds", "Inputs"]
        .map(|name| format_ident!("{name}"));
    quote! {
        /// The model has mistakes.
        #[allow(dead_code, clippy::all)]
        pub mod #module {
            #(const _: &[u8] = ::core::include_bytes!(#tracked);)*
            #(
                /// The model has mistakes.
                #[derive(Clone, Copy, Debug, Default, PartialEq)]
                pub struct #records<T = f64>(::core::marker::PhantomData<T>);
            )*
            /// The model has mistakes.
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct #name<T = f64>(::core::marker::PhantomData<T>);
        }
    }
}
