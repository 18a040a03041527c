//! The language server on a model that imports parts: texts that are open, files that are not.

use std::path::Path;

use hodograph_generator::files;
use serde_json::{Value, json};

use crate::client::Client;

const LINK: &str = "part Link(hinge: point) {
    coordinates { q: rad = 0.1 }
    speeds { u: rad/s }
    frames { B = N.rotate(z, q); }
    points { tip = hinge - 0.5{m}*B.y; }
    particles { Bob { point: tip, mass: 2{kg} } }
}
";
const CHAIN: &str = "mechanism Chain;
import \"link.mech\";
parameters { g: m/s^2 = 9.81 }
loads { gravity: -g*N.y; }
use Link as a(hinge: O);
";

fn uri(folder: &Path, name: &str) -> String {
    format!("file://{}", folder.join(name).display())
}

fn replace(client: &mut Client, uri: &str, version: i64, text: &str) {
    let document = json!({ "uri": uri, "version": version });
    let changes = json!([{ "text": text }]);
    client.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
}

/// What was published last of a document, once all is read.
fn shown(client: &mut Client, uri: &str) -> Vec<Value> {
    let params = json!({ "textDocument": { "uri": uri } });
    client.request("textDocument/foldingRange", params);
    // diagnostics are sent before what is asked after them is answered, or right behind it
    let params = json!({ "textDocument": { "uri": uri } });
    client.request("textDocument/foldingRange", params);
    let published = client.notifications.iter().rev().find(|message| message["params"]["uri"] == uri);
    published.map_or(Vec::new(), |message| message["params"]["diagnostics"].as_array().unwrap().clone())
}

#[test]
fn imports_come_from_open_texts_and_from_files() {
    let link =
        LINK.replace("{m}", "").replace("{kg}", "").replace("0.5*B.y", "l*B.y").replace("mass: 2", "mass: m");
    let link = link.replacen("coordinates", "parameters { l: m = 0.5, m: kg = 2 }\n    coordinates", 1);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("chain.mech"), CHAIN).unwrap();
    std::fs::write(at("link.mech"), &link).unwrap();
    let (chain, parts) = (uri(folder.path(), "chain.mech"), uri(folder.path(), "link.mech"));
    let mut client = Client::started();
    client.open(&chain, CHAIN);
    assert_eq!(shown(&mut client, &chain), Vec::<Value>::new());

    // a mistake in the file, which is not open, stands at its use and leads there
    let wrong = link.replace("rotate(z, q)", "rotate(z, qq)");
    std::fs::write(at("link.mech"), &wrong).unwrap();
    let change = json!({ "changes": [{ "uri": parts, "type": 2 }] });
    client.notify("workspace/didChangeWatchedFiles", change);
    let found = shown(&mut client, &chain);
    assert_eq!(
        (found.len(), &found[0]["code"], &found[0]["range"]["start"]["line"]),
        (1, &json!("E020"), &json!(4))
    );
    let there = &found[0]["relatedInformation"][0]["location"];
    let known = files::key(&at("link.mech"));
    assert_eq!(there["uri"], format!("file://{known}"));
    let line = wrong[..wrong.find("qq").unwrap()].matches('\n').count();
    assert_eq!(there["range"]["start"]["line"], line);

    // opened, it has the mistake at its place, and the same fix is offered at both
    client.open(&parts, &wrong);
    let own = shown(&mut client, &parts);
    assert_eq!((own.len(), &own[0]["range"]["start"]["line"]), (1, &json!(line)));
    for (document, range) in [(&parts, &own[0]["range"]), (&chain, &found[0]["range"])] {
        let params =
            json!({ "textDocument": { "uri": document }, "range": range, "context": { "diagnostics": [] } });
        let actions = client.request("textDocument/codeAction", params)["result"].clone();
        assert_eq!(actions[0]["title"], "Change to `q`", "{actions}");
        let edit = &actions[0]["edit"]["changes"][&parts][0];
        assert_eq!((&edit["newText"], &edit["range"]["start"]["line"]), (&json!("q"), &json!(line)));
    }

    // mended in the editor and not saved, it is right in both; a mistake in the use shows there alone
    replace(&mut client, &parts, 2, &link);
    assert_eq!(shown(&mut client, &parts), Vec::<Value>::new());
    assert_eq!(shown(&mut client, &chain), Vec::<Value>::new());
    replace(&mut client, &chain, 2, &CHAIN.replace("hinge: O", "hinges: O"));
    assert_eq!(shown(&mut client, &chain)[0]["code"], "E095");
    assert_eq!(shown(&mut client, &parts), Vec::<Value>::new());
    replace(&mut client, &chain, 3, &CHAIN.replace("use Link as a(hinge: O);", ""));

    // F12 on the part leads into its file
    replace(&mut client, &chain, 4, CHAIN);
    let position = json!({ "line": 4, "character": 5 });
    let params = json!({ "textDocument": { "uri": chain }, "position": position });
    let definition = client.request("textDocument/definition", params)["result"].clone();
    assert_eq!((&definition["uri"], &definition["range"]["start"]["character"]), (&json!(parts), &json!(5)));

    // closed, the file counts again, and then it is gone
    client.notify("textDocument/didClose", json!({ "textDocument": { "uri": parts } }));
    assert_eq!(shown(&mut client, &chain)[0]["code"], "E020");
    std::fs::remove_file(at("link.mech")).unwrap();
    client.notify("workspace/didChangeWatchedFiles", json!({ "changes": [{ "uri": parts, "type": 3 }] }));
    assert_eq!(shown(&mut client, &chain)[0]["code"], "E090");
    // and comes anew, in the editor only
    client.open(&parts, &link);
    assert_eq!(shown(&mut client, &chain), Vec::<Value>::new());
    assert_eq!(client.end(), Some(0));
}

