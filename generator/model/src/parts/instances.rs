//! The instances of parts in a mechanism: each use and each turn of a repetition, the names that it declares,
//! and the whole numbers that it is given.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use super::catalogue::{Catalogue, Families};
use super::count::{Numbers, evaluate};
use super::given;
use super::outline::{ArgumentKind, Block, For, Item, Use, names_of_arguments};
use super::places::Places;
use super::roles::Kind;
use super::template::{Shared, Template, template};
use crate::diagnostics::{Code, Diagnostic, codes};
use crate::span::Span;
use crate::syntax::tree::Name;

/// A mechanism has at most this many instances and turns of repetitions.
pub const MOST_INSTANCES: usize = 10_000;
/// Parts and repetitions stand within each other at most this deep.
pub const MOST_DEPTH: usize = 64;

/// A name with its indices.
pub type Key = (String, Vec<i64>);

/// What a name of an instance stands for.
#[derive(Clone, Debug)]
pub enum Member {
    /// something that it declares
    Own {
        /// what
        kind: Kind,
        /// its name in the expanded model
        text: String,
        /// where it is declared
        span: Span,
    },
    /// another instance
    Instance(usize, Span),
}

impl Member {
    /// Where it is declared.
    pub fn span(&self) -> Span {
        match self {
            Member::Own { span, .. } | Member::Instance(_, span) => *span,
        }
    }
}

/// An instance of a part; the first is the mechanism itself.
#[derive(Debug)]
pub struct Instance<'a> {
    /// the part
    pub part: Option<usize>,
    /// the instance that uses it
    pub parent: usize,
    /// the use
    pub used: Option<&'a Use>,
    /// the same, for places
    pub site: Option<u32>,
    /// what the names of its expanded model begin with
    pub text: String,
    /// the same with dots
    pub shown: String,
    /// counts that it is given
    pub numbers: Numbers,
    /// counts and indices where it is used
    pub outer: Numbers,
    /// its names
    pub members: BTreeMap<Key, Member>,
}

/// A block that is to be written into the model.
#[derive(Clone, Debug)]
pub struct Run {
    /// for this instance
    pub instance: usize,
    /// its words
    pub template: Rc<Template>,
    /// counts and indices
    pub numbers: Numbers,
    /// it is that of the mechanism itself
    pub is_mechanism: bool,
}

/// All instances and what they write, in the order of the model.
pub struct Instances<'a, 'p> {
    /// the parts
    pub catalogue: &'a Catalogue<'a>,
    /// the places
    pub places: &'p mut Places,
    /// what is wrong
    pub mistakes: Vec<Diagnostic>,
    /// instances
    pub list: Vec<Instance<'a>>,
    /// what they write
    pub runs: Vec<Run>,
    /// each name of the expanded model, with the same as it is written outside
    pub shown: HashMap<String, String>,
    /// for names that a part does not declare, by file and place, those that may be meant
    pub near: HashMap<(u32, Span), String>,
    /// the instances that the mechanism itself uses
    pub families: Families,
    root: &'a Block,
    templates: HashMap<*const Block, Rc<Template>>,
    /// the indices of repetitions, each with the instance in which it is
    repeated: Vec<(usize, &'a Name)>,
    /// places of which something was said that is the same for all instances
    said: HashSet<Span>,
    /// instances and turns of repetitions so far
    pub turns: usize,
    /// how many words they write so far, and may write
    length: usize,
    most: usize,
    /// there are too many
    pub full: bool,
}

impl<'a, 'p> Instances<'a, 'p> {
    /// All instances of a mechanism with these counts, which write at most so many words.
    pub fn new(
        block: &'a Block,
        numbers: Numbers,
        catalogue: &'a Catalogue<'a>,
        places: &'p mut Places,
        most: usize,
    ) -> Self {
        let mechanism = Instance {
            part: None,
            parent: 0,
            used: None,
            site: None,
            text: String::new(),
            shown: String::new(),
            numbers: numbers.clone(),
            outer: Numbers::new(),
            members: BTreeMap::new(),
        };
        let mut instances = Instances {
            catalogue,
            places,
            mistakes: Vec::new(),
            list: vec![mechanism],
            runs: Vec::new(),
            shown: HashMap::new(),
            near: HashMap::new(),
            families: catalogue.families(block, 0),
            root: block,
            templates: HashMap::new(),
            repeated: Vec::new(),
            said: HashSet::new(),
            turns: 0,
            length: 0,
            most,
            full: false,
        };
        instances.block(0, block, numbers, None, 0);
        instances.shadowing_indices();
        instances
    }

