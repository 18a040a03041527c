//! The proc-macro door of Hodograph: finds the model and its derivation, calls the generator, reports mistakes. Use it as
//! `hodograph::mechanism!`, which says where the runtime is under whatever name.

mod derivation;
mod file;
mod inline;
mod report;

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::quote;

/// `($crate) "models/two_sleds.mech"` or `($crate) mechanism Name; ..`; without the first group the runtime is `::hodograph`.
#[proc_macro]
pub fn mechanism(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let expand = std::panic::AssertUnwindSafe(|| expand(input.into()));
    match std::panic::catch_unwind(expand) {
        Ok(tokens) => tokens.into(),
        Err(_) => {
            let message = "the generator failed on this model, which is a mistake of Hodograph: please report it with the model";
            quote!(::core::compile_error!(#message);).into()
        }
    }
}

fn expand(input: TokenStream) -> TokenStream {
    let mut trees: Vec<TokenTree> = input.into_iter().collect();
    let krate = match trees.first() {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis => {
            let krate = group.stream();
            trees.remove(0);
            krate
        }
        _ => quote!(::hodograph),
    };
    match file::path(&trees) {
        Some(path) => file::expand(&path, &krate),
        None => inline::expand(trees.into_iter().collect(), &krate),
    }
}
