//! The names of a model with parts and of the files that it imports, with all places where they stand in these
//! texts: what an editor needs to change one. Nothing is expanded: a name of a part is one name, however often
//! the part is used, and parts that are not used are read too.
//!
//! A name belongs to a scope: the mechanism, a part, a repetition (its index), or a file (its parts). A place
//! can stand for names of several scopes: `leg[i].tip` where some `leg` are instances of one part and some of
//! another. What a part shares with the mechanism is a name of both.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use super::bind::point_and_owner;
use super::catalogue::{Catalogue, Families};
use super::imports::{self, Files, Imported};
use super::instances::MOST_DEPTH;
use super::outline::{ArgumentKind, Block, Item, Outline, Part, Use, names_of_arguments};
use super::places::Places;
use super::reader;
use super::roles::{Kind, Role};
use super::template::{Path, Template, Word, expression, template};
use crate::span::Span;
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::tree::Name;

/// Where a name belongs.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scope {
    /// the mechanism
    Mechanism,
    /// a file: names of parts
    File,
    /// the part of this name
    Part(String),
    /// the repetition that begins at this byte of its file
    Repetition(u32),
}

/// A name, the same for all models that import its file.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Owned {
    /// the file that declares it: 0 is that of the model
    pub file: u32,
    /// where in that file
    pub scope: Scope,
    /// as it is written
    pub text: String,
}

/// A place where a name stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Standing {
    /// the file
    pub file: u32,
    /// where in its text
    pub span: Span,
    /// which of [`Names::names`] it stands for: one, but through instances of different parts
    pub names: Vec<usize>,
    /// a coordinate is declared here; the place of all of it, with its indices
    pub coordinate: Option<Span>,
}

/// All names.
#[derive(Debug, Default)]
pub struct Names {
    /// the files that are imported; the file `i` of a place is the entry `i - 1`
    pub files: Vec<Imported>,
    /// the names, in the order in which they were met
    pub names: Vec<Owned>,
    /// names of parts that are names of the mechanism
    pub shared: Vec<(usize, usize)>,
    /// where names stand, in the order of files and places
    pub places: Vec<Standing>,
}

/// The names of a text with parts, of at most `most` tokens. Nothing where the text has no parts, or where it,
/// or what it imports, cannot be read.
pub fn names(tokens: &[Token], files: &dyn Files, most: usize) -> Option<Names> {
    if tokens.len() > most || !reader::has_parts(tokens) || imports::unbalanced(tokens).is_some() {
        return None;
    }
    let (mut places, mut mistakes) = (Places::default(), Vec::new());
    let mut own = tokens.to_vec();
    imports::place(&mut own, 0, &mut places);
    let is_library = imports::is_mechanism(tokens).is_none();
    let root = reader::read(&own, !is_library, &mut mistakes);
    let read = imports::read_all(root, files, most - tokens.len(), &mut places, &mut mistakes);
    let catalogue = Catalogue::new(&read, &mut mistakes);
    if !mistakes.is_empty() {
        return None;
    }
    let root = &read[0].outline;
    let mut walk = Walk {
        catalogue: &catalogue,
        root,
        families: catalogue.families(&root.block, 0),
        is_library,
        places: &places,
        spaces: Vec::new(),
        used: HashSet::new(),
        templates: HashMap::new(),
        known: HashMap::new(),
        sound: true,
        found: Names::default(),
    };
    let mut open = vec![catalogue.parts.len()];
    while let Some(owner) = open.pop() {
        let uses: Vec<usize> = walk.families_of(owner).values().flatten().copied().collect();
        open.extend(uses.into_iter().filter(|part| walk.used.insert(*part)));
    }
    // what is declared comes first: a name may stand before its declaration
    walk.spaces = (0..=catalogue.parts.len()).map(|owner| walk.space(owner)).collect();
    (0..catalogue.parts.len()).for_each(|part| walk.part(part));
    walk.mechanism();
    let Walk { sound, mut found, .. } = walk;
    found.files = read.into_iter().filter_map(|read| read.file).collect();
    found.places.sort_by_key(|place| (place.file, place.span));
    sound.then_some(found)
}

