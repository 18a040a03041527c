//! Expands `mechanism!("models/two_sleds.mech")`: a model in a file.

use std::path::{Path, PathBuf};

use proc_macro2::{Span, TokenStream, TokenTree};
use quote::quote;

use super::emitted::emitted;
use super::sets::Sets;
use super::{derivation, report};
use crate::check::check;
use crate::compiler;
use crate::emit;
use crate::rust_names;
use crate::source::Source;
use crate::syntax::token::TokenKind;

/// The path that the user wrote, and where.
pub struct ModelPath {
    text: String,
    span: Span,
}

/// The path, if the input is one: a string, perhaps with a comma.
pub fn path(trees: &[TokenTree]) -> Option<ModelPath> {
    let literal = match trees {
        [literal] => literal,
        [literal, TokenTree::Punct(comma)] if comma.as_char() == ',' => literal,
        _ => return None,
    };
    // A literal that another macro passed on stands in an invisible group.
    let literal = match literal {
        TokenTree::Group(group) => group.stream().into_iter().next()?,
        literal => literal.clone(),
    };
    let TokenTree::Literal(literal) = literal else { return None };
    let quoted = literal.to_string();
    let text = match quoted.strip_prefix('r') {
        Some(raw) => raw.trim_matches('#').strip_prefix('"')?.strip_suffix('"')?.to_string(),
        None => quoted.strip_prefix('"')?.strip_suffix('"')?.replace("\\\\", "\\").replace("\\\"", "\""),
    };
    Some(ModelPath { text, span: literal.span() })
}

/// A file that was found, and the expression that names it in generated code.
struct Place {
    path: PathBuf,
    /// relative to Cargo.toml, else to the invoking source file
    in_package: bool,
}

fn find(path: &ModelPath, package: &Path) -> Result<Place, String> {
    let in_package = package.join(&path.text);
    if in_package.is_file() {
        return Ok(Place { path: in_package, in_package: true });
    }
    let source = compiler::file(path.span);
    let beside = source.as_deref().and_then(Path::parent).map(|folder| folder.join(&path.text));
    match beside {
        Some(beside) if beside.is_file() => Ok(Place { path: beside, in_package: false }),
        _ => Err(format!(
            "there is no model `{}`: the path is relative to the package's Cargo.toml, or to the source file that invokes \
             the macro",
            path.text
        )),
    }
}

/// The expression that names a file in generated code, without an absolute path.
fn tracked(text: &str, in_package: bool) -> TokenStream {
    if in_package && !Path::new(text).is_absolute() {
        let text = format!("/{text}");
        quote!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), #text))
    } else {
        quote!(#text)
    }
}

/// The module of a model in a file.
pub fn expand(path: &ModelPath, sets: &Sets, krate: &TokenStream, package: &Path) -> TokenStream {
    let stem = Path::new(&path.text)
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let module = rust_names::snake_case(&stem);
    let place = match find(path, package) {
        Ok(place) => place,
        Err(message) => {
            let error = report::error(path.span, path.span, &message);
            return if stem.is_empty() {
                error
            } else {
                emit::stub(&module, &stem, &error, &[], &sets.types())
            };
        }
    };
    let mut tracked_files = vec![tracked(&path.text, place.in_package)];
    let source = Source::read_as(path.text.clone(), &place.path);
    let name = name(&source).unwrap_or(stem);
    let failed = |error: &TokenStream, tracked: &[TokenStream]| {
        emit::stub(&module, &name, error, tracked, &sets.types())
    };
    let checked = check(&source);
    let Some(mechanism) = checked.mechanism else {
        return failed(&report::of_file(&source, &checked.diagnostics, path.span), &tracked_files);
    };
    let shown = Path::new(&path.text).with_extension("derivation").to_string_lossy().into_owned();
    let command = format!("hodograph derive {}", path.text);
    let kept = place.path.with_extension("derivation");
    if kept.is_file() {
        tracked_files.push(tracked(&shown, place.in_package));
    }
    let (krate, files, sets_asked) = (krate.clone(), tracked_files.clone(), sets.sets.clone());
    let options = emit::Options { krate, module: module.clone(), tracked: files, sets: sets_asked };
    let found = || derivation::find(&source, &mechanism, &kept, &shown, &command);
    let result = emitted(&mechanism, sets, path.span, &options, found);
    result.unwrap_or_else(|errors| failed(&errors, &tracked_files))
}

/// The name after the word `mechanism`.
fn name(source: &Source) -> Option<String> {
    let tokens = source.tokens().ok()?;
    let head = tokens.iter().position(|token| token.is_word("mechanism"))?;
    tokens.get(head + 1).filter(|token| token.kind == TokenKind::Name).map(|token| token.text.clone())
}
