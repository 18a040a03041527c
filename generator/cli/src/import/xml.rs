//! Reads XML, and counts elements that are not used.

use std::collections::BTreeMap;

use roxmltree::Document;

use super::lines::Lines;

/// The largest number of attributes of an element. Robot descriptions have fewer than fifty, and the XML
/// reader compares each with each.
const MAX_ATTRIBUTES: usize = 1000;

/// Parses a file.
///
/// # Errors
///
/// The mistakes of the XML.
pub fn parse<'s>(source: &'s str, file: &str, lines: &Lines<'_>) -> Result<Document<'s>, Vec<String>> {
    few_attributes(source, file, lines)?;
    Document::parse(source).map_err(|error| {
        let at = error.pos();
        vec![format!("{file}:{}:{}: this is not XML: {error}", at.row, at.col)]
    })
}

/// Refuses elements with very many attributes before the XML reader compares each with each. The tag of an
/// element ends before the next `<`; its attributes are counted by `=` with a quotation mark.
fn few_attributes(source: &str, file: &str, lines: &Lines<'_>) -> Result<(), Vec<String>> {
    let mut end = 0;
    for tag in source.split_inclusive('<') {
        let begin = end;
        end += tag.len();
        let values = tag.split('=').skip(1).filter(|rest| rest.trim_start().starts_with(['"', '\'']));
        if values.take(MAX_ATTRIBUTES + 1).count() > MAX_ATTRIBUTES {
            let place = lines.place(begin.saturating_sub(1));
            return Err(vec![format!(
                "{file}:{place}: this element has more than {MAX_ATTRIBUTES} attributes: this is not a robot description"
            )]);
        }
    }
    Ok(())
}

/// Elements and attributes of a description that the model does not use: each kind once, with its number.
#[derive(Default)]
pub struct Ignored(BTreeMap<String, (usize, String)>);

impl Ignored {
    /// Counts an occurrence of this kind, and keeps the place of the first.
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
