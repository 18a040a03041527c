//! Parts: pieces of mechanisms that are used several times, in one file or in files that are imported. They
//! are expanded here, to the tokens of a model without parts; no later stage knows of them.
//!
//! ```text
//! reader     tokens of a file -> outline: imports, counts, parts, uses, repetitions, sections
//! imports    the outlines of all files
//! catalogue  the parts that each file sees
//! template   sections -> words, each with what it is: a name that is declared, a reference, or neither (roles)
//! instances  each use and each turn of a repetition, and the names that it declares
//! given      names that are predefined, and cannot be declared
//! uses       whether a use can be, and what it gives
//! resolve    what a name of an instance means in the mechanism
//! bind       what each instance is given
//! assembly   the sections of the expanded model
//! emit       the blocks of all instances, written into these
//! messages   diagnostics of the expanded model, said of the texts that its author wrote
//! names      where each name stands in the texts, without expanding them
//! ```
//!
//! Expanding is bounded: instances, files and tokens are counted, and no text is read twice.

mod assembly;
mod bind;
mod catalogue;
mod count;
mod emit;
mod given;
mod imports;
mod instances;
mod messages;
pub mod names;
mod outline;
mod places;
mod reader;
mod resolve;
mod roles;
mod template;
mod text;
mod uses;

use std::collections::HashMap;

use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::syntax::token::Token;

use assembly::Model;
use catalogue::Catalogue;
use count::Numbers;
use instances::Instances;
use resolve::Resolver;

pub use given::predefined;
pub use imports::{Files, Imported, NoFiles};
pub use outline::WORDS;
pub use places::{Place, Places, Site};
pub use reader::has_parts;

/// A model without parts, and where its tokens come from.
#[derive(Clone, Debug)]
pub struct Expansion {
    /// the tokens
    pub tokens: Vec<Token>,
    /// where they come from
    pub places: Places,
    /// the files that were imported; the file `i` of a place is the entry `i - 1`
    pub files: Vec<Imported>,
    /// what is wrong with the parts and their uses
    pub mistakes: Vec<Diagnostic>,
    /// what is wrong with the syntax, of the mechanism too
    pub syntax: Vec<Diagnostic>,
    /// the text holds parts and no mechanism
    pub is_library: bool,
    /// names of the expanded model as they are written outside of their parts
    shown: HashMap<String, String>,
    /// for names that a part does not declare, by file and place, those that may be meant
    near: HashMap<(u32, Span), String>,
}

/// Expands the parts of a model; nothing where it has none, or where its brackets do not match. `most` is the
/// largest number of tokens.
pub fn expand(tokens: &[Token], files: &dyn Files, most: usize) -> Option<Expansion> {
    if tokens.len() > most || !has_parts(tokens) || imports::unbalanced(tokens).is_some() {
        return None;
    }
    let (mut places, mut mistakes) = (Places::default(), Vec::new());
    let mut own = tokens.to_vec();
    imports::place(&mut own, 0, &mut places);
    let is_library = imports::is_mechanism(tokens).is_none();
    let root = reader::read(&own, !is_library, &mut mistakes);
    // statements that could not be read are of syntax too
    let mut syntax = std::mem::take(&mut mistakes);
    let read = imports::read_all(root, files, most - tokens.len(), &mut places, &mut mistakes);
    let catalogue = Catalogue::new(&read, &mut mistakes);
    mistakes.extend(given::mistakes(&read[0].outline, &catalogue));
    let numbers = counts(&read[0].outline.counts, &mut mistakes);
    let block = &read[0].outline.block;
    let mut instances = Instances::new(block, numbers, &catalogue, &mut places, most);
    syntax.extend(instances.syntax());
    mistakes.append(&mut instances.mistakes);
    let mut model = Model::default();
    // what follows from a part that could not be read is no further mistake
    let sound = mistakes.is_empty() && syntax.is_empty();
    let mut shown = std::mem::take(&mut instances.shown);
    if sound {
        instances.shown = shown;
        let mut resolver = Resolver { instances: &mut instances, bindings: Vec::new() };
        let values = resolver.bind(&mut model);
        if let Err(instance) = resolver.write(&values, most, &mut model) {
            let span = instances.list[instance].used.map_or(Span::default(), |used| used.span);
            let message = format!("the model has more than {most} words and signs with this part");
            mistakes.push(Diagnostic::new(codes::REPETITION, span, message));
        }
        mistakes.append(&mut instances.mistakes);
        shown = std::mem::take(&mut instances.shown);
    }
    let near = instances.near;
    let tokens = if mistakes.is_empty() { model.tokens(&mut places) } else { own };
    let files = read.into_iter().filter_map(|read| read.file).collect();
    Some(Expansion { tokens, places, files, mistakes, syntax, is_library, shown, near })
}

/// The counts of a mechanism.
fn counts(list: &[outline::Count], mistakes: &mut Vec<Diagnostic>) -> Numbers {
    let mut numbers = Numbers::new();
    for count in list {
        if numbers.iter().any(|(name, _)| *name == count.name.text) {
            let message = format!("the name `{}` is declared twice", count.name.text);
            mistakes.push(Diagnostic::new(codes::DUPLICATE_NAME, count.name.span, message));
            continue;
        }
        match count::evaluate(&count.value, &numbers, count.name.span) {
            Ok(value) => numbers.push((count.name.text.clone(), value)),
            Err(error) => {
                mistakes.push(*error);
                // so that nothing more is said of it
                numbers.push((count.name.text.clone(), 1));
            }
        }
    }
    numbers
}
