//! Models in the source: `mechanism! { mechanism Name; .. }`. Their derivations are in `derived/` beside Cargo.toml.

use std::path::{Path, PathBuf};

use proc_macro2::{Span, TokenStream};
use quote::quote;

use super::{derivation, report};
use crate::check::check;
use crate::compiler;
use crate::emit;
use crate::rust_names;
use crate::source::Source;

/// The module of an inline model.
pub fn expand(model: TokenStream, krate: &TokenStream, package: &Path) -> TokenStream {
    // The tokens are the user's; the call itself stands in the wrapper of the runtime.
    let first = model.clone().into_iter().next().map_or_else(Span::call_site, |token| token.span());
    let (name, at) = name(&model).map_or((None, first), |(name, at)| (Some(name), at));
    let source = Source::inline("mechanism!", model);
    let checked = check(&source);
    let module = rust_names::snake_case(name.as_deref().unwrap_or("mechanism"));
    let Some(mechanism) = checked.mechanism else {
        let errors = report::of_inline(&source, &checked.diagnostics);
        // what has no name nobody refers to
        let skeleton = name.as_deref().map(|name| emit::skeleton(&module, Some(name), &[]));
        return quote!(#errors #skeleton);
    };
    let shown = format!("derived/{module}.derivation");
    let command = format!("hodograph derive {}", invoking_file(first, package));
    let path = package.join(&shown);
    let relative = format!("/{shown}");
    let tracked = quote!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), #relative));
    let result = derivation::find(&source, &mechanism, &path, &shown, &command).and_then(|found| {
        let tracked = if found.checked_in { vec![tracked.clone()] } else { vec![] };
        let options = emit::Options { krate: krate.clone(), module: module.clone(), tracked };
        emit::module(&mechanism, &found.program, &options)
    });
    result.unwrap_or_else(|message| {
        let error = report::error(at, at, &message);
        let tracked = if path.is_file() { vec![tracked] } else { vec![] };
        let options = emit::Options { krate: krate.clone(), module: module.clone(), tracked };
        let stub = emit::stub(&mechanism, &options);
        quote!(#error #stub)
    })
}

/// The name after `mechanism`, which follows the documentation, and where it stands.
fn name(model: &TokenStream) -> Option<(String, Span)> {
    let mut trees = model.clone().into_iter();
    trees.by_ref().find(|tree| tree.to_string() == "mechanism")?;
    let token = trees.next()?;
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
