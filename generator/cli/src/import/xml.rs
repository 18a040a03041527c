//! Reads XML, and counts what of it is not used.

use std::collections::BTreeMap;

use roxmltree::Document;

use super::lines::Lines;

/// An element has at most so many attributes: descriptions of robots have none with fifty, and to compare
/// each with each takes time.
const MOST_ATTRIBUTES: usize = 1000;

/// Parses a file.
///
/// # Errors
///
/// What is wrong with the XML.
pub fn parse<'s>(source: &'s str, file: &str, lines: &Lines<'_>) -> Result<Document<'s>, Vec<String>> {
    few_attributes(source, file, lines)?;
    Document::parse(source).map_err(|error| {
        let at = error.pos();
        vec![format!("{file}:{}:{}: this is no XML: {error}", at.row, at.col)]
    })
}

/// Refuses elements with very many attributes, before an XML reader compares each with each. The tag of an
/// element ends before the next `<`; that each of its attributes has `=` and a quotation mark counts them.
fn few_attributes(source: &str, file: &str, lines: &Lines<'_>) -> Result<(), Vec<String>> {
    let mut end = 0;
    for tag in source.split_inclusive('<') {
        let begin = end;
        end += tag.len();
        let values = tag.split('=').skip(1).filter(|rest| rest.trim_start().starts_with(['"', '\'']));
        if values.take(MOST_ATTRIBUTES + 1).count() > MOST_ATTRIBUTES {
            let place = lines.place(begin.saturating_sub(1));
            return Err(vec![format!(
                "{file}:{place}: this element has more than {MOST_ATTRIBUTES} attributes: this is no description of a robot"
            )]);
        }
    }
    Ok(())
}

/// What a description says and a model does not: each kind once, with its number.
#[derive(Default)]
pub struct Ignored(BTreeMap<String, (usize, String)>);

impl Ignored {
    /// Something of this kind stands at a place.
    pub fn count(&mut self, what: String, at: impl FnOnce() -> String) {
        self.0.entry(what).or_insert_with(|| (0, at())).0 += 1;
    }

    /// A sentence for each kind.
    pub fn notes(self) -> impl Iterator<Item = String> {
        self.0.into_iter().map(|(what, (count, first))| match count {
            1 => format!("{first}: ignored {what}"),
            _ => format!("{first}: ignored {what}, {count} times"),
        })
    }
}
