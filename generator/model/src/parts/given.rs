//! Names that the statements of parts declare although they are predefined: counts, indices, arguments and
//! instances. What sections of the mechanism declare is looked at where all its names are collected.

use super::catalogue::Catalogue;
use super::outline::{Block, Item, Outline, names_of_arguments};
use crate::diagnostics::{Diagnostic, codes};
use crate::syntax::tree::Name;
use crate::words;

/// A mistake for each of them.
pub fn mistakes(root: &Outline, catalogue: &Catalogue<'_>) -> Vec<Diagnostic> {
    let mut found: Vec<Diagnostic> = root.counts.iter().filter_map(|count| predefined(&count.name)).collect();
    let mut open: Vec<&Block> = vec![&root.block];
    for part in catalogue.parts.iter().map(|entry| entry.part) {
        found.extend(names_of_arguments(part).filter_map(predefined));
        open.push(&part.block);
    }
    while let Some(block) = open.pop() {
        for item in &block.items {
            match item {
                Item::Use(used) if used.indices.is_empty() => found.extend(predefined(&used.name)),
                Item::Use(_) => {}
                Item::For(repeated) => {
                    found.extend(predefined(&repeated.variable));
                    open.push(&repeated.block);
                }
            }
        }
    }
    found
}

/// Says so where a name is predefined.
pub fn predefined(name: &Name) -> Option<Diagnostic> {
    let given = words::look(words::GIVEN, &name.text)?;
    let message = format!("`{}` is predefined: {}", given.text, given.meaning);
    Some(Diagnostic::new(codes::RESERVED_NAME, name.span, message).help("choose another name"))
}
