//! What each instance is given: names for points, frames and bodies, values for quantities.
//!
//! A name that is given takes the place of the argument. An expression becomes an entry of the model of its
//! own: a point or a frame for an argument of that kind, a definition for a quantity. A constant becomes a
//! `fixed` parameter, since it is counted in the unit of the argument; where that is 1 it stands in the place
//! of the argument.

use std::collections::HashMap;

use super::assembly::{Model, separator};
use super::count::Numbers;
use super::instances::{Member, own_quantities};
use super::outline::{Actual, Argument, ArgumentKind, Use};
use super::places::Place;
use super::resolve::{Bound, Meaning, Out, Resolver, bracketed, predefined};
use super::roles::{Kind, Role};
use super::template::{Template, Word, expression};
use super::text::shown;
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::suggest;
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::tree::{Name, Section};
use crate::syntax::units;

/// A value that a use gives to a quantity of its part.
#[derive(Clone, Debug)]
pub struct Given {
    /// its tokens
    pub tokens: Vec<Out>,
    /// it holds no names: it counts in the unit of the quantity
    pub is_constant: bool,
}

/// The values that uses give to quantities of each instance.
pub type GivenValues = Vec<HashMap<String, Given>>;

/// The entry of the model that an argument becomes.
struct Entry {
    section: Section,
    name: Out,
    /// what stands between the name and the value
    middle: Vec<Out>,
    value: Vec<Out>,
}