/// The names that a part or the mechanism declares; with what they are, where a section declares them.
type Space = HashMap<String, Option<Kind>>;

/// The indices of the repetitions around a place, each with the byte at which its repetition begins.
type Indices = Vec<(String, u32)>;

struct Walk<'a> {
    catalogue: &'a Catalogue<'a>,
    root: &'a Outline,
    /// the instances that the mechanism itself uses
    families: Families,
    is_library: bool,
    places: &'a Places,
    /// of each part, and last of the mechanism
    spaces: Vec<Space>,
    /// the parts of which the mechanism has instances
    used: HashSet<usize>,
    templates: HashMap<*const Block, Rc<Template>>,
    known: HashMap<Owned, usize>,
    /// all could be read
    sound: bool,
    found: Names,
}

impl<'a> Walk<'a> {
    /// The part with this number; the number behind the last is that of the mechanism.
    fn declared(&self, owner: usize) -> Option<&'a Part> {
        self.catalogue.parts.get(owner).map(|entry| entry.part)
    }

    fn file_of(&self, owner: usize) -> usize {
        self.catalogue.parts.get(owner).map_or(0, |entry| entry.file)
    }

    fn families_of(&self, owner: usize) -> &Families {
        self.catalogue.parts.get(owner).map_or(&self.families, |entry| &entry.families)
    }

    fn block_of(&self, owner: usize) -> (&'a Block, Option<Span>) {
        match self.declared(owner) {
            Some(part) => (&part.block, Some(part.name.span)),
            None => (&self.root.block, None),
        }
    }

    /// The words of a block. `head` is the place of what it belongs to.
    fn template(&mut self, owner: usize, block: &Block, head: Option<Span>) -> Rc<Template> {
        let key = std::ptr::from_ref(block);
        if let Some(known) = self.templates.get(&key) {
            return known.clone();
        }
        let read = match head.is_none() && self.is_library {
            true => Template::default(),
            false => template(block, head, self.families_of(owner), self.catalogue),
        };
        self.sound &= read.mistakes.is_empty();
        let read = Rc::new(read);
        self.templates.insert(key, read.clone());
        read
    }

    /// The names that a part or the mechanism declares.
    fn space(&mut self, owner: usize) -> Space {
        let mut space = Space::new();
        match self.declared(owner) {
            Some(part) => space.extend(names_of_arguments(part).map(|name| (name.text.clone(), None))),
            None => space.extend(self.root.counts.iter().map(|count| (count.name.text.clone(), None))),
        }
        let mut open = vec![self.block_of(owner)];
        while let Some((block, head)) = open.pop() {
            let template = self.template(owner, block, head);
            space.extend(template.shared.iter().map(|shared| (shared.name.text.clone(), None)));
            let sections = template.declared().map(|(word, kind)| (first(word).text.clone(), Some(kind)));
            space.extend(sections);
            for item in &block.items {
                match item {
                    Item::Use(used) => drop(space.insert(used.name.text.clone(), None)),
                    Item::For(repeated) => open.push((&repeated.block, Some(repeated.span))),
                }
            }
        }
        space
    }

    fn scope(&self, owner: usize) -> (usize, Scope) {
        match self.declared(owner) {
            Some(part) => (self.file_of(owner), Scope::Part(part.name.text.clone())),
            None => (0, Scope::Mechanism),
        }
    }

    /// The number of a name.
    fn number(&mut self, file: usize, scope: Scope, text: &str) -> usize {
        let name = Owned { file: file as u32, scope, text: text.to_owned() };
        let names = &mut self.found.names;
        *self.known.entry(name.clone()).or_insert_with(|| {
            names.push(name);
            names.len() - 1
        })
    }

    /// The number of a name that a part or the mechanism declares.
    fn owned(&mut self, owner: usize, text: &str) -> usize {
        let (file, scope) = self.scope(owner);
        self.number(file, scope, text)
    }

    fn stands(&mut self, span: Span, names: Vec<usize>) {
        let place = self.places.find(span).unwrap_or_default();
        self.found.places.push(Standing { file: place.file, span: place.span, names, coordinate: None });
    }

    /// A name of a part or the mechanism stands at its own place.
    fn own(&mut self, owner: usize, name: &Name) {
        let number = self.owned(owner, &name.text);
        self.stands(name.span, vec![number]);
    }

    /// A name is used in a part or in the mechanism.
    fn refers(&mut self, owner: usize, indices: &Indices, text: &str, span: Span) {
        if let Some((_, begins)) = indices.iter().rev().find(|(index, _)| index == text) {
            let number = self.number(self.file_of(owner), Scope::Repetition(*begins), text);
            return self.stands(span, vec![number]);
        }
        if self.spaces[owner].contains_key(text) {
            let number = self.owned(owner, text);
            return self.stands(span, vec![number]);
        }
        // one contact of a pair of shapes, which is numbered: `foot_floor_2` of `foot_floor`
        let Some((pair, digits)) = text.rsplit_once('_') else { return };
        let numbered = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit());
        if numbered && self.spaces[owner].get(pair) == Some(&Some(Kind::Contact)) {
            let number = self.owned(owner, pair);
            self.stands(span, vec![number]);
            if let Some(place) = self.found.places.last_mut() {
                place.span.end = place.span.start + pair.len() as u32;
            }
        }
    }

    /// An expression of counts and indices.
    fn numbers(&mut self, owner: usize, indices: &Indices, tokens: &[Token]) {
        for token in tokens.iter().filter(|token| token.kind == TokenKind::Name) {
            self.refers(owner, indices, &token.text, token.span);
        }
    }

    /// A name through instances: each name behind a dot is one of the parts that what is before it may be of.
    fn path(&mut self, owner: usize, indices: &Indices, path: &Path) {
        let mut owners = vec![owner];
        for segment in &path.segments {
            let name = &segment.name;
            for tokens in &segment.indices {
                self.numbers(owner, indices, tokens);
            }
            if owners == [owner] {
                self.refers(owner, indices, &name.text, name.span);
            } else {
                self.member(&owners, name);
            }
            let mut next: Vec<usize> = Vec::new();
            for owner in &owners {
                next.extend(self.families_of(*owner).get(&name.text).into_iter().flatten());
            }
            next.sort_unstable();
            next.dedup();
            owners = next;
        }
    }

    fn member(&mut self, owners: &[usize], name: &Name) {
        let has = |owner: &&usize| self.spaces[**owner].contains_key(&name.text);
        let declaring: Vec<usize> = owners.iter().filter(has).copied().collect();
        match declaring.as_slice() {
            // a contact that is numbered, or none
            [] => owners.iter().for_each(|owner| self.refers(*owner, &Vec::new(), &name.text, name.span)),
            _ => {
                let names = declaring.iter().map(|owner| self.owned(*owner, &name.text)).collect();
                self.stands(name.span, names);
            }
        }
    }

    fn words(&mut self, owner: usize, indices: &Indices, words: &[Word]) {
        for word in words {
            match (&word.path, word.role) {
                (Some(path), _) => self.path(owner, indices, path),
                (None, Some(Role::Declared(_))) => {
                    let number = self.owned(owner, &word.token.text);
                    self.stands(word.token.span, vec![number]);
                }
                (None, Some(Role::Reference)) => {
                    self.refers(owner, indices, &word.token.text, word.token.span);
                }
                (None, None) => {}
            }
            if word.role == Some(Role::Declared(Kind::Coordinate)) {
                let whole = self.places.find(word.token.span).map(|place| place.span);
                let at = self.places.find(first(word).span).unwrap_or_default();
                let declared = |place: &&mut Standing| (place.file, place.span) == (at.file, at.span);
                if let Some(place) = self.found.places.iter_mut().rev().find(declared) {
                    place.coordinate = whole;
                }
            }
        }
    }

    /// An expression that is given for an argument or stands for one that is not given.
    fn expression(&mut self, owner: usize, indices: &Indices, tokens: &[Token]) {
        let mut mistakes = Vec::new();
        let words = expression(tokens, self.families_of(owner), self.catalogue, &mut mistakes);
        self.sound &= mistakes.is_empty();
        self.words(owner, indices, &words);
    }

    fn part(&mut self, owner: usize) {
        let Some(part) = self.declared(owner) else { return };
        let number = self.number(self.file_of(owner), Scope::File, &part.name.text);
        self.stands(part.name.span, vec![number]);
        for argument in &part.arguments {
            self.own(owner, &argument.name);
            match &argument.kind {
                ArgumentKind::Point { of: Some(of) } => self.own(owner, of),
                ArgumentKind::Count { default: Some(default) } => self.numbers(owner, &Vec::new(), default),
                ArgumentKind::Value { default: Some(default), .. } => {
                    self.expression(owner, &Vec::new(), default);
                }
                _ => {}
            }
        }
        let (block, head) = self.block_of(owner);
        self.block(owner, block, head, &mut Vec::new());
    }

    fn mechanism(&mut self) {
        let (owner, root) = (self.catalogue.parts.len(), self.root);
        for count in &root.counts {
            self.own(owner, &count.name);
            self.numbers(owner, &Vec::new(), &count.value);
        }
        self.block(owner, &root.block, None, &mut Vec::new());
    }

    fn block(&mut self, owner: usize, block: &'a Block, head: Option<Span>, indices: &mut Indices) {
        if indices.len() > MOST_DEPTH {
            self.sound = false;
            return;
        }
        let template = self.template(owner, block, head);
        for stretch in &template.stretches {
            self.words(owner, indices, &stretch.words);
        }
        for shared in &template.shared {
            self.own(owner, &shared.name);
            if self.used.contains(&owner) {
                let own = self.owned(owner, &shared.name.text);
                let outer = self.owned(self.catalogue.parts.len(), &shared.name.text);
                self.found.shared.push((own, outer));
            }
        }
        for item in &block.items {
            match item {
                Item::Use(used) => self.used(owner, indices, used),
                Item::For(repeated) => {
                    self.numbers(owner, indices, &repeated.from);
                    self.numbers(owner, indices, &repeated.to);
                    let variable = &repeated.variable;
                    let begins = self.places.find(variable.span).unwrap_or_default().span.start;
                    let number = self.number(self.file_of(owner), Scope::Repetition(begins), &variable.text);
                    self.stands(variable.span, vec![number]);
                    indices.push((variable.text.clone(), begins));
                    self.block(owner, &repeated.block, Some(repeated.span), indices);
                    indices.pop();
                }
            }
        }
    }

    /// The use of a part.
    fn used(&mut self, owner: usize, indices: &Indices, used: &Use) {
        self.own(owner, &used.name);
        used.indices.iter().for_each(|tokens| self.numbers(owner, indices, tokens));
        let Some(of) = self.catalogue.find(self.file_of(owner), &used.part.text) else {
            self.sound = false;
            return;
        };
        let number = self.number(self.file_of(of), Scope::File, &used.part.text);
        self.stands(used.part.span, vec![number]);
        let part = self.catalogue.parts[of].part;
        for actual in &used.actuals {
            if !self.spaces[of].contains_key(&actual.name.text) {
                self.sound = false;
                continue;
            }
            self.own(of, &actual.name);
            let kind = part.arguments.iter().find(|argument| argument.name.text == actual.name.text);
            match kind.map(|argument| &argument.kind) {
                Some(ArgumentKind::Count { .. }) => self.numbers(owner, indices, &actual.tokens),
                Some(ArgumentKind::Point { .. }) => {
                    let (point, of) = point_and_owner(&actual.tokens);
                    self.expression(owner, indices, point);
                    of.into_iter().for_each(|of| self.expression(owner, indices, of));
                }
                _ => self.expression(owner, indices, &actual.tokens),
            }
        }
    }
}

/// The name that a word begins with.
fn first(word: &Word) -> Name {
    match &word.path {
        Some(path) => path.segments[0].name.clone(),
        None => Name { text: word.token.text.clone(), span: word.token.span },
    }
}
