//! Expands `mechanism!`: finds the model and its derivation, and returns the module or the mistakes. It runs
//! in the compiler and in macro servers of editors, which run for a long time and expand often, from several
//! threads.

mod arguments;
mod compiler;
mod derivation;
mod emitted;
mod file;
mod inline;
mod report;
mod tokens;

use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};
use quote::quote;

use hodograph_model::syntax::tree::Section;

pub use arguments::Arguments;
pub use tokens::Inline;

/// The expansion of `mechanism!`: a module, or errors and a stand-in for it. The input is `($crate)
/// "models/two_sleds.mech"` or `($crate) mechanism Name; ..`; without the first group the runtime is
/// `::hodograph`. `package` is the folder of the invoking package's `Cargo.toml`.
pub fn expand(input: TokenStream, package: &Path) -> TokenStream {
    let expand = std::panic::AssertUnwindSafe(|| module(input, package));
    std::panic::catch_unwind(expand).unwrap_or_else(|_| {
        let message = "the generator failed on this model, which is a mistake of Hodograph: please report it with the model";
        quote!(::core::compile_error!(#message);)
    })
}

/// The folder of the `Cargo.toml` of the package that is compiled.
pub fn package() -> PathBuf {
    std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default()
}

fn module(input: TokenStream, package: &Path) -> TokenStream {
    let mut trees: Vec<TokenTree> = input.into_iter().collect();
    let krate = match trees.first() {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis => {
            let krate = group.stream();
            trees.remove(0);
            krate
        }
        _ => quote!(::hodograph),
    };
    let mut arguments = Arguments::take(trees);
    let trees = std::mem::take(&mut arguments.rest);
    match file::path(&trees) {
        Some(Ok(path)) => file::expand(&path, &arguments, &krate, package),
        Some(Err(error)) => error.to_compile_error(),
        None if is_model(&trees) => inline::expand(trees.into_iter().collect(), &arguments, &krate, package),
        None => {
            let first = trees.first().map_or_else(Span::call_site, TokenTree::span);
            let last = trees.last().map_or(first, TokenTree::span);
            report::error(first, last, TAKES)
        }
    }
}

const TAKES: &str = "`mechanism!` takes the path of a model file in quotes, as in `mechanism!(\"models/hopper.mech\")`, or a model, as in \
                     `mechanism! { mechanism Hopper; .. }`";

/// Whether the input looks like a model, perhaps without its beginning.
fn is_model(trees: &[TokenTree]) -> bool {
    trees.windows(2).any(|pair| match pair {
        [TokenTree::Ident(word), next] => {
            let opens = matches!(next, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
            word == "mechanism" || opens && Section::of_word(&word.to_string()).is_some()
        }
        _ => false,
    })
}
