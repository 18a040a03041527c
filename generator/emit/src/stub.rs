//! Emits the module of a model with mistakes: compile errors for the mistakes, and names that keep the
//! compiler from reporting consequential errors.

use proc_macro2::TokenStream;
use quote::quote;

use crate::identifiers;

/// A module that holds `errors` (calls of `compile_error!`) and the names of the types that a mechanism has.
///
/// The names are imports of items that do not exist. In a module with a `compile_error!` the compiler does
/// not report these, and it also suppresses errors of code that uses the imported names: one mistake in a
/// model is one error. `tracked` is as in [`super::Options`]; `types` are those of the sets.
pub fn stub(
    module: &str,
    mechanism: &str,
    errors: &TokenStream,
    tracked: &[TokenStream],
    types: &[String],
) -> TokenStream {
    let module = identifiers::ident(module);
    let name = identifiers::type_name(mechanism);
    let mut names: Vec<&str> = vec![&name];
    for other in identifiers::RECORDS.iter().copied().chain(types.iter().map(String::as_str)) {
        if !names.contains(&other) {
            names.push(other);
        }
    }
    let names = names.into_iter().map(identifiers::ident);
    quote! {
        /// The model has mistakes.
        pub mod #module {
            #(const _: &[u8] = ::core::include_bytes!(#tracked);)*
            #errors
            pub use self::absent::{#(#names),*};
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hodograph_model::rust_names::snake_case;

    #[test]
    fn a_stub_is_rust() {
        // of a missing file only the name is known
        for name in ["two_sleds", "arm.v2", "2-arms", "-", "ö", "a b", "linearisation", "fn"] {
            let error = quote!(::core::compile_error! { "no" });
            let tokens =
                stub(&snake_case(name), name, &error, &[quote!("x")], &["Control".into(), "Speeds".into()]);
            let file = syn::parse2::<syn::File>(tokens).unwrap_or_else(|error| panic!("{name}: {error}"));
            let [syn::Item::Mod(module)] = &file.items[..] else { panic!("one module") };
            assert_eq!(module.content.as_ref().map_or(0, |(_, items)| items.len()), 3, "{name}");
        }
    }
}
