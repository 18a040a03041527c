//! From a name to its declaration and its uses, and renaming.

use hodograph_model::check;
use hodograph_model::diagnostics::{Diagnostic, codes};
use hodograph_model::model::names::Symbol;
use hodograph_model::parts::Imported;
use hodograph_model::source::{MAX_TOKENS, Source};
use hodograph_model::span::Span;
use hodograph_model::syntax::lexer;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Section;

use crate::new_name::valid_name;
use crate::rename_with_parts::{self, Known};
use crate::text::{Edit, apply};
use crate::{Document, Place};

impl Document {
    /// The place of the declaration of the name or part at a place; for an import, the beginning of the file.
    /// `None` for a predefined name.
    pub fn definition(&self, offset: u32) -> Option<Place> {
        if let Some((declared, _)) = self.symbols().at(offset) {
            let own = declared.place.map(|span| Place { file: 0, span });
            let imported = || self.analysis.imported.get(&declared.symbol);
            return own.or_else(|| imported().map(|at| Place { file: at.file as usize, span: at.span }));
        }
        let (i, token) = self.token_at(offset)?;
        match self.tokens()[..i].last()? {
            before if before.is_word("use") => self.part(&token.text),
            before if before.is_word("import") => {
                let path = token.text.trim_matches('"');
                let read = self.files.read(None, path).ok()?;
                let files = &self.source.expansion()?.files;
                let file = files.iter().position(|file| file.key == read.key)? + 1;
                Some(Place { file, span: Span::default() })
            }
            _ => None,
        }
    }

    /// The place of the declaration of a part, in the document or in an imported file.
    fn part(&self, name: &str) -> Option<Place> {
        let declared = |file: usize, tokens: &[Token]| {
            let found = tokens.windows(2).find(|pair| pair[0].is_word("part") && pair[1].is_word(name))?;
            Some(Place { file, span: found[1].span })
        };
        let files = self.source.expansion().map_or(&[][..], |expansion| &expansion.files);
        let imported =
            |(i, file): (usize, &Imported)| declared(i + 1, &lexer::tokens(&file.text, MAX_TOKENS));
        declared(0, self.tokens()).or_else(|| files.iter().enumerate().find_map(imported))
    }

    /// The places of the name at a place, in order.
    pub fn references(&self, offset: u32, with_declaration: bool) -> Vec<Span> {
        let Some((declared, _)) = self.symbols().at(offset) else { return Vec::new() };
        let mut places: Vec<Span> = self.symbols().uses_of(declared.symbol).collect();
        places.extend(declared.place.filter(|_| with_declaration));
        places.sort();
        places.dedup();
        places
    }

    /// The name at a place that can be changed, and its place.
    ///
    /// # Errors
    ///
    /// The reason why it cannot be changed.
    pub fn renameable(&self, offset: u32) -> Result<(String, Span), String> {
        if self.has_parts() {
            return self.renameable_with_parts(offset);
        }
        let nothing = || "no name of the model stands here".to_owned();
        let (declared, span) = self.symbols().at(offset).ok_or_else(nothing)?;
        if declared.place.is_none() {
            return Err(format!("`{}` is given: it is declared in no model", declared.name));
        }
        if self.text.at(span) != declared.name {
            return Err(format!(
                "`{}` follows from the name of a pair of shapes: change that",
                declared.name
            ));
        }
        if declared.symbol == Symbol::Broken || self.symbols().ambiguous.contains(&declared.name) {
            return Err(format!(
                "it is not clear which `{}` is meant: correct the mistakes first",
                declared.name
            ));
        }
        if self.is_unbalanced() {
            return Err("brackets lack their partners: correct that first".to_owned());
        }
        Ok((declared.name.clone(), span))
    }

    /// The changes that rename the name at a place, in this text alone; [`rename_with_parts::rename`] changes
    /// names that stand in several texts.
    ///
    /// # Errors
    ///
    /// The reason why this is impossible: the name is taken or invalid, or the model would change its
    /// meaning.
    pub fn rename(&self, offset: u32, new: &str) -> Result<Vec<Edit>, String> {
        let (old, _) = self.renameable(offset)?;
        if new == old {
            return Ok(Vec::new());
        }
        if self.has_parts() {
            let changes = rename_with_parts::rename(Known { key: "", document: self }, offset, new, &[])?;
            return match changes.as_slice() {
                [change] if change.key.is_empty() => Ok(change.edits.clone()),
                _ => Err(format!("`{old}` stands in imported files too")),
            };
        }
        self.can_be_named(new)?;
        let places = self.references(offset, true);
        self.left_over(&old, &places)?;
        let edits: Vec<Edit> = places.iter().map(|span| Edit { span: *span, text: new.to_owned() }).collect();
        let Err(why) = self.same_after(&edits, new, places.len()) else { return Ok(edits) };
        // `q1` and `u1` belong together by their names; an equation can state this instead
        let Some((equations, count)) = self.rates_by_name(&old, new) else { return Err(why) };
        let edits: Vec<Edit> = edits.into_iter().chain([equations]).collect();
        self.same_after(&edits, new, places.len() + count).map(|()| edits)
    }

