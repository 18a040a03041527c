//! Requests about a document.

use std::collections::HashMap;

use gen_lsp_types as lsp;
use hodograph_language::findings::Finding;
use hodograph_language::outline::Item;
use hodograph_language::text::{Edit, Encoding, Text};
use hodograph_language::{Document, Place, Span};

use super::convert::{self, Places};

/// A document and where its texts are.
pub struct Located<'a> {
    pub document: &'a Document,
    /// of the document, then of each file that it imports
    pub uris: Vec<lsp::Uri>,
    pub encoding: Encoding,
}

impl Located<'_> {
    fn edits(&self, file: usize, edits: Vec<Edit>) -> lsp::WorkspaceEdit {
        workspace_edit(self.uris[file].clone(), self.in_text(file, |places| places.edits(edits)))
    }

    /// Where a place is.
    pub fn location(&self, place: Place) -> lsp::Location {
        let range = self.in_text(place.file, |places| places.range(place.span));
        lsp::Location { uri: self.uris[place.file].clone(), range }
    }

    fn in_text<T>(&self, file: usize, ask: impl FnOnce(Places<'_>) -> T) -> T {
        let encoding = self.encoding;
        match self.document.imported(file) {
            None => ask(Places { text: self.document.text(), encoding }),
            Some(imported) => ask(Places { text: &Text::new(imported.text.clone()), encoding }),
        }
    }

    fn diagnostic(&self, finding: &Finding, file: usize) -> lsp::Diagnostic {
        let itself = Place { file, span: if file == 0 { finding.span } else { finding.place.span } };
        let here = |(place, _): &&(Place, String)| *place != itself;
        let related = finding.related.iter().filter(here).map(|(place, message)| {
            lsp::DiagnosticRelatedInformation { location: self.location(*place), message: message.clone() }
        });
        let severity = match finding.is_error {
            true => lsp::DiagnosticSeverity::Error,
            false => lsp::DiagnosticSeverity::Warning,
        };
        lsp::Diagnostic {
            range: self.location(itself).range,
            severity: Some(severity),
            code: Some(lsp::Code::String(finding.code.to_owned())),
            source: Some("hodograph".to_owned()),
            message: lsp::Message::String(finding.message.clone()),
            tags: finding.is_unused.then(|| vec![lsp::DiagnosticTag::Unnecessary]),
            related_information: Some(related.collect()),
            ..lsp::Diagnostic::default()
        }
    }
}

/// The findings of a document as the protocol writes them: all where they stand in the document itself, or those
/// that stand in a file that it imports.
pub fn diagnostics(of: Located<'_>, file: usize) -> Vec<lsp::Diagnostic> {
    let findings = of.document.findings();
    let there = findings.iter().filter(|finding| file == 0 || finding.place.file == file);
    there.map(|finding| of.diagnostic(finding, file)).collect()
}

fn markdown(value: String) -> lsp::MarkupContent {
    lsp::MarkupContent { kind: lsp::MarkupKind::Markdown, value }
}

pub fn hover(document: &Document, places: Places<'_>, at: lsp::Position) -> Option<lsp::Hover> {
    let hover = document.hover(places.offset(at))?;
    let contents = lsp::Contents::MarkupContent(markdown(hover.text));
    Some(lsp::Hover { contents, range: Some(places.range(hover.span)) })
}

pub fn completion(document: &Document, places: Places<'_>, at: lsp::Position) -> lsp::CompletionList {
    let proposals = document.completion(places.offset(at));
    let item = |(i, proposal): (usize, hodograph_language::completion::Proposal)| lsp::CompletionItem {
        kind: Some(convert::proposed(proposal.kind)),
        detail: Some(proposal.detail).filter(|detail| !detail.is_empty()),
        documentation: (!proposal.docs.is_empty())
            .then(|| lsp::Documentation::MarkupContent(markdown(proposal.docs))),
        // in the order in which they are proposed
        sort_text: Some(format!("{i:05}")),
        label: proposal.label,
        ..lsp::CompletionItem::default()
    };
    let items = proposals.into_iter().enumerate().map(item).collect();
    lsp::CompletionList { items, ..lsp::CompletionList::default() }
}

