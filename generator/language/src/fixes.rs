//! Changes that may correct a mistake.

use hodograph_model::diagnostics::{Diagnostic, Place, codes};
use hodograph_model::model::names::Symbol;
use hodograph_model::span::Span;
use hodograph_model::syntax::tree::Section;

use crate::Document;
use crate::text::Edit;

/// A change that may correct a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Action {
    /// a short description
    pub title: String,
    /// the changes, which do not overlap
    pub edits: Vec<Edit>,
    /// index of the changed text: 0 is the document, imported files are counted from 1
    pub file: usize,
    /// the index of the mistake in [`findings`](Document::findings)
    pub finding: usize,
    /// whether it is the likeliest change
    pub is_preferred: bool,
}

/// The largest number of independent speeds that are offered as dependent ones.
const MOST_SPEEDS: usize = 8;

impl Document {
    /// The changes for mistakes inside a range.
    pub fn fixes(&self, within: Span) -> Vec<Action> {
        if self.has_parts() {
            return self.fixes_with_parts(0, within);
        }
        let mut out = Vec::new();
        for (finding, mistake) in self.analysis.diagnostics.iter().enumerate() {
            let place = mistake.primary.span;
            if place.end < within.start || within.end < place.start {
                continue;
            }
            let mut offers = self.stated(mistake);
            offers.extend(match mistake.code {
                codes::UNUSED_PARAMETER | codes::UNUSED_INPUT | codes::UNUSED_DEFINITION => {
                    self.removal(place)
                }
                codes::CONSTRAINT_COUNT => self.dependent_speeds(place),
                codes::UNKNOWN_NAME => self.declarations(place),
                codes::NO_RATE | codes::EMPTY => self.stated_section(mistake),
                _ => Vec::new(),
            });
            let single = offers.len() == 1;
            for (i, (title, edits)) in offers.into_iter().enumerate() {
                let is_preferred = i == 0 && (single || mistake.code == codes::UNKNOWN_NAME);
                out.push(Action { title, edits, file: 0, finding, is_preferred });
            }
        }
        out
    }

    /// The changes that the mistake itself states.
    fn stated(&self, mistake: &Diagnostic) -> Vec<(String, Vec<Edit>)> {
        let offers = mistake.fixes.iter().filter_map(|fix| match fix.place {
            Place::Replace(span) => {
                let title = match span.start == span.end {
                    true => format!("Write `{}`", fix.text.trim_start_matches([':', ' '])),
                    false => format!("Change to `{}`", fix.text),
                };
                Some((title, vec![Edit { span, text: fix.text.clone() }]))
            }
            Place::IntoBraces(owner) => {
                let edit = self.written().entry_in_braces(owner.end, &fix.text)?;
                Some((format!("Add `{}`", fix.text), vec![edit]))
            }
        });
        offers.collect()
    }

    /// Adds an entry to a section, which is created if necessary. Entries are followed by their separator.
    pub(crate) fn entry_in_section(&self, section: Section, entry: &str) -> Option<Edit> {
        let there = self.tree().sections.iter().find(|(other, _)| *other == section);
        if let Some((_, place)) = there {
            return self.written().entry_in_braces(place.end, entry);
        }
        let next =
            self.tree().sections.iter().filter(|(other, _)| *other > section).map(|(_, place)| place.start);
        let at = next.min().unwrap_or(self.text.as_str().len() as u32);
        let text = format!("{} {{ {entry} }}\n", section.word());
        Some(Edit { span: Span { start: at, end: at }, text })
    }

    /// Removes the declaration at a place with its documentation, and its line if it becomes empty.
    fn removal(&self, name: Span) -> Vec<(String, Vec<Edit>)> {
        self.written()
            .declaration(name)
            .map(|span| {
                (format!("Remove `{}`", self.text.at(name)), vec![Edit { span, text: String::new() }])
            })
            .into_iter()
            .collect()
    }

    /// Adds what the advice of a mistake states: "add `kinematics { d(q1)/dt = u1; }`".
    fn stated_section(&self, mistake: &Diagnostic) -> Vec<(String, Vec<Edit>)> {
        let advice = mistake.help.as_deref().and_then(|help| help.strip_prefix("add `")?.split('`').next());
        let Some((advice, (word, entries))) =
            advice.and_then(|advice| Some((advice, advice.split_once(" { ")?)))
        else {
            return Vec::new();
        };
        let section = Section::of_word(word).filter(|_| !entries.contains(".."));
        let edit = section
            .and_then(|section| self.entry_in_section(section, entries.trim_end_matches('}').trim_end()));
        edit.map(|edit| (format!("Add `{advice}`"), vec![edit])).into_iter().collect()
    }

    /// Makes one of the independent speeds dependent; those in the equation come first.
    fn dependent_speeds(&self, equation: Span) -> Vec<(String, Vec<Edit>)> {
        let symbols = self.symbols();
        let tree = self.tree();
        let named = |i: usize| {
            symbols
                .uses_of(Symbol::Speed(i))
                .any(|used| equation.start <= used.start && used.end <= equation.end)
        };
        // if there are too few equations, equations must be added
        if self.symbols().at(equation.start).is_some_and(|(declared, _)| declared.place == Some(equation)) {
            return Vec::new();
        }
        // a mechanism needs at least one independent speed
        if tree.speeds.len() < 2 {
            return Vec::new();
        }
        let mut speeds: Vec<usize> = (0..tree.speeds.len()).rev().collect();
        speeds.sort_by_key(|i| !named(*i));
        let offers = speeds.into_iter().take(MOST_SPEEDS).filter_map(|i| {
            let speed = &tree.speeds[i];
            let text = format!("{}: {}", speed.name.text, self.text.at(speed.unit.span));
            let gone = Edit { span: self.written().declaration(speed.name.span)?, text: String::new() };
            let there = self.entry_in_section(Section::Dependent, &text)?;
            Some((format!("Make `{}` a dependent speed", speed.name.text), vec![gone, there]))
        });
        offers.collect()
    }

    /// Declares the unknown name as a parameter with the dimension that fits.
    fn declarations(&self, place: Span) -> Vec<(String, Vec<Edit>)> {
        let name = self.text.at(place);
        let is_name = name.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !is_name || name.is_empty() {
            return Vec::new();
        }
        let unit = self.expected_at(place).and_then(|wanted| wanted.dimension);
        let unit = unit.map_or("1".to_owned(), |dimension| dimension.to_string());
        let entry = format!("{name}: {unit} = 1");
        let edit = self.entry_in_section(Section::Parameters, &entry);
        edit.map(|edit| (format!("Declare the parameter `{entry}`"), vec![edit])).into_iter().collect()
    }
}
