//! Says the mistakes of an expanded model of the texts that its author wrote: names as they are written
//! there, the uses through which a part came into the model, and what all instances of a part have in common
//! once.

use std::collections::{HashMap, HashSet};

use super::Expansion;
use crate::diagnostics::{Code, Diagnostic, Label, codes};
use crate::span::Span;

/// Uses around a place that are pointed out.
const MOST_USES: usize = 3;

impl Expansion {
    /// The mistakes as the author of the texts knows them, in the order of the texts.
    pub fn explained(&self, diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
        let mut kept: Vec<Diagnostic> = Vec::new();
        // the first of those that differ in their instance only, and how many there are
        let mut known: HashMap<(Code, u32, Span), usize> = HashMap::new();
        let mut counts: Vec<usize> = Vec::new();
        for diagnostic in diagnostics {
            let place = self.places.find(diagnostic.primary.span).unwrap_or_default();
            let key = (diagnostic.code, place.file, place.span);
            if let Some(first) = known.get(&key) {
                counts[*first] += 1;
                continue;
            }
            known.insert(key, kept.len());
            kept.push(diagnostic);
            counts.push(0);
        }
        let mut explained: Vec<Diagnostic> = kept
            .into_iter()
            .zip(counts)
            .map(|(diagnostic, others)| self.of_instance(diagnostic, others))
            .collect();
        explained.sort_by_key(|d| {
            let place = self.places.find(d.primary.span).unwrap_or_default();
            (place.file, place.span, d.code)
        });
        explained
    }

    fn of_instance(&self, mut diagnostic: Diagnostic, others: usize) -> Diagnostic {
        if diagnostic.code == codes::DUPLICATE_NAME
            && let Some(name) = diagnostic.message.split('`').nth(1)
            && let Some(shown) = self.shown.get(name).filter(|shown| *shown != name)
        {
            let help = format!(
                "`{shown}` is called {name} in generated code, and so is the other: choose another name"
            );
            diagnostic.help = Some(help);
        }
        let place = self.places.find(diagnostic.primary.span).unwrap_or_default();
        // within a part its own names are meant
        if let Some(near) =
            self.near.get(&(place.file, place.span)).filter(|_| diagnostic.code == codes::UNKNOWN_NAME)
        {
            diagnostic.fixes.clear();
            diagnostic = diagnostic.did_you_mean(near);
        }
        // the last name is that in generated code, which two others become
        diagnostic.message = match diagnostic.message.rsplit_once(" both become ") {
            Some((names, rust)) => format!("{} both become {rust}", self.written(names)),
            None => self.written(&diagnostic.message),
        };
        diagnostic.help = diagnostic.help.map(|help| self.written(&help));
        diagnostic.primary.text = self.written(&diagnostic.primary.text);
        for label in &mut diagnostic.related {
            label.text = self.written(&label.text);
        }
        let place = self.places.find(diagnostic.primary.span).unwrap_or_default();
        // instances have their places in common
        let mut said = HashSet::new();
        diagnostic.related.retain(|label| {
            let place = self.places.find(label.span).unwrap_or_default();
            said.insert((place.file, place.span, label.text.clone()))
        });
        for (i, site) in self.places.sites(place).into_iter().take(MOST_USES).enumerate() {
            let more = match others {
                0 => String::new(),
                _ if i > 0 => String::new(),
                1 => ", and in another".to_owned(),
                n => format!(", and in {n} others"),
            };
            let text = format!("in this use of `{}`{more}", site.part);
            diagnostic.related.push(Label { span: site.span, text });
        }
        diagnostic
    }

    /// A text with the names of instances as they are written: `front_left.knee` for `front_left_knee`.
    fn written(&self, text: &str) -> String {
        if !text.contains('`') {
            return text.to_owned();
        }
        let quoted =
            |(i, piece): (usize, &str)| if i % 2 == 1 { self.names(piece, 0) } else { piece.to_owned() };
        text.split('`').enumerate().map(quoted).collect::<Vec<String>>().join("`")
    }

    /// Words of the expanded model as they are written at a place of it: within the part of `front_left`,
    /// `knee` for `front_left_knee`.
    pub fn written_at(&self, place: Span, words: &str) -> String {
        let place = self.places.find(place).unwrap_or_default();
        self.names(words, self.places.sites(place).len())
    }

    /// Words with the names of instances as they are written, without so many names of instances before them.
    fn names(&self, text: &str, inside: usize) -> String {
        let is_part = |c: char| c == '_' || c.is_alphanumeric();
        let (mut out, mut rest) = (String::new(), text);
        while let Some(first) = rest.chars().next() {
            let length = match is_part(first) {
                true => rest.find(|c| !is_part(c)).unwrap_or(rest.len()),
                false => first.len_utf8(),
            };
            let word = &rest[..length];
            let shown = self.shown.get(word).map_or(word, String::as_str);
            out.push_str(shown.splitn(inside + 1, '.').nth(inside).unwrap_or(shown));
            rest = &rest[length..];
        }
        out
    }
}
