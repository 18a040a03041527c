//! `hodograph serve`: the page and its model, for this machine alone.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

const MODEL: &str = "mechanism A;\nparameters { m: kg = 1 }\n";
const PAGE: &str = "<!DOCTYPE html>\n<html lang=\"en\">\n<script id=\"wasm\"></script></html>";

/// A server, which ends with the test.
struct Served {
    child: Child,
    port: u16,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn command(arguments: &[&Path]) -> Command {
    let mut command = Command::new(crate::common::tool());
    command.arg("serve").args(arguments).env_remove("HODOGRAPH_PAGE");
    command
}

fn serve(folder: &Path) -> Served {
    std::fs::write(folder.join("a.mech"), MODEL).unwrap();
    std::fs::write(folder.join("page.html"), PAGE).unwrap();
    let mut child = command(&[&folder.join("a.mech"), Path::new("--page"), &folder.join("page.html")])
        .args(["--port", "0"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
    let port = line.split("127.0.0.1:").nth(1).unwrap().split('/').next().unwrap().parse().unwrap();
    Served { child, port }
}

/// Status, head and body of an answer.
fn ask(served: &Served, method: &str, path: &str, host: &str) -> (u16, String, String) {
    let mut stream = TcpStream::connect(("127.0.0.1", served.port)).unwrap();
    write!(stream, "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    (head.split(' ').nth(1).unwrap().parse().unwrap(), head.to_owned(), body.to_owned())
}

#[test]
fn the_page_has_the_model_of_the_file_and_each_change_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let served = serve(folder.path());
    let host = format!("127.0.0.1:{}", served.port);
    let (status, head, body) = ask(&served, "GET", "/", &host);
    assert_eq!(status, 200);
    assert!(body.contains("<html lang=\"en\" data-served>"), "{body}");
    assert!(head.contains("Content-Security-Policy: default-src 'none'"), "{head}");
    let model = |after: &str| ask(&served, "GET", &format!("/model?after={after}"), &host);
    let (status, _, body) = model("");
    let first: serde_json::Value = serde_json::from_str(&body).unwrap();
    assert_eq!((status, first["text"].as_str(), first["name"].as_str()), (200, Some(MODEL), Some("a.mech")));
    let version = first["version"].as_str().unwrap();
    assert_eq!(model(version).0, 204);
    std::fs::write(folder.path().join("a.derivation"), "derived").unwrap();
    let second: serde_json::Value = serde_json::from_str(&model(version).2).unwrap();
    assert_eq!(second["derivation"], "derived");
    std::fs::remove_file(folder.path().join("a.mech")).unwrap();
    let third: serde_json::Value = serde_json::from_str(&model(version).2).unwrap();
    assert!(third["fault"].as_str().unwrap().contains("there is no such file"), "{third}");
}

#[test]
fn other_hosts_methods_and_paths_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let served = serve(folder.path());
    let own = format!("localhost:{}", served.port);
    for (method, path, host, expected) in [
        ("GET", "/", "evil.example", 403),
        ("GET", "/model?after=", "127.0.0.1", 403),
        ("POST", "/", own.as_str(), 405),
        ("GET", "/../a.mech", own.as_str(), 404),
        ("GET", "/", own.as_str(), 200),
    ] {
        assert_eq!(ask(&served, method, path, host).0, expected, "{method} {path} {host}");
    }
}

#[test]
fn without_the_page_or_the_model_it_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let [model, page] = ["a.mech", "page.html"].map(|name| folder.path().join(name));
    let run = |page: &Path| {
        let output = command(&[&model, Path::new("--page"), page]).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    std::fs::write(&model, MODEL).unwrap();
    let (code, text) = run(&page);
    assert!(code == Some(2) && text.contains("playground/build") && text.contains("no such file"), "{text}");
    std::fs::write(&page, "<html>another</html>").unwrap();
    let (code, text) = run(&page);
    assert!(code == Some(2) && text.contains("is not the page"), "{text}");
    std::fs::write(&page, PAGE).unwrap();
    std::fs::remove_file(&model).unwrap();
    let (code, text) = run(&page);
    assert!(code == Some(1) && text.contains("cannot read"), "{text}");
}