    /// Whether the changed text has the same mistakes and uses as this one, with this number of uses of the
    /// new name.
    fn same_after(&self, edits: &[Edit], new: &str, places: usize) -> Result<(), String> {
        let after = check::analyse(&Source::file("", apply(self.text.as_str(), edits)));
        let kinds = |all: &[Diagnostic]| {
            let mut kinds: Vec<_> = all.iter().map(|found| found.code).collect();
            kinds.sort();
            kinds
        };
        let uses = after.symbols.named(new).map_or(0, |named| after.symbols.uses_of(named.symbol).count());
        if kinds(&after.diagnostics) == kinds(&self.analysis.diagnostics) && uses + 1 == places {
            return Ok(());
        }
        let known = |found: &&Diagnostic| !self.analysis.diagnostics.iter().any(|d| d.code == found.code);
        Err(match after.diagnostics.iter().find(known) {
            Some(found) => format!("with `{new}` the model has a mistake: {}", found.message),
            None => format!("with `{new}` the model would mean something else"),
        })
    }

    /// The equations `d(q..)/dt = u..` that hold because of the names of coordinates and speeds, and that
    /// contain the name; with the new name, and the number of its occurrences.
    fn rates_by_name(&self, old: &str, new: &str) -> Option<(Edit, usize)> {
        let mechanism = self.analysis.mechanism.as_ref()?;
        let mut stated = Vec::new();
        for coordinate in &mechanism.coordinates {
            let speed = coordinate.name.strip_prefix('q').map(|rest| format!("u{rest}"));
            let Some(speed) = speed.filter(|speed| [coordinate.name.as_str(), speed].contains(&old)) else {
                continue;
            };
            let by_name = mechanism.kinematics.iter().any(|equation| equation.span == coordinate.span);
            if by_name && mechanism.speeds.iter().any(|other| other.name == speed) {
                let named = |name: &str| if name == old { new.to_owned() } else { name.to_owned() };
                stated.push(format!("d({})/dt = {};", named(&coordinate.name), named(&speed)));
            }
        }
        let count = stated.len();
        let edit = self.entry_in_section(Section::Kinematics, &stated.join(" "))?;
        (count > 0).then_some((edit, count))
    }

    /// Whether a name may be declared in this model.
    fn can_be_named(&self, new: &str) -> Result<(), String> {
        valid_name(new)?;
        if let Some(taken) = self.symbols().named(new) {
            return Err(format!(
                "`{new}` is {} of this model already",
                taken.symbol.kind().trim_start_matches("the ")
            ));
        }
        Ok(())
    }

    /// Checks that the name does not occur in parts of a mistaken model that were not read.
    fn left_over(&self, name: &str, places: &[Span]) -> Result<(), String> {
        let unread = [codes::CYCLE, codes::TOO_DEEP, codes::EXPECTED, codes::FIELD, codes::SECTION_UNKNOWN];
        if !self.analysis.diagnostics.iter().any(|found| unread.contains(&found.code)) {
            return Ok(());
        }
        let tokens = self.tokens();
        let is_use = |i: usize| {
            let member = i > 0 && tokens[i - 1].is_sign('.');
            let word =
                tokens.get(i + 1).is_some_and(|next| next.is_sign(':') || next.kind == TokenKind::Open('('));
            !member && !word
        };
        let left = tokens.iter().enumerate().find(|(i, token)| {
            token.is_word(name) && is_use(*i) && !places.contains(&token.span) && !self.is_unit(token.span)
        });
        match left {
            None => Ok(()),
            Some((_, token)) => Err(format!(
                "`{name}` may be meant in line {} too, which could not be read: correct the mistakes first",
                self.text.line_of(token.span.start) + 1
            )),
        }
    }

    /// Whether a place is in a unit.
    pub(crate) fn is_unit(&self, place: Span) -> bool {
        self.units().iter().any(|unit| unit.start <= place.start && place.end <= unit.end)
    }

    /// The places of all units.
    pub(crate) fn units(&self) -> Vec<Span> {
        let tree = self.tree();
        let lists = [&tree.parameters, &tree.inputs, &tree.coordinates, &tree.speeds, &tree.dependent];
        let quantities = lists.into_iter().flatten().map(|quantity| quantity.unit.span);
        let definitions =
            tree.definitions.iter().filter_map(|definition| Some(definition.unit.as_ref()?.span));
        quantities.chain(definitions).collect()
    }
}