impl Resolver<'_, '_, '_> {
    /// Binds the arguments of all instances; what becomes an entry is added to the model.
    pub fn bind(&mut self, model: &mut Model) -> GivenValues {
        let mut values = GivenValues::new();
        for instance in 0..self.instances.list.len() {
            self.bindings.push(HashMap::new());
            values.push(HashMap::new());
            let Some((part, used)) =
                self.instances.list[instance].part.zip(self.instances.list[instance].used)
            else {
                continue;
            };
            let declared = self.instances.catalogue.parts[part].part;
            let template = self.instances.template(&declared.block, Some(declared.name.span), Some(part));
            self.share(instance, &template);
            for argument in &declared.arguments {
                let actual = used.actuals.iter().find(|actual| actual.name.text == argument.name.text);
                self.argument(instance, argument, actual, used, model);
            }
            let quantities: Vec<String> = own_quantities(&template).map(str::to_owned).collect();
            for actual in used.actuals.iter().filter(|actual| quantities.contains(&actual.name.text)) {
                let (tokens, is_constant) = self.value(instance, actual);
                values[instance].insert(actual.name.text.clone(), Given { tokens, is_constant });
            }
        }
        values
    }

    /// What an instance shares with the mechanism.
    fn share(&mut self, instance: usize, template: &Template) {
        for shared in &template.shared {
            let kind = if shared.section == Section::Inputs { Kind::Input } else { Kind::Parameter };
            let name = &shared.name;
            let key = (name.text.clone(), Vec::new());
            let found = match self.instances.list[0].members.get(&key) {
                Some(Member::Own { kind: found, span, .. }) if *found == kind => Some(*span),
                _ => None,
            };
            let Some(place) = found else {
                let what = kind.describe().split_once(' ').map_or("", |(_, word)| word);
                let message = format!("the mechanism has no {what} `{}` to share", name.text);
                let help = format!("declare it in the section `{}` of the mechanism", shared.section.word());
                self.instances.report(instance, codes::OUTER_NAME, name.span, message, &help);
                // so that nothing more is said of it
                self.bindings[instance].insert(name.text.clone(), Bound::Name(name.text.clone(), kind));
                continue;
            };
            self.agreement(instance, shared, place);
            self.bindings[instance].insert(name.text.clone(), Bound::Name(name.text.clone(), kind));
        }
    }

    /// The unit of what is shared measures what that of the mechanism measures.
    fn agreement(&mut self, instance: usize, shared: &super::template::Shared, place: Span) {
        let Some(run) = self.instances.runs.iter().find(|run| run.is_mechanism) else { return };
        let outer = run.template.units.get(&shared.name.text).and_then(|unit| units::read(unit).ok());
        let own = shared.unit.as_ref().map(units::read);
        match (own, outer) {
            (Some(Err(error)), _) => {
                let Some(mut error) = error else { return };
                error.primary.span = self.instances.at(error.primary.span, instance);
                self.instances.mistakes.push(*error);
            }
            (Some(Ok(own)), Some(outer)) if own.dimension != outer.dimension => {
                let message = format!(
                    "`{}` is shared in {}, but the mechanism has it in {}",
                    shared.name.text, own.text, outer.text
                );
                let span = self.instances.at(shared.name.span, instance);
                let error = Diagnostic::new(codes::DIMENSION, span, message);
                self.instances.mistakes.push(error.related(place, "that of the mechanism"));
            }
            _ => {}
        }
    }

    fn argument(
        &mut self,
        instance: usize,
        argument: &Argument,
        actual: Option<&Actual>,
        used: &Use,
        model: &mut Model,
    ) {
        match &argument.kind {
            // a number of the instance already
            ArgumentKind::Count { .. } => {}
            ArgumentKind::Value { unit, default } => {
                self.quantity(instance, argument, actual, unit, default, model)
            }
            ArgumentKind::Point { of } => {
                if let Some(actual) = actual {
                    self.point(instance, argument, of.as_ref(), actual, used, model);
                }
            }
            ArgumentKind::Frame | ArgumentKind::Body => {
                let Some(actual) = actual else { return };
                let is_frame = matches!(argument.kind, ArgumentKind::Frame);
                let fits: &[Kind] = if is_frame { &[Kind::Frame, Kind::Body] } else { &[Kind::Body] };
                let words = self.given_words(instance, &actual.tokens);
                if is_frame && !is_name(&words) {
                    let value = self.outer_words(instance, &words);
                    let place = self.outer_place(instance, actual.span());
                    let name = self.own_name(instance, &argument.name, Kind::Frame);
                    let middle = vec![Out { kind: TokenKind::Sign('='), text: String::new(), place }];
                    self.entry(model, Entry { section: Section::Frames, name, middle, value });
                } else {
                    self.named(instance, argument, &argument.name, &words, actual.span(), fits);
                }
            }
        }
    }

    /// A point, and what it belongs to.
    fn point(
        &mut self,
        instance: usize,
        argument: &Argument,
        of: Option<&Name>,
        actual: &Actual,
        used: &Use,
        model: &mut Model,
    ) {
        let (point, owner) = point_and_owner(&actual.tokens);
        let parent = self.instances.list[instance].parent;
        let mut body = None;
        match (of, owner) {
            (None, None) => {}
            (Some(name), Some(owner)) => {
                let words = self.given_words(instance, owner);
                let span = span_of(owner).unwrap_or(actual.span());
                body = self.named(instance, argument, name, &words, span, &[Kind::Frame, Kind::Body]);
            }
            (Some(_), None) => {
                let message =
                    format!("the argument `{}` takes a point of a body or frame", argument.name.text);
                let help =
                    format!("say to what it belongs: `{}: {} of ..`", argument.name.text, shown(point));
                self.wrong_argument(parent, actual.span(), message, argument, &help);
            }
            (None, Some(_)) => {
                let message = format!("the argument `{}` takes a point alone", argument.name.text);
                self.wrong_argument(
                    parent,
                    actual.span(),
                    message,
                    argument,
                    "remove `of` and what follows it",
                );
            }
        }
        let words = self.given_words(instance, point);
        if words.is_empty() {
            let message = format!("`{}` is given no point", argument.name.text);
            self.wrong_argument(parent, used.span, message, argument, "");
        } else if is_name(&words) {
            let span = span_of(point).unwrap_or(actual.span());
            self.named(instance, argument, &argument.name, &words, span, &[Kind::Point]);
        } else {
            let value = self.outer_words(instance, &words);
            let place = self.outer_place(instance, actual.span());
            let name = self.own_name(instance, &argument.name, Kind::Point);
            let sign = |kind, text: &str| Out { kind, text: text.to_owned(), place };
            let mut middle = Vec::new();
            if let Some(body) = body {
                middle.extend([sign(TokenKind::Name, "of"), sign(TokenKind::Name, &body)]);
            }
            middle.push(sign(TokenKind::Sign('='), ""));
            self.entry(model, Entry { section: Section::Points, name, middle, value });
        }
    }

    /// An argument for which a name is given; its name in the expanded model.
    fn named(
        &mut self,
        instance: usize,
        argument: &Argument,
        name: &Name,
        words: &[Word],
        span: Span,
        fits: &[Kind],
    ) -> Option<String> {
        let parent = self.instances.list[instance].parent;
        let outer = self.instances.list[instance].outer.clone();
        let [word] = words else {
            let message = format!("the argument `{}` takes {}", argument.name.text, argument.kind.describe());
            self.wrong_argument(parent, span, message, argument, "give its name");
            return None;
        };
        let (text, kind) = match self.meaning(parent, &outer, word) {
            Meaning::Name(text, kind) => (text, Some(kind)),
            Meaning::Wrong => return None,
            Meaning::Tokens(_) => (word.token.text.clone(), None),
            Meaning::Itself => match predefined(&word.token.text) {
                Some(kind) => (word.token.text.clone(), kind),
                None => {
                    let name = word.token.text.as_str();
                    let error = Diagnostic::new(codes::UNKNOWN_NAME, span, format!("unknown name `{name}`"));
                    let names = self.instances.list[parent].members.keys().map(|(name, _)| name.as_str());
                    let error = match suggest::nearest(name, names) {
                        Some(near) => error.did_you_mean(near),
                        None => error,
                    };
                    self.instances.push(parent, error);
                    return None;
                }
            },
        };
        if !kind.is_some_and(|kind| fits.contains(&kind)) {
            let is = kind.map_or("no name of that kind", Kind::describe);
            let message = format!(
                "the argument `{}` takes {}, but `{}` is {is}",
                argument.name.text,
                argument.kind.describe(),
                word.token.text
            );
            self.wrong_argument(parent, span, message, argument, "");
            return None;
        }
        let kind = kind.unwrap_or(Kind::Point);
        self.bindings[instance].insert(name.text.clone(), Bound::Name(text.clone(), kind));
        Some(text)
    }

    fn quantity(
        &mut self,
        instance: usize,
        argument: &Argument,
        actual: Option<&Actual>,
        unit: &[Token],
        default: &Option<Vec<Token>>,
        model: &mut Model,
    ) {
        let (value, is_constant) = match (actual, default) {
            (Some(actual), _) => self.value(instance, actual),
            (None, Some(default)) => {
                let mut found = Vec::new();
                let words = expression(default, &Default::default(), self.instances.catalogue, &mut found);
                self.instances.mistakes.extend(found);
                let numbers = self.instances.list[instance].numbers.clone();
                let before = self.instances.mistakes.len();
                let value = self.words(instance, &numbers, &words);
                if self.instances.mistakes.len() > before {
                    return;
                }
                if !is_constant(&value) {
                    let span = span_of(default).unwrap_or(argument.name.span);
                    let message = format!(
                        "the value that `{}` has if none is given must be a constant",
                        argument.name.text
                    );
                    let help = "numbers, `pi`, functions and counts may stand in it";
                    self.instances.report(instance, codes::CONSTANT, span, message, help);
                    return;
                }
                (value, true)
            }
            (None, None) => return,
        };
        // `+1` is 1
        let signed = value.len() == 2 && value[0].kind == TokenKind::Sign('+');
        let value = if signed { value[1..].to_vec() } else { value };
        let is_one = matches!(unit, [only] if only.kind == TokenKind::Number && only.text == "1");
        if is_one && is_constant {
            self.bindings[instance].insert(argument.name.text.clone(), Bound::Number(bracketed(value)));
            return;
        }
        let name = self.own_name(
            instance,
            &argument.name,
            if is_constant { Kind::Parameter } else { Kind::Definition },
        );
        let place = name.place;
        let mut middle = vec![Out { kind: TokenKind::Sign(':'), text: String::new(), place }];
        for token in unit {
            let place = self.place(instance, token);
            middle.push(Out { kind: token.kind, text: token.text.clone(), place });
        }
        middle.push(Out { kind: TokenKind::Sign('='), text: String::new(), place });
        let section = if is_constant { Section::Parameters } else { Section::Definitions };
        self.entry(model, Entry { section, name, middle, value });
    }

    /// A value that a use gives, and whether it is a constant.
    fn value(&mut self, instance: usize, actual: &Actual) -> (Vec<Out>, bool) {
        let words = self.given_words(instance, &actual.tokens);
        let value = self.outer_words(instance, &words);
        let constant = is_constant(&value);
        (value, constant)
    }

    /// The words of what is given to an instance.
    fn given_words(&mut self, instance: usize, tokens: &[Token]) -> Vec<Word> {
        let parent = self.instances.list[instance].parent;
        let catalogue = self.instances.catalogue;
        let families = match self.instances.list[parent].part {
            Some(part) => catalogue.parts[part].families.clone(),
            None => self.instances.families.clone(),
        };
        let mut found = Vec::new();
        let words = expression(tokens, &families, catalogue, &mut found);
        for mut error in found {
            error.primary.span = self.instances.at(error.primary.span, parent);
            self.instances.mistakes.push(error);
        }
        words
    }

    /// What is given to an instance, as tokens of the expanded model.
    fn outer_words(&mut self, instance: usize, words: &[Word]) -> Vec<Out> {
        let outer: Numbers = self.instances.list[instance].outer.clone();
        self.words(self.instances.list[instance].parent, &outer, words)
    }

    fn outer_place(&self, instance: usize, span: Span) -> Place {
        let parent = &self.instances.list[self.instances.list[instance].parent];
        self.instances.places.within(span, parent.site)
    }

    /// The name of an argument as an entry of the expanded model.
    fn own_name(&mut self, instance: usize, name: &Name, kind: Kind) -> Out {
        let owner = &self.instances.list[instance];
        let text = format!("{}_{}", owner.text, name.text);
        let written = format!("{}.{}", owner.shown, name.text);
        let place = self.instances.places.within(name.span, owner.site);
        self.bindings[instance].insert(name.text.clone(), Bound::Name(text.clone(), kind));
        let member = Member::Own { kind, text: text.clone(), span: name.span };
        self.instances.list[instance].members.insert((name.text.clone(), Vec::new()), member);
        self.instances.shown.insert(text.clone(), written);
        Out { kind: TokenKind::Name, text, place }
    }

    fn entry(&mut self, model: &mut Model, entry: Entry) {
        let place = entry.name.place;
        let separator = separator(entry.section);
        let mut tokens = Vec::new();
        if entry.section == Section::Parameters {
            tokens.push(Out { kind: TokenKind::Name, text: "fixed".to_owned(), place });
        }
        tokens.push(entry.name);
        tokens.extend(entry.middle);
        tokens.extend(entry.value);
        tokens.push(Out { kind: TokenKind::Sign(separator), text: String::new(), place });
        model.add(entry.section, tokens);
    }

    fn wrong_argument(
        &mut self,
        parent: usize,
        span: Span,
        message: String,
        argument: &Argument,
        help: &str,
    ) {
        let error = Diagnostic::new(codes::ARGUMENT_KIND, span, message)
            .related(argument.name.span, format!("`{}` is declared here", argument.name.text));
        self.instances.push(parent, if help.is_empty() { error } else { error.help(help) });
    }
}

/// Whether what is given is a name.
fn is_name(words: &[Word]) -> bool {
    matches!(words, [word] if word.token.kind == TokenKind::Name && word.role == Some(Role::Reference))
}

/// Whether tokens hold no name of a quantity.
fn is_constant(tokens: &[Out]) -> bool {
    tokens.iter().enumerate().all(|(i, token)| {
        let calls = tokens.get(i + 1).is_some_and(|next| next.kind == TokenKind::Open('('));
        token.kind != TokenKind::Name || token.text == "pi" || calls && token.text != "touching"
    })
}

/// What is given for a point, `P of B`, or the point alone.
pub fn point_and_owner(tokens: &[Token]) -> (&[Token], Option<&[Token]>) {
    let mut depth = 0_usize;
    let splits = tokens.iter().position(|token| {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && token.is_word("of")
    });
    match splits {
        Some(at) => (&tokens[..at], Some(&tokens[at + 1..])),
        None => (tokens, None),
    }
}

fn span_of(tokens: &[Token]) -> Option<Span> {
    Some(tokens.first()?.span.to(tokens.last()?.span))
}
