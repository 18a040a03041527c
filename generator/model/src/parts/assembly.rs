//! The expanded model on its way: the sections of the mechanism, each with the entries of all instances
//! behind its own.

use std::collections::BTreeMap;

use super::places::{Place, Places};
use super::resolve::Out;
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::tree::Section;

/// What separates the entries of a section.
pub fn separator(section: Section) -> char {
    use Section::*;
    match section {
        Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Shapes | Contacts => {
            ','
        }
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
pub struct Own {
    /// the section whose entries it holds
    pub section: Option<Section>,
    /// its word and brace
    pub head: Vec<Out>,
    /// its entries
    pub inner: Vec<Out>,
    /// its closing brace
    pub close: Option<Out>,
}

impl Model {
    /// Adds entries of an instance.
    pub fn add(&mut self, section: Section, tokens: Vec<Out>) {
        self.length += tokens.len();
        self.added.entry(section).or_default().extend(tokens);
    }

    /// Adds a stretch of the mechanism itself.
    pub fn stretch(&mut self, stretch: Own) {
        self.length += stretch.inner.len();
        self.own.push(stretch);
    }

    /// How many tokens its entries have.
    pub fn length(&self) -> usize {
        self.length
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
