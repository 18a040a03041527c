//! Changes that may cure a mistake.

use hodograph_model::diagnostics::{Diagnostic, Place, codes};
use hodograph_model::model::names::Symbol;
use hodograph_model::span::Span;
use hodograph_model::syntax::token::TokenKind;
use hodograph_model::syntax::tree::Section;

use crate::Document;
use crate::statements::partner;
use crate::text::Edit;

/// A change that may cure a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Action {
    /// what it does, in a few words
    pub title: String,
    /// the changes, of which none overlap
    pub edits: Vec<Edit>,
    /// the index of the mistake in [`findings`](Document::findings)
    pub finding: usize,
    /// the likeliest
    pub is_preferred: bool,
}

/// So many independent speeds are offered as dependent ones.
const MOST_SPEEDS: usize = 8;

impl Document {
    /// The changes that are offered for mistakes within a place.
    pub fn fixes(&self, within: Span) -> Vec<Action> {
        let mut out = Vec::new();
        // their places are those of the expanded model
        if self.has_parts() {
            return out;
        }
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
                _ => Vec::new(),
            });
            let single = offers.len() == 1;
            for (i, (title, edits)) in offers.into_iter().enumerate() {
                let is_preferred = i == 0 && (single || mistake.code == codes::UNKNOWN_NAME);
                out.push(Action { title, edits, finding, is_preferred });
            }
        }
        out
    }

    /// What the mistake itself offers.
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
                let edit = self.entry_in_braces(owner.end, &fix.text)?;
                Some((format!("Add `{}`", fix.text), vec![edit]))
            }
        });
        offers.collect()
    }

    /// One more entry in the braces that follow a place.
    fn entry_in_braces(&self, after: u32, text: &str) -> Option<Edit> {
        let tokens = self.tokens();
        let from = tokens.partition_point(|token| token.span.start < after);
        let open = (from..tokens.len().min(from + 12)).find(|i| tokens[*i].kind == TokenKind::Open('{'))?;
        let close = partner(tokens, open);
        let last = tokens[close - 1].clone();
        let separate = !matches!(last.kind, TokenKind::Open('{') | TokenKind::Sign(',' | ';'));
        // behind a comment the entry would be part of it
        let at = Span { start: last.span.end, end: last.span.end };
        let several =
            self.text.line_of(tokens[open].span.start) < self.text.line_of(tokens[close].span.start);
        let lead = match (separate, several) {
            (true, false) => ", ".to_owned(),
            (false, false) => " ".to_owned(),
            (separate, true) => {
                let line = self.text.line(self.text.line_of(tokens[close].span.start));
                let indent: String = self.text.at(line).chars().take_while(|c| *c == ' ').collect();
                format!("{}\n{indent}    ", if separate { "," } else { "" })
            }
        };
        let tail = match last.kind {
            TokenKind::Open(_) if !several => " ",
            _ if several => ",",
            _ => "",
        };
        Some(Edit { span: at, text: format!("{lead}{text}{tail}") })
    }

    /// One more entry in a section, which is made if it is not there. Entries are followed by their separator.
    pub(crate) fn entry_in_section(&self, section: Section, entry: &str) -> Option<Edit> {
        let there = self.tree().sections.iter().find(|(other, _)| *other == section);
        if let Some((_, place)) = there {
            return self.entry_in_braces(place.end, entry);
        }
        let next =
            self.tree().sections.iter().filter(|(other, _)| *other > section).map(|(_, place)| place.start);
        let at = next.min().unwrap_or(self.text.as_str().len() as u32);
        let text = format!("{} {{ {entry} }}\n", section.word());
        Some(Edit { span: Span { start: at, end: at }, text })
    }

    /// The declaration at a place goes, with its documentation and its line if nothing else stands there.
    fn removal(&self, name: Span) -> Vec<(String, Vec<Edit>)> {
        self.declaration(name)
            .map(|span| {
                (format!("Remove `{}`", self.text.at(name)), vec![Edit { span, text: String::new() }])
            })
            .into_iter()
            .collect()
    }

    /// All of a declaration, with the separator behind it and the documentation before it.
    fn declaration(&self, name: Span) -> Option<Span> {
        let tokens = self.tokens();
        let at = tokens.iter().position(|token| token.span == name)?;
        let is_before =
            |i: &usize| matches!(tokens[*i].kind, TokenKind::OuterDoc) || tokens[*i].is_word("fixed");
        let first = (0..at).rev().take_while(is_before).last().unwrap_or(at);
        let mut depth = 0_usize;
        let mut last = at;
        for (i, token) in tokens.iter().enumerate().skip(at) {
            match token.kind {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close(_) if depth == 0 => break,
                TokenKind::Close(_) => depth -= 1,
                _ => {}
            }
            last = i;
            if depth == 0 && matches!(token.kind, TokenKind::Sign(',' | ';')) {
                break;
            }
        }
        let mut span = tokens[first].span.to(tokens[last].span);
        let after = self.text.at(Span { start: span.end, end: self.text.as_str().len() as u32 });
        let line = self.text.line(self.text.line_of(span.start));
        let alone = self.text.at(Span { start: line.start, end: span.start }).trim().is_empty();
        let blanks = after.len() - after.trim_start_matches([' ', '\t']).len();
        let rest = &after[blanks..];
        if alone && (rest.starts_with('\n') || rest.starts_with("\r\n")) {
            let feed = if rest.starts_with('\n') { 1 } else { 2 };
            span = Span { start: line.start, end: span.end + (blanks + feed) as u32 };
        } else {
            span.end += blanks as u32;
        }
        Some(span)
    }

    /// One of the independent speeds becomes dependent: those that the equation names come first.
    fn dependent_speeds(&self, equation: Span) -> Vec<(String, Vec<Edit>)> {
        let symbols = self.symbols();
        let tree = self.tree();
        let named = |i: usize| {
            symbols
                .uses_of(Symbol::Speed(i))
                .any(|used| equation.start <= used.start && used.end <= equation.end)
        };
        // too few equations are cured by equations
        if self.symbols().at(equation.start).is_some_and(|(declared, _)| declared.place == Some(equation)) {
            return Vec::new();
        }
        // a mechanism keeps one of them
        if tree.speeds.len() < 2 {
            return Vec::new();
        }
        let mut speeds: Vec<usize> = (0..tree.speeds.len()).rev().collect();
        speeds.sort_by_key(|i| !named(*i));
        let offers = speeds.into_iter().take(MOST_SPEEDS).filter_map(|i| {
            let speed = &tree.speeds[i];
            let text = format!("{}: {}", speed.name.text, self.text.at(speed.unit.span));
            let gone = Edit { span: self.declaration(speed.name.span)?, text: String::new() };
            let there = self.entry_in_section(Section::Dependent, &text)?;
            Some((format!("Make `{}` a dependent speed", speed.name.text), vec![gone, there]))
        });
        offers.collect()
    }

    /// The unknown name is declared, as a parameter with the dimension that fits.
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
