//! Finds inline models, `mechanism! { .. }`, in Rust files.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use hodograph_generator::expand::Arguments;
use hodograph_generator::files::{self, Beside};
use hodograph_generator::source::Source;
use proc_macro2::{TokenStream, TokenTree};

use crate::stop::{Outcome, Stop};

/// Largest size of a Rust file with models, in bytes.
const MAX_BYTES: usize = 16 << 20;

/// The model of a `mechanism!` in a Rust file.
#[derive(Clone, Debug)]
pub enum Invocation {
    /// a model in the file itself; all other text of the source is blanked, so that places are those in the
    /// file
    Inline(Source),
    /// a model file, by the path in the macro
    File(PathBuf),
}

/// The models of a Rust file, in order.
///
/// # Errors
///
/// The file cannot be read, or is not Rust.
pub fn models(path: &Path) -> Outcome<Vec<Invocation>> {
    let text = files::text(path, MAX_BYTES).map_err(|error| Stop::unreadable(path, &error))?;
    if !text.contains("mechanism") {
        return Ok(Vec::new());
    }
    let stream = TokenStream::from_str(&text).map_err(|error| {
        let start = error.span().start();
        Stop::Fault(format!(
            "{}:{}:{}: this is not Rust: {error}",
            path.display(),
            start.line,
            start.column + 1
        ))
    })?;
    let name = path.display().to_string();
    let mut sources = Vec::new();
    let mut open = vec![stream];
    while let Some(stream) = open.pop() {
        let trees: Vec<TokenTree> = stream.into_iter().collect();
        for (index, tree) in trees.iter().enumerate() {
            let TokenTree::Group(group) = tree else { continue };
            if index >= 2 && is_invocation(&trees[index - 2], &trees[index - 1]) {
                let (from, to) = (group.span_open().byte_range().end, group.span_close().byte_range().start);
                let arguments = Arguments::take(group.stream().into_iter().collect());
                match arguments.rest.into_iter().next() {
                    Some(TokenTree::Ident(_) | TokenTree::Punct(_)) => {
                        let taken: Vec<Range<usize>> =
                            arguments.taken.iter().filter_map(|argument| places(argument)).collect();
                        let source = Source::file(name.clone(), blanked(&text, from..to, &taken));
                        let source = match package(path) {
                            Ok(package) => source.importing(&beside(&package)),
                            Err(_) => source,
                        };
                        sources.push((from, Invocation::Inline(source)));
                    }
                    Some(TokenTree::Literal(literal)) => {
                        let literal = literal.to_string();
                        let file = literal.trim_start_matches('r').trim_matches('#').trim_matches('"');
                        sources.push((from, Invocation::File(PathBuf::from(file))));
                    }
                    _ => {}
                }
            } else {
                open.push(group.stream());
            }
        }
    }
    sources.sort_by_key(|&(from, _)| from);
    Ok(sources.into_iter().map(|(_, source)| source).collect())
}

/// Imports of inline models are relative to Cargo.toml.
fn beside(package: &Path) -> Beside {
    let path = package.join("Cargo.toml");
    Beside { name: path.display().to_string(), path }
}

fn is_invocation(name: &TokenTree, bang: &TokenTree) -> bool {
    matches!(name, TokenTree::Ident(name) if name == "mechanism")
        && matches!(bang, TokenTree::Punct(bang) if bang.as_char() == '!')
}

/// The range of tokens in the file, from the first to the last.
fn places(trees: &[TokenTree]) -> Option<Range<usize>> {
    Some(trees.first()?.span().byte_range().start..trees.last()?.span().byte_range().end)
}

/// The text up to the end of a range. Everything before the range and in some parts of it is replaced by
/// blanks, so that lines and columns stay the same.
fn blanked(text: &str, range: Range<usize>, parts: &[Range<usize>]) -> String {
    let is_kept = |at: usize| at >= range.start && !parts.iter().any(|part| part.contains(&at));
    let upto = text.char_indices().take_while(|(at, _)| *at < range.end);
    upto.map(|(at, c)| if c == '\n' || is_kept(at) { c } else { ' ' }).collect()
}

/// The directory of the package that a file belongs to: the nearest above it with a `Cargo.toml`.
///
/// # Errors
///
/// There is no package.
pub fn package(path: &Path) -> Outcome<PathBuf> {
    // search the path as written, as long as that leads upwards
    let written = path.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
    let absolute = std::path::absolute(path).map_err(|error| Stop::unreadable(path, &error))?;
    written
        .chain(absolute.ancestors().skip(1))
        .find(|folder| folder.join("Cargo.toml").is_file())
        .map(Path::to_path_buf)
        .ok_or_else(|| {
            Stop::Call(format!("{} is not in a package: there is no Cargo.toml above it", path.display()))
        })
}

#[cfg(test)]
mod tests {
    use hodograph_generator::artifact::model_hash;
    use hodograph_generator::expand::Inline;

    use super::*;

    #[test]
    fn inline_models_are_found_in_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lib.rs");
        let text = "// mechanism! { no }\nhodograph::mechanism! {\n    mechanism Té;\n}\nmod a { mechanism!(\"b.mech\", evaluate x(é)); \
                    mechanism! { evaluate é(forcing); mechanism B; evaluate y(é); specialise z(é, e = 1) } }\nfn f() -> &'static str { \"mechanism! { no }\" }\n";
        std::fs::write(&path, text).unwrap();
        let found = models(&path).unwrap();
        let [Invocation::Inline(first), Invocation::File(file), Invocation::Inline(last)] = &found[..] else {
            panic!("{found:?}");
        };
        assert!(first.text().unwrap().ends_with("\n    mechanism Té;\n"));
        assert_eq!(first.text().unwrap().lines().count(), 3);
        assert_eq!(file, Path::new("b.mech"));
        assert_eq!(last.text().unwrap().trim(), "mechanism B;");
        std::fs::write(folder.path().join("Cargo.toml"), "").unwrap();
        assert_eq!(package(&path).unwrap(), folder.path());
    }

    #[test]
    fn a_model_has_one_hash_in_a_file_in_rust_and_in_the_macro() {
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../models");
        let folder = tempfile::tempdir().unwrap();
        for name in ["two_sleds", "whipple_bicycle", "shaken_pendulum_moving_plate"] {
            let text = std::fs::read_to_string(root.join(name).with_extension("mech")).unwrap();
            let path = folder.path().join("lib.rs");
            std::fs::write(&path, format!("hodograph::mechanism! {{\n{text}\n}}\n")).unwrap();
            let Invocation::Inline(source) = models(&path).unwrap().remove(0) else { panic!("inline") };
            let hash = model_hash(&source);
            assert_eq!(hash, model_hash(&Source::file("model", text.clone())), "{name}");
            let tokens = TokenStream::from_str(&text).unwrap();
            assert_eq!(hash, model_hash(&Inline::new("model", tokens).source), "{name}");
        }
    }
}
