//! The language server, through its protocol.

use std::path::Path;

use crate::client::{Client, URI};
use serde_json::{Value, json};

fn model(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// Line and character, in units of UTF-16, of a text in another.
fn place(text: &str, word: &str) -> (usize, usize) {
    let before = &text[..text.find(word).unwrap()];
    let line = before.matches('\n').count();
    (line, before.rsplit('\n').next().unwrap().encode_utf16().count())
}

fn range(value: &Value) -> [u64; 4] {
    let at = |end: &str, what: &str| value[end][what].as_u64().unwrap();
    [at("start", "line"), at("start", "character"), at("end", "line"), at("end", "character")]
}

#[test]
fn mistakes_are_shown_while_typing_and_mended() {
    let text = model("slider_crank.mech");
    let mut client = Client::started();
    client.open(URI, &text);
    assert_eq!(client.diagnostics(1), Vec::<Value>::new());
    let (line, start) = place(&text, "l1/2*A.x");
    client.change(2, [line, start, line, start + 2], "ll");
    let found = client.diagnostics(2);
    let unknown = found.iter().find(|found| found["code"] == "E020").unwrap();
    assert_eq!(range(&unknown["range"]), [line, start, line, start + 2].map(|n| n as u64));
    assert_eq!((&unknown["severity"], &unknown["source"]), (&json!(1), &json!("hodograph")));
    assert!(unknown["message"].as_str().unwrap().contains("did you mean `l1`?"), "{unknown}");
    assert_eq!(
        unknown["relatedInformation"][0]["location"]["range"]["start"]["line"],
        place(&text, "l1: m").0
    );
    let params = json!({ "textDocument": { "uri": URI }, "range": unknown["range"], "context": { "diagnostics": [] } });
    let actions = client.request("textDocument/codeAction", params)["result"].clone();
    let mend = &actions[0];
    assert_eq!((&mend["title"], &mend["isPreferred"]), (&json!("Change to `l1`"), &json!(true)));
    let edit = &mend["edit"]["changes"][URI][0];
    client.change(3, range(&edit["range"]).map(|n| n as usize), edit["newText"].as_str().unwrap());
    assert_eq!(client.diagnostics(3), Vec::<Value>::new());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn all_that_is_offered_is_answered() {
    let text = model("slider_crank.mech");
    let mut client = Client::started();
    client.open(URI, &text);
    let (line, at) = place(&text, "l2/2*B.x");
    let hover = client.ask("textDocument/hover", line, at, json!({}));
    let shown = hover["result"]["contents"]["value"].as_str().unwrap();
    assert!(shown.contains("l2: m = 0.5") && shown.contains("length of the connecting rod"), "{shown}");
    let declared = place(&text, "l2: m");
    let found = client.ask("textDocument/definition", line, at, json!({}));
    assert_eq!(
        range(&found["result"]["range"]),
        [declared.0, declared.1, declared.0, declared.1 + 2].map(|n| n as u64)
    );
    let context = json!({ "context": { "includeDeclaration": true } });
    let uses = client.ask("textDocument/references", line, at, context)["result"].as_array().unwrap().len();
    let marked =
        client.ask("textDocument/documentHighlight", line, at, json!({}))["result"].as_array().unwrap().len();
    assert_eq!((uses, marked), (6, 6));
    let proposals = client.ask("textDocument/completion", line, at, json!({}));
    let first = &proposals["result"]["items"][0];
    assert!(first["label"].is_string() && first["sortText"] == "00000");
    let (call, within) = place(&text, "dot(position(P)");
    let help = client.ask("textDocument/signatureHelp", call, within + 4, json!({}));
    assert_eq!(help["result"]["signatures"][0]["label"], "dot(v, w)");
    let ready = client.ask("textDocument/prepareRename", line, at, json!({}));
    assert_eq!(ready["result"]["placeholder"], "l2");
    let renamed = client.ask("textDocument/rename", line, at, json!({ "newName": "rod" }));
    assert_eq!(renamed["result"]["changes"][URI].as_array().unwrap().len(), uses);
    let clash = client.ask("textDocument/rename", line, at, json!({ "newName": "l1" }));
    assert!(clash["error"]["message"].as_str().unwrap().contains("already"), "{clash}");
    let document = json!({ "textDocument": { "uri": URI } });
    let outline = client.request("textDocument/documentSymbol", document.clone());
    assert_eq!(outline["result"][0]["name"], "parameters");
    assert_eq!(outline["result"][0]["children"].as_array().unwrap().len(), 11);
    assert!(
        !client.request("textDocument/foldingRange", document.clone())["result"]
            .as_array()
            .unwrap()
            .is_empty()
    );
    let colours = client.request("textDocument/semanticTokens/full", document.clone());
    let data = colours["result"]["data"].as_array().unwrap();
    assert!(data.len() > 500 && data.len().is_multiple_of(5));
    let options =
        json!({ "textDocument": { "uri": URI }, "options": { "tabSize": 4, "insertSpaces": true } });
    assert_eq!(client.request("textDocument/formatting", options)["result"], json!([]));
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 999, "character": 0 } });
    let hints = json!({ "textDocument": { "uri": URI }, "range": whole });
    // off, until they are asked for
    assert_eq!(client.request("textDocument/inlayHint", hints.clone())["result"], json!([]));
    client.notify(
        "workspace/didChangeConfiguration",
        json!({ "settings": { "hodograph": { "inlayHints": true } } }),
    );
    let shown = client.request("textDocument/inlayHint", hints);
    assert_eq!(shown["result"][0]["label"], ": m/s");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn lenses_tell_the_state_of_the_derivation_and_commands_run_on_saved_models() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pendulum ü.mech");
    let text = model("slider_crank.mech");
    std::fs::write(&path, &text).unwrap();
    let uri = format!("file://{}", path.display()).replace(' ', "%20").replace('ü', "%C3%BC");
    let mut client = Client::started();
    client.open(&uri, &text);
    let document = json!({ "textDocument": { "uri": uri } });
    let lenses = client.request("textDocument/codeLens", document.clone());
    let titles = |lenses: &Value| -> Vec<String> {
        let all = lenses["result"].as_array().unwrap();
        all.iter().map(|lens| lens["command"]["title"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(titles(&lenses), ["derive", "equations", "simulate"]);
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let kept = path.with_extension("derivation");
    std::fs::copy(models.join("slider_crank.derivation"), &kept).unwrap();
    assert_eq!(titles(&client.request("textDocument/codeLens", document.clone()))[0], "derivation is fresh");
    let run = |client: &mut Client, command: &str| {
        client.request("workspace/executeCommand", json!({ "command": command, "arguments": [uri] }))
    };
    let page = run(&mut client, "hodograph.equations")["result"]["path"].as_str().unwrap().to_owned();
    assert!(std::fs::read_to_string(page).unwrap().contains("<html"));
    std::fs::copy(models.join("pendulum.derivation"), &kept)
        .or_else(|_| std::fs::copy(models.join("two_sleds.derivation"), &kept))
        .unwrap();
    assert_eq!(
        titles(&client.request("textDocument/codeLens", document))[0],
        "derivation is stale: derive again"
    );
    // what is in the editor is not what is in the file
    std::fs::write(&path, "mechanism Other;").unwrap();
    let refused = run(&mut client, "hodograph.simulate");
    assert!(refused["error"]["message"].as_str().unwrap().contains("save the model first"), "{refused}");
    assert!(run(&mut client, "hodograph.none")["error"]["message"].is_string());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn positions_count_units_of_utf_16() {
    let text =
        "\u{feff}mechanism A;\r\nparameters {\r\n    /// 𝛼𝛽\r\n    ωπ: kg = 1, /* 𝛾 */ ζ: m = zz,\r\n}\r\n";
    let mut client = Client::started();
    client.open(URI, text);
    let found = client.diagnostics(1);
    let unknown = found.iter().find(|found| found["code"] == "E020").unwrap();
    assert_eq!(range(&unknown["range"]), [3, 32, 3, 34]);
    let hover = client.ask("textDocument/hover", 3, 4, json!({}));
    assert_eq!(range(&hover["result"]["range"]), [3, 4, 3, 6]);
    // beyond the letter that counts twice
    client.change(2, [3, 25, 3, 26], "η");
    assert_eq!(range(&client.diagnostics(2).iter().find(|f| f["code"] == "E020").unwrap()["range"])[1], 32);
    let hover = client.ask("textDocument/hover", 3, 25, json!({}));
    assert!(hover["result"]["contents"]["value"].as_str().unwrap().contains("η: m = zz"), "{hover}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn nonsense_is_answered_and_nothing_stops() {
    let mut client = Client::new();
    let early = client.request("textDocument/hover", json!({}));
    assert_eq!(early["error"]["code"], -32002);
    client.raw(b"Content-Length: 7\r\n\r\n{\"a\": 1");
    assert_eq!(client.receive()["error"]["code"], -32700);
    client.raw(b"hello\r\n\r\n");
    assert_eq!(client.receive()["error"]["code"], -32700);
    let answer = client.request("initialize", json!({ "capabilities": {} }));
    assert!(answer["result"]["serverInfo"]["name"] == "hodograph");
    assert_eq!(client.request("initialize", json!({}))["error"]["code"], -32600);
    assert_eq!(client.request("textDocument/nothing", json!({}))["error"]["code"], -32601);
    assert_eq!(client.request("textDocument/hover", json!([1, 2]))["error"]["code"], -32602);
    assert_eq!(client.ask("textDocument/hover", 0, 0, json!({}))["error"]["code"], -32602);
    client.change(1, [0, 0, 0, 0], "never opened");
    client.notify("textDocument/didOpen", json!({ "textDocument": 3 }));
    for text in [
        "\u{0}\u{1}\u{fffd}PK\u{3}\u{4}".to_owned(),
        "x".repeat(4 << 20) + "y",
        "a\rb\rc".to_owned(),
        "(".repeat(100_000),
    ] {
        client.open(URI, &text);
        let found = client.diagnostics(1);
        assert!(!found.is_empty(), "{}", &text[..3]);
        // far from any line
        let far = json!({});
        assert!(client.ask("textDocument/hover", 9_999_999, 9_999_999, far)["error"].is_null());
        client.change(2, [7, 7, 3, 3], "");
        client.diagnostics(2);
    }
    // Rust files are not read, which is said once
    client.open("file:///nowhere/lib.rs", "fn main() {}");
    let uri = json!({ "textDocument": { "uri": "file:///nowhere/lib.rs" } });
    assert_eq!(client.request("textDocument/foldingRange", uri)["error"]["code"], -32602);
    assert!(client.notifications.iter().any(|said| said["method"] == "window/showMessage"));
    client.request("shutdown", Value::Null);
    assert_eq!(client.request("shutdown", Value::Null)["error"]["code"], -32600);
    client.notify("exit", Value::Null);
    assert_eq!(client.child.wait().unwrap().code(), Some(0));
}

/// Numbers that are as good as random and always the same.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

/// Pieces of text that authors and accidents write.
const PIECES: &[&str] = &[
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    ";",
    ",",
    ":",
    "=",
    "+",
    "*",
    "/",
    "^",
    ".",
    " ",
    "\n",
    "\r\n",
    "//",
    "/*",
    "*/",
    "///",
    "0",
    "1e9",
    "q1",
    "l1",
    "N.x",
    "velocity(",
    "frames {",
    "dot(",
    "𝛼",
    "ü",
    "\u{0}",
    "speeds",
    "of",
    "rotate(z, q1)",
];

/// Random edits through the server: the text is inserted into, deleted from and restored, and now and then
/// something is asked. What the server says of the text is what `check` says of it.
fn random_edits(count: usize, between: usize, seed: u64) {
    let whole = model("slider_crank.mech");
    let mut random = Random(seed);
    let mut client = Client::started();
    client.open(URI, &whole);
    client.diagnostics(1);
    let (mut text, mut before) = (whole.clone(), Vec::new());
    let memory = |client: &Client| {
        let status =
            std::fs::read_to_string(format!("/proc/{}/status", client.child.id())).unwrap_or_default();
        let line = status.lines().find(|line| line.starts_with("VmRSS")).unwrap_or_default().to_owned();
        line.split_whitespace().nth(1).and_then(|size| size.parse::<u64>().ok()).unwrap_or(0)
    };
    let mut first = 0;
    for version in 2..count as i64 + 2 {
        let bound = |mut at: usize| {
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            // between a carriage return and its line feed there is no position
            if text[..at].ends_with('\r') { at - 1 } else { at }
        };
        let (start, end, new) = match random.below(4) {
            0 => {
                let at = bound(random.below(text.len() + 1));
                (at, at, PIECES[random.below(PIECES.len())].to_owned())
            }
            1 => {
                let start = bound(random.below(text.len() + 1));
                (start, bound((start + random.below(30)).min(text.len())).max(start), String::new())
            }
            // as it was before
            2 if !before.is_empty() => (0, text.len(), before.swap_remove(random.below(before.len()))),
            _ => (0, text.len(), whole.clone()),
        };
        let ([a, b], [c, d]) = (position(&text, start), position(&text, end));
        client.change(version, [a, b, c, d], &new);
        let after = [&text[..start], &new, &text[end..]].concat();
        before.push(std::mem::replace(&mut text, after));
        before.truncate(8);
        let methods = ["hover", "completion", "definition", "signatureHelp", "documentHighlight"];
        let method = format!("textDocument/{}", methods[random.below(methods.len())]);
        if random.below(8) == 0 {
            let [line, character] = position(&text, bound_of(&text, random.below(text.len() + 1)));
            assert!(client.ask(&method, line, character, json!({}))["error"].is_null());
        }
        if (version as usize).is_multiple_of(between) {
            let found = client.diagnostics(version);
            let source = hodograph_generator::source::Source::file("", text.as_str());
            let checked = hodograph_generator::check::check(&source).diagnostics;
            let said = |found: &Value| found["code"].as_str().unwrap().to_owned();
            let codes: Vec<String> = checked.iter().map(|found| found.code.0.to_owned()).collect();
            assert_eq!(found.iter().map(said).collect::<Vec<_>>(), codes, "version {version}:\n{text}");
            let starts = checked.iter().map(|d| position(&text, d.primary.span.start as usize));
            for (found, [line, character]) in found.iter().zip(starts) {
                assert_eq!(
                    range(&found["range"])[..2],
                    [line as u64, character as u64],
                    "{version}:\n{text}"
                );
            }
        }
        if version as usize == count / 4 {
            first = memory(&client);
        }
    }
    let last = memory(&client);
    println!("{count} edits; {first} KiB after a quarter of them, {last} KiB at the end");
    assert!(
        last < first + first / 2 + 8192,
        "{first} KiB after a quarter of the edits, {last} KiB at the end"
    );
    assert_eq!(client.end(), Some(0));
}

fn bound_of(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// Line and character of a byte, as the protocol counts: a carriage return alone ends a line too.
fn position(text: &str, at: usize) -> [usize; 2] {
    let before = &text[..bound_of(text, at.min(text.len()))];
    let ends = |(i, c): (usize, char)| c == '\n' || c == '\r' && !text[i + 1..].starts_with('\n');
    let line = before.char_indices().filter(|found| ends(*found)).count();
    let start = before.char_indices().rev().find(|found| ends(*found)).map_or(0, |(i, _)| i + 1);
    [line, before[start..].encode_utf16().count()]
}

#[test]
fn random_edits_end_where_check_does() {
    random_edits(400, 20, 1);
}

/// `cargo test --release -p hodograph-cli --no-default-features --test all -- --ignored --nocapture random_edits`
#[test]
#[ignore = "a hundred thousand edits take minutes"]
fn a_hundred_thousand_random_edits() {
    random_edits(100_000, 500, 7);
}

/// From a key to its diagnostics, through the protocol: each of the last keys of a text is typed, and its diagnostics
/// are awaited. Prints the half and the 95th of a hundred.
///
/// `cargo test --release -p hodograph-cli --no-default-features --test all -- --ignored --nocapture latency`
#[test]
#[ignore = "times are not held on machines that do other work; instructions are, by tests/benchmarks/instructions"]
fn latency_from_a_key_to_its_diagnostics() {
    let largest = model("arm_7dof.mech");
    let many: String =
        (0..2490).map(|i| format!("    /// place {i}\n    P{i} = O + {}*l*N.x + q1*N.y;\n", i + 1)).collect();
    let long = format!(
        "mechanism Long;\nparameters {{ l: m = 1, m: kg = 1 }}\ncoordinates {{ q1: m }}\nspeeds {{ u1: m/s }}\n\
         points {{\n{many}}}\nparticles {{ A {{ point: P1, mass: m }} }}\nloads {{ force on P1: 2*m/l*u1^2*N.y; }}\n"
    );
    let word: String = std::iter::once("l").chain(std::iter::repeat_n(" + l", 24)).collect();
    for (name, text, before) in
        [("the largest shipped model", largest.as_str(), "*"), ("5000 lines", long.as_str(), "*l*N.x")]
    {
        let mut client = Client::started();
        client.open(URI, text);
        client.diagnostics(1);
        let at = text.len() / 2 + text[text.len() / 2..].find(before).unwrap();
        let [line, start] = position(text, at);
        let mut times = Vec::new();
        for (index, key) in word.chars().enumerate() {
            let version = index as i64 + 2;
            let begun = std::time::Instant::now();
            client.change(version, [line, start + index, line, start + index], &key.to_string());
            client.diagnostics(version);
            times.push(begun.elapsed().as_secs_f64() * 1e3);
        }
        assert_eq!(client.end(), Some(0));
        times.sort_by(f64::total_cmp);
        let part = |part: f64| times[((times.len() - 1) as f64 * part).round() as usize];
        println!(
            "{name}, {} lines: {} keys, half within {:.1} ms, 95 of 100 within {:.1} ms",
            text.lines().count(),
            times.len(),
            part(0.5),
            part(0.95)
        );
    }
}
