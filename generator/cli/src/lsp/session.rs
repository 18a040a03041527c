//! The order of the protocol: what a client says, and what it is answered.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use gen_lsp_types as lsp;
use hodograph_generator::files;
use hodograph_language::text::{Edit, Encoding, Text};
use hodograph_language::{Document, Place};
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::answers;
use super::convert::{MODIFIERS, Places, TYPES};
use super::documents::{Documents, Settled};
use super::jobs::{self, Finished, Jobs, Tell};
use super::lenses::Derivations;
use super::rename;
use super::uri;
use super::wire::Incoming;

/// Where a connection stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    New,
    Running,
    ShutDown,
    /// it is over, as the protocol says or not
    Ended(bool),
}

/// Why a request is not answered.
struct Refused(ErrorCode, String);

type Answer = Result<Value, Refused>;

/// A connection.
pub struct Session {
    phase: Phase,
    documents: Documents,
    /// dimensions are shown beside names
    hints: bool,
    shows_documents: bool,
    refreshes_lenses: bool,
    watches_files: bool,
    /// it was said that Rust files are not read
    declined: bool,
    derivations: Derivations,
    /// the folders that the client works in
    folders: Vec<PathBuf>,
    jobs: Jobs,
    requests: i32,
    outgoing: Vec<Value>,
}

impl Session {
    /// Before the client has said anything.
    pub fn new(tell: Tell) -> Session {
        Session {
            phase: Phase::New,
            documents: Documents::default(),
            hints: false,
            shows_documents: false,
            refreshes_lenses: false,
            watches_files: false,
            declined: false,
            derivations: Derivations::default(),
            folders: Vec::new(),
            jobs: Jobs::new(tell),
            requests: 0,
            outgoing: Vec::new(),
        }
    }

    /// What is to be sent.
    pub fn outgoing(&mut self) -> Vec<Value> {
        std::mem::take(&mut self.outgoing)
    }

    /// Whether it is over, and in order.
    pub fn ended(&self) -> Option<bool> {
        if let Phase::Ended(in_order) = self.phase { Some(in_order) } else { None }
    }

    /// The client has closed the connection.
    pub fn end(&mut self) {
        self.phase = Phase::Ended(true);
    }

    /// Takes what the client sent.
    pub fn receive(&mut self, incoming: Incoming) {
        match incoming {
            Incoming::Malformed(why) => {
                let error = json!({ "code": ErrorCode::ParseError as i32, "message": why });
                self.outgoing.push(json!({ "jsonrpc": "2.0", "id": null, "error": error }));
            }
            // answers to what the server asked: nothing follows from them
            Incoming::Message(Message::Response(_)) => {}
            Incoming::Message(Message::Notification(notification)) => self.notified(notification),
            Incoming::Message(Message::Request(request)) => self.requested(request),
        }
    }

    /// Reads the texts that have changed and sends what is wrong with them.
    pub fn settle(&mut self) {
        for Settled { name, version, diagnostics } in self.documents.settle() {
            let uri = lsp::Uri(name);
            let params = lsp::PublishDiagnosticsParams { uri, version: Some(version), diagnostics };
            self.tell("textDocument/publishDiagnostics", &json!(params));
        }
    }

    /// A command has ended.
    pub fn finished(&mut self, job: Finished) {
        match job.result {
            Ok(None) => {
                self.answer(job.id, Ok(Value::Null));
                if self.refreshes_lenses {
                    self.ask("workspace/codeLens/refresh", &Value::Null);
                }
            }
            Ok(Some(page)) => {
                let uri = uri::of(&page);
                self.answer(job.id, Ok(json!({ "uri": uri, "path": page })));
                if self.shows_documents {
                    self.ask("window/showDocument", &json!({ "uri": uri, "external": true }));
                }
            }
            Err(why) => {
                self.tell("window/showMessage", &json!({ "type": 1, "message": why }));
                self.answer(job.id, Err(Refused(ErrorCode::RequestFailed, why)));
            }
        }
    }

