//! Models in the source: `mechanism! { mechanism Name; .. }`. Their derivations are in `derived/` beside Cargo.toml.

use std::path::{Path, PathBuf};

use hodograph_generator::emit;
use hodograph_generator::model::check;
use hodograph_generator::source::Source;
use proc_macro2::{Span, TokenStream};
use quote::quote;

use crate::{derivation, report};

/// The module of an inline model.
pub fn expand(model: TokenStream, krate: &TokenStream) -> TokenStream {
    let name = name(&model);
    // The tokens are the user's; the call itself stands in the wrapper of the runtime.
    let place = model.clone().into_iter().next().map_or_else(Span::call_site, |token| token.span());
    let source = Source::inline("mechanism!", model);
    let checked = check(&source);
    let module = emit::names::snake_case(name.as_deref().unwrap_or("mechanism"));
    let Some(mechanism) = checked.mechanism else {
        let errors = report::of_inline(&source, &checked.diagnostics);
        let skeleton = emit::skeleton(&module, name.as_deref(), &[]);
        return quote!(#errors #skeleton);
    };
    let manifest = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    let shown = format!("derived/{module}.derivation");
    let command = format!("hodograph derive {}", invoking_file(place, &manifest));
    let path = manifest.join(&shown);
    let relative = format!("/{shown}");
    let tracked = quote!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), #relative));
    let result = derivation::find(&source, &mechanism, &path, &shown, &command).and_then(|found| {
        let tracked = if found.checked_in { vec![tracked.clone()] } else { vec![] };
        let options = emit::Options { krate: krate.clone(), module: module.clone(), tracked };
        emit::module(&mechanism, &found.program, &options)
    });
    result.unwrap_or_else(|message| {
        let error = report::error(Span::call_site(), Span::call_site(), &message);
        let tracked = if path.is_file() { vec![tracked] } else { vec![] };
        let options = emit::Options { krate: krate.clone(), module: module.clone(), tracked };
        let stub = emit::stub(&mechanism, &options);
        quote!(#error #stub)
    })
}

/// The name after `mechanism`, which follows the documentation.
fn name(model: &TokenStream) -> Option<String> {
    let mut trees = model.clone().into_iter();
    trees.by_ref().find(|tree| tree.to_string() == "mechanism")?;
    let name = trees.next()?.to_string();
    let is_name = name.starts_with(|c: char| c == '_' || c.is_alphabetic());
    is_name.then_some(name)
}

/// The source file that invokes the macro, relative to Cargo.toml where it is below.
fn invoking_file(place: Span, manifest: &Path) -> String {
    let file = place.unwrap().local_file().unwrap_or_else(|| PathBuf::from("src/lib.rs"));
    let absolute = std::path::absolute(&file).unwrap_or_else(|_| file.clone());
    absolute.strip_prefix(manifest).unwrap_or(&file).to_string_lossy().into_owned()
}
