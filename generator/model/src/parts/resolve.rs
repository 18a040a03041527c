//! What the names in an instance of a part mean in the mechanism. A name means what the part declares, what
//! was given to it, what it shares with the mechanism, or what is predefined, and nothing else.

use std::collections::HashMap;

use super::count::{Numbers, number};
use super::instances::{Instances, Member, dotted};
use super::outline::names_of_arguments;
use super::places::Place;
use super::roles::{Kind, Role};
use super::template::{Path, Segment, Word};
use crate::diagnostics::{Diagnostic, Place as Change, codes};
use crate::suggest;
use crate::syntax::token::{Token, TokenKind};

/// A token of the expanded model.
#[derive(Clone, Debug)]
pub struct Out {
    /// what it is
    pub kind: TokenKind,
    /// its text
    pub text: String,
    /// where it comes from
    pub place: Place,
}

/// What was given for a name of a part.
#[derive(Clone, Debug)]
pub enum Bound {
    /// a name of the expanded model, and what it is
    Name(String, Kind),
    /// a plain number
    Number(Vec<Out>),
}

/// What is given to each instance, by name.
pub type Bindings = Vec<HashMap<String, Bound>>;

/// Names that are predefined.
pub fn predefined(name: &str) -> Option<Option<Kind>> {
    match name {
        "N" => Some(Some(Kind::Frame)),
        "O" => Some(Some(Kind::Point)),
        "time" | "pi" => Some(None),
        _ => None,
    }
}

/// What a name means.
#[derive(Clone, Debug)]
pub enum Meaning {
    /// a name of the expanded model
    Name(String, Kind),
    /// other tokens
    Tokens(Vec<Out>),
    /// what it says: it is predefined, or declared nowhere
    Itself,
    /// a message says what is wrong
    Wrong,
}

/// Resolves names.
pub struct Resolver<'r, 'a, 'p> {
    /// the instances
    pub instances: &'r mut Instances<'a, 'p>,
    /// what is given to them
    pub bindings: Bindings,
}

