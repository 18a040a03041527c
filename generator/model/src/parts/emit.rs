//! Writes the blocks of all instances into the model, in the order of the uses.

use std::collections::HashMap;

use super::assembly::{Model, Own, separator};
use super::bind::{Given, GivenValues};
use super::count::Numbers;
use super::resolve::{Out, Resolver};
use super::roles::{Kind, Role};
use super::template::{Stretch, Word};
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::tree::Section;

impl Resolver<'_, '_, '_> {
    /// Writes all blocks.
    ///
    /// # Errors
    ///
    /// The model would have more than `most` tokens: the instance at which it has.
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
                    model.stretch(Own { section: stretch.section, head, inner, close });
                } else {
                    self.stretch(run.instance, &run.numbers, stretch, &values[run.instance], model);
                }
                if model.length() > most {
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
        numbers: &Numbers,
        stretch: &Stretch,
        given: &HashMap<String, Given>,
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
