//! `hodograph serve`: the page in a browser of this machine, with the model of a file.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};

use hodograph_generator::artifact::{MAX_BYTES as MAX_DERIVATION, place};
use hodograph_generator::files;
use serde_json::json;
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};

use crate::output;
use crate::stop::{Outcome, Stop};

/// Show a model in a browser of this machine: its mechanism moves beside its text, anew whenever the file changes
///
///   hodograph serve pendulum.mech
///
/// The page is one file, which `playground/build` makes: `hodograph.html`. It is looked for beside this program, or
/// where --page says. Only this machine can reach it.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// the file of the page [default: hodograph.html beside this program]
    #[arg(long, value_name = "FILE", env = "HODOGRAPH_PAGE")]
    page: Option<PathBuf>,
    /// the port on 127.0.0.1; 0 takes any that is free
    #[arg(long, value_name = "NUMBER", default_value_t = 4640)]
    port: u16,
}

/// Largest page, in bytes.
const MAX_PAGE: usize = 16 << 20;
/// Largest model, in bytes.
const MAX_MODEL: usize = 4 << 20;
/// The beginning of the page, and its replacement in a page that is served.
const HEAD: [&str; 2] = ["<html lang=\"en\">", "<html lang=\"en\" data-served>"];
/// The content security policy: the page may run its own scripts and connect to this server.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; style-src 'unsafe-inline'; \
                      worker-src blob:; connect-src 'self'; img-src data: blob:; frame-src 'self'; base-uri 'none'; form-action 'none'";

/// Runs the command, until it is interrupted.
///
/// # Errors
///
/// [`Stop::Call`] if there is no page; [`Stop::Fault`] if the model cannot be read or the port is taken.
pub fn run(arguments: &Arguments) -> Outcome {
    let page = page(arguments.page.as_deref())?;
    let model = &arguments.model;
    files::text(model, MAX_MODEL)
        .map_err(|error| Stop::Fault(format!("cannot read {}: {error}", model.display())))?;
    let server = Server::http((Ipv4Addr::LOCALHOST, arguments.port))
        .map_err(|error| Stop::Fault(format!("cannot serve on port {}: {error}", arguments.port)))?;
    let port = server.server_addr().to_ip().map_or(arguments.port, |address| address.port());
    output::say(format_args!("serving {} at http://127.0.0.1:{port}/ (Ctrl-C ends)", model.display()));
    for request in server.incoming_requests() {
        let response = answer(&request, &page, model, port);
        // A client that has gone away needs no answer.
        let _ = request.respond(response);
    }
    Ok(())
}

/// The text of the page.
fn page(named: Option<&Path>) -> Outcome<String> {
    let beside = || Some(std::env::current_exe().ok()?.parent()?.join("hodograph.html"));
    let Some(path) = named.map(Path::to_owned).or_else(beside) else {
        return Err(Stop::Call("it is not known where this program is: name the page by --page".to_owned()));
    };
    let cure = "`playground/build` in the repository makes it, as playground/dist/hodograph.html: put it there, or name it by --page";
    let text = files::text(&path, MAX_PAGE)
        .map_err(|error| Stop::Call(format!("there is no page at {}: {error}; {cure}", path.display())))?;
    if !text.contains(HEAD[0]) || !text.contains("id=\"wasm\"") {
        return Err(Stop::Call(format!("{} is not the page of Hodograph: {cure}", path.display())));
    }
    Ok(text.replacen(HEAD[0], HEAD[1], 1))
}

type Answer = Response<std::io::Cursor<Vec<u8>>>;

fn answer(request: &Request, page: &str, model: &Path, port: u16) -> Answer {
    let plain = |code: u16, text: &str| with(text.as_bytes().to_vec(), code, "text/plain; charset=utf-8");
    // Refuse requests under another host name that resolves to this machine (DNS rebinding).
    let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let host = request.headers().iter().find(|header| header.field.equiv("Host"));
    if !host.is_some_and(|header| hosts.iter().any(|host| host == header.value.as_str())) {
        return plain(403, "this page is served to 127.0.0.1 only\n");
    }
    if !matches!(request.method(), Method::Get | Method::Head) {
        return plain(405, "only GET\n");
    }
    let (path, query) = request.url().split_once('?').unwrap_or((request.url(), ""));
    match path {
        "/" => with(page.as_bytes().to_vec(), 200, "text/html; charset=utf-8"),
        "/model" => {
            let known = query.strip_prefix("after=").unwrap_or("");
            let (version, text) = current(model);
            match known == version {
                true => with(Vec::new(), 204, "application/json"),
                false => with(text.into_bytes(), 200, "application/json"),
            }
        }
        _ => plain(404, "there is the page `/` and its model `/model`\n"),
    }
}

fn with(body: Vec<u8>, code: u16, kind: &str) -> Answer {
    let headers = [
        ("Content-Type", kind),
        ("Cache-Control", "no-store"),
        ("X-Content-Type-Options", "nosniff"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
        ("Referrer-Policy", "no-referrer"),
        ("Content-Security-Policy", POLICY),
    ];
    let response = Response::from_data(body).with_status_code(StatusCode(code));
    headers
        .iter()
        .filter_map(|(name, value)| Header::from_bytes(name.as_bytes(), value.as_bytes()).ok())
        .fold(response, Response::with_header)
}

/// The model and its derivation, if there is one, as JSON; and a tag that changes with the answer.
fn current(model: &Path) -> (String, String) {
    let name = model.file_name().unwrap_or_default().to_string_lossy();
    let text = files::text(model, MAX_MODEL);
    let imported = imported(model);
    let kept = files::text(&place::beside(model), MAX_DERIVATION).unwrap_or_default();
    let mut hasher = DefaultHasher::new();
    text.as_ref().map_err(ToString::to_string).hash(&mut hasher);
    kept.hash(&mut hasher);
    imported.iter().for_each(|(name, text)| (name, text.as_str()).hash(&mut hasher));
    let version = format!("{:016x}", hasher.finish());
    let answer = match text {
        Ok(text) => {
            json!({ "version": version, "name": name, "text": text, "files": imported, "derivation": kept })
        }
        Err(error) => json!({ "version": version, "name": name, "fault": format!("{name}: {error}") }),
    };
    (version, answer.to_string())
}

/// The files that a model imports, by their paths from its folder.
fn imported(model: &Path) -> serde_json::Map<String, serde_json::Value> {
    let name = model.file_name().unwrap_or_default().to_string_lossy();
    let source = files::model_as(name, model);
    let texts = source.imported().map(|file| (file.name().to_owned(), file.text().unwrap_or("").into()));
    texts.collect()
}
