//! Writes the expanded model: the sections of the mechanism, each with the entries of all instances behind its
//! own, in the order of the uses.

use std::collections::BTreeMap;

use super::bind::{Given, GivenValues};
use super::places::{Place, Places};
use super::resolve::{Out, Resolver};
use super::roles::{Kind, Role};
use super::template::{Stretch, Word};
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::tree::Section;

/// What separates the entries of a section.
pub fn separator(section: Section) -> char {
    use Section::*;
    match section {
        Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Contacts => ',',
        _ => ';',
    }
}

/// A model on its way.
#[derive(Debug, Default)]
pub struct Model {
    /// the entries of instances
    added: BTreeMap<Section, Vec<Out>>,
    /// the stretches of the mechanism
    own: Vec<Own>,
    /// how many tokens there are
    length: usize,
}

/// A stretch of the mechanism.
#[derive(Debug)]
struct Own {
    section: Option<Section>,
    head: Vec<Out>,
    inner: Vec<Out>,
    close: Option<Out>,
}

impl Model {
    /// Adds entries of an instance.
    pub fn add(&mut self, section: Section, tokens: Vec<Out>) {
        self.length += tokens.len();
        self.added.entry(section).or_default().extend(tokens);
    }

    /// The tokens of the model.
    pub fn tokens(mut self, places: &mut Places) -> Vec<Token> {
        let mut tokens = Vec::with_capacity(self.length + 100);
        let own = std::mem::take(&mut self.own);
        for (i, stretch) in own.iter().enumerate() {
            if let Some(section) = stretch.section {
                // sections that the mechanism does not have stand where they belong
                let later = |other: &Section| own[i..].iter().any(|stretch| stretch.section == Some(*other));
                let missing: Vec<Section> =
                    self.added.keys().copied().filter(|other| *other < section && !later(other)).collect();
                missing.into_iter().for_each(|section| self.whole(section, &mut tokens));
            }
            tokens.extend(stretch.head.iter().cloned());
            tokens.extend(stretch.inner.iter().cloned());
            if let Some(added) =
                stretch.section.and_then(|section| self.added.remove(&section).map(|added| (section, added)))
            {
                let (section, added) = added;
                let sign = separator(section);
                let place = stretch.inner.last().map(|last| (last.place, last.kind == TokenKind::Sign(sign)));
                if let Some((place, false)) = place {
                    tokens.push(Out { kind: TokenKind::Sign(sign), text: String::new(), place });
                }
                tokens.extend(added);
            }
            tokens.extend(stretch.close.iter().cloned());
        }
        let left: Vec<Section> = self.added.keys().copied().collect();
        left.into_iter().for_each(|section| self.whole(section, &mut tokens));
        let token = |out: Out| Token { kind: out.kind, span: places.add(out.place), text: out.text };
        tokens.into_iter().map(token).collect()
    }

    /// A section of entries of instances alone.
    fn whole(&mut self, section: Section, tokens: &mut Vec<Out>) {
        let Some(added) = self.added.remove(&section) else { return };
        let place = added.first().map_or(Place::default(), |first| first.place);
        let sign = |kind| Out { kind, text: String::new(), place };
        tokens.push(Out { kind: TokenKind::Name, text: section.word().to_owned(), place });
        tokens.push(sign(TokenKind::Open('{')));
        tokens.extend(added);
        tokens.push(sign(TokenKind::Close('}')));
    }
}

impl Resolver<'_, '_, '_> {
    /// Writes all blocks; false where the model would have more than `most` tokens, with the block at which it
    /// has.
    pub fn write(&mut self, values: &GivenValues, most: usize, model: &mut Model) -> Result<(), usize> {
        let runs = self.instances.runs.clone();
        for run in &runs {
            for stretch in &run.template.stretches {
                if run.is_mechanism {
                    let inner = self.words(run.instance, &run.numbers, &stretch.words);
                    let out = |token: &Token, resolver: &Self| Out {
                        kind: token.kind,
                        text: token.text.clone(),
                        place: resolver.place(0, token),
                    };
                    let head = stretch.head.iter().map(|token| out(token, self)).collect();
                    let close = stretch.close.as_ref().map(|token| out(token, self));
                    model.length += inner.len();
                    model.own.push(Own { section: stretch.section, head, inner, close });
                } else {
                    self.stretch(run.instance, &run.numbers, stretch, &values[run.instance], model);
                }
                if model.length > most {
                    return Err(run.instance);
                }
            }
        }
        Ok(())
    }

    /// The entries of a section of an instance.
    fn stretch(
        &mut self,
        instance: usize,
        numbers: &super::count::Numbers,
        stretch: &Stretch,
        given: &std::collections::HashMap<String, Given>,
        model: &mut Model,
    ) {
        let Some(section) = stretch.section else { return };
        let sign = separator(section);
        for entry in entries(&stretch.words, sign) {
            let ended = entry.last().is_some_and(|word| word.token.is_sign(sign));
            let words = &entry[..entry.len() - usize::from(ended)];
            let Some(last) = words.last() else { continue };
            let place = self.place(instance, &last.token);
            let end = Out { kind: TokenKind::Sign(sign), text: String::new(), place };
            let value = declared(words).and_then(|(name, kind)| Some((given.get(name)?, kind)));
            let Some((value, kind)) = value else {
                let mut tokens = self.words(instance, numbers, words);
                tokens.push(end);
                model.add(section, tokens);
                continue;
            };
            // what is given takes the place of the value
            let equals = words.iter().position(|word| word.token.is_sign('=')).unwrap_or(words.len());
            let mut tokens = self.words(instance, numbers, &words[..equals]);
            let equals = Out { kind: TokenKind::Sign('='), text: String::new(), place };
            let is_expression = !value.is_constant && matches!(kind, Kind::Parameter | Kind::Input);
            if is_expression {
                // the quantity follows from others: it is defined by them
                tokens.retain(|token| !(token.kind == TokenKind::Name && token.text == "fixed"));
            }
            tokens.push(equals);
            tokens.extend(value.tokens.iter().cloned());
            let section = if is_expression { Section::Definitions } else { section };
            tokens.push(Out { kind: TokenKind::Sign(separator(section)), ..end });
            model.add(section, tokens);
        }
    }
}

/// The name that an entry declares, and what it is.
fn declared(words: &[Word]) -> Option<(&str, Kind)> {
    let word = words.iter().find(|word| matches!(word.role, Some(Role::Declared(_))))?;
    match word.role {
        Some(Role::Declared(kind)) if word.path.is_none() => Some((&word.token.text, kind)),
        _ => None,
    }
}

/// Entries with their separators.
fn entries(words: &[Word], separator: char) -> Vec<&[Word]> {
    let (mut depth, mut start, mut entries) = (0_usize, 0, Vec::new());
    for (i, word) in words.iter().enumerate() {
        match word.token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            TokenKind::Sign(sign) if sign == separator && depth == 0 => {
                entries.push(&words[start..=i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    if start < words.len() {
        entries.push(&words[start..]);
    }
    entries
}
