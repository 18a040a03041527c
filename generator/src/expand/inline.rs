//! Expands `mechanism! { mechanism Name; .. }`: a model in the Rust source. Its derivation is in `derived/`
//! beside Cargo.toml.

use std::path::{Path, PathBuf};

use proc_macro2::{Span, TokenStream, TokenTree};
use quote::quote;

use super::arguments::Arguments;
use super::compiler;
use super::emitted::emitted;
use super::tokens::Inline;
use super::{derivation, report};
use hodograph_emit as emit;
use hodograph_model::check::check;
use hodograph_model::rust_names;
use hodograph_program::files::Beside;

/// The module of an inline model.
pub fn expand(model: TokenStream, arguments: &Arguments, krate: &TokenStream, package: &Path) -> TokenStream {
    // The tokens are the user's; the call itself is in the wrapper of the runtime.
    let first = model.clone().into_iter().next().map_or_else(Span::call_site, |token| token.span());
    let (name, at) = name(&model).map_or((None, first), |(name, at)| (Some(name), at));
    // imports are relative to Cargo.toml, like the path of a model file
    let imports = Beside { path: package.join("Cargo.toml"), name: "Cargo.toml".to_owned() };
    let model = Inline::new("mechanism!", model).importing(&imports);
    let source = &model.source;
    let imported: Vec<TokenStream> = source.imported().map(|file| in_package(file.name())).collect();
    let checked = check(source);
    let module = rust_names::snake_case(name.as_deref().unwrap_or("mechanism"));
    let failed = |error: &TokenStream, tracked: &[TokenStream]| match &name {
        Some(name) => emit::stub(&module, name, error, tracked, &arguments.types()),
        // a module without a name is never used
        None => error.clone(),
    };
    let Some(mechanism) = checked.mechanism else {
        return failed(&report::of_inline(&model, &checked.diagnostics), &imported);
    };
    let shown = format!("derived/{module}.derivation");
    let command = format!("hodograph derive {}", invoking_file(first, package));
    let path = package.join(&shown);
    let tracked: Vec<TokenStream> =
        path.is_file().then(|| in_package(&shown)).into_iter().chain(imported).collect();
    let (krate, files, requests) = (krate.clone(), tracked.clone(), arguments.requests.clone());
    let options = emit::Options { krate, module: module.clone(), tracked: files, requests };
    let found = || derivation::find(source, &mechanism, &path, &shown, &command);
    let result = emitted(&mechanism, arguments, at, &options, found);
    result.unwrap_or_else(|errors| failed(&errors, &tracked))
}

/// The expression that names a file of the package in generated code.
fn in_package(path: &str) -> TokenStream {
    let path = format!("/{path}");
    quote!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), #path))
}

/// The name after `mechanism`, which follows the documentation, and its place.
fn name(model: &TokenStream) -> Option<(String, Span)> {
    let trees: Vec<TokenTree> = model.clone().into_iter().collect();
    let is = |tree: &TokenTree, word: &str| matches!(tree, TokenTree::Ident(ident) if ident == word);
    let head = trees.iter().position(|tree| is(tree, "mechanism"));
    // the word itself may be misspelled
    let head = head.or_else(|| trees.iter().position(|tree| matches!(tree, TokenTree::Ident(_))))?;
    let token = trees.get(head + 1)?;
    let name = token.to_string();
    let is_name = name.starts_with(|c: char| c == '_' || c.is_alphabetic());
    is_name.then(|| (name, token.span()))
}

/// The source file that invokes the macro, relative to Cargo.toml where it is below.
fn invoking_file(first: Span, package: &Path) -> String {
    let file = compiler::file(first).unwrap_or_else(|| PathBuf::from("src/lib.rs"));
    let absolute = std::path::absolute(&file).unwrap_or_else(|_| file.clone());
    absolute.strip_prefix(package).unwrap_or(&file).to_string_lossy().into_owned()
}
