//! Expands `mechanism!("models/two_sleds.mech")`: a model in a file.

use std::path::{Path, PathBuf};

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use quote::quote;
use syn::ext::IdentExt;
use syn::parse::{Parse, ParseStream, Parser};
use syn::{Error, LitStr, Result, Token};

use super::arguments::{Arguments, WORDS};
use super::compiler;
use super::emitted::emitted;
use super::{derivation, report};
use hodograph_emit as emit;
use hodograph_model::check::check;
use hodograph_model::rust_names;
use hodograph_model::source::Source;
use hodograph_model::suggest::nearest;
use hodograph_model::syntax::token::TokenKind;
use hodograph_program::files;

/// The path in the macro, and its place.
pub struct ModelPath {
    text: String,
    span: Span,
}

/// A string, perhaps with a comma. More than that is an error, which lists the arguments.
impl Parse for ModelPath {
    fn parse(input: ParseStream) -> Result<Self> {
        let path = input.parse::<LitStr>()?;
        let path = ModelPath { text: path.value(), span: path.span() };
        let separated = input.parse::<Option<Token![,]>>()?.is_some();
        if input.is_empty() {
            return Ok(path);
        }
        let words = WORDS.map(|word| format!("`{word}`")).join(" and ");
        let message = match input.fork().call(Ident::parse_any).ok().map(|word| word.to_string()) {
            Some(word) if separated => match nearest(&word, WORDS.into_iter()) {
                Some(meant) => format!("there is no argument `{word}`; did you mean `{meant}`?"),
                None => format!("there is no argument `{word}`: the path is followed by {words}"),
            },
            _ if separated => format!("after the path of a model there are only the arguments {words}"),
            _ => "expected a comma after the path of the model".to_owned(),
        };
        Err(Error::new_spanned(input.parse::<TokenStream>()?, message))
    }
}

/// The path, if the input begins with a string.
pub fn path(trees: &[TokenTree]) -> Option<Result<ModelPath>> {
    let tokens: TokenStream = trees.iter().cloned().collect();
    let begins = |input: ParseStream| {
        let begins = input.peek(LitStr);
        input.parse::<TokenStream>().map(|_| begins)
    };
    begins.parse2(tokens.clone()).is_ok_and(|begins| begins).then(|| syn::parse2(tokens))
}

/// A file that was found, and the expression that names it in generated code.
struct Place {
    path: PathBuf,
    /// relative to Cargo.toml, else to the invoking source file
    in_package: bool,
}

fn find(path: &ModelPath, package: &Path) -> std::result::Result<Place, String> {
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
pub fn expand(path: &ModelPath, arguments: &Arguments, krate: &TokenStream, package: &Path) -> TokenStream {
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
                emit::stub(&module, &stem, &error, &[], &arguments.types())
            };
        }
    };
    let mut tracked_files = vec![tracked(&path.text, place.in_package)];
    let source = files::model_as(path.text.clone(), &place.path);
    tracked_files.extend(source.imported().map(|file| tracked(file.name(), place.in_package)));
    let name = name(&source).unwrap_or(stem);
    let failed = |error: &TokenStream, tracked: &[TokenStream]| {
        emit::stub(&module, &name, error, tracked, &arguments.types())
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
    let (krate, files, requests) = (krate.clone(), tracked_files.clone(), arguments.requests.clone());
    let options = emit::Options { krate, module: module.clone(), tracked: files, requests };
    let found = || derivation::find(&source, &mechanism, &kept, &shown, &command);
    let result = emitted(&mechanism, arguments, path.span, &options, found);
    result.unwrap_or_else(|errors| failed(&errors, &tracked_files))
}

/// The name after the word `mechanism`.
fn name(source: &Source) -> Option<String> {
    let tokens = source.tokens().ok()?;
    let head = tokens.iter().position(|token| token.is_word("mechanism"))?;
    tokens.get(head + 1).filter(|token| token.kind == TokenKind::Name).map(|token| token.text.clone())
}