impl Resolver<'_, '_, '_> {
    /// The words of an instance as tokens of the expanded model.
    pub fn words(&mut self, instance: usize, numbers: &Numbers, words: &[Word]) -> Vec<Out> {
        let mut out = Vec::with_capacity(words.len());
        for word in words {
            let place = self.place(instance, &word.token);
            let plain = |text: String| Out { kind: word.token.kind, text, place };
            match word.role {
                None if word.path.is_none() => out.push(plain(word.token.text.clone())),
                Some(Role::Declared(_)) => out.push(plain(self.declared(instance, numbers, word))),
                _ => match self.meaning(instance, numbers, word) {
                    Meaning::Name(text, _) => out.push(plain(text)),
                    Meaning::Tokens(tokens) => out.extend(tokens),
                    Meaning::Itself | Meaning::Wrong => out.push(plain(word.token.text.clone())),
                },
            }
        }
        out
    }

    /// The place of a token of an instance.
    pub fn place(&self, instance: usize, token: &Token) -> Place {
        let site = self.instances.list[instance].site;
        self.instances.places.within(token.span, site)
    }

    /// The name that a word declares, in the expanded model.
    fn declared(&mut self, instance: usize, numbers: &Numbers, word: &Word) -> String {
        let key = match &word.path {
            None => (word.token.text.clone(), Vec::new()),
            Some(path) => {
                let segment = &path.segments[0];
                let values = self.instances.indices(instance, &segment.name, &segment.indices, numbers);
                (segment.name.text.clone(), values.unwrap_or_default())
            }
        };
        match self.instances.list[instance].members.get(&key) {
            Some(Member::Own { text, .. }) => text.clone(),
            _ => word.token.text.clone(),
        }
    }

    /// What a word refers to.
    pub fn meaning(&mut self, instance: usize, numbers: &Numbers, word: &Word) -> Meaning {
        if let Some(path) = &word.path {
            return self.path(instance, numbers, word, path);
        }
        let name = word.token.text.as_str();
        if let Some(value) = number(numbers, name) {
            let place = self.place(instance, &word.token);
            return Meaning::Tokens(self::whole(value, place));
        }
        match self.bindings.get(instance).and_then(|bindings| bindings.get(name)) {
            Some(Bound::Name(text, kind)) => return Meaning::Name(text.clone(), *kind),
            Some(Bound::Number(tokens)) => {
                let place = self.place(instance, &word.token);
                return Meaning::Tokens(tokens.iter().map(|token| Out { place, ..token.clone() }).collect());
            }
            None => {}
        }
        match self.instances.list[instance].members.get(&(name.to_owned(), Vec::new())) {
            Some(Member::Own { text, kind, .. }) => return Meaning::Name(text.clone(), *kind),
            Some(Member::Instance(other, _)) => {
                let other = *other;
                return self.whole_instance(instance, word, other);
            }
            None => {}
        }
        if predefined(name).is_some() {
            return Meaning::Itself;
        }
        if let Some(text) = self.one_of_several(instance, name) {
            return Meaning::Name(text, Kind::Point);
        }
        let (name, span) = (name.to_owned(), word.token.span);
        let indexed: Vec<String> = self.indexed(instance, &name).take(3).collect();
        if !indexed.is_empty() {
            let message = format!("`{name}` needs an index");
            let help = format!("there are {}", indexed.join(", "));
            self.instances.report(instance, codes::INDEX, span, message, &help);
            return Meaning::Wrong;
        }
        // what is declared nowhere is reported where names are resolved, unless it would mean something there
        let Some(outside) = self.instances.shown.get(&name).cloned() else {
            self.note_near(instance, word);
            return Meaning::Itself;
        };
        let (message, help) = match self.instances.list[instance].part {
            None => (
                format!("{name} is what `{outside}` is called in generated code"),
                format!("write `{outside}`"),
            ),
            Some(part) => {
                let part = &self.instances.catalogue.parts[part].part.name.text;
                let message =
                    format!("the part `{part}` declares no `{name}`, and does not see that of the mechanism");
                let help = format!(
                    "give it to the part as an argument, or, if it is a parameter or an input, declare it in the part as \
                     `shared {name}: ..`"
                );
                (message, help)
            }
        };
        self.instances.report(instance, codes::OUTER_NAME, span, message, &help);
        Meaning::Wrong
    }

    /// Notes which name of a part may be meant by one that it does not declare.
    fn note_near(&mut self, instance: usize, word: &Word) {
        if self.instances.list[instance].part.is_none() {
            return;
        }
        let own = self.instances.list[instance].members.keys().map(|(name, _)| name.as_str());
        let given = self.bindings.get(instance).into_iter().flat_map(HashMap::keys).map(String::as_str);
        if let Some(near) = suggest::nearest(&word.token.text, own.chain(given)).map(str::to_owned) {
            let Place { file, span, .. } = self.place(instance, &word.token);
            self.instances.near.insert((file, span), near);
        }
    }

    /// The name of one contact of a pair of shapes, which is numbered: `foot_floor_2` of `foot_floor`.
    fn one_of_several(&self, instance: usize, name: &str) -> Option<String> {
        let (pair, number) = name.rsplit_once('_')?;
        number.bytes().all(|digit| digit.is_ascii_digit()).then_some(())?;
        match self.instances.list[instance].members.get(&(pair.to_owned(), Vec::new())) {
            Some(Member::Own { text, kind: Kind::Contact, .. }) => Some(format!("{text}_{number}")),
            _ => None,
        }
    }

    /// An instance where one of its names is needed.
    fn whole_instance(&mut self, instance: usize, word: &Word, other: usize) -> Meaning {
        let other = &self.instances.list[other];
        let part = other.part.map_or("", |part| &self.instances.catalogue.parts[part].part.name.text);
        let message = format!("`{}` is an instance of the part `{part}`", word.token.text);
        let example = other
            .members
            .keys()
            .next()
            .map_or("name".to_owned(), |(name, indices)| dotted("", name, indices));
        let help = format!("name something that it has, as in `{}.{example}`", word.token.text);
        self.instances.report(instance, codes::WRONG_KIND, word.token.span, message, &help);
        Meaning::Wrong
    }

    /// The names of an instance that differ in their indices only.
    fn indexed(&self, instance: usize, name: &str) -> impl Iterator<Item = String> {
        let members = &self.instances.list[instance].members;
        let from = (name.to_owned(), Vec::new());
        let found = members.range(from..).take_while(move |((other, _), _)| other == name);
        found
            .filter(|((_, indices), _)| !indices.is_empty())
            .map(|((name, indices), _)| dotted("", name, indices))
    }

    fn path(&mut self, instance: usize, numbers: &Numbers, word: &Word, path: &Path) -> Meaning {
        let mut current = instance;
        let mut way = String::new();
        for (i, segment) in path.segments.iter().enumerate() {
            let name = &segment.name.text;
            let Some(indices) = self.instances.indices(instance, &segment.name, &segment.indices, numbers)
            else {
                return Meaning::Wrong;
            };
            let key = (name.clone(), indices);
            let last = i + 1 == path.segments.len();
            let here = dotted(&way, name, &key.1);
            match self.instances.list[current].members.get(&key) {
                Some(Member::Own { text, kind, .. }) if last => return Meaning::Name(text.clone(), *kind),
                Some(Member::Instance(other, _)) if !last => current = *other,
                Some(Member::Instance(other, _)) => {
                    let other = *other;
                    return self.whole_instance(instance, word, other);
                }
                Some(Member::Own { kind, .. }) => {
                    let message = format!("`{here}` is {}, which has no names of its own", kind.describe());
                    self.instances.report(instance, codes::WRONG_KIND, word.token.span, message, "");
                    return Meaning::Wrong;
                }
                None => {
                    let numbered =
                        if last && key.1.is_empty() { self.one_of_several(current, name) } else { None };
                    if let Some(text) = numbered {
                        return Meaning::Name(text, Kind::Point);
                    }
                    self.no_member(instance, current, word, segment, &here, &key);
                    return Meaning::Wrong;
                }
            }
            way = here;
        }
        Meaning::Wrong
    }

    /// Says that an instance has no such name.
    fn no_member(
        &mut self,
        instance: usize,
        current: usize,
        word: &Word,
        segment: &Segment,
        here: &str,
        key: &(String, Vec<i64>),
    ) {
        let span = word.token.span;
        let (name, indices) = key;
        let others: Vec<String> = self.indexed(current, name).collect();
        let plain = self.instances.list[current].members.contains_key(&(name.clone(), Vec::new()));
        if !others.is_empty() || plain && !indices.is_empty() {
            let help = match others.as_slice() {
                [] => format!("`{name}` has no index"),
                [only] => format!("there is `{only}` only"),
                [first, .., last] => format!("there are `{first}` to `{last}`, {} of them", others.len()),
            };
            self.instances.report(instance, codes::INDEX, span, format!("there is no `{here}`"), &help);
            return;
        }
        let place = match self.instances.list[current].part {
            None => "the mechanism".to_owned(),
            Some(part) => format!("the part `{}`", self.instances.catalogue.parts[part].part.name.text),
        };
        let given = match self.instances.list[current].part.filter(|_| current != instance) {
            Some(part) => names_of_arguments(self.instances.catalogue.parts[part].part)
                .any(|argument| argument.text == *name),
            None => false,
        };
        let names = self.instances.list[current].members.keys().map(|(name, _)| name.as_str());
        let error = Diagnostic::new(codes::UNKNOWN_NAME, span, format!("{place} declares no `{name}`"));
        let error = match suggest::nearest(name, names) {
            _ if given => error.help("it is an argument: name what was given for it"),
            Some(near) => {
                let at = segment.name.span;
                error.help(format!("did you mean `{near}`?")).fix(Change::Replace(at), near)
            }
            None => error,
        };
        self.instances.push(instance, error);
    }
}

/// A whole number as tokens.
pub fn whole(value: i64, place: Place) -> Vec<Out> {
    let digits = Out { kind: TokenKind::Number, text: value.unsigned_abs().to_string(), place };
    if value >= 0 {
        return vec![digits];
    }
    bracketed(vec![Out { kind: TokenKind::Sign('-'), text: String::new(), place }, digits])
}

/// Tokens between brackets, unless they are one.
pub fn bracketed(tokens: Vec<Out>) -> Vec<Out> {
    let (Some(first), true) = (tokens.first(), tokens.len() > 1) else { return tokens };
    let bracket = |kind| Out { kind, text: String::new(), place: first.place };
    let (open, close) = (bracket(TokenKind::Open('(')), bracket(TokenKind::Close(')')));
    std::iter::once(open).chain(tokens).chain([close]).collect()
}
