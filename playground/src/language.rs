//! What an editor asks: the functions of the language service, with places as JavaScript counts them.

use hodograph_language::outline::Item;
use hodograph_language::rename_with_parts::{self, Known, Renamed};
use hodograph_language::{Document, Place, Span};
use hodograph_model::format;
use serde_json::{Value, json};

use crate::answer::object;
use crate::places::Places;
use crate::texts::Texts;

/// The name of a text of a document, which is empty for its own, and how places in it are counted.
fn file(document: &Document, file: usize) -> (&str, Places<'_>) {
    match document.imported(file) {
        None => ("", Places::new(document.text().as_str())),
        Some(imported) => (&imported.key, Places::new(&imported.text)),
    }
}

fn place(document: &Document, place: Place) -> Value {
    let (name, places) = file(document, place.file);
    let [from, to] = places.span(place.span);
    object!({ "file": name, "from": from, "to": to })
}

/// Mistakes and warnings with their fixes, and the colours of words: from, length and kind of each. What stands in
/// an imported file has its place there under `there`.
pub fn check(texts: &Texts<'_>) -> Value {
    let document = texts.document();
    let places = Places::new(texts.text);
    let all = Span { start: 0, end: texts.text.len() as u32 };
    let fixes = document.fixes(all);
    let findings: Value = document
        .findings()
        .into_iter()
        .enumerate()
        .map(|(index, finding)| {
            let own = fixes.iter().filter(|action| action.finding == index);
            let own: Value = own
                .map(|action| {
                    let (name, places) = file(&document, action.file);
                    object!({ "title": action.title.as_str(), "file": name, "edits": places.edits(&action.edits) })
                })
                .collect();
            let related: Value =
                finding.related.iter().map(|(at, text)| json!([place(&document, *at), text])).collect();
            let there = match finding.place.file {
                0 => Value::Null,
                _ => place(&document, finding.place),
            };
            let [from, to] = places.span(finding.span);
            object!({
                "from": from, "to": to, "there": there, "code": finding.code, "error": finding.is_error,
                "unused": finding.is_unused, "message": finding.message, "related": related, "fixes": own,
            })
        })
        .collect();
    let colours: Value = document
        .colours()
        .into_iter()
        .map(|word| {
            let [from, to] = places.span(word.span);
            json!([from, to, format!("{:?}", word.kind).to_lowercase()])
        })
        .collect();
    object!({ "findings": findings, "colours": colours, "errors": document.analysis().has_errors() })
}

/// What may stand at a place.
pub fn complete(texts: &Texts<'_>, at: u32) -> Value {
    let (document, places) = (texts.document(), Places::new(texts.text));
    let proposals = document.completion(places.byte(at));
    let proposals: Value = proposals
        .into_iter()
        .map(|one| {
            let kind = match one.kind {
                hodograph_language::completion::Proposed::Name(symbol) => format!("{symbol:?}"),
                other => format!("{other:?}"),
            };
            let kind = kind.split(['(', ' ', '{']).next().unwrap_or("").to_lowercase();
            object!({ "label": one.label, "kind": kind, "detail": one.detail, "docs": one.docs })
        })
        .collect();
    object!({ "proposals": proposals })
}

/// What is known of the word at a place.
pub fn hover(texts: &Texts<'_>, at: u32) -> Value {
    let (document, places) = (texts.document(), Places::new(texts.text));
    document.hover(places.byte(at)).map_or(Value::Null, |hover| {
        let [from, to] = places.span(hover.span);
        object!({ "from": from, "to": to, "text": hover.text })
    })
}

/// The changes that give the name at a place another, of each text in which it stands; without a new name, the
/// name at the place.
pub fn rename(texts: &Texts<'_>, at: u32, name: &str) -> Value {
    let (document, places) = (texts.document(), Places::new(texts.text));
    let at = places.byte(at);
    if name.is_empty() {
        return match document.renameable(at) {
            Ok((name, _)) => object!({ "name": name }),
            Err(why) => object!({ "refused": why }),
        };
    }
    let all = texts.all();
    let known = |(key, document)| Known { key, document };
    let others: Vec<Known<'_>> = all.iter().map(|(key, document)| known((key.as_str(), document))).collect();
    match rename_with_parts::rename(known((texts.name(), &document)), at, name, &others) {
        Ok(changes) => {
            let of = |change: &Renamed| {
                let edits = Places::new(&change.text).edits(&change.edits);
                object!({ "file": change.key.as_str(), "edits": edits })
            };
            let changes: Value = changes.iter().map(of).collect();
            object!({ "changes": changes })
        }
        Err(why) => object!({ "refused": why }),
    }
}

/// Where the name at a place is declared.
pub fn definition(texts: &Texts<'_>, at: u32) -> Value {
    let (document, places) = (texts.document(), Places::new(texts.text));
    document.definition(places.byte(at)).map_or(Value::Null, |found| place(&document, found))
}

/// Sections and what they declare.
pub fn outline(texts: &Texts<'_>) -> Value {
    let (document, places) = (texts.document(), Places::new(texts.text));
    fn items(list: &[Item], places: &Places<'_>) -> Value {
        let one = |item: &Item| {
            let [from, to] = places.span(item.place);
            let within = items(&item.items, places);
            object!({ "name": item.name.as_str(), "detail": item.detail.as_str(), "from": from, "to": to, "items": within })
        };
        list.iter().map(one).collect()
    }
    items(&document.outline(), &places)
}

/// The text in the one style; nothing where it cannot be parsed.
pub fn format(texts: &Texts<'_>) -> Value {
    match format::format(&texts.source()) {
        Ok(text) => object!({ "text": text }),
        Err(_) => object!({ "refused": "the model cannot be parsed: mend its mistakes first" }),
    }
}
