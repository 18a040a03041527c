//! Reads XML, and counts elements and attributes that are not used.

use std::collections::BTreeMap;

use roxmltree::{Document, Error, Node, ParsingOptions};

use super::lines::Lines;

/// The largest number of attributes of an element. Robot descriptions have fewer than fifty, and the XML
/// reader compares each with each.
const MAX_ATTRIBUTES: usize = 1000;

/// Parses a file. It may have a document type, but no entities of its own.
///
/// # Errors
///
/// The mistakes of the XML.
pub fn parse<'s>(source: &'s str, file: &str, lines: &Lines<'_>) -> Result<Document<'s>, Vec<String>> {
    few_attributes(source, file, lines)?;
    let parsed = match Document::parse(source) {
        Err(Error::DtdDetected) => match entity(source) {
            Some(entity) => {
                return Err(vec![format!(
                    "{file}:{}: entities are not read: write in the place of each what it stands for, and remove the \
                     <!DOCTYPE ..>",
                    lines.place(entity)
                )]);
            }
            None => {
                let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
                Document::parse_with_options(source, options)
            }
        },
        parsed => parsed,
    };
    parsed.map_err(|error| vec![told(&error, source, file, lines)])
}

/// Where the document type declares an entity.
fn entity(source: &str) -> Option<usize> {
    let begin = source.find("<!DOCTYPE")?;
    source[begin..].find("<!ENTITY").map(|entity| begin + entity)
}

/// A mistake of the XML: its place, its cause and its cure.
fn told(error: &Error, source: &str, file: &str, lines: &Lines<'_>) -> String {
    let stated = format!("{}:{}", error.pos().row, error.pos().col);
    let (at, cause) = match error {
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream if !source.trim().is_empty() => {
            let advice = "the file ends within an element: it is cut off, or lacks an end tag";
            (lines.place(source.trim_end().len()), advice.to_owned())
        }
        Error::UnknownNamespace(prefix, _) => {
            let advice = format!(
                "the prefix `{prefix}` has no meaning: remove what bears it, or state `xmlns:{prefix}=\"..\"` in the \
                 root element"
            );
            (stated, advice)
        }
        _ => {
            let text = error.to_string();
            let place = format!(" at {stated}");
            (stated, text.strip_suffix(&place).unwrap_or(&text).to_owned())
        }
    };
    format!("{file}:{at}: this is not XML: {cause}")
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

/// What is read of the elements of a name.
pub struct Known {
    /// the name
    name: &'static str,
    /// its attributes
    attributes: &'static [&'static str],
    /// the elements in it that stand there once
    parts: &'static [&'static str],
    /// the elements in it of which there may be any number
    lists: &'static [&'static str],
}

impl Known {
    /// What is read of the elements of a name.
    pub const fn new(
        name: &'static str,
        attributes: &'static [&'static str],
        parts: &'static [&'static str],
        lists: &'static [&'static str],
    ) -> Self {
        Known { name, attributes, parts, lists }
    }

    fn reads(&self, part: Node) -> bool {
        let name = part.tag_name().name();
        self.parts.contains(&name) || self.lists.contains(&name)
    }
}

/// Counts the attributes and the elements of an element that are not read, and those of what is read of it;
/// `at` returns the place of an offset. Returns the elements that stand a second time where one is read.
pub fn unread<'n>(
    element: Node<'n, 'n>,
    known: &[Known],
    ignored: &mut Ignored,
    at: &dyn Fn(usize) -> String,
) -> Vec<Node<'n, 'n>> {
    let name = element.tag_name().name();
    let Some(own) = known.iter().find(|known| known.name == name) else { return Vec::new() };
    for attribute in element.attributes() {
        if attribute.namespace().is_some() || !own.attributes.contains(&attribute.name()) {
            let what = format!("attribute `{}` of <{name}>", attribute.name());
            ignored.count(what, || at(attribute.range().start));
        }
    }
    let mut second = Vec::new();
    let mut seen = Vec::new();
    for part in element.children().filter(Node::is_element) {
        let kind = part.tag_name().name();
        if !own.reads(part) {
            let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
            ignored.count(format!("<{kind}> of {article} {name}"), || at(part.range().start));
        } else if own.parts.contains(&kind) && seen.contains(&kind) {
            second.push(part);
        } else {
            seen.push(kind);
            second.extend(unread(part, known, ignored, at));
        }
    }
    second
}