    /// Says so where an index hides something that has its name.
    fn shadowing_indices(&mut self) {
        for (instance, index) in std::mem::take(&mut self.repeated) {
            let key = (index.text.clone(), Vec::new());
            let member = self.list[instance].members.get(&key).map(Member::span);
            let part = self.list[instance].part.map(|part| self.catalogue.parts[part].part);
            // a count that is given may be the index of what it counts
            let arguments = part.into_iter().flat_map(|part| &part.arguments);
            let arguments = arguments.filter(|argument| !matches!(argument.kind, ArgumentKind::Count { .. }));
            let argument = arguments.map(|argument| &argument.name).find(|name| name.text == index.text);
            let shared = self.runs.iter().filter(|run| run.instance == instance);
            let shared = shared.flat_map(|run| &run.template.shared).map(|shared| &shared.name);
            let shared = shared.into_iter().find(|name| name.text == index.text);
            let Some(place) = member.or(argument.or(shared).map(|name| name.span)) else { continue };
            // in the turns of the repetition this is said where it is declared
            if self.said.contains(&place) {
                continue;
            }
            let message = format!("the name `{}` is declared twice", index.text);
            let error = Diagnostic::new(codes::DUPLICATE_NAME, index.span, message);
            let error = error.related(place, "the other is here").help("choose another name for the index");
            self.report_once(instance, error);
        }
    }

    /// The file in which the text of an instance stands.
    pub fn file(&self, instance: usize) -> usize {
        self.list[instance].part.map_or(0, |part| self.catalogue.parts[part].file)
    }

    /// The words of a block; read once. `head` is the name of its part.
    pub fn template(&mut self, block: &'a Block, head: Option<Span>, part: Option<usize>) -> Rc<Template> {
        let key = std::ptr::from_ref(block);
        if let Some(known) = self.templates.get(&key) {
            return known.clone();
        }
        let catalogue = self.catalogue;
        let families = match part {
            Some(part) => &catalogue.parts[part].families,
            None => &self.families,
        };
        let read = Rc::new(template(block, head, families, catalogue));
        self.templates.insert(key, read.clone());
        read
    }