/// A coordinate of a part is renamed in the part, which is not open, in the model that is, and in another model of
/// the workspace; a model that does not import the part stays as it is.
#[test]
fn a_name_of_a_part_is_renamed_in_open_texts_and_in_files() {
    let link =
        LINK.replace("{m}", "").replace("{kg}", "").replace("0.5*B.y", "l*B.y").replace("mass: 2", "mass: m");
    let link = link.replacen("coordinates", "parameters { l: m = 0.5, m: kg = 2 }\n    coordinates", 1);
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    let write = |name: &str, text: &str| std::fs::write(root.join(name), text).unwrap();
    std::fs::create_dir_all(root.join("models/other")).unwrap();
    let chain = CHAIN
        .replace("loads {", "loads { torque on a.B: -1.5*k*a.q*N.z;")
        .replace("{ g:", "{ k: N*m = 1, g:");
    let other = chain
        .replace("Chain", "Other")
        .replace("link.mech", "../link.mech")
        .replace("a.q*", "b.q*")
        .replace("a.B", "b.B")
        .replace("as a(", "as b(");
    write("models/link.mech", &link);
    write("models/other/swing.mech", &other);
    write(
        "models/other/apart.mech",
        "mechanism Apart; // imports nothing, and has its own q\ncoordinates { q: rad }\n",
    );
    let mut client = Client::new();
    let folders = json!([{ "uri": format!("file://{}", root.display()), "name": "all" }]);
    client.request(
        "initialize",
        json!({ "capabilities": {}, "processId": null, "rootUri": null, "workspaceFolders": folders }),
    );
    client.notify("initialized", json!({}));
    // it is only in the editor
    let [chain_at, link_at, other_at] =
        ["models/chain.mech", "models/link.mech", "models/other/swing.mech"].map(|name| uri(&root, name));
    client.open(&chain_at, &chain);
    assert_eq!(shown(&mut client, &chain_at), Vec::<Value>::new());
    let line = 3;
    let character = chain.lines().nth(line).unwrap().find("a.q").unwrap() + 2;
    let place =
        json!({ "textDocument": { "uri": chain_at }, "position": { "line": line, "character": character } });
    let ready = client.request("textDocument/prepareRename", place.clone());
    assert_eq!(ready["result"]["placeholder"], "q");
    let ask = |client: &mut Client, new: &str| {
        let mut params = place.clone();
        params["newName"] = json!(new);
        client.request("textDocument/rename", params)
    };
    let answer = ask(&mut client, "angle");
    let changes = answer["result"]["changes"].as_object().unwrap_or_else(|| panic!("{answer}"));
    assert_eq!(changes.len(), 3, "{answer}");
    let applied = |uri: &str, text: &str| {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut edits: Vec<&Value> = changes[uri].as_array().unwrap().iter().collect();
        let at = |edit: &Value, end: &str, part: &str| edit["range"][end][part].as_u64().unwrap() as usize;
        edits.sort_by_key(|edit| {
            std::cmp::Reverse((at(edit, "start", "line"), at(edit, "start", "character")))
        });
        for edit in edits {
            assert_eq!(at(edit, "start", "line"), at(edit, "end", "line"));
            let line = &mut lines[at(edit, "start", "line")];
            let range = at(edit, "start", "character")..at(edit, "end", "character");
            line.replace_range(range, edit["newText"].as_str().unwrap());
        }
        lines.join("\n") + "\n"
    };
    assert_eq!(applied(&chain_at, &chain), chain.replace("a.q*", "a.angle*"));
    assert_eq!(applied(&other_at, &other), other.replace("b.q*", "b.angle*"));
    let expected = link.replace("q: rad", "angle: rad").replace("(z, q)", "(z, angle)");
    let expected = expected.replace("mass: m } }", "mass: m } }\n    kinematics { d(angle)/dt = u; }");
    assert_eq!(applied(&link_at, &link), expected);
    let clash = ask(&mut client, "tip");
    assert!(
        clash["error"]["message"].as_str().unwrap().contains("the part `Link` has a name `tip` already"),
        "{clash}"
    );
    assert_eq!(client.end(), Some(0));
}
