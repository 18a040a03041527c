//! The parts that each file sees: its own and those of the files that it imports.

use std::collections::{BTreeMap, HashMap};

use super::imports::Read;
use super::outline::{Block, Item, Part};
use crate::diagnostics::{Diagnostic, codes};

/// The names of the instances in a block, each with the parts that it may be an instance of.
pub type Families = BTreeMap<String, Vec<usize>>;

/// A part of a file.
#[derive(Debug)]
pub struct Entry<'a> {
    /// the part
    pub part: &'a Part,
    /// the file that it stands in
    pub file: usize,
    /// its instances
    pub families: Families,
}

/// All parts.
#[derive(Debug, Default)]
pub struct Catalogue<'a> {
    /// in the order in which they were read
    pub parts: Vec<Entry<'a>>,
    /// the parts that each file sees
    visible: Vec<HashMap<&'a str, usize>>,
    /// a file could not be imported, or two parts have one name: what is unknown is no further mistake
    pub incomplete: bool,
}

impl<'a> Catalogue<'a> {
    /// The parts of all files.
    pub fn new(files: &'a [Read], mistakes: &mut Vec<Diagnostic>) -> Self {
        let mut catalogue = Catalogue { incomplete: !mistakes.is_empty(), ..Catalogue::default() };
        let mut own: Vec<Vec<usize>> = Vec::new();
        for (file, read) in files.iter().enumerate() {
            let first = catalogue.parts.len();
            let entries =
                read.outline.parts.iter().map(|part| Entry { part, file, families: Families::new() });
            catalogue.parts.extend(entries);
            own.push((first..catalogue.parts.len()).collect());
        }
        for (file, read) in files.iter().enumerate() {
            let mut visible: HashMap<&'a str, usize> = HashMap::new();
            let imported = read.imports.iter().flat_map(|import| &own[*import]);
            for &part in own[file].iter().chain(imported) {
                let name = &catalogue.parts[part].part.name;
                match visible.get(name.text.as_str()) {
                    Some(&other) if other != part => {
                        let message = format!("two parts are called `{}`", name.text);
                        let place = catalogue.parts[other].part.name.span;
                        let error = Diagnostic::new(codes::DUPLICATE_NAME, name.span, message);
                        mistakes.push(error.related(place, "the other is here").help("choose another name"));
                        catalogue.incomplete = true;
                        visible.remove(name.text.as_str());
                    }
                    _ => {
                        visible.insert(&name.text, part);
                    }
                }
            }
            catalogue.visible.push(visible);
        }
        let families: Vec<Families> =
            catalogue.parts.iter().map(|entry| catalogue.families(&entry.part.block, entry.file)).collect();
        for (entry, families) in catalogue.parts.iter_mut().zip(families) {
            entry.families = families;
        }
        catalogue
    }

    /// The part of a name, as a file sees it.
    pub fn find(&self, file: usize, name: &str) -> Option<usize> {
        self.visible.get(file)?.get(name).copied()
    }

    /// The names of the parts that a file sees, sorted.
    pub fn names(&self, file: usize) -> Vec<&'a str> {
        let mut names: Vec<&str> =
            self.visible.get(file).into_iter().flat_map(HashMap::keys).copied().collect();
        names.sort_unstable();
        names
    }

    /// The instances in a block of a file.
    pub fn families(&self, block: &Block, file: usize) -> Families {
        let mut families = Families::new();
        let mut open = vec![block];
        while let Some(block) = open.pop() {
            for item in &block.items {
                match item {
                    Item::For(repeated) => open.push(&repeated.block),
                    Item::Use(used) => {
                        let parts = families.entry(used.name.text.clone()).or_default();
                        let part = self.find(file, &used.part.text).filter(|part| !parts.contains(part));
                        parts.extend(part);
                    }
                }
            }
        }
        families
    }

    /// The instances of any of these parts.
    pub fn families_of(&self, parts: &[usize]) -> Families {
        let mut families = Families::new();
        for entry in parts.iter().filter_map(|part| self.parts.get(*part)) {
            for (name, parts) in &entry.families {
                let all = families.entry(name.clone()).or_default();
                all.extend(parts.iter().filter(|part| !all.contains(part)).copied().collect::<Vec<_>>());
            }
        }
        families
    }
}
