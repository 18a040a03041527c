//! Changes that may cure a mistake of a model with parts. One part stands for many places of the model, and a
//! file for many models, so that each change is tried before it is offered: the model is read again with it,
//! and it is kept where the mistake is gone and no other stands in its place.

use hodograph_model::check;
use hodograph_model::diagnostics::{Diagnostic, Place as Change, codes};
use hodograph_model::parts::{Files, Imported};
use hodograph_model::source::{MAX_TOKENS, Source};
use hodograph_model::span::Span;
use hodograph_model::syntax::lexer;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Section;

use crate::entries::Written;
use crate::fixes::Action;
use crate::statements::partner;
use crate::text::{Edit, Text, apply};
use crate::{Document, Place};

/// At most so many changes are tried at once.
const MOST_TRIES: usize = 24;

/// A change that is not yet tried.
struct Offer {
    title: String,
    file: usize,
    edit: Edit,
}

/// Files, of which one has another text.
struct Changed<'a> {
    files: &'a dyn Files,
    key: &'a str,
    text: &'a str,
}

impl Files for Changed<'_> {
    fn read(&self, importing: Option<&Imported>, path: &str) -> Result<Imported, String> {
        let mut file = self.files.read(importing, path)?;
        if file.key == self.key {
            self.text.clone_into(&mut file.text);
        }
        Ok(file)
    }
}

impl Document {
    /// The changes that are offered for mistakes within a place of a text: 0 is this document, where what stands
    /// in an imported file counts at its use.
    pub fn fixes_with_parts(&self, file: usize, within: Span) -> Vec<Action> {
        let (mut out, mut tries) = (Vec::new(), 0);
        for (finding, mistake) in self.analysis.diagnostics.iter().enumerate() {
            let place = match file {
                0 => self.source.in_itself(mistake.primary.span),
                _ => match self.place(mistake.primary.span) {
                    place if place.file == file => place.span,
                    _ => continue,
                },
            };
            if place.end < within.start || within.end < place.start {
                continue;
            }
            let before = out.len();
            for Offer { title, file, edit } in self.offers(mistake) {
                tries += 1;
                let twice = |action: &Action| action.file == file && action.edits == [edit.clone()];
                if tries > MOST_TRIES || out[before..].iter().any(twice) || !self.cures(mistake, file, &edit)
                {
                    continue;
                }
                let is_preferred = out.len() == before;
                out.push(Action { title, edits: vec![edit], file, finding, is_preferred });
            }
        }
        out
    }

    /// What may cure a mistake.
    fn offers(&self, mistake: &Diagnostic) -> Vec<Offer> {
        let mut offers = Vec::new();
        let change = |title: String, file, edit| Offer { title, file, edit };
        for fix in &mistake.fixes {
            let (Change::Replace(at) | Change::IntoBraces(at)) = fix.place;
            let Place { file, span } = self.place(at);
            // as it is written there, or as in the model without parts
            let own = self.source.expansion().map(|expansion| expansion.written_at(at, &fix.text));
            for text in own.into_iter().chain([fix.text.clone()]) {
                let offer = match fix.place {
                    Change::Replace(_) => {
                        let title = match span.range().is_empty() {
                            true => format!("Write `{}`", text.trim_start_matches([':', ' '])),
                            false => format!("Change to `{text}`"),
                        };
                        Some(change(title, file, Edit { span, text }))
                    }
                    Change::IntoBraces(_) => {
                        let edit = self.in_text(file, |text_of| text_of.entry_in_braces(span.end, &text));
                        edit.map(|edit| change(format!("Add `{text}`"), file, edit))
                    }
                };
                offers.extend(offer);
            }
        }
        let Place { file, span } = self.place(mistake.primary.span);
        match mistake.code {
            codes::UNUSED_PARAMETER | codes::UNUSED_INPUT | codes::UNUSED_DEFINITION => {
                let removed =
                    self.in_text(file, |text| Some((text.text.at(span).to_owned(), text.declaration(span)?)));
                offers.extend(removed.map(|(name, span)| {
                    change(format!("Remove `{name}`"), file, Edit { span, text: String::new() })
                }));
            }
            codes::OUTER_NAME => offers.extend(self.shared(file, span)),
            _ => {}
        }
        offers
    }

