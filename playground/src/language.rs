//! What an editor asks: the functions of the language service, with places as JavaScript counts them.

use hodograph_language::outline::Item;
use hodograph_language::{Document, Span};
use hodograph_model::format;
use hodograph_model::source::Source;
use serde_json::{Value, json};

use crate::places::Places;

/// Mistakes and warnings with their fixes, and the colours of words: from, length and kind of each.
pub fn check(text: &str) -> Value {
    let (document, places) = (Document::new(text), Places::new(text));
    let all = Span { start: 0, end: text.len() as u32 };
    let fixes = document.fixes(all);
    let findings: Value = document
        .findings()
        .into_iter()
        .enumerate()
        .map(|(index, finding)| {
            let own = fixes.iter().filter(|action| action.finding == index);
            let own: Value = own
                .map(|action| json!({ "title": action.title, "edits": places.edits(&action.edits) }))
                .collect();
            let related: Value =
                finding.related.iter().map(|(span, text)| json!([places.span(*span), text])).collect();
            let [from, to] = places.span(finding.span);
            json!({
                "from": from, "to": to, "code": finding.code, "error": finding.is_error,
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
    json!({ "findings": findings, "colours": colours, "errors": document.analysis().has_errors() })
}

/// What may stand at a place.
pub fn complete(text: &str, at: u32) -> Value {
    let (document, places) = (Document::new(text), Places::new(text));
    let proposals = document.completion(places.byte(at));
    let proposals: Value = proposals
        .into_iter()
        .map(|one| {
            let kind = match one.kind {
                hodograph_language::completion::Proposed::Name(symbol) => format!("{symbol:?}"),
                other => format!("{other:?}"),
            };
            let kind = kind.split(['(', ' ', '{']).next().unwrap_or("").to_lowercase();
            json!({ "label": one.label, "kind": kind, "detail": one.detail, "docs": one.docs })
        })
        .collect();
    json!({ "proposals": proposals })
}

/// What is known of the word at a place.
pub fn hover(text: &str, at: u32) -> Value {
    let (document, places) = (Document::new(text), Places::new(text));
    document.hover(places.byte(at)).map_or(Value::Null, |hover| {
        let [from, to] = places.span(hover.span);
        json!({ "from": from, "to": to, "text": hover.text })
    })
}

/// The changes that give the name at a place another; without a name, the name at the place.
pub fn rename(text: &str, at: u32, name: &str) -> Value {
    let (document, places) = (Document::new(text), Places::new(text));
    let at = places.byte(at);
    if name.is_empty() {
        return match document.renameable(at) {
            Ok((name, _)) => json!({ "name": name }),
            Err(why) => json!({ "refused": why }),
        };
    }
    match document.rename(at, name) {
        Ok(edits) => json!({ "edits": places.edits(&edits) }),
        Err(why) => json!({ "refused": why }),
    }
}

/// Where the name at a place is declared.
pub fn definition(text: &str, at: u32) -> Value {
    let (document, places) = (Document::new(text), Places::new(text));
    document.definition(places.byte(at)).map_or(Value::Null, |span| json!(places.span(span)))
}

/// Sections and what they declare.
pub fn outline(text: &str) -> Value {
    let (document, places) = (Document::new(text), Places::new(text));
    fn items(list: &[Item], places: &Places<'_>) -> Value {
        let one = |item: &Item| {
            let [from, to] = places.span(item.place);
            let within = items(&item.items, places);
            json!({ "name": item.name, "detail": item.detail, "from": from, "to": to, "items": within })
        };
        list.iter().map(one).collect()
    }
    items(&document.outline(), &places)
}

/// The text in the one style; nothing where it cannot be parsed.
pub fn format(text: &str) -> Value {
    match format::format(&Source::file("", text)) {
        Ok(text) => json!({ "text": text }),
        Err(_) => json!({ "refused": "the model cannot be parsed: mend its mistakes first" }),
    }
}