    /// The mistakes of syntax in all parts, used or not, and in the mechanism.
    pub fn syntax(&mut self) -> Vec<Diagnostic> {
        let catalogue = self.catalogue;
        let mut open: Vec<(&'a Block, Option<Span>, Option<usize>)> = vec![(self.root, None, None)];
        for (i, entry) in catalogue.parts.iter().enumerate() {
            open.push((&entry.part.block, Some(entry.part.name.span), Some(i)));
        }
        let mut found = Vec::new();
        while let Some((block, head, part)) = open.pop() {
            // a file of parts alone has no mechanism
            if head.is_some() || !block.chunks.is_empty() {
                found.extend(self.template(block, head, part).mistakes.iter().cloned());
            }
            for item in &block.items {
                if let Item::For(repeated) = item {
                    open.push((&repeated.block, Some(repeated.span), part));
                }
            }
        }
        found.sort_by_key(|mistake| mistake.primary.span);
        found
    }

    /// A span for a place of a file, as part of an instance.
    pub fn at(&mut self, span: Span, instance: usize) -> Span {
        let site = self.list[instance].site;
        if site.is_none() {
            return span;
        }
        let place = self.places.within(span, site);
        self.places.add(place)
    }

    /// Reports a mistake at a place of an instance.
    pub fn report(&mut self, instance: usize, code: Code, span: Span, message: String, help: &str) {
        let error = Diagnostic::new(code, span, message);
        self.push(instance, if help.is_empty() { error } else { error.help(help) });
    }

    /// Reports a mistake whose place is that of the text of an instance.
    pub fn push(&mut self, instance: usize, mut error: Diagnostic) {
        error.primary.span = self.at(error.primary.span, instance);
        self.mistakes.push(error);
    }

    /// As [`Instances::report`], but once for all instances.
    pub fn report_once(&mut self, instance: usize, error: Diagnostic) {
        if self.said.insert(error.primary.span) {
            self.push(instance, error);
        }
    }

    /// The value of an expression of counts in an instance.
    pub fn number(
        &mut self,
        instance: usize,
        tokens: &[crate::syntax::token::Token],
        numbers: &Numbers,
        at: Span,
    ) -> Option<i64> {
        match evaluate(tokens, numbers, at) {
            Ok(value) => Some(value),
            Err(mut error) => {
                error.primary.span = self.at(error.primary.span, instance);
                self.mistakes.push(*error);
                None
            }
        }
    }

    /// The indices of a name.
    pub fn indices(
        &mut self,
        instance: usize,
        name: &Name,
        indices: &[Vec<crate::syntax::token::Token>],
        numbers: &Numbers,
    ) -> Option<Vec<i64>> {
        let mut values = Vec::new();
        for tokens in indices {
            values.push(self.number(instance, tokens, numbers, name.span)?);
        }
        Some(values)
    }

    /// Adds a block, and all that it uses. `head` is the place of what it belongs to.
    pub fn block(
        &mut self,
        instance: usize,
        block: &'a Block,
        numbers: Numbers,
        head: Option<Span>,
        depth: usize,
    ) {
        if depth > MOST_DEPTH {
            let span = head.unwrap_or_default();
            let message = format!("parts and repetitions are nested more than {MOST_DEPTH} deep");
            self.report(instance, codes::TOO_DEEP, span, message, "");
            self.full = true;
            return;
        }
        let part = self.list[instance].part;
        let template = self.template(block, head, part);
        self.length += template.stretches.iter().map(|stretch| stretch.words.len()).sum::<usize>();
        if self.length > self.most {
            let span = head.unwrap_or_default();
            let message = format!("the model has more than {} words and signs with this", self.most);
            self.report(instance, codes::REPETITION, span, message, "");
            self.full = true;
            return;
        }
        self.declare(instance, &template, &numbers);
        let is_mechanism = instance == 0 && head.is_none();
        self.runs.push(Run { instance, template, numbers: numbers.clone(), is_mechanism });
        for item in &block.items {
            if self.full {
                return;
            }
            match item {
                Item::Use(used) => self.instance(instance, used, &numbers, depth),
                Item::For(repeated) => self.repetition(instance, repeated, &numbers, depth),
            }
        }
    }

    /// Notes the names that a block declares.
    fn declare(&mut self, instance: usize, template: &Rc<Template>, numbers: &Numbers) {
        for (word, kind) in template.declared() {
            let (name, indices) = match &word.path {
                None => (Name { text: word.token.text.clone(), span: word.token.span }, Vec::new()),
                Some(path) if path.segments.len() == 1 => {
                    let segment = &path.segments[0];
                    let Some(values) = self.indices(instance, &segment.name, &segment.indices, numbers)
                    else {
                        continue;
                    };
                    (Name { text: segment.name.text.clone(), span: word.token.span }, values)
                }
                Some(_) => {
                    let message = format!("`{}` cannot be declared here", word.token.text);
                    let help = "what an instance has is declared in its part";
                    self.report(instance, codes::RESERVED_NAME, word.token.span, message, help);
                    continue;
                }
            };
            if !self.is_index(instance, &name, &indices) {
                continue;
            }
            if super::count::number(numbers, &name.text).is_some() {
                let message = format!("the name `{}` is that of a count or an index", name.text);
                let error = Diagnostic::new(codes::DUPLICATE_NAME, name.span, message);
                self.report_once(instance, error.help("choose another name"));
                continue;
            }
            // names of the mechanism are looked at where all are collected
            if let Some(error) = given::predefined(&name).filter(|_| instance > 0 && indices.is_empty()) {
                self.report_once(instance, error);
                continue;
            }
            let text = joined(&self.list[instance].text, &name.text, &indices);
            let shown = dotted(&self.list[instance].shown, &name.text, &indices);
            let span = name.span;
            self.free(instance, &name, &indices, &template.shared);
            let member = Member::Own { kind, text: text.clone(), span };
            self.list[instance].members.entry((name.text, indices)).or_insert(member);
            self.shown.insert(text, shown);
        }
    }

    /// Whether these can be indices; says so where they cannot.
    pub fn is_index(&mut self, instance: usize, name: &Name, indices: &[i64]) -> bool {
        let Some(index) = indices.iter().find(|index| **index < 0) else { return true };
        let message = format!("`{}[{index}]` has an index below 0", name.text);
        self.report(instance, codes::INDEX, name.span, message, "indices begin with 0");
        false
    }

    /// Says so if a name is taken in its part.
    pub fn free(&mut self, instance: usize, name: &Name, indices: &[i64], shared: &[Shared]) {
        let taken = |message: &str, place: Span, help: &str| {
            let error = Diagnostic::new(codes::DUPLICATE_NAME, name.span, message);
            error.related(place, "first declared here").help(help)
        };
        let other = "all names of a part share one name space: choose another name";
        let twice = format!("the name `{}` is declared twice", dotted("", &name.text, indices));
        if let Some(member) = self.list[instance].members.get(&(name.text.clone(), indices.to_vec())) {
            let place = member.span();
            let error = if place == name.span {
                let message = format!("`{}` is declared anew for each value of the index", name.text);
                let help =
                    format!("give it the index: `{}[i]` where `i` is the index of the `for`", name.text);
                Diagnostic::new(codes::DUPLICATE_NAME, name.span, message).help(help)
            } else {
                taken(&twice, place, other)
            };
            self.report_once(instance, error);
            return;
        }
        let catalogue = self.catalogue;
        let part = self.list[instance].part.map(|part| catalogue.parts[part].part);
        let arguments = part.into_iter().flat_map(names_of_arguments);
        let given = arguments.chain(shared.iter().map(|shared| &shared.name));
        let place = given.into_iter().find(|given| given.text == name.text).map(|given| given.span);
        if let Some(place) = place {
            let error = taken(&twice, place, other);
            self.report_once(instance, error);
        }
    }

    fn repetition(&mut self, instance: usize, repeated: &'a For, numbers: &Numbers, depth: usize) {
        let from = self.number(instance, &repeated.from, numbers, repeated.span);
        let to = self.number(instance, &repeated.to, numbers, repeated.span);
        let (Some(from), Some(to)) = (from, to) else { return };
        let most = (MOST_INSTANCES - self.turns.min(MOST_INSTANCES)) as i64;
        if to - from >= most {
            let message = format!(
                "the index takes the values {from} to {to}: a mechanism has at most {MOST_INSTANCES} instances and turns of \
                 repetitions"
            );
            self.report(instance, codes::REPETITION, repeated.span, message, "");
            self.full = true;
            return;
        }
        if !self.repeated.iter().any(|known| known.0 == instance && std::ptr::eq(known.1, &repeated.variable))
        {
            self.repeated.push((instance, &repeated.variable));
        }
        for index in from..=to {
            self.turns += 1;
            let mut numbers = numbers.clone();
            numbers.push((repeated.variable.text.clone(), index));
            self.block(instance, &repeated.block, numbers, Some(repeated.span), depth + 1);
            if self.full {
                return;
            }
        }
    }
}

/// The quantities of a part that a use may give values to.
pub fn own_quantities(template: &Template) -> impl Iterator<Item = &str> {
    let quantity =
        |kind: Kind| matches!(kind, Kind::Parameter | Kind::Input | Kind::Coordinate | Kind::Speed);
    let plain = template.declared().filter(move |(word, kind)| word.path.is_none() && quantity(*kind));
    plain.map(|(word, _)| word.token.text.as_str())
}

/// A name of the expanded model: `front_left_knee`, `link_3_tip`.
pub fn joined(before: &str, name: &str, indices: &[i64]) -> String {
    let mut text = if before.is_empty() { name.to_owned() } else { format!("{before}_{name}") };
    indices.iter().for_each(|index| text.push_str(&format!("_{index}")));
    text
}

/// The same as it is written in models: `front_left.knee`, `link[3].tip`.
pub fn dotted(before: &str, name: &str, indices: &[i64]) -> String {
    let mut text = if before.is_empty() { name.to_owned() } else { format!("{before}.{name}") };
    indices.iter().for_each(|index| text.push_str(&format!("[{index}]")));
    text
}