    /// Asks something of a text.
    fn in_text<T>(&self, file: usize, ask: impl FnOnce(Written<'_>) -> Option<T>) -> Option<T> {
        let Some(imported) = self.imported(file) else { return ask(self.written()) };
        let (text, tokens) = (Text::new(imported.text.clone()), lexer::tokens(&imported.text, MAX_TOKENS));
        ask(Written { text: &text, tokens: &tokens })
    }

    /// A part that needs a parameter or input of the mechanism shares it.
    fn shared(&self, file: usize, place: Span) -> Option<Offer> {
        let name = self.in_text(file, |text| Some(text.text.at(place).to_owned()))?;
        let lists = [Section::Parameters, Section::Inputs];
        let (section, unit) = lists
            .into_iter()
            .find_map(|section| Some((section, stated_unit(self.written(), section, &name)?)))?;
        let entry = format!("shared {name}: {unit}");
        let edit = self.in_text(file, |text| entry_in_part(text, place, section, &entry))?;
        Some(Offer { title: format!("Share it with the mechanism: `{entry}`"), file, edit })
    }

    /// Whether a change cures a mistake, and puts no other in its place.
    fn cures(&self, mistake: &Diagnostic, file: usize, edit: &Edit) -> bool {
        let source = match self.imported(file) {
            None => Source::file("", apply(self.text.as_str(), std::slice::from_ref(edit)))
                .importing(&*self.files),
            Some(imported) => {
                let text = apply(&imported.text, std::slice::from_ref(edit));
                let files = Changed { files: &*self.files, key: &imported.key, text: &text };
                Source::file("", self.text.as_str()).importing(&files)
            }
        };
        let after = check::analyse(&source).diagnostics;
        let same = |other: &&Diagnostic| (other.code, &other.message) == (mistake.code, &mistake.message);
        let count = |list: &[Diagnostic]| list.iter().filter(same).count();
        let new = edit.span.start..edit.span.start + edit.text.len() as u32;
        let there = |other: &Diagnostic| {
            let (of, span) = source.place(other.primary.span);
            of == file && span.start < new.end && new.start < span.end
        };
        count(&after) < count(&self.analysis.diagnostics) && !after.iter().any(there)
    }
}

/// The unit with which a section of the mechanism declares a name.
fn stated_unit(of: Written<'_>, section: Section, name: &str) -> Option<String> {
    let Written { text, tokens } = of;
    let mut depth = 0_usize;
    let head = tokens.iter().enumerate().find(|(i, token)| {
        let outside = depth == 0;
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ => {}
        }
        outside && token.is_word(section.word()) && is_open(tokens.get(i + 1))
    })?;
    let (open, close) = (head.0 + 1, partner(tokens, head.0 + 1));
    let at = (open..close).find(|i| tokens[*i].is_word(name) && tokens[i + 1].is_sign(':'))? + 2;
    let ends = |token: &Token| token.is_sign('=') || token.is_sign(',') || token.kind == TokenKind::OuterDoc;
    let end = (at..close).find(|i| ends(&tokens[*i])).unwrap_or(close);
    let unit = text.at(tokens.get(at)?.span.to(tokens.get(end.checked_sub(1)?)?.span));
    (end > at).then(|| unit.trim().to_owned())
}

/// One more entry in a section of the part around a place; the section is made where there is none.
fn entry_in_part(of: Written<'_>, place: Span, section: Section, entry: &str) -> Option<Edit> {
    let Written { text, tokens } = of;
    let within = |open: usize| {
        tokens[open].span.end <= place.start && place.end <= tokens[partner(tokens, open)].span.start
    };
    let part =
        (0..tokens.len()).rev().find(|i| tokens[*i].is_word("part") && tokens[*i].span.end <= place.start)?;
    let open = (part..tokens.len()).find(|i| tokens[*i].kind == TokenKind::Open('{'))?;
    if !within(open) {
        return None;
    }
    let close = partner(tokens, open);
    let head = (open + 1..close).find(|i| tokens[*i].is_word(section.word()) && is_open(tokens.get(i + 1)));
    match head {
        Some(head) => of.entry_in_braces(tokens[head].span.end, entry),
        None => {
            let at = tokens[open].span.end;
            let line = text.at(text.line(text.line_of(tokens[part].span.start)));
            let indent: String = line.chars().take_while(|c| *c == ' ').collect();
            let text = format!("\n{indent}    {} {{ {entry} }}", section.word());
            Some(Edit { span: Span { start: at, end: at }, text })
        }
    }
}

fn is_open(token: Option<&Token>) -> bool {
    token.is_some_and(|token| token.kind == TokenKind::Open('{'))
}