pub fn signature(document: &Document, places: Places<'_>, at: lsp::Position) -> Option<lsp::SignatureHelp> {
    let signature = document.signature(places.offset(at))?;
    let inner = signature.form.split_once('(').and_then(|(_, rest)| rest.rsplit_once(')'));
    let arguments =
        inner.map_or("", |(arguments, _)| arguments).split(", ").filter(|argument| !argument.is_empty());
    let parameter = |argument: &str| lsp::ParameterInformation {
        label: lsp::ParameterInformationLabel::String(argument.to_owned()),
        documentation: None,
    };
    let information = lsp::SignatureInformation {
        label: signature.form.to_owned(),
        documentation: Some(lsp::Documentation::String(signature.meaning.to_owned())),
        parameters: Some(arguments.map(parameter).collect()),
        active_parameter: None,
    };
    Some(lsp::SignatureHelp {
        signatures: vec![information],
        active_signature: Some(0),
        active_parameter: Some(lsp::ActiveParameter::Int(signature.argument as u32)),
    })
}

pub fn references(
    document: &Document,
    places: Places<'_>,
    at: lsp::Position,
    with_declaration: bool,
) -> Vec<lsp::Range> {
    let found = document.references(places.offset(at), with_declaration);
    found.into_iter().map(|span| places.range(span)).collect()
}

pub fn outline(document: &Document, places: Places<'_>) -> Vec<lsp::DocumentSymbol> {
    document.outline().into_iter().map(|item| symbol(item, places)).collect()
}

fn symbol(item: Item, places: Places<'_>) -> lsp::DocumentSymbol {
    let kind = match (item.symbol, item.items.is_empty()) {
        (None, true) => lsp::SymbolKind::Property,
        (symbol, _) => convert::symbol(symbol),
    };
    let detail = Some(item.detail).filter(|detail| !detail.is_empty());
    let items = item.items.into_iter().map(|item| symbol(item, places)).collect();
    let (range, place) = (places.range(item.span), places.range(item.place));
    lsp::DocumentSymbol::new(item.name, detail, kind, None, None, range, place, Some(items))
}

pub fn folds(document: &Document) -> Vec<lsp::FoldingRange> {
    let fold = |fold: hodograph_language::outline::Fold| lsp::FoldingRange {
        start_line: fold.first,
        end_line: fold.last,
        kind: fold.is_comment.then_some(lsp::FoldingRangeKind::Comment),
        ..lsp::FoldingRange::default()
    };
    document.folds().into_iter().map(fold).collect()
}

pub fn colours(document: &Document, places: Places<'_>) -> lsp::SemanticTokens {
    let (mut line, mut character) = (0, 0);
    let mut data = Vec::new();
    for word in document.colours() {
        let range = places.range(word.span);
        let (token_type, token_modifiers_bitset) = convert::colour(word.kind, word.declares);
        let delta_line = range.start.line - line;
        let delta_start = range.start.character - if delta_line == 0 { character } else { 0 };
        let length = range.end.character - range.start.character;
        (line, character) = (range.start.line, range.start.character);
        data.push(lsp::SemanticToken { delta_line, delta_start, length, token_type, token_modifiers_bitset });
    }
    lsp::SemanticTokens { result_id: None, data }
}

pub fn hints(document: &Document, places: Places<'_>, range: lsp::Range) -> Vec<lsp::InlayHint> {
    let hints = document.hints(places.span(range));
    let hint = |hint: hodograph_language::hints::Hint| lsp::InlayHint {
        position: places.position(hint.offset),
        label: lsp::Label::String(hint.label),
        kind: Some(lsp::InlayHintKind::Type),
        text_edits: None,
        tooltip: None,
        padding_left: None,
        padding_right: Some(true),
        data: None,
    };
    hints.into_iter().map(hint).collect()
}

/// Changes that are offered for what a document finds within a place of its own text, or of one that it imports.
pub fn actions(of: Located<'_>, file: usize, within: Span) -> Vec<lsp::CodeAction> {
    let findings = of.document.findings();
    let offered = match file {
        0 => of.document.fixes(within),
        _ => of.document.fixes_with_parts(file, within),
    };
    let action = |action: hodograph_language::fixes::Action| lsp::CodeAction {
        title: action.title,
        kind: Some(lsp::CodeActionKind::QuickFix),
        diagnostics: findings.get(action.finding).map(|finding| vec![of.diagnostic(finding, file)]),
        is_preferred: Some(action.is_preferred),
        edit: Some(of.edits(action.file, action.edits)),
        ..lsp::CodeAction::default()
    };
    offered.into_iter().map(action).collect()
}

/// Changes of one document.
pub fn workspace_edit(uri: lsp::Uri, edits: Vec<lsp::TextEdit>) -> lsp::WorkspaceEdit {
    let changes = HashMap::from([(uri, edits)]);
    lsp::WorkspaceEdit { changes: Some(changes), ..lsp::WorkspaceEdit::default() }
}