    fn tell(&mut self, method: &str, params: &Value) {
        self.outgoing.push(json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn ask(&mut self, method: &str, params: &Value) {
        self.requests += 1;
        let mut message = json!({ "jsonrpc": "2.0", "id": self.requests, "method": method });
        if !params.is_null() {
            message["params"] = params.clone();
        }
        self.outgoing.push(message);
    }

    fn answer(&mut self, id: RequestId, answer: Answer) {
        self.outgoing.push(match answer {
            Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
            Err(Refused(code, message)) => {
                let error = json!({ "code": code as i32, "message": message });
                json!({ "jsonrpc": "2.0", "id": id, "error": error })
            }
        });
    }

    fn notified(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        if method == "exit" {
            self.phase = Phase::Ended(self.phase == Phase::ShutDown);
            return;
        }
        if self.phase != Phase::Running {
            return;
        }
        let read = match method.as_str() {
            "textDocument/didOpen" => self.opened(params),
            "textDocument/didChange" => self.changed(params),
            "textDocument/didClose" => self.closed(params),
            "workspace/didChangeWatchedFiles" => self.watched(params),
            "initialized" => {
                self.watch();
                Ok(())
            }
            "workspace/didChangeConfiguration" => {
                let hints = &params["settings"]["hodograph"]["inlayHints"];
                self.hints = hints.as_bool().unwrap_or(self.hints);
                Ok(())
            }
            _ => Ok(()),
        };
        if let Err(Refused(_, why)) = read {
            let message = format!("{method}: {why}");
            self.tell("window/logMessage", &json!({ "type": 2, "message": message }));
        }
    }

    /// Asks to be told of files that change.
    fn watch(&mut self) {
        if self.watches_files {
            let watchers = json!([{ "globPattern": "**/*.mech" }]);
            let method = "workspace/didChangeWatchedFiles";
            let watched =
                json!({ "id": "models", "method": method, "registerOptions": { "watchers": watchers } });
            self.ask("client/registerCapability", &json!({ "registrations": [watched] }));
        }
    }

    fn opened(&mut self, params: Value) -> Result<(), Refused> {
        let lsp::TextDocumentItem { uri, version, text, .. } =
            arguments::<lsp::DidOpenTextDocumentParams>(params)?.text_document;
        if uri.0.ends_with(".rs") {
            if !self.declined {
                self.declined = true;
                let message = "models within Rust files are checked by the compiler and by `hodograph check`; here `.mech` files are read only";
                self.tell("window/showMessage", &json!({ "type": 3, "message": message }));
            }
            return Ok(());
        }
        self.documents.open(uri.0, text, version);
        Ok(())
    }

    fn changed(&mut self, params: Value) -> Result<(), Refused> {
        let lsp::DidChangeTextDocumentParams { text_document, content_changes } = arguments(params)?;
        let encoding = self.documents.encoding;
        let uri = text_document.text_document_identifier.uri.0;
        let unknown = || Refused(ErrorCode::InvalidParams, format!("{uri} is not open"));
        let mut text = self.documents.get(&uri).ok_or_else(unknown)?.text.clone();
        for change in content_changes {
            text = Text::new(match change {
                lsp::TextDocumentContentChangeEvent::TextDocumentContentChangePartial(change) => {
                    let span = Places { text: &text, encoding }.span(change.range);
                    text.edited(&Edit { span, text: change.text })
                }
                lsp::TextDocumentContentChangeEvent::TextDocumentContentChangeWholeDocument(change) => {
                    change.text
                }
            });
        }
        self.documents.change(&uri, text, text_document.version);
        Ok(())
    }

    fn closed(&mut self, params: Value) -> Result<(), Refused> {
        let uri = arguments::<lsp::DidCloseTextDocumentParams>(params)?.text_document.uri;
        if self.documents.close(&uri.0) {
            let none = json!({ "uri": uri, "diagnostics": [] });
            self.tell("textDocument/publishDiagnostics", &none);
        }
        Ok(())
    }

    /// Files have changed that may not be open.
    fn watched(&mut self, params: Value) -> Result<(), Refused> {
        let changes = arguments::<lsp::DidChangeWatchedFilesParams>(params)?.changes;
        for path in changes.into_iter().filter_map(|change| uri::path(&change.uri.0)) {
            self.documents.file_has_changed(&files::key(&path));
        }
        Ok(())
    }

    fn requested(&mut self, request: Request) {
        let Request { id, method, params } = request;
        let running = match (self.phase, method.as_str()) {
            (Phase::Running, "initialize") => {
                Err(Refused(ErrorCode::InvalidRequest, "the server is initialized".to_owned()))
            }
            (Phase::New, "initialize") | (Phase::Running, _) => Ok(()),
            (Phase::New, _) => {
                Err(Refused(ErrorCode::ServerNotInitialized, "`initialize` comes first".to_owned()))
            }
            _ => Err(Refused(ErrorCode::InvalidRequest, "the server was shut down".to_owned())),
        };
        if let Err(refused) = running {
            return self.answer(id, Err(refused));
        }
        if method == "workspace/executeCommand" {
            return match self.command(&id, params) {
                // answered when the command has ended
                Ok(()) => {}
                Err(refused) => self.answer(id, Err(refused)),
            };
        }
        let answer = catch_unwind(AssertUnwindSafe(|| self.result(&method, params))).unwrap_or_else(|_| {
            let why = "please report it with the model".to_owned();
            Err(Refused(ErrorCode::InternalError, format!("{method} failed: {why}")))
        });
        self.answer(id, answer);
    }

    fn result(&mut self, method: &str, params: Value) -> Answer {
        match method {
            "initialize" => self.initialize(params),
            "shutdown" => {
                self.phase = Phase::ShutDown;
                Ok(Value::Null)
            }
            "textDocument/hover" => {
                self.at(params, |p: lsp::HoverParams| p.text_document_position_params, answers::hover)
            }
            "textDocument/completion" => self.at(
                params,
                |p: lsp::CompletionParams| p.text_document_position_params,
                answers::completion,
            ),
            "textDocument/signatureHelp" => self.at(
                params,
                |p: lsp::SignatureHelpParams| p.text_document_position_params,
                answers::signature,
            ),
            "textDocument/definition" => self.definition(params),
            "textDocument/references" => {
                let uri = params["textDocument"]["uri"].clone();
                let with = params["context"]["includeDeclaration"].as_bool().unwrap_or(true);
                let place = |p: lsp::ReferenceParams| p.text_document_position_params;
                self.at(params, place, |document, places, at| {
                    let found = answers::references(document, places, at, with);
                    found.into_iter().map(|range| json!({ "uri": uri, "range": range })).collect::<Vec<_>>()
                })
            }
            "textDocument/documentHighlight" => {
                let place = |p: lsp::DocumentHighlightParams| p.text_document_position_params;
                self.at(params, place, |document, places, at| {
                    let found = answers::references(document, places, at, true);
                    found.into_iter().map(|range| json!({ "range": range })).collect::<Vec<_>>()
                })
            }
            "textDocument/prepareRename" => self.prepare_rename(params),
            "textDocument/rename" => self.rename(params),
            "textDocument/documentSymbol" => self.whole(params, answers::outline),
            "textDocument/foldingRange" => self.whole(params, |document, _| answers::folds(document)),
            "textDocument/semanticTokens/full" => self.whole(params, answers::colours),
            "textDocument/formatting" => {
                self.whole(params, |document, places| document.layout().map(|edits| places.edits(edits)))
            }
            "textDocument/inlayHint" => {
                let shown = self.hints;
                let range = arguments::<lsp::InlayHintParams>(params.clone())?.range;
                self.whole(
                    params,
                    |document, places| {
                        if shown { answers::hints(document, places, range) } else { Vec::new() }
                    },
                )
            }
            "textDocument/codeAction" => self.actions(params),
            "textDocument/codeLens" => self.lenses(params),
            _ => Err(Refused(ErrorCode::MethodNotFound, format!("there is no method `{method}`"))),
        }
    }

    fn initialize(&mut self, params: Value) -> Answer {
        let folders = params["workspaceFolders"].as_array().into_iter().flatten();
        let uris = folders.map(|folder| &folder["uri"]).chain([&params["rootUri"]]);
        self.folders = uris.filter_map(|uri| uri::path(uri.as_str()?)).collect();
        let lsp::InitializeParams { capabilities, initialization_options, .. } = arguments(params)?;
        let encodings =
            capabilities.general.and_then(|general| general.position_encodings).unwrap_or_default();
        let chosen = encodings.into_iter().find_map(|encoding| match encoding {
            lsp::PositionEncodingKind::UTF8 => Some(Encoding::Utf8),
            lsp::PositionEncodingKind::UTF16 => Some(Encoding::Utf16),
            lsp::PositionEncodingKind::UTF32 => Some(Encoding::Utf32),
            lsp::PositionEncodingKind::Custom(_) => None,
        });
        self.documents.encoding = chosen.unwrap_or_default();
        let window = capabilities.window.and_then(|window| window.show_document);
        self.shows_documents = window.is_some_and(|show| show.support);
        let workspace = capabilities.workspace.unwrap_or_default();
        let watched = workspace.did_change_watched_files;
        self.watches_files = watched.and_then(|watched| watched.dynamic_registration).unwrap_or(false);
        let lenses = workspace.code_lens;
        self.refreshes_lenses = lenses.and_then(|lenses| lenses.refresh_support).unwrap_or(false);
        let options = initialization_options.unwrap_or_default();
        self.hints = options["inlayHints"].as_bool().unwrap_or(false);
        self.phase = Phase::Running;
        to_value(lsp::InitializeResult {
            capabilities: capabilities_of(self.documents.encoding),
            server_info: Some(lsp::ServerInfo {
                name: "hodograph".to_owned(),
                version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            }),
        })
    }

    /// The document of a request.
    fn open(&mut self, uri: &lsp::Uri) -> Result<(&Document, Places<'_>), Refused> {
        let encoding = self.documents.encoding;
        let unknown = || Refused(ErrorCode::InvalidParams, format!("{} is not open", uri.0));
        let document = self.documents.document(&uri.0).ok_or_else(unknown)?;
        Ok((document, Places { text: document.text(), encoding }))
    }

    /// Answers a request about a place.
    fn at<P: DeserializeOwned, R: Serialize>(
        &mut self,
        params: Value,
        place: impl Fn(P) -> lsp::TextDocumentPositionParams,
        answer: impl Fn(&Document, Places<'_>, lsp::Position) -> R,
    ) -> Answer {
        let place = place(arguments(params)?);
        let (document, places) = self.open(&place.text_document.uri)?;
        to_value(answer(document, places, place.position))
    }

    /// Answers a request about a whole document.
    fn whole<R: Serialize>(&mut self, params: Value, answer: impl Fn(&Document, Places<'_>) -> R) -> Answer {
        let identifier: lsp::TextDocumentIdentifier = arguments(params["textDocument"].clone())?;
        let (document, places) = self.open(&identifier.uri)?;
        to_value(answer(document, places))
    }

    fn definition(&mut self, params: Value) -> Answer {
        let place = arguments::<lsp::DefinitionParams>(params)?.text_document_position_params;
        let uri = place.text_document.uri;
        let (document, places) = self.open(&uri)?;
        let found: Option<Place> = document.definition(places.offset(place.position));
        let document = self.documents.get(&uri.0).and_then(|open| open.document.as_ref());
        let location = |(found, document)| self.documents.located(document, &uri.0).location(found);
        to_value(found.zip(document).map(location))
    }

    /// Changes that the document offers, and those that models offer that import it.
    fn actions(&mut self, params: Value) -> Answer {
        let lsp::CodeActionParams { text_document, range, .. } = arguments(params)?;
        let name = text_document.uri.0.as_str();
        let (_, places) = self.open(&text_document.uri)?;
        let within = places.span(range);
        let key = self.documents.get(name).map_or("", |open| open.key());
        let mut actions = Vec::new();
        for (other, open) in self.documents.iter() {
            let file = if other == name { Some(0) } else { open.imports(key) };
            if let Some((document, file)) = open.document.as_ref().zip(file) {
                actions.extend(answers::actions(self.documents.located(document, other), file, within));
            }
        }
        to_value(actions)
    }

    fn prepare_rename(&mut self, params: Value) -> Answer {
        let place = arguments::<lsp::PrepareRenameParams>(params)?.text_document_position_params;
        let (document, places) = self.open(&place.text_document.uri)?;
        let failed = |why| Refused(ErrorCode::RequestFailed, why);
        let (name, span) = document.renameable(places.offset(place.position)).map_err(failed)?;
        to_value(lsp::PrepareRenamePlaceholder { range: places.range(span), placeholder: name })
    }

    fn rename(&mut self, params: Value) -> Answer {
        let lsp::RenameParams { new_name, text_document_position_params: place, .. } = arguments(params)?;
        let uri = place.text_document.uri;
        let (_, places) = self.open(&uri)?;
        let at = places.offset(place.position);
        let failed = |why| Refused(ErrorCode::RequestFailed, why);
        let edit = rename::rename(&mut self.documents, &uri.0, at, &new_name, &self.folders);
        to_value(edit.map_err(failed)?)
    }

    fn lenses(&mut self, params: Value) -> Answer {
        let uri = arguments::<lsp::CodeLensParams>(params)?.text_document.uri;
        let Some(path) = uri::path(&uri.0) else { return Ok(json!([])) };
        let mut derivations = std::mem::take(&mut self.derivations);
        let opened = self.open(&uri);
        let lenses = opened.map(|(document, places)| derivations.lenses(document, places, &uri.0, &path));
        self.derivations = derivations;
        to_value(lenses?)
    }

    /// Starts a command on a model as it is in its file.
    fn command(&mut self, id: &RequestId, params: Value) -> Result<(), Refused> {
        let lsp::ExecuteCommandParams { command, arguments: list, .. } = arguments(params)?;
        let invalid = |why: String| Refused(ErrorCode::InvalidParams, why);
        if !jobs::ALL.contains(&command.as_str()) {
            return Err(invalid(format!("there is no command `{command}`")));
        }
        let uri = list.and_then(|list| Some(list.first()?.as_str()?.to_owned()));
        let uri = uri.ok_or_else(|| invalid("the command needs the URI of a model".to_owned()))?;
        let path: PathBuf = uri::path(&uri).ok_or_else(|| invalid(format!("{uri} is no file")))?;
        let failed = |why: String| Refused(ErrorCode::RequestFailed, why);
        if let Some(open) = self.documents.get(&uri) {
            let saved = std::fs::read_to_string(&path).unwrap_or_default();
            if saved.trim_start_matches('\u{feff}') != open.text.as_str().trim_start_matches('\u{feff}') {
                return Err(failed("save the model first: the command reads its file".to_owned()));
            }
        }
        self.jobs.start(id.clone(), &command, &path).map_err(failed)
    }
}

fn arguments<P: DeserializeOwned>(params: Value) -> Result<P, Refused> {
    serde_json::from_value(params).map_err(|error| Refused(ErrorCode::InvalidParams, error.to_string()))
}

fn to_value(answer: impl Serialize) -> Answer {
    serde_json::to_value(answer).map_err(|error| Refused(ErrorCode::InternalError, error.to_string()))
}

/// What the server offers.
fn capabilities_of(encoding: Encoding) -> lsp::ServerCapabilities {
    let words = |list: &[&str]| list.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let legend = lsp::SemanticTokensLegend { token_types: words(&TYPES), token_modifiers: words(&MODIFIERS) };
    let colours = lsp::SemanticTokensOptions {
        legend,
        full: Some(lsp::Full::Bool(true)),
        ..lsp::SemanticTokensOptions::default()
    };
    let sync = lsp::TextDocumentSyncOptions {
        open_close: Some(true),
        change: Some(lsp::TextDocumentSyncKind::Incremental),
        ..lsp::TextDocumentSyncOptions::default()
    };
    lsp::ServerCapabilities {
        position_encoding: Some(match encoding {
            Encoding::Utf8 => lsp::PositionEncodingKind::UTF8,
            Encoding::Utf16 => lsp::PositionEncodingKind::UTF16,
            Encoding::Utf32 => lsp::PositionEncodingKind::UTF32,
        }),
        text_document_sync: Some(lsp::TextDocumentSync::Options(sync)),
        completion_provider: Some(lsp::CompletionOptions {
            trigger_characters: Some(words(&[".", ":"])),
            ..lsp::CompletionOptions::default()
        }),
        hover_provider: Some(lsp::HoverProvider::Bool(true)),
        signature_help_provider: Some(lsp::SignatureHelpOptions {
            trigger_characters: Some(words(&["(", ","])),
            ..lsp::SignatureHelpOptions::default()
        }),
        definition_provider: Some(lsp::DefinitionProvider::Bool(true)),
        references_provider: Some(lsp::ReferencesProvider::Bool(true)),
        document_highlight_provider: Some(lsp::DocumentHighlightProvider::Bool(true)),
        document_symbol_provider: Some(lsp::DocumentSymbolProvider::Bool(true)),
        code_action_provider: Some(lsp::CodeActionProvider::CodeActionOptions(lsp::CodeActionOptions {
            code_action_kinds: Some(vec![lsp::CodeActionKind::QuickFix]),
            ..lsp::CodeActionOptions::default()
        })),
        code_lens_provider: Some(lsp::CodeLensOptions::default()),
        document_formatting_provider: Some(lsp::DocumentFormattingProvider::Bool(true)),
        rename_provider: Some(lsp::RenameProvider::RenameOptions(lsp::RenameOptions {
            prepare_provider: Some(true),
            ..lsp::RenameOptions::default()
        })),
        folding_range_provider: Some(lsp::FoldingRangeProvider::Bool(true)),
        execute_command_provider: Some(lsp::ExecuteCommandOptions {
            commands: words(&jobs::ALL),
            ..lsp::ExecuteCommandOptions::default()
        }),
        semantic_tokens_provider: Some(lsp::SemanticTokensProvider::SemanticTokensOptions(colours)),
        inlay_hint_provider: Some(lsp::InlayHintProvider::Bool(true)),
        ..lsp::ServerCapabilities::default()
    }
}
